//! A smooth piece of the excitation → steps, the first event in each, and the change of the block at events.

use crate::numerics::control::{Attempt, eighth_root, shortest, size_factor};
use crate::numerics::dop853::EVALUATIONS_PER_STEP;
use crate::numerics::dual::Dual;
use crate::numerics::roots;
use crate::numerics::stepper::{SliceEquations, Stepper};
use crate::run::{Ending, SimulationError, spend_step};
use crate::space::base::BaseEdge;
use crate::space::equations::SpaceEquations;
use crate::space::events::{Poised, SpaceEvent, SpaceEventKind, SpaceFunction, SpaceSample, change, watched};
use crate::space::excitation::{SpaceExcitation, SpaceInputs};
use crate::space::limits::{SpaceLimits, fastest_number};
use crate::space::motion::{Lean, OMEGA, normalize, of_foot, three};
use crate::space::peaks::{HALF_TILT, OF_MOTION, SpacePeaks, of_motion};
use crate::space::run::SpaceRun;
use crate::space::samples::SpaceSamples;

/// Largest rotation in a step (rad) whose ends alone show whether a foot landed inside, as in the plane.
const SMALL_TURN: f64 = 0.1;

/// Change of the state in a step, over the size of its terms, that is round-off.
const ROUND_OFF: f64 = 1e-13;

/// Maximum number of times that a foot may change within an instant.
const CHANGES_IN_AN_INSTANT: usize = 8;

/// The fall of a watched function through zero.
struct SpaceCrossing {
    /// Its time, in seconds after the beginning of the step.
    elapsed: f64,
    /// The number of the function.
    number: usize,
    /// Whether the function begins at zero and seems to fall at once, against its rate there.
    rise_unseen: bool,
}

/// The motion inside a step.
pub(super) struct SpaceInterior<'a> {
    pub(super) equations: SpaceEquations<'a>,
    pub(super) stepper: &'a mut Stepper,
    pub(super) time: f64,
    pub(super) state: &'a mut [f64],
    pub(super) rates: &'a mut [f64],
    pub(super) evaluations: u64,
}

impl SpaceInterior<'_> {
    /// Moves to `elapsed` seconds after the beginning of the step.
    fn go_to(&mut self, elapsed: f64) -> Poised<'_> {
        self.evaluations += self.stepper.state_at(elapsed, &self.equations, self.state) + 1;
        let time = self.time + elapsed;
        self.equations.write_rates(time, self.state, self.rates);
        Poised::of(&self.equations, time, self.state, self.rates)
    }

    fn sample(&mut self, function: SpaceFunction, elapsed: f64) -> Dual {
        self.go_to(elapsed).sample(function).value
    }

    /// Returns the quantities of the body's motion with a peak.
    fn of_motion(&mut self, elapsed: f64) -> [Dual; OF_MOTION] {
        let now = self.go_to(elapsed);
        of_motion(now.body, now.motion())
    }

    /// Returns the tilt over that over an edge, in the direction of the lean.
    fn tilt_over(&mut self, edge: &BaseEdge, elapsed: f64) -> Dual {
        let now = self.go_to(elapsed);
        edge.tilt_over_critical(&now.motion().turn.lean(), now.body.center_height)
    }
}

/// A step in which functions are searched for their falls.
struct Searched {
    /// Its size (s).
    duration: f64,
    /// The longest step (s).
    longest: f64,
    /// Whether the body turns so far that heights of feet between the ends do not follow from those at the ends.
    turns_far: bool,
}

/// Returns the time of the first fall of a function in a step, and whether it seems to fall at once against its rate.
fn first_fall(
    [start, end]: [&SpaceSample; 2],
    &Searched { duration, longest, turns_far }: &Searched,
    inside: &mut SpaceInterior,
) -> Option<(f64, bool)> {
    let (function, rounding) = (start.function, start.rounding.max(end.rounding));
    let (start, end) = (start.value, end.value);
    let hidden = turns_far
        && match function {
            SpaceFunction::Landing(_) | SpaceFunction::Overturning => true,
            SpaceFunction::LiftOff(_) | SpaceFunction::Slides(_) | SpaceFunction::Sticks(_) => false,
        };
    if !hidden && !roots::may_fall(start, end, rounding, duration) {
        return None;
    }
    let mut sample = |elapsed| inside.sample(function, elapsed);
    if start.eps < 0.0 && roots::leaves_downwards(start, rounding, duration, &mut sample) {
        return Some((0.0, false));
    }
    // |F| has kinks where F is small.
    let (pieces, bounded) = match function {
        SpaceFunction::LiftOff(_) | SpaceFunction::Landing(_) | SpaceFunction::Overturning if !hidden => {
            (roots::pieces(duration / longest), true)
        }
        SpaceFunction::LiftOff(_)
        | SpaceFunction::Landing(_)
        | SpaceFunction::Overturning
        | SpaceFunction::Slides(_)
        | SpaceFunction::Sticks(_) => (roots::PIECES, false),
    };
    let elapsed = roots::first_fall(start, end, rounding, duration, pieces, bounded, &mut sample)?;
    Some((elapsed, elapsed == 0.0 && start.re >= -rounding))
}

/// Returns the first fall of a watched function in a step.
fn first_crossing(
    [starts, ends]: [&SpaceSamples; 2],
    searched: &Searched,
    inside: &mut SpaceInterior,
) -> Option<SpaceCrossing> {
    let mut first: Option<SpaceCrossing> = None;
    for (number, (start, end)) in starts.watched().iter().zip(ends.watched()).enumerate() {
        if let Some((elapsed, rise_unseen)) = first_fall([start, end], searched, inside)
            && first.as_ref().is_none_or(|earliest| elapsed < earliest.elapsed)
        {
            first = Some(SpaceCrossing { elapsed, number, rise_unseen });
        }
    }
    first
}

/// Includes the tilts over the critical ones in a step of this duration (s), with the leans at its ends.
///
/// Over one edge it is smooth, and the greatest over all edges is that over the edge ahead. Edges over which it may pass the peak are searched.
fn include_tilt_over_critical(
    peaks: &mut SpacePeaks,
    [start, end]: [&Lean<Dual>; 2],
    duration: f64,
    inside: &mut SpaceInterior,
) {
    let body = inside.equations.body;
    for edge in &body.edges {
        let harmless = peaks.harmless_tangent_ratio(body);
        let [first, last] = [start, end].map(|lean| edge.excess(harmless, lean, body.center_height));
        if roots::may_pass(0.0, first, last, duration) {
            let [first, last] = [start, end].map(|lean| edge.tilt_over_critical(lean, body.center_height));
            let mut tilt = |elapsed| inside.tilt_over(edge, elapsed);
            let peak = &mut peaks.tilt_over_critical;
            *peak = roots::greatest(*peak, first, last, duration, &mut tilt);
        }
    }
}

/// Includes the values of a step of this duration (s), with the samples at its ends.
pub(super) fn include_peaks(
    peaks: &mut SpacePeaks,
    [starts, ends]: [&SpaceSamples; 2],
    duration: f64,
    inside: &mut SpaceInterior,
) {
    let harmless = peaks.harmless_half_tilt_square(inside.equations.body);
    if roots::may_pass(harmless, starts.of_motion[HALF_TILT], ends.of_motion[HALF_TILT], duration) {
        include_tilt_over_critical(peaks, [&starts.lean, &ends.lean], duration, inside);
    }
    for (i, (&start, &end)) in starts.of_motion.iter().zip(&ends.of_motion).enumerate() {
        let peak = peaks.of_motion_mut(i);
        *peak = roots::greatest(*peak, start, end, duration, &mut |elapsed| inside.of_motion(elapsed)[i]);
    }
    for (start, end) in starts.watched().iter().zip(ends.watched()) {
        if let Some(peak) = peaks.of_function_mut(start.function) {
            let mut sample = |elapsed| inside.sample(start.function, elapsed);
            *peak = roots::greatest(*peak, start.value, end.value, duration, &mut sample);
        }
    }
}

impl SpaceRun {
    /// Steps over a smooth piece of the excitation to `stop` (s), to the first event later than `after` (s), or to the end of the run.
    pub(super) fn smooth_piece(
        &mut self,
        stop: f64,
        after: f64,
        inputs: &SpaceInputs,
        budget: &mut u64,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<(), SimulationError> {
        let excitation = self.excitation(inputs);
        self.begin(&excitation);
        let is_steady = excitation.is_constant();
        while self.state.time < stop && self.state.ending.is_none() && self.state.last_event <= after {
            if is_steady && self.rests() {
                self.state.move_clock(stop);
                break;
            }
            self.step(stop, &excitation, budget, observer)?;
        }
        Ok(())
    }

    /// Whether the block is at rest: no rate changes the state by more than round-off in a step.
    fn rests(&self) -> bool {
        let SpaceLimits { weights, longest } = &self.memory.limits;
        let scale = longest * self.setup.settings.tolerance;
        weights.iter().zip(&self.memory.rates).all(|(weight, rate)| (weight * rate * scale).abs() <= ROUND_OFF)
    }

    /// Evaluates the present state, under new contacts or a new excitation.
    pub(super) fn begin(&mut self, excitation: &SpaceExcitation) {
        let SpaceRun { setup, state, memory } = self;
        memory.limits.set(&setup.body, &state.contacts, setup.settings.tolerance, excitation.frequency());
        let equations = SpaceEquations { body: &setup.body, contacts: &state.contacts, excitation };
        equations.write_rates(state.time, &state.numbers, &mut memory.rates);
        state.counts.evaluations += 1;
        memory.samples[0].take(&Poised::of(&equations, state.time, &state.numbers, &memory.rates));
    }

    /// Takes a step to its first event or its end.
    fn step(
        &mut self,
        stop: f64,
        excitation: &SpaceExcitation,
        budget: &mut u64,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<(), SimulationError> {
        let time = self.state.time;
        let omega = three(&self.state.numbers, OMEGA).norm();
        let longest = self.memory.limits.longest(omega);
        spend_step(budget, [time, stop], longest, || fastest_number(&self.setup.body, &self.state.contacts))?;
        let attempt = self.accepted_step(stop, longest, excitation)?;
        let end_time = if attempt.last { stop } else { time + attempt.size };
        let SpaceRun { setup, state, memory } = self;
        let equations = SpaceEquations { body: &setup.body, contacts: &state.contacts, excitation };
        normalize(&mut memory.end);
        equations.write_rates(end_time, &memory.end, &mut memory.end_rates);
        state.counts.evaluations += 1;
        // Without early ends, which compilers do not vectorize.
        let are_finite = |numbers: &[f64]| numbers.iter().fold(true, |all, number| all & number.is_finite());
        if !(are_finite(&memory.end) && are_finite(&memory.end_rates)) {
            return Err(SimulationError::NotFinite { time });
        }
        memory.stepper.set_end(&memory.end, &memory.end_rates);
        memory.samples[1].take(&Poised::of(&equations, end_time, &memory.end, &memory.end_rates));
        let mut inside = SpaceInterior {
            equations,
            stepper: &mut memory.stepper,
            time,
            state: &mut memory.inside,
            rates: &mut memory.inside_rates,
            evaluations: 0,
        };
        let omega_after = three(&memory.end, OMEGA).norm();
        let turns_far = attempt.size * omega.max(omega_after) > SMALL_TURN;
        let searched = Searched { duration: attempt.size, longest, turns_far };
        let [starts, ends] = &mut memory.samples;
        let mut first = first_crossing([starts, ends], &searched, &mut inside);
        if let Some(SpaceCrossing { rise_unseen: true, elapsed, .. }) = &mut first {
            if roots::may_shorten(time, attempt.size, longest) {
                state.counts.evaluations += inside.evaluations;
                state.counts.rejected += 1;
                state.counts.steps -= 1;
                state.control.restart(roots::SHORTENED * attempt.size);
                return Ok(());
            }
            *elapsed = attempt.size;
        }
        let duration = first.as_ref().map_or(attempt.size, |crossing| crossing.elapsed);
        let is_inside = duration < attempt.size;
        if is_inside {
            ends.take(&inside.go_to(duration));
        }
        include_peaks(&mut state.peaks, [starts, ends], duration, &mut inside);
        if is_inside {
            inside.go_to(duration);
        }
        state.counts.evaluations += inside.evaluations;
        state.numbers.copy_from_slice(if is_inside { &memory.inside } else { &memory.end });
        state.peaks.include_slips(&state.numbers, setup.body.count());
        state.move_clock(if is_inside { time + duration } else { end_time });
        if let Some(SpaceCrossing { number, .. }) = first {
            normalize(&mut state.numbers);
            return self.apply(number, duration, excitation, observer);
        }
        std::mem::swap(&mut memory.rates, &mut memory.end_rates);
        memory.samples.swap(0, 1);
        Ok(())
    }

    /// Takes a step within the tolerance, whose end is in memory.
    fn accepted_step(
        &mut self,
        stop: f64,
        longest: f64,
        excitation: &SpaceExcitation,
    ) -> Result<Attempt, SimulationError> {
        let SpaceRun { setup, state, memory } = self;
        let equations = SpaceEquations { body: &setup.body, contacts: &state.contacts, excitation };
        let time = state.time;
        let shortest = shortest(time, longest);
        let mut attempt = state.control.attempt(stop - time, longest, shortest);
        memory.stepper.begin(time, &state.numbers, &memory.rates);
        loop {
            memory.stepper.attempt(attempt.size, &equations, &mut memory.end);
            state.counts.evaluations += EVALUATIONS_PER_STEP;
            let error = memory.stepper.error(&memory.limits.weights);
            let factor = size_factor(eighth_root(error));
            if error <= 1.0 {
                state.control.accept(&attempt, factor, longest);
                state.counts.steps += 1;
                return Ok(attempt);
            }
            state.counts.rejected += 1;
            attempt = state.control.reject(&attempt, factor);
            if attempt.size < shortest {
                let tolerance = setup.settings.tolerance;
                return Err(if error.is_finite() && memory.rates.iter().all(|rate| rate.is_finite()) {
                    SimulationError::StepTooSmall { time, size: attempt.size, tolerance }
                } else {
                    SimulationError::NotFinite { time }
                });
            }
        }
    }

    /// Applies the event of a function that fell through zero after `elapsed` seconds, and all others in the same instant.
    fn apply(
        &mut self,
        number: usize,
        elapsed: f64,
        excitation: &SpaceExcitation,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<(), SimulationError> {
        self.find_falls(number, elapsed, excitation);
        self.apply_falls(excitation, observer)?;
        Ok(())
    }

    /// Applies the events of the watched functions that fall, whose rates are those inside a step in memory. Returns whether any happened.
    pub(super) fn apply_falls(
        &mut self,
        excitation: &SpaceExcitation,
        observer: &mut dyn FnMut(&SpaceEvent),
    ) -> Result<bool, SimulationError> {
        let SpaceRun { setup, state, memory } = self;
        let time = state.time;
        state.events_in_this_instant += 1;
        if state.events_in_this_instant > CHANGES_IN_AN_INSTANT * setup.body.count() {
            return Err(SimulationError::NoRegime { time, count: state.events_in_this_instant as u32 });
        }
        // The functions of a foot are next to each other, its lift-off first.
        let (mut number, mut any) = (0, false);
        for foot in 0..setup.body.count() {
            let contact = state.contacts[foot];
            let functions = watched(&setup.body, foot, &contact);
            let count = functions.iter().flatten().count();
            let falls = &memory.falls[number..number + count];
            number += count;
            let Some(function) =
                functions.iter().flatten().zip(falls).find_map(|(&function, &falls)| falls.then_some(function))
            else {
                continue;
            };
            let Some((foot, change)) = change(&setup.body, time, &state.numbers, function) else { continue };
            if contact.touches() != change.contact.touches() {
                state.numbers[of_foot(foot)..of_foot(foot) + 2].fill(0.0);
            }
            any = true;
            state.contacts[foot] = change.contact;
            state.lift_off_energy += change.lost;
            for kind in change.events.into_iter().flatten() {
                state.last_event = time;
                state.counts.add(kind);
                observer(&SpaceEvent { time, kind });
            }
        }
        if memory.falls[number] {
            any = true;
            state.ending = Some((Ending::Overturned, time));
            state.last_event = time;
            observer(&SpaceEvent { time, kind: SpaceEventKind::Overturning });
        }
        state.note_separation(setup);
        self.begin(excitation);
        Ok(any)
    }

    /// Finds the watched functions that fall through zero at the present state, beside the one with this number.
    ///
    /// A function that began the step at zero, after an event, is left out: it falls when it has left zero.
    fn find_falls(&mut self, number: usize, elapsed: f64, excitation: &SpaceExcitation) {
        let SpaceRun { setup, state, memory } = self;
        let equations = SpaceEquations { body: &setup.body, contacts: &state.contacts, excitation };
        equations.write_rates(state.time, &state.numbers, &mut memory.inside_rates);
        let [starts, ends] = &mut memory.samples;
        ends.take(&Poised::of(&equations, state.time, &state.numbers, &memory.inside_rates));
        memory.falls.fill(false);
        for ((falls, start), end) in memory.falls.iter_mut().zip(starts.watched()).zip(ends.watched()) {
            let began_above = start.value.re > start.rounding;
            *falls = elapsed > 0.0 && began_above && end.value.re <= end.rounding && end.value.eps < 0.0;
        }
        memory.falls[number] = true;
    }
}
