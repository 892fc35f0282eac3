//! Kinetic energy added by the change of the horizontal constraint at lift-off; prints the table of docs/unit/model.md:
//! `cargo run --release --example lift_off`.

#[path = "../tests/common/mod.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod common;

use rocking_block::block::Foundation;
use rocking_block::block::Regime;
use rocking_block::simulation::{Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};

use common::{Case, Record, cases, inputs_at, record_step};

type Records = [Option<Record>; 2];

fn main() {
    println!("| case | η | lift-offs | greatest rise of kinetic energy |");
    println!("| --- | ---: | ---: | ---: |");
    for case in cases().iter().filter(|case| case.block().foundation == Foundation::Viscoelastic) {
        let Ok(records) = case.records() else {
            println!("({} is left out: its record is missing)", case.name);
            continue;
        };
        let mut events = Vec::new();
        go(&mut start(case, &records), &records, case.t_end, &mut events);
        let from_full = |event: &&Event| {
            event.before == Regime::FullContact
                && matches!(event.kind, EventKind::LiftOff(_))
                && event.after != Regime::Separated
        };
        let lift_offs: Vec<&Event> = events.iter().filter(from_full).collect();
        let rise = lift_offs.iter().map(|event| kinetic_rise(case, &records, event.time)).fold(0.0, f64::max);
        println!("| {} | {:.0} | {} | {:.2} % |", case.name, case.block().eta(), lift_offs.len(), 100.0 * rise);
    }
}

fn start(case: &Case, records: &Records) -> Simulation {
    let settings = Settings { tolerance: 1e-10, ..Settings::default() };
    Simulation::new(case.block(), settings, case.pulse(), &case.initial(), 0.0, &inputs_at(records, 0))
}

fn go(simulation: &mut Simulation, records: &Records, until: f64, events: &mut Vec<Event>) {
    let dt = record_step(records).unwrap_or(f64::INFINITY);
    while simulation.time() < until && simulation.ending().is_none() {
        let sample = (simulation.time() / dt * (1.0 + 1e-14)).floor();
        let stop = ((sample + 1.0) * dt).min(until);
        let inputs = inputs_at(records, sample as usize);
        simulation.advance(stop, &inputs, &mut |event| events.push(*event)).expect("the reference cases run");
    }
}

/// Returns the relative rise of the kinetic energy at an event.
fn kinetic_rise(case: &Case, records: &Records, time: f64) -> f64 {
    let mut simulation = start(case, records);
    go(&mut simulation, records, time - 1e-9, &mut Vec::new());
    let before = simulation.energies().kinetic;
    go(&mut simulation, records, time + 1e-9, &mut Vec::new());
    simulation.energies().kinetic / before - 1.0
}
