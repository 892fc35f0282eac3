//! Options of the command line → records, pulses, blocks, settings; the errors name the option.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`choices`] | words of the command line → choices of the engine |
//! | [`explicit`] | command line → the options set by the user; errors for those without effect |
//! | [`checks`] | numbers of options → errors for those out of range |
//! | [`input`] | path or `-` → content |
//! | [`accelerograms`] | options, files → records |
//! | [`excitation`] | options → records and a pulse |
//! | [`mod@block`] | options of a single block → the block |
//! | [`in_space`] | options of a block in space → the block |
//! | [`single_run`] | settings of a single run → the run |
//! | [`run`] | options shared by studies → settings, a table of many runs |
//! | [`fit`] | options, table of a sweep → its rows, a limit, the method of intervals |
//! | [`measure`] | options of a block → the measure of records behind a measure relative to the block |

pub mod choices;

pub mod explicit;

pub mod checks;

pub mod input;

pub mod accelerograms;

pub mod excitation;

pub mod block;

pub mod in_space;

pub mod single_run;

pub mod run;

pub mod fit;

pub mod measure;
