//! Outputs of all types change with the inputs and states that ModelStructure declares, and with no others.

use std::collections::BTreeMap;

use crate::derivatives::{INPUTS, SCENES, Scene, set_up};
use crate::functions::*;
use crate::host::{FMU, Instance, call};
use crate::solver::{NAMES, STATES, Solver};

/// Blocks that inputs make slide or lift at once.
const STANDING: [Scene; 6] = [
    ("gripping at rest on the rigid base", &[("foundation", 2.0), ("friction", 0.2)], 0.0),
    (
        "gripping with a corner of the rigid base",
        &[("foundation", 2.0), ("friction", 0.3), ("initial.theta", 0.1)],
        1.0,
    ),
    ("gripping in full contact", &[("friction", 0.3), ("initial.theta", 0.001)], 0.0),
    // The horizontal force is 0.4 % of the weight at the beginning and 0.3 % later.
    ("hardly gripping at rest on the rigid base", &[("foundation", 2.0), ("friction", 0.0042)], 0.0),
    ("sliding on the rigid base", &[("foundation", 2.0), ("friction", 1e-4)], 0.0),
    (
        "sliding with a corner of the rigid base",
        &[("foundation", 2.0), ("friction", 0.02), ("initial.theta", 0.1)],
        1.0,
    ),
];

/// Shifts of a known, relative to its size.
const SHIFTS: [f64; 6] = [1e-3, -1e-3, 0.3, -0.3, 3.0, -3.0];

/// The pairs of an output and a known with which it changed, each with the first scene.
type Pairs = BTreeMap<(&'static str, &'static str), &'static str>;

/// Returns the values of all outputs with their names.
fn outputs(instance: &Instance) -> Vec<(&'static str, f64)> {
    FMU.description.outputs().map(|output| (output.name.as_str(), instance.get(&output.name))).collect()
}

/// Adds the outputs that `known` changes.
fn note(
    scene: &'static str,
    instance: &Instance,
    before: &[(&'static str, f64)],
    known: &'static str,
    pairs: &mut Pairs,
) {
    for (&(name, before), (_, after)) in before.iter().zip(outputs(instance)) {
        if before != after {
            pairs.entry((name, known)).or_insert(scene);
        }
    }
}

/// Expects that each pair is declared.
fn assert_declared(pairs: &Pairs) {
    let is_declared =
        |name: &str, known| FMU.description.variable(name).dependencies.iter().any(|found| found == known);
    let undeclared: Vec<_> = pairs.iter().filter(|((name, known), _)| !is_declared(name, known)).collect();
    assert!(undeclared.is_empty(), "not in ModelStructure: {undeclared:#?}");
}

fn perturb_inputs(scene: &'static str, instance: &Instance, pairs: &mut Pairs) {
    // The input at the end of a step is that of its rate, to round-off.
    INPUTS.iter().for_each(|(input, _)| instance.set(input, instance.get(input)));
    let before = outputs(instance);
    for (input, size) in INPUTS {
        let value = instance.get(input);
        for shift in SHIFTS {
            instance.set(input, value + shift * size);
            note(scene, instance, &before, input, pairs);
        }
        instance.set(input, value);
        assert_eq!(outputs(instance), before, "{scene}: {input} set back");
    }
}

/// In Co-Simulation an input acts at once, so that it may also lift the block or make it slide in this instant.
#[test]
fn outputs_of_a_step_change_with_declared_inputs_alone() {
    let mut pairs = Pairs::new();
    for scene in SCENES.iter().chain(&STANDING) {
        perturb_inputs(scene.0, &set_up(scene), &mut pairs);
    }
    assert_declared(&pairs);
    for output in FMU.description.outputs() {
        for (input, _) in INPUTS.iter().filter(|(input, _)| output.dependencies.iter().any(|known| known == input)) {
            assert!(pairs.contains_key(&(output.name.as_str(), input)), "{} never changes with {input}", output.name);
        }
    }
}

/// In Continuous-Time Mode outputs that are discrete change at events alone, wherever a solver tries a state.
#[test]
fn outputs_between_events_change_with_declared_inputs_and_states_alone() {
    let mut pairs = Pairs::new();
    for scene in SCENES.iter().chain(&STANDING) {
        let instance = Instance::of(MODEL_EXCHANGE, "block", None, false);
        scene.1.iter().for_each(|&(name, value)| instance.set(name, value));
        instance.initialize(Some(1e-12));
        let mut solver = Solver::of(instance, true);
        solver.go(0.05, 1e-3);
        let (name, instance) = (scene.0, &solver.instance);
        perturb_inputs(name, instance, &mut pairs);
        let mut nominals = [f64::NAN; STATES];
        assert_eq!(call!(instance, get_nominals, nominals.as_mut_ptr(), STATES), OK);
        let before = outputs(instance);
        for (i, state) in NAMES.into_iter().enumerate() {
            for shift in SHIFTS {
                let mut states = solver.states;
                states[i] += shift * nominals[i];
                solver.set(solver.time, Some(&states));
                note(name, instance, &before, state, &mut pairs);
            }
            solver.set(solver.time, Some(&solver.states));
            assert_eq!(outputs(instance), before, "{name}: {state} set back");
        }
    }
    let discrete = FMU.description.outputs().filter(|output| output.kind != "Real");
    for output in discrete {
        let moved: Vec<_> = pairs.iter().filter(|((name, _), _)| *name == output.name).collect();
        assert!(moved.is_empty(), "{} changes between events: {moved:?}", output.name);
    }
    assert_declared(&pairs);
}
