//! Excitation: pulses against the paper's ground velocities, ramps, and the drift of the ground.

use std::f64::consts::{PI, TAU};

use rocking_block::block::Foundation;
use rocking_block::excitation::{Excitation, Forcing, Pulse, PulseShape};

use crate::blocks::{ramps, shapes, uneven};

const START: f64 = 0.3;
const PERIOD: f64 = 0.8;
const AMPLITUDE: f64 = 2.5;
const CYCLES: f64 = 2.3;

fn pulse(shape: PulseShape) -> Pulse {
    // With this phase the peak acceleration of a Gabor pulse is that in its middle, ω_p A.
    Pulse { shape, amplitude: AMPLITUDE, period: PERIOD, start: START, phase: -0.5 * PI, cycles: CYCLES }
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

/// Returns β of the antisymmetric Ricker wavelet, the peak of its acceleration; the paper gives 1.3801.
fn beta() -> f64 {
    let values = (0..200_000).map(|i| 1e-5 * f64::from(i)).map(|y| (3.0 * y - y.powi(3)) * (-0.5 * y * y).exp());
    let beta = values.fold(0.0, f64::max);
    assert!((beta - 1.3801).abs() < 5e-5, "β = {beta}");
    beta
}

/// Returns the published ground velocity (m/s) at a time after the start, and the duration (s).
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
        PulseShape::HalfSine => (AMPLITUDE / omega * (1.0 - (omega * t).cos()), 0.5 * PERIOD),
        PulseShape::Rectangular => (AMPLITUDE * t, PERIOD),
        PulseShape::SymmetricRicker => {
            let tau = t - 1.5 * PERIOD;
            let exponent = (PI * tau / PERIOD).powi(2);
            (AMPLITUDE * tau * (-exponent).exp(), 3.0 * PERIOD)
        }
        PulseShape::AntisymmetricRicker => {
            let scale = 3.0_f64.sqrt() * PERIOD / TAU;
            let y = (t - 2.0 * PERIOD) / scale;
            (AMPLITUDE * scale / beta() * (1.0 - y * y) * (-0.5 * y * y).exp(), 4.0 * PERIOD)
        }
        PulseShape::Gabor => {
            let tau = t - 0.5 * CYCLES * PERIOD;
            let envelope = 0.5 * (1.0 + (omega * tau / CYCLES).cos());
            (AMPLITUDE / omega * envelope * (omega * tau - 0.5 * PI).cos(), CYCLES * PERIOD)
        }
    }
}

#[test]
fn accelerations_are_derivatives_of_the_published_ground_velocities() {
    for shape in shapes() {
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
            let (found, exact) = (pulse.velocity(START + t), velocity(shape, t).0 - velocity(shape, 0.0).0);
            assert!((found - exact).abs() < 1e-7, "{shape:?} at {t} s: {found} m/s, not {exact} m/s");
        }
        // The peak acceleration is a_p. The ground stands still at the end of every pulse that changes its sign.
        let greatest = (0..4000).map(|i| pulse.acceleration(START + duration * f64::from(i) / 4000.0).abs());
        assert!((greatest.fold(0.0, f64::max) / AMPLITUDE - 1.0).abs() < 1e-5, "{shape:?}");
        let end = match shape {
            PulseShape::HalfSine => AMPLITUDE * PERIOD / PI,
            PulseShape::Rectangular => AMPLITUDE * PERIOD,
            _ => 0.0,
        };
        // Ricker wavelets are cut off below 1e-8 a_p.
        for velocity in [velocity(shape, duration).0, pulse.velocity(pulse.end()), pulse.velocity(pulse.end() + 1.0)] {
            assert!((velocity - end).abs() < 1e-9 * AMPLITUDE, "{shape:?}: {velocity} m/s at the end, not {end}");
        }
        for outside in [pulse.acceleration(START), pulse.acceleration(pulse.end().next_down())] {
            let is_cut = matches!(shape, PulseShape::SymmetricRicker | PulseShape::AntisymmetricRicker);
            assert!(!is_cut || outside.abs() < 1e-8 * AMPLITUDE, "{shape:?}: {outside} m/s²");
        }
    }
}

#[test]
fn pulses_act_from_start_to_end() {
    for shape in shapes() {
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

#[test]
fn loads_count_as_ground_accelerations() {
    let block = uneven(Foundation::Viscoelastic, 0.2);
    for shape in shapes() {
        let pulse = pulse(shape);
        let excitation = Excitation::from_time(0.5, &ramps(), &pulse, &block);
        for time in [0.5, 0.57, 0.69] {
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
        let least = if shape == PulseShape::Rectangular { 0.0 } else { TAU / PERIOD };
        assert!((least..=2.2 * TAU / PERIOD).contains(&excitation.frequency()), "{shape:?}");
    }
    let quiet = Excitation::from_time(0.1, &ramps(), &pulse(PulseShape::OneSine), &block);
    assert_eq!(quiet.frequency(), 0.0, "the pulse has not begun");
    assert_eq!(Excitation::none().at(3.0), Forcing::default());
}

/// The drift gives velocity and displacement of a free body, by Simpson's rule.
#[test]
fn the_drift_is_the_integral_of_the_forcing() {
    let block = uneven(Foundation::Viscoelastic, 0.2);
    // With one cycle a part of a Gabor pulse has no frequency.
    let one_cycle = Pulse { cycles: 1.0, phase: 0.3, ..pulse(PulseShape::Gabor) };
    for pulse in shapes().into_iter().map(pulse).chain([one_cycle, pulse(PulseShape::None)]) {
        let shape = pulse.shape;
        let (from, to) = (START + 0.3 * pulse.duration(), START + 0.8 * pulse.duration() + 0.1);
        let to = to.min(pulse.end().max(from + 0.1));
        let excitation = Excitation::from_time(from, &ramps(), &pulse, &block);
        let steps = 4000;
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
    let (inputs, moved) = (ramps(), ramps().moved_to(0.9));
    assert_eq!(moved.time, 0.9);
    let block = uneven(Foundation::Viscoelastic, 0.2);
    let [a, b] = [inputs, moved].map(|inputs| Excitation::from_time(0.9, &inputs, &Pulse::NONE, &block));
    for time in [0.2, 0.9, 1.4] {
        let (a, b) = (a.at(time), b.at(time));
        assert!((a.x - b.x).abs() < 1e-14 && (a.z - b.z).abs() < 1e-14 && (a.moment - b.moment).abs() < 1e-14);
    }
}
