//! Derivatives of a block stepped from outside.

use super::*;

/// Along the direction in which states and inputs change, outputs and energies change at the rates of the motion, and the balance
/// holds. An energy among the states changes only its own sum and the balance.
#[test]
fn derivatives_in_the_direction_of_the_motion_are_its_rates() {
    let inputs =
        Inputs { a_gx: Ramp { value: 1.0, rate: 20.0 }, a_gz: Ramp { value: -2.0, rate: 30.0 }, ..Inputs::default() };
    let rates = Inputs { a_gx: Ramp::held(20.0), a_gz: Ramp::held(30.0), ..Inputs::default() };
    let close = |a: f64, b: f64, size: f64| assert!((a - b).abs() <= 1e-11 * size, "{a}, {b}");
    let [on_supports, rigid] =
        [Foundation::Viscoelastic, Foundation::Rigid].map(|foundation| block(foundation, 0.25, 30.0, 0.1));
    let weight = on_supports.mass * on_supports.gravity;
    let tie = Tie { ground: [-0.2, -0.1], stiffness: weight, pretension: weight, damping: weight, ..Tie::default() };
    let mut tied = on_supports.with_ties(&[tie]).unwrap();
    tied.body.friction = 0.05;
    for (theta, block) in [(0.001, on_supports), (-0.1, on_supports), (0.1, rigid), (0.001, tied)] {
        let mut simulation = start(block, &Initial { theta, theta_dot: 0.3, vertical: None });
        simulation.advance(0.003, &inputs, &mut |_| ()).unwrap();
        assert_eq!(simulation.slides(), block.friction > 0.0);
        let (seen, energies) =
            simulation.directional(&inputs.moved_to(0.003), &simulation.derivatives(&inputs), &rates, 0.0);
        let moving = simulation.observe_rates(&inputs);
        for (a, b) in [
            (seen.theta, moving.theta),
            (seen.theta_ddot, moving.theta_ddot),
            (seen.v_ddot, moving.v_ddot),
            (seen.u_dot, moving.u_dot),
            (seen.reaction[0], moving.reaction[0]),
            (seen.reaction[1], moving.reaction[1]),
            (seen.horizontal, moving.horizontal),
            (seen.power[0], moving.power[0]),
        ] {
            close(a.re, b.re, b.re.abs());
            close(a.eps, b.eps, b.eps.abs().max(b.re.abs()));
        }
        let expected = simulation.energy_rates(&inputs);
        let size = expected.kinetic.abs() + expected.potential.abs();
        assert!(size > 1.0, "{expected:?}");
        assert_eq!(
            expected.friction > 1e-3 * size && expected.restraints.ties > 1e-3 * size,
            block.friction > 0.0,
            "{expected:?}"
        );
        for (a, b) in [
            (energies.kinetic, expected.kinetic),
            (energies.potential, expected.potential),
            (energies.total, expected.total),
            (energies.total, energies.input - energies.dashpots - energies.friction - energies.restraints.ties),
            (energies.friction, expected.friction),
            (energies.restraints.ties, expected.restraints.ties),
            (energies.input, expected.input),
            (energies.dashpots, expected.dashpots),
            (energies.residual, 0.0),
        ] {
            close(a, b, size);
        }
        // A power is the derivative of its sum, to the last bit.
        let [.., input, dashpots, friction, ties, dampers] = simulation.derivatives(&inputs);
        let seen = simulation.observe(&inputs);
        assert_eq!([input, dashpots], seen.power);
        assert_eq!(
            [friction, ties, dampers],
            [seen.friction_power, seen.restraint_power.ties, seen.restraint_power.dampers]
        );
        for (state, expected) in [
            (6, Energies { input: 1.0, residual: -1.0, ..Energies::default() }),
            (7, Energies { dashpots: 1.0, residual: 1.0, ..Energies::default() }),
            (8, Energies { friction: 1.0, residual: 1.0, ..Energies::default() }),
            (
                9,
                Energies {
                    restraints: restraints::RestraintEnergies { ties: 1.0, dampers: 0.0 },
                    residual: 1.0,
                    ..Energies::default()
                },
            ),
        ] {
            let direction = std::array::from_fn(|i| if i == state { 1.0 } else { 0.0 });
            assert_eq!(simulation.directional(&inputs, &direction, &Inputs::default(), 0.0).1, expected);
        }
    }
}

/// The derivatives of the energies of a block that is held are differences between the states that an importer may set: rates stay.
#[test]
fn derivatives_of_a_block_that_is_held_are_differences() {
    let settings =
        Settings { on_overturning: OnOverturning::Hold, on_separation: OnSeparation::Hold, ..Settings::default() };
    let inputs = Inputs::default();
    for (foundation, theta_dot) in
        [(Foundation::Viscoelastic, 6.0), (Foundation::Viscoelastic, -6.0), (Foundation::Rigid, 6.0)]
    {
        let block = block(foundation, 0.25, 40.0, 0.1);
        let initial = Initial { theta: 0.2_f64.copysign(theta_dot), theta_dot, vertical: None };
        let mut held = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
        held.advance(2.0, &inputs, &mut |_| ()).unwrap();
        assert!(held.is_frozen());
        let (states, size) = (held.states(&inputs), held.energies().total.abs());
        assert!(held.energies().kinetic > 0.0);
        for i in 0..STATES {
            let direction: ContinuousStates = std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
            let (_, found) = held.directional(&inputs, &direction, &Inputs::default(), 0.0);
            let step = 1e-5;
            let [before, after] = [-step, step].map(|change| {
                let mut moved = states;
                moved[i] += change;
                let mut held = held.clone();
                held.set_states(2.0, &moved);
                held.energies()
            });
            for (found, [before, after]) in [
                (found.kinetic, [before.kinetic, after.kinetic]),
                (found.potential, [before.potential, after.potential]),
                (found.total, [before.total, after.total]),
                (found.residual, [before.residual, after.residual]),
            ] {
                let difference = (after - before) / (2.0 * step);
                assert!((found - difference).abs() < 1e-6 * size, "state {i}: {found}, {difference}");
            }
        }
    }
}

/// With its states held, a block that has just lifted comes closer to its support, which recovers: the derivative with respect to time alone.
#[test]
fn an_uplift_shrinks_with_time_while_the_support_recovers() {
    let block = block(Foundation::Viscoelastic, 0.25, 30.0, 0.1);
    let mut simulation = start(block, &Initial { theta_dot: 0.5 * block.alpha * block.p, ..Initial::default() });
    let inputs = Inputs::default();
    let mut time = 0.0;
    while simulation.regime() == Regime::FullContact {
        time += 1e-5;
        simulation.advance(time, &inputs, &mut |_| ()).unwrap();
    }
    time += 3e-4;
    simulation.advance(time, &inputs, &mut |_| ()).unwrap();
    assert_eq!(simulation.regime(), Regime::TiltingRight);
    let states = simulation.states(&inputs);
    let (seen, _) = simulation.directional(&inputs, &[0.0; STATES], &inputs, 1.0);
    let uplift_at = |time: f64| {
        let mut later = simulation.clone();
        later.set_states(time, &states);
        later.observe(&inputs).uplift[0]
    };
    const STEP: f64 = 1e-6;
    let expected = (uplift_at(time + STEP) - uplift_at(time - STEP)) / (2.0 * STEP);
    assert!(expected < 0.0 && (seen.uplift[0].eps / expected - 1.0).abs() < 1e-5, "{:?}, not {expected}", seen.uplift);
}
