//! The C functions of the standard's headers (fmi3FunctionTypes.h, 3.0.1), written from these and not from the crate.

use std::ffi::{c_char, c_int, c_void};

use crate::loading::functions;

pub type Handle = *mut c_void;
pub type Text = *const c_char;
pub type Bytes = *const u8;
pub type Boolean = bool;
pub type Status = c_int;

pub const OK: Status = 0;
pub const DISCARD: Status = 2;
pub const ERROR: Status = 3;

pub type Logger = unsafe extern "C" fn(Handle, Status, Text, Text);
pub type Update = unsafe extern "C" fn(Handle, f64, Boolean, Boolean, Boolean, Boolean, *mut Boolean, *mut f64);
pub type ClockUpdate = unsafe extern "C" fn(Handle);
pub type Preemption = unsafe extern "C" fn();

functions! {
    get_version "fmi3GetVersion" () -> Text;
    set_debug_logging "fmi3SetDebugLogging" (Handle, Boolean, usize, *const Text) -> Status;
    instantiate_model_exchange "fmi3InstantiateModelExchange" (Text, Text, Text, Boolean, Boolean, Handle, Option<Logger>) -> Handle;
    instantiate_co_simulation "fmi3InstantiateCoSimulation" (Text, Text, Text, Boolean, Boolean, Boolean, Boolean, *const u32, usize, Handle, Option<Logger>, Option<Update>) -> Handle;
    instantiate_scheduled_execution "fmi3InstantiateScheduledExecution" (Text, Text, Text, Boolean, Boolean, Handle, Option<Logger>, Option<ClockUpdate>, Option<Preemption>, Option<Preemption>) -> Handle;
    free_instance "fmi3FreeInstance" (Handle);
    enter_initialization_mode "fmi3EnterInitializationMode" (Handle, Boolean, f64, f64, Boolean, f64) -> Status;
    exit_initialization_mode "fmi3ExitInitializationMode" (Handle) -> Status;
    enter_event_mode "fmi3EnterEventMode" (Handle) -> Status;
    terminate "fmi3Terminate" (Handle) -> Status;
    reset "fmi3Reset" (Handle) -> Status;
    get_float32 "fmi3GetFloat32" (Handle, *const u32, usize, *mut f32, usize) -> Status;
    get_float64 "fmi3GetFloat64" (Handle, *const u32, usize, *mut f64, usize) -> Status;
    get_int8 "fmi3GetInt8" (Handle, *const u32, usize, *mut i8, usize) -> Status;
    get_uint8 "fmi3GetUInt8" (Handle, *const u32, usize, *mut u8, usize) -> Status;
    get_int16 "fmi3GetInt16" (Handle, *const u32, usize, *mut i16, usize) -> Status;
    get_uint16 "fmi3GetUInt16" (Handle, *const u32, usize, *mut u16, usize) -> Status;
    get_int32 "fmi3GetInt32" (Handle, *const u32, usize, *mut i32, usize) -> Status;
    get_uint32 "fmi3GetUInt32" (Handle, *const u32, usize, *mut u32, usize) -> Status;
    get_int64 "fmi3GetInt64" (Handle, *const u32, usize, *mut i64, usize) -> Status;
    get_uint64 "fmi3GetUInt64" (Handle, *const u32, usize, *mut u64, usize) -> Status;
    get_boolean "fmi3GetBoolean" (Handle, *const u32, usize, *mut Boolean, usize) -> Status;
    get_string "fmi3GetString" (Handle, *const u32, usize, *mut Text, usize) -> Status;
    get_binary "fmi3GetBinary" (Handle, *const u32, usize, *mut usize, *mut Bytes, usize) -> Status;
    get_clock "fmi3GetClock" (Handle, *const u32, usize, *mut Boolean) -> Status;
    set_float32 "fmi3SetFloat32" (Handle, *const u32, usize, *const f32, usize) -> Status;
    set_float64 "fmi3SetFloat64" (Handle, *const u32, usize, *const f64, usize) -> Status;
    set_int8 "fmi3SetInt8" (Handle, *const u32, usize, *const i8, usize) -> Status;
    set_uint8 "fmi3SetUInt8" (Handle, *const u32, usize, *const u8, usize) -> Status;
    set_int16 "fmi3SetInt16" (Handle, *const u32, usize, *const i16, usize) -> Status;
    set_uint16 "fmi3SetUInt16" (Handle, *const u32, usize, *const u16, usize) -> Status;
    set_int32 "fmi3SetInt32" (Handle, *const u32, usize, *const i32, usize) -> Status;
    set_uint32 "fmi3SetUInt32" (Handle, *const u32, usize, *const u32, usize) -> Status;
    set_int64 "fmi3SetInt64" (Handle, *const u32, usize, *const i64, usize) -> Status;
    set_uint64 "fmi3SetUInt64" (Handle, *const u32, usize, *const u64, usize) -> Status;
    set_boolean "fmi3SetBoolean" (Handle, *const u32, usize, *const Boolean, usize) -> Status;
    set_string "fmi3SetString" (Handle, *const u32, usize, *const Text, usize) -> Status;
    set_binary "fmi3SetBinary" (Handle, *const u32, usize, *const usize, *const Bytes, usize) -> Status;
    set_clock "fmi3SetClock" (Handle, *const u32, usize, *const Boolean) -> Status;
    get_number_of_variable_dependencies "fmi3GetNumberOfVariableDependencies" (Handle, u32, *mut usize) -> Status;
    get_variable_dependencies "fmi3GetVariableDependencies" (Handle, u32, *mut usize, *mut u32, *mut usize, *mut c_int, usize) -> Status;
    get_fmu_state "fmi3GetFMUState" (Handle, *mut Handle) -> Status;
    set_fmu_state "fmi3SetFMUState" (Handle, Handle) -> Status;
    free_fmu_state "fmi3FreeFMUState" (Handle, *mut Handle) -> Status;
    serialized_fmu_state_size "fmi3SerializedFMUStateSize" (Handle, Handle, *mut usize) -> Status;
    serialize_fmu_state "fmi3SerializeFMUState" (Handle, Handle, *mut u8, usize) -> Status;
    deserialize_fmu_state "fmi3DeserializeFMUState" (Handle, *const u8, usize, *mut Handle) -> Status;
    get_directional_derivative "fmi3GetDirectionalDerivative" (Handle, *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize) -> Status;
    get_adjoint_derivative "fmi3GetAdjointDerivative" (Handle, *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize) -> Status;
    enter_configuration_mode "fmi3EnterConfigurationMode" (Handle) -> Status;
    exit_configuration_mode "fmi3ExitConfigurationMode" (Handle) -> Status;
    get_interval_decimal "fmi3GetIntervalDecimal" (Handle, *const u32, usize, *mut f64, *mut c_int) -> Status;
    get_interval_fraction "fmi3GetIntervalFraction" (Handle, *const u32, usize, *mut u64, *mut u64, *mut c_int) -> Status;
    get_shift_decimal "fmi3GetShiftDecimal" (Handle, *const u32, usize, *mut f64) -> Status;
    get_shift_fraction "fmi3GetShiftFraction" (Handle, *const u32, usize, *mut u64, *mut u64) -> Status;
    set_interval_decimal "fmi3SetIntervalDecimal" (Handle, *const u32, usize, *const f64) -> Status;
    set_interval_fraction "fmi3SetIntervalFraction" (Handle, *const u32, usize, *const u64, *const u64) -> Status;
    set_shift_decimal "fmi3SetShiftDecimal" (Handle, *const u32, usize, *const f64) -> Status;
    set_shift_fraction "fmi3SetShiftFraction" (Handle, *const u32, usize, *const u64, *const u64) -> Status;
    evaluate_discrete_states "fmi3EvaluateDiscreteStates" (Handle) -> Status;
    update_discrete_states "fmi3UpdateDiscreteStates" (Handle, *mut Boolean, *mut Boolean, *mut Boolean, *mut Boolean, *mut Boolean, *mut f64) -> Status;
    enter_continuous_time_mode "fmi3EnterContinuousTimeMode" (Handle) -> Status;
    completed_integrator_step "fmi3CompletedIntegratorStep" (Handle, Boolean, *mut Boolean, *mut Boolean) -> Status;
    set_time "fmi3SetTime" (Handle, f64) -> Status;
    set_continuous_states "fmi3SetContinuousStates" (Handle, *const f64, usize) -> Status;
    get_continuous_state_derivatives "fmi3GetContinuousStateDerivatives" (Handle, *mut f64, usize) -> Status;
    get_event_indicators "fmi3GetEventIndicators" (Handle, *mut f64, usize) -> Status;
    get_continuous_states "fmi3GetContinuousStates" (Handle, *mut f64, usize) -> Status;
    get_nominals_of_continuous_states "fmi3GetNominalsOfContinuousStates" (Handle, *mut f64, usize) -> Status;
    get_number_of_event_indicators "fmi3GetNumberOfEventIndicators" (Handle, *mut usize) -> Status;
    get_number_of_continuous_states "fmi3GetNumberOfContinuousStates" (Handle, *mut usize) -> Status;
    enter_step_mode "fmi3EnterStepMode" (Handle) -> Status;
    get_output_derivatives "fmi3GetOutputDerivatives" (Handle, *const u32, usize, *const i32, *mut f64, usize) -> Status;
    do_step "fmi3DoStep" (Handle, f64, f64, Boolean, *mut Boolean, *mut Boolean, *mut Boolean, *mut f64) -> Status;
    activate_model_partition "fmi3ActivateModelPartition" (Handle, u32, f64) -> Status;
}
