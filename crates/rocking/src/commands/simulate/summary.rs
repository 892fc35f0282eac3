//! A run → its summary as JSON.

use serde::Serialize;

use super::gradients::{GradientSummary, GrazingSummary, summaries};

use rocking_block::block::restraints::{LinkKind, Tie, TieState};
use rocking_block::block::{Block, Corner, Ratios};
use rocking_block::simulation::Energies;
use rocking_block::system::events::Event;
use rocking_studies::run::gradients::Gradients;
use rocking_studies::run::outcome::End;
use rocking_studies::run::{History, Run};
use rocking_studies::spec::words::Words;

/// Summary of a run in SI units; names are those of the tables and of the FMU's variables.
#[derive(Serialize)]
pub struct Summary<'a> {
    excitation: &'a str,
    block: Parameters,
    /// `completed`, `overturned`, `separated` or `undecided`.
    outcome: &'static str,
    end_time: f64,
    /// Whether the block is at rest or bound to come to rest.
    has_come_down: bool,
    /// Whether the block is at rest.
    is_at_rest: bool,
    /// Whether |θ| exceeded the balance angle of its side.
    passed_balance: bool,
    /// Whether the block rests without standing upright.
    ends_tilted: bool,
    /// Rotation at the end.
    #[serde(rename = "end.theta/alpha")]
    end_theta_over_alpha: f64,
    /// Only with `--tie`.
    #[serde(skip_serializing_if = "Option::is_none")]
    ties_broken: Option<u32>,
    /// Only if a tie broke.
    #[serde(skip_serializing_if = "Option::is_none")]
    first_break: Option<f64>,
    peak: PeakValues,
    /// Only with `--friction-demand`.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction_demand: Option<FrictionDemand>,
    /// Only with `--friction`.
    #[serde(skip_serializing_if = "Option::is_none")]
    slip: Option<SlipSummary>,
    /// Only with `--tie`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ties: Vec<TieSummary>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    dampers: Vec<DamperSummary>,
    /// Only with `--gradients`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    gradients: Vec<GradientSummary<'a>>,
    /// Only with `--gradients`, where an event grazes.
    #[serde(skip_serializing_if = "Option::is_none")]
    grazing: Option<GrazingSummary>,
    events: Events,
    /// At the end of the run.
    energy: Energy,
    steps: Steps,
}

/// Parameters of a block.
#[derive(Serialize)]
pub struct Parameters {
    foundation: &'static str,
    alpha: f64,
    p: f64,
    /// Only of supports.
    #[serde(flatten)]
    ratios: Option<Ratios>,
    /// Only of a rigid base.
    #[serde(skip_serializing_if = "Option::is_none")]
    e: Option<f64>,
    epsilon: f64,
    #[serde(rename = "R0")]
    r0: f64,
    width: f64,
    height: f64,
    mass: f64,
    gamma: f64,
    g: f64,
    /// Only of uneven blocks.
    #[serde(flatten)]
    sides: Option<Sides>,
    /// Only with a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ties: Vec<NamedTie>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    dampers: Vec<NamedTie>,
}

/// An eccentric centre of mass.
#[derive(Serialize)]
struct Sides {
    eccentricity: f64,
    #[serde(rename = "alpha_L")]
    alpha_left: f64,
    #[serde(rename = "alpha_R")]
    alpha_right: f64,
}

/// A tie or a damper by the names of its numbers.
struct NamedTie(Tie);

impl Serialize for NamedTie {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // An elastic tie has no numbers of yielding.
        let is_shown = |(name, _): &(&str, f64)| self.0.yields() || !matches!(*name, "yield_force" | "hardening");
        serializer.collect_map(self.0.named().filter(is_shown))
    }
}

#[derive(Serialize)]
struct PeakValues {
    theta: f64,
    #[serde(rename = "theta/alpha")]
    theta_over_alpha: f64,
    #[serde(rename = "theta/balance")]
    theta_over_balance: f64,
    uplift: f64,
    #[serde(rename = "N")]
    reaction: f64,
    #[serde(rename = "H")]
    horizontal: f64,
    friction_demand: f64,
}

#[derive(Serialize)]
struct FrictionDemand {
    coefficient: f64,
    longest_time_above: f64,
}

#[derive(Serialize)]
struct SlipSummary {
    /// At the end of the run.
    now: f64,
    total: f64,
    peak: f64,
}

#[derive(Serialize)]
struct TieSummary {
    peak_tension: f64,
    /// Only of a tie that yields.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    yielding: Option<YieldSummary>,
    broken: bool,
}

#[derive(Serialize)]
struct DamperSummary {
    peak_force: f64,
    #[serde(flatten)]
    yielding: YieldSummary,
    broken: bool,
}

#[derive(Serialize)]
struct YieldSummary {
    peak_plastic: f64,
    /// Energy lost by yielding.
    yield_energy: f64,
}

#[derive(Serialize)]
struct Events {
    impacts: u32,
    liftoffs: u32,
    last_time: Option<f64>,
    /// Only with `--events`.
    #[serde(skip_serializing_if = "Option::is_none")]
    list: Option<Vec<EventSummary>>,
}

#[derive(Serialize)]
struct EventSummary {
    t: f64,
    event: &'static str,
    corner: Option<&'static str>,
    before: String,
    after: String,
}

#[derive(Serialize)]
struct Energy {
    #[serde(flatten)]
    energies: Energies,
    /// Greatest values of the run.
    greatest_total: f64,
    greatest_residual: f64,
}

#[derive(Serialize)]
struct Steps {
    accepted: u64,
    rejected: u64,
    evaluations: u64,
}

impl<'a> Summary<'a> {
    /// Summarizes a run; `demand` is a coefficient of friction with the longest time above it (s).
    pub fn new(
        run: &Run,
        history: &History,
        gradients: &'a Gradients,
        excitation: &'a str,
        demand: Option<(f64, f64)>,
        with_events: bool,
    ) -> Summary<'a> {
        let History { rows, events, peaks, counts, ending, end, is_at_rest, slip, ties, yield_works, lean } = history;
        let breaks = history.breaks();
        let last = rows.last();
        let of_kind = |kind| {
            let links = run.block.ties().iter().enumerate();
            links.filter(move |(_, tie)| tie.kind == kind).map(|(number, tie)| (number, tie.yields()))
        };
        let yielding =
            |number: usize| YieldSummary { peak_plastic: peaks.plastic[number], yield_energy: yield_works[number] };
        let is_broken = |number: usize| ties[number] == TieState::Broken;
        Summary {
            excitation,
            block: Parameters::of(&run.block),
            outcome: end.word(),
            end_time: ending.map_or(last.map_or(0.0, |row| row.time), |(_, time)| time),
            has_come_down: *end == End::Completed,
            is_at_rest: *is_at_rest,
            passed_balance: lean.passed_balance(),
            ends_tilted: history.ends_tilted(&run.block),
            end_theta_over_alpha: lean.end / run.block.alpha,
            ties_broken: (!run.block.ties().is_empty()).then_some(breaks.count),
            first_break: breaks.first,
            peak: PeakValues {
                theta: peaks.theta,
                theta_over_alpha: peaks.theta / run.block.alpha,
                theta_over_balance: lean.over_balance,
                uplift: peaks.uplift,
                reaction: peaks.reaction,
                horizontal: peaks.horizontal,
                friction_demand: peaks.friction_demand,
            },
            friction_demand: demand
                .map(|(coefficient, longest_time_above)| FrictionDemand { coefficient, longest_time_above }),
            slip: (run.block.friction > 0.0).then_some(SlipSummary {
                now: slip.now,
                total: slip.total,
                peak: peaks.slip,
            }),
            ties: of_kind(LinkKind::Tie)
                .map(|(number, yields)| TieSummary {
                    peak_tension: peaks.pull[number],
                    yielding: yields.then(|| yielding(number)),
                    broken: is_broken(number),
                })
                .collect(),
            dampers: of_kind(LinkKind::Damper)
                .map(|(number, _)| DamperSummary {
                    peak_force: peaks.pull[number],
                    yielding: yielding(number),
                    broken: is_broken(number),
                })
                .collect(),
            gradients: summaries(gradients),
            grazing: gradients.grazing.as_ref().map(GrazingSummary::of),
            events: Events {
                impacts: counts.impacts,
                liftoffs: counts.liftoffs,
                last_time: events.last().map(|event| event.time),
                list: with_events.then(|| events.iter().map(EventSummary::of).collect()),
            },
            energy: Energy {
                energies: last.map(|row| row.energies).unwrap_or_default(),
                greatest_total: history.greatest_energy(),
                greatest_residual: history.greatest_residual(),
            },
            steps: Steps { accepted: counts.steps, rejected: counts.rejected, evaluations: counts.evaluations },
        }
    }
}

impl Parameters {
    /// Returns the parameters of a block.
    pub fn of(block: &Block) -> Parameters {
        let ratios = block.ratios().viscoelastic();
        let named = |kind| block.ties().iter().copied().filter(|tie| tie.kind == kind).map(NamedTie).collect();
        Parameters {
            foundation: block.foundation.word(),
            alpha: block.alpha,
            p: block.p,
            ratios,
            e: ratios.is_none().then(|| block.restitution()),
            r0: block.r0,
            width: 2.0 * block.b,
            height: 2.0 * block.h,
            epsilon: block.epsilon,
            mass: block.mass,
            gamma: block.gamma,
            g: block.gravity,
            sides: (block.eccentricity != 0.0).then(|| Sides {
                eccentricity: block.eccentricity,
                alpha_left: block.alpha_of(Corner::Left),
                alpha_right: block.alpha_of(Corner::Right),
            }),
            friction: (block.friction > 0.0).then_some(block.friction),
            ties: named(LinkKind::Tie),
            dampers: named(LinkKind::Damper),
        }
    }
}

impl EventSummary {
    fn of(event: &Event) -> EventSummary {
        let (name, corner) = (event.kind.word(), event.kind.location());
        let (before, after) = (event.before.to_string(), event.after.to_string());
        EventSummary { t: event.time, event: name, corner, before, after }
    }
}
