//! The table `[assess]` of a study file.

#![allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of editors")]

use schemars::JsonSchema;
use serde::Deserialize;

use crate::spec::schema;
use crate::spec::values::{Positive, Word};

/// `[assess]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct AssessTable {
    /// Name of the object.
    pub title: String,
    /// Who answers for the study, on the first page.
    pub author: Option<String>,
    /// Date of the study, on the first page, as 2026-11-29 in quotes.
    pub date: Option<String>,
    /// Measure of the curves; by default that of the levels, else PGV, in space PGV.RotD50.
    pub im: Option<String>,
    /// Years of the probabilities; by default 50.
    pub years: Option<Positive>,
    /// Shape of the pulses whose least amplitude is searched; by default one-sine.
    pub pulse: Option<String>,
    /// Their periods [s]; by default 0.25, 0.5, 1 and 2.
    #[schemars(length(min = 1))]
    pub pulse_periods: Option<Vec<Positive>>,
    /// Hazard curve of the site.
    pub hazard: Option<HazardTable>,
    /// Limits on the response, the least severe first.
    #[schemars(length(min = 1))]
    pub states: Option<Vec<StateTable>>,
    /// Changes of the object whose effect is reported.
    #[schemars(length(min = 1))]
    pub variants: Option<Vec<VariantTable>>,
    /// Both ends of the ranges of doubtful parameters, by their names.
    #[serde(default)]
    #[schemars(schema_with = "schema::pairs")]
    pub sensitivity: Option<toml::Table>,
}

/// `hazard`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct HazardTable {
    /// File of the hazard curve.
    pub file: String,
    /// Unit of the levels, if the file does not state it.
    pub unit: Option<String>,
    /// Site of a file with several: its name, or longitude and latitude.
    pub site: Option<Site>,
    /// Investigation time of probabilities, if the file does not state it [years].
    pub investigation_time: Option<Positive>,
    /// Kind of the curves of OpenQuake, such as "quantile-0.84", instead of the mean.
    pub kind: Option<String>,
}

/// A name, or longitude and latitude.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(untagged)]
pub enum Site {
    /// A name.
    Name(String),
    /// Longitude and latitude (°).
    Place([f64; 2]),
}

/// `[[assess.states]]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct StateTable {
    /// Name of the state.
    pub name: String,
    /// "overturned", "balance", "breaks", a number for |theta|/alpha, in metres "slip:0.1" or "plastic:0.02", or "half_cycles:20";
    /// in space a number for the tilt over that of the balance, "twist:0.1" [rad], "slip:0.1" or "drift:0.1" [m].
    pub limit: Word,
    /// The publication or decision behind it.
    pub source: Option<String>,
}

/// `[[assess.variants]]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct VariantTable {
    /// Name of the variant.
    pub name: String,
    /// Factor on the width of the base, in space also on its depth.
    pub width: Option<Positive>,
    /// Coefficient of friction over the static threshold b/h; below 1 the block slides before it rocks.
    pub friction_over_threshold: Option<Positive>,
    /// Stiffness of two ties at the top, over M g/R0.
    pub ties: Option<Positive>,
    /// Yield force of a damper under each corner, over the weight M g.
    pub dampers: Option<Positive>,
    /// Parameters that change.
    #[serde(default)]
    #[schemars(schema_with = "schema::values")]
    pub parameters: Option<toml::Table>,
}
