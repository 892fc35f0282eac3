//! One run of a case, whose instructions `scripts/instructions` counts:
//! `one_run (sine | record | flight | reference RECORD) [TOLERANCE]`.
//!
//! `reference` runs the block of most cases of tests/reference under a record that may not be redistributed.

use rocking_block::block::{Block, Common, Dimensionless};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::ground::Ground;
use rocking_block::simulation::{Initial, OnSeparation, Progress, Settings, Simulation};
use rocking_records::ReadOptions;

const RECORD: &[u8] = include_bytes!("../records/np01002p_4225a_a.smc");

fn block(alpha: f64, p: f64, eta: f64, xi_v: f64, epsilon: f64) -> Block {
    let common = Common { epsilon, ..Common::default() };
    Block::from_dimensionless(&Dimensionless { alpha, p, eta, xi_v }, &common).expect("a block")
}

/// Steps from stop to stop of the ground motion. Never inlined, since callgrind counts inside it.
#[inline(never)]
fn counted(simulation: &mut Simulation, ground: &Ground, end: f64) -> f64 {
    while simulation.time() < end {
        let (inputs, until) = ground.inputs_from(simulation.time());
        let progress = simulation.advance(until.min(end), &inputs, &mut |_| ()).expect("the case runs");
        if let Progress::Ended(_, time) = progress {
            return time;
        }
    }
    end
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let case = arguments.next().unwrap_or_default();
    let sine = |amplitude, period| Pulse { shape: PulseShape::OneSine, amplitude, period, start: 0.0, ..Pulse::NONE };
    let (block, pulse, ground, end) = match case.as_str() {
        "sine" => (block(0.25, 1.0, 40.0, 0.1, 0.0), sine(4.0, 1.2566), Ground::default(), 10.0),
        "flight" => (block(0.3, 2.5, 80.0, 0.02, 0.6), sine(4.0, 0.8), Ground::default(), 4.0),
        "record" => {
            let record =
                rocking_records::parse("np01002p_4225a_a.smc", RECORD, &ReadOptions::default()).expect("a record");
            let end = record.start_time + record.duration();
            let ground = Ground { horizontal: Some(record), vertical: None };
            (block(0.15, 2.0, 40.0, 0.2, 0.0), Pulse::NONE, ground, end)
        }
        "reference" => {
            let path = arguments.next().expect("a record");
            let record = rocking_records::read(path.as_ref(), &ReadOptions::default()).expect("a record");
            let end = record.start_time + record.duration();
            let ground = Ground { horizontal: Some(record), vertical: None };
            (block(0.25, 1.0, 40.0, 0.1, 0.0), Pulse::NONE, ground, end)
        }
        other => panic!("case \"{other}\"; expected sine, record, flight or reference"),
    };
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let tolerance = arguments.next().map_or(settings.tolerance, |text| text.parse().expect("a tolerance"));
    let settings = Settings { tolerance, ..settings };
    let (inputs, _) = ground.inputs_from(0.0);
    let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
    let ended = counted(&mut simulation, &ground, end);
    let counts = simulation.counts();
    println!("{ended} {} {}", counts.evaluations, counts.impacts);
}
