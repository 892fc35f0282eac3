//! `rocking record`: accelerograms → their contents and intensity measures, or a table.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Parser;
use serde::{Serialize, Serializer};

use crate::options::accelerograms::refuse_without_effect;
use crate::options::block::in_options;
use crate::options::checks::check;
use crate::options::input;
use crate::output::files::{NamedFile, Pending, check_distinct};
use crate::output::formats::check_table;
use crate::output::report::{ReportOptions, WrittenFiles};
use rocking_block::block::Common;
use rocking_block::excitation::records::Ground;
use rocking_records::Record;
use rocking_studies::input::ground_files::{RecordOption, RecordOptions};
use rocking_studies::intensity::{Measure, PERIODS, rot_d, rotated};
use rocking_studies::spec::ReadingSpec;

/// Displacement (m) that the ground hardly reaches away from a fault; integrals of a record that drifts exceed it.
const LARGEST_DISPLACEMENT: f64 = 1.0;

/// Options of `rocking record`, which scales no ground motion: `--scale` is that of the values.
#[derive(Parser)]
#[command(mut_arg("value_scale", |option| option.visible_alias("scale")))]
pub struct RecordCommand {
    /// Accelerograms in any format of docs/records.md, among them PEER, COSMOS, CSMIP, ESM, K-NET, GeoNet and tables; `-` for standard input
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Second horizontal component of a single record, at a right angle to it: adds RotD50 and RotD100 of each measure
    #[arg(long, value_name = "FILE")]
    transverse: Option<PathBuf>,
    /// Replace the record by the component in a direction, at this angle from the record towards --transverse [degrees]
    #[arg(long, value_name = "DEGREES", requires = "transverse")]
    rotate: Option<f64>,
    #[command(flatten, next_help_heading = "Reading")]
    reading: ReadingSpec,
    /// Gravitational acceleration, for records in g and for the Arias intensity [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
    /// Periods of Sa and Sv, with 5 % damping [s]
    #[arg(long, value_name = "S,S,...", value_delimiter = ',', help_heading = "Results")]
    periods: Vec<f64>,
    /// Table of times and accelerations of a single record; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &RecordCommand) -> anyhow::Result<()> {
    let RecordCommand { files, transverse, rotate, csv, g, periods, .. } = options;
    let one = transverse.is_none() || files.len() == 1;
    anyhow::ensure!(one, "--transverse with {} records; expected one", files.len());
    anyhow::ensure!(csv.is_none() || files.len() == 1, "--csv with {} records; expected one", files.len());
    csv.as_deref().map_or(Ok(()), check_table)?;
    for &period in periods {
        check("periods", period, |period| PERIODS.contains(&period), "times from 0.001 to 1000 s")?;
    }
    let outputs = [("csv", csv.as_deref())];
    let inputs: Vec<_> = files.iter().chain(transverse).map(|path| NamedFile::new("the record", path)).collect();
    check_distinct(&inputs, &NamedFile::of_options(outputs))?;
    let record_options =
        RecordOptions { both: options.reading.options(*g).map_err(in_options)?, ..RecordOptions::default() };
    let read = |path: &PathBuf| {
        let record = record_options.read(false, RecordOption::option, |options| input::record(path, options));
        Ok(Ground { horizontal: Some(record.map_err(anyhow::Error::msg)?), vertical: None })
    };
    let (mut grounds, mut shown, mut unreadable) = (Vec::new(), Vec::new(), Vec::new());
    for path in files.iter().chain(transverse) {
        match read(path) {
            Ok(ground) => {
                grounds.push(ground);
                shown.push(path);
            }
            Err(error) if files.len() == 1 => return Err(error),
            Err(error) => unreadable.push(error.to_string()),
        }
    }
    if unreadable.is_empty() {
        refuse_without_effect(&record_options, &grounds)?;
    }
    let measures = Measure::of_record(periods);
    let mut rotations = Vec::new();
    if let [Ground { horizontal: Some(record), .. }, Ground { horizontal: Some(transverse), .. }] = &grounds[..]
        && options.transverse.is_some()
    {
        for &measure in &measures {
            rotations.push(rot_d(measure, [record, transverse], [50.0, 100.0], *g).map_err(anyhow::Error::msg)?);
        }
        if let Some(angle) = rotate {
            let record = rotated(record, transverse, *angle).map_err(anyhow::Error::msg)?;
            grounds = vec![Ground { horizontal: Some(record), vertical: None }];
        }
    }
    grounds.truncate(files.len());
    let records = || grounds.iter().filter_map(|ground| ground.horizontal.as_ref());
    if let Some(path) = csv {
        let table: String = shown.iter().zip(records()).map(|(path, record)| table(path, record)).collect();
        Pending::write(vec![(Pending::new(path)?, table.into_bytes())])?;
    }
    let report = |(path, record): (&&PathBuf, &Record)| {
        Report::of(path.display().to_string(), record, &measures, &rotations, *g)
    };
    let reports: Vec<Report> = shown.iter().zip(records()).map(report).collect();
    let texts: Vec<String> = reports.iter().map(|report| report.text(*g)).collect();
    let written = WrittenFiles::new(outputs);
    let text = texts.join("\n") + &written.lines();
    let warnings: Vec<String> = reports.iter().filter_map(Report::drift).collect();
    for warning in &warnings {
        eprintln!("rocking: warning: {warning}");
    }
    for error in &unreadable {
        eprintln!("rocking: {error}");
    }
    let failed = unreadable.len();
    options.report.print("record", &written, &warnings, &text, &Reports { records: reports, unreadable })?;
    anyhow::ensure!(failed == 0, "{failed} of {} records cannot be read", files.len());
    Ok(())
}

/// Contents of all records.
#[derive(Serialize)]
struct Reports {
    records: Vec<Report>,
    /// The reason for each file that is no record.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unreadable: Vec<String>,
}

/// Contents of a record, in SI units.
#[derive(Serialize)]
struct Report {
    file: String,
    title: String,
    format: String,
    /// Unit of the file.
    unit: String,
    /// Changes since the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    processing: Option<String>,
    samples: usize,
    dt: f64,
    start: f64,
    duration: f64,
    #[serde(rename = "PGA.time")]
    pga_time: f64,
    /// By their names; null if the record has no value.
    #[serde(flatten, serialize_with = "by_name")]
    measures: Vec<(Measure, Option<f64>)>,
    /// The measures over all directions, with a transverse record.
    #[serde(flatten)]
    rotations: Option<Rotations>,
}

/// Median and greatest of each measure over all directions.
#[derive(Serialize)]
struct Rotations {
    #[serde(rename = "RotD50", serialize_with = "by_name")]
    median: Vec<(Measure, Option<f64>)>,
    #[serde(rename = "RotD100", serialize_with = "by_name")]
    greatest: Vec<(Measure, Option<f64>)>,
}

fn by_name<S: Serializer>(measures: &[(Measure, Option<f64>)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(measures.iter().map(|(measure, value)| (measure.to_string(), value)))
}

impl Report {
    fn of(file: String, record: &Record, measures: &[Measure], rotations: &[Option<[f64; 2]>], gravity: f64) -> Report {
        let over_directions = |part: usize| {
            let values = rotations.iter().map(|values| values.map(|values| values[part]));
            measures.iter().copied().zip(values).collect()
        };
        Report {
            file,
            title: record.title.split_whitespace().collect::<Vec<_>>().join(" "),
            format: record.format.to_string(),
            unit: record.unit.to_string(),
            processing: (!record.processing.is_none()).then(|| record.processing.to_string()),
            samples: record.acceleration.len(),
            dt: record.time_step,
            start: record.start_time,
            duration: record.duration(),
            pga_time: record.peak().time,
            measures: measures.iter().map(|&measure| (measure, measure.of(record, gravity))).collect(),
            rotations: (!rotations.is_empty())
                .then(|| Rotations { median: over_directions(0), greatest: over_directions(1) }),
        }
    }

    /// Returns the reason to doubt the displacements, if there is one.
    fn drift(&self) -> Option<String> {
        let (_, pgd) = self.measures.iter().find(|(measure, _)| *measure == Measure::Pgd)?;
        let pgd = pgd.filter(|pgd| *pgd > LARGEST_DISPLACEMENT)?;
        let file = &self.file;
        Some(format!(
            "{file}: the PGD is {} m; expected at most {LARGEST_DISPLACEMENT} m except beside a fault. \
             A wrong unit, counts or a drifting baseline (--baseline, --band-pass) give more",
            short(pgd)
        ))
    }

    /// Writes the report as text, with the PGA also in units of this gravity (m/s²).
    fn text(&self, gravity: f64) -> String {
        let Report {
            file,
            title,
            format,
            unit,
            processing,
            samples,
            dt,
            start,
            duration,
            pga_time,
            measures,
            rotations,
        } = self;
        let processing = processing.as_ref().map(|words| format!("processing    {words}\n")).unwrap_or_default();
        let [duration, pga_time] = [duration, pga_time].map(|value| short(*value));
        let mut text = format!(
            "file          {file}\n\
             title         {title}\n\
             format        {format}, in {unit}\n\
             {processing}\
             samples       {samples}, every {dt} s from {start} s\n\
             duration      {duration} s\n"
        );
        for (i, (measure, value)) in measures.iter().enumerate() {
            let in_g = match (measure, value) {
                (Measure::Pga, Some(pga)) => format!(" = {:.3} g at {pga_time} s", pga / gravity),
                _ => String::new(),
            };
            let unit = measure.unit().replace('2', "²");
            let mut value = value.map_or("none".into(), |value| format!("{} {unit}{in_g}", short(value)));
            if let Some(Rotations { median, greatest }) = rotations
                && let (Some((_, Some(median))), Some((_, Some(greatest)))) = (median.get(i), greatest.get(i))
            {
                // Writing to a String never fails.
                let _ = write!(value, "; RotD50 {}, RotD100 {}", short(*median), short(*greatest));
            }
            // Writing to a String never fails.
            let _ = writeln!(text, "{:<13} {value}", measure.to_string());
        }
        text
    }
}

/// Rounds a number to six digits.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Writes all samples of a record in full precision, below comments on its origin.
fn table(file: &Path, record: &Record) -> String {
    let Record { title, format, unit, processing, .. } = record;
    let changes = if processing.is_none() { String::new() } else { format!("; {processing}") };
    let file = file.file_name().unwrap_or(file.as_os_str()).display();
    let [title, file] =
        [title.clone(), file.to_string()].map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "));
    let mut table = format!("# {title}\n# from {file}: {format}, in {unit}{changes}\nt [s],a [m/s2]\n");
    for (number, acceleration) in record.acceleration.iter().enumerate() {
        let time = record.start_time + number as f64 * record.time_step;
        // Writing to a String never fails.
        let _ = writeln!(table, "{time},{acceleration}");
    }
    table
}
