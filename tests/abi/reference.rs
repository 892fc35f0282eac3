//! The reference trajectories through the FMU: parameters by name, records through inputs and their derivatives.

use rocking_block::block::Foundation;

use crate::common::{Case, cases, inputs_at, record_step};
use crate::functions::*;
use crate::host::{Instance, call};
use crate::logging::Told;

/// |a − b| over |b|.
pub fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / b.abs()
}

/// Sets all parameters of a case.
pub fn prepare(instance: &Instance, case: &Case) {
    let (block, pulse, initial) = (case.block(), case.pulse(), case.initial());
    for (name, value) in [
        ("dimensionless.alpha", block.alpha),
        ("dimensionless.p", block.p),
        ("dimensionless.eta", block.eta()),
        ("dimensionless.xi_v", block.xi_v),
        ("mass", block.mass),
        ("gamma", block.gamma),
        ("epsilon", block.epsilon),
        ("g", block.gravity),
        ("foundation", f64::from(block.foundation as i32)),
        ("pulse.shape", f64::from(pulse.shape as i32)),
        ("pulse.amplitude", pulse.amplitude),
        ("pulse.period", pulse.period),
        ("pulse.start", pulse.start),
        ("initial.theta", initial.theta),
        ("initial.theta_dot", initial.theta_dot),
        ("initial.settled", f64::from(u8::from(initial.vertical.is_none()))),
        ("initial.v", 0.0),
        ("initial.v_dot", 0.0),
    ] {
        instance.set(name, value);
    }
}

/// How far a case is from its trajectory: θ in α, the end of the run in s, and what else is wrong.
struct Outcome {
    theta: f64,
    end: f64,
    wrong: Vec<String>,
}

/// Runs a case, or tells which record is missing.
fn run(case: &Case, tolerance: Option<f64>) -> Result<Outcome, String> {
    let records = case.records()?;
    let block = case.block();
    let instance = Instance::at(&case.name, None, true);
    let category = c"logEvents".as_ptr();
    assert_eq!(call!(instance, set_debug_logging, 1, 1, &category), OK);
    prepare(&instance, case);
    let set_inputs = |sample: usize| {
        let inputs = inputs_at(&records, sample);
        for (name, ramp, record) in [("a_gx", inputs.a_gx, &records[0]), ("a_gz", inputs.a_gz, &records[1])] {
            if record.is_some() {
                instance.set(name, ramp.value);
                instance.set_rate(name, ramp.rate);
            }
        }
    };
    set_inputs(0);
    instance.initialize(tolerance);
    let step = record_step(&records).unwrap_or(case.dt);
    let per_row = (case.dt / step).round() as usize;
    let rows = case.rows();
    let (mut theta, mut status, mut sample) = (0.0_f64, OK, 0);
    let mut wrong = Vec::new();
    while status == OK && (sample as f64 + 0.5) * step < case.t_end {
        if sample % per_row == 0
            && let Some(row) = rows.get(sample / per_row)
        {
            theta = theta.max((instance.get("theta") - row.theta).abs() / block.alpha);
            // A row at the instant of an event holds the state before it, the FMU's outputs that after it.
            let apart = case.events.iter().all(|event| (event.0 - row.t).abs() > 1e-9);
            if apart && instance.get("regime") != f64::from(row.regime) {
                wrong.push(format!("regime {} at {} s should be {}", instance.get("regime"), row.t, row.regime));
            }
        }
        set_inputs(sample);
        let (here, there) = (sample as f64 * step, ((sample + 1) as f64 * step).min(case.t_end));
        status = instance.try_step(here, there - here);
        sample += 1;
    }
    let (separated, overturned) = (instance.get("separated") == 1.0, instance.get("overturned") == 1.0);
    let end = match (status, separated, overturned) {
        (OK, false, false) => "completed",
        (DISCARD, true, false) => "separated",
        (DISCARD, false, true) => "overturned",
        _ => "in no way that there is",
    };
    if end != case.end {
        wrong.push(format!("ends {end} instead of {}", case.end));
    }
    if let Some(last) = rows.last()
        && status == OK
    {
        theta = theta.max((instance.get("theta") - last.theta).abs() / block.alpha);
    }
    let ended = instance.real_status(LAST_SUCCESSFUL_TIME).unwrap();
    let events: Vec<Told> = instance.messages().iter().map(|message| Told::read(&message.text)).collect();
    wrong.extend(compare(case, &events));
    if block.foundation == Foundation::Rigid && instance.get("derived.e") != instance.get("derived.e_max") {
        wrong.push("Housner's block has the restitution of epsilon = 0".into());
    }
    Ok(Outcome { theta, end: (ended - case.t_final.min(case.t_end)).abs(), wrong })
}

/// The first difference between the events of a case and those that were logged.
fn compare(case: &Case, events: &[Told]) -> Option<String> {
    for (i, (time, before, after)) in case.events.iter().enumerate() {
        let Some(event) = events.get(i) else { return Some(format!("event {i} at {time} s is missing")) };
        let overturned = after.as_str() == Some("overturned");
        let same = event.before == *before
            && (overturned && event.what == "overturning" || after.as_i64() == Some(event.after.into()));
        if !same {
            return Some(format!("event {i} should be {before} -> {after} at {time} s, is {event:?}"));
        }
    }
    (events.len() > case.events.len()).then(|| format!("one event too many: {:?}", events[case.events.len()]))
}

fn check(tolerance: Option<f64>, bound: f64) {
    let mut failures = Vec::new();
    for case in cases() {
        let outcome = match run(&case, tolerance) {
            Ok(outcome) => outcome,
            Err(record) => {
                println!("{}: left out, its record {record} may not be redistributed and is not at hand", case.name);
                continue;
            }
        };
        let Outcome { theta, end, wrong } = &outcome;
        println!("{:24} theta {theta:8.1e} alpha, end {end:8.1e} s {wrong:?}", case.name);
        if *theta > bound || *end > 1e-6 || !wrong.is_empty() {
            failures.push(case.name);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn at_a_tight_tolerance() {
    check(Some(1e-10), 1e-7);
}

#[test]
fn at_the_default_tolerance() {
    check(None, 1e-5);
}
