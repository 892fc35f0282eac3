//! Results → pictures.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`numerals`] | numbers → short text |
//! | `labels` | parameters of a block → their symbols |
//! | `glyphs` | text → widths and outlines, the same on every machine |
//! | [`picture`] | SVG → SVG and PNG files |
//! | [`formula`] | labels with formulas → text with subscripts |
//! | [`canvas`] | drawing functions → SVG |
//! | [`line_style`] | points → lines that differ without colours |
//! | [`chart`] | curves, areas and marks → charts with axes |
//! | [`page`] | heading, legend and charts → pages |
//! | [`sketch`] | a block with its ties, or one in space → a sketch with dimensions |
//! | [`history`], [`fragility`] | histories and fragilities → pages |
//! | [`history_in_space`], [`plan`](mod@plan) | a history of a block in space → a page, and a view from above |
//! | [`cloud`](mod@cloud) | rotations over a measure → their line and its scatter |
//! | [`stripes`](mod@stripes) | fractions at levels of a measure → their curve |
//! | [`directions`](mod@directions) | outcomes in space by the direction of the ground motion → a polar chart |
//! | [`loops`](mod@loops) | a history → the loops of dampers and of ties that yield |
//! | [`pushover`](mod@pushover) | the curve of a slow rotation → a page |
//! | [`record`](mod@record) | a record → its acceleration, velocity and response spectrum |
//! | [`frame`](mod@frame) | the history of a frame → its rotation, beam and forces |
//! | [`rate`] | annual rates → pages |
//! | [`ranking`](mod@ranking) | annual rates of several objects → a chart that ranks them |
//! | [`pulse_fit`] | a record and the pulse fitted to it → a page |
//! | [`mod@fit`] | tests and their fits → a page |
//! | [`tornado`] | a result at both ends of several ranges → pages |
//! | [`spectrum`], [`record_spectra`] | spectra under one and under several records → pages |

mod glyphs;
mod labels;
pub mod numerals;

pub mod picture;

pub mod formula;

pub mod canvas;

pub mod line_style;

pub mod chart;

pub mod page;
pub use page::titled;

pub mod sketch;

pub mod history;

pub mod history_in_space;

pub mod plan;

pub mod loops;

pub mod pushover;

pub mod fragility;

pub mod cloud;

pub mod stripes;

pub mod directions;

pub mod record;

pub mod frame;

pub mod rate;

pub mod ranking;

pub mod pulse_fit;

pub mod fit;

pub mod tornado;

pub mod spectrum;

pub mod record_spectra;
