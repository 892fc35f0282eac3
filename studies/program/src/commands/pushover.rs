//! `rocking pushover`: options → a block → its lateral force over a slow rotation. The curve has landmarks, and a cycle its loop.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Parser;

use crate::options::block;
use crate::options::explicit::ExplicitOptions;
use crate::output::files::Outputs;
use crate::output::formats::{PictureOptions, check_table};
use crate::output::report::ReportOptions;
use crate::output::summary::{Object, Summary};
use rocking_block::block::Block;
use rocking_block::block::restraints::{MAX, tie};
use rocking_charts::history::block_line;
use rocking_charts::numerals::significant;
use rocking_charts::pushover::{groups, names};
use rocking_studies::output::csv::with_headings;
use rocking_studies::pushover::table::table;
use rocking_studies::pushover::{Cycle, Landmark, Push, Pushover};
use rocking_studies::spec::BlockSpec;

/// Options of `rocking pushover`.
#[derive(Parser)]
pub struct PushoverCommand {
    #[command(flatten)]
    block: BlockSpec,
    #[command(flatten)]
    push: Push,
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

/// Runs the command.
pub fn run(options: &PushoverCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    let PushoverCommand { block: given, push, csv, cycle_csv, picture, report } = options;
    explicit.refuse_unless(push.amplitude.is_some(), &["cycle-csv"], "without --amplitude")?;
    let outputs = [("csv", csv.as_deref()), ("cycle-csv", cycle_csv.as_deref()), ("plot", picture.plot.as_deref())];
    [csv, cycle_csv].into_iter().flatten().try_for_each(|table| check_table(table))?;
    let format = picture.format()?;
    let mut outputs = Outputs::checked(&[], outputs)?;
    let block = block::block(given)?;
    let found = Pushover::of(&block, push)?;
    let cycle_rows = found.cycle.as_ref().map_or(&[][..], |cycle| &cycle.rows[..]);
    for (option, rows) in [("csv", &found.rows[..]), ("cycle-csv", cycle_rows)] {
        outputs.fill(option, || Ok(with_headings(&table(&block, rows))?.into_bytes()))?;
    }
    outputs.fill("plot", || Ok(format.encode(&rocking_charts::pushover::pushover(&block, &found)?)?))?;
    let written = outputs.write()?;
    let summary = summary(&block, &found);
    report.print("pushover", &written, &[], &(summary.text + &written.lines()), &summary.json)
}

/// The curve and the cycle.
fn summary(block: &Block, found: &Pushover) -> Summary {
    let mut summary = Summary::default();
    summary.line("block", block_line(block));
    let landmark = |Landmark { kind, at }: &Landmark| {
        let of_kind = Object::default().with("name", kind.to_string());
        of_kind.with("theta", at.theta).with("u", at.u).with("force", at.force).with("moment", at.moment)
    };
    summary.entry("landmarks", found.landmarks.iter().map(landmark).collect::<Vec<_>>());
    summary.text += "curve            θ/rad     θ/α      u/mm   F/(M g)   moment/kN.m\n";
    for group in groups(&found.landmarks) {
        let at = group[0].at;
        summary.text += &format!(
            "{:>22.5}{:>8.3}{:>10.1}{:>10.4}{:>14}  {}\n",
            at.theta,
            at.theta / block.alpha,
            1e3 * at.u,
            at.force / (block.mass * block.gravity),
            significant(1e-3 * at.moment, 5),
            names(group)
        );
    }
    if let Some(cycle) = &found.cycle {
        add_cycle(&mut summary, block, cycle);
    }
    summary
}

/// Adds the cycle with its energies (J). Each tie and damper loses some before it and in it.
fn add_cycle(summary: &mut Summary, block: &Block, cycle: &Cycle) {
    let Cycle { amplitude, lost, lost_before, equivalent_damping, recentring, residual, .. } = cycle;
    let of_links = |energy: &[f64; MAX]| -> BTreeMap<String, f64> {
        tie::names(block.ties()).into_iter().zip(energy.iter().copied()).collect()
    };
    let [in_cycle, before] = [lost, lost_before].map(|energy| significant(of_links(energy).values().sum(), 4));
    let finite = |number: f64| number.is_finite().then_some(number);
    let (damping, ratio) = (finite(*equivalent_damping), finite(*recentring));
    let shown = damping.map_or("none".into(), |ratio| significant(ratio, 4));
    let amplitude_shown = significant(*amplitude, 4);
    summary.item(
        "amplitude",
        amplitude,
        "cycle",
        format!(
            "±{amplitude_shown} rad: {in_cycle} J lost by yielding, after {before} J; ξ_eq = {shown} without impacts"
        ),
    );
    summary.entry("energy", of_links(lost));
    summary.entry("energy_before", of_links(lost_before));
    summary.entry("equivalent_damping", damping);
    let shown = ratio.map_or("no damper".into(), |ratio| format!("λ = {}", significant(ratio, 4)));
    let text = format!("{shown}; residual rotation {} rad", significant(*residual, 4));
    summary.item("recentring_ratio", ratio, "recentring", text);
    summary.entry("residual_theta", residual);
}
