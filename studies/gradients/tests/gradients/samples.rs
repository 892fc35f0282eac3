//! Samples inside the steps of a run, against the same run with a stop at each of them.

use rocking_block::simulation::outputs::Observation;
use rocking_gradients::{Follower, Number, Sample, Varied, advance, advance_with_samples};

use crate::cases::{reference, under_record};
use crate::run::Run;

/// Allowed difference, as a part of the greatest value or derivative of its kind.
const TOLERANCE: f64 = 1e-7;

/// Rows nearer to an event (s) may be on either side of it.
const NEAR: f64 = 1e-6;

/// A row: some columns, and the slip.
fn row(x: &Observation<Number>, slip: Number) -> Vec<Number> {
    let [left, right] = x.reaction;
    vec![
        x.theta,
        x.theta_dot,
        x.v,
        x.v_dot,
        x.u_dot,
        left,
        right,
        x.horizontal,
        x.uplift[0],
        x.restraints[0].pull,
        slip,
    ]
}

/// Compares all rows that are not at events, with derivatives with respect to two parameters.
fn check(run: &Run, names: [&str; 2]) {
    let times: Vec<f64> = (0..run.rows).map(|row| (row as f64 + 0.37) * run.step).collect();
    let begin = || {
        let (simulation, ground) = run.begin();
        let varied = Varied::with_respect_to(&run.parameters, simulation.block(), &names).unwrap();
        let follower = Follower::new(&simulation, varied, &ground.inputs_from(0.0).0);
        (simulation, ground, [follower])
    };
    let (mut stopped, ground, mut followers) = begin();
    let mut expected = Vec::new();
    for &time in &times {
        while stopped.time() < time && stopped.ending().is_none() {
            let (inputs, until) = ground.inputs_from(stopped.time());
            advance(&mut stopped, &mut followers, until.min(time), &inputs).unwrap();
        }
        if stopped.ending().is_none() {
            let (inputs, _) = ground.inputs_from(stopped.time());
            expected.push(row(&followers[0].observe(&stopped, &inputs), followers[0].slip()));
        }
    }
    let events: Vec<f64> = followers[0].events().iter().map(|event| event.event.time).collect();

    let (mut simulation, ground, mut followers) = begin();
    let mut found = Vec::new();
    let end = run.rows as f64 * run.step;
    while simulation.time() < end && simulation.ending().is_none() {
        let (inputs, until) = ground.inputs_from(simulation.time());
        let first = found.len();
        let mut take = |number: usize, _: usize, sample: &Sample| {
            assert_eq!(first + number, found.len(), "{}", run.name);
            let (now, along) = (sample.observe(), sample.observe_along());
            let rate = |of: fn(&Observation<Number>) -> Number| of(&along).eps[0] - of(&now).eps[0];
            let rates = [(rate(|x| x.theta), now.theta_dot.re), (rate(|x| x.v), now.v_dot.re)];
            assert!(rates.iter().all(|(one, other)| (one - other).abs() < 1e-9), "{}: {rates:?}", run.name);
            found.push(row(&now, sample.slip()));
        };
        let (stop, ahead) = (until.min(end), &times[first..]);
        let taken = advance_with_samples(&mut simulation, &mut followers, stop, &inputs, ahead, &mut take);
        assert_eq!(first + taken.unwrap(), found.len(), "{}", run.name);
    }
    assert!(simulation.counts().steps < stopped.counts().steps, "{}: a step stopped at a sample", run.name);
    let is_far = |i: usize| events.iter().all(|event| (event - times[i]).abs() > NEAR);
    let rows: Vec<usize> = (0..expected.len()).filter(|&i| is_far(i)).collect();
    assert!(found.len() >= expected.len() && rows.len() + 8 > expected.len(), "{}: {} rows", run.name, found.len());
    for x in 0..expected[0].len() {
        let parts: [fn(&Number) -> f64; 3] = [|x| x.re, |x| x.eps[0], |x| x.eps[1]];
        for (part, of) in parts.into_iter().enumerate() {
            let greatest = rows.iter().map(|&i| of(&expected[i][x]).abs()).fold(0.0, f64::max);
            for &i in &rows {
                let [found, expected] = [&found, &expected].map(|rows| of(&rows[i][x]));
                let off = (found - expected).abs();
                let message = || format!("{}: row {i}, column {x}, part {part}: {found} for {expected}", run.name);
                assert!(off <= TOLERANCE * greatest, "{}, off by {:.1e}", message(), off / greatest);
            }
        }
    }
}

#[test]
fn samples_match_stops_on_supports() {
    check(&reference("reference", "sine_eta40"), ["alpha", "eta"]);
    check(&reference("reference", "cosine_small_block"), ["p", "epsilon"]);
}

#[test]
fn samples_match_stops_on_the_rigid_base() {
    check(&reference("reference", "sine_rigid"), ["alpha", "restitution_factor"]);
    check(&reference("reference", "overturns"), ["alpha", "pulse.amplitude"]);
}

#[test]
fn samples_match_stops_in_flight() {
    let run = Run { flies: true, rows: 30, ..reference("reference", "sine_separates") };
    check(&run, ["alpha", "xi_v"]);
}

#[test]
fn samples_match_stops_with_friction_and_ties() {
    let run = Run { rows: 59, ..reference("reference_more", "slip_030") };
    check(&run, ["alpha", "friction"]);
    check(&run.on_rigid_base(), ["alpha", "friction"]);
    check(&Run { rows: 30, ..reference("reference_more", "guys_slack") }, ["alpha", "tie_1.stiffness"]);
}

/// Steps from sample to sample of the record, with times inside them: short ones at the second tolerance.
#[test]
fn samples_match_stops_under_a_record() {
    for tolerance in [1e-13, 1e-9] {
        let run = Run { step: 0.003, rows: 2000, tolerance, ..under_record("reference", "sine_eta40", 1.0) };
        check(&run, ["eta", "scale"]);
    }
}
