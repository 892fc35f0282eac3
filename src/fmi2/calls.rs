//! Which call is legal in which state: the table of 4.2.4 of the standard (2.0.4), in one place.

use crate::model::life_cycle::Phase;

const INSTANTIATED: u16 = Phase::Instantiated.bit();
const INITIALIZATION: u16 = Phase::InitializationMode.bit();
const COMPLETE: u16 = Phase::StepComplete.bit();
const FAILED: u16 = Phase::StepFailed.bit();
const TERMINATED: u16 = Phase::Terminated.bit();
const ERROR: u16 = Phase::Error.bit();
const NEVER: u16 = 0;

const AFTER_INSTANTIATION: u16 = INSTANTIATED | INITIALIZATION | COMPLETE | FAILED | TERMINATED | ERROR;
const READABLE: u16 = INITIALIZATION | COMPLETE | FAILED | TERMINATED | ERROR;
const SETTABLE: u16 = INSTANTIATED | INITIALIZATION | COMPLETE;
const STEPPED: u16 = COMPLETE | FAILED | TERMINATED | ERROR;
const STATUS: u16 = COMPLETE | FAILED | TERMINATED;

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
    SetDebugLogging "fmi2SetDebugLogging" AFTER_INSTANTIATION;
    SetupExperiment "fmi2SetupExperiment" INSTANTIATED;
    EnterInitializationMode "fmi2EnterInitializationMode" INSTANTIATED;
    ExitInitializationMode "fmi2ExitInitializationMode" INITIALIZATION;
    Terminate "fmi2Terminate" COMPLETE | FAILED;
    Reset "fmi2Reset" AFTER_INSTANTIATION;
    GetReal "fmi2GetReal" READABLE;
    GetInteger "fmi2GetInteger" READABLE;
    GetBoolean "fmi2GetBoolean" READABLE;
    GetString "fmi2GetString" READABLE;
    SetReal "fmi2SetReal" SETTABLE;
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
    SetRealInputDerivatives "fmi2SetRealInputDerivatives" SETTABLE;
    GetRealOutputDerivatives "fmi2GetRealOutputDerivatives" STEPPED;
    DoStep "fmi2DoStep" COMPLETE;
    CancelStep "fmi2CancelStep" NEVER;
    GetStatus "fmi2GetStatus" STATUS;
    GetRealStatus "fmi2GetRealStatus" STATUS;
    GetIntegerStatus "fmi2GetIntegerStatus" STATUS;
    GetBooleanStatus "fmi2GetBooleanStatus" STATUS;
    GetStringStatus "fmi2GetStringStatus" STATUS;
    EnterEventMode "fmi2EnterEventMode" NEVER;
    NewDiscreteStates "fmi2NewDiscreteStates" NEVER;
    EnterContinuousTimeMode "fmi2EnterContinuousTimeMode" NEVER;
    CompletedIntegratorStep "fmi2CompletedIntegratorStep" NEVER;
    SetTime "fmi2SetTime" NEVER;
    SetContinuousStates "fmi2SetContinuousStates" NEVER;
    GetDerivatives "fmi2GetDerivatives" NEVER;
    GetEventIndicators "fmi2GetEventIndicators" NEVER;
    GetContinuousStates "fmi2GetContinuousStates" NEVER;
    GetNominalsOfContinuousStates "fmi2GetNominalsOfContinuousStates" NEVER;
}

impl Call {
    /// Whether the state allows the call; if not, a sentence that says what would.
    pub fn admitted_in(self, phase: Phase) -> Result<(), String> {
        let phases = self.phases();
        if phases & phase.bit() != 0 {
            return Ok(());
        }
        Err(match (phases, self) {
            (NEVER, Call::CancelStep) => "no step is ever in progress, steps are synchronous".into(),
            (NEVER, _) => "this belongs to Model Exchange; this FMU offers Co-Simulation only".into(),
            _ => {
                let allowed: Vec<&str> = Phase::ALL.into_iter().filter(|p| phases & p.bit() != 0).map(name).collect();
                format!("not allowed in state {}; it is in {}", name(phase), allowed.join(", "))
            }
        })
    }
}

/// What the standard calls a state.
fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::Instantiated => "instantiated",
        Phase::InitializationMode => "initializationMode",
        Phase::StepComplete => "stepComplete",
        Phase::StepFailed => "stepFailed",
        Phase::Terminated => "terminated",
        Phase::Error => "error",
        Phase::Fatal => "fatal",
    }
}
