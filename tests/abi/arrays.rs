//! Arrays as C passes them: uninitialized, empty, or overlapping.

use std::ffi::c_int;
use std::ptr::null_mut;

use crate::functions::*;
use crate::host::{FMU, Instance, call, reference};

/// A block in full contact under a push, one second after its start.
fn pushed() -> Instance {
    let instance = Instance::new("pushed");
    instance.set("a_gx", 0.7);
    instance.set("a_gz", -0.4);
    instance.set("initial.theta", 0.003);
    instance.initialize(None);
    instance.go(0.0, 1.0, 0.1);
    instance
}

fn real_outputs() -> Vec<Reference> {
    FMU.description.outputs().filter(|variable| variable.kind == "Real").map(|variable| variable.reference).collect()
}

const INPUTS: [&str; 5] = ["a_gx", "a_gz", "F_x", "F_z", "M_y"];
const DIRECTION: [f64; 5] = [0.5, -2.0, 300.0, 40.0, -7.0];
/// Outputs that depend on the inputs, equal to these in number.
const UNKNOWNS: [&str; 5] = ["theta_ddot", "v_ddot", "u_ddot", "H", "friction_demand"];

/// An uninitialized array, as from `malloc`; memcheck reports any read of it.
fn fresh<T>(length: usize) -> Vec<T> {
    Vec::with_capacity(length)
}

#[test]
fn results_may_go_to_uninitialized_memory() {
    let instance = pushed();
    let outputs = real_outputs();
    let n = outputs.len();
    let mut values = fresh(n);
    assert_eq!(call!(instance, get_real, outputs.as_ptr(), n, values.as_mut_ptr()), OK);
    // SAFETY: the call has initialized all n values.
    unsafe { values.set_len(n) };
    let names = FMU.description.outputs().filter(|variable| variable.kind == "Real").map(|variable| &variable.name);
    let seen: Vec<f64> = names.map(|name| instance.get(name)).collect();
    assert_eq!(values, seen);

    let mut rates: Vec<f64> = fresh(n);
    assert_eq!(
        call!(instance, get_real_output_derivatives, outputs.as_ptr(), n, vec![1; n].as_ptr(), rates.as_mut_ptr()),
        OK
    );
    // SAFETY: the call has initialized all n rates.
    unsafe { rates.set_len(n) };
    assert_eq!(rates[outputs.iter().position(|&r| r == reference("theta")).unwrap()], instance.get("theta_dot"));

    let mut integers: Vec<c_int> = fresh(1);
    assert_eq!(call!(instance, get_integer, &reference("regime"), 1, integers.as_mut_ptr()), OK);
    // SAFETY: the call wrote it.
    unsafe { integers.set_len(1) };
    assert_eq!(integers, [0]);

    let state = instance.save();
    let bytes = instance.serialize(state);
    let mut room: Vec<std::ffi::c_char> = fresh(bytes.len() + 10);
    assert_eq!(call!(instance, serialize, state, room.as_mut_ptr(), bytes.len() + 10), OK);
    // SAFETY: the call has initialized all bytes of the state.
    unsafe { room.set_len(bytes.len()) };
    assert_eq!(room, bytes);
    instance.free(state);
}

/// Passes directions and sensitivities in one array, as solvers that work in place do.
#[test]
fn a_direction_may_share_its_array_with_the_sensitivities() {
    let instance = pushed();
    let (unknowns, knowns) = (UNKNOWNS.map(reference), INPUTS.map(reference));
    let mut apart = [f64::NAN; 5];
    let (of, to) = (unknowns.as_ptr(), knowns.as_ptr());
    let direction = DIRECTION.as_ptr();
    assert_eq!(call!(instance, get_directional_derivative, of, 5, to, 5, direction, apart.as_mut_ptr()), OK);
    assert!(apart.iter().all(|x| x.is_finite() && *x != 0.0), "{apart:?}");

    let mut in_place = DIRECTION;
    let both = in_place.as_mut_ptr();
    assert_eq!(call!(instance, get_directional_derivative, of, 5, to, 5, both, both), OK);
    assert_eq!(in_place, apart);

    // Shifted by one element.
    let mut shifted = [0.0; 6];
    shifted[..5].copy_from_slice(&DIRECTION);
    let both = shifted.as_mut_ptr();
    assert_eq!(call!(instance, get_directional_derivative, of, 5, to, 5, both, both.wrapping_add(1)), OK);
    assert_eq!((shifted[0], &shifted[1..]), (DIRECTION[0], &apart[..]));
}

/// Passes one buffer for everything, so that inputs overlap the results.
#[test]
fn references_and_orders_may_share_their_arrays_with_the_values() {
    let instance = pushed();
    let outputs = real_outputs();
    let n = outputs.len();
    let mut apart = vec![f64::NAN; n];
    assert_eq!(call!(instance, get_real, outputs.as_ptr(), n, apart.as_mut_ptr()), OK);
    let mut buffer = vec![0.0_f64; n];
    let as_references = buffer.as_mut_ptr().cast::<Reference>();
    // SAFETY: two references fit into each number.
    unsafe { as_references.copy_from_nonoverlapping(outputs.as_ptr(), n) };
    assert_eq!(call!(instance, get_real, as_references, n, buffer.as_mut_ptr()), OK);
    assert_eq!(buffer, apart);

    let mut rates = vec![f64::NAN; n];
    let ones = vec![1; n];
    assert_eq!(
        call!(instance, get_real_output_derivatives, outputs.as_ptr(), n, ones.as_ptr(), rates.as_mut_ptr()),
        OK
    );
    let as_orders = buffer.as_mut_ptr().cast::<c_int>();
    // SAFETY: two orders fit into each number.
    unsafe { as_orders.copy_from_nonoverlapping(ones.as_ptr(), n) };
    assert_eq!(call!(instance, get_real_output_derivatives, outputs.as_ptr(), n, as_orders, buffer.as_mut_ptr()), OK);
    assert_eq!(buffer, rates);

    let mut numbers = [reference("regime"), reference("events.impacts")];
    let both = numbers.as_mut_ptr();
    assert_eq!(call!(instance, get_integer, both, 2, both.cast()), OK);
    assert_eq!(numbers.map(f64::from), [instance.get("regime"), instance.get("events.impacts")]);
}

/// A pointer that cannot be an array is refused before it is used.
#[test]
fn impossible_arrays_are_refused() {
    let instance = pushed();
    let mut values = [0.0_f64; 2];
    let crooked = values.as_mut_ptr().wrapping_byte_add(1);
    let theta = reference("theta");
    instance.refuses(call!(instance, get_real, &theta, 1, crooked), &["value", "multiple of 8"]);
    instance.refuses(call!(instance, set_real, &reference("a_gx"), 1, crooked), &["value", "multiple of 8"]);
    instance.refuses(call!(instance, get_real_status, LAST_SUCCESSFUL_TIME, crooked), &["value", "multiple of 8"]);
    instance.refuses(call!(instance, get_real, &theta, usize::MAX, values.as_mut_ptr()), &["value", "memory"]);
    assert_eq!(values, [0.0; 2]);
    assert_eq!(call!(instance, get_real, std::ptr::null(), 0, null_mut()), OK, "of nothing there is nothing to refuse");
}
