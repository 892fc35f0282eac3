//! A run → the longest time for which a coefficient of friction would not keep the block from sliding.
//!
//! The peak of the friction demand |H|/(N_L + N_R) says little: it has no bound where the reactions vanish for an instant, as in
//! an impact. How long the demand stays above the friction that there is tells whether a block would slide.

use crate::excitation::Inputs;
use crate::simulation::Simulation;

/// Greatest time between two looks at the friction demand (s).
const LOOK: f64 = 1e-3;

/// The name of the column of these times (s) for a coefficient of friction (1).
pub fn name(friction: f64) -> String {
    format!("friction_demand>{friction}")
}

/// The same with its unit.
pub fn heading(friction: f64) -> String {
    name(friction) + " [s]"
}

/// The longest time in one piece for which the friction demand exceeds μ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sliding {
    friction: f64,
    /// Time of the last look (s), and `|H| − μ (N_L + N_R)` then (N).
    last: Option<(f64, f64)>,
    /// Length of the present piece (s).
    piece: f64,
    /// Length of the longest one (s).
    pub(super) longest: f64,
}

impl Sliding {
    /// For the coefficient of friction μ (1), before the first look.
    pub(super) fn new(friction: f64) -> Sliding {
        Sliding { friction, last: None, piece: 0.0, longest: 0.0 }
    }

    /// Looks at a run from its present time to its next stop (s). It is a copy that goes there, at least every millisecond, so
    /// that the motion of the run has the same bits as without.
    pub(super) fn follow(&mut self, simulation: &Simulation, stop: f64, inputs: &Inputs) {
        let mut copy = simulation.clone();
        let start = copy.time();
        let looks = ((stop - start) / LOOK).ceil().max(1.0) as u64;
        self.look(&copy, inputs);
        for number in 1..=looks {
            let time = if number == looks { stop } else { start + (stop - start) * (number as f64 / looks as f64) };
            // The run itself reports a failure.
            if copy.advance(time, inputs, &mut |_| ()).is_err() {
                return;
            }
            self.look(&copy, inputs);
            if copy.ending().is_some() {
                return;
            }
        }
    }

    fn look(&mut self, simulation: &Simulation, inputs: &Inputs) {
        let seen = simulation.observe(inputs);
        let excess = seen.horizontal.abs() - self.friction * (seen.reaction[0] + seen.reaction[1]);
        let now = simulation.time();
        let (time, before) = self.last.replace((now, excess)).unwrap_or((now, excess));
        // The excess is taken as linear between two looks.
        let above = match (before > 0.0, excess > 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (false, true) => excess / (excess - before),
            (true, false) => before / (before - excess),
        };
        self.piece += (now - time) * above;
        self.longest = self.longest.max(self.piece);
        if excess <= 0.0 {
            self.piece = 0.0;
        }
    }
}
