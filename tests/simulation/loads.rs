//! Loads from a structural model: F_x, F_z and M_y on the centre of mass, on every foundation and in flight.

use rocking_block::block::restraints::{Tie, TieState};
use rocking_block::block::{Block, Common, Foundation, Regime};
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::{Energies, Initial, OnSeparation, Settings, Simulation};

use crate::blocks;

fn block(foundation: Foundation) -> Block {
    let common = Common { epsilon: 0.2, mass: 250.0, ..Common::default() };
    blocks::block_on(foundation, [0.25, 2.0, 40.0, 0.1], &common)
}

fn start(foundation: Foundation, initial: &Initial) -> Simulation {
    let settings = Settings { tolerance: 1e-11, on_separation: OnSeparation::Fly, ..Settings::default() };
    Simulation::new(block(foundation), settings, Pulse::NONE, initial, 0.0, &Inputs::default())
}

/// In the frame of the ground a force on the centre of mass equals an opposite ground acceleration.
#[test]
fn a_force_equals_an_opposite_ground_acceleration() {
    let thrown = Initial { theta: 0.03, theta_dot: 0.2, vertical: Some((0.2, 0.5)) };
    for (foundation, initial, regime) in [
        (Foundation::Viscoelastic, Initial::default(), Regime::TiltingRight),
        (Foundation::Viscoelastic, thrown, Regime::Separated),
        (Foundation::Rigid, Initial::default(), Regime::TiltingRight),
    ] {
        let [mut shaken, mut loaded] = [(); 2].map(|()| start(foundation, &initial));
        let mass = shaken.block().mass;
        let mut there = false;
        for i in 0..200 {
            let time = 0.01 * f64::from(i);
            let (a_x, a_z) = (-4.0 * libm::cos(5.0 * time), 2.0 * libm::sin(9.0 * time));
            let [a_gx, a_gz] = [a_x, a_z].map(Ramp::held);
            let [f_x, f_z] = [a_x, a_z].map(|a| Ramp::held(-mass * a));
            let ground = Inputs { time, a_gx, a_gz, ..Inputs::default() };
            let load = Inputs { time, f_x, f_z, ..Inputs::default() };
            shaken.advance(0.01 * f64::from(i + 1), &ground, &mut |_| ()).unwrap();
            loaded.advance(0.01 * f64::from(i + 1), &load, &mut |_| ()).unwrap();
            let [a, b] = [shaken.observe(&ground), loaded.observe(&load)];
            for (a, b) in [(a.theta, b.theta), (a.theta_dot, b.theta_dot), (a.v, b.v), (a.u, b.u), (a.u_ddot, b.u_ddot)]
            {
                assert!((a - b).abs() < 1e-9, "{foundation:?}, t = {time}: {a} or {b}");
            }
            // The reactions agree as well: H balances force and inertia.
            assert!((a.horizontal - b.horizontal).abs() < 1e-6 && (a.reaction[0] - b.reaction[0]).abs() < 1e-6);
            there |= shaken.regime() == regime;
        }
        assert!(there, "{foundation:?} never came to {regime}");
    }
}

/// `M_y > M g b` lifts a corner of a block at rest on the rigid base and turns it by Newton's law.
#[test]
fn a_moment_starts_rocking_where_it_balances_the_weight() {
    let block = block(Foundation::Rigid);
    let limit = block.mass * block.gravity * block.b;
    for (part, regime) in [(0.999, Regime::FullContact), (1.001, Regime::TiltingRight), (-1.001, Regime::TiltingLeft)] {
        let mut simulation = start(Foundation::Rigid, &Initial::default());
        let inputs = Inputs { m_y: Ramp::held(part * limit), ..Inputs::default() };
        simulation.advance(0.01, &inputs, &mut |_| ()).unwrap();
        assert_eq!(simulation.regime(), regime, "{part} of the limit");
        if regime != Regime::FullContact {
            let exact = part.signum() * 0.001 * limit / (block.mass * (block.i0 + block.r0 * block.r0));
            let found = simulation.observe(&inputs).theta_ddot;
            assert!((found / exact - 1.0).abs() < 1e-2, "{found}, exact {exact}");
        }
    }
}

/// The energy balance contains the work of the loads, integrated here from the motion.
#[test]
fn the_work_of_loads_is_in_the_energy_sums() {
    let thrown = Initial { theta: 0.03, theta_dot: 0.2, vertical: Some((0.2, 0.5)) };
    for (foundation, initial) in [
        (Foundation::Viscoelastic, Initial { theta: 0.1, ..Initial::default() }),
        (Foundation::Viscoelastic, thrown),
        (Foundation::Rigid, Initial { theta: 0.1, ..Initial::default() }),
    ] {
        let mut simulation = start(foundation, &initial);
        let inputs = Inputs {
            f_x: Ramp { value: 200.0, rate: -300.0 },
            f_z: Ramp { value: -150.0, rate: 100.0 },
            m_y: Ramp { value: 100.0, rate: -250.0 },
            ..Inputs::default()
        };
        let power = |simulation: &Simulation| {
            let (x, now) = (simulation.observe(&inputs), inputs.moved_to(simulation.time()));
            now.f_x.value * x.u_dot + now.f_z.value * x.v_dot + now.m_y.value * x.theta_dot
        };
        let (mut work, mut before) = (0.0, power(&simulation));
        let step = 1e-4;
        for i in 1..=10_000 {
            simulation.advance(step * f64::from(i), &inputs, &mut |_| ()).unwrap();
            let now = power(&simulation);
            work += 0.5 * step * (before + now);
            before = now;
        }
        let energies = simulation.energies();
        let largest = energies.total.abs().max(energies.input.abs());
        assert!((energies.input - work).abs() < 1e-4 * largest, "{} or {work}", energies.input);
        assert!(energies.input.abs() > 0.05 * largest && energies.residual.abs() < 1e-9 * largest, "{energies:?}");
    }
}

/// The powers of a block that slides between ties are the rates of its energy sums, by central differences.
#[test]
fn powers_are_the_rates_of_the_energy_sums() {
    let common = Common { mass: 250.0, friction: 0.2, ..Common::default() };
    let plain = blocks::block([0.25, 2.0, 40.0, 0.1], &common);
    let weight = plain.mass * plain.gravity;
    let tie = Tie {
        block: [-plain.b, plain.h],
        ground: [-4.0 * plain.b, 0.0],
        stiffness: weight,
        damping: 0.3 * weight,
        ..Tie::default()
    };
    let block = plain.with_ties(&[tie]).unwrap();
    let ramp = |value: f64, rate: f64| Ramp { value, rate };
    let inputs = Inputs {
        a_gx: ramp(-5.0, 8.0),
        a_gz: ramp(0.5, -2.0),
        f_x: ramp(200.0, -300.0),
        f_z: ramp(-150.0, 100.0),
        m_y: ramp(30.0, -50.0),
        ..Inputs::default()
    };
    let settings = Settings { tolerance: 1e-13, ..Settings::default() };
    let mut simulation = Simulation::new(block, settings, Pulse::NONE, &Initial::default(), 0.0, &inputs);
    let h = 1e-4;
    let [(before, _), (_, seen), (after, _)] = [0.1 - h, 0.1, 0.1 + h].map(|time| {
        simulation.advance(time, &inputs, &mut |_| ()).unwrap();
        assert!(simulation.slides() && simulation.restraints().ties[0] == TieState::Taut, "{simulation:?}");
        (simulation.energies(), simulation.observe(&inputs.moved_to(time)))
    });
    let rate = |of: fn(&Energies) -> f64| (of(&after) - of(&before)) / (2.0 * h);
    for (name, power, rate) in [
        ("input", seen.power[0], rate(|sums| sums.input)),
        ("dashpots", seen.power[1], rate(|sums| sums.dashpots)),
        ("friction", seen.friction_power, rate(|sums| sums.friction)),
        ("ties", seen.restraint_power.ties, rate(|sums| sums.restraints.ties)),
    ] {
        // The supports vibrate at ω_v, with an error of (ω_v h)²/6.
        assert!(power != 0.0 && (power / rate - 1.0).abs() < 1e-4, "{name}: {power} W, {rate} W by difference");
    }
}

/// Inputs and records with different reference times add up at any time.
#[test]
fn inputs_add_up_at_any_time() {
    let ramp = |value: f64, rate: f64| Ramp { value, rate };
    let one = Inputs { time: 1.0, a_gx: ramp(2.0, 3.0), f_z: ramp(-4.0, 0.5), ..Inputs::default() };
    let other = Inputs { time: 3.0, a_gx: ramp(-1.0, 5.0), m_y: ramp(6.0, -7.0), ..Inputs::default() };
    let sum = one.plus(&other);
    for time in [0.0, 1.0, 4.5] {
        let [sum, one, other] = [sum, one, other].map(|inputs| inputs.moved_to(time));
        for (sum, one, other) in
            [(sum.a_gx, one.a_gx, other.a_gx), (sum.f_z, one.f_z, other.f_z), (sum.m_y, one.m_y, other.m_y)]
        {
            assert_eq!((sum.value, sum.rate), (one.value + other.value, one.rate + other.rate), "at {time} s");
        }
    }
}

/// A line from inputs to others, as an importer sets them at the ends of a step, has the values of both; inputs that are held keep theirs.
#[test]
fn a_line_joins_two_sets_of_inputs() {
    let inputs = |time: f64, values: [f64; 5]| {
        let [a_gx, a_gz, f_x, f_z, m_y] = values.map(|value| Ramp { value, rate: 7.0 });
        Inputs { time, a_gx, a_gz, f_x, f_z, m_y }
    };
    let values = |inputs: Inputs| [inputs.a_gx, inputs.a_gz, inputs.f_x, inputs.f_z, inputs.m_y].map(|ramp| ramp.value);
    let (first, last) = ([1.0, -2.0, 3.0, 5.0, -8.0], [0.5, 4.0, -1.5, 6.5, 2.0]);
    let (start, end) = (inputs(0.75, first), inputs(1.25, last));
    let line = start.line_to(&end);
    assert_eq!((values(line), values(line.moved_to(1.25))), (first, last));
    assert_eq!(values(line.moved_to(1.0)), std::array::from_fn(|i| 0.5 * (first[i] + last[i])));
    let mut held = start;
    held.hold();
    assert_eq!(values(held.moved_to(3.0)), first);
    assert!(start.is_finite());
    for i in 0..5 {
        let mut broken = first;
        broken[i] = f64::NAN;
        assert!(!inputs(0.0, broken).is_finite() && !inputs(f64::INFINITY, first).is_finite());
    }
    assert!(!Inputs { f_x: Ramp { value: 0.0, rate: f64::INFINITY }, ..start }.is_finite());
}
