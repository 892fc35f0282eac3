//! The tables of study files: each key once, with its type, its limits and its help.
//!
//! Their JSON Schema is both what `rocking schema` describes to editors and what [readers](crate::input::study_file::Section) accept. The rules
//! between keys stand in the readers.

#![allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of editors")]

use rocking_records::Choice;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::spec::assess::AssessTable;
use crate::spec::records::{Column, RecordSpec};
use crate::spec::run::RunSpec;
use crate::spec::schema;
use crate::spec::values::{Positive, Seed, Word};

/// A study of many runs, for `rocking sweep`, `rocking ida` and `rocking assess`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// The design of the study and the settings of its runs.
    pub study: StudyTable,
    /// Parameters of block, pulse and initial state by their names: one value, a list, or a range.
    #[serde(default)]
    #[schemars(schema_with = "schema::parameters::<RangeTable>")]
    pub parameters: Option<toml::Table>,
    /// Ground motions; several files by a pattern.
    #[schemars(length(min = 1))]
    pub records: Option<Vec<RecordsTable>>,
    /// A building whose floors carry the block.
    pub building: Option<BuildingTable>,
    /// The assessment of an object: limits, hazard, variants. Only `rocking assess` reads it.
    pub assess: Option<AssessTable>,
}

/// How the values of the parameters are combined.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(rename_all = "kebab-case")]
pub enum DesignWord {
    /// All combinations of the lists.
    Grid,
    /// Samples of the ranges.
    LatinHypercube,
}

/// `[study]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline, deny_unknown_fields)]
pub struct StudyTable {
    /// All combinations of the lists, or samples of the ranges.
    pub design: DesignWord,
    /// Number of samples of a Latin hypercube.
    #[schemars(range(min = 1, max = 10_000_000))]
    pub samples: Option<u32>,
    /// Seed of a Latin hypercube.
    pub seed: Option<Seed>,
    /// Natural periods of further columns, the spectral accelerations Sa and velocities Sv [s].
    #[schemars(length(min = 1), inner(range(min = 0.001, max = 1000)))]
    pub periods: Option<Vec<f64>>,
    /// Settings of each run.
    #[serde(flatten)]
    pub run: RunSpec,
    /// Amplitude [m]: a column has the half cycles of plastic elongations above it, of the tie or damper with the most.
    pub half_cycles: Option<Positive>,
    /// Each row stands for samples around its values: a coefficient of variation for each parameter.
    pub ensemble: Option<EnsembleTable>,
    /// Directions of the pairs of records of a block in space, and of the pulse, from +x towards +y [degrees]: a row each.
    pub azimuths: Option<Azimuths>,
    /// Factors on the records, a row each.
    #[schemars(length(min = 1))]
    pub scales: Option<Vec<f64>>,
    /// Values of an intensity measure, a row each.
    pub levels: Option<LevelsTable>,
    /// Incremental dynamic analysis by hunt and fill: each level follows from the runs before.
    pub hunt: Option<HuntTable>,
    /// The least values of a measure that overturn the block, a row for each ground motion.
    pub least: Option<LeastTable>,
}

/// Directions, or how many of them are drawn.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(untagged)]
pub enum Azimuths {
    /// The directions [degrees].
    List(#[schemars(length(min = 1))] Vec<f64>),
    /// Random ones, other ones for each ground motion.
    Random(RandomAzimuths),
}

/// Random directions: one in each of `count` equal parts of a turn.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct RandomAzimuths {
    /// Number of directions of each ground motion.
    #[schemars(range(min = 1, max = 3600))]
    pub count: u32,
    /// Seed of the directions.
    pub seed: Seed,
}

/// A range of a parameter.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RangeTable {
    /// Its beginning.
    pub from: f64,
    /// Its end.
    pub to: f64,
    /// Number of values of a grid, both ends included.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub count: Option<u64>,
    /// Spacing of the values; by default linear.
    pub spacing: Option<SpacingWord>,
}

/// A spacing.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(rename_all = "kebab-case")]
pub enum SpacingWord {
    /// Equal differences.
    Linear,
    /// Equal ratios.
    Log,
}

/// `levels`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct LevelsTable {
    /// Intensity measure, such as "PGV" or "Sa(0.5 s)".
    pub im: String,
    /// Its values, in its unit.
    #[schemars(length(min = 1))]
    pub values: Vec<Positive>,
}

/// `hunt`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct HuntTable {
    /// Intensity measure, such as "PGV" or "Sa(0.5 s)".
    pub im: String,
    /// Level of the first run.
    pub first: Positive,
    /// First step between levels; by default `first`.
    pub step: Option<Positive>,
    /// Growth of each further step; by default half of `first`.
    #[schemars(range(min = 0))]
    pub growth: Option<f64>,
    /// Distance of the two levels that enclose overturning, as a part of the greater; by default 0.1.
    #[schemars(extend("exclusiveMaximum" = 1))]
    pub resolution: Option<Positive>,
    /// Number of runs; by default 12.
    #[schemars(range(min = 1, max = 1000))]
    pub runs: Option<u64>,
}

/// `least`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct LeastTable {
    /// Intensity measure, such as "PGV" or "Sa(0.5 s)".
    pub im: String,
    /// Least level.
    pub from: Positive,
    /// Greatest level.
    pub to: Positive,
    /// Number of levels that are scanned before the changes between them are bisected.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub points: u64,
    /// Width of the bisected intervals.
    pub resolution: Positive,
}

/// `ensemble`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct EnsembleTable {
    /// Number of runs per row.
    #[schemars(range(min = 1, max = 100_000))]
    pub samples: u32,
    /// Pairs the values of several spreads.
    pub seed: Option<Seed>,
    /// Further limits: "balance", "breaks", numbers for |theta|/alpha, or in metres as "slip:0.1" or "plastic:0.02".
    #[schemars(length(min = 1))]
    pub limits: Option<Vec<Word>>,
    /// Spread of the factor on the records.
    pub scale: Option<Spread>,
    /// Spreads of parameters by their names.
    #[serde(flatten)]
    #[schemars(schema_with = "schema::spreads::<Spread>")]
    pub parameters: toml::Table,
}

/// A coefficient of variation, or a distribution and its width.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Spread {
    /// Coefficient of variation of a lognormal distribution.
    Relative(Positive),
    /// Distribution with its width.
    Table(SpreadTable),
}

/// A distribution about the value of the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// Lognormal; the row's value is the median and keeps its sign.
    Lognormal,
    /// Normal; the row's value is the mean.
    Normal,
    /// Uniform and symmetric about the row's value.
    Uniform,
}

/// A distribution and its width: cov or deviation.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct SpreadTable {
    /// Distribution; by default lognormal.
    pub distribution: Option<Distribution>,
    /// Coefficient of variation.
    pub cov: Option<Positive>,
    /// Standard deviation, in the unit of the parameter.
    pub deviation: Option<Positive>,
}

/// `[[records]]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline, deny_unknown_fields)]
pub struct RecordsTable {
    /// File of the horizontal motion, or a pattern for several files.
    pub horizontal: Option<String>,
    /// File of the vertical motion, or a pattern for several files.
    pub vertical: Option<String>,
    /// File of the first horizontal component for a block in space, or a pattern for several files.
    pub x: Option<String>,
    /// File of the second horizontal component, a quarter turn ahead of the first, or a pattern for several files.
    pub y: Option<String>,
    /// File of the vertical component for a block in space, or a pattern for several files.
    pub z: Option<String>,
    /// Cut the components of each motion for a block in space to the samples that all of them have.
    pub cut: Option<bool>,
    /// Channel of the files of y, by name or by number from 1, instead of channel.
    #[schemars(with = "Option<Column<1000>>")]
    pub y_channel: Option<Choice>,
    /// Column of the accelerations in the tables of y, by name or by number from 1, instead of acceleration_column.
    #[schemars(with = "Option<Column>")]
    pub y_acceleration_column: Option<Choice>,
    /// Polarities of the horizontal records; by default as-recorded. With both, each motion also acts with its horizontal record reversed.
    pub polarity: Option<PolarityWord>,
    /// Patterns of files to leave out.
    pub exclude: Option<Vec<String>>,
    /// Settings of their reading.
    #[serde(flatten)]
    pub reading: RecordSpec,
}

/// Polarities of a horizontal record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(rename_all = "kebab-case")]
pub enum PolarityWord {
    /// As it was recorded.
    AsRecorded,
    /// As it was recorded, and reversed: one motion in two rows.
    Both,
}

/// `[building]`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct BuildingTable {
    /// Masses of the floors of a shear building, from the lowest [kg].
    #[schemars(length(min = 1))]
    pub floor_masses: Option<Vec<f64>>,
    /// Stiffnesses of its storeys [N/m].
    #[schemars(length(min = 1))]
    pub storey_stiffnesses: Option<Vec<f64>>,
    /// Natural frequencies of the modes [Hz].
    #[schemars(length(min = 1))]
    pub frequencies: Option<Vec<f64>>,
    /// Participation factors of the modes.
    #[schemars(length(min = 1))]
    pub participation: Option<Vec<f64>>,
    /// Shape of each mode, a value per floor.
    pub shapes: Option<Vec<Vec<f64>>>,
    /// Damping ratio of all modes, or a list of one per mode.
    pub damping: Option<DampingValue>,
    /// Rayleigh damping, instead of `damping`.
    pub rayleigh: Option<RayleighTable>,
    /// Floors that carry the block, 0 for the ground; by default all above it.
    #[schemars(length(min = 1), inner(range(min = 0)))]
    pub floors: Option<Vec<u64>>,
}

/// A ratio, or a list of one per mode.
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(untagged)]
pub enum DampingValue {
    /// Of all modes.
    All(f64),
    /// Of each mode.
    Each(#[schemars(length(min = 1))] Vec<f64>),
}

/// `rayleigh`
#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
#[serde(deny_unknown_fields)]
pub struct RayleighTable {
    /// Damping ratio of both modes.
    pub damping: Positive,
    /// Two modes, as in [1, 3].
    #[schemars(inner(range(min = 1)))]
    pub modes: [u64; 2],
}
