//! `rocking pulse`: an accelerogram → the pulse that fits its velocity best.

use std::path::PathBuf;

use anyhow::Context;
use clap::Parser;
use std::fmt::Write;

use crate::options::accelerograms::refuse_without_effect;
use crate::options::block::in_options;
use crate::options::input;
use crate::output::files::{NamedFile, Outputs};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::ReportOptions;
use crate::output::summary::Summary;
use rocking_block::block::Common;
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_studies::input::ground_files::{RecordOption, RecordOptions};
use rocking_studies::intensity::{pga, pgv};
use rocking_studies::output::table::{Table, TableColumn};
use rocking_studies::pulse_fit::{self, FitSample, PulseFit};
use rocking_studies::spec::ReadingSpec;
use rocking_studies::spec::pulse::shapes;
use rocking_studies::spec::words::Words;

/// Options of `rocking pulse`.
#[derive(Parser)]
pub struct PulseCommand {
    /// Accelerogram in any format of docs/studies/records.md; `-` for standard input
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten, next_help_heading = "Reading")]
    reading: ReadingSpec,
    /// Gravitational acceleration, for records in g [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
    /// Shape of the pulse
    #[arg(long, value_parser = shapes(), default_value = PulseShape::Gabor.word())]
    shape: PulseShape,
    /// Table of accelerations and velocities of record and pulse; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &PulseCommand) -> anyhow::Result<()> {
    let PulseCommand { file, reading, g, shape, csv, picture, report } = options;
    anyhow::ensure!(
        pulse_fit::SHAPES.contains(shape),
        "--shape {}; expected a pulse after which the ground stands still: {}",
        shape.word(),
        pulse_fit::SHAPES.map(Words::word).join(", ")
    );
    csv.as_deref().map_or(Ok(()), check_table)?;
    let format = picture.format()?;
    let outputs = [("csv", csv.as_deref()), ("plot", picture.plot.as_deref())];
    let mut outputs = Outputs::checked(&[NamedFile::new("the record", file)], outputs)?;
    let record_options = RecordOptions { both: reading.options(*g).map_err(in_options)?, ..RecordOptions::default() };
    let record = record_options.read(false, RecordOption::option, |options| input::record(file, options));
    let record = record.map_err(anyhow::Error::msg)?;
    let grounds = [Ground { horizontal: Some(record.clone()), vertical: None }];
    refuse_without_effect(&record_options, &grounds)?;

    let name = file.display();
    let fit = pulse_fit::fit(&record, *shape)
        .with_context(|| format!("{name}: no {} pulse fits into the motion; expected a longer record", shape.word()))?;
    let samples = fit.samples(&record);
    let columns = [
        TableColumn::real("t", "s", |sample: &FitSample| sample.time),
        TableColumn::real("a", "m/s2", |sample: &FitSample| sample.acceleration[0]),
        TableColumn::real("a_pulse", "m/s2", |sample: &FitSample| sample.acceleration[1]),
        TableColumn::real("v", "m/s", |sample: &FitSample| sample.velocity[0]),
        TableColumn::real("v_pulse", "m/s", |sample: &FitSample| sample.velocity[1]),
    ];
    outputs.fill_table("csv", || Ok(Table::of(&columns, &samples)))?;
    let title = record.title.split_whitespace().collect::<Vec<_>>().join(" ");
    outputs.fill("plot", || Ok(format.encode(&rocking_charts::pulse_fit::pulse_fit(&samples, &fit, &title)?)?))?;
    let written = outputs.write()?;
    let mut summary = Summary::default();
    summary.item("file", name.to_string(), "file", name);
    summary.item("title", &title, "title", &title);
    add_pulse(&mut summary, &fit);
    let peak = |of: fn(&FitSample) -> f64| samples.iter().map(of).fold(0.0, |a: f64, b| a.max(b.abs()));
    let pga = [pga(&record), peak(|sample| sample.acceleration[1])];
    let pgv = [pgv(&record), peak(|sample| sample.velocity[1])];
    summary.line("velocity", format!("{:.4} m/s at most, of PGV = {:.4} m/s", pgv[1], pgv[0]));
    // Of the record and of the pulse.
    summary.item("PGA", pga, "acceleration", format!("{:.4} m/s² at most, of PGA = {:.4} m/s²", pga[1], pga[0]));
    summary.entry("PGV", pgv);
    let command = command(&fit.pulse);
    summary.item("command", &command, "run", &command);
    report.print("pulse", &written, &[], &(summary.text + &written.lines()), &summary.json)
}

/// Adds the fitted pulse.
fn add_pulse(summary: &mut Summary, fit: &PulseFit) {
    let Pulse { shape, amplitude, period, start, phase, cycles } = fit.pulse;
    let (omega_p, duration, r_squared) = (fit.omega(), fit.pulse.duration(), fit.r_squared);
    let mut text =
        format!("{}, a_p = {amplitude:.4} m/s², T_p = {period:.4} s, ω_p = {omega_p:.4} rad/s", shape.word());
    summary.entry("shape", shape.word());
    summary.entry("amplitude", amplitude);
    summary.entry("period", period);
    summary.entry("start", start);
    if shape == PulseShape::Gabor {
        summary.entry("phase", phase);
        summary.entry("cycles", cycles);
        text += &format!(", ν = {phase:.4} rad, γ = {cycles:.4}");
    }
    summary.item("omega_p", omega_p, "pulse", text);
    summary.item("duration", duration, "time", format!("from {start:.4} s, {duration:.4} s long"));
    summary.item("r_squared", r_squared, "share", format!("R² = {r_squared:.4} of the energy of the velocity"));
}

/// Returns the command line that uses a pulse, with six digits.
fn command(pulse: &Pulse) -> String {
    let Pulse { shape, amplitude, period, start, phase, cycles } = *pulse;
    let digits = |value: f64| format!("{value:.5e}").parse().unwrap_or(value);
    let [amplitude, period, start, phase, cycles] = [amplitude, period, start, phase, cycles].map(digits);
    let mut line =
        format!("rocking simulate --pulse {} --amplitude {amplitude} --period {period} --start {start}", shape.word());
    if shape == PulseShape::Gabor {
        // Writing to a String never fails.
        let _ = write!(line, " --phase {phase} --cycles {cycles}");
    }
    line
}
