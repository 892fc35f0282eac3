//! `rocking record`: accelerograms → their contents and intensity measures, or a table.

use std::path::{Path, PathBuf};

use clap::Parser;

use crate::options::accelerograms::refuse_without_effect;
use crate::options::block::in_options;
use crate::options::checks::check;
use crate::options::input;
use crate::options::run::warn;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::ReportOptions;
use crate::output::summary::{Object, Summary};
use rocking_block::block::Common;
use rocking_block::excitation::records::Ground;
use rocking_records::Record;
use rocking_studies::input::ground_files::{RecordOption, RecordOptions};
use rocking_studies::intensity::{Measure, PERIODS, rot_d, rotated};
use rocking_studies::output::format::DescribedTable;
use rocking_studies::output::table::{Table, TableColumn};
use rocking_studies::spec::ReadingSpec;

/// Displacement (m) that the ground hardly reaches away from a fault. Integrals of a record that drifts exceed it.
const LARGEST_DISPLACEMENT: f64 = 1.0;

/// Options of `rocking record`, which scales no ground motion: `--scale` is that of the values.
#[derive(Parser)]
#[command(mut_arg("value_scale", |option| option.visible_alias("scale")))]
pub struct RecordCommand {
    /// Accelerograms in any format of docs/studies/records.md, among them PEER, COSMOS, CSMIP, ESM, K-NET, GeoNet and tables; `-` for standard input
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
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &RecordCommand) -> anyhow::Result<()> {
    let RecordCommand { files, transverse, rotate, csv, g, periods, .. } = options;
    let one = transverse.is_none() || files.len() == 1;
    anyhow::ensure!(one, "--transverse with {} records; expected one", files.len());
    anyhow::ensure!(csv.is_none() || files.len() == 1, "--csv with {} records; expected one", files.len());
    let plot = options.picture.plot.as_deref();
    anyhow::ensure!(plot.is_none() || files.len() == 1, "--plot with {} records; expected one", files.len());
    let format = options.picture.format()?;
    csv.as_deref().map_or(Ok(()), check_table)?;
    for &period in periods {
        check("periods", period, |period| PERIODS.contains(&period), "times from 0.001 to 1000 s")?;
    }
    let inputs: Vec<_> = files.iter().chain(transverse).map(|path| NamedFile::new("the record", path)).collect();
    let mut outputs = Outputs::checked(&inputs, [("csv", csv.as_deref()), ("plot", plot)])?;
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
    if let (Some(path), Some(record)) = (shown.first(), records().next()) {
        outputs.fill_table("csv", || Ok(table(path, record)))?;
    }
    if let (Some(path), Some(record)) = (shown.first(), records().next()) {
        let title = format!("{}: {}", path.file_name().unwrap_or(path.as_os_str()).display(), record.title);
        outputs.fill("plot", || Ok(format.encode(&rocking_charts::record::record(record, &title)?)?))?;
    }
    let written = outputs.write()?;
    let named: Vec<(String, &Record)> = shown.iter().map(|path| path.display().to_string()).zip(records()).collect();
    let report = |(file, record): &(String, &Record)| report(file, record, &measures, &rotations, *g);
    let (texts, reports): (Vec<String>, Vec<Object>) =
        named.iter().map(report).map(|Summary { text, json }| (text, json)).unzip();
    let text = texts.join("\n") + &written.lines();
    let warnings: Vec<String> = named.iter().filter_map(|(file, record)| drift(file, record, *g)).collect();
    warn(&warnings);
    for error in &unreadable {
        eprintln!("rocking: {error}");
    }
    let failed = unreadable.len();
    let json = Object::default().with("records", reports);
    let json = json.with_some("unreadable", (failed > 0).then_some(unreadable));
    options.report.print("record", &written, &warnings, &text, &json)?;
    anyhow::ensure!(failed == 0, "{failed} of {} records cannot be read", files.len());
    Ok(())
}

/// Returns the reason to doubt the displacements, if there is one.
fn drift(file: &str, record: &Record, gravity: f64) -> Option<String> {
    let pgd = Measure::Pgd.of(record, gravity).filter(|pgd| *pgd > LARGEST_DISPLACEMENT)?;
    Some(format!(
        "{file}: the PGD is {} m; expected at most {LARGEST_DISPLACEMENT} m except beside a fault. \
         A wrong unit, counts or a drifting baseline (--baseline, --band-pass) give more",
        short(pgd)
    ))
}

/// Summarizes a record, with the PGA also in units of this gravity (m/s²).
///
/// `rotations` are the median and the greatest of each measure over all directions, with a transverse record.
fn report(file: &str, record: &Record, measures: &[Measure], rotations: &[Option<[f64; 2]>], gravity: f64) -> Summary {
    let Record { title, format, unit, processing, start_time, time_step, acceleration, .. } = record;
    let title = title.split_whitespace().collect::<Vec<_>>().join(" ");
    let (samples, duration, pga_time) = (acceleration.len(), record.duration(), record.peak().time);
    let mut summary = Summary::default();
    summary.item("file", file, "file", file);
    summary.item("title", &title, "title", &title);
    summary.item("format", format.to_string(), "format", format!("{format}, in {unit}"));
    summary.entry("unit", unit.to_string());
    if !processing.is_none() {
        summary.item("processing", processing.to_string(), "processing", processing);
    }
    summary.item("samples", samples, "samples", format!("{samples}, every {time_step} s from {start_time} s"));
    summary.entry("dt", time_step);
    summary.entry("start", start_time);
    summary.item("duration", duration, "duration", format!("{} s", short(duration)));
    summary.entry("PGA.time", pga_time);
    for (i, &measure) in measures.iter().enumerate() {
        let value = measure.of(record, gravity);
        let in_g = match (measure, value) {
            (Measure::Pga, Some(pga)) => format!(" = {:.3} g at {} s", pga / gravity, short(pga_time)),
            _ => String::new(),
        };
        let unit = measure.unit().replace('2', "²");
        let mut text = value.map_or("none".into(), |value| format!("{} {unit}{in_g}", short(value)));
        if let Some(Some([median, greatest])) = rotations.get(i) {
            text += &format!("; RotD50 {}, RotD100 {}", short(*median), short(*greatest));
        }
        summary.item(&measure.to_string(), value, &measure.to_string(), text);
    }
    if !rotations.is_empty() {
        for (part, key) in ["RotD50", "RotD100"].into_iter().enumerate() {
            let values = rotations.iter().map(|values| values.map(|values| values[part]));
            summary.entry(key, measures.iter().map(Measure::to_string).zip(values).collect::<Object>());
        }
    }
    summary
}

/// Rounds a number to six digits.
fn short(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Returns all samples of a record, with lines on its origin.
fn table(file: &Path, record: &Record) -> DescribedTable {
    let Record { title, format, unit, processing, start_time, time_step, acceleration, .. } = record;
    let changes = if processing.is_none() { String::new() } else { format!("; {processing}") };
    let file = file.file_name().unwrap_or(file.as_os_str()).display();
    let [title, file] =
        [title.clone(), file.to_string()].map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "));
    let numbers: Vec<usize> = (0..acceleration.len()).collect();
    let columns = [
        TableColumn::real("t", "s", |number: &usize| start_time + *number as f64 * time_step),
        TableColumn::real("a", "m/s2", |number: &usize| acceleration[*number]),
    ];
    let study = vec![title, format!("from {file}: {format}, in {unit}{changes}")];
    DescribedTable { study, table: Table::of(&columns, &numbers) }
}
