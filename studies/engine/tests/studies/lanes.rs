//! Runs stepped in the lanes of the processor's vectors have the bits of single runs.

use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

use proptest::prelude::*;
use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::lanes::{BatchKind, Lane, Next, step_group};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_records::ReadOptions;
use rocking_studies::run::Run;
use rocking_studies::run::batch::in_lanes;
use rocking_studies::run::outcome::{End, Outcome};
use rocking_studies::spec::words::Words;

use crate::cases::cases;
use crate::skipped::skip;

/// The vector widths of this processor.
fn widths() -> Vec<VectorWidth> {
    let mut widths: Vec<VectorWidth> = [2, 4, 8].into_iter().filter_map(VectorWidth::at_most).collect();
    widths.dedup();
    widths
}

/// All bits of the state of a run.
fn bits(simulation: &Simulation) -> Vec<u8> {
    postcard::to_allocvec(simulation).unwrap()
}

/// A pulse of any shape that begins and ends during the first seconds, or none.
fn pulse() -> impl Strategy<Value = Pulse> {
    let shape = prop_oneof![
        4 => Just(PulseShape::None),
        8 => prop::sample::select(PulseShape::WORDS[1..].iter().map(|word| word.1).collect::<Vec<_>>()),
    ];
    let numbers = (-6.0..6.0_f64, 0.05..2.0_f64, prop_oneof![Just(0.0), -1.0..2.0], -3.0..3.0_f64, 1.0..4.0_f64);
    (shape, numbers).prop_map(|(shape, (amplitude, period, start, phase, cycles))| Pulse {
        shape,
        amplitude,
        period,
        start,
        phase,
        cycles,
    })
}

/// A block on supports in an arbitrary initial state.
fn simulation() -> impl Strategy<Value = Simulation> {
    let eccentricity = prop_oneof![Just(0.0), -0.9..0.9];
    let block = (0.05..0.6_f64, 0.3..8.0_f64, 5.0..120.0_f64, 0.0..0.6_f64, 0.0..1.0_f64, 1.0..4.0_f64, eccentricity);
    let beginning = (-1.1..1.1_f64, -1.5..1.5_f64, any::<bool>());
    let settings = (4.0..11.0_f64, any::<bool>());
    (block, beginning, settings, pulse()).prop_map(
        |((alpha, p, eta, xi_v, epsilon, gamma, eccentricity), (theta, theta_dot, stands), (digits, flies), pulse)| {
            let common = Common { gamma, epsilon, mass: 13.0, ..Common::default() };
            let even = Block::from_dimensionless(
                &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
                &common,
            )
            .unwrap();
            let common = Common { eccentricity: eccentricity * even.b, ..common };
            let block = Block::from_dimensionless(
                &Dimensionless { alpha, p, supports: Supports::Viscoelastic(Ratios { eta, xi_v }) },
                &common,
            )
            .unwrap();
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
            Simulation::new(block, settings, pulse, &initial, 0.0, &Inputs::default())
        },
    )
}

/// A block on the rigid base that tilts, or begins to, maybe under a pulse.
fn rigid_simulation() -> impl Strategy<Value = Simulation> {
    let eccentricity = prop_oneof![Just(0.0), -0.9..0.9];
    let block = (0.05..0.6_f64, 0.3..8.0_f64, 1.0..4.0_f64, eccentricity, prop_oneof![Just(1.0), 0.5..1.0]);
    let beginning = (-1.1..1.1_f64, -1.0..1.0_f64);
    let pulse = (any::<prop::sample::Index>(), -8.0..8.0_f64, 0.05..1.0_f64, -0.3..1.0_f64);
    let settings = (4.0..13.0_f64, any::<bool>());
    (block, beginning, pulse, settings).prop_map(
        |((alpha, p, gamma, eccentricity, restitution_factor), (theta, theta_dot), pulse, (digits, flies))| {
            let common = Common { gamma, mass: 13.0, ..Common::default() };
            let numbers = Dimensionless { alpha, p, supports: Supports::Rigid { restitution_factor } };
            let even = Block::from_dimensionless(&numbers, &common).unwrap();
            let common = Common { eccentricity: eccentricity * even.b, ..common };
            let block = Block::from_dimensionless(&numbers, &common).unwrap();
            let settings = Settings {
                tolerance: libm::exp10(-digits),
                on_separation: if flies { OnSeparation::Fly } else { OnSeparation::Terminate },
                ..Settings::default()
            };
            let initial = Initial { theta: theta * alpha, theta_dot: theta_dot * alpha * p, ..Initial::default() };
            let (shape, amplitude, period, start) = pulse;
            let shapes =
                [PulseShape::None, PulseShape::OneSine, PulseShape::C2, PulseShape::HalfSine, PulseShape::Gabor];
            let pulse = Pulse { shape: *shape.get(&shapes), amplitude, period, start, ..Pulse::NONE };
            Simulation::new(block, settings, pulse, &initial, 0.0, &Inputs::default())
        },
    )
}

/// Intervals of a ground motion with both components: durations (s), accelerations at their ends (m/s²).
fn intervals() -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let duration = prop_oneof![Just(0.005), Just(0.01), Just(0.02), 0.001..0.4];
    let vertical = prop_oneof![Just(0.0), -3.0..3.0];
    prop::collection::vec((duration, -8.0..8.0, vertical), 20..60)
}

/// Inputs and end (s) of each interval. The acceleration is constant in every fourth and jumps before every fifth; during every ninth a
/// moment acts.
fn inputs(intervals: &[(f64, f64, f64)]) -> Vec<(Inputs, f64)> {
    let (mut time, mut before) = (0.0, [0.0; 2]);
    let mut made = Vec::new();
    for (number, &(duration, x, z)) in intervals.iter().enumerate() {
        if number % 5 == 2 {
            before = [-x, 0.5 * z];
        }
        let to = if number % 4 == 3 { before } else { [x, z] };
        let ramp = |i: usize| Ramp { value: before[i], rate: (to[i] - before[i]) / duration };
        let m_y = Ramp::held(if number % 9 == 4 { 10.0 } else { 0.0 });
        made.push((Inputs { time, a_gx: ramp(0), a_gz: ramp(1), m_y, ..Inputs::default() }, time + duration));
        (time, before) = (time + duration, to);
    }
    made
}

/// Takes the runs of a group through an interval, in lanes where possible; returns the number of steps in lanes.
fn through(width: VectorWidth, lanes: &mut [Option<Box<Lane>>], inputs: &Inputs) -> u64 {
    let mut taken = 0;
    loop {
        let mut waiting: [Vec<usize>; BatchKind::COUNT] = Default::default();
        for (number, place) in lanes.iter_mut().enumerate() {
            let lane = place.as_mut().unwrap();
            loop {
                match lane.next_step(inputs) {
                    Next::Arrived => break,
                    Next::Alone => lane.step_alone(inputs, &mut |_| ()).unwrap(),
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
        let went = step_group(width, BatchKind::numbered(kind), &mut group);
        taken += u64::from(went.count_ones());
        for (place, (mut lane, &number)) in group.into_iter().zip(numbers).enumerate() {
            if went >> place & 1 == 0 {
                lane.step_alone(inputs, &mut |_| ()).unwrap();
            }
            lanes[number] = Some(lane);
        }
    }
}

/// Compares all bits after every interval: time, state, contacts, step sizes, sums, peaks and counters. Returns the numbers of steps in lanes,
/// and of all steps.
fn compare(runs: &[Simulation], intervals: &[(f64, f64, f64)]) -> Result<[u64; 2], TestCaseError> {
    let (mut in_lanes, mut steps) = (0, 0);
    for width in widths() {
        let mut single = runs.to_vec();
        let mut lanes: Vec<Option<Box<Lane>>> =
            runs.iter().map(|run| Some(Box::new(Lane::new(run.clone(), 0)))).collect();
        for (inputs, until) in inputs(intervals) {
            for (run, lane) in single.iter_mut().zip(&mut lanes) {
                run.advance(until, &inputs, &mut |_| ()).unwrap();
                lane.as_mut().unwrap().send(until, &inputs);
            }
            in_lanes += through(width, &mut lanes, &inputs);
            for (run, lane) in single.iter().zip(&lanes) {
                let lane = lane.as_ref().unwrap().simulation();
                prop_assert_eq!(lane, run);
                prop_assert!(bits(lane) == bits(run), "{:?}: {:?} is not {:?}", width, lane, run);
            }
        }
        steps += single.iter().map(|run| run.counts().steps).sum::<u64>();
    }
    Ok([in_lanes, steps])
}

#[test]
fn a_step_in_a_lane_has_the_bits_of_a_step_alone() {
    let (in_lanes, steps) = (AtomicU64::new(0), AtomicU64::new(0));
    proptest!(cases(40), |(runs in prop::collection::vec(simulation(), 1..12), intervals in intervals())| {
        let [taken, all] = compare(&runs, &intervals)?;
        in_lanes.fetch_add(taken, Ordering::Relaxed);
        steps.fetch_add(all, Ordering::Relaxed);
    });
    let (in_lanes, steps) = (in_lanes.into_inner(), steps.into_inner());
    assert!(in_lanes > steps / 2, "{in_lanes} of {steps} steps were taken in lanes");
}

/// On the rigid base, under ground accelerations, pulses, and both; to landings, overturning, rest and flights.
#[test]
fn a_swing_in_a_lane_has_the_bits_of_a_swing_alone() {
    let (in_lanes, steps) = (AtomicU64::new(0), AtomicU64::new(0));
    proptest!(cases(100), |(runs in prop::collection::vec(rigid_simulation(), 1..12), intervals in intervals())| {
        let [taken, all] = compare(&runs, &intervals)?;
        in_lanes.fetch_add(taken, Ordering::Relaxed);
        steps.fetch_add(all, Ordering::Relaxed);
    });
    let (in_lanes, steps) = (in_lanes.into_inner(), steps.into_inner());
    assert!(in_lanes > steps / 5, "{in_lanes} of {steps} steps were taken in lanes");
}

/// The Loma Prieta record times a factor, with a vertical motion derived from it.
fn ground(scale: f64, vertical: bool) -> Ground {
    let bytes = include_bytes!("../../../../examples/records/np01002p_4225a_a.smc");
    let record = rocking_records::parse("np01002p_4225a_a.smc", bytes, &ReadOptions::default()).unwrap();
    let up = rocking_records::Record { start_time: record.start_time + 0.1234, ..record.clone().scaled(0.4 * scale) };
    Ground { horizontal: Some(record.scaled(scale)), vertical: vertical.then_some(up) }
}

fn run(number: u32) -> Run {
    let k = f64::from(number);
    let foundation = if number % 7 == 3 { Foundation::Rigid } else { Foundation::Viscoelastic };
    // Blocks with friction, or with a damper, are stepped alone between the others.
    let friction = if number % 5 == 2 { 0.4 } else { 0.0 };
    let common = Common { epsilon: [0.0, 0.3, 0.6][number as usize % 3], friction, ..Common::default() };
    let d = Dimensionless {
        alpha: 0.1 + 0.013 * (k * 7.0 % 11.0),
        p: 1.0 + 0.07 * k,
        supports: Supports::of(foundation, Ratios { eta: 12.0 + 5.0 * (k % 9.0), xi_v: 0.1 }),
    };
    let shapes = [PulseShape::OneSine, PulseShape::Rectangular, PulseShape::SymmetricRicker, PulseShape::Gabor];
    let shape = shapes[number as usize / 6 % shapes.len()];
    let pulse = Pulse { shape, amplitude: 3.0, period: 0.7, start: 2.0, ..Pulse::NONE };
    let on_separation = [OnSeparation::Fly, OnSeparation::Fly, OnSeparation::Hold, OnSeparation::Terminate];
    let block = Block::from_dimensionless(&d, &common).unwrap();
    let (b, weight) = (block.b, block.mass * block.gravity);
    let damper = Tie {
        block: [b, 0.0],
        ground: [b, -b],
        stiffness: 3.0 * weight / b,
        yield_force: 0.05 * weight,
        hardening: 0.1,
        kind: LinkKind::Damper,
        ..Tie::default()
    };
    Run {
        block: block.with_ties(if number % 9 == 4 { std::slice::from_ref(&damper) } else { &[] }).unwrap(),
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

/// Blocks that rock, fly, overturn and are held, on supports and on the rigid base, under records with and without vertical motion
/// and under pulses, for a given duration and until they have come down.
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
        let (outcomes, lane_use) = in_lanes(width, (0..RUNS).map(run), || ended.set(ended.get() + 1));
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
        assert!(lane_use.in_lanes > 10 * lane_use.repeated, "{width:?}: {lane_use:?}");
    }
}

/// Vectors that this processor lacks are named among the skipped tests.
#[test]
fn widths_are_those_of_the_processor() {
    let of_target: &[usize] = if cfg!(target_arch = "x86_64") { &[4, 8] } else { &[2] };
    for &lanes in of_target {
        let found = VectorWidth::at_most(lanes).map_or(1, VectorWidth::lanes);
        assert!(found <= lanes && lanes.is_multiple_of(found), "{found} of {lanes} lanes");
        if found < lanes {
            skip(&format!("runs in vectors of {lanes} numbers: this processor has at most {found}"));
        }
    }
    assert_eq!(VectorWidth::at_most(1), None);
    assert_eq!(VectorWidth::widest(), widths().last().copied());
    assert_eq!(VectorWidth::at_most(3), VectorWidth::at_most(2));
}

/// Runs that start in the air or have almost no duration, and an empty batch.
#[test]
fn runs_without_steps_are_included() {
    for width in widths() {
        let short =
            |number: u32| Run { duration: Some(if number.is_multiple_of(2) { 1e-300 } else { 0.05 }), ..run(number) };
        let alone: Vec<Outcome> = (0..9).map(|number| short(number).outcome()).collect();
        assert_eq!(in_lanes(width, (0..9).map(short), || ()).0, alone);
        assert!(in_lanes(width, std::iter::empty::<Run>(), || ()).0.is_empty());
    }
}
