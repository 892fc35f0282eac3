//! The states in which each call is legal: the state machines of the standard (3.0.2, 2.3, 3.2 and 4.2).
//!
//! In addition some harmless calls are legal: values and the numbers of states and indicators can be read in every state, and
//! `fmi3SetTime` can be called in Event Mode, where several importers set the time before the first step.

use crate::fmi;
use crate::fmi::calls::{BOTH, calls};
use crate::fmi::fmi3::callbacks::Messenger;
use crate::fmi::fmi3::instance::Fmi3;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::{Interface, Phase};

const INSTANTIATED: u16 = Phase::Instantiated.bit();
const CONFIGURATION: u16 = Phase::ConfigurationMode.bit();
const INITIALIZATION: u16 = Phase::InitializationMode.bit();
const EVENT: u16 = Phase::EventMode.bit();
const STEP: u16 = Phase::StepComplete.bit();
const AHEAD: u16 = Phase::SettingAhead.bit();
const READING: u16 = Phase::ReadingOutputs.bit();
const CONTINUOUS: u16 = Phase::ContinuousTimeMode.bit();
const ENDED: u16 = Phase::StepFailed.bit();
const TERMINATED: u16 = Phase::Terminated.bit();
const ERROR: u16 = Phase::Error.bit();
const NEVER: u16 = 0;

const COMPUTED: u16 = INITIALIZATION | EVENT | STEP | CONTINUOUS | ENDED | TERMINATED | ERROR;
const ANY: u16 = INSTANTIATED | CONFIGURATION | COMPUTED;
const READABLE: u16 = ANY | READING;
const SETTABLE: u16 = INSTANTIATED | INITIALIZATION | EVENT | STEP;
const EXCHANGED: u16 = INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR;

calls! {
    BOTH => {
        SetDebugLogging "fmi3SetDebugLogging" ANY;
        EnterConfigurationMode "fmi3EnterConfigurationMode" INSTANTIATED;
        ExitConfigurationMode "fmi3ExitConfigurationMode" CONFIGURATION;
        EnterInitializationMode "fmi3EnterInitializationMode" INSTANTIATED;
        ExitInitializationMode "fmi3ExitInitializationMode" INITIALIZATION;
        EnterEventMode "fmi3EnterEventMode" STEP | CONTINUOUS;
        UpdateDiscreteStates "fmi3UpdateDiscreteStates" EVENT;
        Terminate "fmi3Terminate" EVENT | STEP | CONTINUOUS | ENDED;
        Reset "fmi3Reset" ANY;
        GetFloat32 "fmi3GetFloat32" READABLE;
        GetFloat64 "fmi3GetFloat64" READABLE;
        GetInt8 "fmi3GetInt8" READABLE;
        GetUInt8 "fmi3GetUInt8" READABLE;
        GetInt16 "fmi3GetInt16" READABLE;
        GetUInt16 "fmi3GetUInt16" READABLE;
        GetInt32 "fmi3GetInt32" READABLE;
        GetUInt32 "fmi3GetUInt32" READABLE;
        GetInt64 "fmi3GetInt64" READABLE;
        GetUInt64 "fmi3GetUInt64" READABLE;
        GetBoolean "fmi3GetBoolean" READABLE;
        GetString "fmi3GetString" READABLE;
        GetBinary "fmi3GetBinary" READABLE;
        SetFloat32 "fmi3SetFloat32" SETTABLE;
        SetFloat64 "fmi3SetFloat64" SETTABLE | CONTINUOUS | AHEAD;
        SetInt8 "fmi3SetInt8" SETTABLE;
        SetUInt8 "fmi3SetUInt8" SETTABLE;
        SetInt16 "fmi3SetInt16" SETTABLE;
        SetUInt16 "fmi3SetUInt16" SETTABLE;
        SetInt32 "fmi3SetInt32" SETTABLE;
        SetUInt32 "fmi3SetUInt32" SETTABLE;
        SetInt64 "fmi3SetInt64" SETTABLE;
        SetUInt64 "fmi3SetUInt64" CONFIGURATION;
        SetBoolean "fmi3SetBoolean" SETTABLE;
        SetString "fmi3SetString" SETTABLE;
        SetBinary "fmi3SetBinary" SETTABLE;
        GetFmuState "fmi3GetFMUState" ANY;
        SetFmuState "fmi3SetFMUState" ANY;
        FreeFmuState "fmi3FreeFMUState" ANY;
        SerializedFmuStateSize "fmi3SerializedFMUStateSize" ANY;
        SerializeFmuState "fmi3SerializeFMUState" ANY;
        DeserializeFmuState "fmi3DeserializeFMUState" ANY;
        GetDirectionalDerivative "fmi3GetDirectionalDerivative" COMPUTED;
        GetAdjointDerivative "fmi3GetAdjointDerivative" COMPUTED;
        GetClock "fmi3GetClock" NEVER;
        SetClock "fmi3SetClock" NEVER;
        SetInputDerivatives "fmi3SetInputDerivatives" NEVER;
        GetIntervalDecimal "fmi3GetIntervalDecimal" NEVER;
        GetIntervalFraction "fmi3GetIntervalFraction" NEVER;
        GetShiftDecimal "fmi3GetShiftDecimal" NEVER;
        GetShiftFraction "fmi3GetShiftFraction" NEVER;
        SetIntervalDecimal "fmi3SetIntervalDecimal" NEVER;
        SetIntervalFraction "fmi3SetIntervalFraction" NEVER;
        SetShiftDecimal "fmi3SetShiftDecimal" NEVER;
        SetShiftFraction "fmi3SetShiftFraction" NEVER;
        ActivateModelPartition "fmi3ActivateModelPartition" NEVER;
        EvaluateDiscreteStates "fmi3EvaluateDiscreteStates" NEVER;
        GetNumberOfVariableDependencies "fmi3GetNumberOfVariableDependencies" NEVER;
        GetVariableDependencies "fmi3GetVariableDependencies" NEVER;
    }
    Some(Interface::CoSimulation) => {
        EnterStepMode "fmi3EnterStepMode" EVENT;
        DoStep "fmi3DoStep" STEP | ENDED;
        GetOutputDerivatives "fmi3GetOutputDerivatives" EVENT | STEP | READING | ENDED | TERMINATED | ERROR;
    }
    Some(Interface::ModelExchange) => {
        EnterContinuousTimeMode "fmi3EnterContinuousTimeMode" EVENT;
        CompletedIntegratorStep "fmi3CompletedIntegratorStep" CONTINUOUS;
        SetTime "fmi3SetTime" EVENT | CONTINUOUS;
        SetContinuousStates "fmi3SetContinuousStates" CONTINUOUS;
        GetContinuousStateDerivatives "fmi3GetContinuousStateDerivatives" EXCHANGED;
        GetEventIndicators "fmi3GetEventIndicators" EXCHANGED;
        GetContinuousStates "fmi3GetContinuousStates" EXCHANGED;
        GetNominalsOfContinuousStates "fmi3GetNominalsOfContinuousStates" EXCHANGED;
        GetNumberOfEventIndicators "fmi3GetNumberOfEventIndicators" ANY;
        GetNumberOfContinuousStates "fmi3GetNumberOfContinuousStates" ANY;
    }
}

impl<U: Fmu> fmi::Version for Fmi3<U> {
    type Unit = U;
    type Call = Call;
    type Messenger = Messenger;

    fn reached(interface: Interface) -> u16 {
        match interface {
            Interface::CoSimulation => (ANY | AHEAD | READING) & !CONTINUOUS,
            Interface::ModelExchange => ANY & !(STEP | ENDED),
        }
    }

    fn state(phase: Phase) -> &'static str {
        match phase {
            Phase::Instantiated => "Instantiated",
            Phase::ConfigurationMode => "Configuration Mode",
            Phase::InitializationMode => "Initialization Mode",
            Phase::EventMode => "Event Mode",
            Phase::StepComplete => "Step Mode",
            Phase::SettingAhead => "Intermediate Update Mode (inputs requested)",
            Phase::ReadingOutputs => "Intermediate Update Mode (outputs allowed)",
            Phase::ContinuousTimeMode => "Continuous-Time Mode",
            Phase::StepFailed => "Step Mode after the end of the run",
            Phase::Terminated => "Terminated",
            Phase::Error => "Terminated by an error",
            Phase::Fatal => "Fatal",
        }
    }

    fn missing(call: Call) -> &'static str {
        match call {
            Call::EvaluateDiscreteStates => "providesEvaluateDiscreteStates is false",
            Call::GetNumberOfVariableDependencies | Call::GetVariableDependencies => {
                "providesPerElementDependencies is false; ModelStructure has the dependencies"
            }
            Call::SetInputDerivatives => "FMI 3.0 has no derivatives of inputs",
            _ => "this FMU has no clocks",
        }
    }
}
