//! The cases of tests/reference_more: blocks with friction, ties and an eccentric centre of mass.

use std::path::{Path, PathBuf};

use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use serde::Deserialize;

use crate::common::Motion;

/// A case of tests/reference_more/cases.json.
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
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference_more")
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
        Block::from_dimensionless(
            &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
            &common,
        )
        .unwrap()
        .with_ties(&ties)
        .unwrap()
    }
}

/// Returns all cases.
pub fn cases() -> Vec<Case> {
    let text = std::fs::read_to_string(folder().join("cases.json")).unwrap();
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
        for (i, tie) in (1..).zip(block.ties()) {
            let Tie { block, ground, stiffness, pretension, slack, damping, strength } = *tie;
            values.extend(
                [
                    ("block_x", block[0]),
                    ("block_z", block[1]),
                    ("ground_x", ground[0]),
                    ("ground_z", ground[1]),
                    ("stiffness", stiffness),
                    ("pretension", pretension),
                    ("slack", slack),
                    ("damping", damping),
                    ("strength", strength),
                ]
                .map(|(name, value)| (format!("tie_{i}.{name}"), value)),
            );
        }
        values
    }

    pub fn rows(&self) -> Vec<Row> {
        let path = folder().join(format!("{}.csv", self.name));
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
