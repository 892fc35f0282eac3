//! `rocking frame`: options → columns under a beam → one run of their equivalent block, with the forces of the columns.

use std::path::PathBuf;

use clap::{Args, Parser};
use serde::Serialize;

use crate::options::checks::check;
use crate::options::excitation::{Excitation, ExcitationOptions};
use crate::options::explicit::ExplicitOptions;
use crate::options::run::warn;
use crate::options::single_run;
use crate::output::files::{NamedFile, Pending, check_distinct};
use crate::output::formats::check_table;
use crate::output::report::{ReportOptions, WrittenFiles};
use rocking_block::block::{Block, Body, Common, Physical, Supports};
use rocking_block::simulation::{Initial, OnSeparation};
use rocking_charts::history::block_line;
use rocking_studies::doubts;
use rocking_studies::frame::Frame;
use rocking_studies::output::csv::with_headings;
use rocking_studies::run::{History, Run};
use rocking_studies::spec::SingleRunSpec;

/// Options of `rocking frame`.
#[derive(Parser)]
pub struct FrameCommand {
    #[command(flatten, next_help_heading = "Excitation")]
    excitation: ExcitationOptions,
    #[command(flatten)]
    frame: FrameOptions,
    /// Initial rotation, positive to the right [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.0, help_heading = "Run")]
    theta: f64,
    #[command(flatten)]
    single_run: SingleRunSpec,
    /// Table of the history; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(Args)]
#[command(next_help_heading = "Frame")]
struct FrameOptions {
    /// Number of equal columns, at least 2
    #[arg(long, value_name = "N")]
    columns: u32,
    /// Width of a column [m]
    #[arg(long, value_name = "M")]
    width: f64,
    /// Height of a column [m]
    #[arg(long, value_name = "M")]
    height: f64,
    /// Mass of a column [kg]
    #[arg(long, value_name = "KG")]
    mass: f64,
    /// Centroidal moment of inertia of a column; by default that of a homogeneous rectangle [kg.m2]
    #[arg(long, value_name = "KG.M2")]
    inertia: Option<f64>,
    /// Mass of the beam that rests on the columns [kg]
    #[arg(long, value_name = "KG")]
    beam_mass: f64,
    /// Factor on the restitution e of the frame; their product is at most 1
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    restitution_factor: f64,
    /// Gravitational acceleration, also for records in g [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
}

impl FrameOptions {
    fn frame(&self) -> anyhow::Result<Frame> {
        let FrameOptions { columns, width, height, mass, inertia, beam_mass, restitution_factor, g } = *self;
        check("height", height, |x| x > 0.0, "a length > 0 m")?;
        let common = Common { mass, gravity: g, ..Common::default() };
        let physical = Physical { width, height, supports: Supports::Rigid { restitution_factor }, inertia };
        let column = Block::from_physical(&physical, &common)?;
        warn(doubts::of_blocks([column]));
        Ok(Frame::new(columns, column, beam_mass)?)
    }
}

/// Summary of a run, in SI units.
#[derive(Serialize)]
struct Summary<'a> {
    excitation: &'a str,
    frame: Parameters,
    /// `completed`, `overturned`, `separated` or `undecided`.
    outcome: &'static str,
    end_time: f64,
    peak: Peaks,
    /// The time from which the beam would have to be held down, if any.
    beam_leaves: Option<f64>,
}

/// The equivalent block: with these values it can be part of a sweep or a spectrum.
#[derive(Serialize)]
struct Parameters {
    mass_ratio: f64,
    alpha: f64,
    p: f64,
    gamma: f64,
    e: f64,
    #[serde(rename = "R0")]
    r0: f64,
    mass: f64,
}

/// Largest absolute values: of θ in the whole run, of the others in the rows.
#[derive(Default, Serialize)]
struct Peaks {
    theta: f64,
    #[serde(rename = "theta/alpha")]
    theta_over_alpha: f64,
    beam_u: f64,
    #[serde(rename = "base_H")]
    base_horizontal: f64,
    #[serde(rename = "base_N")]
    base_vertical: f64,
    #[serde(rename = "top_H")]
    top_horizontal: f64,
    #[serde(rename = "top_N")]
    top_vertical: f64,
}

impl Peaks {
    fn of(frame: &Frame, history: &History) -> Peaks {
        let theta = history.peaks.theta;
        let mut peaks = Peaks { theta, theta_over_alpha: theta / frame.block.alpha, ..Peaks::default() };
        for row in &history.rows {
            let response = frame.response_in(row);
            for (peak, value) in [
                (&mut peaks.beam_u, response.beam[0]),
                (&mut peaks.base_horizontal, response.base[0]),
                (&mut peaks.base_vertical, response.base[1]),
                (&mut peaks.top_horizontal, response.top[0]),
                (&mut peaks.top_vertical, response.top[1]),
            ] {
                *peak = peak.max(value.abs());
            }
        }
        peaks
    }
}

/// Runs the command.
pub fn run(options: &FrameCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let csv = options.csv.as_deref();
    csv.map_or(Ok(()), check_table)?;
    let frame = options.frame.frame()?;
    let (run, excitation) = options.run(explicit, &frame)?;
    check_distinct(&options.excitation.accelerograms.files().named(), &NamedFile::of_options([("csv", csv)]))?;
    let file = csv.map(Pending::new).transpose()?;
    let history = run.history(|_| ())?;
    if let Some(file) = file {
        Pending::write(vec![(file, with_headings(&frame.table(&history))?.into_bytes())])?;
    }
    let Block { alpha, gamma, body: Body { p, r0, mass, .. }, .. } = frame.block;
    let e = frame.block.restitution();
    let last = history.rows.last().map_or(0.0, |row| row.time);
    let summary = Summary {
        excitation: &excitation,
        frame: Parameters { mass_ratio: frame.mass_ratio(), alpha, p, gamma, e, r0, mass },
        outcome: history.end.word(),
        end_time: history.ending.map_or(last, |(_, time)| time),
        peak: Peaks::of(&frame, &history),
        beam_leaves: frame.beam_leaves(&history),
    };
    let written = WrittenFiles::new([("csv", csv)]);
    options.report.print("frame", &written, &[], &(summary.text(&frame) + &written.lines()), &summary)
}

impl FrameCommand {
    /// Returns the run of the equivalent block and a description of its excitation.
    fn run(&self, explicit: &ExplicitOptions, frame: &Frame) -> anyhow::Result<(Run, String)> {
        let block = frame.block;
        let Excitation { ground, pulse, description } = self.excitation.read(explicit, block.gravity, None)?;
        let is_moved = !description.is_empty() || self.theta != 0.0;
        anyhow::ensure!(is_moved, "nothing moves the frame; expected --record, --pulse or --theta");
        let initial = Initial { theta: self.theta, ..Initial::default() };
        // The equivalent block does not fly like the frame.
        let run = single_run::run(&self.single_run, block, OnSeparation::Terminate, initial, pulse, ground)?;
        Ok((run, if description.is_empty() { "free motion".into() } else { description }))
    }
}

impl Summary<'_> {
    fn text(&self, frame: &Frame) -> String {
        let Summary { excitation, peak, outcome, end_time, .. } = self;
        let Frame { columns, column, beam_mass, .. } = frame;
        let weight = column.mass * column.gravity + beam_mass * column.gravity / f64::from(*columns);
        let mut text = format!("excitation    {excitation}\n");
        text += &format!(
            "frame         {columns} columns of {} m × {} m, {} kg; beam {beam_mass} kg, γ_b = {:.4}\n",
            2.0 * column.b,
            2.0 * column.h,
            column.mass,
            self.frame.mass_ratio
        );
        text += &format!("block         {}, γ = {:.4}\n", block_line(&frame.block), self.frame.gamma);
        text += &format!("end           {outcome} at t = {end_time:.4} s\n");
        text += &format!("peak          |θ|/α = {:.4}, beam {:.1} mm\n", peak.theta_over_alpha, 1e3 * peak.beam_u);
        text += &format!(
            "base          N = {:.4e} N, |H| = {:.4e} N per column on average; {:.3} and {:.3} of its load at rest\n",
            peak.base_vertical,
            peak.base_horizontal,
            peak.base_vertical / weight,
            peak.base_horizontal / weight
        );
        text += &format!(
            "top           N = {:.4e} N, |H| = {:.4e} N per column on average\n",
            peak.top_vertical, peak.top_horizontal
        );
        if let Some(time) = self.beam_leaves {
            text += &format!("beam          leaves the columns at t = {time:.4} s, where this model ends\n");
        }
        text
    }
}
