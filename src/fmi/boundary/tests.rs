//! Panics are caught, and calls take turns.

use super::*;
use std::ffi::CStr;

use crate::fmi::instance::always;
use crate::fmi::log::{Category, Log, Messenger, Wanted};
use crate::unit::instance::Unit;
use crate::unit::life_cycle::{Interface, Phase};

/// A version with one function, legal in every state, and a logger that panics.
struct Any;

#[derive(Clone, Copy)]
struct Function;

struct Panicking;

impl Version for Any {
    type Unit = Unit;
    type Call = Function;
    type Messenger = Panicking;

    fn reached(_: Interface) -> u16 {
        u16::MAX
    }

    fn state(_: Phase) -> &'static str {
        "state"
    }

    fn missing(_: Function) -> &'static str {
        "missing"
    }
}

impl Call for Function {
    fn name(self) -> &'static str {
        "function"
    }

    fn phases(self) -> u16 {
        u16::MAX
    }

    fn interface(self) -> Option<Interface> {
        None
    }
}

impl Messenger for Panicking {
    const DOUBLED: &[char] = &[];

    fn wanted(before: Wanted, _: bool, _: Option<&[Category]>) -> Wanted {
        before
    }

    fn send(&self, _: &CStr, _: Status, _: &CStr, _: &CStr) {
        panic!("broken logger");
    }
}

fn instance() -> Instance<Any> {
    Instance::new(Log::new(Panicking, c"block".into(), false), Interface::CoSimulation, Any)
}

#[test]
fn a_panic_is_caught_and_the_instance_refuses_from_then_on() {
    let mut instance = instance();
    assert_eq!(guarded(&mut instance, Function, |_| panic!("broken")), Status::Fatal);
    assert_eq!(guarded(&mut instance, Function, |_| Ok(Status::Ok)), Status::Fatal);
    assert_eq!(guarded(&mut instance, Function, always(Fmu::reset)), Status::Fatal);
}

#[test]
fn a_panic_of_the_logger_is_caught_too() {
    let mut instance = instance();
    assert_eq!(guarded(&mut instance, Function, |_| Err(Fault::new("refused"))), Status::Fatal);
    assert_eq!(guarded(&mut instance, Function, |_| Ok(Status::Ok)), Status::Fatal);
}

#[test]
fn the_reason_of_a_panic_is_logged() {
    let text = catch_unwind(|| panic!("reason {}", 7)).unwrap_err();
    assert_eq!(panic_reason(text.as_ref()), "reason 7");
    let literal = catch_unwind(|| panic!("reason")).unwrap_err();
    assert_eq!(panic_reason(literal.as_ref()), "reason");
}

/// A call within a call is refused, a later one is not. An instance in use is not freed.
#[test]
fn calls_take_turns() {
    let handle = create(|| Some(instance()));
    for _ in 0..2 {
        // SAFETY: made by `create`, and freed only below.
        let status = unsafe {
            call::<Any>(handle, Function, |_| {
                assert_eq!(call::<Any>(handle, Function, |_| panic!("reached")), Status::Error);
                free::<Any>(handle);
                assert_eq!(call::<Any>(handle, Function, |_| panic!("reached")), Status::Error);
                Ok(Status::Ok)
            })
        };
        assert_eq!(status, Status::Ok);
    }
    // SAFETY: not used any more.
    unsafe { free::<Any>(handle) };
}

/// Other calls are admitted between the pieces of a call, except to free the instance.
#[test]
fn a_call_in_pieces_lends_its_turn() {
    let handle = create(|| Some(instance()));
    let between = |asked: u32| {
        // SAFETY: made by `create`, and freed only below.
        unsafe {
            free::<Any>(handle);
            assert_eq!(call::<Any>(handle, Function, |_| Ok(Status::Warning)), Status::Warning);
        }
        2 * asked
    };
    let piece = |_: &mut Instance<Any>, reply: Option<u32>| {
        // SAFETY: as before.
        assert_eq!(unsafe { call::<Any>(handle, Function, |_| panic!("reached")) }, Status::Error);
        Ok(match reply {
            None => ControlFlow::Continue(21),
            Some(reply) => ControlFlow::Break(if reply == 42 { Status::Ok } else { Status::Discard }),
        })
    };
    // SAFETY: as before.
    unsafe {
        assert_eq!(call_in_pieces::<Any, _, _>(handle, Function, piece, between), Status::Ok);
        assert_eq!(call_in_pieces::<Any, u32, u32>(handle, Function, piece, |_| panic!("broken")), Status::Fatal);
        assert_eq!(call::<Any>(handle, Function, |_| Ok(Status::Ok)), Status::Fatal);
        free::<Any>(handle);
    }
}
