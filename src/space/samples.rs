//! A block at an end of a step → the samples of its watched functions, and the quantities of its motion that have a peak.

use crate::numerics::dual::Dual;
use crate::space::events::{Poised, SpaceFunction, SpaceSample};
use crate::space::motion::Lean;
use crate::space::peaks::{OF_MOTION, of_motion};
use crate::space::piece::indicator_count;

/// What is known of a block at an end of a step.
#[derive(Clone, Debug)]
pub(super) struct SpaceSamples {
    /// Room for a sample of each function; the first `count` hold those of the functions watched now.
    functions: Vec<SpaceSample>,
    count: usize,
    /// The quantities of the body's motion with a peak.
    pub(super) of_motion: [Dual; OF_MOTION],
    /// The lean of the body.
    pub(super) lean: Lean<Dual>,
}

impl SpaceSamples {
    /// Returns memory for the samples of a block with n feet.
    pub(super) fn new(feet: usize) -> SpaceSamples {
        let none = SpaceSample { function: SpaceFunction::Overturning, value: Dual::default(), rounding: 0.0 };
        let functions = vec![none; indicator_count(feet)];
        SpaceSamples { functions, count: 0, of_motion: [Dual::default(); OF_MOTION], lean: Lean::default() }
    }

    /// Takes the samples of a block.
    pub(super) fn take(&mut self, now: &Poised) {
        self.count = 0;
        now.take_samples(|sample| {
            self.functions[self.count] = sample;
            self.count += 1;
        });
        self.of_motion = of_motion(now.body, now.motion());
        self.lean = now.motion().turn.lean();
    }

    /// Returns the samples of the functions that are watched.
    pub(super) fn watched(&self) -> &[SpaceSample] {
        &self.functions[..self.count]
    }
}
