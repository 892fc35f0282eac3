//! The engine of the Python package `rocking_block`, with conversions between NumPy and the crate `rocking-block` only.
//! Names, defaults and documentation are those of the Python modules beside it; `_engine.pyi` has the types.
//!
//! | module | in → out |
//! | --- | --- |
//! | `tie` | a tie of Python ↔ one of the engine |
//! | `block` | parameters → a block |
//! | `blocks` | parameters of many blocks → the blocks |
//! | `building` | floor masses and storey stiffnesses, or modes → a building, motions of its floors |
//! | `record` | a file or an array → a record |
//! | `options` | words and numbers of Python → settings, pulses, ground motions of the engine |
//! | `history` | a block and its excitation → columns over time |
//! | `pushover` | a block → its lateral force over a slow rotation |
//! | `frame` | columns under a beam → the equivalent block, and the forces of the columns |
//! | `studies` | many blocks under many ground motions → a column each |
//! | `table` | a table, or its file → its columns as arrays of NumPy |
//! | `fragility` | outcomes over an intensity measure → a curve |
//! | `risk` | a hazard curve and a fragility curve → an annual rate |
//! | `fit` | a block, measured tests, free parameters → estimates with their intervals |
//! | `assess` | study files with an object each → the numbers and the files of reports, and their order |
//! | `foundations` | materials and sizes → friction, restitution, supports with their sources |
//! | `space` | a block in space and its excitation → columns over time, or outcomes of many motions |
//! | `search` | a range → the values at which the outcome changes |
//! | `work` | long work → its result, while Python shows progress and handles Ctrl-C |

#![deny(clippy::disallowed_methods)]

mod assess;
mod block;
mod blocks;
mod building;
mod cloud;
mod fit;
mod foundations;
mod fragility;
mod frame;
mod history;
mod ida;
mod measures;
mod options;
mod pushover;
mod record;
mod risk;
mod search;
mod space;
mod studies;
mod table;
mod tie;
mod work;

use pyo3::prelude::*;

/// The engine of `rocking_block`.
#[pymodule]
mod _engine {
    #[pymodule_export]
    #[allow(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use super::{
        assess::{assess, portfolio},
        block::Block,
        blocks::{Blocks, parameter_unit},
        building::Building,
        cloud::{Cloud, stripes, unrolled},
        fit::fit,
        foundations::{foundation_pairs, pad_support, soil_support},
        fragility::{
            CaseStore, Cases, Fragility, Motions, Surface, export_fragility, link_probabilities, sufficiency, surface,
        },
        frame::{frame_block, frame_response},
        history::history,
        ida::Ida,
        measures::measure_name,
        options::{check_pulse, pulse_acceleration, pulse_duration},
        pushover::pushover,
        record::{Record, fit_pulse, intensity, motion_words, read_record, rot_d, rotate, unit_factor},
        risk::{AnnualRate, check_hazard, hazard_over, read_hazard},
        search::{search_damping, search_overturning},
        space::{BlockInSpace, history_in_space, outcomes_in_space},
        studies::{Study, outcomes, part_file_name, part_format, strong_scales},
        table::{read_table, table_files},
        tie::link_numbers,
    };
}
