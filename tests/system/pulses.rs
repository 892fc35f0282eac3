//! Excitation: pulses against the paper's ground velocities, ramps, and the drift of the ground.

use std::f64::consts::{PI, TAU};

use rocking_block::block::Foundation;
use rocking_block::excitation::{Excitation, Forcing, Inputs, Pulse, PulseShape, Ramp};

use crate::blocks::uneven;

const START: f64 = 0.3;
const PERIOD: f64 = 0.8;
const AMPLITUDE: f64 = 2.5;
const SHAPES: [PulseShape; 4] = [PulseShape::OneSine, PulseShape::OneCosine, PulseShape::C1, PulseShape::C2];

fn pulse(shape: PulseShape) -> Pulse {
    Pulse { shape, amplitude: AMPLITUDE, period: PERIOD, start: START }
}

/// Returns φ of a type-Cn pulse, by bisection of the paper's condition of zero final displacement.
fn phase(n: f64) -> f64 {
    let comes_back = |phi: f64| {
        let turns = (2.0 * n + 1.0) * PI;
        (turns - phi).cos() + (turns - 2.0 * phi) * phi.sin() - phi.cos()
    };
    let (mut low, mut high) = (1e-3, 0.5);
    assert!(comes_back(low) < 0.0 && comes_back(high) > 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if comes_back(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Returns the ground velocity (m/s) of the paper's Table I at a time after the start, and the duration (s).
fn velocity(shape: PulseShape, t: f64) -> (f64, f64) {
    let omega = TAU / PERIOD;
    let c = |n: f64| {
        let phi = phase(n);
        (AMPLITUDE / omega * ((omega * t + phi).sin() - phi.sin()), (n + 0.5 - phi / PI) * PERIOD)
    };
    match shape {
        PulseShape::None => (0.0, 0.0),
        PulseShape::OneSine => (AMPLITUDE / omega * (1.0 - (omega * t).cos()), PERIOD),
        PulseShape::OneCosine => (AMPLITUDE / omega * (omega * t).sin(), PERIOD),
        PulseShape::C1 => c(1.0),
        PulseShape::C2 => c(2.0),
    }
}

#[test]
fn accelerations_are_derivatives_of_the_papers_ground_velocities() {
    for shape in SHAPES {
        let pulse = pulse(shape);
        let (_, duration) = velocity(shape, 0.0);
        assert!((pulse.duration() - duration).abs() < 1e-13, "{shape:?}: {} s, not {duration}", pulse.duration());
        assert_eq!(pulse.end(), START + pulse.duration());
        let h = 1e-5;
        for i in 1..50 {
            let t = duration * f64::from(i) / 50.0;
            let exact = (velocity(shape, t + h).0 - velocity(shape, t - h).0) / (2.0 * h);
            let found = pulse.acceleration(START + t);
            assert!((found - exact).abs() < 1e-7, "{shape:?} at {t} s: {found}, not {exact}");
        }
        // The peak acceleration is a_p, and the ground stands still at the end.
        let greatest = (0..4000).map(|i| pulse.acceleration(START + duration * f64::from(i) / 4000.0).abs());
        assert!((greatest.fold(0.0, f64::max) / AMPLITUDE - 1.0).abs() < 1e-5, "{shape:?}");
        assert!(velocity(shape, duration).0.abs() < 1e-13, "{shape:?}");
    }
}

#[test]
fn pulses_act_from_start_to_end() {
    for shape in SHAPES {
        let pulse = pulse(shape);
        let (start, end) = (START, pulse.end());
        assert!(pulse.acts_at(start) && pulse.acts_at(0.5 * (start + end)), "{shape:?}");
        assert!(
            !pulse.acts_at(start.next_down()) && !pulse.acts_at(end) && pulse.acts_at(end.next_down()),
            "{shape:?}"
        );
        assert_eq!((pulse.acceleration(start.next_down()), pulse.acceleration(end)), (0.0, 0.0));
        let kinks = [0.0, start.next_down(), start, end.next_down(), end].map(|time| pulse.next_kink(time));
        assert_eq!(kinks, [Some(start), Some(start), Some(end), Some(end), None]);
    }
    let none = pulse(PulseShape::None);
    assert_eq!((none.duration(), none.next_kink(0.0), none.acceleration(START)), (0.0, None, 0.0));
    assert!(!none.acts_at(START));
}

/// Returns ramps of all inputs.
fn inputs() -> Inputs {
    let ramp = |value, rate| Ramp { value, rate };
    Inputs {
        time: 0.2,
        a_gx: ramp(1.3, -2.0),
        a_gz: ramp(-0.8, 1.5),
        f_x: ramp(2.0, 11.0),
        f_z: ramp(-3.0, 5.0),
        m_y: ramp(1.1, -4.0),
    }
}

#[test]
fn loads_count_as_ground_accelerations() {
    let block = uneven(Foundation::Viscoelastic, 0.2);
    for shape in SHAPES {
        let pulse = pulse(shape);
        let excitation = Excitation::from_time(0.5, &inputs(), &pulse, &block);
        for time in [0.5, 0.77, 1.0] {
            let since = time - 0.2;
            let forcing = excitation.at(time);
            let x = 1.3 - 2.0 * since - (2.0 + 11.0 * since) / block.mass + pulse.acceleration(time);
            let z = -0.8 + 1.5 * since - (-3.0 + 5.0 * since) / block.mass;
            let moment = (1.1 - 4.0 * since) / block.mass;
            for (found, exact) in [(forcing.x, x), (forcing.z, z), (forcing.moment, moment)] {
                assert!((found - exact).abs() < 1e-14, "{shape:?} at {time} s: {found}, not {exact}");
            }
            let h = 1e-5;
            let [before, after] = [-h, h].map(|elapsed| excitation.at(time + elapsed));
            let Forcing { x, z, moment, .. } = excitation.rate_at(time);
            for (found, change) in
                [(x, after.x - before.x), (z, after.z - before.z), (moment, after.moment - before.moment)]
            {
                assert!((found - change / (2.0 * h)).abs() < 1e-6, "{shape:?} at {time} s: {found}");
            }
        }
        assert_eq!(excitation.frequency(), TAU / PERIOD);
    }
    let quiet = Excitation::from_time(0.1, &inputs(), &pulse(PulseShape::OneSine), &block);
    assert_eq!(quiet.frequency(), 0.0, "the pulse has not begun");
    assert_eq!(Excitation::none().at(3.0), Forcing::default());
}

/// The drift gives velocity and displacement of a free body, by Simpson's rule.
#[test]
fn the_drift_is_the_integral_of_the_forcing() {
    let block = uneven(Foundation::Viscoelastic, 0.2);
    for shape in [PulseShape::None, PulseShape::OneSine, PulseShape::OneCosine, PulseShape::C1, PulseShape::C2] {
        let excitation = Excitation::from_time(0.5, &inputs(), &pulse(shape), &block);
        let (from, to, steps) = (0.55, 0.95, 200);
        let h = (to - from) / f64::from(steps);
        let (mut velocity, mut displacement) = (0.0, 0.0);
        for i in 0..=steps {
            let time = from + h * f64::from(i);
            let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            let x = excitation.at(time).x;
            velocity += weight * x * h / 3.0;
            // ∫∫ x dt dt = ∫ (to − t) x dt.
            displacement += weight * (to - time) * x * h / 3.0;
        }
        let found = excitation.horizontal_drift(from, to);
        let close = (found.0 - velocity).abs() < 1e-9 && (found.1 - displacement).abs() < 1e-9;
        assert!(close, "{shape:?}: {found:?}, not {velocity} {displacement}");
    }
}

#[test]
fn inputs_do_not_depend_on_their_reference_time() {
    let (inputs, moved) = (inputs(), inputs().moved_to(0.9));
    assert_eq!(moved.time, 0.9);
    let block = uneven(Foundation::Viscoelastic, 0.2);
    let [a, b] = [inputs, moved].map(|inputs| Excitation::from_time(0.9, &inputs, &Pulse::NONE, &block));
    for time in [0.2, 0.9, 1.4] {
        let (a, b) = (a.at(time), b.at(time));
        assert!((a.x - b.x).abs() < 1e-14 && (a.z - b.z).abs() < 1e-14 && (a.moment - b.moment).abs() < 1e-14);
    }
}
