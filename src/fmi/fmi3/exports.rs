//! The functions of the standard's headers (fmi3Functions.h, 3.0.1), and nothing else.
//!
//! Each turns its pointers into references through [`boundary`], which lists the importer's obligations, and calls an `Instance`.
//! The crates `crates/fmu3` and `crates/fmu3-in-space` compile this file as libraries of FMUs and export the names; `super` says over which
//! unit.
//!
//! For all functions the instance is null or live (standard, 2.3.1), arrays have the given number of elements (2.2.6, 3.2, 4.2), and
//! strings end with 0 (2.2.1). Saved states come from `fmi3GetFMUState` or `fmi3DeserializeFMUState` and have not been freed, and a
//! pointer to a state points to null or to such a state (2.2.7). Memory for results is only written (2.3.5, 3.2).

#![allow(non_snake_case, reason = "the names are the standard's")]
#![expect(clippy::missing_safety_doc, reason = "the contracts are those of the standard for each function")]

use std::ffi::c_char;

use crate::fmi::arrays::{output_array, read, single_output, texts};
use crate::fmi::fmi3::boundary::{self, Request, Stepping, call};
use crate::fmi::fmi3::callbacks::is_true;
use crate::fmi::fmi3::calls::Call;
use crate::fmi::fmi3::instance::{always, moves_to, write};
use crate::fmi::fmi3::step::StepOutcome;
use crate::fmi::fmi3::types::*;
use crate::fmi::fmi3::values::of_no_type;
use crate::fmi::size_t;
use crate::unit::attributes::Kind;
use crate::unit::fault::Fault;
use crate::unit::fmu::{Exchanged, Fmu};
use crate::unit::life_cycle::Phase;
use crate::unit::snapshot;

use super::Unit;

type Instance = crate::fmi::fmi3::instance::Instance<Unit>;

/// Returns the version of the interface: "3.0".
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// Makes a new instance for Co-Simulation, or returns null. The path of the resources is not used.
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    _resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    event_mode_used: fmi3Boolean,
    early_return_allowed: fmi3Boolean,
    required_intermediate_variables: *const fmi3ValueReference,
    required_count: size_t,
    instance_environment: fmi3InstanceEnvironment,
    log_message: Option<fmi3LogMessageCallback>,
    intermediate_update: Option<fmi3IntermediateUpdateCallback>,
) -> fmi3Instance {
    let request = Request {
        name: instance_name,
        token: instantiation_token,
        logging: logging_on,
        environment: instance_environment,
        logger: log_message,
    };
    let stepping = Stepping {
        event_mode: event_mode_used,
        early_return: early_return_allowed,
        required: required_intermediate_variables,
        required_count,
        update: intermediate_update,
    };
    // SAFETY: strings are null or end with 0, there are `required_count` references, and the callbacks may be called until the
    // instance is freed (standard, 2.3.1).
    unsafe { boundary::instantiate::<Unit>("fmi3InstantiateCoSimulation", &request, Some(stepping)) }
}

/// Makes a new instance for Model Exchange, or returns null. The path of the resources is not used.
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    _resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    instance_environment: fmi3InstanceEnvironment,
    log_message: Option<fmi3LogMessageCallback>,
) -> fmi3Instance {
    let request = Request {
        name: instance_name,
        token: instantiation_token,
        logging: logging_on,
        environment: instance_environment,
        logger: log_message,
    };
    // SAFETY: strings are null or end with 0, and the logger may be called until the instance is freed (standard, 2.3.1).
    unsafe { boundary::instantiate::<Unit>("fmi3InstantiateModelExchange", &request, None) }
}

/// Returns null: Scheduled Execution is not supported.
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    instance_name: fmi3String,
    instantiation_token: fmi3String,
    _resource_path: fmi3String,
    _visible: fmi3Boolean,
    logging_on: fmi3Boolean,
    instance_environment: fmi3InstanceEnvironment,
    log_message: Option<fmi3LogMessageCallback>,
    _clock_update: Option<fmi3ClockUpdateCallback>,
    _lock_preemption: Option<fmi3PreemptionCallback>,
    _unlock_preemption: Option<fmi3PreemptionCallback>,
) -> fmi3Instance {
    let request = Request {
        name: instance_name,
        token: instantiation_token,
        logging: logging_on,
        environment: instance_environment,
        logger: log_message,
    };
    let reason = "fmi3InstantiateScheduledExecution: this FMU offers Co-Simulation and Model Exchange";
    // SAFETY: the logger may be called with its environment (standard, 2.3.1).
    unsafe { boundary::refuse::<Unit>(&request, reason) }
}

/// Frees an instance. Does nothing for null.
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub unsafe extern "C" fn fmi3FreeInstance(instance: fmi3Instance) {
    // SAFETY: `instance` is null or a live instance, and is not used after this (standard, 2.3.1).
    unsafe { boundary::free_instance::<Unit>(instance) }
}

/// Functions of an instance. Each has a line with its name, its call, its other arguments and its body.
macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident $call:ident($($argument:ident: $type:ty),*) = $body:expr;)*) => {$(
        $(#[$doc])*
        #[cfg_attr(feature = "exports", unsafe(no_mangle))]
        pub unsafe extern "C" fn $name(instance: fmi3Instance, $($argument: $type),*) -> fmi3Status {
            // SAFETY: the instance is null or live (standard, 2.3.1); the clauses at the top of this file hold for other pointers.
            unsafe { call::<Unit>(instance, Call::$call, $body) }
        }
    )*};
}

functions! {
    /// Chooses the categories that are logged.
    fmi3SetDebugLogging SetDebugLogging(logging_on: fmi3Boolean, count: size_t, categories: *const fmi3String) = |instance| {
        instance.set_debug_logging(is_true(logging_on), &texts("categories", categories, count)?)
    };
    /// Begins initialization, with tolerance, start and stop of the run.
    fmi3EnterInitializationMode EnterInitializationMode(
        tolerance_defined: fmi3Boolean, tolerance: fmi3Float64, start_time: fmi3Float64, stop_time_defined: fmi3Boolean, stop_time: fmi3Float64
    ) = |instance| {
        let tolerance = is_true(tolerance_defined).then_some(tolerance);
        let stop = is_true(stop_time_defined).then_some(stop_time);
        instance.enter_initialization_mode(tolerance, start_time, stop)
    };
    /// Ends initialization and makes the block.
    fmi3ExitInitializationMode ExitInitializationMode() = Instance::leave_initialization_mode;
    /// Enters Event Mode.
    fmi3EnterEventMode EnterEventMode() = Instance::begin_event;
    /// Enters Step Mode.
    fmi3EnterStepMode EnterStepMode() = Instance::enter_step_mode;
    /// Model Exchange: enters Continuous-Time Mode.
    fmi3EnterContinuousTimeMode EnterContinuousTimeMode() = moves_to(Phase::ContinuousTimeMode);
    /// Ends the run.
    fmi3Terminate Terminate() = moves_to(Phase::Terminated);
    /// Returns to the state after instantiation.
    fmi3Reset Reset() = always(Fmu::reset);
    /// Enters Configuration Mode, where sizes of arrays can be set.
    fmi3EnterConfigurationMode EnterConfigurationMode() = moves_to(Phase::ConfigurationMode);
    /// Leaves Configuration Mode.
    fmi3ExitConfigurationMode ExitConfigurationMode() = moves_to(Phase::Instantiated);
}

macro_rules! getters {
    ($($(#[$doc:meta])* $name:ident $call:ident $type:ty, $get:expr;)*) => { functions! {$(
        $(#[$doc])*
        $name $call(
            references: *const fmi3ValueReference, count: size_t, values: *mut $type, value_count: size_t
        ) = |instance| {
            let mut values = output_array("values", values, value_count)?;
            let references = values.read_input("valueReferences", references, count)?;
            let get: fn(&mut Instance, &[u32], &mut [std::mem::MaybeUninit<$type>]) -> _ = $get;
            get(instance, &references, values.elements())
        };
    )*}};
}

getters! {
    /// Reads Float64 variables.
    fmi3GetFloat64 GetFloat64 fmi3Float64, Instance::get_floats;
    /// Reads Int32 variables.
    fmi3GetInt32 GetInt32 fmi3Int32, |instance, references, values| {
        instance.get_scalars(Kind::Integer, references, values, |value| value as fmi3Int32)
    };
    /// Reads enumerations.
    fmi3GetInt64 GetInt64 fmi3Int64, |instance, references, values| {
        instance.get_scalars(Kind::Enumeration, references, values, |value| value as fmi3Int64)
    };
    /// Reads Boolean variables.
    fmi3GetBoolean GetBoolean fmi3Boolean, |instance, references, values| {
        instance.get_scalars(Kind::Boolean, references, values, |value| fmi3Boolean::from(value != 0.0))
    };
    /// Reads String variables. The results are valid until the next call.
    fmi3GetString GetString fmi3String, |instance, references, values| {
        instance.check_texts(references, values.len())?;
        write(instance.get_texts(references)?.iter().map(|text| Ok(text.as_ptr())), values)
    };
    /// Reads sizes of arrays.
    fmi3GetUInt64 GetUInt64 fmi3UInt64, Instance::get_sizes;
    /// No variable has this type.
    fmi3GetFloat32 GetFloat32 fmi3Float32, |_, references, _| of_no_type::<Unit>(references, "Float32");
    /// No variable has this type.
    fmi3GetInt8 GetInt8 fmi3Int8, |_, references, _| of_no_type::<Unit>(references, "Int8");
    /// No variable has this type.
    fmi3GetUInt8 GetUInt8 fmi3UInt8, |_, references, _| of_no_type::<Unit>(references, "UInt8");
    /// No variable has this type.
    fmi3GetInt16 GetInt16 fmi3Int16, |_, references, _| of_no_type::<Unit>(references, "Int16");
    /// No variable has this type.
    fmi3GetUInt16 GetUInt16 fmi3UInt16, |_, references, _| of_no_type::<Unit>(references, "UInt16");
    /// No variable has this type.
    fmi3GetUInt32 GetUInt32 fmi3UInt32, |_, references, _| of_no_type::<Unit>(references, "UInt32");
}

macro_rules! setters {
    ($($(#[$doc:meta])* $name:ident $call:ident $type:ty, $set:expr;)*) => { functions! {$(
        $(#[$doc])*
        $name $call(
            references: *const fmi3ValueReference, count: size_t, values: *const $type, value_count: size_t
        ) = |instance| {
            let set: fn(&mut Instance, &[u32], &[$type]) -> _ = $set;
            set(instance, read("valueReferences", references, count)?, read("values", values, value_count)?)
        };
    )*}};
}

setters! {
    /// Sets Float64 variables, all or none.
    fmi3SetFloat64 SetFloat64 fmi3Float64, Instance::set_floats;
    /// Sets Int32 variables, all or none.
    fmi3SetInt32 SetInt32 fmi3Int32, |instance, references, values| {
        instance.set_scalars(Kind::Integer, references, values, f64::from)
    };
    /// Sets enumerations, all or none.
    fmi3SetInt64 SetInt64 fmi3Int64, |instance, references, values| {
        instance.set_scalars(Kind::Enumeration, references, values, |value| value as f64)
    };
    /// Sets Boolean variables, all or none.
    fmi3SetBoolean SetBoolean fmi3Boolean, |instance, references, values| {
        instance.set_scalars(Kind::Boolean, references, values, |value| f64::from(u8::from(is_true(value))))
    };
    /// Sets sizes of arrays, all or none.
    fmi3SetUInt64 SetUInt64 fmi3UInt64, Instance::set_sizes;
    /// No variable has this type.
    fmi3SetFloat32 SetFloat32 fmi3Float32, |_, references, _| of_no_type::<Unit>(references, "Float32");
    /// No variable has this type.
    fmi3SetInt8 SetInt8 fmi3Int8, |_, references, _| of_no_type::<Unit>(references, "Int8");
    /// No variable has this type.
    fmi3SetUInt8 SetUInt8 fmi3UInt8, |_, references, _| of_no_type::<Unit>(references, "UInt8");
    /// No variable has this type.
    fmi3SetInt16 SetInt16 fmi3Int16, |_, references, _| of_no_type::<Unit>(references, "Int16");
    /// No variable has this type.
    fmi3SetUInt16 SetUInt16 fmi3UInt16, |_, references, _| of_no_type::<Unit>(references, "UInt16");
    /// No variable has this type.
    fmi3SetUInt32 SetUInt32 fmi3UInt32, |_, references, _| of_no_type::<Unit>(references, "UInt32");
}

functions! {
    /// Sets String variables, all or none.
    fmi3SetString SetString(
        references: *const fmi3ValueReference, count: size_t, values: *const fmi3String, value_count: size_t
    ) = |instance| {
        let references = read("valueReferences", references, count)?;
        let values = texts("values", values, value_count)?;
        instance.check_texts(references, values.len())?;
        instance.set_texts(references, &values)
    };
    /// No variable has this type.
    fmi3GetBinary GetBinary(
        references: *const fmi3ValueReference, count: size_t, _sizes: *mut size_t, _values: *mut fmi3Binary, _value_count: size_t
    ) = |_| of_no_type::<Unit>(read("valueReferences", references, count)?, "Binary");
    /// No variable has this type.
    fmi3SetBinary SetBinary(
        references: *const fmi3ValueReference, count: size_t, _sizes: *const size_t, _values: *const fmi3Binary, _value_count: size_t
    ) = |_| of_no_type::<Unit>(read("valueReferences", references, count)?, "Binary");
    /// Saves the state.
    fmi3GetFMUState GetFmuState(state: *mut fmi3FMUState) = |instance| boundary::get_state(instance, state);
    /// Restores a saved state.
    fmi3SetFMUState SetFmuState(state: fmi3FMUState) = |instance| instance.restore(boundary::state(state)?);
    /// Frees a saved state.
    fmi3FreeFMUState FreeFmuState(state: *mut fmi3FMUState) = |_| Ok(boundary::free_state::<Unit>(state));
    /// Returns the size of a saved state in bytes.
    fmi3SerializedFMUStateSize SerializedFmuStateSize(state: fmi3FMUState, size: *mut size_t) = |_| {
        single_output("size", size)?.put(snapshot::serialize::<Unit>(boundary::state(state)?)?.len());
        Ok(Status::Ok)
    };
    /// Writes a saved state as bytes.
    fmi3SerializeFMUState SerializeFmuState(state: fmi3FMUState, bytes: *mut fmi3Byte, size: size_t) = |_| {
        let mut output = output_array("serializedState", bytes, size)?;
        output.copy(&snapshot::serialize::<Unit>(boundary::state(state)?)?)?;
        Ok(Status::Ok)
    };
    /// Makes a saved state from bytes.
    fmi3DeserializeFMUState DeserializeFmuState(bytes: *const fmi3Byte, size: size_t, state: *mut fmi3FMUState) = |instance| {
        let unit = snapshot::deserialize(read("serializedState", bytes, size)?)?;
        instance.check_restorable(&unit)?;
        Ok(boundary::give_state(single_output("FMUState", state)?, unit))
    };
}

macro_rules! derivatives {
    ($($(#[$doc:meta])* $name:ident $call:ident $get:expr;)*) => { functions! {$(
        $(#[$doc])*
        $name $call(
            unknowns: *const fmi3ValueReference, unknown_count: size_t, knowns: *const fmi3ValueReference, known_count: size_t,
            seed: *const fmi3Float64, seed_count: size_t, sensitivity: *mut fmi3Float64, sensitivity_count: size_t
        ) = |instance| {
            // The sensitivities may share memory with the others (standard, 2.2.11).
            let mut sensitivities = output_array("sensitivity", sensitivity, sensitivity_count)?;
            let unknowns = sensitivities.read_input("unknowns", unknowns, unknown_count)?;
            let knowns = sensitivities.read_input("knowns", knowns, known_count)?;
            let seed = sensitivities.read_input("seed", seed, seed_count)?;
            $get(instance, &unknowns, &knowns, &seed, sensitivities.elements())
        };
    )*}};
}

derivatives! {
    /// Returns directional derivatives of outputs and, in Initialization Mode, of calculated parameters.
    fmi3GetDirectionalDerivative GetDirectionalDerivative Instance::directional;
    /// Returns the derivatives of a weighted sum of the unknowns.
    fmi3GetAdjointDerivative GetAdjointDerivative Instance::adjoint_derivative;
}

functions! {
    /// Returns the time derivatives of outputs.
    fmi3GetOutputDerivatives GetOutputDerivatives(
        references: *const fmi3ValueReference, count: size_t, orders: *const fmi3Int32, values: *mut fmi3Float64, value_count: size_t
    ) = |instance| {
        let mut values = output_array("values", values, value_count)?;
        let references = values.read_input("valueReferences", references, count)?;
        let orders = values.read_input("orders", orders, count)?;
        instance.derivatives(&references, &orders, values.elements())
    };
    /// Applies the event.
    fmi3UpdateDiscreteStates UpdateDiscreteStates(
        discrete_states_need_update: *mut fmi3Boolean, terminate_simulation: *mut fmi3Boolean, nominals_changed: *mut fmi3Boolean, values_changed: *mut fmi3Boolean, next_event_time_defined: *mut fmi3Boolean, next_event_time: *mut fmi3Float64
    ) = |instance| {
        let need_update = single_output("discreteStatesNeedUpdate", discrete_states_need_update)?;
        let terminate = single_output("terminateSimulation", terminate_simulation)?;
        let nominals = single_output("nominalsOfContinuousStatesChanged", nominals_changed)?;
        let values = single_output("valuesOfContinuousStatesChanged", values_changed)?;
        let defined = single_output("nextEventTimeDefined", next_event_time_defined)?;
        let time = single_output("nextEventTime", next_event_time)?;
        let after = instance.update_discrete_states()?;
        need_update.put(FMI3_FALSE);
        terminate.put(after.ended.into());
        nominals.put(FMI3_FALSE);
        values.put(after.states_changed.into());
        defined.put(after.next_time.is_some().into());
        time.put(after.next_time.unwrap_or(0.0));
        Ok(Status::Ok)
    };
}

/// Does a communication step, or a part of it up to an event.
#[cfg_attr(feature = "exports", unsafe(no_mangle))]
pub unsafe extern "C" fn fmi3DoStep(
    instance: fmi3Instance,
    time: fmi3Float64,
    step: fmi3Float64,
    _no_set_state_prior: fmi3Boolean,
    event_handling_needed: *mut fmi3Boolean,
    terminate_simulation: *mut fmi3Boolean,
    early_return: *mut fmi3Boolean,
    last_successful_time: *mut fmi3Float64,
) -> fmi3Status {
    // SAFETY: the instance is live; the other pointers are memory for results (standard, 4.2).
    unsafe {
        let outputs = || {
            Ok((
                single_output("eventHandlingNeeded", event_handling_needed)?,
                single_output("terminateSimulation", terminate_simulation)?,
                single_output("earlyReturn", early_return)?,
                single_output("lastSuccessfulTime", last_successful_time)?,
            ))
        };
        boundary::do_step::<Unit>(
            instance,
            StepOutcome::new(time, step),
            || outputs().map(|_| ()),
            |step| {
                let (event, terminates, early, reached) = outputs()?;
                event.put(step.event.into());
                terminates.put(step.terminates.into());
                early.put(step.early.into());
                reached.put(step.reached);
                Ok(Status::Ok)
            },
        )
    }
}

functions! {
    /// Model Exchange: accepts a step of the importer's solver.
    fmi3CompletedIntegratorStep CompletedIntegratorStep(
        _no_set_state_prior: fmi3Boolean, enter_event_mode: *mut fmi3Boolean, terminate_simulation: *mut fmi3Boolean
    ) = |instance| {
        let enter = single_output("enterEventMode", enter_event_mode)?;
        let terminate = single_output("terminateSimulation", terminate_simulation)?;
        instance.unit.complete_step();
        enter.put(FMI3_FALSE);
        terminate.put(FMI3_FALSE);
        Ok(Status::Ok)
    };
    /// Model Exchange: sets the time.
    fmi3SetTime SetTime(time: fmi3Float64) = |instance| instance.set_time(time);
    /// Model Exchange: sets the continuous states.
    fmi3SetContinuousStates SetContinuousStates(states: *const fmi3Float64, count: size_t) = |instance| {
        instance.set_continuous_states(read("continuousStates", states, count)?)
    };
    /// Model Exchange: returns the derivatives of the continuous states.
    fmi3GetContinuousStateDerivatives GetContinuousStateDerivatives(values: *mut fmi3Float64, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::Derivatives, output_array("derivatives", values, count)?.elements());
    /// Model Exchange: returns the event indicators.
    fmi3GetEventIndicators GetEventIndicators(values: *mut fmi3Float64, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::Indicators, output_array("eventIndicators", values, count)?.elements());
    /// Model Exchange: returns the continuous states.
    fmi3GetContinuousStates GetContinuousStates(values: *mut fmi3Float64, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::States, output_array("continuousStates", values, count)?.elements());
    /// Model Exchange: returns the nominal values of the continuous states.
    fmi3GetNominalsOfContinuousStates GetNominalsOfContinuousStates(values: *mut fmi3Float64, count: size_t) =
        |instance| instance.get_exchanged(Exchanged::Nominals, output_array("nominals", values, count)?.elements());
    /// Model Exchange: returns the number of event indicators.
    fmi3GetNumberOfEventIndicators GetNumberOfEventIndicators(count: *mut size_t) = |instance| {
        single_output("nEventIndicators", count)?.put(instance.unit.indicator_count());
        Ok(Status::Ok)
    };
    /// Model Exchange: returns the number of continuous states.
    fmi3GetNumberOfContinuousStates GetNumberOfContinuousStates(count: *mut size_t) = |instance| {
        single_output("nContinuousStates", count)?.put(instance.unit.state_count());
        Ok(Status::Ok)
    };
}

/// Never called, since the table of calls refuses the call before.
fn refused(_: &mut Instance) -> Result<Status, Fault> {
    Err(Fault::new("not offered"))
}

macro_rules! missing {
    ($($name:ident $call:ident ($($argument:ident: $type:ty),*);)*) => { functions! {$(
        /// Not supported: refused with a message.
        $name $call($($argument: $type),*) = refused;
    )*}};
}

missing! {
    fmi3GetClock GetClock (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _values: *mut fmi3Clock);
    fmi3SetClock SetClock (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _values: *const fmi3Clock);
    fmi3GetIntervalDecimal GetIntervalDecimal (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _intervals: *mut fmi3Float64, _qualifiers: *mut fmi3IntervalQualifier);
    fmi3GetIntervalFraction GetIntervalFraction (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _counters: *mut fmi3UInt64, _resolutions: *mut fmi3UInt64, _qualifiers: *mut fmi3IntervalQualifier);
    fmi3GetShiftDecimal GetShiftDecimal (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _shifts: *mut fmi3Float64);
    fmi3GetShiftFraction GetShiftFraction (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _counters: *mut fmi3UInt64, _resolutions: *mut fmi3UInt64);
    fmi3SetIntervalDecimal SetIntervalDecimal (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _intervals: *const fmi3Float64);
    fmi3SetIntervalFraction SetIntervalFraction (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _counters: *const fmi3UInt64, _resolutions: *const fmi3UInt64);
    fmi3SetShiftDecimal SetShiftDecimal (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _shifts: *const fmi3Float64);
    fmi3SetShiftFraction SetShiftFraction (_value_references: *const fmi3ValueReference, _n_value_references: size_t, _counters: *const fmi3UInt64, _resolutions: *const fmi3UInt64);
    fmi3ActivateModelPartition ActivateModelPartition (_clock_reference: fmi3ValueReference, _activation_time: fmi3Float64);
    fmi3EvaluateDiscreteStates EvaluateDiscreteStates ();
    fmi3GetNumberOfVariableDependencies GetNumberOfVariableDependencies (_value_reference: fmi3ValueReference, _n_dependencies: *mut size_t);
    fmi3GetVariableDependencies GetVariableDependencies (_dependent: fmi3ValueReference, _element_indices_of_dependent: *mut size_t, _independents: *mut fmi3ValueReference, _element_indices_of_independents: *mut size_t, _dependency_kinds: *mut fmi3DependencyKind, _n_dependencies: size_t);
}
