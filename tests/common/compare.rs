//! A run compared with its reference trajectory: columns, events and their bounds.
//!
//! The trajectories have 13 digits, the event times 16; both were computed at a tolerance of 1e-12 (tests/reference/README.md).
//! Neither printing nor reference limits a bound below, except that of `SENSITIVE`.

use rocking_block::block::{Block, Body, Foundation};

use crate::common::{Case, Row};
use crate::skipped::skip;

/// Compared quantities, in the order of [`BOUNDS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    Theta,
    ThetaDot,
    V,
    VDot,
    Reaction,
    Horizontal,
    Energy,
    EventTime,
    EndTime,
    Residual,
}

/// Bound of a deviation, in the unit of the quantity.
struct Bound {
    name: &'static str,
    unit: &'static str,
    /// At an integrator's tolerance of 1e-10, and at the default one, 1e-8.
    all: [f64; 2],
    /// The same for the last part of the case [`SENSITIVE`].
    sensitive: [f64; 2],
}

/// The only case with sensitive motion, and the time (s) from which deviations grow.
///
/// From 8 s on, a deviation grows some 450-fold over the next fourteen contacts, at every tolerance from 1e-8 to 1e-13: the
/// cause is the motion, not the solver. (The program of the trajectories deviates by 2e-8 α in θ at 1e-9.) With the stiffness
/// ratio of 860 of the supports, a deviation of 2e-8 α changes a reaction by
/// `η² γ/(1+γ) sin α · 2e-8 α = 2e-4` of the weight. Before 8 s the case keeps to the bounds of the others.
const SENSITIVE: (&str, f64) = ("bridge_rinaldi_pad_S10", 8.0);

/// All bounds: some ten times the greatest deviation of any case.
///
/// That admits other computations of the same accuracy and no mistake.
const BOUNDS: [Bound; 10] = [
    // A step may deviate by the tolerance, as a velocity in units of α p, and some hundred steps and twenty impacts follow; but
    // events limit most steps, which are far more accurate. gamma_1_5 overturns, with exponential growth of deviations.
    Bound { name: "theta", unit: "alpha", all: [5e-9, 1e-8], sensitive: [5e-9, 2e-7] },
    Bound { name: "theta_dot", unit: "alpha p", all: [5e-9, 3e-8], sensitive: [1e-7, 3e-6] },
    // v follows from θ on one corner: v ≈ R0 α θ.
    Bound { name: "v", unit: "R0 alpha", all: [5e-9, 1e-8], sensitive: [2e-9, 5e-8] },
    // v̇ changes within 1/ω_v, so a shifted event time causes a deviation of v̈ δt.
    Bound { name: "v_dot", unit: "R0 alpha p", all: [1e-8, 1e-7], sensitive: [5e-7, 1e-5] },
    // Reactions are displacements times stiffness: δN/(M g) = η² γ/(1+γ) sin α δθ, 300 α δθ and more.
    Bound { name: "N", unit: "M g", all: [1e-7, 1e-6], sensitive: [5e-5, 2e-3] },
    // H follows from θ̈, to which the reactions contribute some tan α by their lever arms.
    Bound { name: "H", unit: "M g", all: [2e-8, 2e-7], sensitive: [1e-5, 2e-4] },
    // The energy of rocking is quadratic in the rates, in units of the energy at peak rates.
    Bound { name: "energy", unit: "M (R0 alpha p)^2", all: [1e-9, 1e-8], sensitive: [5e-9, 2e-7] },
    // A deviation of θ over θ̇, some α p/4 at impacts. Through the FMU they are printed to 1e-9 s.
    Bound { name: "event times", unit: "s", all: [1e-8, 3e-8], sensitive: [2e-7, 5e-6] },
    // The same as for the events, since the last event ends the run.
    Bound { name: "end", unit: "s", all: [1e-8, 3e-8], sensitive: [1e-8, 3e-8] },
    // The energy residual: works are integrated with the same steps.
    Bound { name: "residual", unit: "greatest energy", all: [1e-9, 1e-8], sensitive: [1e-9, 1e-8] },
];

/// Tolerances of the runs.
#[derive(Clone, Copy, Debug)]
pub enum Tolerance {
    /// 1e-10.
    Tight,
    /// The default.
    Default,
}

/// Outputs at one time, in SI units.
pub struct RecordedRow {
    pub theta: f64,
    pub theta_dot: f64,
    pub v: f64,
    pub v_dot: f64,
    pub reaction: [f64; 2],
    pub horizontal: f64,
    pub energy: f64,
    pub residual: f64,
    pub regime: i32,
}

/// An event of a run: time (s), regimes before and after, and whether the block overturned.
#[derive(Clone, Debug)]
pub struct RecordedEvent {
    pub time: f64,
    pub before: i32,
    pub after: i32,
    pub overturns: bool,
}

/// Comparison under way.
pub struct Comparison<'a> {
    case: &'a Case,
    block: Block,
    /// Greatest deviations; the second list covers the end of the sensitive case.
    greatest: [[f64; BOUNDS.len()]; 2],
    greatest_energy: f64,
    wrong: Vec<String>,
}

impl Comparison<'_> {
    pub fn of<'a>(case: &'a Case, rows: &[Row]) -> Comparison<'a> {
        let greatest_energy = rows.iter().fold(0.0_f64, |greatest, row| greatest.max(row.energy.abs()));
        Comparison { case, block: case.block(), greatest: Default::default(), greatest_energy, wrong: Vec::new() }
    }

    fn include(&mut self, time: f64, quantity: Quantity, deviation: f64) {
        let (name, since) = SENSITIVE;
        let sensitive = self.case.name == name && time > since;
        let greatest = &mut self.greatest[usize::from(sensitive)][quantity as usize];
        *greatest = greatest.max(if deviation.is_nan() { f64::INFINITY } else { deviation.abs() });
    }

    /// Compares a row. No row is at the instant of an event, which would have two sides.
    pub fn row(&mut self, row: &Row, seen: &RecordedRow) {
        let Block { alpha, body: Body { p, r0, mass, gravity, foundation, .. }, .. } = self.block;
        let weight = mass * gravity;
        let velocity = alpha * p;
        let greatest_energy = self.greatest_energy;
        let mut include = |quantity, deviation| self.include(row.t, quantity, deviation);
        include(Quantity::Theta, (seen.theta - row.theta) / alpha);
        include(Quantity::ThetaDot, (seen.theta_dot - row.theta_dot) / velocity);
        include(Quantity::V, (seen.v - row.v) / (r0 * alpha));
        include(Quantity::VDot, (seen.v_dot - row.v_dot) / (r0 * velocity));
        if foundation == Foundation::Rigid && row.regime == 0 {
            // At rest on a rigid base the reference assigns half the weight to each corner, which does not balance the moment
            // of H.
            include(Quantity::Reaction, (seen.reaction[0] + seen.reaction[1] - row.n_l - row.n_r) / weight);
        } else {
            include(Quantity::Reaction, (seen.reaction[0] - row.n_l) / weight);
            include(Quantity::Reaction, (seen.reaction[1] - row.n_r) / weight);
        }
        include(Quantity::Horizontal, (seen.horizontal - row.h) / weight);
        include(Quantity::Energy, (seen.energy - row.energy) / (mass * (r0 * velocity).powi(2)));
        include(Quantity::Residual, seen.residual / greatest_energy);
        if seen.regime != row.regime {
            self.wrong.push(format!("regime {} at {} s should be {}", seen.regime, row.t, row.regime));
        }
    }

    /// Compares all events.
    pub fn events(&mut self, found: &[RecordedEvent]) {
        for (i, (time, before, after)) in self.case.events.iter().enumerate() {
            let overturns = after.as_str() == Some("overturned");
            let same = |event: &RecordedEvent| {
                event.before == *before
                    && event.overturns == overturns
                    && (overturns || after.as_i64() == Some(event.after.into()))
            };
            match found.get(i) {
                Some(event) if same(event) => self.include(*time, Quantity::EventTime, event.time - time),
                other => {
                    self.wrong.push(format!("event {i} should be {before} -> {after} at {time} s, is {other:?}"));
                    return;
                }
            }
        }
        if let Some(event) = found.get(self.case.events.len()) {
            self.wrong.push(format!("one event too many: {event:?}"));
        }
    }

    /// Compares kind and time of the end; `end` as in cases.json.
    pub fn end(&mut self, end: &str, time: f64) {
        if end != self.case.end {
            self.wrong.push(format!("ends {end} instead of {}", self.case.end));
        }
        self.include(0.0, Quantity::EndTime, time - self.case.t_final);
    }

    /// Reports another failure.
    pub fn complain(&mut self, what: &str) {
        self.wrong.push(what.into());
    }

    /// Prints the deviations and returns those beyond their bounds.
    pub fn judge(mut self, tolerance: Tolerance) -> Vec<String> {
        for (found, since) in self.greatest.iter().zip(["", ", sensitive"]) {
            if !since.is_empty() && self.case.name != SENSITIVE.0 {
                continue;
            }
            let mut line = format!("{}{since}:", self.case.name);
            for (bound, &found) in BOUNDS.iter().zip(found) {
                let bounds = if since.is_empty() { bound.all } else { bound.sensitive };
                let most = bounds[tolerance as usize];
                let Bound { name, unit, .. } = bound;
                line += &format!(" {name} {found:.1e}");
                if found > most {
                    self.wrong.push(format!("{name} is {found:.1e} {unit} off{since}, expected at most {most:.1e}"));
                }
            }
            println!("{line}");
        }
        self.wrong.into_iter().map(|what| format!("{}: {what}", self.case.name)).collect()
    }
}

/// Compares each case by `run`, which returns its differences or the name of its missing record.
///
/// Most cases have no record: at least half of them must run.
pub fn check_cases<C>(cases: &[C], name: impl Fn(&C) -> &str, run: impl Fn(&C) -> Result<Vec<String>, String>) {
    let (mut compared, mut wrong) = (0, Vec::new());
    for case in cases {
        match run(case) {
            Ok(differences) => {
                compared += 1;
                wrong.extend(differences);
            }
            Err(record) => skip(&format!(
                "reference case {}: its record {record} may not be redistributed and is not at hand",
                name(case)
            )),
        }
    }
    assert!(2 * compared >= cases.len() && compared > 0, "{compared} of {} cases were compared", cases.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
}
