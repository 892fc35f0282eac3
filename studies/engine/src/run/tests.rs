//! Rows of a run, and its stops.

use super::*;
use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Common, Dimensionless, Ratios, Supports};
use rocking_records::{ReadOptions, Record, Unit, parse};

/// Times of the rows of a block at rest, and the number of stops. Panics beyond `most` stops.
fn rows(ground: &Ground, duration: f64, output_step: f64, most: usize) -> (Vec<f64>, usize) {
    let dimensionless = Dimensionless { alpha: 0.2, p: 1.0, supports: Supports::HOUSNER };
    let common = Common::default();
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let at_rest = Run::at_rest(block, Settings::default());
    let run = Run { ground: ground.clone(), duration: Some(duration), output_step, ..at_rest };
    let mut simulation = run.begin();
    let mut schedule = run.schedule(&simulation);
    let (mut rows, mut stops) = (vec![simulation.time()], 0);
    while let Some(stop) = schedule.next_stop(&simulation) {
        stops += 1;
        assert!(
            stops <= most,
            "{duration} s in rows of {output_step} s do not end: {stops} stops, the last at {stop} s"
        );
        simulation.advance(stop, schedule.inputs(), &mut |_| ()).unwrap();
        if schedule.stopped(&run, &simulation).is_some() {
            rows.push(simulation.time());
        }
    }
    (rows, stops)
}

/// Returns the run at rest of a block with a damper under each corner. Its stiffness (M g/b), yield force (M g) and hardening are these.
fn with_dampers(supports: Supports<Ratios>, [stiffness, yield_force, hardening]: [f64; 3]) -> Run {
    let dimensionless = Dimensionless { alpha: 0.2, p: 1.0, supports };
    let block = Block::from_dimensionless(&dimensionless, &Common::default()).unwrap();
    let (b, weight) = (block.b, block.mass * block.gravity);
    let links = [-1.0, 1.0].map(|side| Tie {
        block: [side * b, 0.0],
        ground: [side * b, -b],
        stiffness: stiffness * weight / b,
        yield_force: yield_force * weight,
        hardening,
        kind: LinkKind::Damper,
        ..Tie::default()
    });
    Run::at_rest(block.with_ties(&links).unwrap(), Settings::default())
}

/// A free motion ends at rest long before the greatest time of the stopping rule. Dampers lock in forces.
#[test]
fn a_block_whose_dampers_have_yielded_comes_to_rest() {
    for supports in [Supports::HOUSNER, Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.1 })] {
        let at_rest = with_dampers(supports, [3.0, 0.05, 0.1]);
        let run = Run { initial: Initial { theta: 0.1, ..Initial::default() }, ..at_rest };
        let outcome = run.outcome();
        assert!(outcome.end == End::Completed && outcome.end_time < 60.0, "{outcome:?}");
        let mut simulation = run.begin();
        simulation.advance(outcome.end_time, &Inputs::default(), &mut |_| ()).unwrap();
        let [left, right, ..] = simulation.plastic_elongations();
        assert!(
            left.abs() + right.abs() > 1e-4 * run.block.b && stopping_rule::is_at_rest(&simulation),
            "{left} {right}"
        );
    }
}

/// Half cycles counted at events are those of a fine history. They lie between its turning points, whatever the stops.
#[test]
fn half_cycles_lie_between_the_turning_points_of_the_history() {
    let at_rest = with_dampers(Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.1 }), [20.0, 0.05, 0.05]);
    let initial = Initial { theta: 0.12, ..Initial::default() };
    let run = Run { initial, duration: Some(12.0), output_step: 1e-3, ..at_rest };
    let history = run.history(|_| ()).unwrap();
    let mut ranges: [Vec<f64>; 2] = Default::default();
    for (number, ranges) in ranges.iter_mut().enumerate() {
        let mut turns = vec![0.0];
        // The tilted block has yielded at its beginning.
        let plastic = history.rows.iter().map(|row| row.observation.restraints[number].plastic);
        let mut path: Vec<f64> = std::iter::once(0.0).chain(plastic).collect();
        path.dedup();
        turns.extend(path.windows(3).filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0).map(|w| w[1]));
        turns.extend(path.last());
        *ranges = turns.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    }
    assert!(ranges.iter().all(|ranges| ranges.len() > 4), "{ranges:?}");
    let mut counts = Vec::new();
    for amplitude in [1e-4, 0.01, 0.05, 0.1] {
        let expected = ranges.each_ref().map(|ranges| ranges.iter().filter(|range| 0.5 * **range > amplitude).count());
        let coarse = Run { output_step: f64::INFINITY, ..run.clone() };
        for run in [&run, &coarse] {
            let found = run.half_cycles(amplitude);
            assert_eq!([found[0] as usize, found[1] as usize], expected, "{amplitude}: {ranges:?}");
            assert_eq!(found[2..], [0; MAX - 2]);
        }
        counts.push(expected[0]);
    }
    assert!(counts[0] > counts[2] && counts[2] > 0, "{counts:?}");
}

/// Durations of a whole number of decimal steps, their neighbouring numbers, and others.
#[test]
fn every_run_ends_with_one_row_at_its_end() {
    let still = |start_time: f64, time_step: f64| {
        let unit = Some(Unit::MetrePerSecondSquared);
        let options = ReadOptions { unit, time_step: Some(time_step), ..ReadOptions::default() };
        let record = parse("still", "0\n".repeat(40).as_bytes(), &options).unwrap();
        Ground { horizontal: Some(Record { start_time, ..record }), vertical: None }
    };
    let grounds = [Ground::default(), still(0.0, 0.015), still(-0.3, 0.01), still(1e5, 0.007)];
    let steps = [0.0001, 0.001, 0.0025, 0.007, 0.01, 0.015, 0.02, 0.03, 0.1, 1.0 / 3.0, 0.7];
    let mut pairs: Vec<(f64, f64, usize)> = Vec::new();
    for step in steps {
        for count in 1..=160_usize {
            // As written by a user: 60 steps of 0.015 are 0.9.
            let decimal: f64 = format!("{:.10}", count as f64 * step).parse().unwrap();
            pairs.extend([decimal, decimal.next_up(), decimal.next_down()].map(|duration| (duration, step, count)));
            pairs.push(((count as f64 - 0.37) * step, step, count));
        }
    }
    for (number, (duration, step, count)) in pairs.into_iter().enumerate() {
        let ground = &grounds[number % grounds.len()];
        let (times, stops) = rows(ground, duration, step, count + 41);
        let start = ground.start();
        // At 1e5 s, rounding of the time exceeds the distance of a decimal duration from its last row.
        let end = start + duration;
        assert_eq!(times.last(), Some(&end), "{duration} s, {step} s");
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{duration} s, {step} s: {times:?}");
        assert!(stops < times.len() + 40);
        if start < 1e5 && step != 1.0 / 3.0 {
            assert_eq!(times.len(), count + 1, "{duration} s, {step} s");
        }
    }
}

/// Invalid steps leave the rows at the start and the end.
#[test]
fn invalid_steps_make_no_rows() {
    for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert_eq!(rows(&Ground::default(), 1.0, step, 1).0, [0.0, 1.0], "{step}");
    }
    for duration in [0.0, -1.0, f64::NAN] {
        assert_eq!(rows(&Ground::default(), duration, 0.1, 1).0, [0.0], "{duration}");
    }
}

/// A pulse beside a still record has the outcome of the pulse alone. It ends before the first sample, or begins before it.
#[test]
fn a_pulse_before_a_record_counts() {
    let dimensionless = Dimensionless { alpha: 0.25, p: 3.0, supports: Supports::HOUSNER };
    let common = Common::default();
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 3.0, period: 0.8, ..Pulse::NONE };
    let alone = Run { pulse, ..Run::at_rest(block, Settings::default()) };
    let options =
        ReadOptions { unit: Some(Unit::MetrePerSecondSquared), time_step: Some(0.01), ..ReadOptions::default() };
    let record = parse("still", "0\n".repeat(40).as_bytes(), &options).unwrap();
    let (expected, end) = (alone.outcome().peaks.theta, alone.outcome().end);
    assert!(expected > 0.1 * block.alpha);
    for (start_time, start) in [(5.0, 0.0), (0.6, 0.0), (0.6, -0.3), (-0.2, 0.1)] {
        let ground = Ground { horizontal: Some(Record { start_time, ..record.clone() }), vertical: None };
        let run = Run { pulse: Pulse { start, ..pulse }, ground, ..alone.clone() };
        assert_eq!(run.start(), f64::min(start, start_time));
        let found = run.outcome();
        assert!((found.peaks.theta / expected - 1.0).abs() < 1e-6, "{start_time} s, {start} s: {found:?}, {expected}");
        assert_eq!(found.end, end);
        let history = run.history(|_| ()).unwrap();
        assert_eq!([history.rows[0].time, history.peaks.theta], [run.start(), found.peaks.theta]);
        let longer = Run { duration: Some(run.longest_duration()), ..run.clone() };
        assert_eq!(longer.outcome().end, end);
    }
}
