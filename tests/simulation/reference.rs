//! Runs of the solver compared with the independent reference trajectories.

use rocking_block::excitation::Inputs;
use rocking_block::simulation::{Ending, Progress, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};

use crate::common::{Case, cases, inputs_at, record_step};
use crate::compare::{Comparison, RecordedEvent, RecordedRow, Tolerance, check_cases};

/// Compares a run with its trajectory, or returns the name of a missing record.
fn run(case: &Case, tolerance: Tolerance) -> Result<Vec<String>, String> {
    let records = case.records()?;
    let mut simulation = case.start(
        match tolerance {
            Tolerance::Tight => 1e-10,
            Tolerance::Default => Settings::default().tolerance,
        },
        &records,
    );
    let mut events = Vec::new();
    let mut end = None;
    let step = record_step(&records).unwrap_or(case.dt);
    let per_row = (case.dt / step).round() as usize;
    let rows = case.rows();
    let mut compared = Comparison::of(case, &rows);
    compared.row(&rows[0], &seen(&simulation, &inputs_at(&records, 0)));
    let mut sample = 0;
    while end.is_none() && simulation.time() < case.t_end {
        let inputs = inputs_at(&records, sample);
        sample += 1;
        let until = (sample as f64 * step).min(case.t_end);
        let progress = simulation
            .advance(until, &inputs, &mut |event| {
                events.push(RecordedEvent {
                    time: event.time,
                    before: event.before.number(),
                    after: event.after.number(),
                    overturns: event.kind == EventKind::Overturning,
                });
            })
            .unwrap();
        match progress {
            Progress::Ended(ending, time) => end = Some((ending, time)),
            Progress::Reached if sample % per_row == 0 => match rows.get(sample / per_row) {
                Some(row) => compared.row(row, &seen(&simulation, &inputs)),
                None => compared.complain(&format!("goes on to {until} s, where the trajectory has ended")),
            },
            Progress::Reached => {}
        }
    }
    compared.events(&events);
    let counts = simulation.counts();
    let (found, expected) = ([counts.impacts, counts.liftoffs], impacts_and_liftoffs(case));
    if found != expected {
        compared.complain(&format!("{found:?} impacts and lift-offs should be {expected:?}"));
    }
    match end {
        None => compared.end("completed", simulation.time()),
        Some((Ending::Separated, time)) => compared.end("separated", time),
        Some((Ending::Toppled | Ending::Overturned, time)) => compared.end("overturned", time),
    }
    Ok(compared.judge(tolerance))
}

/// Counts landings and lift-offs by the regimes of the trajectory.
///
/// At an event without a change of regime, the corner that landed has lifted again.
fn impacts_and_liftoffs(case: &Case) -> [u32; 2] {
    let touching = |regime: i64| [matches!(regime, -1 | 0), matches!(regime, 0 | 1)];
    let mut counts = [0; 2];
    for (_, before, after) in &case.events {
        let Some(after) = after.as_i64() else { continue };
        if i64::from(*before) == after {
            counts = counts.map(|count| count + 1);
        }
        for (before, after) in touching(i64::from(*before)).into_iter().zip(touching(after)) {
            counts[0] += u32::from(!before && after);
            counts[1] += u32::from(before && !after);
        }
    }
    counts
}

fn seen(simulation: &Simulation, inputs: &Inputs) -> RecordedRow {
    let (x, energies) = (simulation.observe(inputs), simulation.energies());
    RecordedRow {
        theta: x.theta,
        theta_dot: x.theta_dot,
        v: x.v,
        v_dot: x.v_dot,
        reaction: x.reaction,
        horizontal: x.horizontal,
        energy: energies.total,
        residual: energies.residual,
        regime: simulation.regime().number(),
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

/// At each tolerance down to the default, θ/α is within the tolerance, with the events of the reference.
#[test]
fn theta_is_within_the_tolerance() {
    let mut failures = Vec::new();
    for case in cases() {
        // The other tests report missing records.
        let Ok(records) = case.records() else { continue };
        let rows = case.rows();
        let step = record_step(&records).unwrap_or(case.dt);
        let per_row = (case.dt / step).round() as usize;
        for tolerance in [1e-4, 1e-5, 1e-6, Settings::default().tolerance] {
            let mut simulation = case.start(tolerance, &records);
            let (mut events, mut sample, mut greatest, mut residual) = (Vec::new(), 0, 0.0_f64, 0.0_f64);
            let mut ended = false;
            while !ended && simulation.time() < case.t_end {
                let inputs = inputs_at(&records, sample);
                sample += 1;
                let mut event = |event: &Event| {
                    let overturns = event.kind == EventKind::Overturning;
                    let after = if overturns { "overturned".into() } else { event.after.number().into() };
                    events.push((event.before.number(), after));
                };
                let progress = simulation.advance((sample as f64 * step).min(case.t_end), &inputs, &mut event).unwrap();
                ended = matches!(progress, Progress::Ended(..));
                if let Some(row) = rows.get(sample / per_row).filter(|_| !ended && sample % per_row == 0) {
                    // See `SENSITIVE` in tests/common/compare.rs.
                    let sensitive = case.name == "bridge_rinaldi_pad_S10" && row.t > 8.0 && tolerance < 1e-7;
                    let most = if sensitive { 20.0 * tolerance } else { tolerance };
                    let off = (simulation.observe(&inputs).theta - row.theta).abs() / case.block().alpha;
                    greatest = greatest.max(off / most);
                }
                residual = residual.max(simulation.energies().residual.abs());
            }
            let greatest_energy = rows.iter().fold(0.0_f64, |most, row| most.max(row.energy.abs()));
            println!(
                "{} at {tolerance:e}: theta {greatest:.2} of the tolerance, residual {:.1e} of the greatest energy",
                case.name,
                residual / greatest_energy
            );
            if greatest > 1.0 {
                failures.push(format!("{} at {tolerance:e}: theta is off by {greatest:.2} tolerances", case.name));
            }
            // Works accumulate the errors of all steps; see docs/code/integrator.md.
            let most = (5.0 * tolerance).min(1e-5);
            if residual > most * greatest_energy {
                failures.push(format!("{} at {tolerance:e}: residual {residual:e}", case.name));
            }
            let expected: Vec<_> = case.events.iter().map(|(_, before, after)| (*before, after.clone())).collect();
            if events != expected {
                failures.push(format!("{} at {tolerance:e}: {events:?} should be {expected:?}", case.name));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}
