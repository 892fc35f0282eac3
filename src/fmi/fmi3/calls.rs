//! The states in which each call is legal: the state machines of the standard (3.0.2, 2.3, 3.2 and 4.2).
//!
//! In addition some harmless calls are legal: values and the numbers of states and indicators can be read in every state, and
//! `fmi3SetTime` can be called in Event Mode, where several importers set the time before the first step.

use crate::fmi;
use crate::unit::instance::Interface;
use crate::unit::life_cycle::Phase;

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

/// States only of Co-Simulation, and only of Model Exchange.
const OF_CO_SIMULATION: u16 = STEP | AHEAD | READING | ENDED;
const OF_MODEL_EXCHANGE: u16 = CONTINUOUS;

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
    SetDebugLogging "fmi3SetDebugLogging" ANY;
    EnterConfigurationMode "fmi3EnterConfigurationMode" INSTANTIATED;
    ExitConfigurationMode "fmi3ExitConfigurationMode" CONFIGURATION;
    EnterInitializationMode "fmi3EnterInitializationMode" INSTANTIATED;
    ExitInitializationMode "fmi3ExitInitializationMode" INITIALIZATION;
    EnterEventMode "fmi3EnterEventMode" STEP | CONTINUOUS;
    UpdateDiscreteStates "fmi3UpdateDiscreteStates" EVENT;
    EnterStepMode "fmi3EnterStepMode" EVENT;
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
    DoStep "fmi3DoStep" STEP | ENDED;
    GetOutputDerivatives "fmi3GetOutputDerivatives" EVENT | STEP | READING | ENDED | TERMINATED | ERROR;
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
        (ANY | AHEAD | READING) & !others & phase.bit() != 0
    }
}

impl Call {
    /// Returns the reason for a refusal, with the states that allow the call.
    #[cold]
    fn refusal(self, phase: Phase, interface: Interface) -> String {
        let phases = self.phases();
        if let Some(needed) = self.interface().filter(|needed| *needed != interface) {
            let called = |interface| match interface {
                Interface::CoSimulation => "Co-Simulation",
                Interface::ModelExchange => "Model Exchange",
            };
            return format!("found an instance for {}; expected one for {}", called(interface), called(needed));
        }
        if phases == NEVER {
            return self.missing().into();
        }
        let allowed = |phase: &Phase| phases & phase.bit() != 0 && <Call as fmi::Call>::lead_to(*phase, interface);
        let allowed = Phase::ALL.into_iter().filter(allowed);
        let allowed: Vec<&str> = allowed.map(name).collect();
        format!("not allowed in {}; expected {}", name(phase), allowed.join(", "))
    }

    /// Returns the only interface type that has the call, or `None` if both have it.
    #[inline]
    fn interface(self) -> Option<Interface> {
        match self {
            Call::DoStep | Call::EnterStepMode | Call::GetOutputDerivatives => Some(Interface::CoSimulation),
            Call::EnterContinuousTimeMode
            | Call::CompletedIntegratorStep
            | Call::SetTime
            | Call::SetContinuousStates
            | Call::GetContinuousStateDerivatives
            | Call::GetEventIndicators
            | Call::GetContinuousStates
            | Call::GetNominalsOfContinuousStates
            | Call::GetNumberOfEventIndicators
            | Call::GetNumberOfContinuousStates => Some(Interface::ModelExchange),
            _ => None,
        }
    }

    /// Returns the reason why a function is never legal.
    fn missing(self) -> &'static str {
        match self {
            Call::EvaluateDiscreteStates => "providesEvaluateDiscreteStates is false",
            Call::GetNumberOfVariableDependencies | Call::GetVariableDependencies => {
                "providesPerElementDependencies is false; ModelStructure has the dependencies"
            }
            Call::SetInputDerivatives => "FMI 3.0 has no derivatives of inputs",
            _ => "this FMU has no clocks",
        }
    }
}

/// Returns the standard's name of a state.
fn name(phase: Phase) -> &'static str {
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
