//! One module a command: options → results.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`simulate`] | options → one run: a table, a picture, a summary |
//! | [`sketch`] | options → a block → its sketch and its values |
//! | [`pushover`] | options → a block → its lateral force over a slow rotation |
//! | [`frame`] | options → columns under a beam → one run of their equivalent block |
//! | [`spectrum`] | options → peak rotations of blocks of all sizes |
//! | [`sweep`] | study file → the table of a sweep |
//! | [`parts`] | a folder of parts → their counts, and the parts to make |
//! | [`merge`] | a folder of parts → the table of one run |
//! | [`ida`] | study file → incremental dynamic analysis |
//! | [`stripes`] | table of a sweep, or counts at levels → a fragility curve and the fractions at the levels |
//! | [`cloud`] | table of a sweep → a line through rotations, and the probability of overturning |
//! | [`fragility`] | table of a sweep → fragility curves |
//! | [`rate`] | hazard curve, fragility curve → annual rate |
//! | [`search`] | range → the values at which the outcome changes |
//! | [`mod@fit`] | study file with measured tests of a block → estimates with intervals |
//! | [`assess`] | study file with an object → a page on it, with pictures and tables |
//! | [`portfolio`] | study files with an object each → their pages, and one that ranks them |
//! | [`record`] | accelerograms → their contents and intensity measures |
//! | [`pulse`] | an accelerogram → the pulse that fits it best |
//! | [`foundations`] | surfaces, rubber, soil → friction, restitution, supports |
//! | [`schema`] | kind of study file → its JSON Schema |
//! | [`shell`] | command line → completions, manual pages |

pub mod simulate;

pub mod sketch;

pub mod pushover;

pub mod frame;

pub mod spectrum;

pub mod sweep;

pub mod parts;

pub mod merge;

pub mod ida;

pub mod fragility;

pub mod stripes;

pub mod cloud;

pub mod rate;

pub mod search;

pub mod fit;

pub mod assess;

pub mod portfolio;

pub mod record;

pub mod pulse;

pub mod foundations;

pub mod schema;

pub mod shell;
