//! Types of values that several tables of study files have.

use schemars::JsonSchema;
use serde::Deserialize;

/// A number > 0.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline, extend("exclusiveMinimum" = 0))]
pub struct Positive(pub f64);

/// A whole number from 0 to 2^63 - 1, which determines random choices.
#[derive(Deserialize, JsonSchema)]
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
