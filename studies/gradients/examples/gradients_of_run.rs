//! One run with derivatives, whose instructions `scripts/dev/instructions --gradients` counts:
//! `gradients_of_run (sine | record | rigid-sine | rigid-record) COUNT`, where COUNT is the number of parameters; 0 is the run alone.

use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::simulation::{Initial, Settings, Simulation};
use rocking_gradients::{BATCH, Follower, Parameters, Varied, advance};
use rocking_records::ReadOptions;

const RECORD: &[u8] = include_bytes!("../../../examples/records/np01002p_4225a_a.smc");

/// Steps from stop to stop of the ground motion. Never inlined, since callgrind counts inside it.
#[inline(never)]
fn counted(simulation: &mut Simulation, followers: &mut [Follower], ground: &Ground, end: f64) {
    while simulation.time() < end && simulation.ending().is_none() {
        let (inputs, until) = ground.inputs_from(simulation.time());
        let until = until.min(end);
        if followers.is_empty() {
            simulation.advance(until, &inputs, &mut |_| ()).expect("the case runs");
        } else {
            advance(simulation, followers, until, &inputs).expect("the case runs");
        }
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let case = arguments.next().unwrap_or_default();
    let count: usize = arguments.next().map_or(0, |text| text.parse().expect("a number of parameters"));
    let sine = Pulse { shape: PulseShape::OneSine, amplitude: 4.0, period: 1.2566, ..Pulse::NONE };
    let record = || {
        let record = rocking_records::parse("record", RECORD, &ReadOptions::default()).expect("a record");
        Ground { horizontal: Some(record), vertical: None }
    };
    let damped = |xi_v| Supports::Viscoelastic(Ratios { eta: 40.0, xi_v });
    let (alpha, p, supports, pulse, ground, end) = match case.as_str() {
        "sine" => (0.25, 1.0, damped(0.1), sine, Ground::default(), 10.0),
        "record" => (0.15, 2.0, damped(0.2), Pulse::NONE, record(), 40.0),
        "rigid-sine" => (0.25, 1.0, Supports::HOUSNER, sine, Ground::default(), 10.0),
        "rigid-record" => (0.15, 2.0, Supports::HOUSNER, Pulse::NONE, record().scaled(4.0), 40.0),
        other => panic!("case \"{other}\"; expected sine, record, rigid-sine or rigid-record"),
    };
    let (dimensionless, common) = (Dimensionless { alpha, p, supports }, Common::default());
    let block = Block::from_dimensionless(&dimensionless, &common).expect("a block");
    let initial = Initial::default();
    let scale = ground.horizontal.is_some().then_some(1.0);
    let parameters = Parameters { block: dimensionless.with(&common), ties: Vec::new(), initial, pulse, scale };
    let names = parameters.names();
    let names: Vec<&str> = names.iter().map(String::as_str).filter(|name| !name.starts_with("initial")).collect();
    let (inputs, _) = ground.inputs_from(0.0);
    let mut simulation = Simulation::new(block, Settings::default(), pulse, &initial, 0.0, &inputs);
    let mut followers: Vec<Follower> = names[..count]
        .chunks(BATCH)
        .map(|names| Varied::with_respect_to(&parameters, &block, names).expect("parameters of the run"))
        .map(|varied| Follower::new(&simulation, varied, &inputs))
        .collect();
    counted(&mut simulation, &mut followers, &ground, end);
    let counts = simulation.counts();
    let sum: f64 = followers.iter().flat_map(|follower| follower.pose().state[0].eps).sum();
    println!("{} {} {} {sum:e}", simulation.time(), counts.evaluations, counts.impacts);
}
