//! The C functions of the standard's headers (fmi2FunctionTypes.h, 2.0.4), written from these and not from the crate.

use std::ffi::{c_char, c_int, c_uint, c_void};

use crate::loading::functions;

pub type Component = *mut c_void;
pub type Environment = *mut c_void;
pub type SavedState = *mut c_void;
pub type Text = *const c_char;
pub type Reference = c_uint;
pub type Boolean = c_int;
pub type Status = c_int;
pub type StatusKind = c_int;

pub const OK: Status = 0;
pub const WARNING: Status = 1;
pub const DISCARD: Status = 2;
pub const ERROR: Status = 3;

pub const MODEL_EXCHANGE: c_int = 0;
pub const CO_SIMULATION: c_int = 1;

pub const DO_STEP_STATUS: StatusKind = 0;
pub const PENDING_STATUS: StatusKind = 1;
pub const LAST_SUCCESSFUL_TIME: StatusKind = 2;
pub const TERMINATED: StatusKind = 3;

/// The logger is variadic in C, which Rust cannot define. The unit passes no variadic argument, so that one without them can be called.
pub type Logger = unsafe extern "C" fn(Environment, Text, Status, Text, Text);

#[repr(C)]
pub struct Callbacks {
    pub logger: Option<Logger>,
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    pub step_finished: Option<unsafe extern "C" fn(Environment, Status)>,
    pub environment: Environment,
}

/// Information for the importer after an event of Model Exchange.
#[repr(C)]
#[derive(Clone, Copy, Default, Debug)]
pub struct EventInfo {
    pub new_discrete_states_needed: Boolean,
    pub terminate_simulation: Boolean,
    pub nominals_of_continuous_states_changed: Boolean,
    pub values_of_continuous_states_changed: Boolean,
    pub next_event_time_defined: Boolean,
    pub next_event_time: f64,
}

functions! {
    get_types_platform "fmi2GetTypesPlatform" () -> Text;
    get_version "fmi2GetVersion" () -> Text;
    set_debug_logging "fmi2SetDebugLogging" (Component, Boolean, usize, *const Text) -> Status;
    instantiate "fmi2Instantiate" (Text, c_int, Text, Text, *const Callbacks, Boolean, Boolean) -> Component;
    free_instance "fmi2FreeInstance" (Component);
    setup_experiment "fmi2SetupExperiment" (Component, Boolean, f64, f64, Boolean, f64) -> Status;
    enter_initialization_mode "fmi2EnterInitializationMode" (Component) -> Status;
    exit_initialization_mode "fmi2ExitInitializationMode" (Component) -> Status;
    terminate "fmi2Terminate" (Component) -> Status;
    reset "fmi2Reset" (Component) -> Status;
    get_real "fmi2GetReal" (Component, *const Reference, usize, *mut f64) -> Status;
    get_integer "fmi2GetInteger" (Component, *const Reference, usize, *mut c_int) -> Status;
    get_boolean "fmi2GetBoolean" (Component, *const Reference, usize, *mut Boolean) -> Status;
    get_string "fmi2GetString" (Component, *const Reference, usize, *mut Text) -> Status;
    set_real "fmi2SetReal" (Component, *const Reference, usize, *const f64) -> Status;
    set_integer "fmi2SetInteger" (Component, *const Reference, usize, *const c_int) -> Status;
    set_boolean "fmi2SetBoolean" (Component, *const Reference, usize, *const Boolean) -> Status;
    set_string "fmi2SetString" (Component, *const Reference, usize, *const Text) -> Status;
    get_fmu_state "fmi2GetFMUstate" (Component, *mut SavedState) -> Status;
    set_fmu_state "fmi2SetFMUstate" (Component, SavedState) -> Status;
    free_fmu_state "fmi2FreeFMUstate" (Component, *mut SavedState) -> Status;
    serialized_size "fmi2SerializedFMUstateSize" (Component, SavedState, *mut usize) -> Status;
    serialize "fmi2SerializeFMUstate" (Component, SavedState, *mut c_char, usize) -> Status;
    deserialize "fmi2DeSerializeFMUstate" (Component, *const c_char, usize, *mut SavedState) -> Status;
    get_directional_derivative "fmi2GetDirectionalDerivative"
        (Component, *const Reference, usize, *const Reference, usize, *const f64, *mut f64) -> Status;
    enter_event_mode "fmi2EnterEventMode" (Component) -> Status;
    new_discrete_states "fmi2NewDiscreteStates" (Component, *mut EventInfo) -> Status;
    enter_continuous_time_mode "fmi2EnterContinuousTimeMode" (Component) -> Status;
    completed_integrator_step "fmi2CompletedIntegratorStep" (Component, Boolean, *mut Boolean, *mut Boolean) -> Status;
    set_time "fmi2SetTime" (Component, f64) -> Status;
    set_continuous_states "fmi2SetContinuousStates" (Component, *const f64, usize) -> Status;
    get_derivatives "fmi2GetDerivatives" (Component, *mut f64, usize) -> Status;
    get_event_indicators "fmi2GetEventIndicators" (Component, *mut f64, usize) -> Status;
    get_continuous_states "fmi2GetContinuousStates" (Component, *mut f64, usize) -> Status;
    get_nominals "fmi2GetNominalsOfContinuousStates" (Component, *mut f64, usize) -> Status;
    set_real_input_derivatives "fmi2SetRealInputDerivatives"
        (Component, *const Reference, usize, *const c_int, *const f64) -> Status;
    get_real_output_derivatives "fmi2GetRealOutputDerivatives"
        (Component, *const Reference, usize, *const c_int, *mut f64) -> Status;
    do_step "fmi2DoStep" (Component, f64, f64, Boolean) -> Status;
    cancel_step "fmi2CancelStep" (Component) -> Status;
    get_status "fmi2GetStatus" (Component, StatusKind, *mut Status) -> Status;
    get_real_status "fmi2GetRealStatus" (Component, StatusKind, *mut f64) -> Status;
    get_integer_status "fmi2GetIntegerStatus" (Component, StatusKind, *mut c_int) -> Status;
    get_boolean_status "fmi2GetBooleanStatus" (Component, StatusKind, *mut Boolean) -> Status;
    get_string_status "fmi2GetStringStatus" (Component, StatusKind, *mut Text) -> Status;
}
