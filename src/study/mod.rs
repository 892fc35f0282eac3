//! Runs of a block and what is made of them: histories, spectra, sweeps, searches, tables, pictures.

pub mod ground;
pub mod history;
pub mod intensity;
pub mod picture;
pub mod plot;
pub mod resumable;
pub mod runner;
pub mod spectrum;
pub mod spectrum_plot;
pub mod table;
