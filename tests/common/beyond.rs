//! The cases of tests/reference_more: blocks with friction, ties and an eccentric centre of mass; and of tests/reference_links: blocks with
//! ties and dampers that yield.

use std::path::{Path, PathBuf};

use rocking_block::block::restraints::{LinkKind, Tie, tie};
use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use serde::Deserialize;

use crate::common::Motion;

/// A case of a file cases.json.
#[derive(Debug, Deserialize)]
pub struct Case {
    pub name: String,
    pub alpha: f64,
    pub p: f64,
    pub eta: f64,
    pub xi_v: f64,
    pub epsilon: f64,
    pub dt: f64,
    #[serde(default)]
    pub friction: f64,
    #[serde(default)]
    pub eccentricity: f64,
    #[serde(default)]
    pub ties: Vec<TieCase>,
    /// Ties and dampers that may yield, instead of ties.
    #[serde(default)]
    pub links: Vec<TieCase>,
    pub a_gx: Motion,
    pub g: f64,
    #[serde(rename = "M")]
    pub mass: f64,
    pub events: Vec<(f64, Change)>,
}

/// A tie, per kilogram of the block.
#[derive(Debug, Deserialize)]
pub struct TieCase {
    pub block: [f64; 2],
    pub ground: [f64; 2],
    pub stiffness: f64,
    #[serde(default)]
    pub pretension: f64,
    #[serde(default)]
    pub slack: f64,
    #[serde(default)]
    pub damping: f64,
    #[serde(default)]
    pub strength: f64,
    #[serde(default)]
    pub kind: String,
    #[serde(default)]
    pub yield_force: f64,
    #[serde(default)]
    pub hardening: f64,
}

/// A change: the regime and the direction in which the foot slides after it, or the tie that becomes taut or slack, or breaks.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged)]
pub enum Change {
    Regime { regime: i32, slip: i32 },
    Tie(String),
}

/// A row of a trajectory.
#[derive(Debug, Deserialize)]
pub struct Row {
    pub theta: f64,
    pub theta_dot: f64,
    pub v: f64,
    pub u: f64,
    #[serde(rename = "N_L")]
    pub n_l: f64,
    #[serde(rename = "N_R")]
    pub n_r: f64,
    #[serde(rename = "H")]
    pub h: f64,
    pub tension_1: Option<f64>,
    pub tension_2: Option<f64>,
    pub plastic_1: Option<f64>,
    pub plastic_2: Option<f64>,
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name)
}

impl Case {
    pub fn block(&self) -> Block {
        let common = Common {
            mass: self.mass,
            epsilon: self.epsilon,
            gravity: self.g,
            eccentricity: self.eccentricity,
            friction: self.friction,
            ..Common::default()
        };
        let Case { alpha, p, eta, xi_v, mass, .. } = *self;
        let link = |case: &TieCase| Tie {
            block: case.block,
            ground: case.ground,
            stiffness: mass * case.stiffness,
            pretension: mass * case.pretension,
            slack: case.slack,
            damping: mass * case.damping,
            strength: mass * case.strength,
            yield_force: mass * case.yield_force,
            hardening: case.hardening,
            kind: if case.kind == "damper" { LinkKind::Damper } else { LinkKind::Tie },
        };
        let links: Vec<Tie> = self.ties.iter().chain(&self.links).map(link).collect();
        Block::from_dimensionless(
            &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
            &common,
        )
        .unwrap()
        .with_ties(&links)
        .unwrap()
    }
}

/// Returns all cases with elastic ties.
pub fn cases() -> Vec<Case> {
    cases_in("reference_more")
}

/// Returns all cases with ties and dampers that yield.
pub fn cases_with_links() -> Vec<Case> {
    cases_in("reference_links")
}

fn cases_in(name: &str) -> Vec<Case> {
    let text = std::fs::read_to_string(folder(name).join("cases.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

impl Case {
    /// Returns the values of the FMU's parameters.
    pub fn parameters(&self) -> Vec<(String, f64)> {
        let (block, pulse) = (self.block(), self.a_gx.pulse());
        let mut values: Vec<(String, f64)> = [
            ("dimensionless.alpha", self.alpha),
            ("dimensionless.p", self.p),
            ("dimensionless.eta", self.eta),
            ("dimensionless.xi_v", self.xi_v),
            ("mass", self.mass),
            ("epsilon", self.epsilon),
            ("g", self.g),
            ("eccentricity", self.eccentricity),
            ("friction", self.friction),
            ("pulse.shape", f64::from(pulse.shape as i32)),
            ("pulse.amplitude", pulse.amplitude),
            ("pulse.period", pulse.period),
        ]
        .map(|(name, value)| (name.to_string(), value))
        .into();
        for (link, tie) in tie::names(block.ties()).into_iter().zip(block.ties()) {
            values.extend(tie.named().map(|(name, value)| (format!("{link}.{name}"), value)));
        }
        values
    }

    pub fn rows(&self) -> Vec<Row> {
        let name = if self.links.is_empty() { "reference_more" } else { "reference_links" };
        let path = folder(name).join(format!("{}.csv", self.name));
        csv::Reader::from_path(path).unwrap().deserialize().map(|row| row.unwrap()).collect()
    }

    /// Returns the changes without slides of less than a nanosecond: without a limit of friction a foot that a landing leaves in motion
    /// is stopped within the reference's smallest steps, and here at once.
    pub fn lasting_events(&self) -> Vec<(f64, Change)> {
        let events = &self.events;
        let lasts = |i: usize| events.get(i + 1).is_none_or(|(next, _)| next - events[i].0 > 1e-9);
        (0..events.len()).filter(|&i| lasts(i)).map(|i| events[i].clone()).collect()
    }
}

/// Longest pause of a yielding link (s) that trajectories leave unresolved.
///
/// A landing that leaves a yielding link with a rate ṡ against its flow unloads it, and with the acceleration s̈ it yields again after
/// `Δ = 2 ṡ/s̈`, as soon as the elastic excursion `s̈ Δ²/8` is used up. For s̈ of g and this Δ, that is 3e-11 m, the error of the
/// reference: 2e-11 α R0. The reference yields again after 1e-14 s.
const PAUSE: f64 = 5e-6;

/// The time at which a link unloads (s), and its number, if it yields again within [`PAUSE`].
pub type Pause = (f64, Change);

/// Returns the changes of links instant by instant (s), each with the last regime first and the links in order; and the pauses, which
/// are left out there.
///
/// Changes within a nanosecond belong to one instant, in which their order depends on the solver.
/// A limp tie whose spring is loose, which the reference calls slack, is no event here: it stopped pulling when it became limp.
pub fn instants(events: &[(f64, Change)]) -> (Vec<(f64, Vec<Change>)>, Vec<Pause>) {
    let link = |change: &Change, word: &str| match change {
        Change::Tie(name) => name.strip_prefix(word).map(str::to_string),
        Change::Regime { .. } => None,
    };
    let (mut lasting, mut pauses) = (Vec::<(f64, Change)>::new(), Vec::new());
    for (time, change) in events.iter().filter(|(_, change)| link(change, "slack").is_none()) {
        let unloaded = link(change, "yield").and_then(|number| {
            let unloads = |(at, earlier): &(f64, Change)| {
                time - at < PAUSE && link(earlier, "unload").is_some_and(|earlier| earlier == number)
            };
            lasting.iter().rposition(unloads)
        });
        match unloaded {
            Some(unloaded) => pauses.push(lasting.remove(unloaded)),
            None => lasting.push((*time, change.clone())),
        }
    }
    let by_instant = lasting.chunk_by(|(before, _), (after, _)| after - before < 1e-9).map(|instant| {
        let (regimes, mut links): (Vec<Change>, Vec<Change>) = instant
            .iter()
            .map(|(_, change)| change.clone())
            .partition(|change| matches!(change, Change::Regime { .. }));
        links.sort_by_key(|change| format!("{change:?}"));
        (instant[0].0, regimes.into_iter().next_back().into_iter().chain(links).collect())
    });
    (by_instant.collect(), pauses)
}
