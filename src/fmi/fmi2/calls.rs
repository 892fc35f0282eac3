//! The states in which each call is legal: the tables of 3.2.3 and 4.2.4 of the standard (2.0.5).
//!
//! In addition `fmi2SetTime` is legal in Event Mode, which the standard allows only for FMUs without continuous states: several
//! importers set the time there before the first step.

use crate::fmi;
use crate::fmi::calls::{BOTH, calls};
use crate::fmi::fmi2::callbacks::Messenger;
use crate::fmi::fmi2::instance::Fmi2;
use crate::unit::fmu::Fmu;
use crate::unit::life_cycle::{Interface, Phase};

const INSTANTIATED: u16 = Phase::Instantiated.bit();
const INITIALIZATION: u16 = Phase::InitializationMode.bit();
const COMPLETE: u16 = Phase::StepComplete.bit();
const FAILED: u16 = Phase::StepFailed.bit();
const EVENT: u16 = Phase::EventMode.bit();
const CONTINUOUS: u16 = Phase::ContinuousTimeMode.bit();
const TERMINATED: u16 = Phase::Terminated.bit();
const ERROR: u16 = Phase::Error.bit();
const NEVER: u16 = 0;

const READABLE: u16 = INITIALIZATION | COMPLETE | FAILED | EVENT | CONTINUOUS | TERMINATED | ERROR;
const AFTER_INSTANTIATION: u16 = INSTANTIATED | READABLE;
const SETTABLE: u16 = INSTANTIATED | INITIALIZATION | COMPLETE | EVENT;
const SETTABLE_RATES: u16 = INSTANTIATED | INITIALIZATION | COMPLETE;
const STEPPED: u16 = COMPLETE | FAILED | TERMINATED | ERROR;
const STATUS: u16 = COMPLETE | FAILED | TERMINATED;
const EXCHANGED: u16 = INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | ERROR;

calls! {
    BOTH => {
        SetDebugLogging "fmi2SetDebugLogging" AFTER_INSTANTIATION;
        SetupExperiment "fmi2SetupExperiment" INSTANTIATED;
        EnterInitializationMode "fmi2EnterInitializationMode" INSTANTIATED;
        ExitInitializationMode "fmi2ExitInitializationMode" INITIALIZATION;
        Terminate "fmi2Terminate" COMPLETE | FAILED | EVENT | CONTINUOUS;
        Reset "fmi2Reset" AFTER_INSTANTIATION;
        GetReal "fmi2GetReal" READABLE;
        GetInteger "fmi2GetInteger" READABLE;
        GetBoolean "fmi2GetBoolean" READABLE;
        GetString "fmi2GetString" READABLE;
        SetReal "fmi2SetReal" SETTABLE | CONTINUOUS;
        SetInteger "fmi2SetInteger" SETTABLE;
        SetBoolean "fmi2SetBoolean" SETTABLE;
        SetString "fmi2SetString" SETTABLE;
        GetFmuState "fmi2GetFMUstate" AFTER_INSTANTIATION;
        SetFmuState "fmi2SetFMUstate" AFTER_INSTANTIATION;
        FreeFmuState "fmi2FreeFMUstate" AFTER_INSTANTIATION;
        SerializedFmuStateSize "fmi2SerializedFMUstateSize" AFTER_INSTANTIATION;
        SerializeFmuState "fmi2SerializeFMUstate" AFTER_INSTANTIATION;
        DeSerializeFmuState "fmi2DeSerializeFMUstate" AFTER_INSTANTIATION;
        GetDirectionalDerivative "fmi2GetDirectionalDerivative" READABLE;
        CancelStep "fmi2CancelStep" NEVER;
    }
    Some(Interface::CoSimulation) => {
        SetRealInputDerivatives "fmi2SetRealInputDerivatives" SETTABLE_RATES;
        GetRealOutputDerivatives "fmi2GetRealOutputDerivatives" STEPPED;
        DoStep "fmi2DoStep" COMPLETE;
        GetStatus "fmi2GetStatus" STATUS;
        GetRealStatus "fmi2GetRealStatus" STATUS;
        GetIntegerStatus "fmi2GetIntegerStatus" STATUS;
        GetBooleanStatus "fmi2GetBooleanStatus" STATUS;
        GetStringStatus "fmi2GetStringStatus" STATUS;
    }
    Some(Interface::ModelExchange) => {
        EnterEventMode "fmi2EnterEventMode" EVENT | CONTINUOUS;
        NewDiscreteStates "fmi2NewDiscreteStates" EVENT;
        EnterContinuousTimeMode "fmi2EnterContinuousTimeMode" EVENT;
        CompletedIntegratorStep "fmi2CompletedIntegratorStep" CONTINUOUS;
        SetTime "fmi2SetTime" EVENT | CONTINUOUS;
        SetContinuousStates "fmi2SetContinuousStates" CONTINUOUS;
        GetDerivatives "fmi2GetDerivatives" EXCHANGED;
        GetEventIndicators "fmi2GetEventIndicators" EXCHANGED;
        GetContinuousStates "fmi2GetContinuousStates" EXCHANGED;
        GetNominalsOfContinuousStates "fmi2GetNominalsOfContinuousStates" INSTANTIATED | EXCHANGED;
    }
}

impl<U: Fmu> fmi::Version for Fmi2<U> {
    type Unit = U;
    type Call = Call;
    type Messenger = Messenger;

    fn reached(interface: Interface) -> u16 {
        match interface {
            Interface::CoSimulation => AFTER_INSTANTIATION & !(EVENT | CONTINUOUS),
            Interface::ModelExchange => AFTER_INSTANTIATION & !(COMPLETE | FAILED),
        }
    }

    fn state(phase: Phase) -> &'static str {
        match phase {
            Phase::Instantiated => "instantiated",
            Phase::InitializationMode => "initializationMode",
            Phase::StepComplete => "stepComplete",
            // States of FMI 3.0, which no instance of FMI 2.0 reaches.
            Phase::ConfigurationMode => "configurationMode",
            Phase::SettingAhead | Phase::ReadingOutputs => "intermediateUpdateMode",
            Phase::StepFailed => "stepFailed",
            Phase::EventMode => "eventMode",
            Phase::ContinuousTimeMode => "continuousTimeMode",
            Phase::Terminated => "terminated",
            Phase::Error => "error",
            Phase::Fatal => "fatal",
        }
    }

    fn missing(_: Call) -> &'static str {
        "no step is ever in progress, steps are synchronous"
    }
}
