//! `rocking simulate` of a block in space: options → a run → a table, a picture and a summary.

use clap::Args;

use super::{SimulateCommand, summary};
use crate::options::block::in_options;
use crate::options::excitation::SecondComponentOptions;
use crate::options::explicit::ExplicitOptions;
use crate::options::in_space;
use crate::output::files::Outputs;
use crate::output::progress::Progress;
use crate::output::summary::{Object, Summary};
use rocking_block::run::{Ending, OnSeparation};
use rocking_block::space::{SpaceBody, SpaceEvent, SpaceInitial};
use rocking_charts::history_in_space::history as picture;
use rocking_charts::picture::PictureFormat;
use rocking_charts::plan::plan;
use rocking_studies::run::outcome::End;
use rocking_studies::space::{HistoryInSpace, RunInSpace, facts, foot_names, table};
use rocking_studies::spec::SpaceSpec;
use rocking_studies::spec::numbers_in_space::BeginningSpec;

/// Options of a block in space.
#[derive(Args)]
pub struct SpaceOptions {
    #[command(flatten)]
    block: SpaceSpec,
    #[command(flatten)]
    second: SecondComponentOptions,
    /// Initial component of the tilt towards +x [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.0)]
    tilt_x: f64,
    /// Initial component of the tilt towards +y [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.0)]
    tilt_y: f64,
    /// Initial twist about the vertical, before the tilt [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.0)]
    twist: f64,
    /// Initial angular velocity about x [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 0.0)]
    omega_x: f64,
    /// Initial angular velocity about y [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 0.0)]
    omega_y: f64,
    /// Initial angular velocity about the vertical [rad/s]
    #[arg(long, value_name = "RAD/S", default_value_t = 0.0)]
    omega_z: f64,
}

/// Options of an initial state in space.
pub const INITIAL: [&str; 6] = ["tilt-x", "tilt-y", "twist", "omega-x", "omega-y", "omega-z"];

/// Options that have an effect in space only, beside those of the block.
const OF_SPACE: [&str; 3] = ["record-y", "azimuth", "plot-plan"];

/// Options of the plane only, beside those of the block, and what is expected instead.
const OF_PLANE: [(&str, &str); 5] = [
    ("theta", "expected --tilt-x"),
    ("theta-dot", "expected --omega-y"),
    ("friction-demand", "in space --csv has the column friction_demand"),
    ("gradients", "expected it without --depth, --base and --feet"),
    ("plot-loops", "expected it without --depth, --base and --feet"),
];

impl SpaceOptions {
    /// Whether the block is one in space. Otherwise options without effect are refused.
    pub fn make_space(&self, explicit: &ExplicitOptions) -> anyhow::Result<bool> {
        in_space::makes_space(&self.block, explicit, &[&OF_SPACE[..], &INITIAL].concat())
    }
}

/// Runs the command.
pub fn run(options: &SimulateCommand, explicit: &ExplicitOptions) -> anyhow::Result<()> {
    in_space::refuse_of_plane(explicit, &OF_PLANE)?;
    explicit.refuse_unless(!options.quiet, &["events"], "with --quiet")?;
    let format = options.picture.format()?;
    let plan_format = options.plot_plan.as_deref().map(PictureFormat::of).transpose()?;
    options.csv.as_deref().map_or(Ok(()), crate::output::formats::check_table)?;
    let (run, excitation) = options.run_in_space(explicit)?;
    run.check_memory()?;
    let (csv, plot) = options.outputs()?;
    let inputs =
        [options.excitation.accelerograms.named(), options.space.second.named().into_iter().collect()].concat();
    let mut outputs = Outputs::checked(
        &inputs,
        [("csv", csv.as_deref()), ("plot", plot.as_deref()), ("plot-plan", options.plot_plan.as_deref())],
    )?;

    const PARTS: u64 = 1000;
    let bar = Progress::new(PARTS, 0);
    let history = run.history(|part| bar.show((part * PARTS as f64) as u64))?;
    bar.clear();

    outputs.fill_table("csv", || Ok(table::table(&run.parameters, &history, 0..history.rows.len())))?;
    outputs.fill("plot", || Ok(format.encode(&picture(&run, &history, &excitation)?)?))?;
    if let Some(format) = plan_format {
        outputs.fill("plot-plan", || Ok(format.encode(&plan(&run, &history, &excitation)?)?))?;
    }
    let written = outputs.write()?;
    if options.quiet {
        return Ok(());
    }
    let summary = summary_of(&run, &history, &excitation, options.events);
    let text = summary.text + &written.lines();
    options.report.print("simulate", &written, options.warnings(explicit).as_slice(), &text, &summary.json)
}

impl SimulateCommand {
    /// Returns the run in space and a description of its excitation.
    fn run_in_space(&self, explicit: &ExplicitOptions) -> anyhow::Result<(RunInSpace, String)> {
        let space = &self.space;
        let (parameters, body) = in_space::block(&space.block, &self.block)?;
        let initial = self.initial_in_space()?;
        let embedded = self.embedded(explicit)?;
        let excitation = space.second.read(&self.excitation, explicit, parameters.gravity, embedded)?;
        let settings = self.single_run.settings(self.on_separation.unwrap_or(OnSeparation::Fly)).map_err(in_options)?;
        let time_step = excitation.ground.records.iter().flatten().map(|record| record.time_step).reduce(f64::min);
        let description = match excitation.description.as_str() {
            "" => "free motion".into(),
            text => text.into(),
        };
        let run = RunInSpace {
            initial,
            ground: excitation.ground,
            duration: self.single_run.duration,
            output_step: self.single_run.step_of(time_step),
            ..RunInSpace::at_rest(parameters, body, settings).with_pulse(excitation.pulse, space.second.azimuth)
        };
        Ok((run, description))
    }

    fn initial_in_space(&self) -> anyhow::Result<SpaceInitial> {
        let SpaceOptions { tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, .. } = self.space;
        let [tilt_x, tilt_y, twist] = [tilt_x, tilt_y, twist].map(Some);
        let [omega_x, omega_y, omega_z] = [omega_x, omega_y, omega_z].map(Some);
        let (v, v_dot) = self.initial.vertical()?.unzip();
        let beginning = BeginningSpec { tilt_x, tilt_y, twist, omega_x, omega_y, omega_z, v, v_dot };
        beginning.initial().map_err(in_options)
    }
}

/// Summarizes a run; names are those of the tables.
fn summary_of(run: &RunInSpace, history: &HistoryInSpace, excitation: &str, with_events: bool) -> Summary {
    let (body, counts) = (&run.setup.body, &history.counts);
    let mut summary = Summary::default();
    summary.entry("model", "block in space");
    summary.item("excitation", excitation, "excitation", excitation);
    summary::add_block_in_space(&mut summary, &run.parameters, body);
    add_end(&mut summary, run, history);
    add_peaks(&mut summary, body, history);
    add_events(&mut summary, run, history, with_events);
    let energies = history.rows.last().map(|row| row.energies).unwrap_or_default();
    let (total, residual) = (history.greatest_energy(), history.greatest_residual());
    let relative = if total > 0.0 { residual / total } else { 0.0 };
    let of_energy = [
        ("total", energies.stored.total()),
        ("kinetic", energies.stored.kinetic),
        ("input", energies.input),
        ("dashpots", energies.dashpots),
        ("slip", energies.slip),
        ("lift_off", energies.lift_off),
        ("residual", energies.residual),
        ("greatest_total", total),
        ("greatest_residual", residual),
    ];
    summary.item(
        "energy",
        of_energy.into_iter().collect::<Object>(),
        "energy",
        format!(
            "input {:.1} J, dashpots {:.1} J, slip {:.1} J, lift-offs {:.1} J; residual {relative:.1e} of the largest",
            energies.input, energies.dashpots, energies.slip, energies.lift_off
        ),
    );
    summary::add_steps(&mut summary, [counts.steps, counts.rejected, counts.evaluations]);
    if with_events {
        let names = foot_names(&run.parameters);
        for event in &history.events {
            let (word, foot) = facts::word(event.kind);
            let foot = foot.map(|foot| format!(" of foot {}", names[foot])).unwrap_or_default();
            summary.line("", format!("{:.9} s  {word}{foot}", event.time));
        }
    }
    summary
}

/// Adds how the run ended.
fn add_end(summary: &mut Summary, run: &RunInSpace, history: &HistoryInSpace) {
    let last = history.rows.last().map_or(0.0, |row| row.observation.time);
    let end = history.end;
    let text = match history.ending {
        Some((ending @ Ending::Separated, time)) => {
            format!("{ending} at t = {time:.4} s; --on-separation fly follows the block")
        }
        Some((ending, time)) => format!("{ending} at t = {time:.4} s"),
        None => format!("{end} at t = {last:.4} s: {}", prospect(run, history)),
    };
    summary.item("outcome", end.word(), "end", text);
    summary.entry("end_time", history.ending.map_or(last, |(_, time)| time));
    summary.entry("has_come_down", end == End::Completed);
    summary.entry("is_at_rest", history.is_at_rest);
    summary.entry("separated", history.separated);
}

/// Predicts the future of a block that did not end its run.
fn prospect(run: &RunInSpace, history: &HistoryInSpace) -> &'static str {
    match (history.end, run.duration) {
        (End::Completed, _) if history.is_at_rest => "the block is at rest",
        (End::Completed, _) => "the block will come to rest",
        (_, Some(_)) => "the duration is too short to tell whether the block overturns",
        (_, None) => "the block may still overturn",
    }
}

/// Adds the greatest values, and where the block stands at the end.
fn add_peaks(summary: &mut Summary, body: &SpaceBody, history: &HistoryInSpace) {
    let (peaks, weight) = (&history.peaks, body.mass * body.gravity);
    summary.item(
        "peak",
        facts::of_peaks(peaks).into_iter().collect::<Object>(),
        "peak",
        format!(
            "θ/α = {:.4} in the direction of the lean, twist {:.2}°, uplift {:.1} mm, N of a foot {:.3} M g",
            peaks.tilt_over_critical,
            peaks.twist().to_degrees(),
            1e3 * peaks.uplift,
            peaks.normal / weight
        ),
    );
    let Some(last) = history.rows.last() else { return };
    let ([x, y], attitude) = (last.observation.drift, last.observation.attitude);
    summary.item(
        "end",
        Object::from([
            ("tilt/alpha", last.tilt_over_critical),
            ("twist", attitude.twist),
            ("drift_x", x),
            ("drift_y", y),
        ]),
        "slip",
        format!(
            "{:.1} mm of a foot in all; the middle of the base is at ({:.1}, {:.1}) mm, twisted by {:.2}°, at the end",
            1e3 * peaks.slip,
            1e3 * x,
            1e3 * y,
            attitude.twist.to_degrees()
        ),
    );
}

/// Adds the number of events, and their list in JSON.
fn add_events(summary: &mut Summary, run: &RunInSpace, history: &HistoryInSpace, with_list: bool) {
    let HistoryInSpace { events, counts, .. } = history;
    let last = events.last().map(|event| event.time);
    let names = foot_names(&run.parameters);
    let event = |event: &SpaceEvent| {
        let (word, foot) = facts::word(event.kind);
        Object::default().with("t", event.time).with("event", word).with("foot", foot.map(|foot| names[foot].as_str()))
    };
    let at = last.map(|time| format!(", the last at t = {time:.4} s")).unwrap_or_default();
    summary.item(
        "events",
        Object::from([
            ("lift_offs", counts.lift_offs),
            ("landings", counts.landings),
            ("slides", counts.slides),
            ("sticks", counts.sticks),
        ])
        .with("last_time", last)
        .with_some("list", with_list.then(|| events.iter().map(event).collect::<Vec<_>>())),
        "events",
        format!(
            "{} lift-offs, {} landings, {} slides, {} sticks{at}",
            counts.lift_offs, counts.landings, counts.slides, counts.sticks
        ),
    );
}
