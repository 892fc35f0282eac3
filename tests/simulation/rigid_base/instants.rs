//! The first instant of a run, of a pulse and after a jump of inputs, against closed forms.
//!
//! A block of half width b and half height h that starts to turn about a corner has `θ̈ = p² (cos α |a_gx|/g − sin α)`,
//! `N = M (g + b |θ̈|)` and `H = M (a_gx + h θ̈)`, with θ̈ < 0 for a_gx > 0.

use rocking_block::block::{Block, Body, Corner, Regime};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Ending, Initial, OnSeparation, Simulation};
use rocking_block::system::events::EventKind;

use super::{G, block, close, go, held, seen, start};

/// Three times the acceleration that lifts the block.
const PUSH: f64 = 7.27;

fn one_cosine(amplitude: f64, start: f64) -> Pulse {
    Pulse { shape: PulseShape::OneCosine, amplitude, period: 1.0, start, ..Pulse::NONE }
}

fn at_rest(block: Block, pulse: Pulse, inputs: &Inputs) -> Simulation {
    start(block, OnSeparation::Terminate, pulse, &Initial::default(), inputs)
}

/// Checks that the block turns away from a push `a_x` (m/s²) under the gravity `g_z` (m/s²).
#[track_caller]
fn turns(seen: &Observation<f64>, block: &Block, a_x: f64, g_z: f64) {
    let size = block.p * block.p * (block.alpha.cos() * a_x.abs() - block.alpha.sin() * g_z) / G;
    let n = block.mass * (g_z + block.b * size);
    let (theta_ddot, regime, reaction) = match a_x > 0.0 {
        true => (-size, Regime::TiltingLeft, [n, 0.0]),
        false => (size, Regime::TiltingRight, [0.0, n]),
    };
    assert_eq!((seen.regime, seen.theta, seen.theta_dot, seen.u_dot), (regime, 0.0, 0.0, 0.0));
    close(seen.theta_ddot, theta_ddot, theta_ddot);
    close(seen.v_ddot, block.b * size, block.b * size);
    close(seen.u_ddot, block.h * theta_ddot, block.h * theta_ddot);
    close(seen.horizontal, block.mass * (a_x + block.h * theta_ddot), block.mass * a_x);
    for (found, exact) in seen.reaction.into_iter().zip(reaction) {
        close(found, exact, n);
    }
}

#[test]
fn a_block_that_must_lift_at_the_first_instant_has_lifted() {
    let block = block(0.25, 1.0, 0.0);
    for side in [1.0, -1.0] {
        let mut simulation = at_rest(block, one_cosine(side * PUSH, 0.0), &Inputs::default());
        let first = seen(&simulation);
        turns(&first, &block, side * PUSH, G);
        let greatest = first.reaction[0].max(first.reaction[1]);
        assert!((greatest - 10_667.0).abs() < 1.0, "{greatest}");
        // The push decays, and the reaction with it.
        let events = go(&mut simulation, 0.2, &Inputs::default());
        assert_eq!(simulation.peaks().reaction, greatest);
        let lifted = if side > 0.0 { Corner::Right } else { Corner::Left };
        assert_eq!(events.len(), 1);
        assert_eq!((events[0].time, events[0].kind), (0.0, EventKind::LiftOff(lifted)));
        assert_eq!(simulation.counts().liftoffs, 1);
    }
}

#[test]
fn inputs_and_loads_lift_as_a_pulse_does() {
    let block = block(0.25, 1.0, 0.0);
    let force = Inputs { f_x: Ramp::held(-block.mass * PUSH), ..Inputs::default() };
    for inputs in [held(PUSH, 0.0), force] {
        turns(&at_rest(block, Pulse::NONE, &inputs).observe(&inputs), &block, PUSH, G);
    }
    // Too little to lift the block, unless the ground falls.
    turns(&at_rest(block, Pulse::NONE, &held(2.0, -3.0)).observe(&held(2.0, -3.0)), &block, 2.0, G - 3.0);
    // M_y > M g b.
    let moment = 1.2 * block.mass * G * block.b;
    let inputs = Inputs { m_y: Ramp::held(moment), ..Inputs::default() };
    let turned = at_rest(block, Pulse::NONE, &inputs).observe(&inputs);
    let inertia = block.mass * 4.0 / 3.0 * block.r0 * block.r0;
    close(turned.theta_ddot, (moment - block.mass * G * block.b) / inertia, turned.theta_ddot);
    assert_eq!((turned.regime, turned.reaction[0]), (Regime::TiltingRight, 0.0));
}

/// Just below `|a_gx| = (g + a_gz) tan α` the block stays, and the reactions balance weight and push.
#[test]
fn the_limit_of_lifting_is_that_of_statics() {
    let block = block(0.25, 1.0, 0.0);
    for a_gz in [0.0, -5.0, 8.0] {
        let limit = (G + a_gz) * block.alpha.tan();
        for (part, regime) in [(1.0 - 1e-9, Regime::FullContact), (1.0 + 1e-9, Regime::TiltingLeft)] {
            let inputs = held(part * limit, a_gz);
            let seen = at_rest(block, Pulse::NONE, &inputs).observe(&inputs);
            assert_eq!(seen.regime, regime, "a_gz = {a_gz}, {part} of the limit");
            assert!(seen.reaction.iter().all(|&n| n >= 0.0), "{seen:?}");
            let weight = block.mass * (G + a_gz);
            assert!(((seen.reaction[0] + seen.reaction[1]) / weight - 1.0).abs() < 1e-8, "{seen:?}");
            assert!((seen.base_moment / (block.mass * block.h * part * limit) - 1.0).abs() < 1e-8, "{seen:?}");
        }
    }
}

/// Under one sine the block lifts where that reaches `g tan α`, after few evaluations, and its forces until then are those of statics.
#[test]
fn a_block_at_rest_lifts_where_a_pulse_reaches_the_limit_of_statics() {
    for (amplitude, period) in [(4.0, 1.0), (-3.0, 0.2), (2.6, 40.0)] {
        let block = block(0.25, 1.0, 0.0);
        let limit = block.gravity * block.alpha.tan();
        let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.1, ..Pulse::NONE };
        let mut simulation = at_rest(block, pulse, &Inputs::default());
        let mut events = Vec::new();
        let until = 0.1 + 0.3 * period;
        simulation.advance_to_event(until, 0.0, &Inputs::default(), &mut |event| events.push(*event)).unwrap();
        let exact = 0.1 + (limit / f64::abs(amplitude)).asin() * period / std::f64::consts::TAU;
        close(simulation.time(), exact, exact);
        assert!(events.is_empty() && simulation.is_at_event());
        let peaks = simulation.peaks();
        close(peaks.horizontal, block.mass * limit, block.mass * limit);
        close(peaks.reaction, block.mass * block.gravity, block.mass * block.gravity);
        close(peaks.friction_demand, block.alpha.tan(), 1.0);
        assert!(simulation.counts().evaluations < 20, "{:?}", simulation.counts());
    }
}

/// The same while the vertical acceleration and a moment change: `N = M [(g + a_z) b ± (h a_x − m_y/M)]/(2 b)`.
///
/// The first block stays, and its forces peak inside the step; each of the others lifts, the last two where both reactions come
/// to zero within the same step.
#[test]
fn a_block_at_rest_lifts_at_the_first_zero_of_a_reaction() {
    let block = block(0.25, 1.0, 0.0);
    let Body { mass, gravity, b, h, .. } = block.body;
    let falls = Ramp { value: 0.0, rate: -20.0 * gravity };
    for (a_p, period, [a_z, m]) in [
        (1.5, 1.0, [Ramp { value: 0.0, rate: -3.0 }, Ramp { value: 0.0, rate: 5.0 }]),
        (4.0, 1.0, [Ramp { value: -0.5, rate: 1.0 }, Ramp { value: 0.3, rate: -2.0 }]),
        (-4.0, 0.2, [Ramp { value: 0.5, rate: -4.0 }, Ramp { value: 0.3, rate: 3.0 }]),
        (4.0, 1.0, [falls, Ramp::default()]),
        (-4.0, 1.0, [falls, Ramp::default()]),
    ] {
        let push = |time: f64| a_p * (std::f64::consts::TAU * time / period).sin();
        let reactions = |time: f64| {
            let weight = (gravity + a_z.value + a_z.rate * time) * b;
            let moment = h * push(time) - m.value - m.rate * time;
            [weight + moment, weight - moment].map(|n| mass * n / (2.0 * b))
        };
        let lifting = usize::from(a_p > 0.0);
        let [mut exact, mut lifted] = [0.0, 0.3 * period];
        while lifted - exact > 1e-15 {
            let middle = 0.5 * (exact + lifted);
            if reactions(middle)[lifting] > 0.0 { exact = middle } else { lifted = middle }
        }
        let pulse = Pulse { shape: PulseShape::OneSine, amplitude: a_p, period, ..Pulse::NONE };
        let inputs =
            Inputs { a_gz: a_z, m_y: Ramp { value: mass * m.value, rate: mass * m.rate }, ..Inputs::default() };
        let mut simulation = at_rest(block, pulse, &inputs);
        simulation.advance_to_event(0.3 * period, 0.0, &inputs, &mut |event| panic!("{event}")).unwrap();
        close(simulation.time(), exact, exact);
        assert!(simulation.counts().evaluations < 20, "{:?}", simulation.counts());
        let lift_off = EventKind::LiftOff(Corner::BOTH[lifting]);
        assert_eq!(simulation.is_at_event(), a_p != 1.5);
        simulation.apply_pending_event(&inputs, &mut |event| assert_eq!(event.kind, lift_off)).unwrap();
        let times = || (0..=10_000).map(|i| exact * f64::from(i) / 10_000.0);
        let greatest = |of: &dyn Fn(f64) -> f64| times().map(of).fold(0.0, f64::max);
        let demand = |time: f64| mass * push(time).abs() / reactions(time).iter().sum::<f64>();
        let peaks = simulation.peaks();
        for (found, sampled) in [
            (peaks.reaction, greatest(&|time| reactions(time)[1 - lifting])),
            (peaks.horizontal, greatest(&|time| mass * push(time).abs())),
            (peaks.friction_demand, greatest(&demand)),
        ] {
            assert!((-1e-9..1e-7).contains(&(found / sampled - 1.0)), "{found} instead of {sampled}");
        }
    }
}

/// A jump of a pulse or of inputs lifts the block at that instant, and reading outputs does not change the run.
#[test]
fn a_jump_lifts_the_block_in_the_instant_of_the_jump() {
    let block = block(0.25, 1.0, 0.0);
    let mut pulsed = at_rest(block, one_cosine(PUSH, 1.0), &Inputs::default());
    assert!(go(&mut pulsed, 1.0, &Inputs::default()).is_empty());
    turns(&seen(&pulsed), &block, PUSH, G);
    assert_eq!(pulsed.peaks().reaction, 0.5 * block.mass * G);

    let mut pushed = at_rest(block, Pulse::NONE, &Inputs::default());
    go(&mut pushed, 1.0, &Inputs::default());
    let before = pushed.clone();
    turns(&pushed.observe(&held(PUSH, 0.0)), &block, PUSH, G);
    turns(&pushed.observe(&held(-PUSH, 0.0)), &block, -PUSH, G);
    assert_eq!(seen(&pushed).regime, Regime::FullContact);
    assert_eq!(pushed, before);

    for (mut simulation, inputs) in [(pulsed, Inputs::default()), (pushed, held(PUSH, 0.0))] {
        let shown = simulation.observe(&inputs);
        let events = go(&mut simulation, 1.001, &inputs);
        assert_eq!(events.len(), 1);
        assert_eq!(
            (events[0].time, events[0].before, events[0].after),
            (1.0, Regime::FullContact, Regime::TiltingLeft)
        );
        // Under a decaying pulse the reaction peaks right after the jump; under a constant push it grows.
        let peak = simulation.peaks().reaction;
        let now = simulation.observe(&inputs).reaction[0];
        close(peak, shown.reaction[0].max(now), peak);
    }
}

/// A jump under which the last corner would have to be pulled separates the block at that instant.
#[test]
fn a_jump_of_the_vertical_motion_separates_a_rocking_block() {
    let block = block(0.25, 1.0, 0.0);
    let initial = Initial { theta: 0.1, theta_dot: 0.05, ..Initial::default() };
    let mut simulation = start(block, OnSeparation::Terminate, Pulse::NONE, &initial, &Inputs::default());
    go(&mut simulation, 0.1, &Inputs::default());
    let (inputs, standing) = (held(1.0, -2.5 * G), seen(&simulation));
    assert_eq!(standing.regime, Regime::TiltingRight);
    let flying = simulation.observe(&inputs);
    assert_eq!((flying.regime, flying.reaction, flying.horizontal), (Regime::Separated, [0.0; 2], 0.0));
    assert_eq!((flying.theta_ddot, flying.u_ddot), (0.0, -1.0));
    close(flying.v_ddot, 1.5 * G, G);
    for (now, before) in [
        (flying.theta_dot, standing.theta_dot),
        (flying.u_dot, standing.u_dot),
        (flying.v_dot, standing.v_dot),
        (flying.u, standing.u),
    ] {
        close(now, before, before);
    }
    // The run ends with the next step only.
    assert_eq!(simulation.ending(), None);
    go(&mut simulation, 1.0, &inputs);
    assert_eq!(simulation.ending(), Some((Ending::Separated, 0.1)));
}

/// Derivatives with respect to inputs are those of the turning block, such as `∂θ̈/∂a_gx = −p² cos α/g`, not of the resting one.
#[test]
fn derivatives_at_a_jump_are_those_of_the_lifted_block() {
    let block = block(0.25, 1.0, 0.0);
    let simulation = at_rest(block, Pulse::NONE, &Inputs::default());
    let inputs = held(PUSH, 0.0);
    let [cos, sin] = [block.alpha.cos(), block.alpha.sin()].map(|x| block.p * block.p * x / G);
    for (direction, theta_ddot, n) in
        [(held(1.0, 0.0), -cos, block.b * cos), (held(0.0, 1.0), sin, 1.0 - block.b * sin)]
    {
        let derivative = simulation.observe_direction(&inputs, &direction, 0.0);
        close(derivative.theta_ddot.eps, theta_ddot, theta_ddot);
        close(derivative.reaction[0].eps, block.mass * n, block.mass);
        assert_eq!((derivative.reaction[1].eps, derivative.u_dot.eps), (0.0, 0.0));
    }
    // Rates in time: θ̈ grows with the push.
    let growing = Inputs { a_gx: Ramp { value: PUSH, rate: 3.0 }, ..Inputs::default() };
    close(simulation.observe_rates(&growing).theta_ddot.eps, -3.0 * cos, cos);
    close(simulation.observe_rates(&growing).theta_dot.eps, simulation.observe(&growing).theta_ddot, 1.0);
}
