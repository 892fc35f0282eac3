//! The `rocking` program, as a user runs it.
//!
//! | module | subject |
//! | --- | --- |
//! | `holds` | eccentricity, friction and ties: options, columns, limits |
//! | `inputs` | options, study files and records: values, choices, refusals |
//! | `simulate` | single runs: table, picture and summary |
//! | `gradients` | derivatives of single runs |
//! | `space` | single runs of blocks in space |
//! | `sketch` | pictures of a block and its values |
//! | `pushover` | slow rotations: landmarks, cycle, tables |
//! | `frame` | columns under a beam: block, table, refusals |
//! | `fit` | fits to measured tests |
//! | `assess` | reports on an object |
//! | `portfolio` | reports on several objects and their order |
//! | `foundations` | friction, restitution and supports with their sources |
//! | `studies` | spectra, sweeps, searches, fragility curves |
//! | `outputs` | files, devices and pipes, formats, JSON, completions, manual pages |

mod assess;
mod fit;
mod foundations;
mod frame;
mod gradients;
mod holds;
mod inputs;
#[cfg(unix)]
mod outputs;
mod portfolio;
mod program;
mod pushover;
mod simulate;
mod sketch;
#[path = "../../../../tests/common/skipped.rs"]
mod skipped;
mod space;
mod studies;
