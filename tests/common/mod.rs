//! The reference cases of tests/reference: definitions, excitations and trajectories.

use std::path::{Path, PathBuf};

use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::{Initial, Settings, Simulation};
use rocking_records::{ReadOptions, Unit};
use serde::Deserialize;

/// A case of cases.json.
#[derive(Debug, Deserialize)]
pub struct Case {
    pub name: String,
    alpha: f64,
    #[serde(default = "one")]
    p: f64,
    #[serde(default = "one")]
    eta: f64,
    #[serde(default)]
    xi_v: f64,
    #[serde(default)]
    epsilon: f64,
    #[serde(default = "three")]
    gamma: f64,
    #[serde(default = "one", rename = "M")]
    mass: f64,
    foundation: Option<String>,
    g: f64,
    #[serde(default)]
    pub a_gx: Motion,
    #[serde(default)]
    pub a_gz: Motion,
    #[serde(default)]
    initial: InitialCase,
    pub t_end: f64,
    pub dt: f64,
    pub end: String,
    pub t_final: f64,
    pub events: Vec<(f64, i32, serde_json::Value)>,
}

#[derive(Debug, Default, Deserialize)]
pub struct Motion {
    kind: Option<String>,
    #[serde(default)]
    a_p: f64,
    #[serde(default)]
    omega_p: f64,
    pub record: Option<String>,
    #[serde(default)]
    scale: f64,
}

#[derive(Debug, Default, Deserialize)]
struct InitialCase {
    theta: Option<f64>,
    theta_dot: Option<f64>,
}

fn one() -> f64 {
    1.0
}

fn three() -> f64 {
    3.0
}

/// A row of a trajectory.
#[derive(Debug, Deserialize)]
pub struct Row {
    pub t: f64,
    pub theta: f64,
    pub theta_dot: f64,
    pub v: f64,
    pub v_dot: f64,
    #[serde(rename = "N_L")]
    pub n_l: f64,
    #[serde(rename = "N_R")]
    pub n_r: f64,
    #[serde(rename = "H")]
    pub h: f64,
    pub regime: i32,
    pub energy: f64,
}

/// A ground acceleration with evenly spaced samples, zero after the last.
#[derive(Debug, Clone)]
pub struct Record {
    pub dt: f64,
    pub acceleration: Vec<f64>,
}

impl Record {
    /// Returns the ramp from a sample on.
    fn ramp(&self, sample: usize) -> Ramp {
        let at = |i: usize| self.acceleration.get(i).copied().unwrap_or(0.0);
        if sample + 1 < self.acceleration.len() {
            Ramp { value: at(sample), rate: (at(sample + 1) - at(sample)) / self.dt }
        } else {
            Ramp::held(0.0)
        }
    }
}

pub fn reference_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference")
}

/// Returns all cases.
pub fn cases() -> Vec<Case> {
    let text = std::fs::read_to_string(reference_folder().join("cases.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

impl Motion {
    pub fn pulse(&self) -> Pulse {
        let shape = match self.kind.as_deref() {
            Some("sine") => PulseShape::OneSine,
            Some("cosine") => PulseShape::OneCosine,
            _ => return Pulse::NONE,
        };
        Pulse { shape, amplitude: self.a_p, period: std::f64::consts::TAU / self.omega_p, start: 0.0, ..Pulse::NONE }
    }
}

/// Returns the record of a motion, or its name if it is missing.
pub fn record_named(motion: &Motion, gravity: f64) -> Result<Option<Record>, String> {
    let Some(name) = &motion.record else { return Ok(None) };
    let (file, dt) = match name.as_str() {
        "rinaldi" => ("paper/NGA_no_1063_RRS228.AT2", None),
        "erzincan" => ("paper_derived/ERZ-NS_unrotated.AT2", None),
        "sylmar052" => ("paper/SCS052.AT2", Some(0.005)),
        "sylmar142" => ("paper/SCS142.AT2", Some(0.005)),
        "sylmar_up" => ("paper/SCSUP.AT2", Some(0.005)),
        "elcentro" => ("fallback/IELC180.AT2", None),
        other => panic!("unknown record {other}"),
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/records").join(file);
    if !path.exists() {
        return Err(name.clone());
    }
    let unit = dt.map(|_| Unit::G);
    let options = ReadOptions { unit, time_step: dt, gravity, ..ReadOptions::default() };
    let record = rocking_records::read(&path, &options).unwrap().scaled(motion.scale);
    Ok(Some(Record { dt: record.time_step, acceleration: record.acceleration.to_vec() }))
}

impl Case {
    pub fn block(&self) -> Block {
        let foundation =
            if self.foundation.as_deref() == Some("rigid") { Foundation::Rigid } else { Foundation::Viscoelastic };
        Block::from_dimensionless(
            &Dimensionless {
                alpha: self.alpha,
                p: self.p,
                supports: Supports::of(foundation, Ratios { eta: self.eta, xi_v: self.xi_v }),
            },
            &Common { mass: self.mass, gamma: self.gamma, epsilon: self.epsilon, gravity: self.g, ..Common::default() },
        )
        .unwrap()
    }

    pub fn pulse(&self) -> Pulse {
        self.a_gx.pulse()
    }

    pub fn initial(&self) -> Initial {
        let InitialCase { theta, theta_dot } = self.initial;
        Initial {
            theta: theta.unwrap_or(0.0),
            theta_dot: theta_dot.unwrap_or(0.0),
            vertical: if theta.is_some() { None } else { Some((0.0, 0.0)) },
        }
    }

    pub fn rows(&self) -> Vec<Row> {
        let path = reference_folder().join(format!("{}.csv", self.name));
        csv::Reader::from_path(path).unwrap().deserialize().map(|row| row.unwrap()).collect()
    }

    /// Returns the records, or the name of a missing one.
    pub fn records(&self) -> Result<[Option<Record>; 2], String> {
        Ok([record_named(&self.a_gx, self.g)?, record_named(&self.a_gz, self.g)?])
    }

    /// Returns a run at its start.
    pub fn start(&self, tolerance: f64, records: &[Option<Record>; 2]) -> Simulation {
        let settings = Settings { tolerance, ..Settings::default() };
        Simulation::new(self.block(), settings, self.pulse(), &self.initial(), 0.0, &inputs_at(records, 0))
    }
}

/// Returns the inputs from a sample of the records on.
pub fn inputs_at(records: &[Option<Record>; 2], sample: usize) -> Inputs {
    let dt = record_step(records).unwrap_or(0.0);
    let ramp = |record: &Option<Record>| record.as_ref().map_or(Ramp::default(), |record| record.ramp(sample));
    Inputs { time: sample as f64 * dt, a_gx: ramp(&records[0]), a_gz: ramp(&records[1]), ..Inputs::default() }
}

/// Returns the time step of the records, if any.
pub fn record_step(records: &[Option<Record>; 2]) -> Option<f64> {
    records.iter().flatten().map(|record| record.dt).next()
}
