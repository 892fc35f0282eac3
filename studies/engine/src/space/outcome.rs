//! A run in space → its end, its peaks and its counts.

use std::borrow::Borrow;

use crate::output::table::TableColumn;
use crate::run::limit::Limit;
use crate::run::outcome::End;
use crate::run::rows::{Experiment, RunOutcome};
use crate::space::RunInSpace;
use crate::space::facts::{self, PEAKS};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::run::SimulationError;
use rocking_block::space::SpaceRun;
use rocking_block::space::run::SpaceCounts;

/// The result of a run in space without its history. All numbers refer to the run until its end.
#[derive(Clone, Debug, PartialEq)]
pub struct OutcomeInSpace {
    /// How the run ended.
    pub end: End,
    /// Time of the end (s).
    pub end_time: f64,
    /// Greatest values, in the order of [`PEAKS`].
    pub peaks: [f64; PEAKS.len()],
    /// Counters.
    pub counts: SpaceCounts,
    /// Whether no foot touched at some time.
    pub separated: bool,
    /// Tilt at the end over the critical one in the direction of the lean (1).
    pub tilt: f64,
    /// Twist at the end (rad).
    pub twist: f64,
    /// Place of the middle of the base at the end, from that at the start (m).
    pub drift: [f64; 2],
    /// Reason of a failure.
    pub failure: Option<SimulationError>,
}

impl RunInSpace {
    /// Makes the run without keeping rows. Its stops, and thus its bits, are those of [`RunInSpace::history`].
    pub fn outcome(&self) -> OutcomeInSpace {
        let mut run = self.begin();
        let driven = self.drive(&mut run, |_| (), |_, _, _| ());
        self.outcome_of(&run, driven.err())
    }

    /// The outcome of the run if it ends now.
    fn outcome_of(&self, run: &SpaceRun, failure: Option<SimulationError>) -> OutcomeInSpace {
        let (body, state) = (&self.setup.body, run.state());
        let seen = run.observe(&self.ground.inputs_from(run.time()).0);
        OutcomeInSpace {
            end: if failure.is_some() { End::Failed } else { self.end(run) },
            end_time: state.ending.map_or(run.time(), |(_, time)| time),
            peaks: facts::peaks(&state.peaks),
            counts: state.counts,
            separated: state.separated,
            tilt: seen.tilt_over_critical(body),
            twist: seen.attitude.twist,
            drift: seen.drift,
            failure,
        }
    }
}

impl Experiment for RunInSpace {
    type Outcome = OutcomeInSpace;

    /// Runs in space are made one by one.
    fn outcomes<R: Borrow<RunInSpace>>(
        _: Option<VectorWidth>,
        runs: impl Iterator<Item = R>,
        ended: impl Fn(),
    ) -> Vec<OutcomeInSpace> {
        runs.map(|run| run.borrow().outcome()).inspect(|_| ended()).collect()
    }
}

impl RunOutcome for OutcomeInSpace {
    fn end(&self) -> End {
        self.end
    }

    fn response(&self, limit: Limit) -> Option<f64> {
        let peak = |name: &str| PEAKS.iter().position(|(known, _)| *known == name).map(|place| self.peaks[place]);
        match limit {
            Limit::Tilt(_) => peak("tilt/alpha"),
            Limit::Twist(_) => peak("twist"),
            Limit::Slip(_) => peak("slip"),
            Limit::Drift(_) => peak("drift"),
            Limit::Overturned
            | Limit::Balance
            | Limit::Rotation(_)
            | Limit::Plastic(_)
            | Limit::HalfCycles(_)
            | Limit::Breaks => None,
        }
    }

    fn failure(&self) -> Option<&SimulationError> {
        self.failure.as_ref()
    }
}

/// The columns of the outcomes of blocks in space. `of` takes the outcome from a row.
pub fn columns<'c, R: 'c>(of: fn(&R) -> &OutcomeInSpace) -> Vec<TableColumn<'c, R>> {
    type Of<'c, R> = TableColumn<'c, R>;
    let peaks = PEAKS.into_iter().enumerate();
    let peaks =
        peaks.map(|(place, (name, unit))| Of::real(format!("peak.{name}"), unit, move |row| of(row).peaks[place]));
    let mut columns = vec![
        Of::choice("outcome", End::ALL.map(End::word), move |row| of(row).end as usize),
        Of::real("end_time", "s", move |row| of(row).end_time),
    ];
    columns.extend(peaks);
    columns.extend([
        Of::boolean("separated", move |row| of(row).separated),
        Of::count("events.lift_offs", move |row| of(row).counts.lift_offs),
        Of::count("events.landings", move |row| of(row).counts.landings),
        Of::count("events.slides", move |row| of(row).counts.slides),
        Of::count("events.sticks", move |row| of(row).counts.sticks),
        Of::real("end.tilt/alpha", "1", move |row| of(row).tilt),
        Of::real("end.twist", "rad", move |row| of(row).twist),
        Of::real("end.drift_x", "m", move |row| of(row).drift[0]),
        Of::real("end.drift_y", "m", move |row| of(row).drift[1]),
    ]);
    columns
}
