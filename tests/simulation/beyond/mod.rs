//! Friction, ties and an eccentric centre of mass, compared with independent trajectories.

mod beginning;
mod friction;
mod laws;
mod links;
mod random;
mod ties;

use rocking_block::block::restraints::{LinkKind, RestraintEvent, tie::TieEvent};
use rocking_block::simulation::{Initial, Progress, Settings, Simulation};
use rocking_block::system::events::EventKind;
use rocking_block::system::instant::Footing;

use crate::beyond_cases::{Case, Change, cases, cases_with_links, instants};
use crate::common::{Record, inputs_at, record_named};
use crate::compare::check_cases;

/// Differences of θ from the trajectory, as a part of α, and of event times (s).
const CLOSE: f64 = 1e-7;

/// A random number in [0, 1): splitmix64.
fn random_number(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *seed;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn slips(simulation: &Simulation) -> i32 {
    match simulation.footing() {
        Footing::Slides { direction, .. } => direction as i32,
        Footing::Grips { .. } | Footing::Free { .. } => 0,
    }
}

/// Compares a run with its trajectory; returns a message for each difference.
#[expect(clippy::too_many_lines, reason = "a run and the comparison with each row")]
fn run(case: &Case) -> Result<Vec<String>, String> {
    let records: [Option<Record>; 2] = [record_named(&case.a_gx, case.g)?, None];
    let settings = Settings { tolerance: 1e-10, ..Settings::default() };
    let block = case.block();
    let pulse = case.a_gx.pulse();
    let ties = block.ties().iter().filter(|tie| tie.kind == LinkKind::Tie).count();
    let number = |kind, i: u8| if kind == LinkKind::Tie { usize::from(i) } else { ties + usize::from(i) };
    let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs_at(&records, 0));
    let rows = case.rows();
    let step = records[0].as_ref().map_or(case.dt, |record| record.dt);
    let per_row = (case.dt / step).round() as usize;
    let mut greatest = [0.0_f64; 8];
    let mut events: Vec<(f64, Change)> = vec![];
    for (i, row) in rows.iter().enumerate() {
        for sample in (i * per_row).saturating_sub(per_row)..i * per_row {
            let until = (sample + 1) as f64 * step;
            let inputs = inputs_at(&records, sample);
            while simulation.time() < until || simulation.is_at_event() {
                let mut changes = vec![];
                simulation
                    .apply_pending_event(&inputs, &mut |event| {
                        changes.push(match event.kind {
                            EventKind::Restraint(RestraintEvent::Tie(kind, i, TieEvent::Taut | TieEvent::Slack)) => {
                                Some(format!("tie{}", number(kind, i)))
                            }
                            EventKind::Restraint(RestraintEvent::Tie(kind, i, event)) => {
                                Some(format!("{}{}", event.word(), number(kind, i)))
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
                // Further events of the same instant are applied at once.
                let mut at_once = vec![];
                let observer = &mut |event: &rocking_block::system::events::Event| at_once.push(event.kind);
                let progress = simulation.advance_to_event(until, after, &inputs, observer).unwrap();
                for kind in at_once {
                    if let EventKind::Restraint(RestraintEvent::Tie(of, i, event)) = kind
                        && !case.links.is_empty()
                    {
                        events.push((after, Change::Tie(format!("{}{}", event.word(), number(of, i)))));
                    }
                }

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
            (seen.restraints[0].pull - row.tension_1.unwrap_or(0.0))
                .abs()
                .max((seen.restraints[1].pull - row.tension_2.unwrap_or(0.0)).abs())
                / weight,
            [row.plastic_1, row.plastic_2]
                .into_iter()
                .zip(simulation.plastic_elongations())
                .fold(0.0_f64, |most, (row, found)| most.max((found - row.unwrap_or(found)).abs()))
                / block.r0,
        ];
        for (greatest, difference) in greatest.iter_mut().zip(differences) {
            *greatest = greatest.max(difference.abs());
        }
    }
    let (name, residual) = (&case.name, simulation.energies().residual);
    println!("{name}: θ, θ̇, v, u, N, H, T, s_p within {greatest:?}, residual {residual:.1e} J");
    let mut wrong = vec![];
    // The reactions and θ̇ of a row may be those right before or after an event in it.
    for (of, found, most) in
        [("θ", greatest[0], CLOSE), ("v", greatest[2], CLOSE), ("u", greatest[3], CLOSE), ("s_p", greatest[7], CLOSE)]
    {
        if found.is_nan() || found > most {
            wrong.push(format!("{name}: {of} differs by {found:e}"));
        }
    }
    if case.links.is_empty() {
        wrong.extend(differing(name, &events, &case.lasting_events()));
    } else {
        let [(found, pauses), (expected, expected_pauses)] = [instants(&events), instants(&case.events)];
        wrong.extend(differing(name, &found, &expected));
        wrong.extend(differing(name, &pauses, &expected_pauses));
        println!("{name}: {} instants, {} pauses", found.len(), pauses.len());
    }
    Ok(wrong)
}

/// Returns a message for the first event that differs, and for a different number of events.
fn differing<E: PartialEq + std::fmt::Debug>(name: &str, found: &[(f64, E)], expected: &[(f64, E)]) -> Vec<String> {
    let differs = |found: &(f64, E), expected: &(f64, E)| found.1 != expected.1 || (found.0 - expected.0).abs() > CLOSE;
    let mut pairs = found.iter().zip(expected).enumerate();
    let first = pairs.find(|(_, (found, expected))| differs(found, expected));
    let wrong = first.map(|(i, (found, expected))| format!("{name}: event {i} is {found:?}, not {expected:?}"));
    let count = format!("{name}: {} events, not {}", found.len(), expected.len());
    wrong.into_iter().chain((found.len() != expected.len()).then_some(count)).collect()
}

/// The same with ties and dampers that yield; also the plastic elongations.
#[test]
fn trajectories_with_ties_and_dampers_that_yield() {
    check_cases(&cases_with_links(), |case| &case.name, run);
}

/// θ and the places within 1e-7 of α and of R0, with the same events within 1e-7 s.
#[test]
fn trajectories_match_the_references() {
    check_cases(&cases(), |case| &case.name, run);
}
