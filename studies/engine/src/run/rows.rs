//! Inputs and runs of rows → the rows with their outcomes, and a table.
//!
//! Spectra, sweeps and lists of blocks differ in the inputs of a row; their runs pass through here.

use std::borrow::Cow;

use crate::output::runner::StudyRows;
use crate::output::table::{Table, TableColumn};
use crate::run::Run;
use crate::run::batch::outcomes;
use crate::run::outcome::Outcome;
use rocking_block::numerics::wide::VectorWidth;

/// A row of a study with its run.
#[derive(Clone, Debug)]
pub struct RunRow<I> {
    /// The inputs, for the columns that describe the run.
    pub inputs: I,
    /// The run.
    pub run: Run,
    /// Its outcome.
    pub outcome: Outcome,
    /// The outcomes of the row's samples, if it has any.
    pub samples: Vec<Outcome>,
}

impl<I> RunRow<I> {
    /// Makes the runs of rows, each followed by those of its samples. They are stepped in vectors of this width, or singly.
    ///
    /// All rows have equally many samples. `ended` is called after each run.
    pub fn all<M: IntoIterator<Item = Run>>(
        width: Option<VectorWidth>,
        rows: Vec<(I, Run)>,
        samples: impl Fn(&I) -> M,
        ended: impl Fn(),
    ) -> Vec<RunRow<I>> {
        let runs = rows.iter().flat_map(|(inputs, run)| {
            std::iter::once(Cow::Borrowed(run)).chain(samples(inputs).into_iter().map(Cow::Owned))
        });
        let made = outcomes(width, runs, ended);
        let samples = (made.len() / rows.len().max(1)).saturating_sub(1);
        let mut made = made.into_iter();
        let row = |(inputs, run): (I, Run)| {
            let outcome = made.next().expect("an outcome for each run");
            RunRow { inputs, run, outcome, samples: made.by_ref().take(samples).collect() }
        };
        rows.into_iter().map(row).collect()
    }

    /// The batch of a table with these rows.
    pub fn table(columns: &[TableColumn<RunRow<I>>], rows: &[RunRow<I>]) -> StudyRows {
        let failure = rows.iter().find_map(|row| row.outcome.failure.clone());
        StudyRows { table: Table::of(columns, rows), failure }
    }
}
