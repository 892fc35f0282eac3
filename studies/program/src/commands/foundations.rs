//! `rocking foundations`: friction, restitution and supports of rubber or soil. Each has its source.

use std::collections::{BTreeMap, BTreeSet};

use clap::{Args, Parser, Subcommand};

use crate::options::checks::checked;
use crate::output::report::{ReportOptions, WrittenFiles};
use crate::output::summary::{Summary, aligned};
use rocking_charts::numerals::significant;
use rocking_studies::foundations::{Pad, Pair, Soil, Support, pairs};

/// Options of `rocking foundations`.
#[derive(Parser)]
#[command(args_conflicts_with_subcommands = true)]
pub struct FoundationsCommand {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(Subcommand)]
enum Command {
    /// Compute a support of rubber: a circular pad under each corner
    Pad(SupportOptions<Pad>),
    /// Compute supports equivalent to a rectangular footing on soil
    Soil(SupportOptions<Soil>),
}

#[derive(Args)]
struct SupportOptions<S: Args> {
    #[command(flatten)]
    support: S,
    #[command(flatten)]
    block: SupportedBlock,
    #[command(flatten)]
    report: ReportOptions,
}

/// The block on the supports.
#[derive(Args)]
struct SupportedBlock {
    /// Mass M of the block, for omega_v, xi_v and delta_s [kg]
    #[arg(long, value_name = "KG")]
    mass: Option<f64>,
    /// Frequency parameter p of the block, for eta; with --mass [rad/s]
    #[arg(long, value_name = "RAD/S", requires = "mass")]
    p: Option<f64>,
}

/// Runs the command.
pub fn run(options: &FoundationsCommand) -> anyhow::Result<()> {
    match &options.command {
        None => {
            let json = BTreeMap::from([("pairs", pairs())]);
            options.report.print("foundations", &WrittenFiles::new([]), &[], &table(pairs()), &json)
        }
        Some(Command::Pad(options)) => {
            let source = match options.support.bulk_modulus {
                None => "Palmeri and Makris (2008), eq. (36)",
                Some(_) => "Palmeri and Makris (2008), eq. (36); compressibility by Gent and Lindley (1959)",
            };
            options.print("foundations pad", options.support.support()?, source)
        }
        Some(Command::Soil(options)) => {
            let source = "Pais and Kausel (1988): static stiffness, radiation damping of the vertical motion";
            options.print("foundations soil", options.support.support()?, source)
        }
    }
}

impl<S: Args> SupportOptions<S> {
    fn print(&self, command: &str, support: Support, source: &'static str) -> anyhow::Result<()> {
        let mass = checked("mass", self.block.mass, |x| x > 0.0, "a mass > 0 kg")?;
        let p = checked("p", self.block.p, |x| x > 0.0, "a frequency > 0 rad/s")?;
        let omega_v = mass.map(|mass| (2.0 * support.stiffness / mass).sqrt());
        let xi_v = mass.zip(omega_v).zip(support.damping).map(|((mass, omega_v), damping)| damping / (mass * omega_v));
        let eta = omega_v.zip(p).map(|(omega_v, p)| omega_v / p);
        let Support { stiffness, damping, rocking_stiffness } = support;
        let short = |value: f64| significant(value, 4);
        let mut summary = Summary::default();
        summary.item("K", stiffness, "K", format!("{stiffness:.4e} N/m, of each of two supports"));
        let of_each = damping.map(|damping| format!("{damping:.4e} N.s/m, of each"));
        summary.item("C", damping, "C", of_each.unwrap_or_else(|| "not stated by the source".into()));
        summary.entry("K_rocking", rocking_stiffness);
        if let Some(rocking) = rocking_stiffness.filter(|&rocking| rocking != stiffness) {
            let part = significant(rocking / stiffness, 3);
            let text = format!("{rocking:.4e} N/m, {part} K: two supports with the rocking stiffness of the footing");
            summary.line("K_rocking", text);
        }
        for (key, value) in [("omega_v", omega_v), ("xi_v", xi_v), ("eta", eta)] {
            summary.entry(key, value);
        }
        if let Some(omega_v) = omega_v {
            let xi_v = xi_v.map(|xi_v| format!(", xi_v = {}", short(xi_v))).unwrap_or_default();
            let eta = eta.map(|eta| format!(", eta = {}", short(eta))).unwrap_or_default();
            summary.line("block", format!("omega_v = {} rad/s{xi_v}{eta}", short(omega_v)));
        }
        summary.item("source", source, "source", source);
        self.report.print(command, &WrittenFiles::new([]), &[], &summary.text, &summary.json)
    }
}

/// Writes the pairs as a table, with the sources below.
fn table(pairs: &[Pair]) -> String {
    let heading = ["quantity", "surfaces", "state", "value", "kind", "source"].map(String::from).to_vec();
    let row = |pair: &Pair| {
        let [low, high] = [pair.low, pair.high].map(|value| significant(value, 3));
        vec![
            pair.quantity.name().into(),
            pair.surfaces.clone(),
            pair.state.clone(),
            if low == high { low } else { format!("{low} to {high}") },
            pair.kind.word().into(),
            pair.source.name.clone(),
        ]
    };
    let rows: Vec<Vec<String>> = std::iter::once(heading).chain(pairs.iter().map(row)).collect();
    let mut text = aligned(&rows, 0..0);
    text.push('\n');
    let mut seen = BTreeSet::new();
    for source in pairs.iter().map(|pair| &pair.source).filter(|source| seen.insert(&source.name)) {
        let doi = source.doi.as_ref().map(|doi| format!(", doi:{doi}")).unwrap_or_default();
        text.push_str(&format!("{}: {}{doi}\n", source.name, source.citation));
    }
    text
}
