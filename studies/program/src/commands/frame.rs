//! `rocking frame`: options → columns under a beam → one run of their equivalent block.

use std::path::PathBuf;

use clap::{Args, Parser};

use crate::options::accelerograms::of_one_motion;
use crate::options::checks::check;
use crate::options::excitation::{Excitation, ExcitationOptions};
use crate::options::explicit::ExplicitOptions;
use crate::options::run::warn;
use crate::options::single_run;
use crate::output::files::Outputs;
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::ReportOptions;
use crate::output::summary::{Object, Summary};
use rocking_block::block::{Block, BlockParameters, Common, Outline, Supports};
use rocking_block::simulation::{Initial, OnSeparation};
use rocking_charts::history::block_line;
use rocking_studies::doubts;
use rocking_studies::frame::{Frame, FrameResponse};
use rocking_studies::run::{History, Run};
use rocking_studies::spec::{BlockSpec, SingleRunSpec};

/// Options of `rocking frame`.
#[derive(Parser)]
#[command(mut_args(of_one_motion))]
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
    picture: PictureOptions,
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
    #[arg(long, value_name = "FACTOR", default_value_t = BlockSpec::defaults().restitution_factor.unwrap_or_default())]
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
        let (outline, supports) = (Outline::Sizes { width, height, inertia }, Supports::Rigid { restitution_factor });
        let column = Block::new(&BlockParameters { outline, supports, common })?;
        warn(doubts::of_blocks([column]));
        Ok(Frame::new(columns, column, beam_mass)?)
    }
}

/// Runs the command.
pub fn run(options: &FrameCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let csv = options.csv.as_deref();
    csv.map_or(Ok(()), check_table)?;
    let format = options.picture.format()?;
    let frame = options.frame.frame()?;
    let (run, excitation) = options.run(explicit, &frame)?;
    let mut outputs = Outputs::checked(
        &options.excitation.accelerograms.named(),
        [("csv", csv), ("plot", options.picture.plot.as_deref())],
    )?;
    let history = run.history(|_| ())?;
    outputs.fill_table("csv", || Ok(frame.table(&history)))?;
    outputs.fill("plot", || Ok(format.encode(&rocking_charts::frame::frame(&frame, &history, &excitation)?)?))?;
    let written = outputs.write()?;
    let summary = summary(&frame, &history, &excitation);
    options.report.print("frame", &written, &[], &(summary.text + &written.lines()), &summary.json)
}

impl FrameCommand {
    /// Returns the run of the equivalent block and a description of its excitation.
    fn run(&self, explicit: &ExplicitOptions, frame: &Frame) -> anyhow::Result<(Run, String)> {
        let block = frame.block;
        let Excitation { mut motions, pulse, description } = self.excitation.read(explicit, block.gravity, None)?;
        let (_, ground) = motions.swap_remove(0);
        anyhow::ensure!(
            !description.is_empty() || self.theta != 0.0,
            "nothing moves the frame; expected --record, --pulse or --theta"
        );
        let initial = Initial { theta: self.theta, ..Initial::default() };
        // The equivalent block does not fly like the frame.
        let run = single_run::run(&self.single_run, block, OnSeparation::Terminate, initial, pulse, ground)?;
        Ok((run, if description.is_empty() { "free motion".into() } else { description }))
    }
}

/// Summarizes the frame and its run. The peak of θ is that of the whole run, others are those of the rows.
fn summary(frame: &Frame, history: &History, excitation: &str) -> Summary {
    let Frame { columns, column, beam_mass, block } = frame;
    let each = f64::from(*columns);
    let weight = column.mass * column.gravity + beam_mass * column.gravity / each;
    let peak = |of: fn(&FrameResponse) -> f64| {
        history.rows.iter().map(|row| of(&frame.response_in(row)).abs()).fold(0.0, f64::max)
    };
    let (theta, beam) = (history.peaks.theta, peak(|response| response.beam[0]));
    let base = [peak(|response| response.base[0]), peak(|response| response.base[1])];
    let top = [peak(|response| response.top[0]), peak(|response| response.top[1])];
    let last = history.rows.last().map_or(0.0, |row| row.time);
    let end_time = history.ending.map_or(last, |(_, time)| time);

    let mut summary = Summary::default();
    summary.item("excitation", excitation, "excitation", excitation);
    let ratio = frame.mass_ratio();
    summary.line(
        "frame",
        format!(
            "{columns} columns of {} m × {} m, {} kg; beam {beam_mass} kg, γ_b = {ratio:.4}",
            2.0 * column.b,
            2.0 * column.h,
            column.mass
        ),
    );
    // With these values the equivalent block can be part of a sweep or a spectrum.
    summary.item(
        "frame",
        Object::from([
            ("mass_ratio", ratio),
            ("alpha", block.alpha),
            ("p", block.p),
            ("gamma", block.gamma),
            ("e", block.restitution()),
            ("R0", block.r0),
            ("mass", block.mass),
        ]),
        "block",
        format!("{}, γ = {:.4}", block_line(block), block.gamma),
    );
    let outcome = history.end.word();
    summary.item("outcome", outcome, "end", format!("{outcome} at t = {end_time:.4} s"));
    summary.entry("end_time", end_time);
    summary.item(
        "peak",
        Object::from([
            ("theta", theta),
            ("theta/alpha", theta / block.alpha),
            ("beam_u", beam),
            ("base_H", base[0]),
            ("base_N", base[1]),
            ("top_H", top[0]),
            ("top_N", top[1]),
        ]),
        "peak",
        format!("|θ|/α = {:.4}, beam {:.1} mm", theta / block.alpha, 1e3 * beam),
    );
    let [horizontal, vertical] = base.map(|force| force / weight);
    let forces = |[horizontal, vertical]: [f64; 2]| {
        format!("N = {vertical:.4e} N, |H| = {horizontal:.4e} N per column on average")
    };
    summary.line("base", format!("{}; {vertical:.3} and {horizontal:.3} of its load at rest", forces(base)));
    summary.line("top", forces(top));
    let leaves = frame.beam_leaves(history);
    summary.entry("beam_leaves", leaves);
    if let Some(time) = leaves {
        summary.line("beam", format!("leaves the columns at t = {time:.4} s, where this model ends"));
    }
    summary
}
