//! `rocking search`: range of damping or amplitude → the values at which the outcome changes.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Parser, Subcommand};

use crate::options::accelerograms::{Accelerograms, of_one_motion};
use crate::options::block::{block, in_options};
use crate::options::checks::check;
use crate::options::excitation::SecondComponentOptions;
use crate::options::explicit::ExplicitOptions;
use crate::options::in_space;
use crate::options::run::ProcessorOptions;
use crate::output::files::{NamedFile, Outputs, check_distinct};
use crate::output::formats::check_table;
use crate::output::progress::Progress;
use crate::output::report::ReportOptions;
use crate::output::summary::{Object, Summary};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_studies::output::table::{Table, TableColumn};
use rocking_studies::run::Run;
use rocking_studies::run::outcome::End;
use rocking_studies::search::{self, OutcomeMap, Scan, Shaken, Threshold};
use rocking_studies::space::RunInSpace;
use rocking_studies::spec::pulse::shapes;
use rocking_studies::spec::run::separations;
use rocking_studies::spec::words::Words;
use rocking_studies::spec::{BlockSpec, GaborSpec, PulseSpec, RunSpec, SpaceSpec, limits};

/// Options of `rocking search`.
#[derive(Parser)]
pub struct SearchCommand {
    #[command(subcommand)]
    target: Target,
}

/// Parameters of a block that a search for the damping of its supports varies, or excludes.
const OF_NO_SEARCH_FOR_DAMPING: [&str; 5] = ["xi_v", "stiffness", "damping", "foundation", "restitution_factor"];

#[derive(Subcommand)]
enum Target {
    /// Find the smallest xi_v without complete separation in free vibration from theta_dot(0) = 0.95 alpha p
    #[command(mut_args(|arg| if OF_NO_SEARCH_FOR_DAMPING.contains(&arg.get_id().as_str()) { arg.hide(true) } else { arg }))]
    Damping(Box<Damping>),
    /// Find the smallest amplitude of a pulse, or factor on records, that overturns a block, in the plane or in space
    #[command(mut_args(of_one_motion))]
    Overturning(Box<Overturning>),
}

#[derive(Args)]
struct Damping {
    /// Initial angular velocity over alpha p
    #[arg(long, default_value_t = 0.95)]
    rate: f64,
    /// Lower end of the range of xi_v
    #[arg(long, value_name = "XI_V", default_value_t = 0.0)]
    from: f64,
    /// Upper end of the range of xi_v
    #[arg(long, value_name = "XI_V", default_value_t = 1.0)]
    to: f64,
    /// Width to which each change is bisected
    #[arg(long, value_name = "XI_V", default_value_t = 1e-6)]
    resolution: f64,
    #[command(flatten)]
    block: BlockSpec,
    #[command(flatten)]
    search: SearchOptions,
}

#[derive(Args)]
struct Overturning {
    /// Shape of the pulse
    #[arg(long, value_parser = shapes(), default_value = PulseShape::OneSine.word())]
    pulse: PulseShape,
    /// Period T_p of the pulse; required without --record [s]
    #[arg(long, value_name = "S")]
    period: Option<f64>,
    #[command(flatten)]
    gabor: GaborSpec,
    #[command(flatten)]
    accelerograms: Accelerograms,
    #[command(flatten)]
    second: SecondComponentOptions,
    /// Lower end of the range of amplitudes [m/s2] or factors; by default 0, or on a rigid base without a vertical record and without
    /// ties a PGA of g tan(alpha), with alpha of the side with less base, below which no block rocks
    #[arg(long, value_name = "A")]
    from: Option<f64>,
    /// Upper end of the range of amplitudes [m/s2] or factors; by default ten times a PGA of g tan(alpha), in space with alpha over the
    /// nearest edge and the PGA of both components together
    #[arg(long, value_name = "A")]
    to: Option<f64>,
    /// Width to which each change is bisected, in the unit of the amplitude or factor
    #[arg(long, value_name = "A", default_value_t = 1e-6)]
    resolution: f64,
    /// Action at complete separation
    #[arg(long, value_parser = separations(), default_value = OnSeparation::Fly.word())]
    on_separation: OnSeparation,
    #[command(flatten)]
    block: BlockSpec,
    #[command(flatten)]
    space: SpaceSpec,
    #[command(flatten)]
    search: SearchOptions,
}

#[derive(Args)]
#[command(next_help_heading = "Search")]
struct SearchOptions {
    /// Number of evenly spaced values at which the range is scanned
    #[arg(long, value_name = "N", default_value_t = 201, value_parser = clap::value_parser!(u64).range(2..=10_000_000))]
    points: u64,
    /// Relative tolerance of the integration; the default suffices for outcomes and peaks, not for the last digits of reactions
    #[arg(long, default_value_t = Settings::OF_STUDIES, value_name = "TOL")]
    tolerance: f64,
    #[command(flatten)]
    processor: ProcessorOptions,
    /// Table of the ranges with a single outcome; `-` for standard output
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    report: ReportOptions,
}

/// Runs the command.
pub fn run(options: &SearchCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    match &options.target {
        Target::Damping(damping) => damping.run(explicit),
        Target::Overturning(overturning) => overturning.run(explicit),
    }
}

impl Damping {
    /// Searches for the smallest damping.
    fn run(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        let Damping { rate, from, to, resolution, .. } = *self;
        self.search.check_table(&[])?;
        check("rate", rate, |_| true, "a finite number")?;
        let scan = self.search.scan(from, to, resolution)?;
        explicit.refuse_unless(false, &OF_NO_SEARCH_FOR_DAMPING, "in a search for the damping of supports")?;
        let BlockSpec { width, eta, .. } = self.block;
        let has_eta = width.is_none() || eta.is_some();
        anyhow::ensure!(has_eta, "--width without --eta; expected the stiffness ratio of the supports");
        let block = block(&self.block)?;
        let (settings, width) = (self.search.settings()?, self.search.processor.width());
        self.search.search(
            Summary::default(),
            ("xi_v", ""),
            &scan,
            |progress| Ok(search::damping_against_separation(&block, rate, settings, &scan, width, progress)?),
            OutcomeMap::damping_against_separation,
            |found, threshold, shown| {
                let overturned = found.stretches().iter().any(|stretch| stretch.2 == End::Overturned);
                let but = if overturned { ", but overturning in a range above" } else { "" };
                let to = shown(to);
                match threshold {
                    Threshold::At(0.0) => format!("none needed: no separation from xi_v = 0 to {to}{but}"),
                    Threshold::At(least) => format!("no separation from xi_v = {} to {to}{but}", shown(least)),
                    Threshold::AtMost(least) => format!(
                        "no separation from xi_v = {} to {to}{but}: the least damping is at most this value; \
                         expected a smaller --from",
                        shown(least)
                    ),
                    Threshold::Above(_) => {
                        format!("separation even at xi_v = {to}; expected a larger --to")
                    }
                }
            },
        )
    }
}

impl Overturning {
    /// Searches for the smallest strength that overturns a block, in the plane or in space.
    fn run(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        explicit.refuse_unless(!explicit.has("record"), &["pulse", "period", "phase", "cycles"], "with --record")?;
        let is_in_space = in_space::makes_space(&self.space, explicit, &["record-y", "azimuth"])?;
        let files = [self.accelerograms.named(), self.second.named().into_iter().collect()].concat();
        self.search.check_table(&files)?;
        let settings = Settings { on_separation: self.on_separation, ..self.search.settings()? };
        if is_in_space {
            self.search.processor.refuse_lanes("for blocks in space, which are stepped one by one")?;
            let (parameters, body) = in_space::block(&self.space, &self.block)?;
            let gravity = body.gravity;
            let ground = self.second.ground(&self.accelerograms, explicit, gravity, None, !explicit.has("record"))?;
            let [x, _, vertical] = ground.records.each_ref().map(Option::is_some);
            let pulse = self.pulse(x, vertical)?;
            let at_rest = RunInSpace::at_rest(parameters, body, settings);
            let run = RunInSpace { ground, ..at_rest.with_pulse(pulse.unwrap_or(Pulse::NONE), self.second.azimuth) };
            let mut head = Summary::default();
            head.item("model", "block in space", "model", "block in space");
            return self.search(&run, pulse.is_some(), head);
        }
        let block = block(&self.block)?;
        let ground = self.accelerograms.read(block.gravity)?.swap_remove(0);
        let pulse = self.pulse(ground.horizontal.is_some(), ground.vertical.is_some())?;
        let run = Run { ground, pulse: pulse.unwrap_or(Pulse::NONE), ..Run::at_rest(block, settings) };
        self.search(&run, pulse.is_some(), Summary::default())
    }

    /// Searches the strengths of a run, whose summary begins with `head`.
    fn search<E: Shaken>(&self, run: &E, is_pulse: bool, head: Summary) -> anyhow::Result<()> {
        let (name, unit) = if is_pulse { ("a_p", " m/s2") } else { ("scale", "") };
        let [least, greatest] = run.usual_strengths();
        let (from, to) = (self.from.unwrap_or(least), self.to.unwrap_or(greatest));
        let scan = self.search.scan(from, to, self.resolution)?;
        let width = self.search.processor.width();
        self.search.search(
            head,
            (name, unit),
            &scan,
            |progress| Ok(search::overturning(run, &scan, width, progress)),
            OutcomeMap::overturning,
            |_, threshold, shown| match threshold {
                Threshold::At(least) => format!("first overturning at {name} = {}{unit}", shown(least)),
                Threshold::AtMost(least) if least == from => format!(
                    "first overturning at {name} = {}{unit} at most, where the range begins; expected a smaller --from",
                    shown(least)
                ),
                Threshold::AtMost(least) => {
                    format!("first overturning at {name} = {}{unit} at most: runs below it failed", shown(least))
                }
                Threshold::Above(_) => {
                    format!("no overturning from {name} = {} to {}{unit}", shown(from), shown(to))
                }
            },
        )
    }

    /// Returns the pulse whose amplitude is unknown; `None` with a horizontal record.
    fn pulse(&self, has_record: bool, has_vertical: bool) -> anyhow::Result<Option<Pulse>> {
        if has_record {
            return Ok(None);
        }
        anyhow::ensure!(!has_vertical, "--vertical without --record; expected both, or a pulse alone");
        anyhow::ensure!(self.pulse != PulseShape::None, "--pulse none overturns no block; expected a pulse");
        let period = self.period.context("--period is missing; expected the period T_p of the pulse, or --record")?;
        let (shape, period, gabor) = (Some(self.pulse), Some(period), self.gabor.clone());
        let pulse = PulseSpec { shape, period, gabor, ..PulseSpec::default() };
        Ok(Some(pulse.with_amplitude(None).map_err(in_options)?))
    }
}

impl SearchOptions {
    fn settings(&self) -> anyhow::Result<Settings> {
        limits::check::<RunSpec>(&[("tolerance", Some(self.tolerance))]).map_err(in_options)?;
        Ok(Settings { tolerance: self.tolerance, ..Settings::default() })
    }

    fn scan(&self, from: f64, to: f64, resolution: f64) -> anyhow::Result<Scan> {
        check("from", from, |_| true, "a finite number")?;
        check("to", to, |x| x > from, &format!("more than --from = {from}"))?;
        check("resolution", resolution, |x| x > 0.0, "a number > 0")?;
        Ok(Scan { from, to, points: self.points, resolution })
    }

    /// Refuses a table that is not CSV or would replace an input.
    fn check_table(&self, inputs: &[NamedFile]) -> anyhow::Result<()> {
        let Some(csv) = &self.csv else { return Ok(()) };
        check_table(csv)?;
        check_distinct(inputs, &[NamedFile::new("--csv", csv)])
    }

    /// Searches, writes the table and prints the summary.
    ///
    /// The summary begins with `head`; `threshold` extracts the number from the result, `answer` puts it into a sentence.
    fn search(
        &self,
        head: Summary,
        (name, unit): (&str, &str),
        scan: &Scan,
        search: impl FnOnce(search::SearchProgress) -> anyhow::Result<OutcomeMap<End>> + Send,
        threshold: impl FnOnce(&OutcomeMap<End>) -> Threshold,
        answer: impl FnOnce(&OutcomeMap<End>, Threshold, &dyn Fn(f64) -> String) -> String,
    ) -> anyhow::Result<()> {
        let mut outputs = Outputs::open([("csv", self.csv.as_deref())])?;
        let bar = Progress::new(scan.points, 0);
        let found = self.processor.threads.pool()?.install(|| search(&|done, runs| bar.show_of(done, runs)));
        bar.clear();
        let found = found?;
        let stretches = found.stretches();
        type Stretch = (f64, f64, End);
        let columns = [
            TableColumn::real("from", "1", |(from, ..): &Stretch| *from).with_unit(None),
            TableColumn::real("to", "1", |(_, to, _): &Stretch| *to).with_unit(None),
            TableColumn::text("outcome", |(.., end): &Stretch| end.word().into()),
        ];
        outputs.fill_table("csv", || Ok(Table::of(&columns, &stretches)))?;
        let written = outputs.write()?;
        let threshold = threshold(&found);
        let shown = |value: f64| rounded(value, scan.resolution);
        let answer = answer(&found, threshold, &shown);
        let mut summary = head;
        for (from, to, end) in &stretches {
            summary.text += &format!("{name} = {} to {}{unit}: {end}\n", shown(*from), shown(*to));
        }
        let failed = stretches.iter().any(|stretch| stretch.2 == End::Failed).then(|| "some runs failed".to_string());
        let failures = failed.as_ref().map(|failed| format!("; {failed}")).unwrap_or_default();
        summary.text += &format!(
            "{answer}\n{} values, {}{unit} apart: narrower ranges may be missed; changes within {}{unit}{failures}\n",
            scan.points,
            short(found.spacing),
            scan.resolution
        );
        summary.entry("parameter", name);
        summary.entry("unit", if unit.is_empty() { "1" } else { unit.trim() });
        summary.entry("least", threshold.value());
        // `none`; or `upper` or `lower`, if the range only bounds the value.
        summary.entry("bound", threshold.bound());
        summary.entry("answer", &answer);
        summary.entry("values", scan.points);
        summary.entry("spacing", found.spacing);
        summary.entry("resolution", scan.resolution);
        let stretch =
            |(from, to, end): &(f64, f64, End)| Object::from([("from", from), ("to", to)]).with("outcome", end.word());
        summary.entry("stretches", stretches.iter().map(stretch).collect::<Vec<_>>());
        self.report.print("search", &written, failed.as_slice(), &summary.text, &summary.json)
    }
}

/// Rounds a value to the fewest decimals that are as fine as a resolution. A value with fewer is printed in full.
fn rounded(value: f64, resolution: f64) -> String {
    let fine = |decimals: &usize| libm::pow(10.0, -(*decimals as f64)) <= resolution * (1.0 + 1e-9);
    let exact = value.to_string();
    match (0..exact.len()).find(fine) {
        Some(decimals) => format!("{value:.decimals$}"),
        None => exact,
    }
}

/// Rounds a value to three digits.
fn short(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn values_have_the_decimals_of_the_resolution() {
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
