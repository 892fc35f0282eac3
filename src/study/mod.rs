//! Runs of a block and what is made of them: histories, tables, pictures.

pub mod ground;
pub mod history;
pub mod picture;
pub mod plot;
pub mod table;
