//! A motion that is stepped from outside → its next event, if that comes soon.

use crate::block::Body;
use crate::excitation::Inputs;
use crate::simulation::exchange::piece::Foreseen;
use crate::simulation::state::{Pending, Simulation};

/// Longest time from an event to one that is foreseen after it, times p.
///
/// A rotation that returns within T peaks at some α (p T)²/32, here at most 8e-5 α. Longer arcs exceed a relative tolerance of 1e-6
/// of an importer's solver a hundred times.
const FORESIGHT: f64 = 0.05;

/// Distance of two instants that a solver cannot tell apart, over the rounding of its clock. CVODE refuses to step less than 2 ulp.
const UNRESOLVED: f64 = 16.0;

/// The tolerance of steps to a foreseen event.
const TOLERANCE_AHEAD: f64 = 1e-12;

impl Simulation {
    /// The next event, if it is known.
    pub(super) fn foreseen(&self) -> Option<Foreseen> {
        self.run.piece.and_then(|piece| piece.foreseen)
    }

    /// The next event under these inputs, if it comes soon and before `until` (s).
    pub(super) fn foresee(&self, inputs: &Inputs, until: f64) -> Option<Foreseen> {
        if self.run.ending.is_some() {
            return None;
        }
        let horizon = FORESIGHT / self.block().p;
        let stops = [Some(self.run.pose.time + horizon), Some(until), self.setup.pulse.next_kink(self.run.pose.time)];
        let mut ahead = self.clone();
        ahead.setup.settings.tolerance = TOLERANCE_AHEAD;
        let stop = stops.into_iter().flatten().fold(f64::INFINITY, f64::min);
        let mut passes_events = false;
        ahead.advance_to_event(stop, self.run.pose.time, inputs, &mut |_| passes_events = true).ok()?;
        let Pending { function, .. } = ahead.run.pending?;
        // A corner may be held or let go on the way, or a restraint become slack, which is not reported.
        let [then, now] = [&ahead.run.pose, &self.run.pose];
        let direct =
            !passes_events && then.contacts == now.contacts && then.restraints.modes() == now.restraints.modes();
        direct.then_some(Foreseen { pose: ahead.run.pose, function, peaks: ahead.run.peaks, inputs: *inputs })
    }

    /// The time (s) within which the clock of a solver outside does not tell two instants apart.
    pub fn clock_rounding(&self) -> f64 {
        let Body { omega_v, p, .. } = self.block().body;
        UNRESOLVED * f64::EPSILON * self.run.pose.time.abs().max(1.0 / omega_v.max(p))
    }

    /// Forgets an event that was foreseen under other inputs than these.
    pub fn change_inputs(&mut self, inputs: &Inputs) {
        if let Some(piece) = &mut self.run.piece {
            piece.foreseen = piece.foreseen.filter(|foreseen| foreseen.inputs == *inputs);
        }
    }

    /// The next time (s) at which the importer has to stop. It is the first kink of the pulse, or a foreseen event.
    pub fn next_stop(&self) -> Option<f64> {
        let foreseen = self.foreseen().map(|foreseen| foreseen.pose.time);
        [self.setup.pulse.next_kink(self.run.pose.time), foreseen].into_iter().flatten().reduce(f64::min)
    }
}
