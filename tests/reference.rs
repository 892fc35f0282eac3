//! The independent reference trajectories, through the solver.

mod common;

use rocking_block::block::Foundation;
use rocking_block::events::{Event, EventKind};
use rocking_block::simulation::{Ending, Progress};

use common::{Case, cases, inputs_at, record_step};

struct Outcome {
    theta_error: f64,
    end_error: f64,
    state_error: f64,
    wrong_rows: usize,
    reaction_error: f64,
    residual: f64,
    evaluations: u64,
    wrong_regimes: Option<String>,
    end: &'static str,
}

/// Runs a case and compares it with its trajectory.
fn run(case: &Case, tolerance: f64) -> Option<Outcome> {
    let records = match case.records() {
        Ok(records) => records,
        Err(name) => {
            println!("{}: left out, its record {name} may not be redistributed and is not at hand", case.name);
            return None;
        }
    };
    let block = case.block();
    let mut simulation = case.start(tolerance, &records);
    let mut events: Vec<Event> = Vec::new();
    let step = record_step(&records).unwrap_or(case.dt);
    let per_row = (case.dt / step).round() as usize;
    let (mut state_error, mut wrong_rows) = (0.0_f64, 0);
    let (mut theta_error, mut reaction_error, mut residual, mut scale): (f64, f64, f64, f64) = (0.0, 0.0, 0.0, 0.0);
    let mut ended = None;
    for (i, row) in case.rows().iter().enumerate() {
        if i > 0 {
            for sample in (i - 1) * per_row..i * per_row {
                let until = (sample + 1) as f64 * step;
                let progress = simulation
                    .advance(until.min(case.t_end), &inputs_at(&records, sample), &mut |event| events.push(*event))
                    .unwrap();
                if let Progress::Ended(ending, time) = progress {
                    ended = Some((ending, time));
                }
            }
        }
        if ended.is_some() {
            break;
        }
        let sample = (i * per_row).saturating_sub(1);
        let seen = simulation.observe(&inputs_at(&records, sample));
        theta_error = theta_error.max((seen.theta - row.theta).abs() / block.alpha);
        let weight = block.mass * block.gravity;
        let velocity = block.alpha * block.p;
        let others = [
            (seen.theta_dot - row.theta_dot) / velocity,
            (seen.v - row.v) / (block.r0 * block.alpha),
            (seen.v_dot - row.v_dot) / (block.r0 * velocity),
            (simulation.energies().total - row.energy) / (weight * block.r0 * block.alpha),
        ];
        // Rows at the instant of an event hold the state before it, ours the one after.
        if case.events.iter().all(|event| (event.0 - row.t).abs() > 1e-9) {
            state_error = others.into_iter().fold(state_error, |worst, error| worst.max(error.abs()));
            wrong_rows += usize::from(simulation.regime().number() != row.regime);
        }
        if i > 0 && block.foundation == Foundation::Viscoelastic && row.t < case.t_final - 1e-9 {
            reaction_error = reaction_error.max((seen.reaction[0] - row.n_l).abs() / weight);
            reaction_error = reaction_error.max((seen.reaction[1] - row.n_r).abs() / weight);
            reaction_error = reaction_error.max((seen.horizontal - row.h).abs() / weight);
        }
        let energies = simulation.energies();
        residual = residual.max(energies.residual.abs());
        scale = scale.max(energies.total.abs());
    }
    // A run may end between its last row and its last moment.
    let mut sample = (case.t_final / step) as usize;
    while ended.is_none() && simulation.time() < case.t_final.min(case.t_end) {
        let progress = simulation
            .advance((sample + 1) as f64 * step, &inputs_at(&records, sample), &mut |event| events.push(*event))
            .unwrap();
        if let Progress::Ended(ending, time) = progress {
            ended = Some((ending, time));
        }
        sample += 1;
    }
    let end = match ended {
        None => "completed",
        Some((Ending::Separated, _)) => "separated",
        Some((Ending::Toppled | Ending::Overturned, _)) => "overturned",
    };
    Some(Outcome {
        theta_error,
        end_error: ended.map_or(0.0, |(_, time)| (time - case.t_final).abs()),
        state_error,
        wrong_rows,
        reaction_error,
        residual: residual / scale,
        evaluations: simulation.counts().evaluations,
        wrong_regimes: compare_events(case, &events),
        end,
    })
}

fn compare_events(case: &Case, events: &[Event]) -> Option<String> {
    for (i, (time, before, after)) in case.events.iter().enumerate() {
        let Some(event) = events.get(i) else { return Some(format!("event {i} at {time} is missing")) };
        let overturned = after.as_str() == Some("overturned");
        let same = event.before.number() == *before
            && (overturned && event.kind == EventKind::Overturning
                || after.as_i64() == Some(event.after.number().into()));
        if !same {
            return Some(format!("event {i} should be {before} -> {after} at {time}, is {event}"));
        }
    }
    (events.len() > case.events.len()).then(|| format!("one event too many: {}", events[case.events.len()]))
}

fn check(tolerance: f64, theta_bound: f64) {
    let mut failures = Vec::new();
    for case in cases() {
        let Some(outcome) = run(&case, tolerance) else { continue };
        println!(
            "{:24} theta {:8.1e} alpha, rates and energy {:8.1e}, N and H {:8.1e} Mg, end {:8.1e} s, residual {:8.1e}, {:7} evaluations{}",
            case.name,
            outcome.theta_error,
            outcome.state_error,
            outcome.reaction_error,
            outcome.end_error,
            outcome.residual,
            outcome.evaluations,
            outcome.wrong_regimes.as_deref().map(|text| format!("; {text}")).unwrap_or_default(),
        );
        if outcome.theta_error > theta_bound
            || outcome.end_error > 1e-6
            || outcome.end != case.end
            || outcome.wrong_regimes.is_some()
            || outcome.wrong_rows > 0
            || outcome.residual > 1e-8
        {
            failures.push(case.name);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn at_a_tight_tolerance() {
    check(1e-10, 1e-7);
}

#[test]
fn at_the_default_tolerance() {
    check(1e-8, 1e-5);
}
