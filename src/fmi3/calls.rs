//! Which call is legal in which state: the state machine of Co-Simulation of the standard (3.0.1, 2.3 and 4.2), in one place.

use crate::fmi;
use crate::model::life_cycle::Phase;
use crate::model::unit::Interface;

const INSTANTIATED: u16 = Phase::Instantiated.bit();
const CONFIGURATION: u16 = Phase::ConfigurationMode.bit();
const INITIALIZATION: u16 = Phase::InitializationMode.bit();
const EVENT: u16 = Phase::EventMode.bit();
const STEP: u16 = Phase::StepComplete.bit();
const AHEAD: u16 = Phase::SettingAhead.bit();
const LOOKING: u16 = Phase::LookingIn.bit();
const ENDED: u16 = Phase::StepFailed.bit();
const TERMINATED: u16 = Phase::Terminated.bit();
const ERROR: u16 = Phase::Error.bit();
const NEVER: u16 = 0;

const ANY: u16 = INSTANTIATED | CONFIGURATION | INITIALIZATION | EVENT | STEP | ENDED | TERMINATED | ERROR;
const COMPUTED: u16 = INITIALIZATION | EVENT | STEP | ENDED | TERMINATED | ERROR;
const READABLE: u16 = INSTANTIATED | CONFIGURATION | COMPUTED | LOOKING;
const SETTABLE: u16 = INSTANTIATED | INITIALIZATION | EVENT | STEP;

macro_rules! calls {
    ($($call:ident $name:literal $phases:expr;)*) => {
        /// A function of the interface that acts on an instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[expect(missing_docs, reason = "each is the function of the standard with the same name")]
        pub enum Call {
            $($call,)*
        }

        impl Call {
            /// Name of the function.
            pub fn name(self) -> &'static str {
                match self {
                    $(Call::$call => $name,)*
                }
            }

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
    EnterEventMode "fmi3EnterEventMode" STEP;
    UpdateDiscreteStates "fmi3UpdateDiscreteStates" EVENT;
    EnterStepMode "fmi3EnterStepMode" EVENT;
    Terminate "fmi3Terminate" EVENT | STEP | ENDED;
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
    SetFloat64 "fmi3SetFloat64" SETTABLE | AHEAD;
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
    GetOutputDerivatives "fmi3GetOutputDerivatives" EVENT | STEP | LOOKING | ENDED | TERMINATED | ERROR;
    GetClock "fmi3GetClock" NEVER;
    SetClock "fmi3SetClock" NEVER;
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
    EnterContinuousTimeMode "fmi3EnterContinuousTimeMode" NEVER;
    CompletedIntegratorStep "fmi3CompletedIntegratorStep" NEVER;
    SetTime "fmi3SetTime" NEVER;
    SetContinuousStates "fmi3SetContinuousStates" NEVER;
    GetContinuousStateDerivatives "fmi3GetContinuousStateDerivatives" NEVER;
    GetEventIndicators "fmi3GetEventIndicators" NEVER;
    GetContinuousStates "fmi3GetContinuousStates" NEVER;
    GetNominalsOfContinuousStates "fmi3GetNominalsOfContinuousStates" NEVER;
    GetNumberOfEventIndicators "fmi3GetNumberOfEventIndicators" NEVER;
    GetNumberOfContinuousStates "fmi3GetNumberOfContinuousStates" NEVER;
}

impl fmi::Call for Call {
    fn name(self) -> &'static str {
        self.name()
    }

    fn admitted_in(self, phase: Phase, _: Interface) -> Result<(), String> {
        let phases = self.phases();
        if phases & phase.bit() != 0 {
            return Ok(());
        }
        if phases == NEVER {
            return Err(self.missing().into());
        }
        let allowed: Vec<&str> = Phase::ALL.into_iter().filter(|p| phases & p.bit() != 0).map(name).collect();
        Err(format!("not allowed in {}; it is in {}", name(phase), allowed.join(", ")))
    }
}

impl Call {
    /// Why a function is never allowed.
    fn missing(self) -> &'static str {
        match self {
            Call::GetClock
            | Call::SetClock
            | Call::GetIntervalDecimal
            | Call::GetIntervalFraction
            | Call::GetShiftDecimal
            | Call::GetShiftFraction
            | Call::SetIntervalDecimal
            | Call::SetIntervalFraction
            | Call::SetShiftDecimal
            | Call::SetShiftFraction
            | Call::ActivateModelPartition => "this FMU has no clocks",
            Call::EvaluateDiscreteStates => "providesEvaluateDiscreteStates is false",
            Call::GetNumberOfVariableDependencies | Call::GetVariableDependencies => {
                "providesPerElementDependencies is false; ModelStructure has the dependencies"
            }
            _ => "this belongs to Model Exchange; this FMU offers Co-Simulation only",
        }
    }
}

/// What the standard calls a state.
fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::Instantiated => "Instantiated",
        Phase::ConfigurationMode => "Configuration Mode",
        Phase::InitializationMode => "Initialization Mode",
        Phase::EventMode => "Event Mode",
        Phase::StepComplete => "Step Mode",
        Phase::SettingAhead => "Intermediate Update Mode (inputs requested)",
        Phase::LookingIn => "Intermediate Update Mode (outputs allowed)",
        Phase::ContinuousTimeMode => "Continuous-Time Mode",
        Phase::StepFailed => "Step Mode after the end of the run",
        Phase::Terminated => "Terminated",
        Phase::Error => "Terminated by an error",
        Phase::Fatal => "Fatal",
    }
}
