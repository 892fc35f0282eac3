//! `rocking pushover`: options → a block → its lateral force over a slow rotation, with its landmarks, and the loop of a cycle.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};
use serde::Serialize;

use crate::options::block;
use crate::options::explicit::ExplicitOptions;
use crate::output::files::{NamedFile, Pending, check_distinct};
use crate::output::formats::{PictureOptions, check_table, encoded, knows_parquet};
use crate::output::report::{ReportOptions, WrittenFiles};
use rocking_block::block::restraints::{MAX, tie};
use rocking_block::block::{Block, Corner};
use rocking_charts::history::block_line;
use rocking_charts::numerals::significant;
use rocking_charts::pushover::{groups, names};
use rocking_studies::output::csv::with_headings;
use rocking_studies::pushover::table::table;
use rocking_studies::pushover::{Cycle, Landmark, MAX_POINTS, Push, Pushover};
use rocking_studies::spec::BlockSpec;

/// Options of `rocking pushover`.
#[derive(Parser)]
pub struct PushoverCommand {
    #[command(flatten)]
    block: BlockSpec,
    /// Side to which the lateral force turns the block
    #[arg(long, value_enum, default_value_t = Side::Right, help_heading = "Rotation")]
    side: Side,
    /// Greatest rotation; by default that at which the centre of mass stands over the corner. The curve ends before it where the
    /// force vanishes [rad]
    #[arg(long, value_name = "RAD", help_heading = "Rotation")]
    to: Option<f64>,
    /// Also turn the block to and fro by this amplitude: energy, equivalent damping, recentring ratio and residual rotation [rad]
    #[arg(long, value_name = "RAD", help_heading = "Rotation")]
    amplitude: Option<f64>,
    /// Number of equal steps to the greatest rotation, and to the amplitude; landmarks stand between them, at their rotations
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_POINTS)), help_heading = "Rotation")]
    points: u32,
    /// Table of the curve; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    /// Table of the cycle, from its first rotation on
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    cycle_csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    report: ReportOptions,
}

/// A side.
#[derive(Clone, Copy, ValueEnum)]
enum Side {
    /// Over the left corner
    Left,
    /// Over the right corner
    Right,
}

/// The curve and the cycle, in SI units.
#[derive(Serialize)]
struct Results {
    landmarks: Vec<Named>,
    #[serde(flatten)]
    cycle: Option<CycleResults>,
}

/// A named point of the curve.
#[derive(Serialize)]
struct Named {
    name: String,
    theta: f64,
    u: f64,
    force: f64,
    moment: f64,
}

#[derive(Serialize)]
struct CycleResults {
    amplitude: f64,
    /// Lost in the closed cycle, by the names of ties and dampers (J).
    energy: serde_json::Map<String, serde_json::Value>,
    /// Lost before it (J).
    energy_before: serde_json::Map<String, serde_json::Value>,
    equivalent_damping: Option<f64>,
    recentring_ratio: Option<f64>,
    residual_theta: f64,
}

/// Runs the command.
pub fn run(options: &PushoverCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let PushoverCommand { block: given, side, to, amplitude, points, csv, cycle_csv, picture, report } = options;
    explicit.refuse_unless(picture.plot.is_some(), &["plot-format"], "without --plot")?;
    explicit.refuse_unless(amplitude.is_some(), &["cycle-csv"], "without --amplitude")?;
    let outputs = [("csv", csv.as_deref()), ("cycle-csv", cycle_csv.as_deref()), ("plot", picture.plot.as_deref())];
    check_distinct(&[], &NamedFile::of_options(outputs))?;
    for table in [csv, cycle_csv].into_iter().flatten() {
        check_table(table)?;
    }
    let format = picture.format()?;
    let block = block::block(given)?;
    let over = match side {
        Side::Left => Corner::Left,
        Side::Right => Corner::Right,
    };
    let push = Push { over, to: *to, amplitude: *amplitude, points: *points };
    let found = Pushover::of(&block, &push)?;
    let cycle_rows = found.cycle.as_ref().map_or(&[][..], |cycle| &cycle.rows[..]);
    let mut written = Vec::new();
    for (path, rows) in [(csv, &found.rows[..]), (cycle_csv, cycle_rows)] {
        if let Some(path) = path {
            let csv = with_headings(&table(&block, rows))?;
            written.push((Pending::new(path)?, encoded(knows_parquet(path)?, csv.into_bytes())?));
        }
    }
    if let (Some(plot), Some(format)) = (&picture.plot, format) {
        let svg = rocking_charts::pushover::pushover(&block, &found)?;
        written.push((Pending::new(plot)?, format.encode(&svg)?));
    }
    Pending::write(written)?;
    let written = WrittenFiles::new(outputs);
    let results = Results {
        landmarks: found.landmarks.iter().map(Named::of).collect(),
        cycle: found.cycle.as_ref().map(|cycle| CycleResults::of(&block, cycle)),
    };
    report.print("pushover", &written, &[], &(text(&block, &found, &results) + &written.lines()), &results)
}

impl Named {
    fn of(Landmark { kind, at }: &Landmark) -> Named {
        Named { name: kind.to_string(), theta: at.theta, u: at.u, force: at.force, moment: at.moment }
    }
}

impl CycleResults {
    fn of(block: &Block, cycle: &Cycle) -> CycleResults {
        let of_links = |energy: [f64; MAX]| tie::names(block.ties()).into_iter().zip(energy.map(Into::into)).collect();
        let finite = |number: f64| number.is_finite().then_some(number);
        CycleResults {
            amplitude: cycle.amplitude,
            energy: of_links(cycle.lost),
            energy_before: of_links(cycle.lost_before),
            equivalent_damping: finite(cycle.equivalent_damping),
            recentring_ratio: finite(cycle.recentring),
            residual_theta: cycle.residual,
        }
    }
}

fn text(block: &Block, found: &Pushover, results: &Results) -> String {
    let mut text = format!("block         {}\n", block_line(block));
    text += "curve            θ/rad     θ/α      u/mm   F/(M g)   moment/kN.m\n";
    for group in groups(&found.landmarks) {
        let at = group[0].at;
        text += &format!(
            "{:>22.5}{:>8.3}{:>10.1}{:>10.4}{:>14}  {}\n",
            at.theta,
            at.theta / block.alpha,
            1e3 * at.u,
            at.force / (block.mass * block.gravity),
            significant(1e-3 * at.moment, 5),
            names(group)
        );
    }
    let Some(CycleResults { amplitude, energy, energy_before, equivalent_damping, recentring_ratio, residual_theta }) =
        &results.cycle
    else {
        return text;
    };
    let [lost, before] = [energy, energy_before].map(|energy| {
        let sum: f64 = energy.values().filter_map(serde_json::Value::as_f64).sum();
        significant(sum, 4)
    });
    let damping = equivalent_damping.map_or("none".into(), |ratio| significant(ratio, 4));
    let recentring = recentring_ratio.map_or("no damper".into(), |ratio| format!("λ = {}", significant(ratio, 4)));
    text + &format!(
        "cycle         ±{} rad: {lost} J lost by yielding, after {before} J; ξ_eq = {damping} without impacts\n\
         recentring    {recentring}; residual rotation {} rad\n",
        significant(*amplitude, 4),
        significant(*residual_theta, 4)
    )
}
