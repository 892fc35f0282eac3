//! The 44 functions of the standard's headers (fmi2Functions.h, 2.0.4), and nothing else.
//!
//! Each turns its pointers into references through [`boundary`], which lists the importer's obligations, and calls an `Instance`.
//! The crates `crates/fmu2` and `crates/fmu2-in-space` compile this file as libraries of FMUs and export the names; `super` says over which
//! unit.
//!
//! For all functions the component is null or a live instance (standard, 2.1.5), arrays have the given number of elements (2.1.7,
//! 2.1.9, 3.2.1, 4.2.1), and strings end with 0 (2.1.5). Saved states come from `fmi2GetFMUstate` or `fmi2DeSerializeFMUstate` and have
//! not been freed, and a pointer to a state points to null or to such a state (2.1.8). Memory for results is only written (2.1.7,
//! 3.2.2, 4.2.3).

#![allow(non_snake_case, reason = "the names are the standard's")]
#![expect(clippy::missing_safety_doc, reason = "the contracts are those of the standard for each function")]

use std::ffi::c_char;

use crate::fmi::arrays::{output_array, read, single_output, texts};
use crate::fmi::fmi2::boundary::{self, call, is_true};
use crate::fmi::fmi2::calls::Call;
use crate::fmi::fmi2::instance::{always, moves_to, write};
use crate::fmi::fmi2::types::*;
use crate::fmi::size_t;
use crate::unit::attributes::Kind;
use crate::unit::fault::Fault;
use crate::unit::fmu::{Exchanged, Fmu};
use crate::unit::life_cycle::Phase;
use crate::unit::snapshot;

use super::Unit;

type Instance = crate::fmi::fmi2::instance::Instance<Unit>;

/// Returns the platform of the types: "default".
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// Returns the version of the interface: "2.0".
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Makes a new instance, or returns null. The resource location is not used.
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: fmi2String,
    fmu_type: fmi2Type,
    guid: fmi2String,
    _resource_location: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    logging_on: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: the strings are null or end with 0, `functions` is null or the importer's callbacks, and its logger may be
    // called until the instance is freed (standard, 2.1.5).
    unsafe { boundary::instantiate::<Unit>(instance_name, fmu_type, guid, functions, logging_on) }
}

/// Frees an instance. Does nothing for null.
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub unsafe extern "C" fn fmi2FreeInstance(component: fmi2Component) {
    // SAFETY: `component` is null or a live instance, and is not used after this (standard, 2.1.5).
    unsafe { boundary::free_instance::<Unit>(component) }
}

/// Functions of an instance. Each has a line with its name, its call, its other arguments and its body.
macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident $call:ident($($argument:ident: $type:ty),*) = $body:expr;)*) => {$(
        $(#[$doc])*
        #[cfg_attr(feature = "exports", unsafe(no_mangle))]
        pub unsafe extern "C" fn $name(component: fmi2Component, $($argument: $type),*) -> fmi2Status {
            // SAFETY: the component is null or live (standard, 2.1.5); the clauses at the top of this file hold for other pointers.
            unsafe { call::<Unit>(component, Call::$call, $body) }
        }
    )*};
}

functions! {
    /// Chooses the categories that are logged.
    fmi2SetDebugLogging SetDebugLogging(logging_on: fmi2Boolean, count: size_t, categories: *const fmi2String) = |instance| {
        instance.set_debug_logging(is_true(logging_on), &texts("categories", categories, count)?)
    };
    /// Sets tolerance, start and stop of the run.
    fmi2SetupExperiment SetupExperiment(
        tolerance_defined: fmi2Boolean, tolerance: fmi2Real, start_time: fmi2Real, stop_time_defined: fmi2Boolean, stop_time: fmi2Real
    ) = |instance| {
        let tolerance = is_true(tolerance_defined).then_some(tolerance);
        instance.plan(tolerance, start_time, is_true(stop_time_defined).then_some(stop_time))
    };
    /// Begins initialization.
    fmi2EnterInitializationMode EnterInitializationMode() = always(Fmu::enter_initialization_mode);
    /// Ends initialization and makes the block.
    fmi2ExitInitializationMode ExitInitializationMode() = Instance::exit_initialization_mode;
    /// Ends the run.
    fmi2Terminate Terminate() = moves_to(Phase::Terminated);
    /// Returns to the state after instantiation.
    fmi2Reset Reset() = always(Fmu::reset);
    /// Reads Real variables.
    fmi2GetReal GetReal(references: *const fmi2ValueReference, count: size_t, values: *mut fmi2Real) = |instance| {
        let mut values = output_array("value", values, count)?;
        let references = values.read_input("vr", references, count)?;
        instance.get(Kind::Real, &references, values.elements(), |value| value)
    };
    /// Reads Integer variables and enumerations.
    fmi2GetInteger GetInteger(references: *const fmi2ValueReference, count: size_t, values: *mut fmi2Integer) = |instance| {
        let mut values = output_array("value", values, count)?;
        let references = values.read_input("vr", references, count)?;
        instance.get(Kind::Integer, &references, values.elements(), |value| value as fmi2Integer)
    };
    /// Reads Boolean variables.
    fmi2GetBoolean GetBoolean(references: *const fmi2ValueReference, count: size_t, values: *mut fmi2Boolean) = |instance| {
        let mut values = output_array("value", values, count)?;
        let references = values.read_input("vr", references, count)?;
        instance.get(Kind::Boolean, &references, values.elements(), |value| fmi2Boolean::from(value != 0.0))
    };
    /// Reads String variables. The results are valid until the next call.
    fmi2GetString GetString(references: *const fmi2ValueReference, count: size_t, values: *mut fmi2String) = |instance| {
        let mut values = output_array("value", values, count)?;
        let references = values.read_input("vr", references, count)?;
        let texts = instance.get_texts(&references)?;
        write(texts.iter().map(|text| Ok(text.as_ptr())), values.elements())
    };
    /// Sets Real variables, all or none.
    fmi2SetReal SetReal(references: *const fmi2ValueReference, count: size_t, values: *const fmi2Real) = |instance| {
        let (references, values) = (read("vr", references, count)?, read("value", values, count)?);
        instance.set(Kind::Real, references, values, |value| value)
    };
    /// Sets Integer variables and enumerations, all or none.
    fmi2SetInteger SetInteger(references: *const fmi2ValueReference, count: size_t, values: *const fmi2Integer) = |instance| {
        let (references, values) = (read("vr", references, count)?, read("value", values, count)?);
        instance.set(Kind::Integer, references, values, f64::from)
    };
    /// Sets Boolean variables, all or none.
    fmi2SetBoolean SetBoolean(references: *const fmi2ValueReference, count: size_t, values: *const fmi2Boolean) = |instance| {
        let (references, values) = (read("vr", references, count)?, read("value", values, count)?);
        instance.set(Kind::Boolean, references, values, |value| f64::from(u8::from(is_true(value))))
    };
    /// Sets String variables, all or none.
    fmi2SetString SetString(references: *const fmi2ValueReference, count: size_t, values: *const fmi2String) = |instance| {
        let (references, values) = (read("vr", references, count)?, texts("value", values, count)?);
        instance.set_texts(references, &values)
    };
    /// Saves the state.
    fmi2GetFMUstate GetFmuState(state: *mut fmi2FMUstate) = |instance| boundary::get_state(instance, state);
    /// Restores a saved state.
    fmi2SetFMUstate SetFmuState(state: fmi2FMUstate) = |instance| instance.restore(boundary::state(state)?);
    /// Frees a saved state.
    fmi2FreeFMUstate FreeFmuState(state: *mut fmi2FMUstate) = |_| Ok(boundary::free_state::<Unit>(state));
    /// Returns the size of a saved state in bytes.
    fmi2SerializedFMUstateSize SerializedFmuStateSize(state: fmi2FMUstate, size: *mut size_t) = |_| {
        single_output("size", size)?.put(snapshot::serialize::<Unit>(boundary::state(state)?)?.len());
        Ok(Status::Ok)
    };
    /// Writes a saved state as bytes.
    fmi2SerializeFMUstate SerializeFmuState(state: fmi2FMUstate, bytes: *mut fmi2Byte, size: size_t) = |_| {
        let mut output = output_array::<u8>("serializedState", bytes.cast(), size)?;
        output.copy(&snapshot::serialize::<Unit>(boundary::state(state)?)?)?;
        Ok(Status::Ok)
    };
    /// Makes a saved state from bytes.
    fmi2DeSerializeFMUstate DeSerializeFmuState(bytes: *const fmi2Byte, size: size_t, state: *mut fmi2FMUstate) = |instance| {
        let unit = snapshot::deserialize(read("serializedState", bytes.cast(), size)?)?;
        instance.check_restorable(&unit)?;
        Ok(boundary::give_state(single_output("FMUstate", state)?, unit))
    };
    /// Returns directional derivatives of outputs and, in Initialization Mode, of calculated parameters.
    fmi2GetDirectionalDerivative GetDirectionalDerivative(
        unknowns: *const fmi2ValueReference, unknown_count: size_t, knowns: *const fmi2ValueReference, known_count: size_t, direction: *const fmi2Real, sensitivity: *mut fmi2Real
    ) = |instance| {
        let mut sensitivities = output_array("dvUnknown", sensitivity, unknown_count)?;
        let unknowns = sensitivities.read_input("vUnknown_ref", unknowns, unknown_count)?;
        let knowns = sensitivities.read_input("vKnown_ref", knowns, known_count)?;
        let direction = sensitivities.read_input("dvKnown", direction, known_count)?;
        instance.directional_derivative(&unknowns, &knowns, &direction, 0.0, sensitivities.elements())
    };
    /// Sets the time derivatives of inputs over the next step.
    fmi2SetRealInputDerivatives SetRealInputDerivatives(
        references: *const fmi2ValueReference, count: size_t, orders: *const fmi2Integer, values: *const fmi2Real
    ) = |instance| {
        let (references, orders) = (read("vr", references, count)?, read("order", orders, count)?);
        instance.set_input_derivatives(references, orders, read("value", values, count)?)
    };
    /// Returns the time derivatives of outputs.
    fmi2GetRealOutputDerivatives GetRealOutputDerivatives(
        references: *const fmi2ValueReference, count: size_t, orders: *const fmi2Integer, values: *mut fmi2Real
    ) = |instance| {
        let mut values = output_array("value", values, count)?;
        let references = values.read_input("vr", references, count)?;
        let orders = values.read_input("order", orders, count)?;
        instance.output_derivatives(&references, &orders, values.elements())
    };
    /// Does a communication step.
    fmi2DoStep DoStep(
        time: fmi2Real, step: fmi2Real, _no_set_state_prior: fmi2Boolean
    ) = |instance| instance.do_step(time, step);
    /// Always refused, since steps are synchronous.
    fmi2CancelStep CancelStep() = refused;
    /// Returns the status of the last step.
    fmi2GetStatus GetStatus(kind: fmi2StatusKind, value: *mut fmi2Status) = |instance| {
        single_output("value", value)?.put(instance.step_status(status_kind(kind)?)?.code());
        Ok(Status::Ok)
    };
    /// Returns the time that the last step reached.
    fmi2GetRealStatus GetRealStatus(kind: fmi2StatusKind, value: *mut fmi2Real) = |instance| {
        single_output("value", value)?.put(instance.real_status(status_kind(kind)?)?);
        Ok(Status::Ok)
    };
    /// Always refused, since no status is an integer.
    fmi2GetIntegerStatus GetIntegerStatus(kind: fmi2StatusKind, _value: *mut fmi2Integer) = |_| {
        Err(Fault::new(format!("{:?} is no Integer; expected another call, since no status is one", status_kind(kind)?)))
    };
    /// Returns whether the run has ended.
    fmi2GetBooleanStatus GetBooleanStatus(kind: fmi2StatusKind, value: *mut fmi2Boolean) = |instance| {
        single_output("value", value)?.put(instance.boolean_status(status_kind(kind)?)?.into());
        Ok(Status::Ok)
    };
    /// Always refused, since no step is ever pending.
    fmi2GetStringStatus GetStringStatus(kind: fmi2StatusKind, _value: *mut fmi2String) = |instance| {
        let kind = status_kind(kind)?;
        instance.log.status(
            Status::Discard,
            &format!("fmi2GetStringStatus: {kind:?}: no step is pending, steps are synchronous"),
        );
        Ok(Status::Discard)
    };
}

fn status_kind(kind: fmi2StatusKind) -> Result<StatusKind, Fault> {
    StatusKind::from_code(kind).ok_or_else(|| Fault::new(format!("status kind {kind} does not exist; expected 0 to 3")))
}

/// Never called, since the table of calls refuses the call before.
fn refused(_: &mut Instance) -> Result<Status, Fault> {
    Err(Fault::new("not offered"))
}

functions! {
    /// Model Exchange: enters Event Mode.
    fmi2EnterEventMode EnterEventMode() = always(Fmu::enter_event_mode);
    /// Model Exchange: applies an event.
    fmi2NewDiscreteStates NewDiscreteStates(event_info: *mut fmi2EventInfo) = |instance| {
        let output = single_output("fmi2EventInfo", event_info)?;
        let after = instance.new_discrete_states()?;
        output.put(fmi2EventInfo {
            new_discrete_states_needed: FMI2_FALSE,
            terminate_simulation: after.ended.into(),
            nominals_of_continuous_states_changed: FMI2_FALSE,
            values_of_continuous_states_changed: after.states_changed.into(),
            next_event_time_defined: after.next_time.is_some().into(),
            next_event_time: after.next_time.unwrap_or(0.0),
        });
        Ok(Status::Ok)
    };
    /// Model Exchange: enters Continuous-Time Mode.
    fmi2EnterContinuousTimeMode EnterContinuousTimeMode() = moves_to(Phase::ContinuousTimeMode);
    /// Model Exchange: accepts a step of the importer's solver.
    fmi2CompletedIntegratorStep CompletedIntegratorStep(
        _no_set_state_prior: fmi2Boolean, enter_event_mode: *mut fmi2Boolean, terminate: *mut fmi2Boolean
    ) = |instance| {
        let enter_event_mode = single_output("enterEventMode", enter_event_mode)?;
        let terminate = single_output("terminateSimulation", terminate)?;
        instance.unit.complete_step();
        enter_event_mode.put(FMI2_FALSE);
        terminate.put(FMI2_FALSE);
        Ok(Status::Ok)
    };
    /// Model Exchange: sets the time.
    fmi2SetTime SetTime(time: fmi2Real) = |instance| instance.set_time(time);
    /// Model Exchange: sets the continuous states.
    fmi2SetContinuousStates SetContinuousStates(
        states: *const fmi2Real, count: size_t
    ) = |instance| instance.set_continuous_states(read("x", states, count)?);
    /// Model Exchange: returns the derivatives of the continuous states.
    fmi2GetDerivatives GetDerivatives(values: *mut fmi2Real, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::Derivatives, output_array("derivatives", values, count)?.elements());
    /// Model Exchange: returns the event indicators.
    fmi2GetEventIndicators GetEventIndicators(values: *mut fmi2Real, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::Indicators, output_array("eventIndicators", values, count)?.elements());
    /// Model Exchange: returns the continuous states.
    fmi2GetContinuousStates GetContinuousStates(values: *mut fmi2Real, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::States, output_array("x", values, count)?.elements());
    /// Model Exchange: returns the nominal values of the continuous states.
    fmi2GetNominalsOfContinuousStates GetNominalsOfContinuousStates(values: *mut fmi2Real, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::Nominals, output_array("x_nominal", values, count)?.elements());
}
