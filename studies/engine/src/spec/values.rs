//! Types of values that several tables of study files have.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::run::limit::Limit;

/// A number > 0.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[schemars(inline, extend("exclusiveMinimum" = 0))]
pub struct Positive(pub f64);

/// A whole number from 0 to 2^63 - 1, which determines random choices.
#[derive(Clone, Copy, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct Seed(#[schemars(range(min = 0, max = 9_223_372_036_854_775_807_u64))] pub u64);

/// A number > 0, or a text.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(untagged)]
pub enum Word {
    /// A number.
    Number(Positive),
    /// A text.
    Text(String),
}

impl Word {
    /// Returns the limit on the response, a number for |theta|/alpha.
    ///
    /// # Errors
    /// A text that is no limit.
    pub fn limit(&self) -> Result<Limit, String> {
        match self {
            Word::Number(Positive(rotation)) => Ok(Limit::Rotation(*rotation)),
            Word::Text(text) => text.parse(),
        }
    }
}
