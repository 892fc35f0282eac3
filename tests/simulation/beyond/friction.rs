//! Sliding blocks in closed form, and the modes in which a block leaves rest.

use proptest::prelude::*;
use rocking_block::block::{Block, Common, Corner, Foundation, Ratios, Regime, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};

use crate::blocks::{block, block_on};
use crate::cases::cases;

const G: f64 = 9.81;

fn squat(friction: f64, foundation: Foundation) -> Block {
    block_on(foundation, [0.9, 2.0, 60.0, 0.3], &Common { friction, ..Common::default() })
}

fn start(block: Block, pulse: Pulse, inputs: &Inputs) -> Simulation {
    let settings = Settings { tolerance: 1e-12, ..Settings::default() };
    Simulation::new(block, settings, pulse, &Initial::default(), 0.0, inputs)
}

fn push(a_gx: f64) -> Inputs {
    Inputs { a_gx: Ramp::held(a_gx), ..Inputs::default() }
}

/// Newmark's sliding block under a rectangular pulse: `(a − μ g) T²/2 · a/(μ g)`.
#[test]
fn newmarks_block_under_a_rectangular_pulse() {
    for (friction, acceleration) in [(0.3, 5.0), (0.3, -5.0), (0.1, 9.0), (0.6, 6.0)] {
        let duration = 0.7;
        let inputs = push(acceleration);
        let mut simulation = start(squat(friction, Foundation::Rigid), Pulse::NONE, &inputs);
        simulation.advance(duration, &inputs, &mut |_| ()).unwrap();
        assert!(simulation.slides());
        simulation.advance(20.0, &Inputs::default(), &mut |_| ()).unwrap();
        let (a, limit): (f64, f64) = (f64::abs(acceleration), friction * G);
        let way = (a > limit) as u8 as f64 * 0.5 * (a - limit) * duration * duration * a / limit;
        let slip = simulation.slip();
        assert!(!simulation.slides() && (slip.now + acceleration.signum() * way).abs() < 1e-10, "{slip:?}, not {way}");
        assert!((slip.total - way).abs() < 1e-10 && (simulation.peaks().slip - way).abs() < 1e-10);
        let energies = simulation.energies();
        assert!(energies.residual.abs() < 1e-8 * energies.friction && energies.friction > 0.0, "{energies:?}");
    }
}

/// A sliding corner that lifts bears nothing, as far as round-off tells, and needs no more friction than there is.
#[test]
fn the_friction_demand_of_a_sliding_corner_that_lifts_is_the_friction() {
    let common = Common { epsilon: 0.3, friction: 0.4, ..Common::default() };
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let pulse = Pulse { shape: PulseShape::OneCosine, amplitude: 6.7, period: 1.61, ..Pulse::NONE };
    let inputs = Inputs::default();
    let block = block([0.31, 2.2, 40.0, 0.2], &common);
    let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
    let mut flights = 0;
    let count = &mut |event: &Event| flights += u32::from(event.after == Regime::Separated);
    simulation.advance(3.0, &inputs, count).unwrap();
    assert!(flights > 0 && simulation.peaks().friction_demand == 0.4, "{flights} flights, {:?}", simulation.peaks());
}

/// A push beyond both limits slides a block whose friction is tan α. Whether it also rocks is round-off, and so is its rotation.
#[test]
fn friction_of_tan_alpha_does_not_rattle() {
    for (i, ulps) in (0..300).flat_map(|i| (-4..4).map(move |ulps| (i, ulps))) {
        let alpha = 0.05 + 0.0017 * f64::from(i);
        let friction = libm::tan(alpha) * (1.0 + f64::from(ulps) * f64::EPSILON);
        let common = Common { friction, ..Common::default() };
        let block = block_on(Foundation::Rigid, [alpha, 2.0, 60.0, 0.1], &common);
        let amplitude = 1.2 * G * libm::tan(alpha);
        let push = Pulse { shape: PulseShape::Rectangular, amplitude, period: 0.5, ..Pulse::NONE };
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, Settings::default(), push, &Initial::default(), 0.0, &inputs);
        simulation.advance(3.0, &inputs, &mut |_| ()).unwrap();
        let (impacts, peaks) = (simulation.counts().impacts, simulation.peaks());
        assert!(impacts < 500 && peaks.theta < 1e-11, "α = {alpha}, {ulps} ulp: {impacts} impacts, {peaks:?}");
        assert!(peaks.slip > 0.01, "α = {alpha}: {peaks:?}");
    }
}

/// A flight moves the foot, too: after each landing the slip is the displacement of the corner, or of the middle of the base, on which the
/// block stands.
#[test]
fn slip_includes_the_way_through_the_air() {
    let block = block([0.47, 1.0, 11.0, 0.05], &Common { epsilon: 0.3, friction: 0.6, ..Common::default() });
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 13.0, period: 1.0, ..Pulse::NONE };
    let inputs = Inputs::default();
    let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
    let (mut landings, mut greatest) = (0, 0.0_f64);
    for step in 1..=2000 {
        let before = simulation.regime();
        simulation.advance(0.005 * f64::from(step), &inputs, &mut |_| ()).unwrap();
        let offset = match simulation.regime() {
            Regime::Separated => continue,
            Regime::FullContact => 0.0,
            Regime::TiltingLeft => block.b,
            Regime::TiltingRight => -block.b,
        };
        landings += u32::from(before == Regime::Separated);
        let now = simulation.observe(&inputs);
        let (sin, cos) = libm::sincos(now.theta);
        let foot = now.u - block.h * sin + offset * (1.0 - cos);
        let slip = simulation.slip().now;
        // Points of the base differ by b (1 − cos θ) where the foot changes.
        assert!((slip - foot).abs() < 1e-3 * block.b, "slip {slip}, foot at {foot}, {:?}", simulation.regime());
        greatest = greatest.max(slip.abs());
    }
    assert!(landings > 0 && greatest > 0.25, "{landings} landings, {greatest} m");
    assert!((simulation.peaks().slip - greatest).abs() < 1e-2 * greatest);
}

/// Under a one-sine pulse the block slides one way, grips or turns back, and comes to rest.
#[test]
fn newmarks_block_under_a_sine_pulse() {
    for (friction, amplitude, period) in [(0.3, 6.0, 0.8), (0.2, 9.0, 0.5), (0.45, 5.0, 1.3), (0.05, 4.0, 0.6)] {
        let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.0, ..Pulse::NONE };
        let mut simulation = start(squat(friction, Foundation::Rigid), pulse, &Inputs::default());
        simulation.advance(30.0, &Inputs::default(), &mut |_| ()).unwrap();
        let [now, total] = slide(friction * G, amplitude, std::f64::consts::TAU / period);
        let slip = simulation.slip();
        assert!((slip.now - now).abs() < 1e-10, "{slip:?}, not {now}");
        assert!((slip.total - total).abs() < 1e-10, "{slip:?}, not {total}");
    }
}

/// Returns the final position of a block that slides under one period of `a sin ω t` against `limit` (m/s²), and the distance it
/// has slid (m), from integrals in closed form.
fn slide(limit: f64, a: f64, omega: f64) -> [f64; 2] {
    let period = std::f64::consts::TAU / omega;
    // Velocity and place a time after `from`, sliding in a direction, while the pulse acts or after it.
    let within = |from: f64, u_dot: f64, direction: f64, time: f64| {
        let elapsed = time - from;
        let (sin, cos) = (f64::sin, f64::cos);
        let u_dot_after = u_dot + a / omega * (cos(omega * time) - cos(omega * from)) - direction * limit * elapsed;
        let way = u_dot * elapsed
            + a / omega * ((sin(omega * time) - sin(omega * from)) / omega - cos(omega * from) * elapsed)
            - 0.5 * direction * limit * elapsed * elapsed;
        (u_dot_after, way)
    };
    let root = |mut low: f64, mut high: f64, below: &dyn Fn(f64) -> bool| {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if below(middle) { high = middle } else { low = middle }
        }
        high
    };
    let (mut time, mut place, mut total) = (libm::asin(limit / a) / omega, 0.0, 0.0);
    // The ground moves to the right first, so the block slides to the left.
    let mut direction = -1.0;
    loop {
        let slides = |until: f64| direction * within(time, 0.0, direction, until).0 > 0.0;
        // The foot's velocity has a single maximum and is positive right after the start.
        let mut probe = time + 1e-4 * period;
        while probe < period && slides(probe) {
            probe += 1e-4 * period;
        }
        if probe >= period {
            let (u_dot, way) = within(time, 0.0, direction, period);
            let rest = 0.5 * u_dot * u_dot / limit;
            return [place + way + direction * rest, total + way.abs() + rest];
        }
        let stop = root(probe - 1e-4 * period, probe, &|t| !slides(t));
        let way = within(time, 0.0, direction, stop).1;
        (place, total) = (place + way, total + way.abs());
        let acceleration = a * libm::sin(omega * stop);
        if acceleration.abs() > limit {
            (time, direction) = (stop, -acceleration.signum());
            continue;
        }
        // At rest until the other half of the pulse moves it.
        let next = period - (std::f64::consts::PI - libm::asin(limit / a)) / omega;
        let first = next.min(period - libm::asin(limit / a) / omega);
        if a <= limit || first <= stop {
            return [place, total];
        }
        (time, direction) = (first, 1.0);
    }
}

/// The mode in which a block on the rigid base leaves rest under a constant acceleration, after Shenton (1996): it rests, slides,
/// rocks, or both. A block at rest on which the acceleration begins to act is shown in this mode at once.
fn mode(alpha: f64, friction: f64, a: f64) -> (bool, bool) {
    let common = Common { friction, gravity: G, ..Common::default() };
    let (block, inputs) = (block_on(Foundation::Rigid, [alpha, 1.7, 40.0, 0.1], &common), push(a));
    let mut simulation = start(block, Pulse::NONE, &inputs);
    simulation.advance(1e-9, &inputs, &mut |_| ()).unwrap();
    let mode = (simulation.slides(), simulation.regime() != Regime::FullContact);
    let resting = start(block, Pulse::NONE, &Inputs::default());
    let shown = (resting.slides_under(&inputs), resting.observe(&inputs).regime != Regime::FullContact);
    assert_eq!(shown, mode, "alpha = {alpha}, friction = {friction}, a_gx = {a}");
    mode
}

proptest! {
    #![proptest_config(cases(200))]

    /// The boundaries between the four modes match Shenton's, to round-off.
    #[test]
    fn mode_boundaries_are_those_of_shenton(alpha in 0.1..0.6, friction in 0.05..1.2, over in 1.001..3.0) {
        const CLOSE: f64 = 1e-12;
        let tan = libm::tan(alpha);
        let [below, above] = [1.0 - CLOSE, 1.0 + CLOSE];
        if friction < 0.999 * tan {
            let limit = friction * G;
            prop_assert_eq!(mode(alpha, friction, limit * below), (false, false));
            prop_assert_eq!(mode(alpha, friction, limit * above), (true, false));
            prop_assert_eq!(mode(alpha, friction, limit * over), (true, false));
        } else if friction > 1.001 * tan {
            let limit = tan * G;
            prop_assert_eq!(mode(alpha, friction, limit * below), (false, false));
            prop_assert_eq!(mode(alpha, friction, limit * above), (false, true));
            // The friction that pure rocking needs at the start.
            let a = limit * over;
            let (sin, cos) = libm::sincos(alpha);
            let turning = (a * cos - G * sin) / (1.0 + 1.0 / 3.0);
            let needed = (a - cos * turning) / (G + sin * turning);
            if needed > 1.001 * tan && needed < 1.3 {
                prop_assert_eq!(mode(alpha, needed * above, a), (false, true), "needs {}", needed);
                prop_assert_eq!(mode(alpha, needed * below, a), (true, true), "needs {}", needed);
            }
        }
    }
}

/// With μ = tan α exactly, a push beyond both limits makes the block slide, not tip.
#[test]
fn friction_at_the_tangent_of_alpha() {
    for alpha in [0.15, 0.25, 0.4] {
        for over in [1.5, 2.0, 3.0] {
            let friction = libm::tan(alpha);
            let inputs = push(over * friction * G);
            let common = Common { friction, ..Common::default() };
            let mut simulation =
                start(block_on(Foundation::Rigid, [alpha, 1.7, 40.0, 0.1], &common), Pulse::NONE, &inputs);
            simulation.advance(0.5, &inputs, &mut |_| ()).unwrap();
            let way = 0.5 * (over - 1.0) * friction * G * 0.25;
            assert!(simulation.slides());
            assert!((simulation.slip().now + way).abs() < 1e-9, "{:?}, not {way}", simulation.slip());
            assert!(simulation.observe(&inputs).theta.abs() < 1e-9);
        }
    }
}

/// A friction at which a corner may jam on the rigid base is refused there, and only there.
#[test]
fn friction_that_jams() {
    let on = |friction, foundation| {
        let supports = Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 });
        let given = rocking_block::block::Dimensionless { alpha: 0.25, p: 1.0, supports };
        Block::from_dimensionless(&given, &Common { friction, ..Common::default() })
    };
    assert!(on(1.33, Foundation::Rigid).is_ok() && on(1.34, Foundation::Viscoelastic).is_ok());
    let message = on(1.34, Foundation::Rigid).unwrap_err().to_string();
    assert!(message.contains("friction = 1.34") && message.contains("1.333"), "{message}");
}

/// Where a corner lifts right after its landing, the other one slides, whose friction may press the first one down again: then
/// the other one grips, so that some regime lasts.
#[test]
fn a_corner_that_lands_and_lifts_at_once_leaves_a_regime_that_lasts() {
    let block = block([0.2368, 2.8073, 34.13, 0.1252], &Common { friction: 0.44, mass: 250.0, ..Common::default() });
    let initial = Initial { theta: -4.878e-3, theta_dot: -4.22e-3, vertical: Some((1.19e-5, -7.13e-3)) };
    let mut at_once = 0;
    for (i, j) in (0..20).flat_map(|i| (-10..10).map(move |j| (i, j))) {
        let inputs =
            Inputs { a_gx: Ramp::held(0.1 * f64::from(i)), m_y: Ramp::held(20.0 * f64::from(j)), ..Inputs::default() };
        let mut simulation = Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &inputs);
        simulation
            .advance(0.02, &inputs, &mut |event| {
                at_once += u32::from(event.kind == EventKind::Landing(Corner::Right) && event.after == event.before);
            })
            .unwrap();
    }
    assert!(at_once > 20, "{at_once}");
}
