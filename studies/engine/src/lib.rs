//! Runs of a rocking block and their evaluation: a folder for each kind of study.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`mismatch`] | content found, content expected → an error |
//! | [`statistics`] | deviates and seeds → probabilities, random samples |
//! | [`hull`](mod@hull) | points of a plane → the corners of their convex hull |
//! | [`input`] | study files and accelerogram files → parameters and records |
//! | [`intensity`] | a record → its intensity measures |
//! | [`pulse_fit`] | a record → the pulse that fits its velocity best |
//! | [`building`] | a record, an elastic building → the motions of its floors |
//! | [`foundations`] | materials and sizes → friction, restitution, stiffness and damping with their sources |
//! | [`spec`] | what a user says of a block → the block |
//! | [`run`] | block, ground motion, settings → a history, its outcome, limits exceeded |
//! | [`space`] | a block in space, ground motion in three directions, settings → a history |
//! | [`doubts`] | blocks and pulses → remarks on numbers beyond reason |
//! | [`pushover`] | a block → its moment over a slow rotation, and the loop of a cycle |
//! | [`frame`] | columns under a beam → the block that rocks like them, and the forces of the frame |
//! | [`output`] | numbered tasks → rows of a CSV file, in order, resumable |
//! | [`spectrum`] | blocks of all sizes under several ground motions → a table of peak rotations |
//! | [`search`] | a block, a parameter and its range → the values at which the outcome changes |
//! | [`sweep`] | parameters × ground motions × strengths → a table of outcomes; samples of an ensemble |
//! | [`fragility`] | the table of a sweep → fragility curves |
//! | [`risk`] | a hazard curve, a fragility curve → the annual rate of exceeding a limit |
//! | [`fit`] | measured tests of a block, free parameters → estimates with their intervals |
//! | [`assess`] | a study file with an object → the numbers of a report on it |
//! | [`portfolio`] | study files with an object each → their order by annual rate |

#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod mismatch;

pub mod statistics;

pub mod hull;

pub mod input;

pub mod intensity;

pub mod pulse_fit;

pub mod building;

pub mod foundations;

pub mod spec;

pub mod run;

pub mod space;

pub mod doubts;

pub mod pushover;

pub mod frame;

pub mod output;

pub mod spectrum;

pub mod search;

pub mod sweep;

pub mod fragility;

pub mod risk;

pub mod fit;

pub mod assess;

pub mod portfolio;
