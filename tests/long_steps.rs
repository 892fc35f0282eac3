//! Long communication steps, over which loads change, hold the events and the peaks of short ones.

#[path = "common/cases.rs"]
mod cases;

use std::cell::Cell;

use proptest::collection::vec;
use proptest::prelude::*;

use cases::cases;
use rocking_block::block::{Block, Common, Dimensionless, Foundation};
use rocking_block::contact::Corner;
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Initial, OnSeparation, Progress, Settings, Simulation};
use rocking_block::system::surfaces::{Event, EventKind};

/// A communication step: its size (s), and the inputs at its beginning with their rates.
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

/// The first events, and the peaks, with each step taken in as many parts.
fn run(block: Block, initial: &Initial, steps: &[Step], parts: u32) -> (Vec<Event>, Peaks) {
    let settings = Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, ..Settings::default() };
    let pulse = Pulse { shape: PulseShape::None, amplitude: 0.0, period: 1.0, start: 0.0 };
    let mut simulation = Simulation::new(block, settings, pulse, initial, 0.0, &steps[0].inputs(0.0));
    let (mut events, mut time) = (Vec::new(), 0.0);
    for step in steps {
        let inputs = step.inputs(time);
        for part in 1..=parts {
            let until = time + step.size * f64::from(part) / f64::from(parts);
            let progress = simulation.advance(until, &inputs, &mut |event| events.push(*event)).unwrap();
            if progress != Progress::Reached || events.len() >= MOST_EVENTS {
                events.truncate(MOST_EVENTS);
                return (events, simulation.peaks());
            }
        }
        time += step.size;
    }
    (events, simulation.peaks())
}

/// Events that are compared: after so many bounces what rounding leaves of the first of them can have grown to anything.
const MOST_EVENTS: usize = 10;

/// Whether two runs have the same events, and, if not many, the same peaks of all but the friction demand, which is as high as
/// may be where a reaction comes near zero.
fn same((a, peaks): &(Vec<Event>, Peaks), (b, others): &(Vec<Event>, Peaks)) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-5 * b.abs();
    let events = a.iter().zip(b).all(|(a, b)| a.kind == b.kind && (a.time - b.time).abs() < 1e-6);
    let most = |of: &Peaks| [of.theta, of.reaction, of.horizontal, of.uplift];
    let of_all = a.len() < MOST_EVENTS;
    a.len() == b.len() && events && (!of_all || most(peaks).into_iter().zip(most(others)).all(|(a, b)| near(a, b)))
}

/// A moment lifts the block, which then is in the air by a nanometre; the next one turns it through 3 rad in the longest step
/// that there is, and brings the corner down at once.
#[test]
fn a_block_that_is_spun_in_the_air_comes_down_on_the_near_corner() {
    let dimensionless = Dimensionless { alpha: 0.247, p: 2.28, eta: 20.0, xi_v: 0.1 };
    let common = Common { gravity: 1.62, foundation: Foundation::Rigid, ..Common::default() };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let initial = Initial { theta: 0.54, theta_dot: 0.71, vertical: None };
    let up = Step { size: 1.14e-5, values: [-16.0, 0.0, 0.0, 0.0, 6500.0], rates: [0.0; 5] };
    let down = Step { size: 0.92, values: [0.0, -1.32, 0.0, -546.0, -3573.0], rates: [0.0; 5] };
    let (found, _) = run(block, &initial, &[up, down], 1);
    let kinds: Vec<EventKind> = found.iter().take(2).map(|event| event.kind).collect();
    assert_eq!(kinds, [EventKind::LiftOff(Corner::Right), EventKind::Landing(Corner::Right)], "{found:?}");
    // Height and rate reached by the first moment, and what the second one makes of them.
    assert!(found[1].time > 1.14e-5 && found[1].time < 1e-4, "{}", found[1]);
}

/// A block slides on R until L comes down, beside which R falls from a gap of zero; the ground would bring it up again within the
/// same step.
#[test]
fn a_corner_that_falls_beside_the_other_one_comes_down_at_once() {
    let dimensionless = Dimensionless { alpha: 0.991, p: 0.758, eta: 20.0, xi_v: 0.1 };
    let common = Common { foundation: Foundation::Rigid, ..Common::default() };
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

/// Whatever the steps hide: dips of functions whose curvature turns, of corners of a block that turns far in the air, and behind
/// short hops. Where a corner just grazes its support, rounding decides: that is 1 run of 60,000.
#[test]
fn long_steps_hold_the_events_and_peaks_of_short_ones() {
    let (ran, differ) = (Cell::new(0), Cell::new(0));
    proptest!(cases(2000), |(
        (alpha, p, eta, xi_v) in (0.05..1.2, log_uniform(0.3, 10.0), log_uniform(5.0, 300.0), 0.01..0.5),
        epsilon in prop_oneof![Just(0.0), 0.0..0.9],
        foundation in prop_oneof![Just(Foundation::Rigid), Just(Foundation::Viscoelastic)],
        (theta, theta_dot) in (-0.3..0.3, -1.0..1.0),
        steps in steps(),
    )| {
        let common = Common { epsilon, foundation, ..Common::default() };
        let block = Block::from_dimensionless(&Dimensionless { alpha, p, eta, xi_v }, &common).unwrap();
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
