//! Observations with their rates at the ends of a step → the greatest values since the start, from inside the step too.

use num_dual::Dual64;
use serde::{Deserialize, Serialize};

use crate::outputs::Observation;
use crate::roots::{Sample, greatest, upper_bound};

/// Greatest absolute values since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Peaks {
    /// Of the rotation θ (rad).
    pub theta: f64,
    /// Of the reactions N_L and N_R (N).
    pub reaction: f64,
    /// Of the horizontal reaction H (N).
    pub horizontal: f64,
    /// Of the heights of the corners above their supports (m).
    pub uplift: f64,
    /// Of the friction demand (1).
    pub friction_demand: f64,
}

/// The quantities of which the greatest value is a peak, those with a sign in both directions.
pub type PeakSamples = [Sample; 9];

impl Peaks {
    fn slots(&mut self) -> [&mut f64; 5] {
        [&mut self.theta, &mut self.reaction, &mut self.horizontal, &mut self.uplift, &mut self.friction_demand]
    }

    /// Takes in the values at one instant.
    pub fn include(&mut self, samples: &PeakSamples) {
        let slots = self.slots();
        for (sample, slot) in samples.iter().zip(SLOTS) {
            *slots[slot] = greater(*slots[slot], sample.value);
        }
    }

    /// Whether a value may rise to a new peak between two instants, above those at both.
    pub fn may_rise_inside(&self, start: &PeakSamples, end: &PeakSamples, duration: f64) -> bool {
        let Peaks { theta, reaction, horizontal, uplift, friction_demand } = *self;
        let peaks = [theta, reaction, horizontal, uplift, friction_demand];
        SLOTS.into_iter().enumerate().any(|(i, slot)| {
            let turns = start[i].rate > 0.0 && end[i].rate < 0.0;
            turns && upper_bound(start[i], end[i], duration) > peaks[slot]
        })
    }

    /// Takes in what happens in a step of `duration` between two instants; `inside` gives the samples at a time after
    /// the first, and is asked only where a peak may be.
    pub fn include_step(
        &mut self,
        start: &PeakSamples,
        end: &PeakSamples,
        duration: f64,
        mut inside: impl FnMut(f64) -> PeakSamples,
    ) {
        let slots = self.slots();
        for (i, slot) in SLOTS.into_iter().enumerate() {
            let peak = &mut *slots[slot];
            if upper_bound(start[i], end[i], duration) > *peak {
                *peak = greater(*peak, greatest(start[i], end[i], duration, |elapsed| inside(elapsed)[i]));
            }
        }
    }
}

/// The greater value; of 0 and −0 the first, where `f64::max` takes one or the other by processor and compiler.
pub fn greater(first: f64, second: f64) -> f64 {
    if second > first { second } else { first }
}

/// To which peak each sample belongs.
const SLOTS: [usize; 9] = [0, 0, 1, 1, 2, 2, 3, 3, 4];

/// The samples of an observation whose dual parts are rates.
pub fn samples(x: &Observation<Dual64>) -> PeakSamples {
    let of = |dual: Dual64| Sample { value: dual.re, rate: dual.eps };
    [
        of(x.theta),
        of(-x.theta),
        of(x.reaction[0]),
        of(x.reaction[1]),
        of(x.horizontal),
        of(-x.horizontal),
        of(x.uplift[0]),
        of(x.uplift[1]),
        of(x.friction_demand),
    ]
}
