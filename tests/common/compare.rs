//! A run beside its reference trajectory: every column, every event, and how far each may be off.
//!
//! The trajectories are printed with 13 digits, the event times with 16, and were computed at a tolerance of 1e-12
//! (tests/reference/README.md): neither the print nor the reference limits a bound below, but that of `SENSITIVE`.

use rocking_block::block::{Block, Foundation};

use crate::common::{Case, Row};

/// What is compared; the order is that of [`BOUNDS`].
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

/// How far a quantity may be off, in its unit.
struct Bound {
    name: &'static str,
    unit: &'static str,
    /// At an integrator's tolerance of 1e-10, and at the default one, 1e-8.
    all: [f64; 2],
    /// The same for the end of the case [`SENSITIVE`].
    sensitive: [f64; 2],
}

/// The one case whose motion is sensitive, and the time (s) from which that shows.
///
/// From 8 s on, a deviation grows some 450-fold over the fourteen contacts to come, at every tolerance from 1e-8 to 1e-13
/// alike: it is the motion that does so, not the solver. (The program that made the trajectories has θ 2e-8 α off at 1e-9.)
/// And the supports are 860 times as stiff as the block is slow: a rotation that is 2e-8 α off changes a reaction by
/// `η² γ/(1+γ) sin α · 2e-8 α = 2e-4` of the weight. Before 8 s the case keeps to the bounds of the others.
const SENSITIVE: (&str, f64) = ("bridge_rinaldi_pad_S10", 8.0);

/// All bounds: some ten times the greatest deviation that was found in any case, which leaves room for another path to the
/// same accuracy and none for a mistake.
const BOUNDS: [Bound; 10] = [
    // A step may be off by the tolerance as a velocity in units of α p, and some hundred steps and twenty impacts follow; but
    // most steps are limited by the events and are far better. gamma_1_5 turns over, where deviations grow exponentially.
    Bound { name: "theta", unit: "alpha", all: [5e-9, 1e-8], sensitive: [5e-9, 2e-7] },
    Bound { name: "theta_dot", unit: "alpha p", all: [5e-9, 3e-8], sensitive: [1e-7, 3e-6] },
    // v follows from θ on one corner: v ≈ R0 α θ.
    Bound { name: "v", unit: "R0 alpha", all: [5e-9, 1e-8], sensitive: [2e-9, 5e-8] },
    // v̇ changes within 1/ω_v, which a shifted event time makes a deviation of v̈ δt.
    Bound { name: "v_dot", unit: "R0 alpha p", all: [1e-8, 1e-7], sensitive: [5e-7, 1e-5] },
    // Reactions are displacements times stiffness: δN/(M g) = η² γ/(1+γ) sin α δθ, 300 α δθ and more.
    Bound { name: "N", unit: "M g", all: [1e-7, 1e-6], sensitive: [5e-5, 2e-3] },
    // H follows from θ̈, to which the reactions contribute by their lever, some tan α of them.
    Bound { name: "H", unit: "M g", all: [2e-8, 2e-7], sensitive: [1e-5, 2e-4] },
    // The energy of rocking is quadratic in the rates, and its unit is that of the greatest rates.
    Bound { name: "energy", unit: "M (R0 alpha p)^2", all: [1e-9, 1e-8], sensitive: [5e-9, 2e-7] },
    // A deviation of θ over θ̇, some α p/4 at impacts. Through the FMU they are printed to 1e-9 s.
    Bound { name: "event times", unit: "s", all: [1e-8, 3e-8], sensitive: [2e-7, 5e-6] },
    // As the events, of which the last ends the run.
    Bound { name: "end", unit: "s", all: [1e-8, 3e-8], sensitive: [1e-8, 3e-8] },
    // What no one put in or took out: the works are integrated along, with the same steps.
    Bound { name: "residual", unit: "greatest energy", all: [1e-9, 1e-8], sensitive: [1e-9, 1e-8] },
];

/// The tolerances at which the cases are run.
#[derive(Clone, Copy, Debug)]
pub enum Tolerance {
    /// 1e-10.
    Tight,
    /// What a user gets who asks for none.
    Default,
}

/// What a run shows at one time, in SI units.
pub struct Seen {
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

/// An event of a run: its time (s), the regimes before and after it, and whether it is the block's overturning.
#[derive(Clone, Debug)]
pub struct Happened {
    pub time: f64,
    pub before: i32,
    pub after: i32,
    pub overturns: bool,
}

/// What is known of a run so far.
pub struct Comparison<'a> {
    case: &'a Case,
    block: Block,
    /// Greatest deviations; the second list is of the end of the case that is sensitive.
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

    /// Compares a row. None is at the instant of an event, where the two sides would have to be told apart.
    pub fn row(&mut self, row: &Row, seen: &Seen) {
        let Block { alpha, p, r0, mass, gravity, foundation, .. } = self.block;
        let weight = mass * gravity;
        let velocity = alpha * p;
        let greatest_energy = self.greatest_energy;
        let mut include = |quantity, deviation| self.include(row.t, quantity, deviation);
        include(Quantity::Theta, (seen.theta - row.theta) / alpha);
        include(Quantity::ThetaDot, (seen.theta_dot - row.theta_dot) / velocity);
        include(Quantity::V, (seen.v - row.v) / (r0 * alpha));
        include(Quantity::VDot, (seen.v_dot - row.v_dot) / (r0 * velocity));
        if foundation == Foundation::Rigid && row.regime == 0 {
            // At rest on a rigid base the reference puts half the weight under each corner, which leaves the moment of H
            // without balance.
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
    pub fn events(&mut self, found: &[Happened]) {
        for (i, (time, before, after)) in self.case.events.iter().enumerate() {
            let overturns = after.as_str() == Some("overturned");
            let same = |event: &Happened| {
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

    /// Compares how and when the run ended; `end` as in cases.json.
    pub fn end(&mut self, end: &str, time: f64) {
        if end != self.case.end {
            self.wrong.push(format!("ends {end} instead of {}", self.case.end));
        }
        self.include(0.0, Quantity::EndTime, time - self.case.t_final);
    }

    /// Something else that is wrong.
    pub fn complain(&mut self, what: &str) {
        self.wrong.push(what.into());
    }

    /// Shows the deviations, and tells which are beyond their bounds.
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
