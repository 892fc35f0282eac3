//! Runs that are stepped together in the lanes of the processor's vectors: their bits are those of each run alone.
#![cfg(feature = "studies")]

#[path = "common/cases.rs"]
mod cases;

use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use proptest::prelude::*;
use rocking_block::block::{Block, Common, Dimensionless, Foundation};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::numerics::wide::Width;
use rocking_block::records::{self, ReadOptions, ground::Ground};
use rocking_block::simulation::lanes::{Kind, Lane, Next, step_together};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::study::history::Run;
use rocking_block::study::outcome::{End, Outcome};
use rocking_block::study::together::together;

/// The widths that this processor has.
fn widths() -> Vec<Width> {
    let mut widths: Vec<Width> = [2, 4, 8].into_iter().filter_map(Width::at_most).collect();
    widths.dedup();
    widths
}

/// All bits of a run's state.
fn bits(simulation: &Simulation) -> Vec<u8> {
    postcard::to_allocvec(simulation).unwrap()
}

/// A block on supports, somewhere on its way.
fn simulation() -> impl Strategy<Value = Simulation> {
    let block = (0.05..0.6_f64, 0.3..8.0_f64, 5.0..120.0_f64, 0.0..0.6_f64, 0.0..1.0_f64, 1.0..4.0_f64);
    let beginning = (-1.1..1.1_f64, -1.5..1.5_f64, any::<bool>());
    let settings = (4.0..11.0_f64, any::<bool>());
    (block, beginning, settings).prop_map(
        |((alpha, p, eta, xi_v, epsilon, gamma), (theta, theta_dot, stands), (digits, flies))| {
            let common = Common { gamma, epsilon, mass: 13.0, ..Common::default() };
            let block = Block::from_dimensionless(&Dimensionless { alpha, p, eta, xi_v }, &common).unwrap();
            let settings = Settings {
                tolerance: libm::exp10(-digits),
                on_separation: if flies { OnSeparation::Fly } else { OnSeparation::Terminate },
                ..Settings::default()
            };
            let initial = if stands {
                Initial { theta_dot: 0.1 * theta_dot * alpha * p, ..Initial::default() }
            } else {
                Initial { theta: theta * alpha, theta_dot: theta_dot * alpha * p, ..Initial::default() }
            };
            Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default())
        },
    )
}

/// Pieces of a ground motion with both components: durations (s), and accelerations at their ends (m/s²).
fn pieces() -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let duration = prop_oneof![Just(0.005), Just(0.01), Just(0.02), 0.001..0.4];
    let vertical = prop_oneof![Just(0.0), -3.0..3.0];
    prop::collection::vec((duration, -8.0..8.0, vertical), 20..60)
}

/// The inputs of each piece, and when it ends (s). Every fourth piece does not change.
fn inputs(pieces: &[(f64, f64, f64)]) -> Vec<(Inputs, f64)> {
    let (mut time, mut before) = (0.0, [0.0; 2]);
    let mut made = Vec::new();
    for (number, &(duration, x, z)) in pieces.iter().enumerate() {
        let to = if number % 4 == 3 { before } else { [x, z] };
        let ramp = |i: usize| Ramp { value: before[i], rate: (to[i] - before[i]) / duration };
        made.push((Inputs { time, a_gx: ramp(0), a_gz: ramp(1), ..Inputs::default() }, time + duration));
        (time, before) = (time + duration, to);
    }
    made
}

/// Takes the runs of a group through a piece, each step together where it can be; how many steps were.
fn through(width: Width, lanes: &mut [Option<Box<Lane>>]) -> u64 {
    let mut taken = 0;
    loop {
        let mut waiting: [Vec<usize>; Kind::COUNT] = Default::default();
        for (number, place) in lanes.iter_mut().enumerate() {
            let lane = place.as_mut().unwrap();
            loop {
                match lane.next_step() {
                    Next::Arrived => break,
                    Next::Alone => lane.step_alone(&mut |_| ()).unwrap(),
                    Next::Together(kind) => {
                        waiting[kind.number()].push(number);
                        break;
                    }
                }
            }
        }
        let Some((kind, waiting)) = waiting.iter().enumerate().find(|(_, waiting)| !waiting.is_empty()) else {
            return taken;
        };
        let numbers = &waiting[..waiting.len().min(width.lanes())];
        let mut group: Vec<Box<Lane>> = numbers.iter().map(|&number| lanes[number].take().unwrap()).collect();
        let went = step_together(width, Kind::numbered(kind), &mut group);
        taken += u64::from(went.count_ones());
        for (place, (mut lane, &number)) in group.into_iter().zip(numbers).enumerate() {
            if went >> place & 1 == 0 {
                lane.step_alone(&mut |_| ()).unwrap();
            }
            lanes[number] = Some(lane);
        }
    }
}

/// Runs that any step could have taken astray are compared after every piece: time, state, contacts, step sizes, sums, peaks and
/// counters, to the last bit.
#[test]
fn a_step_in_a_lane_has_the_bits_of_a_step_alone() {
    let (together, alone) = (AtomicU64::new(0), AtomicU64::new(0));
    proptest!(cases::cases(40), |(runs in prop::collection::vec(simulation(), 1..12), pieces in pieces())| {
        for width in widths() {
            let mut single = runs.clone();
            let mut lanes: Vec<Option<Box<Lane>>> =
                runs.iter().map(|run| Some(Box::new(Lane::new(run.clone(), 0)))).collect();
            for (inputs, until) in inputs(&pieces) {
                for (run, lane) in single.iter_mut().zip(&mut lanes) {
                    run.advance(until, &inputs, &mut |_| ()).unwrap();
                    lane.as_mut().unwrap().send(until, &inputs);
                }
                together.fetch_add(through(width, &mut lanes), Ordering::Relaxed);
                for (run, lane) in single.iter().zip(&lanes) {
                    let lane = lane.as_ref().unwrap().simulation();
                    prop_assert_eq!(lane, run);
                    prop_assert!(bits(lane) == bits(run), "{:?}: {:?} is not {:?}", width, lane, run);
                }
            }
            let steps = |run: &Simulation| run.counts().steps;
            alone.fetch_add(single.iter().map(steps).sum::<u64>(), Ordering::Relaxed);
        }
    });
    let (together, steps) = (together.into_inner(), alone.into_inner());
    assert!(together > steps / 2, "{together} of {steps} steps were taken together");
}

/// The record of Loma Prieta, as strong as given, with a vertical motion made of it.
fn ground(scale: f64, vertical: bool) -> Ground {
    let bytes = include_bytes!("../records/np01002p_4225a_a.smc");
    let record = records::parse("np01002p_4225a_a.smc", bytes, &ReadOptions::default()).unwrap();
    let up = records::Record { start_time: record.start_time + 0.1234, ..record.clone().scaled(0.4 * scale) };
    Ground { horizontal: Some(record.scaled(scale)), vertical: vertical.then_some(up) }
}

fn run(number: u32) -> Run {
    let k = f64::from(number);
    let foundation = if number % 7 == 3 { Foundation::Rigid } else { Foundation::Viscoelastic };
    let common = Common { epsilon: [0.0, 0.3, 0.6][number as usize % 3], foundation, ..Common::default() };
    let d = Dimensionless {
        alpha: 0.1 + 0.013 * (k * 7.0 % 11.0),
        p: 1.0 + 0.07 * k,
        eta: 12.0 + 5.0 * (k % 9.0),
        xi_v: 0.1,
    };
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 3.0, period: 0.7, start: 2.0 };
    let on_separation = [OnSeparation::Fly, OnSeparation::Fly, OnSeparation::Hold, OnSeparation::Terminate];
    Run {
        block: Block::from_dimensionless(&d, &common).unwrap(),
        settings: Settings {
            tolerance: [1e-8, 1e-6, 1e-4][number as usize / 2 % 3],
            on_separation: on_separation[number as usize % 4],
            ..Settings::default()
        },
        initial: Initial { theta: if number % 5 == 4 { -0.3 * d.alpha } else { 0.0 }, ..Initial::default() },
        pulse: if number % 6 == 5 { pulse } else { Pulse::NONE },
        ground: ground(2.0 + k % 13.0, number.is_multiple_of(2)),
        duration: (number % 8 == 2).then_some(9.5),
        output_step: if number % 10 == 1 { 0.3 } else { f64::INFINITY },
    }
}

/// Blocks that rock, fly, fall, and are held; on supports and on the rigid base; under records with and without vertical motion and
/// under pulses; to a given time and until they have come down.
#[test]
fn whole_runs_have_the_bits_of_single_ones() {
    const RUNS: u32 = 60;
    let alone: Vec<Outcome> = (0..RUNS).map(|number| run(number).outcome()).collect();
    for end in [End::Completed, End::Overturned, End::Separated] {
        assert!(alone.iter().any(|outcome| outcome.end == end), "no run is {end}");
    }
    assert!(alone.iter().any(|outcome| outcome.flights.count > 2 && outcome.counts.impacts > 10));
    let ended = Cell::new(0);
    for width in widths() {
        let (outcomes, shares) = together(width, (0..RUNS).map(run), || ended.set(ended.get() + 1));
        assert_eq!(ended.replace(0), RUNS);
        assert_eq!(outcomes.len(), alone.len());
        for (number, (lane, alone)) in outcomes.iter().zip(&alone).enumerate() {
            assert_eq!(lane, alone, "run {number}, {width:?}");
            for (a, b) in [
                (lane.end_time, alone.end_time),
                (lane.peaks.theta, alone.peaks.theta),
                (lane.peaks.horizontal, alone.peaks.horizontal),
                (lane.peaks.friction_demand, alone.peaks.friction_demand),
            ] {
                assert_eq!(a.to_bits(), b.to_bits(), "run {number}, {width:?}");
            }
        }
        assert!(shares.together > 10 * shares.again, "{width:?}: {shares:?}");
    }
}

/// A run that begins in the air or is over before it begins, and none at all.
#[test]
fn runs_without_a_step_are_there_too() {
    for width in widths() {
        let short =
            |number: u32| Run { duration: Some(if number.is_multiple_of(2) { 1e-300 } else { 0.05 }), ..run(number) };
        let alone: Vec<Outcome> = (0..9).map(|number| short(number).outcome()).collect();
        assert_eq!(together(width, (0..9).map(short), || ()).0, alone);
        assert!(together(width, std::iter::empty(), || ()).0.is_empty());
    }
    assert_eq!(Width::at_most(1), None);
    assert_eq!(Width::widest(), widths().last().copied());
    assert_eq!(Width::at_most(3), Width::at_most(2));
}
