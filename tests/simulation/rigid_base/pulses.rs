//! Slender blocks under pulses that push one way, before their first impact, against closed forms.
//!
//! For `α → 0` the rotation `q = −θ/α` away from a push `a` follows `q̈ − p² q = p² (a/(g α) − 1)`.

use std::f64::consts::TAU;

use rocking_block::excitation::{Inputs, Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation};

use super::{G, block, go, seen, start};

const P: f64 = 2.0;
const PERIOD: f64 = 0.9;

/// Rotation and velocity `(q, q̇)` a time `t` (s) after `from`, without excitation.
fn free((q, q_dot): (f64, f64), t: f64) -> (f64, f64) {
    let (sinh, cosh) = ((P * t).sinh(), (P * t).cosh());
    (1.0 + (q - 1.0) * cosh + q_dot / P * sinh, P * (q - 1.0) * sinh + q_dot * cosh)
}

/// The same under a constant push `strength` g α, from rest.
fn rectangular(strength: f64, t: f64) -> (f64, f64) {
    ((strength - 1.0) * ((P * t).cosh() - 1.0), P * (strength - 1.0) * (P * t).sinh())
}

/// The same under half a sine of this strength, which lifts the block where it reaches g α.
fn half_sine(strength: f64, t: f64) -> (f64, f64) {
    let omega = TAU / PERIOD;
    let from = (1.0 / strength).asin() / omega;
    let b = -strength * P * P / (omega * omega + P * P);
    let forced = |t: f64| (1.0 + b * (omega * t).sin(), b * omega * (omega * t).cos());
    let (at, rate) = forced(from);
    let (now, rate_now) = forced(t);
    let (sinh, cosh) = ((P * (t - from)).sinh(), (P * (t - from)).cosh());
    (now - at * cosh - rate / P * sinh, rate_now - P * at * sinh - rate * cosh)
}

#[test]
fn slender_blocks_follow_the_closed_forms_under_pushes() {
    // The closed forms leave out terms of the order of α².
    let alpha = 1e-4;
    let block = block(alpha, P, 0.0);
    type Solution = fn(f64, f64) -> (f64, f64);
    for (shape, duration, pushed) in
        [(PulseShape::Rectangular, PERIOD, rectangular as Solution), (PulseShape::HalfSine, 0.5 * PERIOD, half_sine)]
    {
        for strength in [1.6, 2.0, 3.0] {
            let pulse = Pulse { shape, amplitude: strength * G * alpha, period: PERIOD, ..Pulse::NONE };
            let mut simulation = start(block, OnSeparation::Terminate, pulse, &Initial::default(), &Inputs::default());
            for part in [0.6, 0.9, 1.0, 1.1] {
                let time = part * duration;
                let events = go(&mut simulation, time, &Inputs::default());
                // Lift-off alone.
                assert!(events.len() <= 1, "{shape:?}: {events:?}");
                let (q, q_dot) = match part > 1.0 {
                    true => free(pushed(strength, duration), time - duration),
                    false => pushed(strength, time),
                };
                let now = seen(&simulation);
                for (found, exact) in [(-now.theta / alpha, q), (-now.theta_dot / alpha / P, q_dot / P)] {
                    assert!(
                        (found - exact).abs() < 1e-6,
                        "{shape:?}, {strength} g α at {time} s: {found}, not {exact}"
                    );
                }
            }
        }
    }
}
