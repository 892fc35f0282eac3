//! The states in which each call is legal: the tables of 3.2.3 and 4.2.4 of the standard (2.0.5).
//!
//! In addition `fmi2SetTime` is legal in Event Mode, which the standard allows only for FMUs without continuous states: several
//! importers set the time there before the first step.

use crate::fmi;
use crate::unit::instance::Interface;
use crate::unit::life_cycle::Phase;

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

macro_rules! calls {
    ($($call:ident $name:literal $phases:expr;)*) => {
        /// A function of the interface that acts on an instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[expect(missing_docs, reason = "each is the function of the standard with the same name")]
        pub enum Call {
            $($call,)*
        }

        impl Call {
            /// Returns the name of the function.
            pub fn name(self) -> &'static str {
                match self {
                    $(Call::$call => $name,)*
                }
            }

            #[inline]
            fn phases(self) -> u16 {
                match self {
                    $(Call::$call => $phases,)*
                }
            }
        }
    };
}

calls! {
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
    SetRealInputDerivatives "fmi2SetRealInputDerivatives" SETTABLE_RATES;
    GetRealOutputDerivatives "fmi2GetRealOutputDerivatives" STEPPED;
    DoStep "fmi2DoStep" COMPLETE;
    CancelStep "fmi2CancelStep" NEVER;
    GetStatus "fmi2GetStatus" STATUS;
    GetRealStatus "fmi2GetRealStatus" STATUS;
    GetIntegerStatus "fmi2GetIntegerStatus" STATUS;
    GetBooleanStatus "fmi2GetBooleanStatus" STATUS;
    GetStringStatus "fmi2GetStringStatus" STATUS;
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

/// States only of Co-Simulation, and only of Model Exchange.
const OF_CO_SIMULATION: u16 = COMPLETE | FAILED;
const OF_MODEL_EXCHANGE: u16 = EVENT | CONTINUOUS;

impl fmi::Call for Call {
    fn name(self) -> &'static str {
        self.name()
    }

    #[inline]
    fn admitted_in(self, phase: Phase, interface: Interface) -> Result<(), String> {
        if self.phases() & phase.bit() != 0 && self.interface().is_none_or(|needed| needed == interface) {
            return Ok(());
        }
        Err(self.refusal(phase, interface))
    }

    fn lead_to(phase: Phase, interface: Interface) -> bool {
        let others = match interface {
            Interface::CoSimulation => OF_MODEL_EXCHANGE,
            Interface::ModelExchange => OF_CO_SIMULATION,
        };
        AFTER_INSTANTIATION & !others & phase.bit() != 0
    }
}

impl Call {
    /// Returns the reason for a refusal, with the states that allow the call.
    #[cold]
    fn refusal(self, phase: Phase, interface: Interface) -> String {
        let phases = self.phases();
        match (phases, self.interface()) {
            (NEVER, _) => "no step is ever in progress, steps are synchronous".into(),
            (_, Some(Interface::ModelExchange)) if interface == Interface::CoSimulation => {
                "found an instance for Co-Simulation; expected one for Model Exchange".into()
            }
            (_, Some(Interface::CoSimulation)) if interface == Interface::ModelExchange => {
                "found an instance for Model Exchange; expected one for Co-Simulation".into()
            }
            _ => {
                let allowed =
                    |phase: &Phase| phases & phase.bit() != 0 && <Call as fmi::Call>::lead_to(*phase, interface);
                let allowed = Phase::ALL.into_iter().filter(allowed);
                let allowed: Vec<&str> = allowed.map(name).collect();
                format!("not allowed in state {}; expected {}", name(phase), allowed.join(", "))
            }
        }
    }

    /// Returns the only interface type that has the call, or `None` if both have it.
    #[inline]
    fn interface(self) -> Option<Interface> {
        match self {
            Call::DoStep
            | Call::SetRealInputDerivatives
            | Call::GetRealOutputDerivatives
            | Call::GetStatus
            | Call::GetRealStatus
            | Call::GetIntegerStatus
            | Call::GetBooleanStatus
            | Call::GetStringStatus => Some(Interface::CoSimulation),
            Call::EnterEventMode
            | Call::NewDiscreteStates
            | Call::EnterContinuousTimeMode
            | Call::CompletedIntegratorStep
            | Call::SetTime
            | Call::SetContinuousStates
            | Call::GetDerivatives
            | Call::GetEventIndicators
            | Call::GetContinuousStates
            | Call::GetNominalsOfContinuousStates => Some(Interface::ModelExchange),
            Call::SetDebugLogging
            | Call::SetupExperiment
            | Call::EnterInitializationMode
            | Call::ExitInitializationMode
            | Call::Terminate
            | Call::Reset
            | Call::GetReal
            | Call::GetInteger
            | Call::GetBoolean
            | Call::GetString
            | Call::SetReal
            | Call::SetInteger
            | Call::SetBoolean
            | Call::SetString
            | Call::GetFmuState
            | Call::SetFmuState
            | Call::FreeFmuState
            | Call::SerializedFmuStateSize
            | Call::SerializeFmuState
            | Call::DeSerializeFmuState
            | Call::GetDirectionalDerivative
            | Call::CancelStep => None,
        }
    }
}

/// Returns the standard's name of a state.
fn name(phase: Phase) -> &'static str {
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
