//! Embedded Runge-Kutta pairs compared by their evaluations for a given error, on the smooth pieces between the events of
//! the reference cases: `cargo run --release --example runge_kutta_pairs`.
//!
//! Prints the table of docs/code/integrator.md. Missing records are named and left out.

#[path = "../../tests/common/mod.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod common;
mod tableaux;

use rocking_block::block::Regime;
use rocking_block::block::{Block, Foundation};
use rocking_block::excitation::Excitation;
use rocking_block::numerics::control::{StepControl, size_factor};
use rocking_block::simulation::Simulation;
use rocking_block::system::dynamics::instant;
use rocking_block::system::instant::{Footing, State};

use common::{Case, Record, cases, inputs_at, record_step};
use tableaux::{PAIRS, Pair};

/// A piece of motion without an event.
struct Piece {
    regime: Regime,
    start: (f64, State),
    end: (f64, State),
}

/// Evaluations of a pair on a group of cases, and its largest error in α.
#[derive(Clone, Copy)]
struct Outcome {
    evaluations: u64,
    error: f64,
}

/// A title and the cases below it.
type Group = (&'static str, fn(&Case) -> bool);

fn main() {
    for pair in PAIRS {
        println!("{:22} order {:.2}", pair.name, order(pair));
    }
    let groups: [Group; 3] = [
        ("Pulses and free motion", |case| !is_record(case)),
        ("Records, eta = 40 and 100", |case| is_record(case) && !case.name.contains("pad")),
        ("Record on bridge pads, eta = 863", |case| case.name.contains("pad")),
    ];
    for (title, belongs) in groups {
        println!("\n{title}: evaluations for an error of 1e-5, 1e-6, 1e-8, 1e-10 alpha");
        let problems: Vec<Problem> = cases().iter().filter(|case| belongs(case)).filter_map(Problem::new).collect();
        for pair in PAIRS {
            let outcomes: Vec<Outcome> = (8..=26)
                .map(|i| 10_f64.powf(-0.5 * f64::from(i)))
                .map(|tolerance| {
                    problems.iter().map(|problem| problem.run(pair, tolerance)).fold(
                        Outcome { evaluations: 0, error: 0.0 },
                        |sum, one| Outcome {
                            evaluations: sum.evaluations + one.evaluations,
                            error: sum.error.max(one.error),
                        },
                    )
                })
                .collect();
            let cells: Vec<String> = [1e-5, 1e-6, 1e-8, 1e-10].iter().map(|&e| cell(&outcomes, e)).collect();
            println!("| {:20} | {} |", pair.name, cells.join(" | "));
        }
    }
}

/// Returns the fewest evaluations, over all tolerances, that meet an error.
fn cell(outcomes: &[Outcome], error: f64) -> String {
    let fewest = outcomes.iter().filter(|o| o.error <= error).map(|o| o.evaluations).min();
    fewest.map_or("not met".into(), |fewest| fewest.to_string())
}

fn is_record(case: &Case) -> bool {
    case.records().map_or(true, |records| record_step(&records).is_some())
}

struct Problem {
    block: Block,
    case: Case,
    records: [Option<Record>; 2],
    pieces: Vec<Piece>,
}

impl Problem {
    /// Returns the smooth pieces of a case, from a run at a tolerance far below the compared ones.
    fn new(case: &Case) -> Option<Problem> {
        let Ok(records) = case.records() else {
            println!("({} is left out: its record is not at hand)", case.name);
            return None;
        };
        // Housner's block does not test an integrator: it has only one slow motion.
        if case.block().foundation == Foundation::Rigid {
            return None;
        }
        let mut simulation = case.start(1e-14, &records);
        let mut pieces = Vec::new();
        let mut times: Vec<f64> = case.events.iter().map(|event| event.0).collect();
        times.push(case.t_final);
        let mut from = 0.0;
        for time in times {
            // Clear of the events at both ends.
            let (start, end) = (from + 1e-7, time - 1e-7);
            if end > start + 1e-3 {
                let regime = go(&mut simulation, start, &records);
                let first = *simulation.state();
                go(&mut simulation, end, &records);
                pieces.push(Piece { regime, start: (start, first), end: (end, *simulation.state()) });
            }
            from = time;
        }
        let case = cases().into_iter().find(|other| other.name == case.name)?;
        Some(Problem { block: case.block(), case, records, pieces })
    }

    fn run(&self, pair: &Pair, tolerance: f64) -> Outcome {
        let mut outcome = Outcome { evaluations: 0, error: 0.0 };
        for piece in &self.pieces {
            let (x, evaluations) = self.integrate(pair, tolerance, piece);
            outcome.evaluations += evaluations;
            outcome.error = outcome.error.max((x[0] - piece.end.1[0]).abs() / self.block.alpha);
        }
        outcome
    }

    /// Returns the state at the end of a piece, and the number of evaluations.
    fn integrate(&self, pair: &Pair, tolerance: f64, piece: &Piece) -> (State, u64) {
        let (mut time, mut x) = piece.start;
        let weights = weights(&self.block, piece.regime, tolerance);
        // A third of the period of the vertical motion.
        let longest = 2.0 / self.block.omega_v;
        let mut control = StepControl::NEW;
        let mut evaluations = 1;
        let per_step = pair.stages.len() as u64 - u64::from(pair.first_same_as_last);
        while time < piece.end.0 {
            let (stop, excitation) = self.smooth(time, piece.end.0);
            let mut attempt = control.attempt(stop - time, longest, f64::MIN_POSITIVE);
            loop {
                let size = attempt.size;
                let (next, error) = step(pair, &self.block, piece.regime, &excitation, time, x, size, &weights);
                evaluations += per_step;
                let factor = size_factor(error.powf(1.0 / f64::from(pair.order)));
                if error <= 1.0 {
                    control.accept(&attempt, factor, longest);
                    x = next;
                    time = if attempt.last { stop } else { time + size };
                    break;
                }
                attempt = control.reject(&attempt, factor);
            }
        }
        (x, evaluations)
    }

    /// Returns the next kink of the excitation, and the excitation until then.
    fn smooth(&self, time: f64, end: f64) -> (f64, Excitation) {
        let mut stop = self.case.pulse().next_kink(time).map_or(end, |kink| kink.min(end));
        let mut sample = 0;
        if let Some(dt) = record_step(&self.records) {
            sample = (time / dt * (1.0 + 1e-14)).floor() as usize;
            stop = stop.min((sample + 1) as f64 * dt);
        }
        let inputs = inputs_at(&self.records, sample);
        (stop, Excitation::from_time(time, &inputs, &self.case.pulse(), &self.block))
    }
}

fn go(simulation: &mut Simulation, until: f64, records: &[Option<Record>; 2]) -> Regime {
    let dt = record_step(records).unwrap_or(f64::INFINITY);
    while simulation.time() < until {
        let sample = (simulation.time() / dt * (1.0 + 1e-14)).floor();
        let stop = ((sample + 1.0) * dt).min(until);
        simulation.advance(stop, &inputs_at(records, sample as usize), &mut |_| ()).expect("the reference cases run");
    }
    simulation.regime()
}

/// Returns the solver's error norm.
fn weights(block: &Block, regime: Regime, tolerance: f64) -> State {
    let turning = block.b * block.b / (block.i0 + block.h * block.h);
    let (rocking, vertical) = match regime {
        Regime::FullContact => (block.p.max(block.omega_v * turning.sqrt()), block.omega_v),
        _ => (block.p, block.omega_v * (0.5 * (1.0 + turning)).sqrt()),
    };
    let allowed = 1.0 / (tolerance * block.alpha * block.p);
    let most = (block.r0 * block.alpha * block.p).min(10.0 * block.gravity / block.omega_v);
    let upright = 1.0 / (tolerance * most);
    State::from([rocking * allowed, allowed, vertical * upright, upright])
}

#[allow(clippy::too_many_arguments, reason = "a step of a method on a problem, written out")]
fn step(
    pair: &Pair,
    block: &Block,
    regime: Regime,
    excitation: &Excitation,
    time: f64,
    x: State,
    size: f64,
    weights: &State,
) -> (State, f64) {
    let rate = |time: f64, x: &State| {
        let x = instant(block, regime, x.0, Footing::AT_START, excitation.at(time));
        State::from([x.theta_dot, x.theta_ddot, x.w_dot, x.w_ddot])
    };
    let (next, k) = stages(pair, time, x, size, rate);
    let sum = |c: &[f64]| c.iter().zip(&k).fold(State::zeros(), |sum, (c, k)| sum + *k * *c);
    let in_units = |c: &[f64]| sum(c).weighted(*weights);
    let error = match &pair.displacements {
        None => in_units(pair.error),
        Some(of) => of_second_order(sum(of.error) * size, State::zeros()).weighted(*weights),
    };
    let norm = match pair.second_error {
        Some(second) => {
            let (fifth, third) = (error.square(), in_units(second).square());
            if fifth == 0.0 { 0.0 } else { size * fifth / (fifth + 0.01 * third).sqrt() }
        }
        None => size * error.norm(),
    };
    (next, norm)
}

fn stages(pair: &Pair, time: f64, x: State, size: f64, rate: impl Fn(f64, &State) -> State) -> (State, Vec<State>) {
    let mut k: Vec<State> = Vec::with_capacity(pair.stages.len());
    let sum = |row: &[f64], k: &[State]| row.iter().zip(k).fold(State::zeros(), |sum, (a, k)| sum + *k * *a);
    let moved = |node: f64, velocities: &[f64], displacements: Option<&[f64]>, k: &[State]| match displacements {
        None => sum(velocities, k) * size,
        Some(row) => of_second_order(x * node + sum(row, k) * size, sum(velocities, k)) * size,
    };
    for (stage, (row, node)) in pair.stages.iter().zip(pair.nodes).enumerate() {
        let displacements = pair.displacements.as_ref().map(|of| of.stages[stage]);
        k.push(rate(time + node * size, &(x + moved(*node, row, displacements, &k))));
    }
    let displacements = pair.displacements.as_ref().map(|of| of.weights);
    (x + moved(1.0, pair.weights, displacements, &k), k)
}

/// Takes the rates of displacements from the velocities of one vector `[x, ẋ, y, ẏ]`, and those of velocities from another.
fn of_second_order(displacements: State, velocities: State) -> State {
    State::from([displacements[1], velocities[1], displacements[3], velocities[3]])
}

/// Returns the convergence order of a pair on problems with known solutions, as a check of its tableau.
fn order(pair: &Pair) -> f64 {
    if pair.displacements.is_some() {
        return order_of_second_order(pair);
    }
    // x = (sin t, cos t, e^sin t, 1/(1+t)) at t = 6 from t = 0.
    let rate = |t: f64, x: &State| State::from([x[1], -x[0], x[2] * t.cos(), -x[3] * x[3]]);
    let error = |steps: u32| {
        let size = 6.0 / f64::from(steps);
        let start = State::from([0.0, 1.0, 1.0, 1.0]);
        let end = (0..steps).fold(start, |x, i| stages(pair, size * f64::from(i), x, size, rate).0);
        (end - State::from([6_f64.sin(), 6_f64.cos(), 6_f64.sin().exp(), 1.0 / 7.0])).norm()
    };
    // The steps are long enough to hide round-off, which Verner's large coefficients magnify.
    let coarse = if pair.order > 5 { 24 } else { 60 };
    (error(coarse) / error(2 * coarse)).log2()
}

/// Returns the convergence order of a method for second-order equations without velocities.
fn order_of_second_order(pair: &Pair) -> f64 {
    // x = sin t, y = 1/(1+t) at t = 6 from t = 0.
    let rate = |_: f64, x: &State| State::from([x[1], -x[0], x[3], 2.0 * x[2].powi(3)]);
    let error = |steps: u32| {
        let size = 6.0 / f64::from(steps);
        let end = (0..steps)
            .fold(State::from([0.0, 1.0, 1.0, -1.0]), |x, i| stages(pair, size * f64::from(i), x, size, rate).0);
        (end - State::from([6_f64.sin(), 6_f64.cos(), 1.0 / 7.0, -1.0 / 49.0])).norm()
    };
    (error(60) / error(120)).log2()
}
