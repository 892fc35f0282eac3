//! Model Exchange: the test's own solver steps the block, and agrees with Co-Simulation.

use std::ptr::null_mut;

use crate::functions::OK;
use crate::host::{FMU, Instance, Wanted, call, reference};

/// Free rocking on a rigid base.
const RELEASED: [(&str, f64); 2] = [("foundation", 2.0), ("initial.theta", 0.1)];

const STATES: usize = 11;
const INDICATORS: usize = 22;

/// Result of `fmi3UpdateDiscreteStates`.
#[derive(Debug)]
struct Updated {
    terminates: bool,
    values_changed: bool,
    next_time: Option<f64>,
}

fn update(block: &Instance) -> Updated {
    let [mut more, mut terminates, mut nominals, mut values_changed, mut defined] = [true; 5];
    let mut next = f64::NAN;
    block.ok(call!(
        block,
        update_discrete_states,
        &mut more,
        &mut terminates,
        &mut nominals,
        &mut values_changed,
        &mut defined,
        &mut next
    ));
    assert!(!more && !nominals);
    Updated { terminates, values_changed, next_time: defined.then_some(next) }
}

fn ready(values: &[(&str, f64)]) -> Instance {
    let block = Instance::exchanged();
    block.set_all(values);
    block.ok(call!(block, enter_initialization_mode, false, 0.0, 0.0, false, 0.0));
    block.ok(call!(block, exit_initialization_mode));
    block
}

fn states(block: &Instance) -> [f64; STATES] {
    let mut states = [f64::NAN; STATES];
    block.ok(call!(block, get_continuous_states, states.as_mut_ptr(), STATES));
    states
}

fn put(block: &Instance, time: f64, states: &[f64; STATES]) {
    block.ok(call!(block, set_time, time));
    block.ok(call!(block, set_continuous_states, states.as_ptr(), STATES));
}

fn derivatives(block: &Instance, time: f64, states: &[f64; STATES]) -> [f64; STATES] {
    put(block, time, states);
    let mut derivatives = [f64::NAN; STATES];
    block.ok(call!(block, get_continuous_state_derivatives, derivatives.as_mut_ptr(), STATES));
    derivatives
}

/// The classical Runge-Kutta step.
fn step(block: &Instance, time: f64, states: &[f64; STATES], h: f64) -> [f64; STATES] {
    let moved = |rates: &[f64; STATES], h: f64| std::array::from_fn(|i| states[i] + h * rates[i]);
    let a = derivatives(block, time, states);
    let b = derivatives(block, time + 0.5 * h, &moved(&a, 0.5 * h));
    let c = derivatives(block, time + 0.5 * h, &moved(&b, 0.5 * h));
    let d = derivatives(block, time + h, &moved(&c, h));
    std::array::from_fn(|i| states[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

fn least_indicator(block: &Instance, time: f64, states: &[f64; STATES]) -> f64 {
    put(block, time, states);
    let mut indicators = [f64::NAN; INDICATORS];
    block.ok(call!(block, get_event_indicators, indicators.as_mut_ptr(), INDICATORS));
    let named = [
        "indicator.L",
        "indicator.R",
        "indicator.quarter_turn",
        "indicator.slide",
        "indicator.slip_R",
        "indicator.slip_L",
        "indicator.tie_1.taut",
        "indicator.tie_1.strength",
        "indicator.tie_1.yield",
        "indicator.tie_1.yield_back",
        "indicator.tie_2.taut",
        "indicator.tie_2.strength",
        "indicator.tie_2.yield",
        "indicator.tie_2.yield_back",
        "indicator.damper_1.thrust",
        "indicator.damper_1.strength",
        "indicator.damper_1.yield",
        "indicator.damper_1.yield_back",
        "indicator.damper_2.thrust",
        "indicator.damper_2.strength",
        "indicator.damper_2.yield",
        "indicator.damper_2.yield_back",
    ];
    assert_eq!(named.map(|name| block.get(name)), indicators);
    indicators.into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
fn an_external_solver_finds_the_impacts_of_co_simulation() {
    let inside = Instance::new(Wanted::default());
    inside.set_all(&RELEASED);
    inside.ok(call!(inside, enter_initialization_mode, true, 1e-12, 0.0, false, 0.0));
    inside.ok(call!(inside, exit_initialization_mode));
    let block = ready(&RELEASED);
    let first = update(&block);
    assert!(!first.terminates && first.next_time.is_none(), "{first:?}");
    block.ok(call!(block, enter_continuous_time_mode));
    let (mut time, mut x, mut impacts) = (0.0, states(&block), 0.0);
    let h = 1e-3;
    while impacts < 3.0 {
        let next = step(&block, time, &x, h);
        if least_indicator(&block, time + h, &next) >= 0.0 {
            (time, x) = (time + h, next);
            put(&block, time, &x);
            let (mut enter, mut terminate) = (true, true);
            block.ok(call!(block, completed_integrator_step, true, &mut enter, &mut terminate));
            assert!(!enter && !terminate);
            continue;
        }
        let (mut before, mut after) = (0.0, h);
        while after - before > 1e-13 {
            let middle = 0.5 * (before + after);
            let there = step(&block, time, &x, middle);
            if least_indicator(&block, time + middle, &there) < 0.0 { after = middle } else { before = middle }
        }
        x = step(&block, time, &x, after);
        time += after;
        put(&block, time, &x);
        block.ok(call!(block, enter_event_mode));
        let updated = update(&block);
        assert!(updated.values_changed && !updated.terminates, "{updated:?}");
        block.ok(call!(block, enter_continuous_time_mode));
        x = states(&block);
        impacts += 1.0;
        inside.step(inside.get("time"), time + 1e-6 - inside.get("time"));
        assert_eq!((inside.get("events.impacts"), block.get("events.impacts")), (impacts, impacts));
        // Runge–Kutta steps of 1 ms give ten digits of a motion with p = 1 rad/s.
        assert!((inside.get("events.last_time") - time).abs() < 1e-9, "{time}");
    }
    assert_eq!(block.get("time"), time);
    block.ok(call!(block, terminate));
}

#[test]
fn sizes_are_reported_and_checked() {
    let block = ready(&RELEASED);
    let (mut states, mut indicators) = (0, 0);
    block.ok(call!(block, get_number_of_continuous_states, &mut states));
    block.ok(call!(block, get_number_of_event_indicators, &mut indicators));
    assert_eq!((states, indicators), (STATES, INDICATORS));
    let mut values = [f64::NAN; STATES];
    block.ok(call!(block, get_nominals_of_continuous_states, values.as_mut_ptr(), STATES));
    assert!(values.iter().all(|nominal| *nominal > 0.0));
    block.refuses(call!(block, get_continuous_states, values.as_mut_ptr(), 3), &["room for 3", "11"]);
    // The pulse's beginning is the next event.
    let pulsed = ready(&[("pulse.shape", 2.0), ("pulse.amplitude", 1.0), ("pulse.start", 0.25)]);
    assert_eq!(update(&pulsed).next_time, Some(0.25));
}

#[test]
fn functions_of_the_other_interface_are_refused() {
    let block = ready(&RELEASED);
    let other = "found an instance for Model Exchange; expected one for Co-Simulation";
    block.refuses(block.try_step(0.0, 0.1).0, &["fmi3DoStep", other]);
    block.refuses(call!(block, enter_step_mode), &["fmi3EnterStepMode", other]);
    block.refuses(call!(block, set_time, 0.5 / 0.0), &["time = inf"]);
    // A state of the other interface type is refused, too.
    let stepped = Instance::new(Wanted::default());
    let mut state = null_mut();
    assert_eq!(call!(stepped, get_fmu_state, &mut state), OK);
    block.refuses(call!(block, set_fmu_state, state), &["CoSimulation", "ModelExchange"]);
    assert_eq!(call!(stepped, free_fmu_state, &mut state), OK);
}

/// Unknowns of ModelStructure, by value reference, with their dependencies and their kinds.
fn structure(element: &str) -> Vec<(u32, Vec<u32>)> {
    let text = std::str::from_utf8(&FMU.files["modelDescription.xml"]).unwrap();
    let document = roxmltree::Document::parse(text).unwrap();
    let unknowns = document.descendants().filter(|node| node.has_tag_name(element));
    let numbers = |text: &str| text.split_whitespace().map(|number| number.parse().unwrap()).collect::<Vec<u32>>();
    unknowns
        .map(|node| {
            let dependencies = numbers(node.attribute("dependencies").unwrap_or(""));
            let kinds = node.attribute("dependenciesKind").unwrap_or("").split_whitespace().count();
            assert_eq!(kinds, dependencies.len(), "{node:?}");
            (node.attribute("valueReference").unwrap().parse().unwrap(), dependencies)
        })
        .collect()
}

/// Unknowns that change with time alone, under a pulse or above a creeping support, declare it.
#[test]
fn dependence_on_time_is_declared() {
    let supports: &[(&str, f64)] = &[("initial.theta", 0.05), ("initial.theta_dot", 0.1)];
    let mut found = std::collections::BTreeSet::new();
    for foundation in [1.0, 2.0] {
        let pulse = [("foundation", foundation), ("pulse.shape", 2.0), ("pulse.amplitude", 6.0)];
        let block = ready(&[supports, &pulse].concat());
        update(&block);
        block.ok(call!(block, enter_continuous_time_mode));
        let x = states(&block);
        let time = reference("time");
        for element in ["Output", "ContinuousStateDerivative"] {
            for (unknown, dependencies) in structure(element) {
                let Some(name) = FMU.variables.iter().find(|(_, of)| of.reference == unknown && of.kind == "Float64")
                else {
                    continue;
                };
                let values = [0.1, 0.2].map(|time| {
                    put(&block, time, &x);
                    block.get(name.0)
                });
                if values[0] != values[1] {
                    assert!(dependencies.contains(&time), "{element} {}: {values:?}", name.0);
                    found.insert(name.0.clone());
                }
            }
        }
    }
    for name in ["theta_ddot", "u_ddot", "H", "power.input", "friction_demand"] {
        assert!(found.contains(name), "{name}: {found:?}");
    }
    // A support creeps up after its corner has left it.
    let time = reference("time");
    for name in ["uplift_L", "uplift_R"] {
        let declared = structure("Output").into_iter().find(|(unknown, _)| *unknown == reference(name));
        assert!(declared.is_some_and(|(_, dependencies)| dependencies.contains(&time)), "{name}");
    }
}

/// States may jump at events (`reinit`), and indicators have no unit.
#[test]
fn states_and_indicators_are_described_in_the_file() {
    for name in ["theta", "theta_dot", "v", "v_dot", "u", "u_dot"] {
        assert_eq!(FMU.variables[name].attributes.get("reinit").map(String::as_str), Some("true"), "{name}");
    }
    for (name, variable) in FMU.variables.iter().filter(|(_, variable)| variable.kind == "Float64") {
        assert!(variable.attributes.contains_key("unit"), "{name}");
    }
}

/// Derivatives with respect to time equal differences at the same states, under a pulse and above a creeping support.
#[test]
fn derivatives_with_respect_to_time_match_differences() {
    for foundation in [1.0, 2.0] {
        let pulse = [("foundation", foundation), ("pulse.shape", 3.0), ("pulse.amplitude", 3.0), ("pulse.period", 0.7)];
        let block =
            ready(&[&pulse[..], &[("initial.theta", 0.1), ("initial.theta_dot", -0.1), ("F_x", 20.0)]].concat());
        update(&block);
        block.ok(call!(block, enter_continuous_time_mode));
        let x = states(&block);
        let (at, h, known) = (0.2, 1e-4, reference("time"));
        let declared = structure("Output").into_iter().filter(|(_, dependencies)| dependencies.contains(&known));
        let mut moved = 0;
        for (unknown, _) in declared {
            let (name, variable) = FMU.variables.iter().find(|(_, variable)| variable.reference == unknown).unwrap();
            if variable.kind != "Float64" {
                continue;
            }
            let value = |time: f64| {
                put(&block, time, &x);
                block.get(name)
            };
            let difference = (value(at + h) - value(at - h)) / (2.0 * h);
            let size = value(at).abs().max(1e-3);
            let (mut derivative, mut adjoint) = (f64::NAN, f64::NAN);
            block.ok(call!(block, get_directional_derivative, &unknown, 1, &known, 1, &1.0, 1, &mut derivative, 1));
            block.ok(call!(block, get_adjoint_derivative, &unknown, 1, &known, 1, &1.0, 1, &mut adjoint, 1));
            assert_eq!(derivative, adjoint, "{name}");
            // Central differences of a motion of 9 rad/s: (9 h)²/6.
            assert!((derivative - difference).abs() <= 1e-6 * 9.0 * size, "{name}: {derivative}, {difference}");
            moved += u32::from(derivative != 0.0);
        }
        assert!(moved >= 5, "{moved}");
    }
}
