//! Free flight: motion, landings and end, without gain of energy.

mod against;
mod independent;

use nalgebra::{Matrix5, Vector5};
use proptest::prelude::*;

use rocking_block::block::{Block, Common, Corner, Dimensionless, Ratios, Regime, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};
use rocking_block::system::impact::{self, Velocities};

use crate::blocks::supported as block;
use crate::cases::cases;

fn start(block: Block, pulse: Pulse, initial: &Initial) -> Simulation {
    let settings = Settings { tolerance: 1e-11, on_separation: OnSeparation::Fly, ..Settings::default() };
    Simulation::new(block, settings, pulse, initial, 0.0, &Inputs::default())
}

fn seen(simulation: &Simulation) -> Observation<f64> {
    simulation.observe(&Inputs::default())
}

fn go(simulation: &mut Simulation, until: f64, inputs: &Inputs) -> Vec<Event> {
    let mut events = Vec::new();
    simulation.advance(until, inputs, &mut |event| events.push(*event)).unwrap();
    events
}

fn one_sine(amplitude: f64, period: f64, start: f64) -> Pulse {
    Pulse { shape: PulseShape::OneSine, amplitude, period, start, ..Pulse::NONE }
}

fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

prop_compose! {
    fn blocks()(
        alpha in 0.05..0.8,
        p in log_uniform(0.5, 6.0),
        eta in log_uniform(5.0, 150.0),
        xi_v in prop_oneof![Just(0.0), 0.01..1.0, 1.0..5.0],
        epsilon in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0],
        gamma in 1.0..5.0,
    ) -> Block {
        Block::from_dimensionless(
            &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
            &Common { epsilon, gamma, ..Common::default() },
        ).unwrap()
    }
}

/// Thrown up at 3 m/s: a parabola, constant rotation rate, and ground that moves away below.
#[test]
fn the_motion_in_flight_is_the_closed_form() {
    let block = block(0.3, 2.0, 40.0, 0.1, 0.0);
    let (v, v_dot, theta, theta_dot) = (1.0, 3.0, 0.02, 0.4);
    let pulse = one_sine(4.0, 0.3, 0.1);
    let mut simulation = start(block, pulse, &Initial { theta, theta_dot, vertical: Some((v, v_dot)) });
    let inputs = Inputs { a_gx: Ramp { value: 1.0, rate: -2.0 }, ..Inputs::default() };
    let [u0, u_dot0] = [block.h * libm::sin(theta), block.h * libm::cos(theta) * theta_dot];
    for i in 1..=60 {
        let t = 0.01 * f64::from(i);
        assert!(go(&mut simulation, t, &inputs).is_empty());
        assert_eq!(simulation.regime(), Regime::Separated);
        let seen = simulation.observe(&inputs);
        // Velocity and displacement of the ground under the pulse: v_g = a_p/ω (1 − cos ω t).
        let omega = std::f64::consts::TAU / pulse.period;
        let inside = (t - pulse.start).clamp(0.0, pulse.period);
        let ground = 4.0 / omega * (inside - libm::sin(omega * inside) / omega);
        let exact = [
            theta + theta_dot * t,
            v + v_dot * t - 0.5 * 9.81 * t * t,
            u0 + u_dot0 * t - 0.5 * t * t + t * t * t / 3.0 - ground,
        ];
        for (found, exact) in [seen.theta, seen.v, seen.u].into_iter().zip(exact) {
            assert!((found - exact).abs() < 1e-13, "t = {t}: {found}, exact {exact}");
        }
        assert_eq!((seen.reaction, seen.horizontal, seen.theta_ddot, seen.v_ddot), ([0.0; 2], 0.0, 0.0, -9.81));
    }
    assert!(simulation.energies().residual.abs() < 1e-12 * simulation.energies().total);
}

/// The work of a pulse on a block in flight is exact in long steps, which only the pulse limits.
#[test]
fn flights_under_a_pulse_keep_the_balance_of_energy() {
    for (block, amplitude, period) in [
        (block(0.373, 0.369, 8.94, 0.0151, 0.415), 13.28, 9.75),
        (block(0.259, 2.98, 109.0, 0.0247, 0.504), 15.35, 1.4),
        (block(0.29, 0.32, 40.0, 0.1, 0.3), 12.8, 11.5),
    ] {
        let pulse = Pulse { shape: PulseShape::C1, amplitude, period, start: 0.0, ..Pulse::NONE };
        for tolerance in [1e-8, 1e-10] {
            let settings = Settings { tolerance, on_separation: OnSeparation::Fly, ..Settings::default() };
            let inputs = Inputs::default();
            let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
            let events = go(&mut simulation, 100.0, &inputs);
            assert!(events.iter().any(|event| event.after == Regime::Separated));
            let energies = simulation.energies();
            let largest = energies.total.abs().max(energies.input.abs());
            assert!(energies.residual.abs() < 1e-8 * largest, "at {tolerance:e}: {energies:?}");
        }
    }
}

/// Landings solve the momentum balance for u̇, v̇, θ̇ and the two impulses.
#[test]
fn landings_from_flight_keep_the_balance_of_momentum() {
    let block = block(0.4, 1.5, 30.0, 0.1, 0.35);
    let before = Velocities { u_dot: 0.7, v_dot: -1.1, theta_dot: 0.5 };
    for (corner, theta) in [(Corner::Left, -0.2), (Corner::Right, 0.3)] {
        let s = corner.sign();
        let (reach, height) =
            (block.r0 * libm::sin(block.alpha + s * theta), block.r0 * libm::cos(block.alpha + s * theta));
        let rate = 0.35 * (before.v_dot + s * reach * before.theta_dot);
        #[rustfmt::skip]
        let matrix = Matrix5::new(
            1.0, 0.0, 0.0, -1.0, 0.0,
            0.0, 1.0, 0.0, 0.0, -1.0,
            0.0, 0.0, block.i0, height, -s * reach,
            1.0, 0.0, -height, 0.0, 0.0,
            0.0, 1.0, s * reach, 0.0, 0.0,
        );
        let right = Vector5::new(before.u_dot, before.v_dot, block.i0 * before.theta_dot, 0.0, rate);
        let exact = matrix.lu().solve(&right).unwrap();
        let found = impact::landing_with_grip(&block, corner, theta, before, rate);
        for (found, exact) in [found.u_dot, found.v_dot, found.theta_dot].into_iter().zip(exact.iter()) {
            assert!((found - exact).abs() < 1e-14, "{corner:?}: {found}, exact {exact}");
        }
    }
}

/// Dropped level, the block lands on both corners, stays level, and keeps its energy if nothing dissipates.
#[test]
fn a_level_drop_lands_on_both_corners() {
    let elastic = block(0.3, 2.0, 40.0, 0.0, 1.0);
    let height = 5.0 * elastic.static_deflection();
    let mut simulation = start(elastic, Pulse::NONE, &Initial { vertical: Some((height, 0.0)), ..Initial::default() });
    let energy = simulation.energies().total;
    let events = go(&mut simulation, 3.0, &Inputs::default());
    let landings = events.iter().filter(|e| matches!(e.kind, EventKind::Landing(_))).collect::<Vec<_>>();
    assert!(landings.len() > 5 && landings.iter().all(|e| e.after == Regime::FullContact), "{events:?}");
    assert_eq!((seen(&simulation).theta, seen(&simulation).u), (0.0, 0.0));
    assert_eq!(simulation.counts().impacts as usize, 2 * landings.len());
    assert!((simulation.energies().total / energy - 1.0).abs() < 1e-8, "{:?}", simulation.energies());

    // Duration of the fall to the free height of the supports.
    let fall = (2.0 * 4.0 * elastic.static_deflection() / 9.81_f64).sqrt();
    assert!((landings[0].time - fall).abs() < 1e-12, "{} instead of {fall}", landings[0].time);
}

/// Successive flights get lower and end, and the block rests where it landed.
#[test]
fn a_thrown_block_comes_to_rest_at_its_new_place() {
    for (epsilon, xi_v) in [(0.0, 0.3), (0.5, 0.2), (1.0, 0.1), (0.3, 2.0)] {
        let block = block(0.5, 2.0, 30.0, xi_v, epsilon);
        let initial = Initial { theta: 0.05, theta_dot: -0.3, vertical: Some((0.3, 1.0)) };
        let mut simulation = start(block, Pulse::NONE, &initial);
        // The ground accelerates to the left during the first flight and stops during a later one.
        let pushed = Inputs { a_gx: Ramp::held(-2.0), ..Inputs::default() };
        go(&mut simulation, 0.1, &pushed);
        go(&mut simulation, 40.0, &Inputs::default());
        assert_eq!(simulation.regime(), Regime::FullContact, "epsilon {epsilon}");
        let rest = seen(&simulation);
        assert!(rest.theta.abs() < 1e-9 && rest.v.abs() < 1e-9 && rest.u_dot.abs() < 1e-9, "{rest:?}");
        assert!((rest.reaction[0] / (0.5 * block.mass * 9.81) - 1.0).abs() < 1e-6, "{:?}", rest.reaction);
        assert!(rest.u.abs() > 0.01, "u = {} m after {} landings", rest.u, simulation.counts().impacts);
        let energies = simulation.energies();
        assert!(energies.total.abs() < 1e-9 * energies.input.abs().max(1.0), "{energies:?}");
        assert!(energies.residual.abs() < 1e-6, "{energies:?}");
    }
}

/// A block shaken off its supports by a mirrored pulse moves as in a mirror.
#[test]
fn the_mirror_image_of_a_flight_is_a_flight() {
    let block = block(0.45, 3.0, 60.0, 0.05, 0.6);
    let [mut one, mut other] =
        [1.0, -1.0].map(|side| start(block, one_sine(side * 12.0, 0.6, 0.0), &Initial::default()));
    let mut flights = 0;
    for i in 1..=40 {
        let t = 0.05 * f64::from(i);
        let [events, _] = [&mut one, &mut other].map(|run| go(run, t, &Inputs::default()));
        flights += events.iter().filter(|e| e.after == Regime::Separated).count();
        let [a, b] = [&one, &other].map(seen);
        assert_eq!([a.theta, a.theta_dot, a.u, a.v, a.v_dot], [-b.theta, -b.theta_dot, -b.u, b.v, b.v_dot]);
        assert_eq!(a.reaction, [b.reaction[1], b.reaction[0]]);
    }
    assert!(flights >= 2, "{flights}");
}

/// If both supports would have to pull, the block first leaves the one with the greater tension.
///
/// The other corner still holds at that moment and gives the centre of mass its horizontal velocity.
#[test]
fn the_corner_with_the_greater_tension_leaves_first() {
    let block = block(0.4, 1.0, 20.0, 0.3, 0.0);
    for side in [1.0, -1.0] {
        let (theta, theta_dot) = (side * 0.004, side * 0.3);
        let initial = Initial { theta, theta_dot, vertical: Some((0.0, 4.0)) };
        let simulation = start(block, Pulse::NONE, &initial);
        let seen = seen(&simulation);
        assert_eq!(seen.regime, Regime::Separated);
        // The block turns about the other corner.
        let exact = block.r0 * libm::cos(block.alpha - 0.004) * theta_dot;
        assert!((seen.u_dot - exact).abs() < 1e-14, "{} instead of {exact}", seen.u_dot);
    }
}

#[test]
fn flights_do_not_depend_on_the_communication_steps() {
    let block = block(0.45, 3.0, 60.0, 0.05, 0.6);
    let [mut coarse, mut fine] = [(); 2].map(|()| start(block, one_sine(12.0, 0.6, 0.0), &Initial::default()));
    let all = go(&mut coarse, 2.0, &Inputs::default());
    let mut piecewise = Vec::new();
    for i in 1..=2000 {
        piecewise.extend(go(&mut fine, 0.001 * f64::from(i), &Inputs::default()));
    }
    assert_eq!(all.len(), piecewise.len());
    for (a, b) in all.iter().zip(&piecewise) {
        assert_eq!((a.kind, a.before, a.after), (b.kind, b.before, b.after));
        assert!((a.time - b.time).abs() < 1e-9, "{a} or {b}");
    }
    assert!((seen(&coarse).theta - seen(&fine).theta).abs() < 1e-8 * block.alpha);
}

/// The last corner slides if holding it would need tension and flight would press it down.
#[test]
fn the_last_corner_slides_where_it_can_neither_hold_nor_lift() {
    let block = Block::from_dimensionless(
        &Dimensionless {
            alpha: 0.254_889_381,
            p: 1.709_870_996,
            supports: Supports::Viscoelastic(Ratios { eta: 39.216_316_06, xi_v: 0.331_827_6 }),
        },
        &Common { gamma: 2.225, ..Common::default() },
    )
    .unwrap();
    let initial = Initial {
        theta: -0.037_31,
        theta_dot: 0.077_15,
        vertical: Some((
            0.5 * block.static_deflection() + 0.037_31 * block.b,
            -0.797_649 * block.alpha * block.p * block.r0,
        )),
    };
    let mut simulation = start(block, one_sine(15.0, 1.580_838, 0.3), &initial);
    let events = go(&mut simulation, 1.2, &Inputs::default());
    let slip = events.iter().find(|event| event.kind == EventKind::Slip).expect("a slip");
    assert_eq!((slip.before, slip.after), (Regime::TiltingLeft, Regime::TiltingLeft));
    let sliding = seen(&simulation);
    assert!(sliding.reaction[0] > 0.0 && sliding.horizontal == 0.0, "{sliding:?}");
    let corner = sliding.u + block.r0 * -libm::sin(block.alpha + sliding.theta);
    assert!((corner + block.b).abs() > 0.01, "L is at {corner} m");
}

proptest! {
    #![proptest_config(cases(120))]

    /// Changes of regime never gain energy, apart from the change of the horizontal constraint.
    #[test]
    fn no_energy_is_made(
        block in blocks(),
        (theta, theta_dot, height, v_dot) in (-0.3..0.3, -0.8..0.8, -1.0..3.0, -1.0..1.0),
        (amplitude, period) in (-15.0..15.0, 0.2..2.0),
    ) {
        let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.3, ..Pulse::NONE };
        let free = block.static_deflection();
        let initial = Initial {
            theta: theta * block.alpha,
            theta_dot: theta_dot * block.alpha * block.p,
            vertical: Some((height * free + f64::abs(theta) * block.alpha * block.b, v_dot * block.alpha * block.p * block.r0)),
        };
        let mut simulation = start(block, pulse, &initial);
        let mut largest = block.mass * (block.r0 * block.alpha * block.p).powi(2);
        let mut lost = f64::NEG_INFINITY;
        let step = 0.02 / block.omega_v.max(10.0);
        let mut time: f64 = 0.0;
        while time < 4.0 && simulation.ending().is_none() {
            time += step;
            let result = simulation.advance(time, &Inputs::default(), &mut |_| ());
            prop_assert!(result.is_ok(), "{result:?}");
            let energies = simulation.energies();
            largest = largest.max(energies.total.abs());
            // A support without its corner still stores energy, and returns some if the corner lands early.
            let seen = seen(&simulation);
            let left: f64 = Corner::BOTH
                .into_iter()
                .filter(|&corner| !simulation.regime().touches(corner))
                .map(|corner| free - (seen.corner[corner.index()] - seen.uplift[corner.index()]))
                .map(|depth| 0.5 * block.stiffness * depth * depth)
                .sum();
            let now = energies.impacts + energies.constraint - left;
            prop_assert!(now >= lost - 1e-9 * largest, "at {}: {lost} -> {now}, of {largest}, regime {}", simulation.time(), simulation.regime());
            lost = now;
            prop_assert!(energies.residual.abs() <= 1e-9 * largest, "residual {} of {largest} at {time}", energies.residual);
            prop_assert!(seen.reaction.iter().all(|&n| n >= -1e-3 * block.mass * block.gravity), "{:?}", seen.reaction);
        }
    }
}
