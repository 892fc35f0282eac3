//! Refused values: a message names the error, and nothing changes.

use std::ffi::c_int;
use std::ptr::{null, null_mut};

use crate::functions::*;
use crate::host::{FMU, Instance, call, reference};

/// An instance in each state where values can be set: instantiated, initializing, stepping.
fn settable() -> [Instance; 3] {
    let instances = ["instantiated", "initializing", "stepping"].map(Instance::new);
    assert_eq!(call!(instances[1], enter_initialization_mode), OK);
    instances[2].initialize(None);
    instances[2].step(0.0, 0.1);
    instances
}

/// The complete state as bytes.
fn all_of(instance: &Instance) -> Vec<std::ffi::c_char> {
    let state = instance.save();
    let bytes = instance.serialize(state);
    instance.free(state);
    bytes
}

#[test]
fn unknown_value_references_are_refused() {
    let count = FMU.description.variables.len() as u32;
    for unknown in [0, count + 1, 4711, u32::MAX] {
        let words: &[&str] = &[&unknown.to_string(), "does not exist"];
        for instance in &settable() {
            let before = all_of(instance);
            // A valid reference before it is not set, either.
            let references = [reference("a_gx"), unknown];
            instance.refuses(call!(instance, set_real, references.as_ptr(), 2, [1.0, 2.0].as_ptr()), words);
            instance.refuses(call!(instance, set_integer, &unknown, 1, &1), words);
            instance.refuses(call!(instance, set_boolean, &unknown, 1, &1), words);
            instance.refuses(call!(instance, set_string, &unknown, 1, &c"x".as_ptr()), words);
            instance.refuses(
                call!(instance, set_real_input_derivatives, references.as_ptr(), 2, [1; 2].as_ptr(), [1.0; 2].as_ptr()),
                words,
            );
            assert_eq!(all_of(instance), before);
        }
        let [_, _, instance] = settable();
        let references = [reference("theta"), unknown];
        let mut reals = [f64::NAN; 2];
        instance.refuses(call!(instance, get_real, references.as_ptr(), 2, reals.as_mut_ptr()), words);
        instance.refuses(call!(instance, get_integer, &unknown, 1, &mut 0), words);
        instance.refuses(call!(instance, get_boolean, &unknown, 1, &mut 0), words);
        instance.refuses(call!(instance, get_string, &unknown, 1, &mut null()), words);
        instance.refuses(call!(instance, get_real_output_derivatives, &unknown, 1, &1, &mut 0.0), words);
        let input = reference("a_gx");
        instance.refuses(call!(instance, get_directional_derivative, &unknown, 1, &input, 1, &1.0, &mut 0.0), words);
        let output = reference("theta");
        instance.refuses(call!(instance, get_directional_derivative, &output, 1, &unknown, 1, &1.0, &mut 0.0), words);
        assert!(reals.iter().all(|x| x.is_nan()), "nothing is written by a call that is refused");
    }
}

/// Every mixture is refused.
#[test]
fn wrong_types_are_refused() {
    let [_, _, instance] = settable();
    for variable in &FMU.description.variables {
        let (name, reference, kind) = (variable.name.as_str(), &variable.reference, variable.kind.as_str());
        let gets = [
            ("Real", call!(instance, get_real, reference, 1, &mut 0.0)),
            ("Integer", call!(instance, get_integer, reference, 1, &mut 0)),
            ("Boolean", call!(instance, get_boolean, reference, 1, &mut 0)),
            ("String", call!(instance, get_string, reference, 1, &mut null())),
        ];
        for (by, status) in gets {
            assert_eq!(status, if by == kind { OK } else { ERROR }, "{name} by fmi2Get{by}");
        }
        let messages = instance.messages();
        assert_eq!(messages.len(), 3);
        assert!(messages.iter().all(|m| m.text.contains(name)), "{messages:?}");
        let sets = [
            ("Real", call!(instance, set_real, reference, 1, &0.5)),
            ("Integer", call!(instance, set_integer, reference, 1, &1)),
            ("Boolean", call!(instance, set_boolean, reference, 1, &1)),
            ("String", call!(instance, set_string, reference, 1, &c"1".as_ptr())),
        ];
        for (by, status) in sets {
            let fine = by == kind && variable.causality == "input";
            assert_eq!(status, if fine { OK } else { ERROR }, "{name} by fmi2Set{by}");
        }
        assert!(instance.messages().iter().all(|m| m.text.contains(name)));
    }
}

#[test]
fn null_arrays_are_refused() {
    let [_, _, instance] = settable();
    let before = all_of(&instance);
    let (theta, a_gx) = (reference("theta"), reference("a_gx"));
    instance.refuses(call!(instance, get_real, null(), 1, &mut 0.0), &["fmi2GetReal", "vr", "NULL"]);
    instance.refuses(call!(instance, get_real, &theta, 1, null_mut()), &["fmi2GetReal", "value", "NULL"]);
    instance.refuses(call!(instance, get_integer, null(), 1, &mut 0), &["fmi2GetInteger", "vr", "NULL"]);
    instance.refuses(call!(instance, get_integer, &theta, 1, null_mut()), &["fmi2GetInteger", "value", "NULL"]);
    instance.refuses(call!(instance, get_boolean, null(), 1, &mut 0), &["fmi2GetBoolean", "vr", "NULL"]);
    instance.refuses(call!(instance, get_string, null(), 1, &mut null()), &["fmi2GetString", "vr", "NULL"]);
    instance.refuses(call!(instance, set_real, null(), 1, &0.0), &["fmi2SetReal", "vr", "NULL"]);
    instance.refuses(call!(instance, set_real, &a_gx, 1, null()), &["fmi2SetReal", "value", "NULL"]);
    instance.refuses(call!(instance, set_integer, null(), 2, [1, 2].as_ptr()), &["fmi2SetInteger", "vr", "NULL", "2"]);
    instance.refuses(call!(instance, set_boolean, &a_gx, 1, null()), &["fmi2SetBoolean", "value", "NULL"]);
    instance.refuses(call!(instance, set_string, &a_gx, 1, null()), &["fmi2SetString", "value", "NULL"]);
    let rates = |references, orders, values| call!(instance, set_real_input_derivatives, references, 1, orders, values);
    instance.refuses(rates(null(), &1, &1.0), &["vr", "NULL"]);
    instance.refuses(rates(&a_gx, null(), &1.0), &["order", "NULL"]);
    instance.refuses(rates(&a_gx, &1, null()), &["value", "NULL"]);
    let derivative = |orders, values| call!(instance, get_real_output_derivatives, &theta, 1, orders, values);
    instance.refuses(derivative(null(), &mut 0.0), &["order", "NULL"]);
    instance.refuses(derivative(&1, null_mut()), &["value", "NULL"]);
    let along = |unknown, known, direction, result| {
        call!(instance, get_directional_derivative, unknown, 1, known, 1, direction, result)
    };
    instance.refuses(along(null(), &a_gx, &1.0, &mut 0.0), &["vUnknown_ref", "NULL"]);
    instance.refuses(along(&theta, null(), &1.0, &mut 0.0), &["vKnown_ref", "NULL"]);
    instance.refuses(along(&theta, &a_gx, null(), &mut 0.0), &["dvKnown", "NULL"]);
    instance.refuses(along(&theta, &a_gx, &1.0, null_mut()), &["dvUnknown", "NULL"]);
    instance.refuses(call!(instance, get_real_status, LAST_SUCCESSFUL_TIME, null_mut()), &["value", "NULL"]);
    instance.refuses(call!(instance, set_debug_logging, 1, 1, null()), &["categories", "NULL"]);
    instance.refuses(call!(instance, set_debug_logging, 1, 1, &null()), &["categories", "NULL"]);
    assert_eq!(all_of(&instance), before);
    // With n = 0 nothing is read or written, and the call succeeds.
    assert_eq!(call!(instance, get_real, null(), 0, null_mut()), OK);
    assert_eq!(call!(instance, set_real, null(), 0, null()), OK);
    assert_eq!(call!(instance, set_real_input_derivatives, null(), 0, null(), null()), OK);
}

#[test]
fn variables_that_cannot_be_set_are_refused() {
    for instance in &settable() {
        for variable in &FMU.description.variables {
            let stepping = call!(instance, get_real_output_derivatives, null(), 0, null(), null_mut()) == OK;
            instance.messages();
            let name = variable.name.as_str();
            let words: &[&str] = match variable.causality.as_str() {
                "output" => &[name, "output"],
                "calculatedParameter" => &[name, "calculated parameter"],
                "parameter" if stepping => &[name, "fixed parameter"],
                _ => continue,
            };
            // Even its present value is refused.
            let status = match (variable.kind.as_str(), variable.causality.as_str()) {
                ("String", _) => instance.try_set_text(name, &instance.text(name)),
                (_, "parameter") => instance.try_set(name, instance.get(name)),
                _ => instance.try_set(name, 0.0),
            };
            instance.refuses(status, words);
        }
    }
}

#[test]
fn non_finite_and_out_of_range_numbers_are_refused() {
    for instance in &settable()[..2] {
        let before = all_of(instance);
        for variable in FMU.description.variables.iter().filter(|v| v.kind == "Real") {
            if !matches!(variable.causality.as_str(), "input" | "parameter") {
                continue;
            }
            let (min, max) = (variable.min, variable.max);
            let limits: Vec<String> = [min, max].iter().flatten().map(f64::to_string).collect();
            let beyond = [min.map(f64::next_down), max.map(f64::next_up)];
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].into_iter().chain(beyond.into_iter().flatten()) {
                // A valid value before it is not set, either.
                let references = [reference("a_gz"), variable.reference];
                let status = call!(instance, set_real, references.as_ptr(), 2, [3.0, value].as_ptr());
                let mut words = vec![variable.name.as_str()];
                let shown = format!("{value:?}");
                words.push(&shown);
                words.extend(limits.iter().map(String::as_str));
                instance.refuses(status, &words);
            }
        }
        assert_eq!(all_of(instance), before);
        // The limits themselves are accepted.
        for variable in FMU.description.variables.iter().filter(|v| v.causality == "parameter") {
            for limit in [variable.min, variable.max].into_iter().flatten() {
                instance.set(&variable.name, limit);
            }
        }
    }
}

#[test]
fn non_finite_inputs_are_refused_while_stepping() {
    let [_, _, instance] = settable();
    let before = all_of(&instance);
    for name in ["a_gx", "a_gz", "F_x", "F_z", "M_y"] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            instance.refuses(instance.try_set(name, value), &[name, &value.to_string(), "finite"]);
            let status = call!(instance, set_real_input_derivatives, &reference(name), 1, &1, &value);
            instance.refuses(status, &[name, &value.to_string(), "finite"]);
        }
    }
    assert_eq!(all_of(&instance), before);
}

#[test]
fn integers_outside_the_enumeration_are_refused() {
    let enumerations: [(&str, &[c_int]); 5] = [
        ("parameterization", &[0, 3, -1, c_int::MAX]),
        ("foundation", &[0, 3, c_int::MIN]),
        ("on_separation", &[0, 9]),
        ("on_overturning", &[0, 3]),
        ("pulse.shape", &[0, 11, -5]),
    ];
    for instance in &settable()[..2] {
        let before = all_of(instance);
        for (name, values) in enumerations {
            for value in values {
                let status = call!(instance, set_integer, &reference(name), 1, value);
                instance.refuses(status, &[name, &value.to_string(), "expected one of", "1", "2"]);
            }
        }
        assert_eq!(all_of(instance), before);
    }
}

#[test]
fn derivatives_of_variables_without_any_are_refused() {
    let [_, _, instance] = settable();
    let (a_gx, theta) = (reference("a_gx"), reference("theta"));
    for order in [0, 2, -1] {
        let words: &[&str] = &["order", &order.to_string()];
        instance.refuses(call!(instance, set_real_input_derivatives, &a_gx, 1, &order, &1.0), words);
        instance.refuses(call!(instance, get_real_output_derivatives, &theta, 1, &order, &mut 0.0), words);
    }
    for name in ["theta", "dimensionless.alpha", "derived.R0"] {
        let status = call!(instance, set_real_input_derivatives, &reference(name), 1, &1, &1.0);
        instance.refuses(status, &[name, "input"]);
    }
    for name in ["a_gx", "dimensionless.alpha", "derived.R0"] {
        let of = reference(name);
        instance.refuses(call!(instance, get_real_output_derivatives, &of, 1, &1, &mut 0.0), &[name, "output"]);
        let status = call!(instance, get_directional_derivative, &of, 1, &a_gx, 1, &1.0, &mut 0.0);
        instance.refuses(status, &[name, "output"]);
    }
    let status = call!(instance, get_directional_derivative, &theta, 1, &reference("N_L"), 1, &1.0, &mut 0.0);
    instance.refuses(status, &["N_L", "input", "state"]);
}

#[test]
fn statuses_of_the_wrong_kind_are_refused() {
    let [_, _, instance] = settable();
    for kind in [DO_STEP_STATUS, PENDING_STATUS, TERMINATED, 4, -1] {
        instance.refuses(call!(instance, get_real_status, kind, &mut 0.0), &["fmi2GetRealStatus"]);
    }
    for kind in [DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, 4, -1] {
        instance.refuses(call!(instance, get_boolean_status, kind, &mut 0), &["fmi2GetBooleanStatus"]);
    }
    for kind in [PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED, 4, -1] {
        instance.refuses(call!(instance, get_status, kind, &mut 0), &["fmi2GetStatus"]);
    }
}
