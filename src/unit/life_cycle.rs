//! The states of an instance, for all versions of FMI.
//!
//! The tables of the calls that are legal in each state are in `calls.rs` of each version.

use serde::{Deserialize, Serialize};

/// State of an instance.
///
/// Steps are synchronous: no step is in progress when a function is called, except in the intermediate updates of FMI 3.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// After instantiation or reset.
    Instantiated,
    /// Sizes of arrays can be set.
    ConfigurationMode,
    /// Start values can be set; at its end they define the block.
    InitializationMode,
    /// Ready for a step.
    StepComplete,
    /// Inside a step: the importer sets inputs for a later time.
    SettingAhead,
    /// Inside a step: the importer reads the outputs at the time reached so far.
    ReadingOutputs,
    /// The last step was discarded because the run ended within it.
    StepFailed,
    /// At the start or at an event, before its effects are applied.
    EventMode,
    /// Model Exchange: the importer's solver steps the block.
    ContinuousTimeMode,
    /// The importer ended the run.
    Terminated,
    /// The integration failed.
    Error,
    /// A panic was caught.
    Fatal,
}

impl Phase {
    /// All states.
    pub const ALL: [Phase; 12] = [
        Phase::Instantiated,
        Phase::ConfigurationMode,
        Phase::InitializationMode,
        Phase::StepComplete,
        Phase::SettingAhead,
        Phase::ReadingOutputs,
        Phase::StepFailed,
        Phase::EventMode,
        Phase::ContinuousTimeMode,
        Phase::Terminated,
        Phase::Error,
        Phase::Fatal,
    ];

    /// Returns the bit of this state in a set of states.
    pub const fn bit(self) -> u16 {
        1 << self as u16
    }

    /// Whether initialization has ended.
    pub fn is_initialized(self) -> bool {
        match self {
            Phase::Instantiated | Phase::ConfigurationMode | Phase::InitializationMode => false,
            Phase::EventMode
            | Phase::StepComplete
            | Phase::SettingAhead
            | Phase::ReadingOutputs
            | Phase::StepFailed
            | Phase::ContinuousTimeMode
            | Phase::Terminated
            | Phase::Error
            | Phase::Fatal => true,
        }
    }
}
