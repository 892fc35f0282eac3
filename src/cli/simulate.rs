//! `rocking simulate`: options → a run → a table, a picture and a summary.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Parser, ValueEnum};

use crate::block::{Block, Common, Dimensionless, Foundation, Physical};
use crate::cli::excitation::{Excitation, Motion, finite};
use crate::cli::formats::{PictureOptions, check_table};
use crate::cli::input;
use crate::cli::output::{Named, Pending, check_distinct};
use crate::cli::progress::Progress;
use crate::cli::report::{ReportOptions, Written};
use crate::cli::run_options::{AtLiftOff, AtSeparation};
use crate::cli::summary::Summary;
use crate::records::{self, ReadOptions, Record};
use crate::simulation::{Ending, Initial, Settings};
use crate::study::history::{History, Run};
use crate::study::picture::PictureFormat;
use crate::study::{plot, table};

/// The record that is run when none is named: U.S. Geological Survey, public domain.
const EMBEDDED: (&str, &[u8]) = ("np01002p_4225a_a.smc", include_bytes!("../../records/np01002p_4225a_a.smc"));

/// Options of `rocking simulate`.
#[derive(Parser)]
pub struct Options {
    #[command(flatten, next_help_heading = "Excitation (without any, an embedded record)")]
    excitation: Excitation,
    #[command(flatten)]
    block: BlockOptions,
    #[command(flatten)]
    beginning: Beginning,
    /// Relative tolerance of the integration
    #[arg(long, default_value_t = 1e-8, value_name = "TOL", help_heading = "Run")]
    tolerance: f64,
    /// What stays the same when a corner lifts from full contact
    #[arg(long, value_enum, default_value_t = AtLiftOff::KeepRates, help_heading = "Run")]
    lift_off: AtLiftOff,
    /// What happens at complete separation
    #[arg(long, value_enum, default_value_t = AtSeparation::Terminate, help_heading = "Run")]
    on_separation: AtSeparation,
    /// Duration; without it the run goes on until the ground has come to rest and the block has come down [s]
    #[arg(long, value_name = "S", help_heading = "Run")]
    duration: Option<f64>,
    /// Time between rows of the table; without it the record's time step or 0.01 [s]
    #[arg(long, value_name = "S", help_heading = "Run")]
    step: Option<f64>,
    /// Table of the history; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
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
#[command(next_help_heading = "Block")]
struct BlockOptions {
    /// Slenderness angle alpha [rad]; 0.25, for the embedded record 0.15
    #[arg(long, value_name = "RAD", conflicts_with_all = ["width", "height", "stiffness", "damping"])]
    alpha: Option<f64>,
    /// Frequency parameter p [rad/s]; 1, for the embedded record 2
    #[arg(long, value_name = "RAD/S", conflicts_with_all = ["width", "height", "stiffness", "damping"])]
    p: Option<f64>,
    /// Stiffness ratio eta = omega_v/p; 40
    #[arg(long, conflicts_with_all = ["width", "height", "stiffness", "damping"])]
    eta: Option<f64>,
    /// Vertical damping ratio xi_v; 0.1, for the embedded record 0.2
    #[arg(long, conflicts_with_all = ["width", "height", "stiffness", "damping"])]
    xi_v: Option<f64>,
    /// Width of the base, instead of alpha, p, eta, xi_v: all four sizes together [m]
    #[arg(long, value_name = "M", requires_all = ["height", "stiffness", "damping"])]
    width: Option<f64>,
    /// Twice the height of the centre of mass over the base [m]
    #[arg(long, value_name = "M", requires = "width")]
    height: Option<f64>,
    /// Stiffness K of one support [N/m]
    #[arg(long, value_name = "N/M", requires = "width")]
    stiffness: Option<f64>,
    /// Damping C of one support [N.s/m]
    #[arg(long, value_name = "N.S/M", requires = "width")]
    damping: Option<f64>,
    /// Mass M [kg]
    #[arg(long, value_name = "KG", default_value_t = Common::default().mass)]
    mass: f64,
    /// Shape factor gamma = M R0²/I0
    #[arg(long, default_value_t = Common::default().gamma)]
    gamma: f64,
    /// Restitution epsilon of the landing corner, 0 to 1
    #[arg(long, default_value_t = Common::default().epsilon)]
    epsilon: f64,
    /// Gravity, also for records in g [m/s2]
    #[arg(long, value_name = "M/S2", default_value_t = Common::default().gravity)]
    g: f64,
    /// What the block stands on
    #[arg(long, value_enum, default_value_t = Base::Viscoelastic)]
    foundation: Base,
    /// On the rigid base, restitution e over Housner's e of epsilon; their product is at most 1
    #[arg(long, value_name = "FACTOR")]
    restitution_factor: Option<f64>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Base {
    /// A spring and a dashpot under each corner
    Viscoelastic,
    /// Housner's rigid base
    Rigid,
}

#[derive(Args)]
#[command(next_help_heading = "Beginning")]
struct Beginning {
    /// Rotation at the start, positive to the right [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.0, allow_negative_numbers = true)]
    theta: f64,
    /// Rate of rotation at the start [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 0.0, allow_negative_numbers = true)]
    theta_dot: f64,
    /// Height of the centre of mass over its place at rest, instead of the vertical equilibrium [m]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    v: Option<f64>,
    /// Vertical velocity at the start, instead of the vertical equilibrium [m/s]
    #[arg(long, value_name = "M/S", allow_negative_numbers = true)]
    v_dot: Option<f64>,
}

/// Does what the options say.
pub fn run(options: &Options) -> anyhow::Result<()> {
    let format = options.picture.format()?.unwrap_or(PictureFormat::Png);
    options.csv.as_deref().map_or(Ok(()), check_table)?;
    let (run, source) = options.run()?;
    let (csv, plot) = options.places()?;
    let named = [("--csv", &csv), ("--plot", &plot)];
    let named: Vec<_> = named.iter().filter_map(|(option, path)| Some(Named::new(option, path.as_deref()?))).collect();
    check_distinct(&input::of_records(&options.excitation.accelerograms), &named)?;
    let csv_file = csv.as_deref().map(Pending::new).transpose()?;
    let picture_file = plot.as_deref().map(Pending::new).transpose()?;

    const PARTS: u64 = 1000;
    let mut bar = Progress::new(PARTS, 0);
    let history = run.history(|part| bar.show((part * PARTS as f64) as u64))?;
    bar.clear();

    let mut files = Vec::new();
    if let Some(file) = csv_file {
        let mut bytes = Vec::new();
        table::write(&history, &mut bytes).context("the table cannot be made")?;
        files.push((file, bytes));
    }
    if let Some(file) = picture_file {
        let svg = plot::history(&run.block, &history, &source)?;
        files.push((file, format.encode(&svg)?));
    }
    Pending::write(files)?;
    if options.quiet {
        return Ok(());
    }
    let written = Written::new([("csv", csv.as_deref()), ("plot", plot.as_deref())]);
    let text = summary(&run, &history, &source, options.events) + &written.lines();
    let warnings =
        options.is_embedded().then(|| format!("no excitation was named: the embedded {} was run", EMBEDDED.0));
    let json = Summary::new(&run, &history, &source, options.events);
    options.report.print("simulate", &written, warnings.as_slice(), &text, &json)
}

impl Options {
    /// Where the results go: `out/rocking.csv` and `out/rocking.png` unless the options say otherwise.
    fn places(&self) -> anyhow::Result<(Option<PathBuf>, Option<PathBuf>)> {
        if self.csv.is_some() || self.picture.plot.is_some() {
            return Ok((self.csv.clone(), self.picture.plot.clone()));
        }
        let folder = Path::new("out");
        std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
        Ok((Some(folder.join("rocking.csv")), Some(folder.join("rocking.png"))))
    }

    fn is_embedded(&self) -> bool {
        let Beginning { theta, theta_dot, v, v_dot } = &self.beginning;
        let at_rest = *theta == 0.0 && *theta_dot == 0.0 && v.is_none() && v_dot.is_none();
        self.excitation.is_empty() && at_rest
    }

    /// The run, and what excites it.
    fn run(&self) -> anyhow::Result<(Run, String)> {
        let block = self.block()?;
        let Motion { ground, pulse, mut source } = self.excitation.read(self.block.g, self.embedded()?)?;
        if source.is_empty() {
            source = "free motion".into();
        }
        finite("theta", self.beginning.theta, |x| x.abs() < 1.57, "a rotation within ±1.57 rad")?;
        finite("theta-dot", self.beginning.theta_dot, |_| true, "a finite rate")?;
        finite("tolerance", self.tolerance, |x| x > 0.0, "a number > 0")?;
        let Beginning { theta, theta_dot, v, v_dot } = self.beginning;
        let vertical = (v.is_some() || v_dot.is_some()).then_some((v.unwrap_or_default(), v_dot.unwrap_or_default()));
        for value in vertical.iter().flat_map(|(v, v_dot)| [v, v_dot]) {
            finite("v and v-dot", *value, |_| true, "finite numbers")?;
        }
        let output_step = self.step.or(ground.time_step()).unwrap_or(0.01);
        finite("step", output_step, |x| x > 0.0, "a time > 0 s")?;
        if let Some(duration) = self.duration {
            finite("duration", duration, |x| x > 0.0, "a time > 0 s")?;
        }
        let settings = Settings {
            tolerance: self.tolerance,
            lift_off: self.lift_off.into(),
            on_separation: self.on_separation.into(),
            ..Settings::default()
        };
        let initial = Initial { theta, theta_dot, vertical };
        let run = Run { block, settings, initial, pulse, ground, duration: self.duration, output_step };
        let duration = run.longest_duration();
        let rows = duration / output_step;
        anyhow::ensure!(
            rows < 1e8,
            "{duration} s in steps of {output_step} s are {rows:.0} rows; expected fewer than 1e8"
        );
        Ok((run, source))
    }

    /// The record that is run when none is named.
    fn embedded(&self) -> anyhow::Result<Option<Record>> {
        if !self.is_embedded() {
            return Ok(None);
        }
        let (name, bytes) = EMBEDDED;
        let options = ReadOptions { gravity: self.block.g, ..ReadOptions::default() };
        Ok(Some(records::parse(name, bytes, &options)?))
    }

    fn block(&self) -> anyhow::Result<Block> {
        let BlockOptions { mass, gamma, epsilon, g, foundation, restitution_factor, .. } = self.block;
        let foundation = match (foundation, restitution_factor) {
            (Base::Viscoelastic, None) => Foundation::Viscoelastic,
            (Base::Viscoelastic, Some(factor)) => anyhow::bail!(
                "--restitution-factor {factor} has no effect on viscoelastic supports; expected --foundation rigid with it"
            ),
            (Base::Rigid, _) => Foundation::Rigid,
        };
        let restitution_factor = restitution_factor.unwrap_or(1.0);
        let common = Common { mass, gamma, epsilon, gravity: g, foundation, restitution_factor };
        let BlockOptions { width, height, stiffness, damping, .. } = self.block;
        if let (Some(width), Some(height), Some(stiffness), Some(damping)) = (width, height, stiffness, damping) {
            return Ok(Block::from_physical(&Physical { width, height, stiffness, damping }, &common)?);
        }
        // A slender block of the size of a statue for the embedded record, the paper's block otherwise.
        let (alpha, p, xi_v) = if self.is_embedded() { (0.15, 2.0, 0.2) } else { (0.25, 1.0, 0.1) };
        let BlockOptions { alpha: given_alpha, p: given_p, eta, xi_v: given_xi_v, .. } = self.block;
        let dimensionless = Dimensionless {
            alpha: given_alpha.unwrap_or(alpha),
            p: given_p.unwrap_or(p),
            eta: eta.unwrap_or(40.0),
            xi_v: given_xi_v.unwrap_or(xi_v),
        };
        Ok(Block::from_dimensionless(&dimensionless, &common)?)
    }
}

/// What happened, for a person.
fn summary(run: &Run, history: &History, source: &str, with_events: bool) -> String {
    let block = &run.block;
    let History { events, peaks, counts, ending, .. } = history;
    let weight = block.mass * block.gravity;
    let last = history.rows.last().map_or(0.0, |row| row.time);
    let end = match ending {
        Some((ending @ Ending::Separated, time)) => {
            format!("{ending} at t = {time:.4} s; --on-separation fly follows the block")
        }
        Some((ending, time)) => format!("{ending} at t = {time:.4} s"),
        None if history.has_come_down => format!("completed at t = {last:.4} s: the block stands"),
        None => format!("completed at t = {last:.4} s, before the block has come down"),
    };
    let energies = history.rows.last().map(|row| row.energies).unwrap_or_default();
    let largest = history.greatest_energy();
    let residual = if largest > 0.0 { history.greatest_residual() / largest } else { 0.0 };
    let mut text = String::new();
    let mut line = |name: &str, value: String| text.push_str(&format!("{name:13} {value}\n"));
    line("excitation", source.into());
    line("block", plot::block_line(block));
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
    let last_event = events.last().map(|event| format!(", the last at t = {:.4} s", event.time));
    line(
        "events",
        format!("{} impacts, {} lift-offs{}", counts.impacts, counts.liftoffs, last_event.unwrap_or_default()),
    );
    line(
        "energy",
        format!(
            "input {:.1} J, dashpots {:.1} J, impacts {:.1} J; residual {residual:.1e} of the largest",
            energies.input, energies.dashpots, energies.impacts
        ),
    );
    line("steps", format!("{} ({} repeated), {} evaluations", counts.steps, counts.rejected, counts.evaluations));
    if with_events {
        for event in events {
            line("", event.to_string());
        }
    }
    text
}
