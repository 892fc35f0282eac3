//! Friction, ties and an eccentric centre of mass in the FMU, compared with independent trajectories.

use rocking_block::block::restraints::tie;

use crate::beyond_cases::{Case, Change, cases, cases_with_links, instants};
use crate::common::{Record, inputs_at, record_named};
use crate::compare::check_cases;
use crate::event_lines::LoggedEvent;
use crate::functions::*;
use crate::host::{Instance, call};

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
    let block = case.block();
    let mut links = tie::names(block.ties());
    links.extend(
        [1, 2]
            .map(|number| format!("tie_{number}"))
            .into_iter()
            .filter(|name| !links.contains(name))
            .collect::<Vec<_>>(),
    );
    let force = |i: usize| format!("{}.{}", links[i], if links[i].starts_with("tie") { "tension" } else { "force" });
    let plastic = |i: usize| format!("{}.plastic", links[i]);
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
            (&force(0), row.tension_1.unwrap_or(0.0), case.mass * case.g),
            (&force(1), row.tension_2.unwrap_or(0.0), case.mass * case.g),
            (&plastic(0), row.plastic_1.unwrap_or(0.0), r0),
            (&plastic(1), row.plastic_2.unwrap_or(0.0), r0),
        ] {
            let found = instance.get(of);
            if (found - expected).abs() > CLOSE * size && wrong.len() < 5 {
                wrong.push(format!("{name}: {of} = {found}, not {expected}, in row {i}"));
            }
        }
    }
    let logged: Vec<LoggedEvent> =
        instance.messages().into_iter().map(|message| LoggedEvent::read(&message.text)).collect();
    if !case.links.is_empty() {
        wrong.extend(differing(case, &logged, &links));
        return Ok(wrong);
    }
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

/// Compares the events of the log with those of a case with ties and dampers that yield, instant by instant.
fn differing(case: &Case, logged: &[LoggedEvent], links: &[String]) -> Vec<String> {
    let (name, mut wrong) = (&case.name, Vec::new());
    // The log does not tell the direction of a slide.
    let without_slip = |change: &Change| match change {
        Change::Regime { regime, .. } => Change::Regime { regime: *regime, slip: 0 },
        Change::Tie(_) => change.clone(),
    };
    let found: Vec<(f64, Change)> = logged.iter().map(|event| (event.time, change(event, links))).collect();
    let expected: Vec<_> = case.events.iter().map(|(time, change)| (*time, without_slip(change))).collect();
    let [(found, pauses), (expected, expected_pauses)] = [instants(&found), instants(&expected)];
    assert_eq!(pauses.len(), expected_pauses.len(), "{name}: {pauses:?}, not {expected_pauses:?}");
    if found.len() != expected.len() {
        wrong.push(format!("{name}: {} instants, not {}", found.len(), expected.len()));
    }
    let mut pairs = found.iter().zip(&expected);
    let differs = |(a, b): &(&(f64, _), &(f64, _))| a.1 != b.1 || (a.0 - b.0).abs() > CLOSE;
    wrong.extend(pairs.find(differs).map(|(found, expected)| format!("{name}: {found:?}, not {expected:?}")));
    wrong
}

/// Returns the change that an event of the log tells; `links` are the names of the ties and dampers.
fn change(event: &LoggedEvent, links: &[String]) -> Change {
    let link = links.iter().position(|link| event.what.starts_with(&format!("{} ", link.replace('_', " "))));
    let Some(link) = link else { return Change::Regime { regime: event.after, slip: 0 } };
    let word = match event.what.split(' ').next_back() {
        Some("yields") => "yield",
        Some("unloads") => "unload",
        Some("breaks") => "break",
        _ => "tie",
    };
    Change::Tie(format!("{word}{link}"))
}

/// θ, the places and the plastic elongations within 1e-7 of α and of R0, with the same events within 1e-7 s.
#[test]
fn trajectories_of_ties_and_dampers_that_yield() {
    check_cases(&cases_with_links(), |case| &case.name, run);
}

/// θ and the places within 1e-7 of α and of R0, with the same events within 1e-7 s.
#[test]
fn trajectories_match_the_references() {
    check_cases(&cases(), |case| &case.name, run);
}
