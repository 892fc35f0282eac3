//! A case file of `cases.py` → its parameters; the command line of the programs that solve it:
//!
//! - `PROGRAM CASE METHOD TOLERANCE time SECONDS` repeats the run for this CPU time;
//! - `PROGRAM CASE METHOD TOLERANCE trace` gives the rotation at multiples of the case's dt.
//!
//! Each prints one line of JSON.

use std::fs;
use std::hint::black_box;

use rustix::time::{ClockId, clock_gettime};
use serde::Deserialize;
use serde_json::{Map, json};

/// A case, as in its file; angles in rad, accelerations in m/s², times in s.
#[derive(Clone, Debug, Deserialize)]
pub struct Case {
    pub alpha: f64,
    pub p: f64,
    pub eta: f64,
    pub xi_v: f64,
    pub epsilon: f64,
    pub gamma: f64,
    pub gravity: f64,
    /// 1 for Housner's block.
    pub rigid: f64,
    /// Shape of the pulse: 0 none, 1 one sine, 2 one cosine.
    pub shape: f64,
    pub a_p: f64,
    pub omega_p: f64,
    /// 1 if the block starts in vertical equilibrium, otherwise v = 0.
    pub settled: f64,
    pub theta: f64,
    pub theta_dot: f64,
    pub t_end: f64,
    pub dt: f64,
    pub record_dt: f64,
    /// Samples of the horizontal ground acceleration, linear in between and zero after the last.
    #[serde(skip)]
    pub record: Vec<f64>,
}

impl Case {
    fn read(path: &str) -> Case {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let number = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("{path}: {text} is no number"));
        let (mut values, mut record) = (Map::new(), Vec::new());
        for line in text.lines() {
            match line.split_once(' ') {
                Some((key, value)) => {
                    values.insert(key.to_owned(), number(value).into());
                }
                None => record.push(number(line)),
            }
        }
        let case: Case = serde_json::from_value(values.into()).unwrap_or_else(|error| panic!("{path}: {error}"));
        Case { record, ..case }
    }

    /// Returns the time of a sample of the record.
    pub fn sample_time(&self, sample: usize) -> f64 {
        sample as f64 * self.record_dt
    }

    /// Returns value and slope of the record after a sample.
    pub fn ramp(&self, sample: usize) -> (f64, f64) {
        match (self.record.get(sample), self.record.get(sample + 1)) {
            (Some(a), Some(b)) => (*a, (b - a) / self.record_dt),
            _ => (0.0, 0.0),
        }
    }

    /// Returns the number of steps of dt to the end.
    pub fn rows(&self) -> usize {
        (self.t_end / self.dt).round() as usize
    }

    /// Returns the time of a row.
    pub fn row_time(&self, row: usize) -> f64 {
        (row as f64 * self.dt).min(self.t_end)
    }
}

/// Cost of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Evaluations of the equations of motion.
    pub rhs: u64,
    /// Accepted steps.
    pub steps: u64,
    /// Events.
    pub events: u64,
}

/// A solver of a case.
pub trait Solver: Sized {
    /// Prepares a case for a method and a tolerance; not timed.
    fn new(case: Case, method: &str, tolerance: f64) -> Self;

    /// Makes the whole run.
    fn run(&mut self) -> Work;

    /// Returns the rotation at every row.
    fn trace(&mut self) -> Vec<f64>;
}

fn cpu_seconds() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Runs the program of a solver.
pub fn program<S: Solver>() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, method, tolerance, task, rest @ ..] = arguments.as_slice() else {
        panic!("usage: CASE METHOD TOLERANCE time SECONDS | trace");
    };
    let mut solver = S::new(Case::read(path), method, tolerance.parse().expect("a tolerance"));
    if task == "trace" {
        println!("{}", json!({ "theta": solver.trace() }));
        return;
    }
    let seconds: f64 = rest.first().map_or(0.0, |text| text.parse().expect("seconds"));
    let work = solver.run();
    let (before, mut repeats) = (cpu_seconds(), 0);
    let used = loop {
        black_box(black_box(&mut solver).run());
        repeats += 1;
        let used = cpu_seconds() - before;
        if used >= seconds {
            break used;
        }
    };
    let cpu = used / f64::from(repeats);
    println!("{}", json!({ "cpu": cpu, "rhs": work.rhs, "steps": work.steps, "events": work.events }));
}
