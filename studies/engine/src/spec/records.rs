//! What a user says of accelerogram files → the options of their reader.

#![allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]

use std::str::FromStr;

use rocking_records::{Choice, Processing, ReadOptions};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error;
use serde::{Deserialize, Deserializer};

use crate::input::ground_files::RecordOptions;
use crate::spec::values::Positive;
use crate::spec::{SpecError, limits};

/// What a user says of horizontal and vertical files.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[schemars(inline)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct RecordSpec {
    /// Of both.
    #[serde(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    reading: ReadingSpec,
    /// Of vertical files, where they differ.
    #[serde(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    vertical: VerticalSpec,
}

/// What a user says of files of one direction, and the changes to their records.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[schemars(inline)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct ReadingSpec {
    /// Information missing from the files.
    #[serde(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    file: FileSpec,
    /// Subtract from each record the line that fits its accelerations best
    #[cfg_attr(feature = "clap", arg(long, action = clap::ArgAction::SetTrue))]
    baseline: Option<bool>,
    /// Filter each record by a Butterworth band-pass of order 4 without phase, with these corner frequencies [Hz]
    #[cfg_attr(feature = "clap", arg(long, value_name = "LOW,HIGH", value_delimiter = ','))]
    #[schemars(with = "Option<[Positive; 2]>")]
    band_pass: Option<Vec<f64>>,
    /// Change the time step of each record, with accelerations linear between the samples [s]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    #[schemars(extend("exclusiveMinimum" = 0))]
    resample: Option<f64>,
}

/// Information missing from the files.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[schemars(inline)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct FileSpec {
    /// Unit of accelerograms that do not state it: g, m/s2, cm/s2, mm/s2 or g/10
    #[cfg_attr(feature = "clap", arg(long))]
    pub unit: Option<String>,
    /// Time step of accelerograms that do not state it [s]
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub dt: Option<f64>,
    /// Format, if the content leaves it open: peer, smc, columns, cosmos, csmip, esm, knet, geonet, nsmn, unam, renadic, bhrc, usc, jma, cwb, csmnc, esd or npts
    #[cfg_attr(feature = "clap", arg(long))]
    pub format: Option<String>,
    /// Channel of a file with several, by name or by number from 1
    #[cfg_attr(feature = "clap", arg(long))]
    #[schemars(with = "Option<Column<1000>>")]
    pub channel: Option<Choice>,
    /// Columns of fixed width in a line, as an edit descriptor of Fortran: 10F8.2, 5E15.7, 8(1PE10.4E1)
    #[cfg_attr(feature = "clap", arg(long))]
    pub layout: Option<String>,
    /// Lines before the first line of the layout
    #[cfg_attr(feature = "clap", arg(long, value_name = "LINES"))]
    #[schemars(range(min = 0, max = 100_000))]
    pub skip: Option<u64>,
    /// Number of values in the layout, if other lines follow them
    #[cfg_attr(feature = "clap", arg(long, value_name = "COUNT"))]
    #[schemars(range(min = 2, max = 100_000_000))]
    pub npts: Option<u64>,
    /// Value of a printed 1 in the unit of the file, for layouts and tables
    #[cfg_attr(feature = "clap", arg(long, value_name = "FACTOR"))]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub value_scale: Option<f64>,
    /// Column of the accelerations in a table, by name or by number from 1
    #[cfg_attr(feature = "clap", arg(long, value_name = "COLUMN"))]
    #[schemars(with = "Option<Column>")]
    pub acceleration_column: Option<Choice>,
    /// Column of the times in a table, by name or by number from 1
    #[cfg_attr(feature = "clap", arg(long, value_name = "COLUMN"))]
    #[schemars(with = "Option<Column>")]
    pub time_column: Option<Choice>,
}

/// A name, or a number from 1 to the last.
#[derive(JsonSchema)]
#[schemars(inline, untagged)]
#[allow(dead_code, reason = "the JSON Schema of a choice")]
pub enum Column<const LAST: u64 = 100_000> {
    /// Number, from 1.
    Number(#[schemars(range(min = 1, max = LAST))] u64),
    /// Name.
    Name(String),
}

/// Information missing from vertical files: that of [`FileSpec`], by names that begin with `vertical_`.
#[derive(Clone, Debug, Default)]
struct VerticalSpec(FileSpec);

impl<'de> Deserialize<'de> for VerticalSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<VerticalSpec, D::Error> {
        let table = toml::Table::deserialize(deserializer)?.into_iter();
        let vertical = table.filter_map(|(key, value)| Some((key.strip_prefix("vertical_")?.to_string(), value)));
        FileSpec::deserialize(vertical.collect::<toml::Table>()).map(VerticalSpec).map_err(Error::custom)
    }
}

impl JsonSchema for VerticalSpec {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "VerticalSpec".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = FileSpec::json_schema(generator);
        if let Some(properties) = schema.get_mut("properties").and_then(|properties| properties.as_object_mut()) {
            *properties = std::mem::take(properties)
                .into_iter()
                .map(|(name, mut property)| {
                    let of_both = property["description"].as_str().unwrap_or_default();
                    property["description"] = format!("{of_both}; of vertical files, instead of {name}").into();
                    (format!("vertical_{name}"), property)
                })
                .collect();
        }
        schema
    }
}

#[cfg(feature = "clap")]
impl clap::Args for VerticalSpec {
    fn augment_args(command: clap::Command) -> clap::Command {
        let of_both = FileSpec::augment_args(clap::Command::new(""));
        let heading = command.get_next_help_heading().map(str::to_owned);
        command.args(of_both.get_arguments().map(|arg| {
            let (name, option) = (arg.get_id(), arg.get_long().unwrap_or_default());
            let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
            let help = format!("{help}; of vertical files, instead of --{option}");
            let arg = arg.clone().id(format!("vertical_{name}")).long(format!("vertical-{option}")).help(help);
            heading.iter().fold(arg.display_order(None), |arg, heading| arg.help_heading(heading))
        }))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        VerticalSpec::augment_args(command)
    }
}

#[cfg(feature = "clap")]
impl clap::FromArgMatches for VerticalSpec {
    /// Parses the options again, without their prefix.
    fn from_arg_matches(matches: &clap::ArgMatches) -> Result<VerticalSpec, clap::Error> {
        let of_both = <FileSpec as clap::Args>::augment_args(clap::Command::new("").no_binary_name(true));
        let given = of_both.get_arguments().filter_map(|arg| {
            let mut values = matches.get_raw(&format!("vertical_{}", arg.get_id())).into_iter().flatten();
            let mut option = std::ffi::OsString::from(format!("--{}=", arg.get_long()?));
            option.push(values.next()?);
            Some(option)
        });
        let given: Vec<_> = given.collect();
        FileSpec::from_arg_matches(&of_both.try_get_matches_from(given)?).map(VerticalSpec)
    }

    fn update_from_arg_matches(&mut self, matches: &clap::ArgMatches) -> Result<(), clap::Error> {
        *self = VerticalSpec::from_arg_matches(matches)?;
        Ok(())
    }
}

impl RecordSpec {
    /// Returns the options of the reader, with this gravity for records in g (m/s²).
    ///
    /// # Errors
    /// A text that is not one of its kind, or a number out of range.
    pub fn options(&self, gravity: f64) -> Result<RecordOptions, SpecError> {
        let vertical = self.vertical.0.options().map_err(|error| error.with_prefix("vertical_"))?;
        Ok(RecordOptions { both: self.reading.options(gravity)?, vertical })
    }
}

impl ReadingSpec {
    /// Returns the options of the reader, with this gravity for records in g (m/s²).
    ///
    /// # Errors
    /// Those of [`RecordSpec::options`].
    pub fn options(&self, gravity: f64) -> Result<ReadOptions, SpecError> {
        let ReadingSpec { ref file, baseline, ref band_pass, resample } = *self;
        limits::check::<ReadingSpec>(&[("resample", resample)])?;
        let missing = "two frequencies; expected two, as in 0.1,25";
        let lacks = |_| SpecError::Lacks { parameter: "band_pass", missing };
        let band_pass = band_pass.as_deref().map(<[f64; 2]>::try_from).transpose().map_err(lacks)?;
        let processing = Processing { baseline: baseline == Some(true), band_pass, resample };
        Ok(ReadOptions { gravity, processing, ..file.options()? })
    }
}

impl FileSpec {
    /// Returns the options of the reader.
    ///
    /// # Errors
    /// Those of [`RecordSpec::options`].
    pub fn options(&self) -> Result<ReadOptions, SpecError> {
        let whole = |value: Option<u64>| value.map(|value| value as f64);
        limits::check::<FileSpec>(&[
            ("dt", self.dt),
            ("skip", whole(self.skip)),
            ("npts", whole(self.npts)),
            ("value_scale", self.value_scale),
        ])?;
        Ok(ReadOptions {
            format: parsed("format", &self.format)?,
            unit: parsed("unit", &self.unit)?,
            time_step: self.dt,
            layout: parsed("layout", &self.layout)?,
            skip: self.skip.map(|lines| lines as usize),
            npts: self.npts.map(|values| values as usize),
            value_scale: self.value_scale,
            time_column: self.time_column.clone(),
            acceleration_column: self.acceleration_column.clone(),
            channel: self.channel.clone(),
            ..ReadOptions::default()
        })
    }
}

/// Parses the text of a setting.
fn parsed<T: FromStr<Err: ToString>>(name: &'static str, text: &Option<String>) -> Result<Option<T>, SpecError> {
    let fault = |error: T::Err| SpecError::Unreadable { parameter: name.into(), message: error.to_string() };
    text.as_ref().map(|text| text.parse().map_err(fault)).transpose()
}
