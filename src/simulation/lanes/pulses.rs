//! The pulses of a group → their accelerations at the instants of a step, one per lane, before the step is taken.
//!
//! They do not depend on the motion, so that no stage waits for a sine, and the code for them is not copied into the steps of each regime.

use crate::excitation::{Form, Wave};
use crate::numerics::scalar::{Real, Runs};
use crate::numerics::wide::{Array, Lanes, MAX_LANES, Simd, Task, VectorWidth, Wide};
use crate::numerics::{dop853, short};
use crate::simulation::lanes::Lane;

/// The number of stages of a step, with its beginning.
const MAX_STAGES: usize = 12;

/// Accelerations (m/s²) by the pulses of a group in a step. Zeros in lanes without a pulse.
pub struct Pulses {
    /// At the times of the stages; the first is the beginning.
    pub stages: [Array; MAX_STAGES],
    /// At the end.
    pub end: Array,
    /// Rates at both ends (m/s³).
    pub rates: [Array; 2],
}

impl Pulses {
    /// No pulses.
    pub const NONE: Pulses =
        Pulses { stages: [[0.0; MAX_LANES]; MAX_STAGES], end: [0.0; MAX_LANES], rates: [[0.0; MAX_LANES]; 2] };

    /// The pulses of a group in a short step or one of order 8.
    pub fn of(width: VectorWidth, short: bool, runs: &[&Lane; MAX_LANES]) -> Pulses {
        let mut pulses = Pulses::NONE;
        for (i, run) in runs.iter().enumerate() {
            let Some(form) = run.wave.as_ref().map(|wave| wave.form) else { continue };
            if runs[..i].iter().all(|before| wave_of(before, form).is_none()) {
                width.run(OfForm { form, short, runs, pulses: &mut pulses });
            }
        }
        pulses
    }
}

/// The pulse of a run, if it has this form.
#[inline(always)]
fn wave_of(run: &Lane, form: Form) -> Option<&Wave> {
    run.wave.as_ref().filter(|wave| wave.form == form)
}

/// The pulses of a form.
struct OfForm<'g> {
    form: Form,
    short: bool,
    runs: &'g [&'g Lane; MAX_LANES],
    pulses: &'g mut Pulses,
}

impl Task for OfForm<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd>(self) {
        let wave = Wave::<Wide<V>>::in_lanes(self.form, |lane| wave_of(self.runs[lane], self.form));
        let it = Wide::each(|lane| if wave_of(self.runs[lane], self.form).is_some() { 1.0 } else { 0.0 });
        let lanes = Wide::default().less(it);
        let time = Wide::each(|lane| self.runs[lane].simulation.run.pose.time);
        let size = Wide::each(|lane| self.runs[lane].attempt.size);
        let end_time = Wide::each(|lane| self.runs[lane].end_time());
        let Pulses { stages, end, rates } = self.pulses;
        let count = if self.short { short::STAGES } else { dop853::STAGES };
        for (stage, place) in stages.iter_mut().enumerate().take(count) {
            let time = match (stage, self.short) {
                (0, _) => time,
                (_, true) => short::stage_time(time, size, stage),
                (_, false) => dop853::stage_time(time, size, stage),
            };
            put(place, wave.acceleration(time), lanes);
        }
        put(end, wave.acceleration(end_time), lanes);
        for (place, time) in rates.iter_mut().zip([time, end_time]) {
            put(place, wave.rate(time), lanes);
        }
    }
}

/// Stores the numbers of some lanes.
#[inline(always)]
fn put<V: Simd>(place: &mut Array, numbers: Wide<V>, lanes: Lanes<V>) {
    *place = lanes.choose(numbers, Wide::load(place)).store();
}
