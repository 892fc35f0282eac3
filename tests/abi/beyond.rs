//! Friction, ties and an eccentric centre of mass in the FMU, compared with independent trajectories.

use crate::beyond_cases::{Case, Change, cases};
use crate::common::{Record, inputs_at, record_named};
use crate::compare::check_cases;
use crate::functions::*;
use crate::host::{Instance, call};
use crate::logging::LoggedEvent;

/// Differences of θ from the trajectory, as a part of α, and of event times (s).
const CLOSE: f64 = 1e-7;

/// Compares a case with its trajectory, or names the missing record.
fn run(case: &Case) -> Result<Vec<String>, String> {
    let records: [Option<Record>; 2] = [record_named(&case.a_gx, case.g)?, None];
    let instance = Instance::at(&case.name, None, true);
    let category = c"logEvents".as_ptr();
    assert_eq!(call!(instance, set_debug_logging, 1, 1, &category), OK);
    case.parameters().iter().for_each(|(name, value)| instance.set(name, *value));
    let set_inputs = |sample: usize| {
        let inputs = inputs_at(&records, sample);
        if records[0].is_some() {
            instance.set("a_gx", inputs.a_gx.value);
            instance.set_rate("a_gx", inputs.a_gx.rate);
        }
    };
    set_inputs(0);
    instance.initialize(Some(1e-10));
    let step = records[0].as_ref().map_or(case.dt, |record| record.dt);
    let per_row = (case.dt / step).round() as usize;
    let name = &case.name;
    let mut wrong = vec![];
    for (i, row) in case.rows().iter().enumerate() {
        for sample in (i * per_row).saturating_sub(per_row)..i * per_row {
            set_inputs(sample);
            assert_eq!(instance.try_step(sample as f64 * step, (sample + 1) as f64 * step - sample as f64 * step), OK);
        }
        let r0 = instance.get("derived.R0");
        for (of, expected, size) in [
            ("theta", row.theta, case.alpha),
            ("u", row.u, r0),
            ("v", row.v, r0),
            ("tie_1.tension", row.tension_1.unwrap_or(0.0), case.mass * case.g),
            ("tie_2.tension", row.tension_2.unwrap_or(0.0), case.mass * case.g),
        ] {
            let found = instance.get(of);
            if (found - expected).abs() > CLOSE * size && wrong.len() < 5 {
                wrong.push(format!("{name}: {of} = {found}, not {expected}, in row {i}"));
            }
        }
    }
    let logged: Vec<LoggedEvent> =
        instance.messages().into_iter().map(|message| LoggedEvent::read(&message.text)).collect();
    let expected = case.lasting_events();
    if logged.len() != expected.len() {
        wrong.push(format!("{name}: {} events, not {}", logged.len(), expected.len()));
    }
    for (event, (time, change)) in logged.iter().zip(&expected) {
        let same = match change {
            Change::Regime { regime, .. } => event.after == *regime && !event.what.starts_with("tie"),
            Change::Tie(tie) => {
                let number: i32 = tie[tie.len() - 1..].parse().unwrap();
                let breaks = tie.starts_with("break");
                event.what.starts_with(&format!("tie {}", number + 1)) && event.what.ends_with("breaks") == breaks
            }
        };
        if !same || (event.time - time).abs() > CLOSE {
            wrong.push(format!("{name}: {} at {} s, not {change:?} at {time} s", event.what, event.time));
            break;
        }
    }
    Ok(wrong)
}

/// θ and the places within 1e-7 of α and of R0, with the same events within 1e-7 s.
#[test]
fn trajectories() {
    check_cases(&cases(), |case| &case.name, run);
}
