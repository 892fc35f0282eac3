//! Derivatives of the outputs of the block in space, compared with finite differences.

use crate::exchange_in_space::{SHAKEN, Solver, names};
use crate::functions::*;
use crate::host::{FMU, Instance, call, reference};
use crate::unit::STATE_COUNT;

/// Returns the derivatives of unknowns with respect to one variable.
fn derivatives(instance: &Instance, unknowns: &[u32], known: &str) -> Vec<f64> {
    let mut found = vec![f64::NAN; unknowns.len()];
    let (known, count, into) = (reference(known), unknowns.len(), found.as_mut_ptr());
    let status = call!(instance, get_directional_derivative, unknowns.as_ptr(), count, &known, 1, &1.0, into);
    assert_eq!(status, OK, "{:?}", instance.messages());
    found
}

/// Derivatives of all outputs with respect to inputs and states, by five points, and the declared dependencies.
#[test]
fn directional_derivatives_are_exact_and_dependencies_true() {
    let names = names();
    let inputs = FMU.description.variables.iter().filter(|variable| variable.causality == "input");
    let inputs: Vec<&str> = inputs.map(|variable| variable.name.as_str()).collect();
    let outputs: Vec<_> = FMU.description.real_outputs().cloned().collect();
    let unknowns: Vec<u32> = outputs.iter().map(|output| output.reference).collect();
    let read = |solver: &Solver| {
        let mut values = vec![f64::NAN; unknowns.len()];
        assert_eq!(call!(solver.instance, get_real, unknowns.as_ptr(), unknowns.len(), values.as_mut_ptr()), OK);
        values
    };
    let (mut moved, mut touching) = (std::collections::BTreeSet::new(), std::collections::BTreeSet::new());
    // With much friction feet lift, with little they slide all the time.
    let mut solvers =
        [0.4, 0.1].map(|friction| Solver::begin(&[&SHAKEN[..], &[("friction", friction)]].concat(), true));
    for solver in &solvers {
        inputs.iter().for_each(|input| solver.instance.set(input, 0.2));
    }
    let mut nominals = [f64::NAN; STATE_COUNT];
    assert_eq!(call!(solvers[0].instance, get_nominals, nominals.as_mut_ptr(), STATE_COUNT), OK);
    for i in 2..30 {
        let solver = &mut solvers[i % 2];
        solver.go(0.13 * (i / 2) as f64, 1e-3);
        touching.insert(solver.instance.get("touching") as u32);
        let (time, states) = (solver.time, solver.states);
        let knowns = names.iter().map(|(name, _)| name.as_str()).chain(inputs.iter().copied());
        for (k, known) in knowns.enumerate() {
            let step = if k < STATE_COUNT { 1e-5 * nominals[k] } else { 1e-2 };
            let at = |places: f64| {
                if k < STATE_COUNT {
                    let mut states = states;
                    states[k] += places * step;
                    solver.set(time, Some(&states));
                } else {
                    solver.instance.set(known, 0.2 + places * step);
                }
                read(solver)
            };
            let values = [-2.0, -1.0, 1.0, 2.0].map(at);
            at(0.0);
            let exact = derivatives(&solver.instance, &unknowns, known);
            for (i, output) in outputs.iter().enumerate() {
                let [a, b, c, d] = [0, 1, 2, 3].map(|j: usize| values[j][i]);
                let difference = (a - 8.0 * b + 8.0 * c - d) / (12.0 * step);
                // Energies are sums and differences of some 300 J.
                let size = if output.name.starts_with("energy") { 300.0 } else { 0.0 };
                let rounding = 1e-13 * b.abs().max(c.abs()).max(size) / step;
                assert!(
                    (difference - exact[i]).abs() <= 1e-5 * exact[i].abs() + 100.0 * rounding,
                    "d {}/d {known} = {}, by differences {difference}, at t = {time}",
                    output.name,
                    exact[i]
                );
                if exact[i] != 0.0 || values.iter().any(|value| value[i] != values[0][i]) {
                    assert!(output.dependencies.iter().any(|name| name == known), "{} of {known}", output.name);
                    moved.insert((output.name.clone(), known.to_string()));
                }
            }
        }
    }
    assert!(touching.len() > 2, "{touching:?}");
    // Each declared dependency is one, at some time.
    for output in &outputs {
        for known in &output.dependencies {
            assert!(
                moved.contains(&(output.name.clone(), known.clone())),
                "{} does not depend on {known}",
                output.name
            );
        }
    }
}

/// A frictionless foot at rest has no direction of slip, and finite derivatives.
#[test]
fn derivatives_are_finite_where_nothing_moves() {
    let solver = Solver::begin(&[("friction", 0.0)], true);
    for unknown in ["slip_rate_SW", "stretch_x_rate_SW", "power.slip", "u_ddot", "friction_demand"] {
        for known in ["u_dot", "stretch_x_SW", "v", "a_gx"] {
            let (unknown, known, mut found) = (reference(unknown), reference(known), f64::NAN);
            let i = &solver.instance;
            assert_eq!(call!(i, get_directional_derivative, &unknown, 1, &known, 1, &1.0, &mut found), OK);
            assert!(found.is_finite());
        }
    }
}

/// What is no direction, or no unknown, is refused by name.
#[test]
fn other_directions_are_refused() {
    let derivative = |instance: &Instance, unknown: &str, known: &str, component: f64| {
        let (unknown, known) = (reference(unknown), reference(known));
        call!(instance, get_directional_derivative, &unknown, 1, &known, 1, &component, &mut 0.0)
    };
    let solver = Solver::begin(&SHAKEN, true);
    let i = &solver.instance;
    i.refuses(derivative(i, "tilt", "mass", 1.0), &["mass", "expected an input"]);
    i.refuses(derivative(i, "tilt", "tilt", 1.0), &["tilt", "expected an input"]);
    i.refuses(derivative(i, "derived.alpha", "a_gx", 1.0), &["derived.alpha", "expected an output"]);
    i.refuses(derivative(i, "u_ddot", "a_gx", f64::NAN), &["NaN", "a_gx"]);
    let slave = Instance::with_start_values(CO_SIMULATION, "slave", None, false);
    assert_eq!(slave.setup(None, 0.0, None), OK);
    assert_eq!(call!(slave, enter_initialization_mode), OK);
    slave.refuses(derivative(&slave, "tilt", "initial.tilt_x", 1.0), &["initial.tilt_x", "expected an input"]);
    let mut found = f64::NAN;
    let (unknown, known) = (reference("u_ddot"), reference("a_gx"));
    assert_eq!(call!(slave, get_directional_derivative, &unknown, 1, &known, 1, &1.0, &mut found), OK);
    assert_eq!(found, -1.0);
    // States are no knowns of Co-Simulation.
    assert_eq!(call!(slave, exit_initialization_mode), OK);
    slave.refuses(derivative(&slave, "tilt", "q_w", 1.0), &["q_w", "expected an input"]);
}

/// Co-Simulation has the derivatives of blocks on any number of feet, those of a circle, too.
#[test]
fn a_block_on_a_circle_of_feet_has_derivatives() {
    for base in [1.0, 2.0] {
        let instance = Instance::new("block");
        instance.set("base", base);
        instance.initialize(None);
        instance.go(0.0, 0.1, 0.05);
        assert_eq!(derivatives(&instance, &[reference("u_ddot"), reference("w_ddot")], "a_gx"), [-1.0, 0.0], "{base}");
    }
}
