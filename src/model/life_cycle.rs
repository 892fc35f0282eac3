//! The states through which an instance goes, of all versions of FMI; which function is legal in which is said there.

use serde::{Deserialize, Serialize};

/// State of an instance. Steps are synchronous: none is ever in progress when a function is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// After instantiation or reset.
    Instantiated,
    /// While the values become a block.
    InitializationMode,
    /// Ready for a step.
    StepComplete,
    /// The last step was discarded: the run came to its end within it.
    StepFailed,
    /// Model Exchange: what an event makes of the block is found out.
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
    pub const ALL: [Phase; 9] = [
        Phase::Instantiated,
        Phase::InitializationMode,
        Phase::StepComplete,
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
            Phase::Instantiated | Phase::InitializationMode => false,
            Phase::StepComplete
            | Phase::StepFailed
            | Phase::EventMode
            | Phase::ContinuousTimeMode
            | Phase::Terminated
            | Phase::Error
            | Phase::Fatal => true,
        }
    }
}
