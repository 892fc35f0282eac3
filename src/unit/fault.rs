//! The reason of a refused or failed call, as a sentence.

/// The reason why a call was refused or failed, with found and expected value.
///
/// A refused call changes nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Fault(pub String);

impl Fault {
    /// Makes a fault from a sentence.
    pub fn new(message: impl Into<String>) -> Fault {
        Fault(message.into())
    }
}
