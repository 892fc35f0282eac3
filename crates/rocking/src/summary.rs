//! A run → its summary as JSON.

use serde::Serialize;

use rocking_block::block::{Block, Foundation};
use rocking_block::simulation::Energies;
use rocking_block::system::events::Event;
use rocking_block::words::Words;
use rocking_studies::run::outcome::End;
use rocking_studies::run::{History, Run};

/// Summary of a run in SI units, with the names of the tables and of the FMU's variables.
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
    peak: PeakValues,
    /// Only with `--friction`.
    #[serde(skip_serializing_if = "Option::is_none")]
    friction: Option<Friction>,
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
    /// Only supports have η and ξ_v; only a rigid base has e.
    #[serde(skip_serializing_if = "Option::is_none")]
    eta: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    xi_v: Option<f64>,
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
}

#[derive(Serialize)]
struct PeakValues {
    theta: f64,
    #[serde(rename = "theta/alpha")]
    theta_over_alpha: f64,
    uplift: f64,
    #[serde(rename = "N")]
    reaction: f64,
    #[serde(rename = "H")]
    horizontal: f64,
    friction_demand: f64,
}

#[derive(Serialize)]
struct Friction {
    coefficient: f64,
    longest_time_above: f64,
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
    /// Summarizes a run; `sliding` is a coefficient of friction with the longest time above it (s).
    pub fn new(
        run: &Run,
        history: &History,
        excitation: &'a str,
        sliding: Option<(f64, f64)>,
        with_events: bool,
    ) -> Summary<'a> {
        let History { rows, events, peaks, counts, ending, end, is_at_rest } = history;
        let last = rows.last();
        Summary {
            excitation,
            block: Parameters::of(&run.block),
            outcome: end.word(),
            end_time: ending.map_or(last.map_or(0.0, |row| row.time), |(_, time)| time),
            has_come_down: *end == End::Completed,
            is_at_rest: *is_at_rest,
            peak: PeakValues {
                theta: peaks.theta,
                theta_over_alpha: peaks.theta / run.block.alpha,
                uplift: peaks.uplift,
                reaction: peaks.reaction,
                horizontal: peaks.horizontal,
                friction_demand: peaks.friction_demand,
            },
            friction: sliding.map(|(coefficient, longest_time_above)| Friction { coefficient, longest_time_above }),
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
        let (eta, xi_v, e) = match block.foundation {
            Foundation::Viscoelastic => (Some(block.eta()), Some(block.xi_v), None),
            Foundation::Rigid => (None, None, Some(block.restitution())),
        };
        Parameters {
            foundation: block.foundation.word(),
            alpha: block.alpha,
            p: block.p,
            eta,
            xi_v,
            e,
            r0: block.r0,
            width: 2.0 * block.b,
            height: 2.0 * block.h,
            epsilon: block.epsilon,
            mass: block.mass,
            gamma: block.gamma,
            g: block.gravity,
        }
    }
}

impl EventSummary {
    fn of(event: &Event) -> EventSummary {
        let (name, corner) = (event.kind.word(), event.kind.place());
        let (before, after) = (event.before.to_string(), event.after.to_string());
        EventSummary { t: event.time, event: name, corner, before, after }
    }
}
