//! `rocking record`: accelerogram files → what they hold, in words or as a table.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Parser;
use serde::{Serialize, Serializer};

use crate::block::Common;
use crate::cli::accelerograms::{OfBoth, all_read};
use crate::cli::excitation::finite;
use crate::cli::formats::check_table;
use crate::cli::input;
use crate::cli::output::{Named, Pending, check_distinct};
use crate::cli::report::{ReportOptions, Written};
use crate::records::Record;
use crate::records::ground::Ground;
use crate::study::ground_files::{Name, Said};
use crate::study::intensity::{Measure, PERIODS};

/// Options of `rocking record`.
#[derive(Parser)]
pub struct Options {
    /// Accelerograms: PEER AT2, USGS SMC, CSV, COSMOS, CSMIP or ESM; `-` for standard input
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    #[command(flatten, next_help_heading = "Reading")]
    said: OfBoth,
    /// Gravity, for records in g and for the Arias intensity [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
    /// Periods at which Sa and Sv are computed, 5 % damping [s]
    #[arg(long, value_name = "S,S,...", value_delimiter = ',', help_heading = "Results")]
    periods: Vec<f64>,
    /// Table of the times and accelerations of one record; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    report: ReportOptions,
}

/// Does what the options say.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let Options { files, csv, g, periods, .. } = options;
    anyhow::ensure!(csv.is_none() || files.len() == 1, "--csv with {} records; expected one", files.len());
    let named = |option: &str, paths: &mut dyn Iterator<Item = &PathBuf>| -> Vec<Named> {
        paths.map(|path| Named::new(option, path)).collect()
    };
    csv.as_deref().map_or(Ok(()), check_table)?;
    for &period in periods {
        finite("periods", period, |period| PERIODS.contains(&period), "times from 0.001 to 1000 s")?;
    }
    check_distinct(&named("the record", &mut files.iter()), &named("--csv", &mut csv.iter()))?;
    let said = Said { of_both: options.said.options(*g)?, ..Said::default() };
    let read = |path: &PathBuf| {
        let record = said.read(false, Name::option, |options| input::record(path, options));
        Ok(Ground { horizontal: Some(record.map_err(anyhow::Error::msg)?), vertical: None })
    };
    let grounds = files.iter().map(read).collect::<anyhow::Result<Vec<_>>>()?;
    all_read(&said, &grounds)?;
    let records = || grounds.iter().filter_map(|ground| ground.horizontal.as_ref());
    if let Some(path) = csv {
        let table: String = records().map(table).collect();
        Pending::write(vec![(Pending::new(path)?, table.into_bytes())])?;
    }
    let measures = Measure::of_record(periods);
    let content = |(path, record): (&PathBuf, &Record)| Content::of(path.display().to_string(), record, &measures, *g);
    let contents: Vec<Content> = files.iter().zip(records()).map(content).collect();
    let words: Vec<String> = contents.iter().map(|content| content.words(*g)).collect();
    let written = Written::new([("csv", csv.as_deref())]);
    let text = words.join("\n") + &written.lines();
    options.report.print("record", &written, &[], &text, &Contents { records: contents })
}

#[derive(Serialize)]
struct Contents {
    records: Vec<Content>,
}

/// What a record holds; SI units.
#[derive(Serialize)]
struct Content {
    file: String,
    title: String,
    format: String,
    /// Of the file.
    unit: String,
    samples: usize,
    dt: f64,
    start: f64,
    duration: f64,
    #[serde(rename = "PGA.time")]
    pga_time: f64,
    /// By their names; null where the record has none.
    #[serde(flatten, serialize_with = "by_name")]
    measures: Vec<(Measure, Option<f64>)>,
}

fn by_name<S: Serializer>(measures: &[(Measure, Option<f64>)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(measures.iter().map(|(measure, value)| (measure.to_string(), value)))
}

impl Content {
    fn of(file: String, record: &Record, measures: &[Measure], gravity: f64) -> Content {
        Content {
            file,
            title: record.title.split_whitespace().collect::<Vec<_>>().join(" "),
            format: record.format.to_string(),
            unit: record.unit.to_string(),
            samples: record.acceleration.len(),
            dt: record.time_step,
            start: record.start_time,
            duration: record.duration(),
            pga_time: record.peak().time,
            measures: measures.iter().map(|&measure| (measure, measure.of(record, gravity))).collect(),
        }
    }

    /// For a person, with the PGA in this gravity (m/s²) too.
    fn words(&self, gravity: f64) -> String {
        let Content { file, title, format, unit, samples, dt, start, duration, pga_time, measures } = self;
        let [duration, pga_time] = [duration, pga_time].map(|value| short(*value));
        let mut words = format!(
            "file          {file}\n\
             title         {title}\n\
             format        {format}, in {unit}\n\
             samples       {samples}, every {dt} s from {start} s\n\
             duration      {duration} s\n"
        );
        for (measure, value) in measures {
            let in_g = match (measure, value) {
                (Measure::Pga, Some(pga)) => format!(" = {:.3} g at {pga_time} s", pga / gravity),
                _ => String::new(),
            };
            let unit = measure.unit().replace('2', "²");
            let value = value.map_or("none".into(), |value| format!("{} {unit}{in_g}", short(value)));
            // Writing to a String never fails.
            let _ = writeln!(words, "{:<13} {value}", measure.to_string());
        }
        words
    }
}

/// Six digits of a number at most.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// All samples of a record, in digits that bring the numbers back exactly.
fn table(record: &Record) -> String {
    let mut table = String::from("t [s],a [m/s2]\n");
    for (number, acceleration) in record.acceleration.iter().enumerate() {
        let time = record.start_time + number as f64 * record.time_step;
        // Writing to a String never fails.
        let _ = writeln!(table, "{time},{acceleration}");
    }
    table
}
