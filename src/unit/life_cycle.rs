//! The states through which an instance goes, of all versions of FMI; which function is legal in which is said there.

use serde::{Deserialize, Serialize};

/// State of an instance. Steps are synchronous: none is in progress when a function is
/// called, but where FMI 3.0 lets the importer look in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// After instantiation or reset.
    Instantiated,
    /// While sizes of arrays are set.
    ConfigurationMode,
    /// While the values become a block.
    InitializationMode,
    /// Ready for a step.
    StepComplete,
    /// Inside a step, while the importer sets inputs of a time to come.
    SettingAhead,
    /// Inside a step, while the importer looks at what has been reached.
    LookingIn,
    /// The last step was discarded: the run came to its end within it.
    StepFailed,
    /// At the start or at an event, while what it makes of the block is found out.
    EventMode,
    /// Model Exchange: the importer's solver steps the block.
    ContinuousTimeMode,
    /// The run was ended from outside.
    Terminated,
    /// The integration failed.
    Error,
    /// A panic was caught.
    Fatal,
}

impl Phase {
    /// All of them.
    pub const ALL: [Phase; 12] = [
        Phase::Instantiated,
        Phase::ConfigurationMode,
        Phase::InitializationMode,
        Phase::StepComplete,
        Phase::SettingAhead,
        Phase::LookingIn,
        Phase::StepFailed,
        Phase::EventMode,
        Phase::ContinuousTimeMode,
        Phase::Terminated,
        Phase::Error,
        Phase::Fatal,
    ];

    /// A bit for sets of phases.
    pub const fn bit(self) -> u16 {
        1 << self as u16
    }

    /// Whether the values have become a block.
    pub fn is_initialized(self) -> bool {
        match self {
            Phase::Instantiated | Phase::ConfigurationMode | Phase::InitializationMode => false,
            Phase::EventMode
            | Phase::StepComplete
            | Phase::SettingAhead
            | Phase::LookingIn
            | Phase::StepFailed
            | Phase::ContinuousTimeMode
            | Phase::Terminated
            | Phase::Error
            | Phase::Fatal => true,
        }
    }
}
