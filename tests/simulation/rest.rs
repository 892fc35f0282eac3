//! Blocks that come to rest, and motions too violent for any step.

use rocking_block::block::{Block, Body, Foundation};
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::{Initial, Settings, Simulation, SimulationError};

use crate::blocks::on;

fn start(block: Block, initial: Initial) -> Simulation {
    Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &Inputs::default())
}

fn pushed(time: f64, a_gx: f64) -> Inputs {
    Inputs { time, a_gx: Ramp::held(a_gx), ..Inputs::default() }
}

/// Motion decays to rest, not to subnormal numbers.
///
/// From then on a step of any length costs one evaluation, until ground motion moves the block again.
#[test]
fn a_block_that_has_decayed_is_at_rest() {
    let block = on(Foundation::Viscoelastic, 0.25, 1.0, 40.0, 0.1);
    let mut simulation = start(block, Initial { theta: 0.001, ..Initial::default() });
    simulation.advance(1000.0, &Inputs::default(), &mut |_| ()).unwrap();
    assert!(simulation.state().0.iter().all(|x| *x == 0.0 || x.is_normal()), "{:?}", simulation.state());
    let energies = simulation.energies();
    assert!(energies.residual.abs() < 1e-8 * energies.dashpots, "{energies:?}");
    let (state, evaluations) = (*simulation.state(), simulation.counts().evaluations);
    for time in [1001.0, 1e6, 1e300] {
        simulation.advance(time, &Inputs::default(), &mut |_| ()).unwrap();
        assert_eq!((simulation.time(), *simulation.state()), (time, state));
    }
    assert_eq!(simulation.counts().evaluations, evaluations + 3);

    let mut simulation = start(block, Initial { theta: 0.001, ..Initial::default() });
    simulation.advance(1000.0, &Inputs::default(), &mut |_| ()).unwrap();
    simulation.advance(1000.1, &pushed(1000.0, 0.1), &mut |_| ()).unwrap();
    assert!(simulation.state()[1].abs() > 1e-4, "{:?}", simulation.state());
}

/// Under a constant push the block comes to rest in equilibrium: with `S = sin θ`, `c = cos θ`,
/// `ω_v² b² S c = −h c a_gx + h S g` (docs/unit/model.md, full contact without motion).
#[test]
fn a_pushed_block_rests_where_the_supports_balance_it() {
    let block = on(Foundation::Viscoelastic, 0.25, 1.0, 40.0, 0.2);
    let mut simulation = start(block, Initial::default());
    let inputs = pushed(0.0, 0.3);
    simulation.advance(100.0, &inputs, &mut |_| ()).unwrap();
    let evaluations = simulation.counts().evaluations;
    simulation.advance(1e9, &inputs.moved_to(100.0), &mut |_| ()).unwrap();
    assert_eq!(simulation.counts().evaluations, evaluations + 1);
    let seen = simulation.observe(&inputs.moved_to(1e9));
    let (sin, cos) = seen.theta.sin_cos();
    let Body { b, h, omega_v, gravity, .. } = block.body;
    let balance = omega_v * omega_v * b * b * sin * cos + h * cos * 0.3 - h * sin * gravity;
    assert!(balance.abs() < 1e-11 * gravity * h, "{balance} at θ = {}", seen.theta);
    assert!(seen.theta < -1e-4, "expected a lean away from the push: {}", seen.theta);
    assert_eq!([seen.theta_dot, seen.v_dot], [0.0; 2]);
}

#[test]
fn a_block_on_the_rigid_base_rests_for_ever() {
    let mut simulation = start(on(Foundation::Rigid, 0.25, 1.0, 40.0, 0.1), Initial::default());
    simulation.advance(1e300, &pushed(0.0, 1.0), &mut |_| ()).unwrap();
    assert_eq!(simulation.counts().evaluations, 1);
    // The block stands on both corners; the push loads one more than the other.
    let [left, right] = simulation.observe(&pushed(1e300, 1.0)).reaction;
    assert!(left > right && right > 0.0);
}

/// Loads on a block that stays at rest on the rigid base count in the peaks.
#[test]
fn loads_on_a_resting_block_are_peaks() {
    let block = on(Foundation::Rigid, 0.25, 1.0, 40.0, 0.1);
    let mut simulation = start(block, Initial::default());
    simulation.advance(1.0, &Inputs::default(), &mut |_| ()).unwrap();
    let weight = block.mass * block.gravity;
    let (f_x, f_z) = (0.1 * weight, -0.5 * weight);
    let inputs = Inputs { time: 1.0, f_x: Ramp::held(f_x), f_z: Ramp::held(f_z), ..Inputs::default() };
    simulation.advance(2.0, &inputs, &mut |_| ()).unwrap();
    simulation.advance(3.0, &Inputs::default(), &mut |_| ()).unwrap();
    let peaks = simulation.peaks();
    let reaction = 0.75 * weight + 0.5 * f_x * block.h / block.b;
    for (found, exact) in
        [(peaks.reaction, reaction), (peaks.horizontal, f_x), (peaks.friction_demand, f_x / (1.5 * weight))]
    {
        assert!((found / exact - 1.0).abs() < 1e-12, "{found}, not {exact}");
    }
}

/// An undamped block never rests: an endless step fails, names the time reached and can be continued from there.
#[test]
fn an_endless_step_fails_and_can_be_continued() {
    let mut simulation =
        start(on(Foundation::Viscoelastic, 0.25, 1.0, 40.0, 0.0), Initial { theta: 1e-4, ..Initial::default() });
    let error = simulation.advance(1e300, &Inputs::default(), &mut |_| ()).unwrap_err();
    let SimulationError::TooManySteps { time, until, steps, .. } = error else { panic!("{error}") };
    assert_eq!((time, until), (simulation.time(), 1e300));
    assert_eq!(simulation.counts().steps + simulation.counts().rejected, steps);
    assert!(time > 1000.0, "{time}");
    assert!(error.to_string().contains(&format!("t = {time} s after {steps} steps towards t = ")), "{error}");
    simulation.advance(time + 1.0, &Inputs::default(), &mut |_| ()).unwrap();
}

/// The error of a finite acceleration that makes every step overflow names the overflow, not the tolerance.
#[test]
fn a_motion_that_overflows_is_named() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let mut simulation = start(on(foundation, 0.25, 1.0, 40.0, 0.1), Initial::default());
        let error = simulation.advance(1.0, &pushed(0.0, 1e305), &mut |_| ()).unwrap_err();
        assert_eq!(error, SimulationError::NotFinite { time: 0.0 });
    }
}
