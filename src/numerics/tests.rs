//! Steps of both orders on an oscillator, whose motion is known, and the step rule on errors that follow a power of the step.

use crate::numerics::control::{
    Attempt, LONGEST, ShortStepTo, StepControl, eighth_root, is_resolved, near_a_peak, short_factor, shortest,
    size_factor,
};
use crate::numerics::dop853::{self, DenseOutput, DenseStep, evaluate, polynomial};
use crate::numerics::numbers::Numbers;
use crate::numerics::repeat::{StateRate, StepForm, repeat_step};
use crate::numerics::short::{self, ShortStep};
use crate::numerics::{Equations, Quadratures, Rate, StageRates, State};

/// Beginning of the steps (s).
const START: f64 = 0.3;

/// A free oscillator, and another one under a force that depends on time alone.
struct Oscillators;

impl Equations for Oscillators {
    fn rate(&self, time: f64, state: &State) -> Rate {
        let [x, x_dot, _, y_dot] = state.0;
        let quadratures = Quadratures::from([x * x, y_dot * libm::cos(time)]);
        Rate { state: State::from([x_dot, -x, y_dot, -4.0 * libm::sin(2.0 * time)]), quadratures }
    }
}

impl StateRate<State> for Oscillators {
    fn state_rate(&self, time: f64, state: &State) -> State {
        self.rate(time, state).state
    }
}

/// The state at a time, and the integrals of the quadratures from 0 to then.
fn exact(time: f64) -> (State, Quadratures) {
    let ((sin, cos), (sin2, cos2)) = (libm::sincos(time), libm::sincos(2.0 * time));
    let works = [0.5 * time + 0.25 * sin2, sin + libm::sin(3.0 * time) / 3.0];
    (State::from([cos, -sin, sin2, 2.0 * cos2]), works.into())
}

/// The distance from the exact state, and from the exact works since the beginning.
fn off(time: f64, state: State, work: Quadratures) -> [f64; 2] {
    let ((exact, end), (_, start)) = (exact(time), exact(START));
    [(state - exact).norm(), (work - (end - start)).norm()]
}

/// Checks that halving a step divides each error by about `2^order`.
#[track_caller]
fn falls<const N: usize>(order: i32, errors: impl Fn(f64) -> [f64; N], size: f64) {
    for (coarse, fine) in errors(size).into_iter().zip(errors(0.5 * size)) {
        let found = (coarse / fine).log2();
        assert!((found - f64::from(order)).abs() < 0.35, "{coarse} and {fine}: order {found}, not {order}");
    }
}

fn step(size: f64) -> DenseStep {
    let start = exact(START).0;
    DenseStep::attempt(START, size, start, Oscillators.rate(START, &start), &Oscillators)
}

#[test]
fn a_step_has_order_eight_and_its_dense_output_seven() {
    let end = |size: f64| {
        let step = step(size);
        off(step.end_time, step.end, step.work)
    };
    falls(9, end, 0.4);
    falls(8, |size| [step(size).error(State::from([1.0; 4]))], 0.1);
    for part in [0.2, 0.5, 0.9] {
        let inside = |size: f64| {
            let step = step(size);
            let dense = step.dense(Oscillators.rate(step.end_time, &step.end), &Oscillators);
            off(START + part * size, dense.state(part * size), dense.work(part * size))
        };
        falls(8, inside, 0.4);
    }
}

/// Between known states displacements have order 5, velocities and works 3.
#[test]
fn the_motion_between_two_states_matches_both() {
    for part in [0.2, 0.5, 0.9] {
        let inside = |size: f64| {
            let ends = [START, START + size].map(|time| (exact(time).0, Oscillators.rate(time, &exact(time).0)));
            let work = exact(START + size).1 - exact(START).1;
            let between = DenseOutput::between(START, size, ends, work);
            let (time, state) = (START + part * size, between.state(part * size) - exact(START + part * size).0);
            let [_, works] = off(time, between.state(part * size), between.work(part * size));
            ([state[0].abs(), state[2].abs()], [state[1].abs(), state[3].abs(), works])
        };
        falls(6, |size| inside(size).0, 0.05);
        falls(4, |size| inside(size).1, 0.05);
    }
}

#[test]
fn a_short_step_has_order_five() {
    let start = exact(START).0;
    let step = |size| ShortStep::attempt(START, size, start, Oscillators.rate(START, &start), &Oscillators);
    let end = |size: f64| {
        let step = step(size);
        off(START + size, step.end, step.work)
    };
    falls(6, end, 0.05);
    let error = |size: f64| {
        let step = step(size);
        [step.error(Oscillators.rate(START + size, &step.end), State::from([1.0; 4]), 1.0)]
    };
    falls(5, error, 0.1);
    // Errors of the state and of the works count as one vector.
    let of = |weight, work_weight| {
        let step = step(0.1);
        step.error(Oscillators.rate(START + 0.1, &step.end), State::from([weight; 4]), work_weight)
    };
    assert!((of(2.0, 3.0).powi(2) - of(2.0, 0.0).powi(2) - of(0.0, 3.0).powi(2)).abs() < 1e-12 * of(2.0, 3.0).powi(2));
}

/// Loops over the stages, and steps that are repeated without quadratures, have the same bits.
#[test]
fn all_forms_of_a_step_have_the_same_bits() {
    let (start, size) = (exact(START).0, 0.7);
    let first = Oscillators.rate(START, &start);
    let step = step(size);
    let mut rates = StageRates::beginning_with(first);
    assert_eq!((step.end, step.work), dop853::attempt_in_loop(START, size, start, &mut rates, &Oscillators));
    let times = [START, START + 0.25, START + 0.6];
    let dense = step.dense(Oscillators.rate(step.end_time, &step.end), &Oscillators);
    let (end, stages) = repeat_step(StepForm::Dense, [START, size], start, &Oscillators);
    assert_eq!([step.end; 2], [end, repeat_step(StepForm::Long, [START, size], start, &Oscillators).0]);
    let inside = polynomial(start, end - start, size, &stages);
    assert_eq!(times.map(|time| evaluate(&inside, (time - START) / size)), times.map(|time| dense.state(time - START)));
    let step = ShortStep::attempt(START, size, start, first, &Oscillators);
    let mut rates = StageRates::beginning_with(first);
    assert_eq!((step.end, step.work), short::attempt_in_loop(START, size, start, &mut rates, &Oscillators));
    assert_eq!(step.end, repeat_step(StepForm::Short, [START, size], start, &Oscillators).0);
}

/// A step of size h has the error `(h/h0)⁸`. Steps come close to h0 after few attempts, and end at the stop.
#[test]
fn the_step_rule_finds_the_step_that_the_error_allows() {
    for (allowed, longest, first) in [(1e-3, 1.0, 1.0), (0.3, 1.0, 1.0), (0.3, 1.0, 1e-3), (2.0, 0.5, 0.5)] {
        let (stop, mut time, mut control) = (100.0 * allowed, 0.0, StepControl::NEW);
        control.restart(first);
        let (mut accepted, mut rejected) = (0, 0);
        while time < stop {
            let mut attempt = control.attempt(stop - time, longest, shortest(time, stop));
            let mut failed = false;
            let factor = loop {
                assert!(attempt.size <= longest * (1.0 + 1e-15) && attempt.size > 0.0);
                let error = (attempt.size / allowed).powi(8);
                let factor = size_factor(eighth_root(error));
                if error <= 1.0 {
                    break factor;
                }
                rejected += 1;
                failed = true;
                let next = control.reject(&attempt, factor);
                assert!(next.size < attempt.size && !next.last);
                attempt = next;
            };
            control.accept(&attempt, factor, longest);
            accepted += 1;
            time = if attempt.last { stop } else { time + attempt.size };
            let next = control.attempt(1e9, longest, 0.0);
            assert!(!failed || next.size <= attempt.size * (1.0 + 1e-6), "it grows right after a failure");
        }
        let least = (stop / allowed.min(longest)).ceil();
        assert!(f64::from(accepted) <= 6.0 + least / 0.9 && rejected <= 10, "{accepted} of {least}, {rejected}");
        control.restart(1e-5);
        assert_eq!(control.attempt(1.0, longest, 0.0).size, 1.0 / 1e5_f64);
    }
    let Attempt { size, last, .. } = StepControl::NEW.attempt(3.0, 1.0, 0.0);
    assert!(size == 1.0 && !last);
    assert_eq!(StepControl::NEW.attempt(0.9, 1.0, 0.0), Attempt::to_stop(0.9));
}

/// A step shortened to meet a stop does not shorten later ones. One with too great an error does.
#[test]
fn a_short_way_to_a_stop_leaves_the_step() {
    let mut control = StepControl::NEW;
    control.restart(0.25);
    let last = control.attempt(0.01, 1.0, 0.0);
    assert_eq!(last, Attempt::to_stop(0.01));
    control.accept(&last, 6.0, 1.0);
    assert_eq!(control.attempt(0.25, 1.0, 0.0), Attempt::to_stop(0.25));
    control.accept(&last, 0.95, 1.0);
    assert!(control.attempt(0.25, 1.0, 0.0).size < 0.01);
}

/// A short step reaches a stop within half the longest step. After it has failed, it waits until the part of its size that its error
/// allows, at least a tenth, has grown to the distance again.
#[test]
fn short_steps_are_tried_where_they_may_succeed() {
    let (longest, mut control) = (1.0_f64, StepControl::NEW);
    let [near, far] = [0.5 * longest, (0.5 * longest).next_up()];
    let tried = |control: &StepControl, remaining| control.short_step(remaining, longest);
    assert_eq!((tried(&control, near), tried(&control, far)), (ShortStepTo::Stop, ShortStepTo::TooFar));
    for (factor, part) in [(0.5, 0.5), (1e-3, 0.1)] {
        control.reject_short(near, factor);
        assert_eq!(tried(&control, part * near), ShortStepTo::Stop);
        assert_eq!(tried(&control, part * near * (1.0 + 1e-9)), ShortStepTo::NotYet);
        let mut waits = 0;
        while tried(&control, near) == ShortStepTo::NotYet {
            let longer = control.attempt(near, longest, 0.0).instead_of(ShortStepTo::NotYet);
            control.accept(&longer, 1.0, longest);
            waits += 1;
        }
        assert_eq!(f64::from(waits), (-f64::ln(part) / f64::ln(1.1)).ceil());
    }
}

/// Sizes of a deserialized rule are positive.
#[test]
fn a_rule_without_sizes_is_not_valid() {
    assert!(StepControl::NEW.is_valid());
    for size in [0.0, -1.0, f64::NAN] {
        let (mut one, mut other) = (StepControl::NEW, StepControl::NEW);
        one.restart(size);
        other.reject_short(size, 1.0);
        assert!(!one.is_valid() && !other.is_valid(), "{size}");
    }
}

/// The sums of the squares of 1 to n.
#[test]
fn squares_are_summed() {
    assert_eq!(5.0, Numbers([1.0, 2.0]).square());
    assert_eq!(30.0, Numbers([1.0, 2.0, 3.0, 4.0]).square());
    assert_eq!(204.0, Numbers([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]).square());
}

/// The factor turns an error of order 8 into 0.9⁸, within limits. That of a short step meets the allowed error.
#[test]
fn factors_bring_errors_to_the_allowed_one() {
    for error in [1e-4, 0.3, 1.0, 20.0] {
        let factor = size_factor(eighth_root(error));
        assert!((error * factor.powi(8) / 0.9_f64.powi(8) - 1.0).abs() < 1e-13, "{error}: {factor}");
        let short: f64 = short_factor(error);
        assert!((short < 1.0) == (error > 1.0) && (short.powi(4) * error - 1.0).abs() < 1e-14, "{error}: {short}");
    }
    assert_eq!([0.0, 1e9, f64::NAN].map(size_factor), [6.0, 1.0 / 3.0, 1.0 / 3.0]);
}

/// The shortest step is the spacing of the clock's numbers after the longest one, which the clock resolves unless it is too late.
#[test]
fn the_clock_resolves_the_shortest_step() {
    for time in [1.0, 8.0, 1024.0] {
        assert!(time + shortest(time, 0.0) > time && time + 0.4 * shortest(time, 0.0) == time);
        assert_eq!(shortest(0.0, time), shortest(time, 0.0));
    }
    assert!(shortest(0.0, 0.0) > 0.0);
    let spacing = f64::EPSILON;
    assert!(is_resolved(1.0, 2.0 * spacing) && !is_resolved(1.0, spacing) && !is_resolved(1.0, 0.5 * spacing));
    assert!(is_resolved(4.0, 8.0 * spacing) && !is_resolved(4.0, 2.0 * spacing));
}

/// A step around a sinusoid's peak has an end above the limit of a search.
#[test]
fn a_peak_inside_a_step_is_near_at_its_ends() {
    for i in 0..=100 {
        let phase = LONGEST * f64::from(i) / 100.0;
        let near = near_a_peak(phase * 0.05, 0.05 * LONGEST);
        assert!(near <= libm::cos(0.5 * phase) && near >= 0.5, "{phase}: {near}");
    }
    assert_eq!(near_a_peak(0.0, 1.0), 1.0);
}
