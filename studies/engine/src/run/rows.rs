//! Inputs and runs of rows → the rows with their outcomes, and a table.
//!
//! Spectra, sweeps and lists of blocks differ in the inputs of a row; their runs, in the plane or in space, pass through here.

use std::borrow::{Borrow, Cow};

use crate::output::runner::StudyRows;
use crate::output::table::{Table, TableColumn};
use crate::run::Run;
use crate::run::batch;
use crate::run::limit::Limit;
use crate::run::outcome::{End, Outcome};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::SimulationError;

/// A run of some body, as rows of tables need it.
pub trait Experiment: Clone {
    /// The result of a run without its history.
    type Outcome: RunOutcome + Clone;

    /// Makes runs and returns their outcomes in order. They may be stepped in vectors of this width.
    ///
    /// `ended` is called after each run, in any order.
    fn outcomes<R: Borrow<Self>>(
        width: Option<VectorWidth>,
        runs: impl Iterator<Item = R>,
        ended: impl Fn(),
    ) -> Vec<Self::Outcome>;
}

/// The result of a run of some body, as studies read it.
pub trait RunOutcome {
    /// How the run ended.
    fn end(&self) -> End;

    /// The greatest value of a limit's quantity; `None` for overturning, and for a quantity that the body does not have.
    fn response(&self, limit: Limit) -> Option<f64>;

    /// Reason of a failure.
    fn failure(&self) -> Option<&SimulationError>;
}

/// A row of a study with its run.
#[derive(Clone, Debug)]
pub struct RunRow<I, E: Experiment = Run> {
    /// The inputs, for the columns that describe the run.
    pub inputs: I,
    /// The run.
    pub run: E,
    /// Its outcome.
    pub outcome: E::Outcome,
    /// The outcomes of the row's samples, if it has any.
    pub samples: Vec<E::Outcome>,
}

impl<I, E: Experiment> RunRow<I, E> {
    /// Makes the runs of rows, each followed by those of its samples. They are stepped in vectors of this width, or singly.
    ///
    /// All rows have equally many samples. `ended` is called after each run.
    pub fn all<M: IntoIterator<Item = E>>(
        width: Option<VectorWidth>,
        rows: Vec<(I, E)>,
        samples: impl Fn(&I) -> M,
        ended: impl Fn(),
    ) -> Vec<RunRow<I, E>> {
        let runs = rows.iter().flat_map(|(inputs, run)| {
            std::iter::once(Cow::Borrowed(run)).chain(samples(inputs).into_iter().map(Cow::Owned))
        });
        let made = E::outcomes(width, runs, ended);
        let samples = (made.len() / rows.len().max(1)).saturating_sub(1);
        let mut made = made.into_iter();
        let row = |(inputs, run): (I, E)| {
            let outcome = made.next().expect("an outcome for each run");
            RunRow { inputs, run, outcome, samples: made.by_ref().take(samples).collect() }
        };
        rows.into_iter().map(row).collect()
    }

    /// The batch of a table with these rows.
    pub fn table(columns: &[TableColumn<RunRow<I, E>>], rows: &[RunRow<I, E>]) -> StudyRows {
        let failure = rows.iter().find_map(|row| row.outcome.failure().cloned());
        StudyRows { table: Table::of(columns, rows), failure }
    }
}

impl Experiment for Run {
    type Outcome = Outcome;

    fn outcomes<R: Borrow<Run>>(
        width: Option<VectorWidth>,
        runs: impl Iterator<Item = R>,
        ended: impl Fn(),
    ) -> Vec<Outcome> {
        batch::outcomes(width, runs, ended)
    }
}

impl RunOutcome for Outcome {
    fn end(&self) -> End {
        self.end
    }

    fn response(&self, limit: Limit) -> Option<f64> {
        let peaks = &self.peaks;
        match limit {
            // Half cycles are counted in the run of a row only.
            Limit::Overturned | Limit::HalfCycles(_) => None,
            Limit::Balance => Some(self.lean.over_balance),
            Limit::Rotation(_) => Some(peaks.theta / self.alpha),
            Limit::Slip(_) => Some(peaks.slip),
            Limit::Plastic(_) => peaks.plastic.into_iter().reduce(f64::max),
            Limit::Breaks => Some(f64::from(self.breaks.count)),
            Limit::Tilt(_) | Limit::Twist(_) | Limit::Drift(_) => None,
        }
    }

    fn failure(&self) -> Option<&SimulationError> {
        self.failure.as_ref()
    }
}
