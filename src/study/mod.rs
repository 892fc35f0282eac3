//! Runs of a block and what is made of them: histories, spectra, sweeps, searches, the paper's figures, tables, pictures.

#[cfg(feature = "program")]
mod chart;
pub mod coming_down;
pub mod ensemble;
#[cfg(feature = "program")]
pub mod figures;
#[cfg(feature = "program")]
mod formula;
pub mod fragility;
#[cfg(feature = "program")]
pub mod fragility_plot;
pub mod friction;
pub mod ground_files;
pub mod history;
pub mod intensity;
#[cfg(feature = "program")]
mod letters;
#[cfg(feature = "program")]
mod look;
pub mod normal;
#[cfg(feature = "program")]
pub mod numerals;
pub mod outcome;
pub mod parameters;
#[cfg(feature = "program")]
pub mod picture;
pub mod place;
#[cfg(feature = "program")]
pub mod plot;
#[cfg(feature = "program")]
pub mod records_plot;
pub mod resumable;
pub mod runner;
pub mod sampling;
pub mod search;
pub mod spectrum;
#[cfg(feature = "program")]
pub mod spectrum_plot;
pub mod spectrum_statistics;
pub mod strength;
pub mod study_file;
pub mod sweep;
mod sweep_ensemble;
pub mod sweep_file;
mod sweep_records;
mod sweep_strength;
pub mod table;
pub mod together;
