//! Flights compared with an independent computation: take-offs, landings on one corner and on both, grips, slides.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

use proptest::prelude::*;
use rocking_block::block::{Block, Common, Corner, Regime};
use rocking_block::excitation::{Inputs, Pulse, Ramp};
use rocking_block::simulation::Initial;
use rocking_block::system::events::{Event, EventKind};

use super::independent::{IndependentEvent, Kind, Rule, Run};
use super::{blocks, go, one_sine, start};
use crate::cases::cases;

/// A flight: block, initial motion and ground motion.
#[derive(Clone, Copy, Debug)]
struct Flight {
    block: Block,
    /// θ (rad), θ̇ (rad/s), v (m), v̇ (m/s) of a block in the air; `None` for a block at rest.
    thrown: Option<[f64; 4]>,
    /// One sine.
    pulse: Pulse,
    /// a_gz (m/s²).
    vertical: Ramp,
    until: f64,
}

/// Greatest deviations between two computations of a flight.
#[derive(Debug, Default)]
struct Deviation {
    /// Deviation of θ, in α.
    theta: f64,
    /// Deviation of u and v, in R0 α.
    place: f64,
    /// Deviation of event times (s); infinite if the events or their counts differ.
    events: f64,
}

impl Deviation {
    /// Includes the deviations of θ and of the centre of mass at an instant.
    fn include(&mut self, block: &Block, theta: f64, place: [f64; 2]) {
        self.theta = self.theta.max(theta.abs() / block.alpha);
        let unit = block.r0 * block.alpha;
        self.place = place.into_iter().fold(self.place, |greatest, x| greatest.max(x.abs() / unit));
    }
}

impl Flight {
    /// Times of comparison, including the ends of the pulse so that no step crosses them.
    fn times(&self) -> Vec<f64> {
        let Flight { pulse, until, .. } = *self;
        let steps = (until / 0.05).round();
        let mut times: Vec<f64> = (1..=steps as u32).map(|i| until / steps * f64::from(i)).collect();
        times.extend([pulse.start, pulse.start + pulse.period].into_iter().filter(|time| (0.0..until).contains(time)));
        times.sort_by(f64::total_cmp);
        times
    }

    fn initial(&self) -> Initial {
        self.thrown.map_or(Initial::default(), |[theta, theta_dot, v, v_dot]| Initial {
            theta,
            theta_dot,
            vertical: Some((v, v_dot)),
        })
    }

    /// Deviation caused by a pulse stronger by a factor of 1 + 10⁻⁹, while both flights last.
    fn sensitivity(&self) -> Deviation {
        let Flight { block, pulse, vertical, .. } = *self;
        let stronger = Pulse { amplitude: pulse.amplitude * (1.0 + 1e-9), ..pulse };
        let mut runs = [pulse, stronger].map(|pulse| start(block, pulse, &self.initial()));
        let inputs = Inputs { a_gz: vertical, ..Inputs::default() };
        let mut greatest = Deviation::default();
        for time in self.times() {
            for run in &mut runs {
                go(run, time, &inputs);
            }
            if runs.iter().any(|run| run.ending().is_some()) {
                break;
            }
            let [one, other] = [&runs[0], &runs[1]].map(|run| run.observe(&inputs));
            greatest.include(&block, one.theta - other.theta, [one.u - other.u, one.v - other.v]);
        }
        greatest
    }

    /// Computes the flight both ways until it ends or the block overturns.
    fn compare(&self) -> (Deviation, Vec<Event>, BTreeSet<Rule>) {
        let Flight { block, pulse, vertical, .. } = *self;
        let ground = |time: f64| {
            let phase = (time - pulse.start) / pulse.period;
            let a_gx = if (0.0..1.0).contains(&phase) { pulse.amplitude * (TAU * phase).sin() } else { 0.0 };
            [a_gx, vertical.value + vertical.rate * time]
        };
        let inputs = Inputs { a_gz: vertical, ..Inputs::default() };
        let mut run = match self.thrown {
            None => Run::at_rest(&block, &ground),
            Some(thrown) => Run::in_flight(&block, thrown, &ground),
        };
        let mut simulation = start(block, pulse, &self.initial());
        let (mut greatest, mut events) = (Deviation::default(), Vec::new());
        for time in self.times() {
            events.extend(go(&mut simulation, time, &inputs));
            if simulation.ending().is_some() {
                events.pop();
                break;
            }
            run.advance(time);
            let seen = simulation.observe(&inputs);
            let [u, height, theta] = [run.state[0], run.state[1], run.state[2]];
            greatest.include(&block, seen.theta - theta, [seen.u - u, seen.v + block.h - height]);
        }
        let pairs = events.iter().zip(&run.events);
        greatest.events = pairs.fold(0.0, |greatest: f64, (event, other)| {
            greatest.max(if same(event, other) { (event.time - other.time).abs() } else { f64::INFINITY })
        });
        let counts = simulation.counts();
        let same = [counts.impacts, counts.liftoffs] == [run.impacts, run.liftoffs] && events.len() == run.events.len();
        if simulation.ending().is_none() && !same {
            greatest.events = f64::INFINITY;
        }
        (greatest, events, run.used)
    }
}

fn same(event: &Event, other: &IndependentEvent) -> bool {
    let kind = match event.kind {
        EventKind::LiftOff(corner) => Kind::LiftOff(corner.index()),
        EventKind::Landing(corner) => Kind::Landing(corner.index()),
        EventKind::Slip => Kind::Slip,
        EventKind::Grip => Kind::Grip,
        EventKind::Overturning | EventKind::Restraint(_) => return false,
    };
    let touching = |regime: Regime| Corner::BOTH.map(|corner| regime.touches(corner));
    (kind, [touching(event.before), touching(event.after)]) == (other.kind, [other.before, other.after])
}

fn block([alpha, p, eta, xi_v, epsilon, gamma]: [f64; 6]) -> Block {
    let common = Common { epsilon, gamma, ..Common::default() };
    crate::blocks::block([alpha, p, eta, xi_v], &common)
}

const STILL: Ramp = Ramp { value: 0.0, rate: 0.0 };

/// Flights that exercise every rule.
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn flights() -> Vec<(&'static str, Flight)> {
    let thrown = |numbers, thrown, pulse, until| Flight {
        block: block(numbers),
        thrown: Some(thrown),
        pulse,
        vertical: STILL,
        until,
    };
    // Falls and turns, and is upright just at the free height of its supports.
    let upright = |numbers, theta_dot: f64, height: f64, ahead: f64| {
        let block = block(numbers);
        let fall = (2.0 * height / block.gravity).sqrt();
        let v = block.static_deflection() + height;
        Flight {
            block,
            thrown: Some([ahead - theta_dot * fall, theta_dot, v, 0.0]),
            pulse: Pulse::NONE,
            vertical: STILL,
            until: 1.0,
        }
    };
    let shaken = Flight {
        block: block([0.45, 3.0, 60.0, 0.05, 0.6, 3.0]),
        thrown: None,
        pulse: one_sine(12.0, 0.6, 0.0),
        vertical: STILL,
        until: 2.0,
    };
    let slides = block([0.254_889_381, 1.709_870_996, 39.216_316_06, 0.331_827_6, 0.0, 2.225]);
    let sliding = [
        -0.037_31,
        0.077_15,
        2.0 * slides.static_deflection() + 0.037_31 * slides.b,
        -0.797_649 * slides.alpha * slides.p * slides.r0,
    ];
    vec![
        ("shaken off by a pulse", shaken),
        (
            "thrown up by the ground",
            Flight {
                pulse: one_sine(6.0, 0.5, 0.1),
                vertical: Ramp { value: -16.0, rate: 40.0 },
                until: 1.0,
                ..shaken
            },
        ),
        (
            "thrown with a turn",
            thrown([0.5, 2.0, 30.0, 0.2, 0.5, 3.0], [0.05, -0.3, 0.3, 1.0], one_sine(-3.0, 0.5, 0.2), 2.0),
        ),
        (
            "a support that rises faster than the corner",
            thrown([0.509, 3.337, 7.759, 1.203, 1.0, 1.224], [0.127, -0.632, 0.071, -0.061], Pulse::NONE, 1.0),
        ),
        ("without dampers", thrown([0.3, 3.0, 25.0, 0.0, 0.3, 2.0], [-0.02, 0.4, 0.2, 0.5], Pulse::NONE, 1.5)),
        (
            "dampers without rebound",
            thrown([0.6, 1.0, 50.0, 2.5, 0.0, 1.2], [0.1, 0.2, 1.5, -0.5], one_sine(8.0, 1.5, 0.3), 2.5),
        ),
        ("elastic", thrown([0.2, 4.0, 40.0, 0.02, 1.0, 3.0], [0.01, 0.1, 0.05, 0.0], Pulse::NONE, 0.6)),
        ("upright on both", upright([0.4, 2.0, 30.0, 0.1, 0.5, 3.0], 0.02, 0.01, 0.0)),
        ("upright, but L would pull", upright([0.4, 2.0, 30.0, 0.1, 0.5, 3.0], 1.0, 0.5, 0.0)),
        ("upright, but R, which is first, would pull", upright([0.4, 2.0, 30.0, 0.1, 0.5, 3.0], -1.0, 0.5, 3e-14)),
        (
            "slides",
            Flight {
                block: slides,
                thrown: Some(sliding),
                pulse: one_sine(15.0, 1.580_838, 0.3),
                vertical: STILL,
                until: 1.5,
            },
        ),
        // Gripping would throw a corner up except at the moment when the slide reverses.
        (
            "grips where a slide turns back",
            thrown(
                [0.622_109_847_7, 2.178_863_462, 24.075_333_22, 2.470_631_64, 0.0, 3.255_790_945],
                [0.088_180_722_4, 0.674_998_816, 0.085_124_68, 1.643_950_4],
                one_sine(11.916_898_453, 1.279_923_954_6, 0.1),
                1.5,
            ),
        ),
        (
            "lands beside a slide",
            thrown(
                [0.719_188, 2.417_585, 11.889_2, 1.442_074, 0.0, 1.464_607],
                [0.134_371, 0.141_892, 0.123_367, 0.189_8],
                one_sine(10.633_207, 1.760_766, 0.3),
                2.05,
            ),
        ),
    ]
}

/// Both computations are accurate to some 1e-10 α between isolated landings; a dozen impacts amplify that within the bounds.
const BOUNDS: Deviation = Deviation { theta: 1e-8, place: 1e-8, events: 1e-9 };

#[test]
fn flights_agree_with_the_independent_computation() {
    let mut all = BTreeSet::new();
    for (name, flight) in flights() {
        let (Deviation { theta, place, events }, found, used) = flight.compare();
        println!("{name}: {} events, {used:?}, theta {theta:.1e}, place {place:.1e}, times {events:.1e}", found.len());
        let right = theta <= BOUNDS.theta && place <= BOUNDS.place && events <= BOUNDS.events;
        assert!(right, "{name}: theta {theta:e}, place {place:e}, times of events {events:e} off; {found:#?}");
        all.extend(used);
    }
    let missing: Vec<Rule> = Rule::ALL.into_iter().filter(|rule| !all.contains(rule)).collect();
    assert!(missing.is_empty(), "no flight needs {missing:?}");
}

/// Random blocks with random throws agree with the independent computation.
///
/// If two events coincide to round-off, their order may differ, and only the motion is compared. If a corner lifts just as it
/// would start to slide, round-off decides, and deviations up to those of a pulse stronger by 10⁻⁹ are accepted. Both are rare.
#[test]
fn random_flights_agree_with_the_independent_computation() {
    let (flown, decided_by_rounding) = (Cell::new(0), Cell::new(0));
    proptest!(cases(24), |(
        block in blocks(),
        (theta, theta_dot, height, v_dot) in (-0.3..0.3, -0.8..0.8, 1.1..3.0, -1.0..1.0),
        (amplitude, period) in (-15.0..15.0, 0.2..2.0),
    )| {
        let v = height * block.static_deflection() + f64::abs(theta) * block.alpha * block.b;
        let rocking = block.alpha * block.p;
        let thrown = Some([theta * block.alpha, theta_dot * rocking, v, v_dot * rocking * block.r0]);
        // Stiffer supports need shorter steps of the independent computation.
        let until = (100.0 / block.omega_v).min(1.5);
        let flight = Flight { block, thrown, pulse: one_sine(amplitude, period, 0.1), vertical: STILL, until };
        let (Deviation { theta, place, .. }, events, _) = flight.compare();
        flown.set(flown.get() + 1);
        if theta > 1e-6 || place > 1e-6 {
            let by = flight.sensitivity();
            let by_rounding = theta <= 10.0 * by.theta && place <= 10.0 * by.place;
            prop_assert!(by_rounding, "theta {:e}, place {:e}, {:#?}", theta, place, events);
            decided_by_rounding.set(decided_by_rounding.get() + 1);
        }
    });
    let (flown, decided) = (flown.get(), decided_by_rounding.get());
    println!("rounding decided {decided} of {flown} flights");
    assert!(decided <= 1 + flown / 200, "rounding decided {decided} of {flown} flights");
}
