//! Separation, sliding, flight and landing, compared with closed forms and an independent integration.

use std::f64::consts::FRAC_PI_2;

use rocking_block::block::{Block, Body, Corner, Regime};
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::{Ending, Initial, OnSeparation, Progress, Simulation};
use rocking_block::system::events::{Event, EventKind};

use super::{G, block, close, go, held, seen, start};

/// The ground falls with 1.5 g for 0.2 s: relative to it the block rises level with g/2, and lands again.
fn thrown(epsilon: f64, on_separation: OnSeparation) -> Simulation {
    let falling = held(0.0, -1.5 * G);
    let mut simulation = start(block(0.25, 1.0, epsilon), on_separation, Pulse::NONE, &Initial::default(), &falling);
    let first = simulation.observe(&falling);
    assert_eq!((first.regime, first.reaction), (Regime::Separated, [0.0; 2]));
    close(first.v_ddot, 0.5 * G, G);
    go(&mut simulation, 0.2, &falling);
    simulation
}

/// Returns height and rate of [`thrown`] at 0.2 s, and time and rate of its first landing.
fn first_landing() -> (f64, f64, f64, f64) {
    let (height, rate) = (0.25 * G * 0.04, 0.5 * G * 0.2);
    let landing_rate = (rate * rate + 2.0 * G * height).sqrt();
    (height, rate, 0.2 + (rate + landing_rate) / G, landing_rate)
}

#[test]
fn a_block_at_rest_leaves_ground_that_falls_faster() {
    let (height, rate, landing, landing_rate) = first_landing();
    let mut simulation = thrown(0.0, OnSeparation::Fly);
    let up = seen(&simulation);
    assert_eq!((up.theta, up.theta_ddot, up.u, up.horizontal), (0.0, 0.0, 0.0, 0.0));
    close(up.v, height, height);
    close(up.v_dot, rate, rate);
    assert_eq!(up.uplift, [up.v; 2]);
    let events = go(&mut simulation, 2.0, &Inputs::default());
    assert_eq!(events.len(), 1);
    assert!((events[0].time - landing).abs() < 1e-12, "{} instead of {landing}", events[0].time);
    assert_eq!((events[0].before, events[0].after), (Regime::Separated, Regime::FullContact));
    let mass = simulation.block().mass;
    let rest = seen(&simulation);
    assert_eq!((rest.v, rest.v_dot, rest.theta, rest.reaction), (0.0, 0.0, 0.0, [0.5 * mass * G; 2]));
    let energies = simulation.energies();
    close(energies.impacts, 0.5 * mass * landing_rate * landing_rate, energies.impacts);
    assert!(energies.residual.abs() < 1e-12 * energies.impacts, "{energies:?}");
}

/// Each rebound has ε times the landing rate, so all flights last in total `2 v/g (ε + ε² + …)`.
#[test]
fn a_block_bounces_with_epsilon() {
    let (_, _, landing, landing_rate) = first_landing();
    let mut simulation = thrown(0.5, OnSeparation::Fly);
    let events = go(&mut simulation, 3.0, &Inputs::default());
    assert!(events.iter().all(|event| matches!(event.kind, EventKind::Landing(_))), "{events:?}");
    assert!(events.len() > 10);
    for (n, pair) in events.windows(2).enumerate() {
        let flight = 2.0 * landing_rate / G * 0.5_f64.powi(n as i32 + 1);
        assert!((pair[1].time - pair[0].time - flight).abs() < 1e-9, "flight {n}: {pair:?}, exact {flight}");
    }
    let last = events[events.len() - 1];
    assert_eq!(last.after, Regime::FullContact);
    // Flights lower than 1e-12 R0 are omitted.
    assert!((last.time - (landing + 2.0 * landing_rate / G)).abs() < 1e-5, "{last}");
    let rises = |n: i32| (landing_rate * 0.5_f64.powi(n)).powi(2) / (2.0 * G);
    let flights = events.len() as i32;
    let least = 1e-12 * simulation.block().r0;
    assert!(rises(flights) < least && least <= rises(flights - 1), "{flights} flights");
    // Both corners land at once, and lift at once when the ground falls and after each landing except the last.
    let counts = simulation.counts();
    assert_eq!([counts.impacts, counts.liftoffs], [2 * flights as u32; 2]);
    close(simulation.energies().impacts, 0.5 * simulation.block().mass * landing_rate * landing_rate, 1e4);
}

#[test]
fn the_run_ends_or_is_held_where_the_block_separates() {
    let falling = held(0.0, -1.5 * G);
    for on_separation in [OnSeparation::Terminate, OnSeparation::Hold] {
        let mut simulation =
            start(block(0.25, 1.0, 0.0), on_separation, Pulse::NONE, &Initial::default(), &Inputs::default());
        go(&mut simulation, 0.5, &Inputs::default());
        let progress = simulation.advance(1.0, &falling, &mut |_| ()).unwrap();
        assert_eq!(simulation.ending(), Some((Ending::Separated, 0.5)));
        let seen = simulation.observe(&falling);
        assert_eq!((seen.regime, seen.reaction, seen.v_dot), (Regime::Separated, [0.0; 2], 0.0));
        if on_separation == OnSeparation::Hold {
            assert_eq!((progress, seen.v_ddot), (Progress::Reached, 0.0));
        } else {
            assert_eq!(progress, Progress::Ended(Ending::Separated, 0.5));
            close(seen.v_ddot, 0.5 * G, G);
        }
    }
}

/// A classical Runge-Kutta step.
fn step(x: [f64; 4], t: f64, h: f64, rate: &impl Fn(f64, &[f64; 4]) -> [f64; 4]) -> [f64; 4] {
    let plus = |k: &[f64; 4], part: f64| [0, 1, 2, 3].map(|i| x[i] + part * h * k[i]);
    let a = rate(t, &x);
    let b = rate(t + 0.5 * h, &plus(&a, 0.5));
    let c = rate(t + 0.5 * h, &plus(&b, 0.5));
    let d = rate(t + h, &plus(&c, 1.0));
    [0, 1, 2, 3].map(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

/// Returns time and state at which `n` falls to zero.
fn until_zero(
    mut x: [f64; 4],
    mut t: f64,
    rate: &impl Fn(f64, &[f64; 4]) -> [f64; 4],
    n: impl Fn(f64, &[f64; 4]) -> f64,
) -> (f64, [f64; 4]) {
    let h = 1e-4;
    loop {
        assert!(t < 10.0);
        let next = step(x, t, h, rate);
        if n(t + h, &next) < 0.0 {
            break;
        }
        (x, t) = (next, t + h);
    }
    let (mut low, mut high) = (0.0, h);
    while high - low > 1e-15 {
        let middle = 0.5 * (low + high);
        if n(t + middle, &step(x, t, middle, rate)) < 0.0 { high = middle } else { low = middle }
    }
    (t + low, step(x, t, low, rate))
}

/// A block rocks while the vertical ground acceleration falls steadily; slip and lift-off match an independent integration.
///
/// Housner's equation and `N = M (g + a_gz + v̈)`, `v = R0 [cos(α − |θ|) − cos α]`, give the time at which the corner would have
/// to be pulled. From then on it slides: Lagrange's equations for θ and a free x, with the height `y = v(θ)` of the centre of
/// mass, give the time at which the base bears no load. Under the opposite ground motion the released corner rises at once.
#[test]
fn slip_and_lift_off_match_an_independent_integration() {
    let block = block(0.3, 2.0, 0.0);
    let Block { alpha, body: Body { p, r0, mass, .. }, .. } = block;
    for (theta, theta_dot, push, slides) in [(0.2, -0.5, 1.0, true), (-0.2, 0.2, -1.0, true), (-0.2, 0.2, 1.0, false)] {
        let sigma = f64::signum(theta);
        let inputs = Inputs {
            a_gx: Ramp { value: 0.4 * push, rate: -push },
            a_gz: Ramp { value: 0.0, rate: -3.0 * G },
            ..Inputs::default()
        };
        let (a_x, a_z) = (|t: f64| push * (0.4 - t), |t: f64| -3.0 * G * t);
        let initial = Initial { theta, theta_dot, ..Initial::default() };
        let mut simulation = start(block, OnSeparation::Fly, Pulse::NONE, &initial, &inputs);
        let events = go(&mut simulation, 0.5, &inputs);
        let slip = events[0];
        let (corner, regime) = match sigma > 0.0 {
            true => (Corner::Right, Regime::TiltingRight),
            false => (Corner::Left, Regime::TiltingLeft),
        };
        let first = if slides { (EventKind::Slip, regime) } else { (EventKind::LiftOff(corner), Regime::Separated) };
        assert_eq!((slip.before, slip.kind, slip.after), (regime, first.0, first.1), "{events:?}");

        let housner = |t: f64, x: &[f64; 4]| {
            let phi = sigma * alpha - x[0];
            [x[1], -p * p * (phi.sin() * (1.0 + a_z(t) / G) + phi.cos() * a_x(t) / G), 0.0, 0.0]
        };
        // y' = σ R0 sin(α − |θ|), y'' = −R0 cos(α − |θ|).
        let phi = |x: &[f64; 4]| alpha - x[0].abs();
        let n = |t: f64, x: &[f64; 4]| {
            let theta_ddot = housner(t, x)[1];
            mass * (G + a_z(t) + sigma * r0 * phi(x).sin() * theta_ddot - r0 * phi(x).cos() * x[1] * x[1])
        };
        let (time, x) = until_zero([theta, theta_dot, 0.0, 0.0], 0.0, &housner, n);
        assert!((slip.time - time).abs() < 1e-9, "slips at {}, by hand at {time}", slip.time);

        // The paper's analysis ends when the corner would have to be pulled.
        let mut ended = start(block, OnSeparation::Terminate, Pulse::NONE, &initial, &inputs);
        let progress = ended.advance(0.5, &inputs, &mut |_| ()).unwrap();
        assert_eq!(progress, Progress::Ended(Ending::Separated, slip.time));
        if !slides {
            continue;
        }

        // From a corner at rest u̇ = R0 cos(α − |θ|) θ̇.
        let x = [x[0], x[1], sigma * r0 * (alpha.sin() - phi(&x).sin()), r0 * phi(&x).cos() * x[1]];
        let i0 = r0 * r0 / 3.0;
        let sliding = |t: f64, x: &[f64; 4]| {
            let (slope, bend) = (sigma * r0 * phi(x).sin(), -r0 * phi(x).cos());
            let theta_ddot = -slope * (G + a_z(t) + bend * x[1] * x[1]) / (i0 + slope * slope);
            [x[1], theta_ddot, x[3], -a_x(t)]
        };
        let n = |t: f64, x: &[f64; 4]| {
            let (slope, bend) = (sigma * r0 * phi(x).sin(), -r0 * phi(x).cos());
            mass * (G + a_z(t) + slope * sliding(t, x)[1] + bend * x[1] * x[1])
        };
        let (time, x) = until_zero(x, time, &sliding, n);
        let lift = events[1];
        assert_eq!((lift.kind, lift.before, lift.after), (EventKind::LiftOff(corner), regime, Regime::Separated));
        assert!((lift.time - time).abs() < 1e-9, "lifts at {}, by hand at {time}", lift.time);
        let mut again = start(block, OnSeparation::Fly, Pulse::NONE, &initial, &inputs);
        go(&mut again, lift.time, &inputs);
        let there = again.observe(&inputs);
        for (found, exact) in [there.theta, there.theta_dot, there.u, there.u_dot].into_iter().zip(x) {
            assert!((found - exact).abs() < 1e-9, "{found} instead of {exact}");
        }
    }
}

/// A toppling block leaves the base before it lies on its side.
///
/// `N` of a rod that falls from unstable equilibrium is zero at `cos φ = 1/3`, and earlier with an initial push.
#[test]
fn a_block_that_topples_is_overturned_where_it_leaves_the_base() {
    let block = block(0.2, 1.0, 0.0);
    for (push, ends) in [(0.02, true), (0.0, false)] {
        let initial = Initial { theta: 0.2 + 1e-6, theta_dot: push, ..Initial::default() };
        let mut simulation = start(block, OnSeparation::Terminate, Pulse::NONE, &initial, &Inputs::default());
        let progress = simulation.advance(60.0, &Inputs::default(), &mut |_| ()).unwrap();
        let theta = seen(&simulation).theta;
        if ends {
            let Progress::Ended(Ending::Toppled, _) = progress else { panic!("{progress:?}") };
            // ½ (4/3) R0² θ̇² = ½ (4/3) R0² θ̇0² + g R0 (1 − cos φ), and the corner bears
            // N/(M g) = (1 − 3 cos φ)²/4 − (R0/g) cos φ θ̇0².
            let cos = (theta - 0.2).cos();
            let n = (1.0 - 3.0 * cos).powi(2) / 4.0 - block.r0 / G * cos * push * push;
            assert!(n.abs() < 1e-8 && cos > 1.0 / 3.0, "N = {n} M g at phi = {}", theta - 0.2);
        } else {
            // The reaction touches zero, within the initial offset of 1e-6.
            assert!((theta - 0.2).cos() < 0.34, "{progress:?} at {theta}");
        }
    }
}

/// A moment −m that slows a toppling block keeps it on its corner to the quarter turn, where it is overturned:
/// `⅔ R0² (θ̇² − θ̇0²) = g R0 [cos(θ0 − α) − sin α] − m (π/2 − θ0)`.
#[test]
fn a_block_that_is_lowered_overturns_at_the_quarter_turn() {
    let block = block(0.25, 1.0, 0.0);
    let (theta, theta_dot, m) = (0.75, (0.09 * G / block.r0).sqrt(), 0.72 * G * block.r0);
    let initial = Initial { theta, theta_dot, ..Initial::default() };
    let inputs = Inputs { m_y: Ramp::held(-block.mass * m), ..Inputs::default() };
    let mut simulation = start(block, OnSeparation::Terminate, Pulse::NONE, &initial, &inputs);
    let progress = simulation.advance(60.0, &inputs, &mut |_| ()).unwrap();
    let Progress::Ended(Ending::Overturned, _) = progress else { panic!("{progress:?}") };
    let now = simulation.observe(&inputs);
    close(now.theta, FRAC_PI_2, 1.0);
    let work = G * block.r0 * ((theta - block.alpha).cos() - block.alpha.sin()) - m * (FRAC_PI_2 - theta);
    let exact = (theta_dot * theta_dot + 1.5 * work / (block.r0 * block.r0)).sqrt();
    assert!((now.theta_dot / exact - 1.0).abs() < 1e-9, "{} instead of {exact} rad/s", now.theta_dot);
}

/// Events and motion do not depend on the communication steps.
#[test]
fn flights_do_not_depend_on_the_communication_steps() {
    let block = block(0.35, 1.5, 0.3);
    let initial = Initial { theta: 0.1, theta_dot: 0.3, ..Initial::default() };
    let inputs = Inputs {
        a_gx: Ramp { value: 2.0, rate: -1.0 },
        a_gz: Ramp { value: -2.5 * G, rate: 12.0 * G },
        ..Inputs::default()
    };
    let [mut coarse, mut fine] = [(); 2].map(|()| start(block, OnSeparation::Fly, Pulse::NONE, &initial, &inputs));
    let all = go(&mut coarse, 0.5, &inputs);
    let piecewise: Vec<Event> = (1..=500).flat_map(|i| go(&mut fine, 0.001 * f64::from(i), &inputs)).collect();
    assert_eq!(all.len(), piecewise.len());
    assert!(all.len() > 3 && all.iter().any(|event| event.before == Regime::Separated), "{all:?}");
    for (a, b) in all.iter().zip(&piecewise) {
        assert_eq!((a.kind, a.before, a.after), (b.kind, b.before, b.after));
        assert!((a.time - b.time).abs() < 1e-8, "{a} or {b}");
    }
    let [a, b] = [&coarse, &fine].map(|run| run.observe(&inputs));
    assert!((a.theta - b.theta).abs() < 1e-7 * block.alpha && (a.u - b.u).abs() < 1e-7 * block.r0);
}

/// On ground that falls with g the reaction is zero, and its rate decides whether the block leaves.
#[test]
fn the_rate_of_a_zero_reaction_decides_whether_the_block_leaves() {
    for (rate, leaves) in [(-1.0, true), (0.0, false), (1.0, false)] {
        let inputs = Inputs { a_gz: Ramp { value: -G, rate }, ..Inputs::default() };
        let mut simulation = start(block(0.3, 1.0, 0.0), OnSeparation::Fly, Pulse::NONE, &Initial::default(), &inputs);
        let first = simulation.observe(&inputs);
        assert_eq!(first.reaction, [0.0; 2]);
        assert_eq!(first.regime, if leaves { Regime::Separated } else { Regime::FullContact }, "{rate} m/s3");
        let events = go(&mut simulation, 0.1, &inputs);
        assert_eq!(events.is_empty(), !leaves, "{events:?}");
    }
}

#[test]
fn an_event_displays_time_kind_and_regimes() {
    let event = Event {
        time: 1.25,
        kind: EventKind::LiftOff(Corner::Left),
        before: Regime::FullContact,
        after: Regime::TiltingRight,
    };
    assert_eq!(event.to_string(), "t = 1.250000000 s: lift-off of L, full contact -> tilting right");
}

/// A block that comes down slides or leaves the ground before it lands if that falls away ever faster: once its corner bears nothing.
#[test]
fn a_corner_is_free_before_the_other_one_lands() {
    for fall in [250.0, 500.0] {
        let initial = Initial { theta: 0.02, theta_dot: -0.3, ..Initial::default() };
        let inputs = Inputs { a_gz: Ramp { value: 0.0, rate: -fall }, ..Inputs::default() };
        let begin = || start(block(0.25, 2.0, 0.0), OnSeparation::Fly, Pulse::NONE, &initial, &inputs);
        let events = go(&mut begin(), 0.1, &inputs);
        let Some(Event { time, kind: EventKind::Slip | EventKind::LiftOff(Corner::Right), .. }) = events.first() else {
            panic!("{events:?}")
        };
        let reaction = |time: f64| {
            let mut before = begin();
            assert_eq!(go(&mut before, time, &inputs), []);
            before.observe(&inputs).reaction[1] / (before.block().mass * G)
        };
        // The reaction vanishes linearly.
        let [just, earlier] = [1e-6, 2e-6].map(|ahead| reaction(time - ahead));
        assert!(just > 0.0 && (earlier - 2.0 * just).abs() < 1e-4 * earlier, "N = {just} and {earlier} M g");
    }
}
