//! `rocking simulate`: options → a run → a table, a picture and a summary.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`summary`] | a run → its summary |
//! | `gradients` | derivatives of a run → entries of its summary |
//! | `space` | options of a block in space → a run, and its outputs |

mod gradients;
mod space;

pub mod summary;

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Parser};

use crate::options::accelerograms::of_one_motion;
use crate::options::block;
use crate::options::checks::check;
use crate::options::excitation::{Excitation, ExcitationOptions};
use crate::options::explicit::ExplicitOptions;
use crate::options::single_run;
use crate::output::files::Outputs;
use crate::output::formats::{PictureOptions, check_table};
use crate::output::progress::Progress;
use crate::output::report::ReportOptions;
use rocking_block::block::Foundation;
use rocking_block::simulation::{Initial, OnSeparation};
use rocking_charts::loops;
use rocking_charts::picture::PictureFormat;
use rocking_gradients::Parameters;
use rocking_records::{ReadOptions, Record};
use rocking_studies::run::gradients::Gradients;
use rocking_studies::run::table;
use rocking_studies::run::{History, Run};
use rocking_studies::spec::run::separations;
use rocking_studies::spec::{BlockSpec, RunSpec, SingleRunSpec, limits};
use space::SpaceOptions;

/// Default record: U.S. Geological Survey, public domain.
const EMBEDDED: (&str, &[u8]) = ("np01002p_4225a_a.smc", include_bytes!("../../../records/np01002p_4225a_a.smc"));

/// Options of `rocking simulate`.
#[derive(Parser)]
#[command(mut_args(of_one_motion))]
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
    space: SpaceOptions,
    #[command(flatten)]
    single_run: SingleRunSpec,
    /// Action at complete separation [default: terminate; fly in space]
    #[arg(long, value_parser = separations(), help_heading = "Run")]
    on_separation: Option<OnSeparation>,
    /// Table of the history; `-` for standard output
    #[arg(long, value_name = "FILE.csv", help_heading = "Results")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureOptions,
    /// Picture of the forces of dampers, and of ties that yield, over their elongations, SVG or PNG by its extension
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    plot_loops: Option<PathBuf>,
    /// Picture from above of the paths of base and centre of mass of a block in space, SVG or PNG by its extension
    #[arg(long, value_name = "FILE", help_heading = "Results")]
    plot_plan: Option<PathBuf>,
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
    if options.space.make_space(explicit)? {
        return space::run(options, explicit);
    }
    options.refuse_without_effect(explicit)?;
    let format = options.picture.format()?;
    options.csv.as_deref().map_or(Ok(()), check_table)?;
    let loops_format = options.plot_loops.as_deref().map(PictureFormat::of).transpose()?;
    let (run, excitation) = options.run(explicit)?;
    let has_loops = !loops::numbers(&run.block).is_empty();
    explicit.refuse_unless(has_loops, &["plot-loops"], "without --damper, or a yield_force in --tie")?;
    let (csv, plot) = options.outputs()?;
    let outputs = [("csv", csv.as_deref()), ("plot", plot.as_deref()), ("plot-loops", options.plot_loops.as_deref())];
    let mut outputs = Outputs::checked(&options.excitation.accelerograms.named(), outputs)?;

    const PARTS: u64 = 1000;
    let bar = Progress::new(PARTS, 0);
    let progress = |part| bar.show((part * PARTS as f64) as u64);
    let (history, derivatives) = options.history(&run, progress)?;
    bar.clear();

    outputs
        .fill_table("csv", || Ok(table::table(&run.block, &history, &derivatives.parameters, 0..history.rows.len())))?;
    outputs
        .fill("plot", || Ok(format.encode(&rocking_charts::history::history(&run.block, &history, &excitation)?)?))?;
    if let Some(format) = loops_format {
        outputs.fill("plot-loops", || Ok(format.encode(&loops::loops(&run.block, &history, &excitation)?)?))?;
    }
    let written = outputs.write()?;
    if options.quiet {
        return Ok(());
    }
    let demand = options.friction_demand.map(|demand| (demand, run.longest_above(demand)));
    let warnings = options.warnings(explicit);
    let summary = summary::of(&run, &history, &derivatives, &excitation, demand, options.events);
    options.report.print("simulate", &written, warnings.as_slice(), &(summary.text + &written.lines()), &summary.json)
}

impl InitialOptions {
    /// Returns the height of the centre of mass above rest and its rate, if one of them is given.
    fn vertical(&self) -> anyhow::Result<Option<(f64, f64)>> {
        let InitialOptions { v, v_dot, .. } = *self;
        for value in [v, v_dot].into_iter().flatten() {
            check("v and v-dot", value, |_| true, "finite numbers")?;
        }
        Ok((v.is_some() || v_dot.is_some()).then_some((v.unwrap_or_default(), v_dot.unwrap_or_default())))
    }
}

impl SimulateCommand {
    /// Returns the warning of a run under the embedded record.
    fn warnings(&self, explicit: &ExplicitOptions) -> Option<String> {
        is_embedded(explicit).then(|| format!("no excitation given: the embedded record {} was used", EMBEDDED.0))
    }

    /// Returns table and picture; by default `out/rocking.csv` and `out/rocking.png`.
    fn outputs(&self) -> anyhow::Result<(Option<PathBuf>, Option<PathBuf>)> {
        if self.csv.is_some() || self.picture.plot.is_some() || self.plot_loops.is_some() || self.plot_plan.is_some() {
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
        let parameters = Parameters {
            block: self.block.parameters().map_err(block::in_options)?,
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
        explicit.refuse_unless(!self.quiet, &["events", "friction-demand"], "with --quiet")
    }

    /// Returns the run and a description of its excitation.
    fn run(&self, explicit: &ExplicitOptions) -> anyhow::Result<(Run, String)> {
        let block = block::block(&self.block)?;
        let embedded = self.embedded(explicit)?;
        let Excitation { mut motions, pulse, mut description } =
            self.excitation.read(explicit, self.block.gravity(), embedded)?;
        let (_, ground) = motions.swap_remove(0);
        if description.is_empty() {
            description = "free motion".into();
        }
        let InitialOptions { theta, theta_dot, .. } = self.initial;
        check("theta-dot", theta_dot, |_| true, "a finite rate")?;
        limits::check::<RunSpec>(&[("friction_demand", self.friction_demand)]).map_err(block::in_options)?;
        let initial = Initial { theta, theta_dot, vertical: self.initial.vertical()? };
        let on_separation = self.on_separation.unwrap_or(OnSeparation::Terminate);
        let run = single_run::run(&self.single_run, block, on_separation, initial, pulse, ground)?;
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
    const OPTIONS: [&str; 8] = ["record", "record-y", "vertical", "pulse", "theta", "theta-dot", "v", "v-dot"];
    !OPTIONS.iter().chain(&space::INITIAL).any(|option| explicit.has(option))
}
