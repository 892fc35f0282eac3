//! Pulses, records, inputs and loads in three directions, and the ends of runs.

use rocking_block::excitation::{Pulse, PulseShape, Ramp};
use rocking_block::numerics::dual::Dual;
use rocking_block::run::{Ending, OnOverturning, OnSeparation, Progress, Settings};
use rocking_block::space::equations::SpaceEquations;
use rocking_block::space::excitation::{SpaceExcitation, SpaceForcing};
use rocking_block::space::{DirectedPulse, SpaceBody, SpaceGround, SpaceInitial, SpaceInputs, SpaceRun, SpaceSetup};
use rocking_records::{ReadOptions, Record, Unit, parse};

use crate::{STILL, advance, held, run, settings, sine, two_axis};

fn body() -> SpaceBody {
    SpaceBody::new(&two_axis(0.5).0).unwrap()
}

/// A pulse with an azimuth is that of both components, and a record pair with an azimuth likewise.
#[test]
fn an_azimuth_turns_both_components() {
    const AZIMUTH: f64 = 0.7;
    let pulse = sine(4.0, 6.0, 0.0, [1.0, 0.0, 0.0]).pulse;
    let turned = [DirectedPulse::horizontal(pulse, AZIMUTH), DirectedPulse::NONE, DirectedPulse::NONE];
    let parts = [
        sine(4.0 * AZIMUTH.cos(), 6.0, 0.0, [1.0, 0.0, 0.0]),
        sine(4.0 * AZIMUTH.sin(), 6.0, 0.0, [0.0, 1.0, 0.0]),
        DirectedPulse::NONE,
    ];
    let [a, b] = [turned, parts].map(|pulses| {
        let mut run = run(body(), 1e-10, pulses, &crate::AT_REST);
        assert!(advance(&mut run, 2.0, &SpaceInputs::default()).len() > 5);
        run.observe(&SpaceInputs::default()).attitude
    });
    assert!((a.tilt_x - b.tilt_x).abs() + (a.tilt_y - b.tilt_y).abs() < 1e-9, "{a:?}, {b:?}");

    let record = |text: &str| {
        let unit = Some(Unit::MetrePerSecondSquared);
        let options = ReadOptions { unit, time_step: Some(0.01), ..ReadOptions::default() };
        parse("record", text.as_bytes(), &options).unwrap()
    };
    let pair = [Some(record("0.0\n1.0\n-1.0\n")), Some(record("0.5\n2.0\n0.0\n")), None];
    let ground = SpaceGround { records: pair, azimuth: AZIMUTH };
    let (inputs, end) = ground.inputs_from(0.005);
    assert!((end - 0.01).abs() < 1e-15);
    let [x, y] = [0.5, 1.25];
    assert!((inputs.ground[0].value - (x * AZIMUTH.cos() - y * AZIMUTH.sin())).abs() < 1e-14);
    assert!((inputs.ground[1].value - (x * AZIMUTH.sin() + y * AZIMUTH.cos())).abs() < 1e-14);
    assert_eq!(ground.inputs_from(0.5), (SpaceInputs { time: 0.5, ..SpaceInputs::default() }, f64::INFINITY));
}

/// Loads F = −M a_g on the centre of mass act as the ground acceleration a_g does.
#[test]
fn loads_act_as_ground_accelerations() {
    let a = [3.0, -1.5, 2.0];
    let loads = SpaceInputs { force: a.map(|a| Ramp::held(-a * body().mass)), ..SpaceInputs::default() };
    let [found, expected] = [loads, held(a)].map(|inputs| {
        let mut run = run(body(), 1e-10, STILL, &crate::AT_REST);
        let events = advance(&mut run, 0.6, &inputs).len();
        (events, run.state().numbers.clone())
    });
    assert!(expected.0 >= 2);
    assert_eq!(found, expected);
}

/// A moment about the vertical twists the block at the rate M_z/I_z at first.
#[test]
fn moments_turn_the_block() {
    let mut moment = [Ramp::default(); 3];
    moment[2] = Ramp::held(0.2);
    let inputs = SpaceInputs { moment, ..SpaceInputs::default() };
    let mut run = run(body(), 1e-12, STILL, &SpaceInitial { vertical: Some([1.0, 0.0]), ..crate::AT_REST });
    advance(&mut run, 0.1, &inputs);
    let expected = 0.1 * 0.2 / run.body().inertia[(2, 2)];
    let seen = run.observe(&inputs);
    assert!((seen.omega.z - expected).abs() < 1e-12, "{}, not {expected}", seen.omega.z);
    let work = 0.2 * seen.attitude.twist;
    assert!((run.energies().input - work).abs() < 1e-12);
}

/// Inputs that change linearly over a call are those of samples: a record in steps is the record inside.
#[test]
fn inputs_over_steps_are_records() {
    let samples: Vec<f64> = (0..200).map(|i| 4.0 * libm::sin(0.06 * f64::from(i))).collect();
    let text: String = samples.iter().map(|a| format!("{a}\n")).collect();
    let unit = Some(Unit::MetrePerSecondSquared);
    let options = ReadOptions { unit, time_step: Some(0.01), ..ReadOptions::default() };
    let record: Record = parse("record", text.as_bytes(), &options).unwrap();
    let ground = SpaceGround { records: [None, Some(record), None], azimuth: 0.0 };
    let mut inside = run(body(), 1e-9, STILL, &crate::AT_REST);
    let mut outside = inside.clone();
    let mut events = [Vec::new(), Vec::new()];
    for i in 0..199 {
        let (time, until) = (0.01 * i as f64, 0.01 * (i + 1) as f64);
        let (inputs, _) = ground.inputs_from(time + 1e-9);
        inside.advance(until, &inputs, &mut |event| events[0].push(*event)).unwrap();
        let ramp = Ramp { value: samples[i], rate: (samples[i + 1] - samples[i]) / 0.01 };
        let inputs = SpaceInputs { time, ground: [Ramp::default(), ramp, Ramp::default()], ..SpaceInputs::default() };
        outside.advance(until, &inputs, &mut |event| events[1].push(*event)).unwrap();
    }
    assert!(events[0].len() > 5 && events[0].len() == events[1].len(), "{events:?}");
    let [a, b] = [inside, outside].map(|run| run.observe(&SpaceInputs::default()).attitude.tilt);
    assert!((a - b).abs() < 1e-9, "{a}, {b}");
}

/// Duals give the derivatives of the accelerations with respect to the forcing: M V̇ = … − M a, J ω̇ = … + M_load.
#[test]
fn duals_are_the_derivatives_with_respect_to_inputs() {
    let run = run(body(), 1e-9, STILL, &SpaceInitial { tilt: [0.05, 0.02], vertical: None, ..crate::AT_REST });
    let excitation = SpaceExcitation::new(0.0, &SpaceInputs::default(), &STILL, 1.0);
    let equations = SpaceEquations { body: run.body(), contacts: &run.state().contacts, excitation: &excitation };
    let state: Vec<Dual> = run.state().numbers.iter().map(|&x| Dual::from(x)).collect();
    let mut rates = vec![Dual::default(); state.len()];
    let axis = |i: usize, unit: f64| nalgebra::Vector3::from_fn(|j, _| Dual::new(0.0, if i == j { unit } else { 0.0 }));
    for i in 0..3 {
        let forcing = SpaceForcing { acceleration: axis(i, 1.0), moment: axis(i, 0.0) };
        equations.rates_under(&forcing, &state, &mut rates);
        for j in 0..3 {
            assert_eq!(rates[7 + j].eps, if i == j { -1.0 } else { 0.0 });
            assert_eq!(rates[10 + j].eps, 0.0);
        }
        let forcing = SpaceForcing { acceleration: axis(i, 0.0), moment: axis(i, 1.0) };
        equations.rates_under(&forcing, &state, &mut rates);
        // I_x = 3.71, I_y = 3.56 at a small tilt.
        let inertia = run.body().inertia[(i, i)];
        assert!((rates[10 + i].eps * inertia - 1.0).abs() < 0.05, "{}", rates[10 + i].eps * inertia);
        assert_eq!(rates[7 + i].eps, 0.0);
    }
}

/// A run ends where no foot touches, as separated or as toppled, or goes on with the block held.
#[test]
fn runs_end_at_separation() {
    let jump = [sine(40.0, 20.0, 0.0, [0.0, 0.0, 1.0]), DirectedPulse::NONE, DirectedPulse::NONE];
    let push = Pulse { shape: PulseShape::Rectangular, amplitude: 9.0, period: 3.0, ..Pulse::NONE };
    let push = [DirectedPulse::horizontal(push, 0.3), DirectedPulse::NONE, DirectedPulse::NONE];
    for (pulses, friction, on_separation, expected) in [
        (jump, 0.5, OnSeparation::Terminate, Some(Ending::Separated)),
        (jump, 0.5, OnSeparation::Hold, Some(Ending::Separated)),
        (jump, 0.5, OnSeparation::Fly, None),
        (push, 10.0, OnSeparation::Fly, Some(Ending::Overturned)),
        (push, 10.0, OnSeparation::Terminate, Some(Ending::Toppled)),
    ] {
        let body = SpaceBody::new(&two_axis(friction).0).unwrap();
        let setup = SpaceSetup {
            body,
            settings: Settings { on_separation, on_overturning: OnOverturning::Terminate, ..settings(1e-8) },
            pulses,
        };
        let mut run = SpaceRun::new(setup, &crate::AT_REST, 0.0);
        let progress = run.advance(3.0, &SpaceInputs::default(), &mut |_| ()).unwrap();
        let case = format!("{on_separation:?}, {expected:?}: {progress:?}");
        assert_eq!(run.state().ending.map(|(ending, _)| ending), expected, "{case}");
        assert_eq!(run.overturns(), expected.is_some_and(Ending::is_overturning), "{case}");
        match (expected, on_separation) {
            (Some(_), OnSeparation::Hold) | (None, _) => assert_eq!((progress, run.time()), (Progress::Reached, 3.0)),
            (Some(_), OnSeparation::Terminate | OnSeparation::Fly) => assert!(run.time() < 3.0, "{case}"),
        }
    }
}
