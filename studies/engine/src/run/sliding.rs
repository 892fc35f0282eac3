//! A run and a coefficient of friction → the longest time of a greater demand.
//!
//! The peak of the friction demand |H|/(N_L + N_R) is unbounded where the reactions vanish for an instant, as in an impact. The
//! time for which the demand exceeds the available friction indicates whether a block would slide.

use crate::output::table::TableColumn;
use crate::run::rows::RunRow;
use rocking_block::excitation::Inputs;
use rocking_block::simulation::Simulation;

/// Greatest time between two samples of the friction demand (s).
const SAMPLING: f64 = 1e-3;

/// The column of these times for a coefficient of friction (1).
pub fn column<'c, I>(friction: f64) -> TableColumn<'c, RunRow<I>> {
    TableColumn::real(format!("friction_demand>{friction}"), "s", move |row: &RunRow<I>| {
        row.run.longest_above(friction)
    })
}

/// The longest uninterrupted time for which the friction demand exceeds μ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sliding {
    friction: f64,
    /// Time of the last sample (s), and `|H| − μ (N_L + N_R)` at that time (N).
    last: Option<(f64, f64)>,
    /// Length of the current interval (s).
    interval: f64,
    /// Length of the longest interval (s).
    pub(super) longest: f64,
}

impl Sliding {
    /// Starts without samples, for the coefficient of friction μ (1).
    pub(super) fn new(friction: f64) -> Sliding {
        Sliding { friction, last: None, interval: 0.0, longest: 0.0 }
    }

    /// Samples a run from now to its next stop (s), at least every millisecond.
    ///
    /// A copy makes the extra steps, so that the bits of the run itself do not change.
    pub(super) fn follow(&mut self, simulation: &Simulation, stop: f64, inputs: &Inputs) {
        let mut copy = simulation.clone();
        let start = copy.time();
        let samples = ((stop - start) / SAMPLING).ceil().max(1.0) as u64;
        self.sample(&copy, inputs);
        for number in 1..=samples {
            let time = if number == samples { stop } else { start + (stop - start) * (number as f64 / samples as f64) };
            // The run itself reports a failure.
            if copy.advance(time, inputs, &mut |_| ()).is_err() {
                return;
            }
            self.sample(&copy, inputs);
            if copy.ending().is_some() {
                return;
            }
        }
    }

    fn sample(&mut self, simulation: &Simulation, inputs: &Inputs) {
        let seen = simulation.observe(inputs);
        let excess = seen.horizontal.abs() - self.friction * (seen.reaction[0] + seen.reaction[1]);
        let now = simulation.time();
        let (time, before) = self.last.replace((now, excess)).unwrap_or((now, excess));
        // The excess is taken as linear between two samples.
        let above = match (before > 0.0, excess > 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (false, true) => excess / (excess - before),
            (true, false) => before / (before - excess),
        };
        self.interval += (now - time) * above;
        self.longest = self.longest.max(self.interval);
        if excess <= 0.0 {
            self.interval = 0.0;
        }
    }
}
