//! `rocking search`: a range of damping or of amplitude → where the outcome changes.

use std::path::PathBuf;
use std::sync::Mutex;

use anyhow::Context;
use clap::{Args, Parser, Subcommand};
use serde::Serialize;

use crate::block::{Block, Common, Dimensionless, Foundation, Physical};
use crate::cli::accelerograms::Accelerograms;
use crate::cli::excitation::{Shape, finite};
use crate::cli::formats::check_table;
use crate::cli::given::Given;
use crate::cli::output::{Named, Pending, check_distinct};
use crate::cli::progress::Progress;
use crate::cli::report::{ReportOptions, Written};
use crate::cli::run_options::{
    AtSeparation, Base, ProcessorOptions, SizeOptions, check_tolerance, warn_of_soft_supports,
};
use crate::excitation::Pulse;
use crate::simulation::Settings;
use crate::study::outcome::End;
use crate::study::search::{self, Found, Scan, Shaking, Threshold};

/// Options of `rocking search`.
#[derive(Parser)]
pub struct Options {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Least damping xi_v against complete separation in free vibration from theta_dot(0) = 0.95 alpha p
    Damping(Damping),
    /// Minimum amplitude of a pulse, or factor on a record, that overturns a block
    Overturning(Box<Overturning>),
}

#[derive(Args)]
struct Damping {
    /// Rate of rotation at the start over alpha p
    #[arg(long, default_value_t = 0.95)]
    rate: f64,
    /// Least xi_v
    #[arg(long, value_name = "XI_V", default_value_t = 0.0)]
    from: f64,
    /// Greatest xi_v
    #[arg(long, value_name = "XI_V", default_value_t = 1.0)]
    to: f64,
    /// Width to which a change is closed in
    #[arg(long, value_name = "XI_V", default_value_t = 1e-6)]
    resolution: f64,
    #[command(flatten)]
    block: BlockOptions,
    #[command(flatten)]
    search: SearchOptions,
}

#[derive(Args)]
struct Overturning {
    /// Shape of the pulse
    #[arg(long, value_enum, default_value_t = Shape::OneSine)]
    pulse: Shape,
    /// Period T_p of the pulse, which has no default [s]
    #[arg(long, value_name = "S")]
    period: Option<f64>,
    #[command(flatten)]
    accelerograms: Accelerograms,
    /// Least amplitude [m/s2], or factor; without it 0, or on a rigid base without a vertical record a PGA of g tan(alpha), below
    /// which no block rocks there
    #[arg(long, value_name = "A")]
    from: Option<f64>,
    /// Greatest amplitude [m/s2], or factor; without it ten times a PGA of g tan(alpha)
    #[arg(long, value_name = "A")]
    to: Option<f64>,
    /// Width to which a change is closed in, in the unit of the amplitude or factor
    #[arg(long, value_name = "A", default_value_t = 1e-6)]
    resolution: f64,
    /// Vertical damping ratio xi_v
    #[arg(long, default_value_t = 0.1)]
    xi_v: f64,
    /// What happens at complete separation
    #[arg(long, value_enum, default_value_t = AtSeparation::Fly)]
    on_separation: AtSeparation,
    /// What the block stands on
    #[arg(long, value_enum, default_value_t = Base::Viscoelastic)]
    foundation: Base,
    /// Restitution e on the rigid base over Housner's e of epsilon; their product is at most 1
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    restitution_factor: f64,
    #[command(flatten)]
    block: BlockOptions,
    #[command(flatten)]
    search: SearchOptions,
}

#[derive(Args)]
#[command(next_help_heading = "Block")]
struct BlockOptions {
    /// Slenderness angle alpha [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.25)]
    alpha: f64,
    /// Frequency parameter p [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 1.0)]
    p: f64,
    #[command(flatten)]
    size: SizeOptions,
    /// Stiffness ratio eta = omega_v/p
    #[arg(long, default_value_t = 40.0)]
    eta: f64,
    /// Restitution epsilon of the landing corner, 0 to 1
    #[arg(long, default_value_t = Common::default().epsilon)]
    epsilon: f64,
    /// Shape factor gamma = M R0²/I0
    #[arg(long, default_value_t = Common::default().gamma)]
    gamma: f64,
    /// Gravity [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
}

#[derive(Args)]
#[command(next_help_heading = "Search")]
struct SearchOptions {
    /// Values at which the range is scanned, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 201, value_parser = clap::value_parser!(u64).range(2..=10_000_000))]
    points: u64,
    /// Relative tolerance of the integration; the default suffices for outcomes and peaks, not for the last digits of reactions
    #[arg(long, default_value_t = Settings::OF_STUDIES, value_name = "TOL")]
    tolerance: f64,
    #[command(flatten)]
    processor: ProcessorOptions,
    /// Table of the stretches of one outcome; `-` for standard output
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    report: ReportOptions,
}

/// Does what the options say.
pub fn run(options: &Options, given: &Given) -> anyhow::Result<()> {
    match &options.what {
        What::Damping(damping) => {
            let Damping { rate, from, to, resolution, .. } = *damping;
            damping.search.check_table(&[])?;
            finite("rate", rate, |_| true, "a finite number")?;
            let scan = damping.search.scan(from, to, resolution)?;
            let common = damping.block.common(Foundation::Viscoelastic);
            let block = damping.block.dimensionless(0.1, &common, given)?;
            let (settings, width) = (damping.search.settings()?, damping.search.processor.width());
            damping.search.search(
                "xi_v",
                "",
                &scan,
                |progress| {
                    let found =
                        search::damping_against_separation(&block, &common, rate, settings, &scan, width, progress);
                    Ok(found?)
                },
                Found::damping_against_separation,
                |found, threshold, shown| {
                    let overturned = found.stretches().iter().any(|stretch| stretch.2 == End::Overturned);
                    let but = if overturned { ", but overturning where it says so above" } else { "" };
                    let to = shown(to);
                    match threshold {
                        Threshold::At(0.0) => format!("none needed: no separation from xi_v = 0 to {to}{but}"),
                        Threshold::At(least) => format!("no separation from xi_v = {} to {to}{but}", shown(least)),
                        Threshold::AtMost(least) => format!(
                            "no separation from xi_v = {} to {to}{but}: the least damping is at most that; expected a \
                             smaller --from",
                            shown(least)
                        ),
                        Threshold::Above(_) => {
                            format!("separation at xi_v = {to} still; expected a range with a greater --to")
                        }
                    }
                },
            )
        }
        What::Overturning(overturning) => {
            let Overturning { xi_v, foundation, restitution_factor, resolution, .. } = **overturning;
            let rigid = foundation == Base::Rigid;
            given.only_if(!rigid, &["eta", "xi-v"], "on a rigid base")?;
            given.only_if(rigid, &["restitution-factor"], "on viscoelastic supports; expected --foundation rigid")?;
            given.only_if(!given.has("record"), &["pulse", "period"], "with --record")?;
            overturning.search.check_table(&overturning.accelerograms.files().named())?;
            let common = Common { restitution_factor, ..overturning.block.common(foundation.into()) };
            let block = Block::from_dimensionless(&overturning.block.dimensionless(xi_v, &common, given)?, &common)?;
            warn_of_soft_supports(&block);
            let (shaking, name, unit) = overturning.shaking(common.gravity)?;
            let [least, greatest] = search::usual_strengths(&block, &shaking);
            let (from, to) = (overturning.from.unwrap_or(least), overturning.to.unwrap_or(greatest));
            let scan = overturning.search.scan(from, to, resolution)?;
            let on_separation = overturning.on_separation.into();
            let settings = Settings { on_separation, ..overturning.search.settings()? };
            let width = overturning.search.processor.width();
            overturning.search.search(
                name,
                unit,
                &scan,
                |progress| Ok(search::overturning(&block, &shaking, settings, &scan, width, progress)),
                Found::overturning,
                |_, threshold, shown| match threshold {
                    Threshold::At(least) => format!("overturning first at {name} = {}{unit}", shown(least)),
                    Threshold::AtMost(least) if least == from => format!(
                        "overturning first at {name} = {}{unit} at most: the range begins there; expected a smaller --from",
                        shown(least)
                    ),
                    Threshold::AtMost(least) => {
                        format!("overturning first at {name} = {}{unit} at most: runs below failed", shown(least))
                    }
                    Threshold::Above(_) => {
                        format!("no overturning from {name} = {} to {}{unit}", shown(from), shown(to))
                    }
                },
            )
        }
    }
}

impl Overturning {
    /// What moves the ground, and name and unit of the number that is searched for.
    fn shaking(&self, gravity: f64) -> anyhow::Result<(Shaking, &'static str, &'static str)> {
        let ground = self.accelerograms.read(gravity)?;
        if ground.horizontal.is_some() {
            return Ok((Shaking::Records(ground), "scale", ""));
        }
        anyhow::ensure!(ground.vertical.is_none(), "--vertical without --record; expected both, or a pulse alone");
        anyhow::ensure!(self.pulse != Shape::None, "--pulse none overturns no block; expected a pulse");
        let period = self.period.context("--period is missing; expected the period T_p of the pulse, or --record")?;
        finite("period", period, |x| x > 0.0, "a time > 0 s")?;
        let pulse = Pulse { shape: self.pulse.into(), amplitude: 0.0, period, start: 0.0 };
        Ok((Shaking::Pulse(pulse), "a_p", " m/s2"))
    }
}

impl BlockOptions {
    fn dimensionless(&self, xi_v: f64, common: &Common, given: &Given) -> anyhow::Result<Dimensionless> {
        let BlockOptions { alpha, p, eta, size, .. } = self;
        let Some([width, height]) = size.read(given, &["alpha", "p"])? else {
            return Ok(Dimensionless { alpha: *alpha, p: *p, eta: *eta, xi_v });
        };
        anyhow::ensure!(
            common.foundation == Foundation::Rigid || given.has("eta"),
            "--width without --eta; expected the stiffness ratio of the supports, or --foundation rigid"
        );
        // Neither alpha nor p depends on the supports.
        let (stiffness, damping) = (common.mass * common.gravity / height, 0.0);
        let Block { alpha, p, .. } = Block::from_physical(&Physical { width, height, stiffness, damping }, common)?;
        Ok(Dimensionless { alpha, p, eta: *eta, xi_v })
    }

    fn common(&self, foundation: Foundation) -> Common {
        let BlockOptions { epsilon, gamma, g, .. } = *self;
        Common { epsilon, gamma, gravity: g, foundation, ..Common::default() }
    }
}

impl SearchOptions {
    fn settings(&self) -> anyhow::Result<Settings> {
        check_tolerance(self.tolerance)?;
        Ok(Settings { tolerance: self.tolerance, ..Settings::default() })
    }

    fn scan(&self, from: f64, to: f64, resolution: f64) -> anyhow::Result<Scan> {
        finite("from", from, |_| true, "a finite number")?;
        finite("to", to, |x| x > from, &format!("more than --from = {from}"))?;
        finite("resolution", resolution, |x| x > 0.0, "a number > 0")?;
        Ok(Scan { from, to, points: self.points, resolution })
    }

    /// Refuses a name of the table under which it cannot be written, or which would replace an input.
    fn check_table(&self, inputs: &[Named]) -> anyhow::Result<()> {
        let Some(csv) = &self.csv else { return Ok(()) };
        check_table(csv)?;
        check_distinct(inputs, &[Named::new("--csv", csv)])
    }

    /// Searches, writes the table and reports the result. `threshold` is the number sought, `answer` its sentence.
    fn search(
        &self,
        name: &str,
        unit: &str,
        scan: &Scan,
        search: impl FnOnce(&(dyn Fn(u64, u64) + Sync)) -> anyhow::Result<Found<End>> + Send,
        threshold: impl FnOnce(&Found<End>) -> Threshold,
        answer: impl FnOnce(&Found<End>, Threshold, &dyn Fn(f64) -> String) -> String,
    ) -> anyhow::Result<()> {
        let file = self.csv.as_deref().map(Pending::new).transpose()?;
        let bar = Mutex::new(Progress::new(scan.points, 0));
        let show = |done, runs| {
            if let Ok(mut bar) = bar.lock() {
                bar.show_of(done, runs);
            }
        };
        let found = self.processor.pool()?.install(|| search(&show));
        if let Ok(bar) = bar.lock() {
            bar.clear();
        }
        let found = found?;
        let stretches = found.stretches();
        if let Some(file) = file {
            let mut table = "from,to,outcome\n".to_string();
            stretches.iter().for_each(|(from, to, end)| table.push_str(&format!("{from},{to},{end}\n")));
            Pending::write(vec![(file, table.into_bytes())])?;
        }
        let threshold = threshold(&found);
        let shown = |value: f64| rounded(value, scan.resolution);
        let answer = answer(&found, threshold, &shown);
        let mut text = String::new();
        for (from, to, end) in &stretches {
            text.push_str(&format!("{name} = {} to {}{unit}: {end}\n", shown(*from), shown(*to)));
        }
        let failed = stretches.iter().any(|stretch| stretch.2 == End::Failed).then(|| "some runs failed".to_string());
        let narrow = failed.as_ref().map(|failed| format!("; {failed}")).unwrap_or_default();
        text.push_str(&format!(
            "{answer}\n{} values, {}{unit} apart: what is narrower may be missed; changes within {}{unit}{narrow}\n",
            scan.points,
            short(found.spacing),
            scan.resolution
        ));
        let result = SearchResult {
            parameter: name,
            unit: if unit.is_empty() { "1" } else { unit.trim() },
            least: threshold.value(),
            bound: threshold.bound(),
            answer: &answer,
            values: scan.points,
            spacing: found.spacing,
            resolution: scan.resolution,
            stretches: stretches
                .iter()
                .map(|&(from, to, end)| Stretch { from, to, outcome: end.to_string() })
                .collect(),
        };
        let written = Written::new([("csv", self.csv.as_deref())]);
        self.report.print("search", &written, failed.as_slice(), &text, &result)
    }
}

#[derive(Serialize)]
struct SearchResult<'a> {
    parameter: &'a str,
    unit: &'a str,
    /// The least damping without separation from there on, or the least amplitude or factor that overturns the block.
    least: Option<f64>,
    /// `none`, or `upper` or `lower` where the range only bounds the least value.
    bound: &'static str,
    answer: &'a str,
    values: u64,
    spacing: f64,
    resolution: f64,
    stretches: Vec<Stretch>,
}

#[derive(Serialize)]
struct Stretch {
    from: f64,
    to: f64,
    outcome: String,
}

/// A value in the decimals that a resolution supports: the fewest whose last one is no coarser. A value with fewer digits
/// than that is printed as it is.
fn rounded(value: f64, resolution: f64) -> String {
    let fine = |decimals: &usize| libm::pow(10.0, -(*decimals as f64)) <= resolution * (1.0 + 1e-9);
    let exact = value.to_string();
    match (0..exact.len()).find(fine) {
        Some(decimals) => format!("{value:.decimals$}"),
        None => exact,
    }
}

/// Three digits of a value.
fn short(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn as_many_decimals_as_the_resolution_supports() {
        let pi = std::f64::consts::PI;
        let cases =
            [(1e-6, "3.141593"), (2e-6, "3.141593"), (9e-7, "3.1415927"), (0.5, "3.1"), (1.0, "3"), (30.0, "3")];
        for (resolution, expected) in cases {
            assert_eq!(rounded(pi, resolution), expected, "{resolution}");
        }
        assert_eq!(rounded(0.25, 1e-300), "0.25");
        assert_eq!(rounded(-1234.5678, 1e-3), "-1234.568");
        assert_eq!(rounded(pi, 1e-15), "3.141592653589793");
    }
}
