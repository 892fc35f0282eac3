//! The block stepped from outside: continuous states, derivatives, event indicators, and effects of events.
//!
//! Equations, watched functions and changes at events are those of [`SpaceRun::advance`]; the importer's solver only has to find where an
//! indicator falls through zero. The quaternion stands for a rotation at any length, which its derivative keeps, so that errors of the
//! solver in its norm have no effect; each event gives it the norm 1.

use crate::numerics::stepper::SliceEquations;
use crate::run::SimulationError;
use crate::space::body::SpaceBody;
use crate::space::equations::SpaceEquations;
use crate::space::events::{PER_CONTACT, Poised, SpaceEvent, SpaceFunction, SpaceSample};
use crate::space::excitation::{SpaceInputs, next_kink};
use crate::space::motion::{
    DISPLACEMENT, FEET_FROM, OMEGA, PER_FOOT, QUATERNION, VELOCITY, dimension, normalize, three,
};
use crate::space::piece::{OF_FEET, SpacePiece, place};
use crate::space::run::{SpaceRun, SpaceState};
use crate::space::stepping::{SpaceInterior, include_peaks};

/// The indicator in place of a function that is not watched at present.
const IDLE: f64 = 1.0;

/// Distance of two instants that a solver cannot tell apart, over the rounding of its clock, as in the plane.
const UNRESOLVED: f64 = 16.0;

/// Returns typical magnitudes of the continuous states for error control, none of them zero.
pub fn nominals(body: &SpaceBody) -> Vec<f64> {
    let SpaceBody { alpha, p, r0, omega_v, .. } = *body;
    let across = r0 * alpha;
    let deflection = body.gravity / (omega_v * omega_v);
    let mut nominals = vec![0.0; dimension(body.count())];
    nominals[DISPLACEMENT..QUATERNION].copy_from_slice(&[across, across, deflection]);
    nominals[QUATERNION..VELOCITY].fill(0.5 * alpha);
    nominals[VELOCITY..OMEGA].copy_from_slice(&[across * p, across * p, deflection * omega_v]);
    nominals[OMEGA..FEET_FROM].fill(alpha * p);
    nominals[FEET_FROM..OF_FEET].fill(body.energy_scale() * alpha * alpha);
    let stretches = OF_FEET..OF_FEET + PER_FOOT * body.count();
    nominals[stretches.clone()].fill(deflection);
    nominals[stretches.end..].fill(across);
    nominals
}

/// The indicator of a function, as a fraction of its size.
///
/// A function falls through zero only while it falls: the indicator is positive while the function rises, and clearly so right after an
/// event that leaves it at zero. Twice its round-off is added, so that zero itself is no event.
fn indicator(body: &SpaceBody, sample: &SpaceSample) -> f64 {
    let weight = body.mass * body.gravity;
    let size = match sample.function {
        SpaceFunction::LiftOff(_) => weight,
        SpaceFunction::Landing(_) => body.r0,
        SpaceFunction::Slides(_) | SpaceFunction::Sticks(_) => weight * body.friction,
        SpaceFunction::Overturning => 1.0,
    };
    (sample.value.re + 2.0 * sample.rounding).max(sample.value.eps / body.p) / size
}

impl SpaceRun {
    /// Lets the block be stepped from outside from here on.
    pub fn begin_exchange(&mut self) {
        let SpaceState { time, numbers, piece, .. } = &mut self.state;
        let mut last = piece.take().map(|piece| piece.last.1).unwrap_or_default();
        last.clone_from(numbers);
        *piece = Some(SpacePiece { since: *time, last: (*time, last) });
    }

    /// Whether the block is stepped from outside.
    pub fn is_exchanged(&self) -> bool {
        self.state.piece.is_some()
    }

    /// Beginning of the present smooth piece of the excitation (s); the present time of a block that steps itself.
    pub fn piece_time(&self) -> f64 {
        self.state.piece.as_ref().map_or(self.state.time, |piece| piece.since)
    }

    /// Time (s) of the last completed step, or of a later event.
    pub fn last_completed(&self) -> f64 {
        self.state.piece.as_ref().map_or(self.state.time, |piece| piece.last.0)
    }

    /// The time (s) within which the clock of a solver outside does not tell two instants apart.
    pub fn clock_rounding(&self) -> f64 {
        let SpaceBody { omega_v, p, .. } = self.setup.body;
        UNRESOLVED * f64::EPSILON * self.state.time.abs().max(1.0 / omega_v.max(p))
    }

    /// The next time (s) at which a pulse has a kink.
    pub fn next_kink(&self) -> Option<f64> {
        next_kink(&self.setup.pulses, self.state.time)
    }

    /// The continuous states, in memory; without velocities once the block is held.
    pub fn continuous_states(&mut self) -> &[f64] {
        let is_frozen = self.is_frozen();
        let (feet, numbers, states) = (self.setup.body.count(), &self.state.numbers, &mut self.memory.end);
        (0..numbers.len()).for_each(|i| states[place(i, feet)] = numbers[i]);
        if is_frozen {
            states[VELOCITY..FEET_FROM].fill(0.0);
        }
        states
    }

    /// Sets time (s) and continuous states; the contacts stay. A block that is held keeps its velocities, and with them its energies, of the
    /// end of its run.
    ///
    /// `states` has the length of [`SpaceRun::continuous_states`].
    pub fn set_continuous_states(&mut self, states: &[f64]) {
        let (is_frozen, feet) = (self.is_frozen(), self.setup.body.count());
        for (i, number) in self.state.numbers.iter_mut().enumerate() {
            if !(is_frozen && (VELOCITY..FEET_FROM).contains(&i)) {
                *number = states[place(i, feet)];
            }
        }
    }

    /// Sets the time (s) of a block that is stepped from outside.
    pub fn set_outside_time(&mut self, time: f64) {
        if time != self.state.time {
            self.state.events_in_this_instant = 0;
        }
        self.state.time = time;
    }

    /// The derivatives of the continuous states, per second, in memory; zeros once the run has ended.
    pub fn derivatives(&mut self, inputs: &SpaceInputs) -> &[f64] {
        let excitation = self.excitation(inputs);
        let SpaceRun { setup, state, memory } = self;
        let equations = SpaceEquations { body: &setup.body, contacts: &state.contacts, excitation: &excitation };
        equations.write_rates(state.time, &state.numbers, &mut memory.rates);
        let has_ended = state.ending.is_some();
        let (feet, rates, derivatives) = (setup.body.count(), &memory.rates, &mut memory.end);
        (0..rates.len()).for_each(|i| derivatives[place(i, feet)] = if has_ended { 0.0 } else { rates[i] });
        derivatives
    }

    /// The event indicators, in memory: an event is due where one falls to zero.
    pub fn indicators(&mut self, inputs: &SpaceInputs) -> &[f64] {
        let excitation = self.excitation(inputs);
        let feet = self.setup.body.count();
        let SpaceRun { setup, state, memory } = self;
        memory.indicators.fill(IDLE);
        if state.ending.is_none() {
            let equations = SpaceEquations { body: &setup.body, contacts: &state.contacts, excitation: &excitation };
            equations.write_rates(state.time, &state.numbers, &mut memory.rates);
            memory.samples[0].take(&Poised::of(&equations, state.time, &state.numbers, &memory.rates));
            for sample in memory.samples[0].watched() {
                let place = match sample.function {
                    SpaceFunction::LiftOff(foot) | SpaceFunction::Landing(foot) => foot,
                    SpaceFunction::Slides(foot) | SpaceFunction::Sticks(foot) => feet + foot,
                    SpaceFunction::Overturning => PER_CONTACT * feet,
                };
                memory.indicators[place] = indicator(&setup.body, sample);
            }
        }
        &memory.indicators
    }

    /// Begins a new smooth piece of the excitation, and applies all events due: those whose indicators are not positive. `observer` receives
    /// them.
    ///
    /// # Errors
    /// Numbers that are not finite, or events of this instant that do not end.
    pub fn pass_events(
        &mut self,
        inputs: &SpaceInputs,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<(), SimulationError> {
        normalize(&mut self.state.numbers);
        self.begin_exchange();
        let excitation = self.excitation(inputs);
        self.begin(&excitation);
        while self.state.ending.is_none() {
            let SpaceRun { setup, state, memory } = self;
            if !state.numbers.iter().chain(&memory.rates).all(|number| number.is_finite()) {
                return Err(SimulationError::NotFinite { time: state.time });
            }
            memory.inside_rates.copy_from_slice(&memory.rates);
            let mut any = false;
            for (falls, sample) in memory.falls.iter_mut().zip(memory.samples[0].watched()) {
                *falls = indicator(&setup.body, sample) <= 0.0;
                any |= *falls;
            }
            // A foot may not be taken in at its landing.
            if !any || !self.apply_falls(&excitation, observer)? {
                break;
            }
        }
        self.include_present();
        self.complete();
        Ok(())
    }

    /// Includes the greatest values of the step since the last call, unless a number is not finite. `inputs` are linear over it.
    ///
    /// The motion between its ends is that of the block's own step between them. A step longer than the block's own longest one counts by its
    /// ends alone.
    pub fn complete_step(&mut self, inputs: &SpaceInputs) {
        if self.state.ending.is_some() {
            return;
        }
        let excitation = self.excitation(inputs);
        self.begin(&excitation);
        let SpaceRun { setup, state, memory } = self;
        let Some(SpacePiece { last: (last, start), .. }) = &mut state.piece else { return };
        if !memory.rates.iter().chain(&state.numbers).all(|number| number.is_finite()) {
            return;
        }
        let duration = state.time - *last;
        if duration > 0.0 && duration <= memory.limits.longest(three(start, OMEGA).norm()) {
            let equations = SpaceEquations { body: &setup.body, contacts: &state.contacts, excitation: &excitation };
            std::mem::swap(&mut memory.rates, &mut memory.end_rates);
            memory.samples.swap(0, 1);
            equations.write_rates(*last, start, &mut memory.rates);
            memory.stepper.begin(*last, start, &memory.rates);
            memory.stepper.attempt(duration, &equations, &mut memory.end);
            memory.stepper.set_end(&state.numbers, &memory.end_rates);
            let [starts, ends] = &mut memory.samples;
            starts.take(&Poised::of(&equations, *last, start, &memory.rates));
            let mut inside = SpaceInterior {
                equations,
                stepper: &mut memory.stepper,
                time: *last,
                state: &mut memory.inside,
                rates: &mut memory.inside_rates,
                evaluations: 0,
            };
            include_peaks(&mut state.peaks, [starts, ends], duration, &mut inside);
            state.peaks.include_slips(&state.numbers, setup.body.count());
        } else {
            self.include_present();
        }
        self.complete();
    }

    /// Makes the present state that of the last completed step.
    fn complete(&mut self) {
        let SpaceState { time, numbers, piece, .. } = &mut self.state;
        if let Some(SpacePiece { last: (last, start), .. }) = piece {
            *last = *time;
            start.copy_from_slice(numbers);
        }
    }

    /// Includes the values at the present state, whose samples are in memory.
    fn include_present(&mut self) {
        let SpaceRun { setup, state, memory } = self;
        let SpaceState { numbers, peaks, .. } = state;
        peaks.include_motion(&setup.body, &memory.samples[0].of_motion, &memory.samples[0].lean);
        for sample in memory.samples[0].watched() {
            if let Some(peak) = peaks.of_function_mut(sample.function) {
                *peak = peak.max(sample.value.re);
            }
        }
        peaks.include_slips(numbers, setup.body.count());
    }
}
