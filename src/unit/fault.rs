//! A refused or failed call, as a sentence.

/// Why a call was refused, changing nothing, or how it failed: what was found and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Fault(pub String);

impl Fault {
    /// With this sentence.
    pub fn new(message: impl Into<String>) -> Fault {
        Fault(message.into())
    }
}
