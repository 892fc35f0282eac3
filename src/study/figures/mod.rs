//! The figures of the paper, computed anew: parameters and records → pictures in the paper's order, with their tables.

mod damping;
mod histories;
mod page;
pub mod parameters;
pub mod plane;
mod restitution;
pub mod sources;
mod spectra;
mod table;
mod tower;

pub use damping::{Least, least_damping};
pub use histories::{Comparison, comparisons, history_run};
pub use spectra::{Panel, abscissa, panels};
pub use tower::{tower_bases, tower_run, tower_sources};

use crate::block::BlockError;
use crate::simulation::SimulationError;
use crate::study::picture::PictureError;
use crate::study::runner;
use parameters::Detail;
use sources::Source;

/// A figure that cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// No such figure.
    #[error("found figure {0}; expected 3, 6, 7, 8, 9, 10, 11, 12, 13 or 14")]
    Number(u8),
    /// A parameter is not valid.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// A run cannot go on.
    #[error(transparent)]
    Run(#[from] SimulationError),
    /// It cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Its table cannot be made.
    #[error("the table cannot be made: {0}")]
    Table(#[from] csv::Error),
}

/// A figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The paper's number.
    pub number: u8,
    /// The drawing, as SVG.
    pub svg: String,
    /// Its data as CSV: lines that begin with `# ` and say what it is, names of the columns, rows.
    pub table: String,
    /// Runs that failed; they have the word `failed` in the table.
    pub failed: u64,
}

/// Threads on which the runs of figures are made, and what is called after each of them.
pub struct Work<'a> {
    /// Threads.
    pub pool: &'a rayon::ThreadPool,
    /// Is called after each task.
    pub done: &'a mut dyn FnMut(),
}

impl Work<'_> {
    /// Makes so many tasks; the results are in the order of their numbers.
    fn make<T: Send>(&mut self, tasks: u64, make: impl Fn(u64) -> T + Sync) -> Vec<T> {
        let mut results = Vec::new();
        let made = runner::in_order(self.pool, 0..tasks, make, |_, result| {
            results.push(result);
            (self.done)();
            Ok::<(), std::convert::Infallible>(())
        });
        match made {
            Ok(()) => results,
            Err(never) => match never {},
        }
    }
}

/// How many tasks a figure has.
pub fn tasks(number: u8, detail: &Detail, sources: &[Source]) -> u64 {
    match number {
        6..=8 => histories::bases(number).len() as u64,
        9 => damping::tasks(detail),
        10..=13 => spectra::tasks(number, detail, sources),
        14 => tower::tasks(sources),
        _ => 0,
    }
}

/// Makes a figure; `sources` are the ground motions of Table I.
pub fn make(number: u8, detail: &Detail, sources: &[Source], work: &mut Work) -> Result<Figure, FigureError> {
    let caption = parameters::caption(number).ok_or(FigureError::Number(number))?;
    match number {
        3 => restitution::figure(&caption),
        6..=8 => histories::figure(number, &caption, detail, work),
        9 => damping::figure(&caption, detail, work),
        10..=13 => spectra::figure(number, &caption, detail, sources, work),
        14 => tower::figure(&caption, sources, work),
        _ => Err(FigureError::Number(number)),
    }
}
