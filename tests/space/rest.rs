//! Blocks come to rest in finite work; the lengths of calls have no effect on events.

use rocking_block::excitation::Ramp;
use rocking_block::space::{
    Base, BaseSize, SpaceBody, SpaceEvent, SpaceInitial, SpaceInputs, SpaceParameters, SpaceSupports,
};

use crate::{STILL, advance, of_foot, run, sine, two_axis};

/// A block that is released or thrown rattles to rest by the dashpots: the events end, and all feet stand.
#[test]
fn a_released_block_comes_to_rest() {
    for (tilt, omega, friction) in [
        ([0.05, 0.03], [0.0, 0.0, 0.3], 0.3),
        ([0.05, 0.0], [0.0; 3], 10.0),
        ([0.0, 0.0], [0.2, -0.1, 0.5], 0.0),
        ([-0.02, 0.06], [0.0, 0.1, -0.2], 0.05),
    ] {
        let (parameters, _) = two_axis(friction);
        let body = SpaceBody::new(&parameters).unwrap();
        let initial = SpaceInitial { tilt, omega, vertical: None, ..crate::AT_REST };
        let mut run = run(body, 1e-8, STILL, &initial);
        let events = advance(&mut run, 60.0, &SpaceInputs::default());
        let last = events.last().map_or(0.0, |event: &SpaceEvent| event.time);
        let counts = run.state().counts;
        assert!(last < 50.0 && events.len() < 400, "mu = {friction}: {} events, the last at {last} s", events.len());
        assert!(counts.steps < 20_000, "{counts:?}");
        let seen = run.observe(&SpaceInputs::default());
        assert_eq!(seen.touching(), 4);
        if friction > 0.0 {
            assert!(run.energies().stored.kinetic < 1e-18, "{:?}", run.energies());
        }
        assert!(run.energies().residual.abs() < 1e-7 * run.body().energy_scale(), "{:?}", run.energies());
    }
}

/// A block at rest waits for any time in few steps, and then moves as one that has not waited.
#[test]
fn a_block_at_rest_waits_in_few_steps() {
    let (parameters, pulses) = two_axis(0.3);
    let body = SpaceBody::new(&parameters).unwrap();
    let initial = SpaceInitial { tilt: [0.05, 0.03], vertical: None, ..crate::AT_REST };
    let mut waits = run(body.clone(), 1e-8, STILL, &initial);
    advance(&mut waits, 200.0, &SpaceInputs::default());
    let (steps, tilt) = (waits.state().counts.steps, waits.observe(&SpaceInputs::default()).attitude.tilt);
    let events = advance(&mut waits, 1e6, &SpaceInputs::default());
    assert!(events.is_empty() && waits.time() == 1e6 && waits.state().counts.steps < steps + 2, "{events:?}");
    assert!((waits.observe(&SpaceInputs::default()).attitude.tilt - tilt).abs() < 1e-12);
    // A push still moves it, and a constant one leaves it at another rest.
    let push = SpaceInputs {
        ground: [Ramp { value: 0.5, rate: 0.0 }, Ramp::default(), Ramp::default()],
        ..SpaceInputs::default()
    };
    advance(&mut waits, 1e6 + 200.0, &push);
    let leans = waits.observe(&push).attitude.tilt_x;
    let steps = waits.state().counts.steps;
    advance(&mut waits, 2e6, &push);
    assert!(leans.abs() > 1e-5 && (waits.observe(&push).attitude.tilt_x - leans).abs() < 1e-12, "{leans}");
    assert!(waits.state().counts.steps < steps + 2);
    let mut pulsed = run(body, 1e-8, pulses, &crate::AT_REST);
    assert!(!advance(&mut pulsed, 3.0, &SpaceInputs::default()).is_empty());
}

/// A block thrown straight up has no horizontal force when its feet lift: N and |F| vanish together, and each foot is decided once.
#[test]
fn feet_without_any_force_are_decided_once() {
    let (parameters, _) = two_axis(0.5);
    let body = SpaceBody::new(&parameters).unwrap();
    let initial = SpaceInitial { vertical: Some([0.0, 1.0]), ..crate::AT_REST };
    let mut run = run(body, 1e-9, STILL, &initial);
    let events = advance(&mut run, 10.0, &SpaceInputs::default());
    let lift_offs = run.state().counts.lift_offs;
    assert!(run.state().separated && (4..40).contains(&lift_offs), "{lift_offs}");
    // The feet begin in the air: their dashpots would pull them.
    assert_eq!(lift_offs + 4, run.state().counts.landings);
    assert_eq!(events.len() as u64, 2 * lift_offs + 4, "{events:?}");
    assert!(run.peak_tilt() < 1e-12);
    for foot in 1..4 {
        let [first, other] = [0, foot].map(|foot| of_foot(&events, foot));
        assert!(first.iter().zip(&other).all(|(a, b)| (a.1 - b.1).abs() < 1e-12), "{first:?}, {other:?}");
    }
}

/// Calls of any length give the same events of each foot.
#[test]
fn the_lengths_of_calls_have_no_effect_on_events() {
    let (parameters, pulses) = two_axis(0.5);
    let body = SpaceBody::new(&parameters).unwrap();
    let events_in = |parts: u32| {
        let mut run = run(body.clone(), 1e-10, pulses, &crate::AT_REST);
        let mut events = Vec::new();
        for part in 1..=parts {
            let until = 3.0 * f64::from(part) / f64::from(parts);
            run.advance(until, &SpaceInputs::default(), &mut |event| events.push(*event)).unwrap();
        }
        let seen = run.observe(&SpaceInputs::default());
        (events, seen.attitude)
    };
    let (events, attitude) = events_in(1);
    assert!(events.len() > 15, "{events:?}");
    for parts in [2, 7, 64, 1000, 8191] {
        let (found, end) = events_in(parts);
        assert!((end.tilt - attitude.tilt).abs() < 1e-8, "{parts} parts: {end:?}, not {attitude:?}");
        for foot in 0..4 {
            let [found, expected] = [&found, &events].map(|events| of_foot(events, foot));
            assert_eq!(found.len(), expected.len(), "{parts} parts, foot {foot}: {found:?}, not {expected:?}");
            for (found, expected) in found.iter().zip(&expected) {
                let same = found.0 == expected.0 && (found.1 - expected.1).abs() < 1e-7;
                assert!(same, "{parts} parts, foot {foot}: {found:?}, not {expected:?}");
            }
        }
    }
}

/// Stiff supports under many feet that slide: the run ends within a bounded number of steps.
#[test]
fn stiff_blocks_end_in_reasonable_work() {
    let base = Base::Circle { size: BaseSize::Slenderness { alpha: 0.25, p: 2.0 }, feet: 64 };
    let supports = SpaceSupports::OfRocking { eta: 300.0, xi_v: 0.1 };
    let parameters = SpaceParameters { base, supports, kappa: 2.0, friction: 0.1, ..SpaceParameters::default() };
    let (_, pulses) = two_axis(0.1);
    let mut run = run(SpaceBody::new(&parameters).unwrap(), 1e-8, pulses, &crate::AT_REST);
    advance(&mut run, 3.0, &SpaceInputs::default());
    let counts = run.state().counts;
    println!("{counts:?}");
    assert!(counts.steps < 60_000, "{counts:?}");
    assert!(run.energies().residual.abs() < 1e-7 * run.body().energy_scale(), "{:?}", run.energies());
}

/// A circle on three frictionless feet, with this ratio of its horizontal dashpots.
fn frictionless(xi_h: f64) -> SpaceBody {
    let size = BaseSize::Slenderness { alpha: 0.29577937886016886, p: 3.9269062147015594 };
    let supports = SpaceSupports::OfRocking { eta: 125.21196891789693, xi_v: 0.7304930646525316 };
    let parameters = SpaceParameters {
        base: Base::Circle { size, feet: 3 },
        supports,
        kappa: 3.061353622110922,
        xi_h: Some(xi_h),
        friction: 0.0,
        mass: 3.0,
        ..SpaceParameters::default()
    };
    SpaceBody::new(&parameters).unwrap()
}

/// A pulse without an amplitude is none: a block at rest waits through it, and a drifting one takes the steps of one without pulses.
#[test]
fn pulses_without_amplitude_have_no_effect() {
    let weak = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|direction| sine(0.0, 11.0, 0.3, direction));
    let mut rests = run(frictionless(0.02), 1e-8, weak, &crate::AT_REST);
    advance(&mut rests, 3.0, &SpaceInputs::default());
    assert!(rests.state().counts.steps < 10, "{:?}", rests.state().counts);

    let drifts = SpaceInitial { omega: [0.0, 0.0, 0.4], ..crate::AT_REST };
    let [with, without] = [weak, STILL].map(|pulses| {
        let mut run = run(frictionless(0.02), 1e-8, pulses, &drifts);
        advance(&mut run, 3.0, &SpaceInputs::default());
        run.state().clone()
    });
    assert_eq!(with, without);
}

/// Nothing acts on a frictionless foot horizontally: neither spring nor dashpot there has an effect on the motion or the steps.
#[test]
fn frictionless_feet_have_no_horizontal_springs() {
    let (_, pulses) = two_axis(0.0);
    let states = [0.02, 0.5].map(|xi_h| {
        let released = SpaceInitial { tilt: [0.1, 0.05], vertical: None, ..crate::AT_REST };
        let mut run = run(frictionless(xi_h), 1e-8, pulses, &released);
        advance(&mut run, 3.0, &SpaceInputs::default());
        run.state().clone()
    });
    assert!(states[0].counts.lift_offs > 0 && states[0].peaks.slip > 0.01, "{:?}", states[0]);
    assert!(states[0].counts.steps < 5_000, "{:?}", states[0].counts);
    assert_eq!(states[0], states[1]);
}
