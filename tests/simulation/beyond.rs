//! Friction, ties and an eccentric centre of mass, beside independent trajectories.

use std::path::{Path, PathBuf};

use rocking_block::block::{Block, Common, Dimensionless};
use rocking_block::simulation::{Initial, Progress, Settings, Simulation};
use serde::Deserialize;

use crate::common::{Motion, Record, inputs_at, record_named};
use crate::skipped::skip;

/// A case of tests/reference_more/cases.json.
#[derive(Debug, Deserialize)]
struct Case {
    name: String,
    alpha: f64,
    p: f64,
    eta: f64,
    xi_v: f64,
    epsilon: f64,
    t_end: f64,
    dt: f64,
    #[serde(default)]
    friction: f64,
    #[serde(default)]
    eccentricity: f64,
    a_gx: Motion,
    g: f64,
    #[serde(rename = "M")]
    mass: f64,
    events: Vec<(f64, Change)>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Change {
    Regime { regime: i32, slip: i32 },
    Tie(String),
}

#[derive(Debug, Deserialize)]
struct Row {
    t: f64,
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
        let Case { alpha, p, eta, xi_v, .. } = *self;
        Block::from_dimensionless(&Dimensionless { alpha, p, eta, xi_v }, &common).unwrap()
    }
}

/// Returns the greatest differences from a trajectory.
fn run(case: &Case) -> Result<[f64; 5], String> {
    let records: [Option<Record>; 2] = [record_named(&case.a_gx, case.g)?, None];
    let settings = Settings { tolerance: 1e-10, ..Settings::default() };
    let block = case.block();
    let (mut simulation, mut events) = (
        Simulation::new(block, settings, case.a_gx.pulse(), &Initial::default(), 0.0, &inputs_at(&records, 0)),
        vec![],
    );
    let path = folder().join(format!("{}.csv", case.name));
    let rows: Vec<Row> = csv::Reader::from_path(path).unwrap().deserialize().map(|row| row.unwrap()).collect();
    let step = records[0].as_ref().map_or(case.dt, |record| record.dt);
    let per_row = (case.dt / step).round() as usize;
    let mut greatest = [0.0_f64; 5];
    for (i, row) in rows.iter().enumerate().skip(1) {
        for sample in (i - 1) * per_row..i * per_row {
            let until = (sample + 1) as f64 * step;
            let inputs = inputs_at(&records, sample);
            let progress = simulation.advance(until, &inputs, &mut |event| events.push(*event)).unwrap();
            assert_eq!(progress, Progress::Reached, "{}", case.name);
        }
        let seen = simulation.observe(&inputs_at(&records, i * per_row - 1));
        let weight = case.mass * case.g;
        let differences = [
            (seen.theta - row.theta) / case.alpha,
            (seen.v - row.v) / block.r0,
            (seen.u - row.u) / block.r0,
            (seen.reaction[0] - row.n_l).abs().max((seen.reaction[1] - row.n_r).abs()) / weight,
            (seen.horizontal - row.h) / weight,
        ];
        for (greatest, difference) in greatest.iter_mut().zip(differences) {
            *greatest = greatest.max(difference.abs());
        }
    }
    println!("{}: {greatest:?}, residual {:e}", case.name, simulation.energies().residual);
    Ok(greatest)
}

#[test]
fn trajectories() {
    let text = std::fs::read_to_string(folder().join("cases.json")).unwrap();
    let cases: Vec<Case> = serde_json::from_str(&text).unwrap();
    for case in cases {
        match run(&case) {
            Ok(_) => {}
            Err(record) => skip(&format!("reference case {}: its record {record} may not be redistributed", case.name)),
        }
    }
}
