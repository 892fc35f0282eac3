//! Random runs under harsh loads: none fails, and no corner pulls.
//!
//! The number of a case determines it. `HARSH_CASES=100000 cargo test --release --test simulation harsh` runs more cases,
//! starting at `HARSH_FIRST`. Numbers of failing cases are stored in a file, and those cases run each time from then on.

use std::f64::consts::TAU;

use rocking_block::block::restraints::States;
use rocking_block::block::{
    Block, Body, Common, Contacts, Corner, Dimensionless, Foot, Foundation, Ratios, Regime, Supports,
};
use rocking_block::excitation::{Excitation, Inputs, Pulse, Ramp};
use rocking_block::simulation::{Initial, OnSeparation, Progress, Settings, Simulation, SimulationError};
use rocking_block::system::System;
use rocking_block::system::evaluation::Motion;
use rocking_block::system::events::Transition;
use rocking_block::system::events::{Event, EventFunction};
use rocking_block::system::impact::height_over;
use rocking_block::system::instant::Pose;
use rocking_block::system::instant::{Footing, State};
use rocking_records::{ReadOptions, Record};

use crate::blocks::shapes;

/// File with a line for each case that failed once: its kind and number.
const REGRESSIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/proptest-regressions/harsh.txt");

/// Returns the numbers of the cases of a kind: those that failed once, then `HARSH_CASES` or `usual` from `HARSH_FIRST` on.
fn cases(kind: &str, usual: u64) -> Vec<u64> {
    let number =
        |name, otherwise| std::env::var(name).map_or(otherwise, |given| given.parse().expect("a whole number"));
    let first: u64 = number("HARSH_FIRST", 0);
    let stored = std::fs::read_to_string(REGRESSIONS).unwrap_or_default();
    let stored = stored.lines().filter_map(|line| line.strip_prefix(kind)?.trim().parse().ok());
    stored.chain(first..first + number("HARSH_CASES", usual)).collect()
}

/// Stores cases for later runs.
fn store(kind: &str, numbers: impl Iterator<Item = u64>) {
    let old = std::fs::read_to_string(REGRESSIONS).unwrap_or_default();
    let new = numbers.map(|number| format!("{kind} {number}\n")).filter(|line| !old.contains(line.as_str()));
    let text: String = std::iter::once(old.clone()).chain(new).collect();
    let folder = std::path::Path::new(REGRESSIONS).parent().unwrap();
    std::fs::create_dir_all(folder).and_then(|()| std::fs::write(REGRESSIONS, text)).unwrap();
}

/// Random numbers by SplitMix64.
struct Random(u64);

impl Random {
    fn of_case(number: u64) -> Random {
        Random(number.wrapping_mul(0xD134_2543_DE82_EF95) ^ 0x5851_F42D_4C95_7F2D)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn log(&mut self, low: f64, high: f64) -> f64 {
        libm::exp(self.within(libm::log(low), libm::log(high)))
    }

    fn chance(&mut self, part: f64) -> bool {
        self.unit() < part
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.next() as usize % choices.len()]
    }
}

/// A communication step in equal parts, with the inputs and their rates at its start.
struct Step {
    size: f64,
    parts: u32,
    values: [f64; 5],
    rates: [f64; 5],
}

impl Step {
    fn inputs(&self, time: f64) -> Inputs {
        let [a_gx, a_gz, f_x, f_z, m_y] = [0, 1, 2, 3, 4].map(|i| Ramp { value: self.values[i], rate: self.rates[i] });
        Inputs { time, a_gx, a_gz, f_x, f_z, m_y }
    }
}

struct Case {
    block: Block,
    settings: Settings,
    initial: Initial,
    pulse: Pulse,
    steps: Vec<Step>,
}

/// Tolerances of 1e-3 to 1e-10.
fn settings(random: &mut Random) -> Settings {
    Settings {
        tolerance: random.log(1e-10, 1e-3),
        on_separation: random.one_of(&[
            OnSeparation::Terminate,
            OnSeparation::Hold,
            OnSeparation::Fly,
            OnSeparation::Fly,
        ]),
        ..Settings::default()
    }
}

/// Returns the ground acceleration that lifts a corner of a rigid block, at most five g (m/s²).
fn lifting(block: &Block) -> f64 {
    block.gravity * block.alpha.tan().min(5.0)
}

/// Returns steps of a record of duration 1/p with a peak acceleration of `most` (m/s²).
fn record(random: &mut Random, p: f64, most: f64) -> Vec<Step> {
    let (size, mut last) = (0.01 / p, 0.0);
    let mut sample = |_| {
        let next = most * random.within(-1.0, 1.0);
        let step = Step {
            size,
            parts: 1,
            values: [last, 0.0, 0.0, 0.0, 0.0],
            rates: [(next - last) / size, 0.0, 0.0, 0.0, 0.0],
        };
        last = next;
        step
    };
    (0..100).map(&mut sample).collect()
}

impl Case {
    /// Supports and rigid bases, soft and stiff, with all dampings, under pulses, records, constant and changing loads.
    fn harsh(number: u64) -> Case {
        let random = &mut Random::of_case(number);
        let foundation = if random.chance(0.3) { Foundation::Rigid } else { Foundation::Viscoelastic };
        let epsilon = if random.chance(0.5) { 0.0 } else { random.unit() };
        let gamma = if random.chance(0.7) { 3.0 } else { random.log(1.0, 10.0) };
        let common = Common { gamma, epsilon, ..Common::default() };
        // Soft supports with strong dashpots under squat blocks hold corners.
        let holds = random.chance(0.5);
        let dimensionless = Dimensionless {
            alpha: random.within(if holds { 0.8 } else { 0.05 }, 1.4),
            p: random.log(0.3, 10.0),
            supports: Supports::of(
                foundation,
                Ratios {
                    eta: if holds { random.log(1.0, 5.0) } else { random.log(1.0, 900.0) },
                    xi_v: if random.chance(0.2) { 0.0 } else { random.log(if holds { 1.0 } else { 1e-3 }, 50.0) },
                },
            ),
        };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let Block { alpha, body: Body { p, gravity, omega_v, mass, b, .. }, .. } = block;
        let settings = settings(random);
        let initial = if random.chance(0.3) {
            Initial::default()
        } else {
            let most = if random.chance(0.7) { 0.5 * alpha } else { 1.5 };
            let sunk = block.static_deflection();
            let vertical = [random.within(-2.0, 2.0) * sunk, random.within(-1.0, 1.0) * sunk * omega_v];
            Initial {
                theta: random.within(-most, most),
                theta_dot: random.within(-1.0, 1.0) * alpha * p,
                vertical: random.chance(0.3).then_some(vertical.into()),
            }
        };
        let lifting = lifting(&block);
        let pulse = Pulse {
            shape: random.one_of(&shapes()),
            amplitude: lifting * if random.chance(0.3) { 1.0 + random.log(1e-12, 1e-3) } else { random.log(0.3, 10.0) },
            period: TAU / (random.log(0.2, 20.0) * p),
            start: if random.chance(0.5) { 0.0 } else { random.unit() / p },
            ..Pulse::NONE
        };
        let pulse = if random.chance(0.2) { Pulse::NONE } else { pulse };
        let kind = random.next() % 4;
        let most = lifting * random.log(0.3, 5.0);
        if kind == 0 {
            return Case { block, settings, initial, pulse, steps: record(random, p, most) };
        }
        let by = random.log(0.01, 3.0) * gravity;
        let loads = [lifting, by, by * mass, by * mass, by * mass * b];
        let mut step = |_| {
            let mut step = Step {
                size: random.log(1e-3, 5.0) / p,
                parts: 1 + random.next() as u32 % 20,
                values: [0.0; 5],
                rates: [0.0; 5],
            };
            match kind {
                1 => {
                    step.values[0] = lifting
                        * if random.chance(0.5) { 1.0 + random.log(1e-15, 1e-3) } else { random.within(-3.0, 3.0) }
                }
                2 => {}
                _ => {
                    for ((value, rate), load) in step.values.iter_mut().zip(&mut step.rates).zip(loads) {
                        *value = load * random.within(-2.0, 2.0);
                        *rate = load * random.within(-5.0, 5.0) * p * f64::from(u8::from(random.chance(0.7)));
                    }
                }
            }
            step
        };
        let steps = (0..5).map(&mut step).collect();
        Case { block, settings, initial, pulse, steps }
    }

    /// A rigid block at rest under a pulse or record close to the limit of lifting it.
    fn grazing(number: u64) -> Case {
        let random = &mut Random::of_case(!number);
        let common = Common::default();
        let dimensionless =
            Dimensionless { alpha: random.within(0.05, 0.6), p: random.log(0.5, 6.0), supports: Supports::HOUSNER };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let above = random.log(1e-15, 1e-3);
        let factor = random.one_of(&[1.0, 1.0 + f64::EPSILON, 1.0 + above, 1.0 + above]);
        let (p, amplitude) = (block.p, factor * lifting(&block));
        let mut pulse = Pulse {
            shape: random.one_of(&shapes()),
            amplitude,
            period: TAU / (random.log(1.0, 12.0) * p),
            start: 0.0,
            ..Pulse::NONE
        };
        let mut steps = vec![Step { size: 20.0 / p, parts: 1, values: [0.0; 5], rates: [0.0; 5] }];
        if random.chance(0.5) {
            pulse = Pulse::NONE;
            steps = record(random, p, amplitude);
            let greatest = steps.iter().map(|step| step.values[0].abs()).fold(0.0, f64::max);
            for x in steps.iter_mut().flat_map(|step| [&mut step.values[0], &mut step.rates[0]]) {
                *x *= amplitude / greatest;
            }
        }
        Case { block, settings: settings(random), initial: Initial::default(), pulse, steps }
    }

    /// A rigid block at rest under a real record of one to four times the ground acceleration that lifts it. Its clock is coarser than that of
    /// shorter loads.
    fn shaken(number: u64, records: &[Record]) -> Case {
        let random = &mut Random::of_case(number.rotate_left(32));
        let common = Common::default();
        let dimensionless =
            Dimensionless { alpha: random.within(0.1, 0.5), p: random.within(1.0, 6.0), supports: Supports::HOUSNER };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let record = &records[random.next() as usize % records.len()];
        let factor = random.within(1.0, 4.0) * lifting(&block) / record.peak().acceleration.abs();
        let size = record.time_step;
        let step = |pair: &[f64]| Step {
            size,
            parts: 1,
            values: [factor * pair[0], 0.0, 0.0, 0.0, 0.0],
            rates: [factor * (pair[1] - pair[0]) / size, 0.0, 0.0, 0.0, 0.0],
        };
        let steps = record.acceleration.windows(2).map(step).collect();
        let settings = settings(random);
        Case { block, settings, initial: Initial::default(), pulse: Pulse::NONE, steps }
    }

    /// Returns the least reaction over the weight, or the error of a failed run.
    fn run(&self) -> Result<f64, SimulationError> {
        let Case { block, settings, initial, pulse, steps } = self;
        let mut simulation = Simulation::new(*block, *settings, *pulse, initial, 0.0, &steps[0].inputs(0.0));
        let (mut time, mut least) = (0.0, 0.0);
        for step in steps {
            let inputs = step.inputs(time);
            for part in 1..=step.parts {
                let until = time + step.size * f64::from(part) / f64::from(step.parts);
                if simulation.advance(until, &inputs, &mut |_| ())? != Progress::Reached {
                    return Ok(least);
                }
                for n in simulation.observe(&inputs).reaction {
                    assert!(n.is_finite(), "a reaction of {n} N at t = {until} s");
                    least = f64::min(least, n / (block.mass * block.gravity));
                }
            }
            time += step.size;
        }
        Ok(least)
    }
}

fn none_fails(kind: &str, usual: u64, case: impl Fn(u64) -> Case) {
    let bad: Vec<(u64, Result<f64, SimulationError>)> = cases(kind, usual)
        .into_iter()
        .map(|number| (number, case(number).run()))
        .filter(|(_, made)| !made.as_ref().is_ok_and(|n| *n >= -1e-6))
        .collect();
    if !bad.is_empty() && std::env::var_os("PROPTEST_DISABLE_FAILURE_PERSISTENCE").is_none() {
        store(kind, bad.iter().map(|(number, _)| *number));
    }
    assert!(bad.is_empty(), "{} cases fail or pull, among them {:?}", bad.len(), &bad[..bad.len().min(10)]);
}

#[test]
fn no_run_under_harsh_loads_fails_and_no_corner_pulls() {
    none_fails("harsh", 600, Case::harsh);
}

#[test]
fn no_run_at_the_limit_of_lifting_fails_and_no_corner_pulls() {
    none_fails("grazing", 300, Case::grazing);
}

#[test]
fn no_run_under_a_real_record_fails_and_no_corner_pulls() {
    let parse = |name, bytes: &[u8]| rocking_records::parse(name, bytes, &ReadOptions::default()).unwrap();
    let records = [
        parse("0111a.smc", include_bytes!("../../examples/records/0111a.smc")),
        parse("np01002p_4225a_a.smc", include_bytes!("../../examples/records/np01002p_4225a_a.smc")),
    ];
    none_fails("shaken", 100, |number| Case::shaken(number, &records));
}

/// A landing without effect gains no energy beyond round-off, and leaves finite numbers.
///
/// On the rigid base the block turns about L at various rates, and L has left the base so little that its landing hardly
/// changes a rate.
#[test]
fn a_landing_without_effect_gains_no_energy() {
    for number in 0..2000 {
        let random = &mut Random::of_case(number);
        let epsilon = random.one_of(&[0.0, 0.3, 1.0]);
        let common = Common { epsilon, ..Common::default() };
        let dimensionless =
            Dimensionless { alpha: random.within(0.05, 1.2), p: random.log(0.3, 10.0), supports: Supports::HOUSNER };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let (theta, theta_dot) = (-block.alpha * random.unit(), block.p * random.within(-2.0, 2.0));
        let (sin, cos) = libm::sincos(theta);
        let reach = block.b * cos + block.h * sin;
        let rate = -random.one_of(&[0.0, 1e-12, 1e-9, 1e-7, 1e-5]);
        let pose = Pose {
            time: 0.0,
            // v with L at the base.
            state: State::from([theta, theta_dot, block.h * (cos - 1.0) - block.b * sin, rate - reach * theta_dot]),
            contacts: Contacts::touching([false; 2], 0.0),
            restraints: States::NONE,
            footing: Footing::Free {
                u: 0.0,
                u_dot: height_over(&block, Foot::Corner(Corner::Left), theta) * theta_dot,
            },
        };
        let excitation = Excitation::from_time(0.0, &Inputs::default(), &Pulse::NONE, &block);
        let system = System { block, flies: true };
        let now = Motion::from_pose(&block, &pose, &excitation).at(0.0, pose.state);
        let Transition { pose: after, .. } = system.transition(&pose, &now, EventFunction::Gap(Corner::Left));
        let landed = Motion::from_pose(&block, &after, &excitation).at(0.0, after.state);
        let [before, energy] = [now, landed].map(|now| now.energy());
        assert!(
            energy <= before + 1e-12 * before.abs().max(block.gravity * block.r0),
            "{number}: {before} -> {energy}"
        );
    }
}

/// Setting the clock back by its round-off after a lift-off leaves the events unchanged.
///
/// A corner that has just lifted is still on its support then.
#[test]
fn setting_the_clock_back_after_a_lift_off_changes_no_event() {
    let dimensionless =
        Dimensionless { alpha: 0.25, p: 2.0, supports: Supports::Viscoelastic(Ratios { eta: 60.0, xi_v: 0.2 }) };
    let block = Block::from_dimensionless(&dimensionless, &Common::default()).unwrap();
    let initial = Initial { theta_dot: 0.45, ..Initial::default() };
    let inputs = Inputs::default();
    let mut simulation = Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.3, &inputs);
    let follow = |simulation: &Simulation, time: f64| {
        let (mut simulation, mut events) = (simulation.clone(), Vec::new());
        simulation.set_time(time);
        simulation.advance(4.0, &inputs, &mut |event| events.push(*event)).unwrap();
        events
    };
    assert_eq!(simulation.regime(), Regime::TiltingRight);
    for _ in 0..5 {
        let time = simulation.time();
        let events = follow(&simulation, time);
        for back in [time.next_down(), time.next_down().next_down()] {
            let others: Vec<Event> = follow(&simulation, back);
            assert_eq!(others.len(), events.len(), "{others:?}, not {events:?}");
            for (event, other) in events.iter().zip(&others) {
                assert!(event.kind == other.kind && (event.time - other.time).abs() < 1e-7, "{event}, {other}");
            }
        }
        simulation.advance_to_event(4.0, time, &inputs, &mut |_| ()).unwrap();
        simulation.apply_pending_event(&inputs, &mut |_| ()).unwrap();
    }
}
