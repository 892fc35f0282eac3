//! Long communication steps with changing loads have the events and peaks of short ones.

use std::cell::Cell;

use proptest::collection::vec;
use proptest::prelude::*;

use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Block, Common, Corner, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Initial, OnSeparation, Progress, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};

use crate::cases::cases;

/// A communication step: its size (s), and the inputs with their rates at its start.
#[derive(Clone, Debug)]
struct Step {
    size: f64,
    values: [f64; 5],
    rates: [f64; 5],
}

impl Step {
    fn inputs(&self, time: f64) -> Inputs {
        let [a_gx, a_gz, f_x, f_z, m_y] = [0, 1, 2, 3, 4].map(|i| Ramp { value: self.values[i], rate: self.rates[i] });
        Inputs { time, a_gx, a_gz, f_x, f_z, m_y }
    }
}

/// Returns the first events and the peaks, with each step divided into equal parts.
fn run(block: Block, initial: &Initial, steps: &[Step], parts: u32) -> (Vec<Event>, Peaks) {
    let settings = Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, ..Settings::default() };
    let pulse = Pulse { shape: PulseShape::None, amplitude: 0.0, period: 1.0, start: 0.0, ..Pulse::NONE };
    let mut simulation = Simulation::new(block, settings, pulse, initial, 0.0, &steps[0].inputs(0.0));
    let (mut events, mut time) = (Vec::new(), 0.0);
    for step in steps {
        let inputs = step.inputs(time);
        for part in 1..=parts {
            let until = time + step.size * f64::from(part) / f64::from(parts);
            let progress = simulation.advance(until, &inputs, &mut |event| events.push(*event)).unwrap();
            if progress != Progress::Reached || events.len() >= MAX_EVENTS {
                events.truncate(MAX_EVENTS);
                return (events, simulation.peaks());
            }
        }
        time += step.size;
    }
    (events, simulation.peaks())
}

/// Number of events to compare; over more bounces round-off errors grow without bound.
const MAX_EVENTS: usize = 10;

/// Returns true if two runs have the same events and, unless there are many, the same peaks.
///
/// The friction demand is left out: it is unbounded where a reaction nears zero.
fn same((a, peaks): &(Vec<Event>, Peaks), (b, others): &(Vec<Event>, Peaks)) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-5 * b.abs();
    let events = a.iter().zip(b).all(|(a, b)| a.kind == b.kind && (a.time - b.time).abs() < 1e-6);
    let most = |of: &Peaks| [of.theta, of.reaction, of.horizontal, of.uplift];
    let of_all = a.len() < MAX_EVENTS;
    a.len() == b.len() && events && (!of_all || most(peaks).into_iter().zip(most(others)).all(|(a, b)| near(a, b)))
}

/// A moment lifts the block by a nanometre; the next turns it by 3 rad in the longest step and lands the corner at once.
#[test]
fn a_block_that_is_spun_in_the_air_comes_down_on_the_near_corner() {
    let dimensionless = Dimensionless { alpha: 0.247, p: 2.28, supports: Supports::HOUSNER };
    let common = Common { gravity: 1.62, ..Common::default() };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let initial = Initial { theta: 0.54, theta_dot: 0.71, vertical: None };
    let up = Step { size: 1.14e-5, values: [-16.0, 0.0, 0.0, 0.0, 6500.0], rates: [0.0; 5] };
    let down = Step { size: 0.92, values: [0.0, -1.32, 0.0, -546.0, -3573.0], rates: [0.0; 5] };
    let (found, _) = run(block, &initial, &[up, down], 1);
    let kinds: Vec<EventKind> = found.iter().take(2).map(|event| event.kind).collect();
    assert_eq!(kinds, [EventKind::LiftOff(Corner::Right), EventKind::Landing(Corner::Right)], "{found:?}");
    // Height and rate after the first moment give the time under the second.
    assert!(found[1].time > 1.14e-5 && found[1].time < 1e-4, "{}", found[1]);
}

/// A block slides on R until L lands; R then falls from a zero gap, and the ground would lift it within the same step.
#[test]
fn a_corner_that_falls_from_a_zero_gap_lands_at_once() {
    let dimensionless = Dimensionless { alpha: 0.991, p: 0.758, supports: Supports::HOUSNER };
    let common = Common::default();
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let initial = Initial { theta: 0.00146, theta_dot: -0.194, vertical: None };
    let step = Step { size: 0.18, values: [9.32, -8.61, -9111.0, 504.0, 9819.0], rates: [12.7, 5.0, 0.0, 0.0, 0.0] };
    let (found, _) = run(block, &initial, &[step], 1);
    let kinds: Vec<EventKind> = found.iter().map(|event| event.kind).collect();
    let landings = [EventKind::Landing(Corner::Left), EventKind::Landing(Corner::Right)];
    assert_eq!(kinds, [EventKind::Slip, landings[0], landings[1]], "{found:?}");
    assert_eq!(found[1].time, found[2].time);
}

fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

prop_compose! {
    fn steps()(
        harsh in any::<bool>(),
        steps in vec(
            (
                log_uniform(1e-3, 1.0),
                [-20.0..20.0, -15.0..15.0, -1e4..1e4, -1e3..1e3, -1e4..1e4],
                [-50.0..50.0, -50.0..50.0, -1.0..1.0, -1.0..1.0, -1.0..1.0],
            ),
            1..8,
        ),
    ) -> Vec<Step> {
        let by = if harsh { 1.0 } else { 0.03 };
        let step = |(size, [a_gx, a_gz, f_x, f_z, m_y], rates): (f64, [f64; 5], [f64; 5])| {
            Step { size, values: [a_gx, by * a_gz, by * f_x, by * f_z, by * m_y], rates }
        };
        steps.into_iter().map(step).collect()
    }
}

/// Long steps miss no dip: with inflections, in far turns in flight, after short hops.
///
/// If a corner just grazes its support, round-off decides: 1 run in 60,000.
#[test]
fn long_steps_have_the_events_and_peaks_of_short_ones() {
    let (ran, differ) = (Cell::new(0), Cell::new(0));
    proptest!(cases(2000), |(
        (alpha, p, eta, xi_v) in (0.05..1.2, log_uniform(0.3, 10.0), log_uniform(5.0, 300.0), 0.01..0.5),
        epsilon in prop_oneof![Just(0.0), 0.0..0.9],
        foundation in prop_oneof![Just(Foundation::Rigid), Just(Foundation::Viscoelastic)],
        (theta, theta_dot) in (-0.3..0.3, -1.0..1.0),
        steps in steps(),
    )| {
        let common = Common { epsilon, ..Common::default() };
        let block = Block::from_dimensionless(&Dimensionless { alpha, p, supports: Supports::of(foundation, Ratios { eta, xi_v }) }, &common).unwrap();
        let initial = Initial { theta: theta * alpha, theta_dot: theta_dot * alpha * p, vertical: Some((0.0, 0.0)) };
        let [long, short] = [1, 64].map(|parts| run(block, &initial, &steps, parts));
        ran.set(ran.get() + 1);
        if !same(&long, &short) {
            println!("{long:?}\n{short:?}");
            differ.set(differ.get() + 1);
        }
    });
    let (ran, differ) = (ran.get(), differ.get());
    println!("{differ} of {ran} runs differ");
    assert!(differ <= 1 + ran / 2000, "{differ} of {ran} runs differ");
}

/// A block whose damper yields at once has, in one long step, the events of short ones: the shortest step does not depend on the stop.
#[test]
fn a_distant_stop_does_not_coarsen_the_steps() {
    let common = Common { mass: 700_000.0, epsilon: 1.0, friction: 0.39959188218360325, ..Common::default() };
    let dimensionless = Dimensionless {
        alpha: 0.5884336294073659,
        p: 35.35485111795873,
        supports: Supports::Viscoelastic(Ratios { eta: 774.048544628359, xi_v: 0.6655909226351806 }),
    };
    let tie = Tie {
        block: [0.0027911645450163164, 0.002305589917394768],
        ground: [0.00813825254522918, 0.0],
        stiffness: 14072344931.122194,
        pretension: 57903.29037696383,
        ..Tie::default()
    };
    let damper = Tie {
        block: [-0.002210477862711015, 0.000650063338099202],
        ground: [-0.00739046139316989, 0.0],
        stiffness: 46693580596.160355,
        yield_force: 2094.2695160993353,
        hardening: 0.5,
        kind: LinkKind::Damper,
        ..Tie::default()
    };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap().with_ties(&[tie, damper]).unwrap();
    let initial = Initial { theta: 0.29988285889348115, ..Initial::default() };
    let settings = Settings { tolerance: 1e-6, on_separation: OnSeparation::Fly, ..Settings::default() };
    let inputs = Inputs { a_gz: Ramp::held(1.064766873836085), ..Inputs::default() };
    let [near, far] = [60.0, 1e6].map(|until| {
        let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
        let mut events = Vec::new();
        simulation.advance(until, &inputs, &mut |event| events.push(*event)).unwrap();
        events
    });
    assert!(near.len() > 2, "{near:?}");
    let kinds = |events: &[Event]| events.iter().take(MAX_EVENTS).map(|event| event.kind).collect::<Vec<_>>();
    assert_eq!(kinds(&near), kinds(&far));
}

/// A block at rest takes a step of any length, and so does one that comes to rest within the step, after a pulse or while leaning
/// into a constant push.
#[test]
fn a_block_at_rest_takes_any_step() {
    let sine = Pulse { shape: PulseShape::OneSine, amplitude: 3.0, period: 0.5, start: 0.1, ..Pulse::NONE };
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        for (pulse, push) in [(Pulse::NONE, 0.0), (sine, 0.0), (Pulse::NONE, 1.5), (sine, 0.5)] {
            let common = Common::default();
            let dimensionless = Dimensionless {
                alpha: 0.25,
                p: 1.0,
                supports: Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 }),
            };
            let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
            let inputs = Inputs { a_gx: Ramp::held(push), ..Inputs::default() };
            let mut simulation = Simulation::new(block, Settings::default(), pulse, &Initial::default(), 0.0, &inputs);
            let mut near = simulation.clone();
            for until in [1e300, 1.5e300] {
                assert_eq!(simulation.advance(until, &inputs, &mut |_| ()), Ok(Progress::Reached), "{foundation:?}");
                assert_eq!(simulation.time(), until);
            }
            near.advance(1e6, &inputs, &mut |_| ()).unwrap();
            let seen = [&simulation, &near].map(|simulation| simulation.observe(&inputs));
            let size = block.mass * block.gravity;
            for (a, b, size) in [
                (seen[0].theta, seen[1].theta, 1.0),
                (seen[0].v, seen[1].v, block.r0),
                (seen[0].reaction[0], seen[1].reaction[0], size),
                (seen[0].horizontal, seen[1].horizontal, size),
                (simulation.peaks().theta, near.peaks().theta, 1.0),
                (simulation.peaks().reaction, near.peaks().reaction, size),
            ] {
                assert!((a - b).abs() <= 1e-14 * size, "{foundation:?}, {push}: {a}, {b}");
            }
            assert!((seen[0].horizontal - block.mass * push).abs() <= 1e-12 * size, "{foundation:?}, {push}");
        }
    }
}
