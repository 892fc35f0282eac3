//! The reference trajectories, computed by the FMU, with records as inputs and their derivatives.

use rocking_block::block::{Foundation, Ratios, Supports};

use crate::common::{Case, cases, inputs_at, record_step};
use crate::compare::{Comparison, RecordedEvent, RecordedRow, Tolerance, check_cases};
use crate::event_lines::LoggedEvent;
use crate::functions::*;
use crate::host::{Instance, call};

/// Returns |a − b|/|b|.
pub fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / b.abs()
}

/// Sets all parameters of a case.
pub fn prepare(instance: &Instance, case: &Case) {
    let (block, pulse, initial) = (case.block(), case.pulse(), case.initial());
    for (name, value) in [
        ("dimensionless.alpha", block.alpha),
        ("dimensionless.p", block.p),
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
    if let Supports::Viscoelastic(Ratios { eta, xi_v }) = block.ratios() {
        instance.set("dimensionless.eta", eta);
        instance.set("dimensionless.xi_v", xi_v);
    }
}

/// Compares a case with its trajectory, or names the missing record.
fn run(case: &Case, tolerance: Tolerance) -> Result<Vec<String>, String> {
    let records = case.records()?;
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
    instance.initialize(match tolerance {
        Tolerance::Tight => Some(1e-10),
        Tolerance::Default => None,
    });
    let step = record_step(&records).unwrap_or(case.dt);
    let per_row = (case.dt / step).round() as usize;
    let rows = case.rows();
    let mut compared = Comparison::of(case, &rows);
    let (mut status, mut sample) = (OK, 0);
    loop {
        if status == OK && sample % per_row == 0 {
            match rows.get(sample / per_row) {
                Some(row) => compared.row(row, &seen(&instance)),
                None => compared.complain("goes on where the trajectory has ended"),
            }
        }
        if status != OK || (sample as f64 + 0.5) * step > case.t_end {
            break;
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
        _ => "in an unknown way",
    };
    compared.end(end, instance.real_status(LAST_SUCCESSFUL_TIME).unwrap());
    let logged = instance.messages().into_iter().map(|message| LoggedEvent::read(&message.text));
    let events = logged.map(|LoggedEvent { time, what, before, after }| RecordedEvent {
        time,
        before,
        after,
        overturns: what == "overturning",
    });
    compared.events(&events.collect::<Vec<_>>());
    if case.block().foundation == Foundation::Rigid && instance.get("derived.e") != instance.get("derived.e_max") {
        compared.complain("Housner's block has the restitution of epsilon = 0");
    }
    Ok(compared.judge(tolerance))
}

fn seen(instance: &Instance) -> RecordedRow {
    RecordedRow {
        theta: instance.get("theta"),
        theta_dot: instance.get("theta_dot"),
        v: instance.get("v"),
        v_dot: instance.get("v_dot"),
        reaction: [instance.get("N_L"), instance.get("N_R")],
        horizontal: instance.get("H"),
        energy: instance.get("energy.total"),
        residual: instance.get("energy.residual"),
        regime: instance.get("regime") as i32,
    }
}

fn check(tolerance: Tolerance) {
    check_cases(&cases(), |case| &case.name, |case| run(case, tolerance));
}

#[test]
fn trajectories_match_at_a_tight_tolerance() {
    check(Tolerance::Tight);
}

#[test]
fn trajectories_match_at_the_default_tolerance() {
    check(Tolerance::Default);
}
