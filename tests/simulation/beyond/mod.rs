//! Friction, ties and an eccentric centre of mass, compared with independent trajectories.

mod beginning;
mod friction;
mod random;
mod ties;

use rocking_block::block::restraints::{RestraintEvent, tie::TieEvent};
use rocking_block::simulation::{Initial, Progress, Settings, Simulation};
use rocking_block::system::events::EventKind;
use rocking_block::system::instant::Footing;

use crate::beyond_cases::{Case, Change, cases};
use crate::common::{Record, inputs_at, record_named};
use crate::compare::check_cases;

/// Differences of θ from the trajectory, as a part of α, and of event times (s).
const CLOSE: f64 = 1e-7;

fn slips(simulation: &Simulation) -> i32 {
    match simulation.footing() {
        Footing::Slides { direction, .. } => direction as i32,
        Footing::Grips { .. } | Footing::Free { .. } => 0,
    }
}

/// Compares a run with its trajectory; returns a message for each difference.
fn run(case: &Case) -> Result<Vec<String>, String> {
    let records: [Option<Record>; 2] = [record_named(&case.a_gx, case.g)?, None];
    let settings = Settings { tolerance: 1e-10, ..Settings::default() };
    let block = case.block();
    let pulse = case.a_gx.pulse();
    let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs_at(&records, 0));
    let rows = case.rows();
    let step = records[0].as_ref().map_or(case.dt, |record| record.dt);
    let per_row = (case.dt / step).round() as usize;
    let mut greatest = [0.0_f64; 7];
    let mut events: Vec<(f64, Change)> = vec![];
    for (i, row) in rows.iter().enumerate() {
        for sample in (i * per_row).saturating_sub(per_row)..i * per_row {
            let until = (sample + 1) as f64 * step;
            let inputs = inputs_at(&records, sample);
            while simulation.time() < until || simulation.is_at_event() {
                let mut changes = vec![];
                simulation
                    .settle(&inputs, &mut |event| {
                        changes.push(match event.kind {
                            EventKind::Restraint(RestraintEvent::Tie(tie, TieEvent::Taut | TieEvent::Slack)) => {
                                Some(format!("tie{tie}"))
                            }
                            EventKind::Restraint(RestraintEvent::Tie(tie, TieEvent::Break)) => {
                                Some(format!("break{tie}"))
                            }
                            _ => None,
                        });
                    })
                    .unwrap();
                let state = Change::Regime { regime: simulation.regime().number(), slip: slips(&simulation) };
                for tie in changes {
                    events.push((simulation.time(), tie.map_or(state.clone(), Change::Tie)));
                }
                let after = simulation.time();
                let progress = simulation.advance_to_event(until, after, &inputs, &mut |_| ()).unwrap();
                assert!(matches!(progress, Some(Progress::Reached) | None), "{}: {progress:?}", case.name);
            }
        }
        let seen = simulation.observe(&inputs_at(&records, (i * per_row).saturating_sub(1)));
        let weight = case.mass * case.g;
        let differences = [
            (seen.theta - row.theta) / case.alpha,
            (seen.theta_dot - row.theta_dot) / (case.alpha * case.p),
            (seen.v - row.v) / block.r0,
            (seen.u - row.u) / block.r0,
            (seen.reaction[0] - row.n_l).abs().max((seen.reaction[1] - row.n_r).abs()) / weight,
            (seen.horizontal - row.h) / weight,
            (seen.pull[0] - row.tension_1.unwrap_or(0.0))
                .abs()
                .max((seen.pull[1] - row.tension_2.unwrap_or(0.0)).abs())
                / weight,
        ];
        for (greatest, difference) in greatest.iter_mut().zip(differences) {
            *greatest = greatest.max(difference.abs());
        }
    }
    let (name, residual) = (&case.name, simulation.energies().residual);
    println!("{name}: θ, θ̇, v, u, N, H, T within {greatest:?}, residual {residual:.1e} J");
    let mut wrong = vec![];
    // The reactions and θ̇ of a row may be those right before or after an event in it.
    for (of, found, most) in [("θ", greatest[0], CLOSE), ("v", greatest[2], CLOSE), ("u", greatest[3], CLOSE)] {
        if found.is_nan() || found > most {
            wrong.push(format!("{name}: {of} differs by {found:e}"));
        }
    }
    let expected = case.lasting_events();
    for (i, (found, expected)) in events.iter().zip(&expected).enumerate() {
        if found.1 != expected.1 || (found.0 - expected.0).abs() > CLOSE {
            wrong.push(format!("{name}: event {i} is {found:?}, not {expected:?}"));
            break;
        }
    }
    if events.len() != expected.len() {
        wrong.push(format!("{name}: {} events, not {}", events.len(), expected.len()));
    }
    Ok(wrong)
}

/// θ and the places within 1e-7 of α and of R0, with the same events within 1e-7 s.
#[test]
fn trajectories() {
    check_cases(&cases(), |case| &case.name, run);
}
