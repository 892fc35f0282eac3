//! Friction, ties and an eccentric centre of mass, beside independent trajectories.

mod friction;
mod random;
mod ties;

use std::path::{Path, PathBuf};

use rocking_block::block::{Block, Common, Dimensionless, Tie};
use rocking_block::simulation::{Initial, Progress, Settings, Simulation};
use rocking_block::system::dynamics::Footing;
use rocking_block::system::events::EventKind;
use serde::Deserialize;

use crate::common::{Motion, Record, inputs_at, record_named};
use crate::skipped::skip;

/// Differences of θ from the trajectory, as a part of α, and of event times (s).
const CLOSE: f64 = 1e-7;

/// A case of tests/reference_more/cases.json.
#[derive(Debug, Deserialize)]
struct Case {
    name: String,
    alpha: f64,
    p: f64,
    eta: f64,
    xi_v: f64,
    epsilon: f64,
    dt: f64,
    #[serde(default)]
    friction: f64,
    #[serde(default)]
    eccentricity: f64,
    #[serde(default)]
    ties: Vec<TieCase>,
    a_gx: Motion,
    g: f64,
    #[serde(rename = "M")]
    mass: f64,
    events: Vec<(f64, Change)>,
}

/// A tie, per kilogram of the block.
#[derive(Debug, Deserialize)]
struct TieCase {
    block: [f64; 2],
    ground: [f64; 2],
    stiffness: f64,
    #[serde(default)]
    pretension: f64,
    #[serde(default)]
    slack: f64,
    #[serde(default)]
    damping: f64,
    #[serde(default)]
    strength: f64,
}

/// A change: the regime and the direction in which the foot slides after it, or the tie that becomes taut or slack, or breaks.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged)]
enum Change {
    Regime { regime: i32, slip: i32 },
    Tie(String),
}

/// A row of a trajectory.
#[derive(Debug, Deserialize)]
struct Row {
    theta: f64,
    theta_dot: f64,
    v: f64,
    u: f64,
    #[serde(rename = "N_L")]
    n_l: f64,
    #[serde(rename = "N_R")]
    n_r: f64,
    #[serde(rename = "H")]
    h: f64,
    tension_1: Option<f64>,
    tension_2: Option<f64>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference_more")
}

impl Case {
    fn block(&self) -> Block {
        let common = Common {
            mass: self.mass,
            epsilon: self.epsilon,
            gravity: self.g,
            eccentricity: self.eccentricity,
            friction: self.friction,
            ..Common::default()
        };
        let Case { alpha, p, eta, xi_v, mass, .. } = *self;
        let ties: Vec<Tie> = self
            .ties
            .iter()
            .map(|tie| Tie {
                block: tie.block,
                ground: tie.ground,
                stiffness: mass * tie.stiffness,
                pretension: mass * tie.pretension,
                slack: tie.slack,
                damping: mass * tie.damping,
                strength: mass * tie.strength,
            })
            .collect();
        Block::from_dimensionless(&Dimensionless { alpha, p, eta, xi_v }, &common).unwrap().with_ties(&ties).unwrap()
    }
}

fn slips(simulation: &Simulation) -> i32 {
    match simulation.footing() {
        Footing::Slides { direction, .. } => direction as i32,
        Footing::Grips { .. } | Footing::Free { .. } => 0,
    }
}

/// Compares a run with its trajectory: the messages of what differs.
fn run(case: &Case) -> Result<Vec<String>, String> {
    let records: [Option<Record>; 2] = [record_named(&case.a_gx, case.g)?, None];
    let settings = Settings { tolerance: 1e-10, ..Settings::default() };
    let block = case.block();
    let pulse = case.a_gx.pulse();
    let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs_at(&records, 0));
    let path = folder().join(format!("{}.csv", case.name));
    let rows: Vec<Row> = csv::Reader::from_path(path).unwrap().deserialize().map(|row| row.unwrap()).collect();
    let step = records[0].as_ref().map_or(case.dt, |record| record.dt);
    let per_row = (case.dt / step).round() as usize;
    let mut greatest = [0.0_f64; 7];
    let mut events: Vec<(f64, Change)> = vec![];
    for (i, row) in rows.iter().enumerate() {
        for sample in (i * per_row).saturating_sub(per_row)..i * per_row {
            let until = (sample + 1) as f64 * step;
            let inputs = inputs_at(&records, sample);
            while simulation.time() < until || simulation.is_at_event() {
                let mut changes = vec![];
                simulation
                    .settle(&inputs, &mut |event| {
                        changes.push(match event.kind {
                            EventKind::Taut(tie) | EventKind::Slack(tie) => Some(format!("tie{tie}")),
                            EventKind::Break(tie) => Some(format!("break{tie}")),
                            _ => None,
                        });
                    })
                    .unwrap();
                let state = Change::Regime { regime: simulation.regime().number(), slip: slips(&simulation) };
                for tie in changes {
                    events.push((simulation.time(), tie.map_or(state.clone(), Change::Tie)));
                }
                let after = simulation.time();
                let progress = simulation.advance_to_event(until, after, &inputs, &mut |_| ()).unwrap();
                assert!(matches!(progress, Some(Progress::Reached) | None), "{}: {progress:?}", case.name);
            }
        }
        let seen = simulation.observe(&inputs_at(&records, (i * per_row).saturating_sub(1)));
        let weight = case.mass * case.g;
        let differences = [
            (seen.theta - row.theta) / case.alpha,
            (seen.theta_dot - row.theta_dot) / (case.alpha * case.p),
            (seen.v - row.v) / block.r0,
            (seen.u - row.u) / block.r0,
            (seen.reaction[0] - row.n_l).abs().max((seen.reaction[1] - row.n_r).abs()) / weight,
            (seen.horizontal - row.h) / weight,
            (seen.tension[0] - row.tension_1.unwrap_or(0.0))
                .abs()
                .max((seen.tension[1] - row.tension_2.unwrap_or(0.0)).abs())
                / weight,
        ];
        for (greatest, difference) in greatest.iter_mut().zip(differences) {
            *greatest = greatest.max(difference.abs());
        }
    }
    let (name, residual) = (&case.name, simulation.energies().residual);
    println!("{name}: θ, θ̇, v, u, N, H, T within {greatest:?}, residual {residual:.1e} J");
    let mut wrong = vec![];
    // The reactions and θ̇ of a row may be those right before or after an event in it.
    for (of, found, most) in [("θ", greatest[0], CLOSE), ("v", greatest[2], CLOSE), ("u", greatest[3], CLOSE)] {
        if !(found <= most) {
            wrong.push(format!("{name}: {of} differs by {found:e}"));
        }
    }
    let expected = without_moments(&case.events);
    for (i, (found, expected)) in events.iter().zip(&expected).enumerate() {
        if found.1 != expected.1 || (found.0 - expected.0).abs() > CLOSE {
            wrong.push(format!("{name}: event {i} is {found:?}, not {expected:?}"));
            break;
        }
    }
    if events.len() != expected.len() {
        wrong.push(format!("{name}: {} events, not {}", events.len(), expected.len()));
    }
    Ok(wrong)
}

/// Returns the changes without slides of less than a nanosecond: without a limit of friction a foot that a landing leaves in motion is
/// stopped within the reference's smallest steps, and here at once.
fn without_moments(events: &[(f64, Change)]) -> Vec<(f64, Change)> {
    let lasts = |i: usize| events.get(i + 1).is_none_or(|(next, _)| next - events[i].0 > 1e-9);
    (0..events.len()).filter(|&i| lasts(i)).map(|i| events[i].clone()).collect()
}

/// θ and the places within 1e-7 of α and of R0, with the same events within 1e-7 s.
#[test]
fn trajectories() {
    let text = std::fs::read_to_string(folder().join("cases.json")).unwrap();
    let cases: Vec<Case> = serde_json::from_str(&text).unwrap();
    let mut wrong = vec![];
    for case in cases {
        match run(&case) {
            Ok(differences) => wrong.extend(differences),
            Err(record) => skip(&format!(
                "reference case {}: its record {record} may not be redistributed and is not at hand",
                case.name
            )),
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
