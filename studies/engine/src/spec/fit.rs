//! The tables of files of tests.

#![allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of editors")]

use rocking_records::Choice;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::spec::records::Column;
use crate::spec::schema;
use crate::spec::study::RecordsTable;
use crate::spec::values::{Positive, Seed};

/// A file of tests, for `rocking fit`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FitFile {
    /// The parameters that are fitted, and the settings of the fit.
    pub fit: FitTable,
    /// Parameters of the block: known values, and first values of those that are fitted.
    #[serde(default)]
    #[schemars(schema_with = "schema::values")]
    pub parameters: Option<toml::Table>,
    /// Tests of the same block.
    #[schemars(length(min = 1))]
    pub tests: Vec<TestTable>,
}

/// `[fit]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct FitTable {
    /// Names of the parameters that are fitted.
    pub free: Option<Vec<String>>,
    /// Both ends of free parameters, by their names.
    #[serde(default)]
    #[schemars(schema_with = "schema::pairs")]
    pub bounds: Option<toml::Table>,
    /// Mean and standard deviation of free parameters, by their names.
    #[serde(default)]
    #[schemars(schema_with = "schema::pairs")]
    pub prior: Option<toml::Table>,
    /// Number of starts.
    #[schemars(range(min = 1, max = 100_000))]
    pub starts: Option<u32>,
    /// Seed of the starts.
    pub seed: Option<Seed>,
    /// Level of confidence of the intervals.
    #[schemars(extend("exclusiveMaximum" = 1))]
    pub level: Option<Positive>,
    /// Relative tolerance of the integration.
    #[schemars(range(min = 1e-14, max = 0.1))]
    pub tolerance: Option<f64>,
}

/// `[[tests]]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct TestTable {
    /// CSV file of times and measured values.
    pub data: String,
    /// Column of times [s], by heading or by number from 1; by default t.
    #[schemars(with = "Option<Column>")]
    pub time: Option<Choice>,
    /// Column of values; by default the name of the output.
    #[schemars(with = "Option<Column>")]
    pub column: Option<Choice>,
    /// Factor that converts the values to the unit of the output, not 0.
    pub factor: Option<f64>,
    /// Measured quantity, a column of `rocking simulate`; by default theta.
    pub output: Option<String>,
    /// Standard deviation of the noise, in the unit of the output.
    pub noise: Option<Positive>,
    /// Ground motion of the test.
    pub record: Option<RecordsTable>,
    /// Factor on the record.
    pub scale: Option<f64>,
    /// Reading of the instrument at rest, in the unit of the output.
    pub zero: Option<f64>,
    /// Time of the data at which the test begins [s].
    pub delay: Option<f64>,
    /// Names of the parameters that are fitted for this test alone.
    pub free: Option<Vec<String>>,
    /// Both ends of these parameters.
    #[serde(default)]
    #[schemars(schema_with = "schema::pairs")]
    pub bounds: Option<toml::Table>,
    /// Mean and standard deviation of these parameters.
    #[serde(default)]
    #[schemars(schema_with = "schema::pairs")]
    pub prior: Option<toml::Table>,
    /// Initial state of the test.
    #[serde(default)]
    #[schemars(schema_with = "schema::initial")]
    pub initial: Option<toml::Table>,
    /// Pulse of the test.
    #[serde(default)]
    #[schemars(schema_with = "schema::pulse")]
    pub pulse: Option<toml::Table>,
}
