//! A run, in the plane or in space → the same run at another strength, and the usual strengths.

use crate::run::Run;
use crate::run::rows::Experiment;
use crate::space::RunInSpace;
use rocking_block::block::{Corner, Foundation};
use rocking_block::excitation::Pulse;
use rocking_block::space::DirectedPulse;

/// A run whose ground motion a search makes stronger.
pub trait Shaken: Experiment + Sync {
    /// Returns the run with records times a factor or, without records, with the amplitude a_p (m/s²) of its pulse.
    #[must_use]
    fn at_strength(&self, strength: f64) -> Self;

    /// Returns the range of strengths in which the block is likely to overturn first. It goes up to ten times a PGA of g tan α.
    ///
    /// It begins at zero: viscoelastic supports respond to weak motions, vertical motion reduces the weight, and ties may pull to a side.
    /// Only on a rigid base under horizontal motion it begins at g tan α (the smaller one of both sides), below which no block rocks.
    fn usual_strengths(&self) -> [f64; 2];
}

impl Shaken for Run {
    fn at_strength(&self, strength: f64) -> Run {
        match self.ground.is_empty() {
            true => Run { pulse: Pulse { amplitude: strength, ..self.pulse }, ..self.clone() },
            false => Run { ground: self.ground.clone().scaled(strength), ..self.clone() },
        }
    }

    fn usual_strengths(&self) -> [f64; 2] {
        let Run { block, ground, .. } = self;
        let pga = match ground.is_empty() {
            true => 1.0,
            false => ground.horizontal.as_ref().map_or(0.0, |record| record.peak().acceleration.abs()),
        };
        let static_limit = |alpha: f64| block.gravity * libm::tan(alpha) / pga;
        let is_rigid = block.foundation == Foundation::Rigid && ground.vertical.is_none() && block.ties().is_empty();
        let [left, right] = Corner::each(|corner| static_limit(block.alpha_of(corner)));
        [if is_rigid { left.min(right) } else { 0.0 }, 10.0 * static_limit(block.alpha)]
    }
}

impl Shaken for RunInSpace {
    fn at_strength(&self, strength: f64) -> RunInSpace {
        let mut run = self.clone();
        if run.ground.end().is_some() {
            run.ground = run.ground.scaled_and_shifted(strength, 0.0);
            return run;
        }
        let first = run.setup.pulses[0];
        run.setup.pulses[0] = DirectedPulse { pulse: Pulse { amplitude: strength, ..first.pulse }, ..first };
        run
    }

    /// In space α is that of the balance over the nearest edge, and the PGA that of both horizontal components together.
    fn usual_strengths(&self) -> [f64; 2] {
        let body = &self.setup.body;
        let [x, y] = [0, 1].map(|i| self.ground.records[i].as_ref().map_or(&[][..], |record| &record.acceleration));
        let both = x.iter().enumerate().map(|(i, x)| libm::hypot(*x, y.get(i).copied().unwrap_or_default()));
        let pga = if self.ground.end().is_some() { both.fold(0.0, f64::max) } else { 1.0 };
        [0.0, 10.0 * body.gravity * libm::tan(body.edge_angle) / pga]
    }
}
