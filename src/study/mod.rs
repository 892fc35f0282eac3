//! Runs of a block and what is made of them: histories, spectra, sweeps, searches, the paper's figures, tables, pictures.

mod chart;
pub mod coming_down;
pub mod figures;
mod formula;
pub mod ground_files;
pub mod history;
pub mod intensity;
mod look;
pub mod outcome;
pub mod parameters;
pub mod picture;
pub mod place;
pub mod plot;
pub mod records_plot;
pub mod resumable;
pub mod runner;
pub mod sampling;
pub mod search;
pub mod spectrum;
pub mod spectrum_plot;
pub mod spectrum_statistics;
pub mod study_file;
pub mod sweep;
pub mod sweep_file;
mod sweep_records;
pub mod table;
