//! `rocking simulate`: options → a run → a table, a picture and a summary.

mod gradients;

pub mod summary;

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Parser};

use crate::options::block;
use crate::options::checks::check;
use crate::options::excitation::{Excitation, ExcitationOptions};
use crate::options::explicit::ExplicitOptions;
use crate::options::single_run;
use crate::output::files::{NamedFile, Pending, check_distinct};
use crate::output::formats::{PictureOptions, check_table};
use crate::output::progress::Progress;
use crate::output::report::{ReportOptions, WrittenFiles};
use rocking_block::block::restraints::TieState;
use rocking_block::block::{Block, Foundation};
use rocking_block::simulation::{Ending, Initial, OnSeparation};
use rocking_charts::history::link_names;
use rocking_charts::loops;
use rocking_charts::picture::PictureFormat;
use rocking_gradients::Parameters;
use rocking_records::{ReadOptions, Record};
use rocking_studies::run::gradients::Gradients;
use rocking_studies::run::outcome::{Breaks, End, Holds};
use rocking_studies::run::stopping_rule::loses_energy;
use rocking_studies::run::table;
use rocking_studies::run::{History, Run};
use rocking_studies::spec::run::separations;
use rocking_studies::spec::words::Words;
use rocking_studies::spec::{BlockSpec, RunSpec, SingleRunSpec, limits};
use summary::Summary;

/// Default record: U.S. Geological Survey, public domain.
const EMBEDDED: (&str, &[u8]) = ("np01002p_4225a_a.smc", include_bytes!("../../../records/np01002p_4225a_a.smc"));

/// Options of `rocking simulate`.
#[derive(Parser)]
pub struct SimulateCommand {
    #[command(
        flatten,
        next_help_heading = "Excitation (by default, unless the block starts from an initial state, an embedded record)"
    )]
    excitation: ExcitationOptions,
    #[command(flatten)]
    block: BlockSpec,
    #[command(flatten)]
    initial: InitialOptions,
    #[command(flatten)]
    single_run: SingleRunSpec,
    /// Action at complete separation
    #[arg(long, value_parser = separations(), default_value = OnSeparation::Terminate.word(),
          help_heading = "Run")]
    on_separation: OnSeparation,
    /// Table of the history; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    /// Picture of the forces of dampers, and of ties that yield, over their elongations, SVG or PNG by its extension
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    plot_loops: Option<PathBuf>,
    /// Report the longest time for which |H|/(N_L + N_R) exceeds this coefficient of friction, checked every ms
    #[arg(long, value_name = "MU", help_heading = "Results")]
    friction_demand: Option<f64>,
    /// Add the derivatives of all columns, of the peaks and of the times of the events with respect to these parameters to table and
    /// summary: alpha, eta, scale, pulse.period, initial.theta, tie_1.stiffness and so on, by the names of the FMU
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', help_heading = "Results")]
    gradients: Vec<String>,
    /// List each event in the summary
    #[arg(long, help_heading = "Results")]
    events: bool,
    /// Print no summary
    #[arg(long, help_heading = "Results", conflicts_with = "json")]
    quiet: bool,
    #[command(flatten)]
    report: ReportOptions,
}

#[derive(Args)]
#[command(next_help_heading = "Initial state (without excitation, the block moves freely from it)")]
struct InitialOptions {
    /// Initial rotation, positive to the right [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.0)]
    theta: f64,
    /// Initial angular velocity [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 0.0)]
    theta_dot: f64,
    /// Initial height of the centre of mass above its position at rest; by default the vertical equilibrium [m]
    #[arg(long, value_name = "M")]
    v: Option<f64>,
    /// Initial vertical velocity; by default the vertical equilibrium [m/s]
    #[arg(long, value_name = "M/S")]
    v_dot: Option<f64>,
}

/// Runs the command.
pub fn run(options: &SimulateCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    options.refuse_without_effect(explicit)?;
    let format = options.picture.format()?.unwrap_or(PictureFormat::Png);
    options.csv.as_deref().map_or(Ok(()), check_table)?;
    let loops_format = options.plot_loops.as_deref().map(PictureFormat::of).transpose()?;
    let (run, excitation) = options.run(explicit)?;
    let has_loops = !loops::numbers(&run.block).is_empty();
    explicit.refuse_unless(has_loops, &["plot-loops"], "without --damper, or a yield_force in --tie")?;
    let (csv, plot) = options.outputs()?;
    let outputs = [("csv", csv.as_deref()), ("plot", plot.as_deref()), ("plot-loops", options.plot_loops.as_deref())];
    check_distinct(&options.excitation.accelerograms.files().named(), &NamedFile::of_options(outputs))?;
    let csv_file = csv.as_deref().map(Pending::new).transpose()?;
    let picture_file = plot.as_deref().map(Pending::new).transpose()?;
    let loops_file = options.plot_loops.as_deref().map(Pending::new).transpose()?;

    const PARTS: u64 = 1000;
    let mut bar = Progress::new(PARTS, 0);
    let progress = |part| bar.show((part * PARTS as f64) as u64);
    let (history, derivatives) = options.history(&run, progress)?;
    bar.clear();

    let mut files = Vec::new();
    if let Some(file) = csv_file {
        let bytes = table::csv(&run.block, &history, &derivatives.parameters, 0..history.rows.len())
            .context("the table cannot be written")?;
        files.push((file, bytes));
    }
    if let Some(file) = picture_file {
        let svg = rocking_charts::history::history(&run.block, &history, &excitation)?;
        files.push((file, format.encode(&svg)?));
    }
    if let (Some(file), Some(format)) = (loops_file, loops_format) {
        files.push((file, format.encode(&loops::loops(&run.block, &history, &excitation)?)?));
    }
    Pending::write(files)?;
    if options.quiet {
        return Ok(());
    }
    let written = WrittenFiles::new(outputs);
    let demand = options.friction_demand.map(|demand| (demand, run.longest_above(demand)));
    let text = summary(&run, &history, &excitation, demand, options.events)
        + &gradients::lines(&derivatives)
        + &written.lines();
    let warnings =
        is_embedded(explicit).then(|| format!("no excitation given: the embedded record {} was used", EMBEDDED.0));
    let json = Summary::new(&run, &history, &derivatives, &excitation, demand, options.events);
    options.report.print("simulate", &written, warnings.as_slice(), &text, &json)
}

impl SimulateCommand {
    /// Returns table and picture; by default `out/rocking.csv` and `out/rocking.png`.
    fn outputs(&self) -> anyhow::Result<(Option<PathBuf>, Option<PathBuf>)> {
        if self.csv.is_some() || self.picture.plot.is_some() || self.plot_loops.is_some() {
            return Ok((self.csv.clone(), self.picture.plot.clone()));
        }
        let folder = Path::new("out");
        std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be created", folder.display()))?;
        Ok((Some(folder.join("rocking.csv")), Some(folder.join("rocking.png"))))
    }

    /// Returns the history, with derivatives if requested.
    fn history(&self, run: &Run, progress: impl FnMut(f64)) -> anyhow::Result<(History, Gradients)> {
        if self.gradients.is_empty() {
            return Ok((run.history(progress)?, Gradients::default()));
        }
        run.check_memory(self.gradients.len())?;
        let (parameterization, common) = self.block.parameters().map_err(block::in_options)?;
        let parameters = Parameters {
            parameterization,
            common,
            ties: run.block.ties().to_vec(),
            initial: run.initial,
            pulse: run.pulse,
            scale: (!run.ground.is_empty()).then_some(self.excitation.scale),
        };
        gradients::check(&parameters, &self.gradients)?;
        let history = run.history_with_gradients(&parameters, &self.gradients, progress);
        Ok(history.context("gradients: a parameter is missing")??)
    }

    /// Refuses options without effect.
    fn refuse_without_effect(&self, explicit: &ExplicitOptions) -> anyhow::Result<()> {
        let on_supports = self.block.foundation() == Foundation::Viscoelastic;
        explicit.refuse_unless(on_supports, &["v", "v-dot"], "on a rigid base")?;
        explicit.refuse_unless(self.picture.plot.is_some(), &["plot-format"], "without --plot")?;
        explicit.refuse_unless(!self.quiet, &["events", "friction-demand"], "with --quiet")
    }

    /// Returns the run and a description of its excitation.
    fn run(&self, explicit: &ExplicitOptions) -> anyhow::Result<(Run, String)> {
        let block = block::block(&self.block)?;
        let embedded = self.embedded(explicit)?;
        let Excitation { ground, pulse, mut description } =
            self.excitation.read(explicit, self.block.gravity(), embedded)?;
        if description.is_empty() {
            description = "free motion".into();
        }
        let InitialOptions { theta, theta_dot, v, v_dot } = self.initial;
        check("theta-dot", theta_dot, |_| true, "a finite rate")?;
        limits::check::<RunSpec>(&[("friction_demand", self.friction_demand)]).map_err(block::in_options)?;
        let vertical = (v.is_some() || v_dot.is_some()).then_some((v.unwrap_or_default(), v_dot.unwrap_or_default()));
        for value in vertical.iter().flat_map(|(v, v_dot)| [v, v_dot]) {
            check("v and v-dot", *value, |_| true, "finite numbers")?;
        }
        let initial = Initial { theta, theta_dot, vertical };
        let run = single_run::run(&self.single_run, block, self.on_separation, initial, pulse, ground)?;
        Ok((run, description))
    }

    /// Returns the embedded record, if neither excitation nor initial state is given.
    fn embedded(&self, explicit: &ExplicitOptions) -> anyhow::Result<Option<Record>> {
        if !is_embedded(explicit) {
            return Ok(None);
        }
        let (name, bytes) = EMBEDDED;
        let options = ReadOptions { gravity: self.block.gravity(), ..ReadOptions::default() };
        let record = rocking_records::parse(name, bytes, &options)?;
        Ok(Some(Record { title: format!("{name}: {}", record.title), ..record }))
    }
}

/// Returns whether neither excitation nor initial state is given.
fn is_embedded(explicit: &ExplicitOptions) -> bool {
    const OPTIONS: [&str; 7] = ["record", "vertical", "pulse", "theta", "theta-dot", "v", "v-dot"];
    !OPTIONS.iter().any(|option| explicit.has(option))
}

/// Predicts the future of a block that neither overturned nor separated.
fn prospect(run: &Run, history: &History) -> &'static str {
    match (history.end, run.duration) {
        (End::Completed, _) if history.ends_tilted(&run.block) => "the block is at rest, tilted",
        (End::Completed, _) if history.is_at_rest => "the block is at rest",
        (End::Completed, _) if loses_energy(&run.block) => "the block will come to rest",
        (End::Completed, _) => "the block will not overturn",
        (_, Some(_)) => "the duration is too short to tell whether the block overturns",
        (_, None) => "the block may still overturn",
    }
}

/// Says how far a block went past its balance, or how it leans at the end, if it does either.
fn balance(block: &Block, history: &History) -> Option<String> {
    let (tilted, rest) = (history.ends_tilted(block), history.lean.end / block.alpha);
    if history.end != End::Overturned && history.lean.passed_balance() {
        let (over, back) = (history.lean.over_balance, if tilted { " and ends tilted" } else { "" });
        return Some(format!(
            "the block passed its balance, |θ| = {over:.4} of that angle{back}; θ/α = {rest:.4} at the end"
        ));
    }
    tilted.then(|| format!("the block ends tilted: θ/α = {rest:.4}"))
}

/// Writes the energies at the end.
fn energy(block: &Block, history: &History) -> String {
    let energies = history.rows.last().map(|row| row.energies).unwrap_or_default();
    let largest = history.greatest_energy();
    let residual = if largest > 0.0 { history.greatest_residual() / largest } else { 0.0 };
    let mut taken = String::new();
    if block.friction > 0.0 {
        taken += &format!(", friction {:.1} J", energies.friction);
    }
    let Holds { ties, dampers, .. } = Holds::of(block);
    if ties > 0 {
        taken += &format!(", ties {:.1} J", energies.restraints.ties);
    }
    if dampers > 0 {
        taken += &format!(", dampers {:.1} J", energies.restraints.dampers);
    }
    format!(
        "input {:.1} J, dashpots {:.1} J, impacts {:.1} J{taken}; residual {residual:.1e} of the largest",
        energies.input, energies.dashpots, energies.impacts
    )
}

/// Writes the summary as text.
fn summary(run: &Run, history: &History, excitation: &str, demand: Option<(f64, f64)>, with_events: bool) -> String {
    let block = &run.block;
    let History { events, peaks, counts, ending, .. } = history;
    let weight = block.mass * block.gravity;
    let last = history.rows.last().map_or(0.0, |row| row.time);
    let end = match ending {
        Some((ending @ Ending::Separated, time)) => {
            format!("{ending} at t = {time:.4} s; --on-separation fly follows the block")
        }
        Some((ending, time)) => format!("{ending} at t = {time:.4} s"),
        None => format!("{} at t = {last:.4} s: {}", history.end, prospect(run, history)),
    };
    let Holds { dampers, .. } = Holds::of(block);
    let mut text = String::new();
    let mut line = |name: &str, value: String| text.push_str(&format!("{name:13} {value}\n"));
    line("excitation", excitation.into());
    line("block", format!("{}, M = {} kg", rocking_charts::history::block_line(block), block.mass));
    line("end", end);
    line(
        "peak",
        format!(
            "|θ|/α = {:.4}, uplift {:.1} mm, N = {:.3} M g, |H| = {:.3} M g",
            peaks.theta / block.alpha,
            1e3 * peaks.uplift,
            peaks.reaction / weight,
            peaks.horizontal / weight
        ),
    );
    if let Some(balance) = balance(block, history) {
        line("balance", balance);
    }
    if block.friction > 0.0 {
        let (peak, slip) = (1e3 * peaks.slip, history.slip);
        line(
            "slip",
            format!("{:.1} mm at the end, at most {peak:.1} mm, {:.1} mm in all", 1e3 * slip.now, 1e3 * slip.total),
        );
    }
    for (number, (name, tie)) in link_names(block).iter().zip(block.ties()).enumerate() {
        let (force, plastic) = (peaks.pull[number], 1e3 * peaks.plastic[number]);
        let mut of_link = format!("{} of at most {force:.4e} N", tie.kind.force());
        if tie.yields() {
            let lost = history.yield_works[number];
            of_link += &format!(", plastic elongation of at most {plastic:.2} mm, {lost:.1} J lost by yielding");
        }
        let broken = if history.ties[number] == TieState::Broken { "; it broke" } else { "" };
        line(name, of_link + broken);
    }
    if let Breaks { count, first: Some(time) } = history.breaks() {
        let [one, several] = if dampers == 0 { ["tie", "ties"] } else { ["tie or damper", "ties and dampers"] };
        let broke = if count == 1 { format!("1 {one} broke,") } else { format!("{count} {several} broke, the first") };
        line(if dampers == 0 { "ties" } else { "breaks" }, format!("{broke} at t = {time:.4} s"));
    }
    if let Some((demand, time)) = demand {
        line("friction", format!("|H|/(N_L + N_R) exceeds {demand} for at most {time:.4} s at a time"));
    }
    let last_event = events.last().map(|event| format!(", the last at t = {:.4} s", event.time));
    let so_far = if ending.is_some() || history.is_at_rest { "" } else { " so far" };
    line(
        "events",
        format!("{} impacts, {} lift-offs{so_far}{}", counts.impacts, counts.liftoffs, last_event.unwrap_or_default()),
    );
    line("energy", energy(block, history));
    line("steps", format!("{} ({} repeated), {} evaluations", counts.steps, counts.rejected, counts.evaluations));
    if with_events {
        for event in events {
            line("", event.to_string());
        }
    }
    text
}
