//! Model Exchange (the standard, chapter 3): a simple [`Solver`] of the importer steps the block.

use crate::functions::*;
use crate::host::{FMU, Instance, call, reference};
use crate::solver::{DERIVATIVES, INDICATORS, NAMES, STATES, Solver, States, ground};

const FLYING: [(&str, f64); 6] = [
    ("dimensionless.alpha", 0.3),
    ("dimensionless.p", 2.0),
    ("dimensionless.eta", 25.0),
    ("dimensionless.xi_v", 0.05),
    ("epsilon", 0.6),
    ("on_separation", 3.0),
];

/// In flight and under nonlinear inputs, the motion matches Co-Simulation in steps short enough for linear inputs.
#[test]
fn a_simple_solver_follows_flights_under_arbitrary_inputs() {
    let mut solver = Solver::begin(&FLYING);
    let slave = Instance::new("slave");
    FLYING.iter().for_each(|&(name, value)| slave.set(name, value));
    slave.initialize(Some(1e-10));
    let (mut flown, step) = (0, 1.0 / 2048.0);
    for i in 0..3072 {
        let time = f64::from(i) * step;
        for (j, name) in ["a_gx", "a_gz"].into_iter().enumerate() {
            let (here, there) = (ground(time)[j], ground(time + step)[j]);
            slave.set(name, here);
            slave.set_rate(name, (there - here) / step);
        }
        slave.step(time, step);
        solver.go(time + step, step);
        flown += u32::from(slave.get("regime") == 2.0);
        let regimes = [&slave, &solver.instance].map(|instance| instance.get("regime"));
        for name in ["theta", "v", "u"] {
            let (a, b) = (slave.get(name), solver.instance.get(name));
            assert!((a - b).abs() < 2e-5, "{name} at t = {}: {a}, {b} in {regimes:?}", time + step);
        }
    }
    assert!(flown > 50, "{flown} steps in flight");
    assert!(solver.events >= 8, "{} events", solver.events);
    for name in ["events.impacts", "events.liftoffs"] {
        assert_eq!(slave.get(name), solver.instance.get(name), "{name}");
    }
    for (name, part) in [("peak.theta", 1e-3), ("peak.uplift", 1e-3), ("energy.input", 1e-3), ("energy.dashpots", 1e-3)]
    {
        let (a, b) = (slave.get(name), solver.instance.get(name));
        assert!((a - b).abs() < part * a.abs(), "{name}: {a}, {b}");
    }
}

/// States, derivatives and nominal values are those of the variables named in the description.
#[test]
fn states_are_the_declared_variables() {
    let count = format!("numberOfEventIndicators=\"{INDICATORS}\"");
    assert!(FMU.xml.contains(&count), "the description has no {count}");
    let mut solver = Solver::begin(&FLYING);
    solver.go(0.9, 1e-3);
    let set: States = std::array::from_fn(|i| solver.states[i] * (1.0 + 1e-7));
    let derivatives = solver.derivatives(solver.time, &set);
    let mut states = [f64::NAN; STATES];
    assert_eq!(call!(solver.instance, get_continuous_states, states.as_mut_ptr(), STATES), OK);
    assert_eq!(states, set);
    for i in 0..STATES {
        let (value, rate) = (solver.instance.get(NAMES[i]), solver.instance.get(DERIVATIVES[i]));
        assert!((rate - derivatives[i]).abs() <= 1e-12 * rate.abs(), "{}: {rate}, {}", DERIVATIVES[i], derivatives[i]);
        assert_eq!(value, set[i], "{}", NAMES[i]);
    }
    let mut nominals = [f64::NAN; STATES];
    assert_eq!(call!(solver.instance, get_nominals, nominals.as_mut_ptr(), STATES), OK);
    assert!(nominals.iter().all(|&nominal| nominal.is_finite() && nominal > 0.0), "{nominals:?}");
}

/// Derivatives with respect to states equal finite differences in all regimes of the run.
#[test]
fn directional_derivatives_with_respect_to_states_are_exact() {
    let mut broad = FLYING;
    broad[0].1 = 0.5;
    let mut solver = Solver::begin(&broad);
    let mut regimes = [false; 4];
    for _ in 0..80 {
        let until = solver.time + 0.05;
        solver.go(until, 1e-3);
        if solver.ended {
            break;
        }
        let regime = solver.instance.get("regime");
        regimes[(regime + 1.0) as usize] = true;
        let (time, states) = (solver.time, solver.states);
        let mut nominals = [f64::NAN; STATES];
        assert_eq!(call!(solver.instance, get_nominals, nominals.as_mut_ptr(), STATES), OK);
        for (i, name) in NAMES.into_iter().enumerate() {
            if (regime != 2.0 && name.starts_with('u')) || name.starts_with("energy") {
                continue;
            }
            let moved = |part: f64| {
                let mut states = states;
                states[i] += part * 1e-5 * nominals[i];
                solver.set(time, Some(&states));
                ["theta_ddot", "v_ddot", "u_ddot", "N_L", "H", "energy.total", "power.input", "v_R"]
                    .map(|output| (output, solver.instance.get(output)))
            };
            let (low, high) = (moved(-1.0), moved(1.0));
            solver.set(time, Some(&states));
            for ((output, low), (_, high)) in low.into_iter().zip(high) {
                let difference = (high - low) / (2e-5 * nominals[i]);
                let (mut exact, unknown, known) = (f64::NAN, reference(output), reference(name));
                let status =
                    call!(solver.instance, get_directional_derivative, &unknown, 1, &known, 1, &1.0, &mut exact);
                assert_eq!(status, OK, "{:?}", solver.instance.messages());
                let size = exact.abs().max(low.abs().max(high.abs()) / nominals[i] * 1e-3);
                assert!(
                    (difference - exact).abs() <= 2e-5 * size,
                    "d {output}/d {name} = {exact}, by differences {difference}"
                );
            }
        }
    }
    assert!(regimes.iter().all(|&seen| seen), "{regimes:?}");
}

#[test]
fn saved_states_resume_with_the_same_bits() {
    let mut solver = Solver::begin(&FLYING);
    solver.go(0.7, 1e-3);
    let (state, time, states) = (solver.instance.save(), solver.time, solver.states);
    let bytes = solver.instance.serialize(state);
    solver.go(1.4, 1e-3);
    let expected = solver.instance.bits();
    (solver.time, solver.states) = (time, states);
    solver.instance.restore(state);
    solver.go(1.4, 1e-3);
    assert_eq!(solver.instance.bits(), expected);

    // A state of the other interface type is refused, too.
    let slave = Instance::new("slave");
    slave.refuses(call!(slave, set_fmu_state, state), &["ModelExchange", "CoSimulation"]);
    solver.instance.free(state);

    let other = Solver::begin(&FLYING);
    let mut state = std::ptr::null_mut();
    assert_eq!(call!(other.instance, deserialize, bytes.as_ptr(), bytes.len(), &mut state), OK);
    other.instance.restore(state);
    other.instance.free(state);
    let mut other = Solver { time, states, ..other };
    other.go(1.4, 1e-3);
    assert_eq!(other.instance.bits(), expected);
}

/// The pulse's beginning and end are time events; the end of the run is announced.
#[test]
fn time_events_and_the_end_of_the_run() {
    let values = [("pulse.shape", 3.0), ("pulse.amplitude", 9.0), ("pulse.period", 0.5), ("pulse.start", 0.25)];
    let instance = Instance::of(MODEL_EXCHANGE, "block", None, false);
    values.iter().for_each(|&(name, value)| instance.set(name, value));
    instance.initialize(None);
    let next = |time: f64| {
        if time > 0.0 {
            assert_eq!(call!(instance, enter_event_mode), OK);
        }
        assert_eq!(call!(instance, set_time, time), OK);
        let mut info = EventInfo::default();
        assert_eq!(call!(instance, new_discrete_states, &mut info), OK);
        assert_eq!(call!(instance, enter_continuous_time_mode), OK);
        (info.next_event_time_defined != 0).then_some(info.next_event_time)
    };
    assert_eq!(next(0.0), Some(0.25));
    // Before the event the pulse does not act; after it the cosine has its full value.
    assert_eq!(call!(instance, set_time, 0.25), OK);
    assert_eq!(instance.get("H"), 0.0);
    assert_eq!(next(0.25), Some(0.75));
    assert!(instance.get("H") > 100.0, "{}", instance.get("H"));
    assert_eq!(next(0.75), None);

    let mut solver = Solver::begin(&[("dimensionless.alpha", 0.15), ("dimensionless.p", 2.0), ("epsilon", 0.5)]);
    solver.go(20.0, 1e-3);
    assert!(solver.ended && solver.time < 20.0, "{}", solver.time);
    assert_eq!(solver.instance.get("separated").max(solver.instance.get("overturned")), 1.0);
}

#[test]
fn arrays_of_wrong_length_and_non_finite_numbers_are_refused() {
    let solver = Solver::begin(&FLYING);
    let before = solver.instance.bits();
    let i = &solver.instance;
    i.refuses(call!(i, get_continuous_states, [0.0; 9].as_mut_ptr(), 9), &["9", "11"]);
    i.refuses(call!(i, get_derivatives, [0.0; 7].as_mut_ptr(), 7), &["7", "11"]);
    i.refuses(call!(i, get_event_indicators, [0.0; 3].as_mut_ptr(), 3), &["3", "22"]);
    i.refuses(call!(i, set_continuous_states, [0.0; 7].as_ptr(), 7), &["7", "11"]);
    i.refuses(call!(i, set_continuous_states, [f64::NAN; STATES].as_ptr(), STATES), &["state 0", "NaN"]);
    i.refuses(call!(i, set_time, f64::INFINITY), &["inf"]);
    i.refuses(call!(i, get_derivatives, std::ptr::null_mut(), STATES), &["derivatives", "NULL"]);
    assert_eq!(i.bits(), before);
}

/// Returns the derivatives of a variable with respect to the states.
fn jacobian(instance: &Instance, unknown: &str) -> States {
    NAMES.map(|name| {
        let (unknown, known, mut found) = (reference(unknown), reference(name), f64::NAN);
        assert_eq!(call!(instance, get_directional_derivative, &unknown, 1, &known, 1, &1.0, &mut found), OK);
        found
    })
}

/// In each regime, on supports and on the rigid base, states read back as set, and the Jacobian agrees.
#[test]
fn states_read_back_in_each_regime() {
    for foundation in [1.0, 2.0] {
        let mut solver = Solver::begin(&[&FLYING[..], &[("foundation", foundation)]].concat());
        let mut regimes = [false; 4];
        for i in 1..30 {
            solver.go(0.05 * f64::from(i), 1e-3);
            if solver.ended {
                break;
            }
            regimes[(solver.instance.get("regime") + 1.0) as usize] = true;
            let set: States = std::array::from_fn(|i| 1.001 * solver.states[i] + 1e-6);
            solver.set(solver.time, Some(&set));
            assert_eq!(NAMES.map(|name| solver.instance.get(name)), set);
            let rates = solver.derivatives(solver.time, &set);
            assert_eq!([rates[0], rates[2], rates[4]], [set[1], set[3], set[5]]);
            for (i, name) in NAMES.into_iter().enumerate() {
                let unit: States = std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 });
                assert_eq!(jacobian(&solver.instance, name), unit, "{name}");
            }
            solver.set(solver.time, Some(&solver.states));
        }
        assert!(regimes.iter().filter(|&&seen| seen).count() > 2, "{regimes:?}");
    }
}

/// Each event and each kink of a pulse signals changed states, so that importers restart their solvers.
#[test]
fn every_event_reports_changed_states() {
    let pulse = [("pulse.shape", 2.0), ("pulse.amplitude", 6.0), ("pulse.period", 0.5), ("pulse.start", 0.25)];
    for foundation in [1.0, 2.0] {
        let instance = Instance::of(MODEL_EXCHANGE, "block", None, false);
        let values = [&pulse[..], &[("foundation", foundation), ("on_separation", 3.0)]].concat();
        values.iter().for_each(|&(name, value)| instance.set(name, value));
        instance.initialize(None);
        let mut solver = Solver::of(instance, true);
        let (mut next, mut events) = (Some(0.25), 0);
        for i in 1..2000 {
            let time = 1e-3 * f64::from(i);
            let before = solver.events;
            solver.step(time - solver.time);
            let due = next.is_some_and(|next: f64| (next - solver.time).abs() < 1e-9);
            if due {
                assert_eq!(call!(solver.instance, set_time, next.unwrap()), OK);
                solver.time = next.unwrap();
                assert_eq!(call!(solver.instance, enter_event_mode), OK);
            }
            if due || solver.events > before {
                let info = if due { solver.pass_events() } else { solver.last };
                assert_eq!(info.values_of_continuous_states_changed, 1, "at {} s", solver.time);
                next = (info.next_event_time_defined != 0).then_some(info.next_event_time);
                events += 1;
            }
        }
        assert!(events > 4, "{events}");
    }
}

/// States, variables and derivatives of a held block have zero rates.
#[test]
fn a_held_block_has_no_rates() {
    let overturns = [("foundation", 2.0), ("initial.theta", 0.2), ("initial.theta_dot", 1.0)];
    let separates = [("initial.theta_dot", -0.9), ("dimensionless.xi_v", 0.01), ("epsilon", 0.6)];
    for values in [&overturns[..], &separates] {
        let [slave, outside] = [CO_SIMULATION, MODEL_EXCHANGE].map(|kind| {
            let instance = Instance::of(kind, "block", None, false);
            let held = [("on_overturning", 2.0), ("on_separation", 2.0)];
            values.iter().chain(&held).for_each(|&(name, value)| instance.set(name, value));
            instance.initialize(Some(1e-12));
            instance
        });
        let mut solver = Solver::of(outside, true);
        let mut time = 0.0;
        while solver.instance.get("overturned") + solver.instance.get("separated") == 0.0 {
            assert!(time < 20.0);
            slave.step(time, 1e-3);
            time += 1e-3;
            solver.go(time, 1e-3);
        }
        let moved: States = std::array::from_fn(|i| if i % 2 == 0 { solver.states[i] } else { 0.0 });
        assert_eq!(moved[..6], solver.states[..6]);
        for later in 1..5 {
            let time = solver.time + 0.1 * f64::from(later);
            assert_eq!(solver.derivatives(time, &solver.states), [0.0; STATES]);
            let (mut event, mut terminate) = (1, 1);
            assert_eq!(call!(solver.instance, completed_integrator_step, 1, &mut event, &mut terminate), OK);
        }
        for name in ["theta_dot", "v_dot", "u_dot", "theta_ddot", "H", "N_L"] {
            assert_eq!(solver.instance.get(name), 0.0, "{name}");
        }
        slave.step(time, 0.5);
        for name in ["peak.theta", "peak.uplift", "peak.N", "energy.kinetic", "energy.total"] {
            let (a, b) = (slave.get(name), solver.instance.get(name));
            assert!((a - b).abs() <= 1e-7 * b.abs(), "{name}: {b}, in Co-Simulation {a}");
        }
        // The outputs follow the states as set.
        let [mut low, mut high] = [solver.states; 2];
        (low[0], high[0]) = (low[0] - 1e-6, high[0] + 1e-6);
        for name in ["theta", "theta_ddot", "v_L", "energy.potential"] {
            let at = |states| {
                solver.set(solver.time, Some(states));
                solver.instance.get(name)
            };
            let difference = (at(&high) - at(&low)) / 2e-6;
            at(&solver.states);
            let exact = jacobian(&solver.instance, name)[0];
            assert!((difference - exact).abs() <= 1e-6 * exact.abs().max(1e-3), "{name}: {exact}, {difference}");
        }
    }
}

/// Peaks between the samples of a record are found in single steps from sample to sample.
#[test]
fn peaks_between_samples_of_a_record_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("record.csv");
    let lines: String =
        (0..=200).map(|i| format!("{},{}\n", 0.01 * f64::from(i), ground(0.01 * f64::from(i))[0])).collect();
    std::fs::write(&path, format!("t (s),a (m/s2)\n{lines}")).unwrap();
    let [inside, outside] = [CO_SIMULATION, MODEL_EXCHANGE].map(|kind| Instance::of(kind, "block", None, false));
    for instance in [&inside, &outside] {
        instance.set("dimensionless.eta", 10.0);
        instance.set_text("record.horizontal", path.to_str().unwrap());
        instance.initialize(Some(1e-12));
    }
    inside.step(0.0, 2.0);
    let mut solver = Solver::of(outside, true);
    for i in 1..=200 {
        // A step of the importer consists of ten steps of its solver.
        let end = 0.01 * f64::from(i);
        solver.quiet = true;
        solver.go(end - 1e-9, 1e-3);
        solver.quiet = false;
        solver.step(end - solver.time);
        assert_eq!(call!(solver.instance, enter_event_mode), OK);
        solver.pass_events();
    }
    for name in ["peak.theta", "peak.uplift", "peak.N", "peak.H"] {
        let (a, b) = (inside.get(name), solver.instance.get(name));
        assert!((a - b).abs() <= 1e-7 * a.abs(), "{name}: {b}, in Co-Simulation {a}");
    }
}

#[test]
fn absurdly_large_states_are_discarded() {
    let mut solver = Solver::begin(&FLYING);
    let (time, states) = (solver.time, solver.states);
    for i in [1, 3, 5] {
        let mut huge = states;
        huge[i] = 1e200;
        solver.set(time, Some(&huge));
        let mut derivatives = [0.0; STATES];
        let status = call!(solver.instance, get_derivatives, derivatives.as_mut_ptr(), STATES);
        assert!(status == DISCARD || derivatives.iter().all(|x| x.is_finite()), "state {i}: {derivatives:?}");
        let mut value = 0.0;
        let status = call!(solver.instance, get_real, &reference("theta_ddot"), 1, &mut value);
        assert!(status == DISCARD || value.is_finite(), "state {i}: {value}");
        let (mut event, mut terminate) = (1, 1);
        assert_eq!(call!(solver.instance, completed_integrator_step, 1, &mut event, &mut terminate), OK);
    }
    let mut huge = states;
    huge[1] = 1e200;
    solver.set(time, Some(&huge));
    assert_eq!(call!(solver.instance, get_derivatives, [0.0; STATES].as_mut_ptr(), STATES), DISCARD);
    // The solver goes back and continues.
    solver.set(time, Some(&states));
    solver.go(0.5, 1e-3);
    assert!(solver.instance.get("peak.theta") < 1.0);
}

/// An importer may set states as variables in Continuous-Time Mode.
#[test]
fn states_can_be_set_as_variables() {
    let mut solver = Solver::begin(&FLYING);
    solver.go(0.3, 1e-3);
    let mut expected = solver.states;
    (expected[1], expected[2]) = (0.25, -0.125);
    solver.set(solver.time, Some(&expected));
    let derivatives = solver.derivatives(solver.time, &expected);
    solver.set(solver.time, Some(&solver.states));
    let (names, values) = (["theta_dot", "v"].map(reference), [0.25, -0.125]);
    assert_eq!(call!(solver.instance, set_real, names.as_ptr(), 2, values.as_ptr()), OK);
    let mut found = [[f64::NAN; STATES]; 2];
    assert_eq!(call!(solver.instance, get_continuous_states, found[0].as_mut_ptr(), STATES), OK);
    assert_eq!(call!(solver.instance, get_derivatives, found[1].as_mut_ptr(), STATES), OK);
    assert_eq!(found, [expected, derivatives]);
    // No other output can be set.
    solver.instance.refuses(call!(solver.instance, set_real, &reference("theta_ddot"), 1, &0.0), &["theta_ddot"]);
}

/// The nominal values in the file are those of the block with the start values.
#[test]
fn nominal_values_suit_the_default_block() {
    let instance = Instance::with_start_values(MODEL_EXCHANGE, "block", None, false);
    let mut nominals = [f64::NAN; STATES];
    assert_eq!(call!(instance, get_nominals, nominals.as_mut_ptr(), nominals.len()), OK);
    let xml = include_str!("../../modelDescription.xml");
    let document = roxmltree::Document::parse(xml).unwrap();
    let names = ["theta", "theta_dot", "v", "v_dot", "u", "u_dot", "energy.input", "energy.dashpots"];
    for (name, nominal) in names.into_iter().zip(nominals) {
        let node = document.descendants().find(|node| node.attribute("name") == Some(name)).unwrap();
        let documented: f64 = node.first_element_child().unwrap().attribute("nominal").unwrap().parse().unwrap();
        assert!((documented / nominal - 1.0).abs() < 0.01, "{name}: {documented}, {nominal}");
    }
}
