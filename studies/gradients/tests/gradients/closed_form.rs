//! Derivatives against closed forms, which are evaluated in numbers with derivatives themselves.

use rocking_block::block::{Common, Dimensionless, Supports};
use rocking_block::numerics::scalar::{Elementary, Scalar};
use rocking_gradients::{BATCH, Number};

use crate::cases::reference;
use crate::run::Run;

const TOLERANCE: f64 = 1e-10;

fn assert_same(what: &str, ours: Number, exact: Number) {
    assert!((ours.re - exact.re).abs() <= TOLERANCE * exact.re.abs(), "{what}: {ours:?} instead of {exact:?}");
    for (i, (found, expected)) in ours.eps.iter().zip(exact.eps).enumerate() {
        let size = expected.abs().max(exact.re.abs());
        assert!((found - expected).abs() <= TOLERANCE * size, "{what}, direction {i}: {found} instead of {expected}");
    }
}

/// Nodes and weights of Gauss's quadrature of Legendre polynomials over [0, 1].
fn gauss() -> Vec<(f64, f64)> {
    const POINTS: usize = 24;
    (0..POINTS)
        .map(|i| {
            let n = POINTS as f64;
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 0.0;
            for _ in 0..50 {
                let (mut before, mut p) = (1.0, x);
                for k in 2..=POINTS {
                    let k = k as f64;
                    (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
                }
                slope = n * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Time from rest at the rotation θ to the next impact of Housner's block: `φ̈ = p² sin φ` from `φ = α − θ` to α.
fn fall(alpha: Number, p: Number, theta: Number) -> Number {
    // With φ = α − θ + s² the integrand is smooth.
    let (root, start) = (theta.sqrt(), alpha - theta);
    let sum = gauss().into_iter().fold(Number::from(0.0), |sum, (node, weight)| {
        let square = root * node * (root * node);
        let under = (start + square * 0.5).sin() * (square * 0.5).sin() * 4.0;
        sum + root * node * 2.0 * weight / under.sqrt()
    });
    sum * root / p
}

/// Housner's free rocking: the times of all impacts, the amplitudes between them, and the first peak.
#[test]
fn free_rocking_of_housners_block() {
    let names = ["alpha", "p", "restitution_factor", "initial.theta"];
    let mut run = reference("reference", "free_rigid");
    *run.parameters.number("restitution_factor").unwrap() = 0.97;
    run.rows = 90;
    let found = run.gradients(&names);
    let number = |i: usize| {
        let mut eps = [0.0; BATCH];
        eps[i] = 1.0;
        Number::new(run.value(names[i]), eps)
    };
    let [alpha, p, factor, tilt] = [0, 1, 2, 3].map(number);
    let gamma = Number::from(3.0);
    let e = factor * ((gamma * (alpha * 2.0).cos() + 1.0) / (gamma + 1.0));
    let (mut amplitude, mut time) = (tilt, fall(alpha, p, tilt));
    assert!(found.events.len() >= 5, "{:?}", found.events);
    for (i, (_, impact)) in found.events.iter().enumerate() {
        assert_same(&format!("impact {i}"), *impact, time);
        // cos(α − θ) − cos α is the kinetic energy of the impact over p².
        let energy = e * e * ((alpha - amplitude).cos() - alpha.cos());
        let cos = energy + alpha.cos();
        let sin = (-(cos * cos) + 1.0).sqrt();
        amplitude = alpha - sin.atan2(cos);
        time = time + fall(alpha, p, amplitude) * 2.0;
    }
    assert_same("peak rotation", found.peaks.theta, tilt);
}

/// A block on the rigid base lifts where a_gx reaches g tan α.
#[test]
fn lift_off_under_a_sine() {
    let names = ["alpha", "pulse.amplitude", "pulse.period", "pulse.start"];
    let mut run = reference("reference", "sine_rigid");
    run.parameters.pulse.start = 0.3;
    run.rows = 5;
    let found = run.gradients(&names);
    let number = |i: usize| {
        let mut eps = [0.0; BATCH];
        eps[i] = 1.0;
        Number::new(run.value(names[i]), eps)
    };
    let [alpha, amplitude, period, start] = [0, 1, 2, 3].map(number);
    let g = Number::from(9.81);
    let (sin, cos) = alpha.sin_cos();
    let time = start + (g * sin / cos / amplitude).asin() * period / Number::from(std::f64::consts::TAU);
    assert_same("lift-off", found.events[0].1, time);
}

/// A stout block on the rigid base slides under a sine from where a_gx reaches μ g on, without rocking.
fn sliding() -> Run {
    let mut run = reference("reference", "sine_rigid");
    let common = Common { friction: 0.3, gravity: 9.81, ..Common::default() };
    run.parameters.block = Dimensionless { alpha: 0.6, p: 2.0, supports: Supports::HOUSNER }.with(&common);
    run.parameters.pulse.amplitude = 5.0;
    run
}

#[test]
fn sliding_under_a_sine() {
    let names = ["friction", "g", "pulse.amplitude", "pulse.period"];
    let mut run = sliding();
    (run.step, run.rows) = (0.05, 10);
    let found = run.gradients(&names);
    let number = |i: usize| {
        let mut eps = [0.0; BATCH];
        eps[i] = 1.0;
        Number::new(run.value(names[i]), eps)
    };
    let [friction, g, amplitude, period] = [0, 1, 2, 3].map(number);
    let omega = Number::from(std::f64::consts::TAU) / period;
    let limit = friction * g;
    let start = (limit / amplitude).asin() / omega;
    assert_same("slip", found.events[0].1, start);
    assert_eq!(found.events.len(), 1, "{:?}", found.events);
    // ü = −a_p sin ωt + μ g from there on.
    for (time, row) in found.rows.iter().filter(|(time, _)| *time > start.re) {
        let (t, begin) = (Number::from(*time), omega * start);
        let elapsed = t - start;
        let rate = amplitude / omega * ((omega * t).cos() - begin.cos()) + limit * elapsed;
        let place = amplitude / omega * (((omega * t).sin() - begin.sin()) / omega - begin.cos() * elapsed)
            + limit * elapsed * elapsed * 0.5;
        assert_same(&format!("u̇ at {time}"), row.u_dot, rate);
        assert_same(&format!("u at {time}"), row.u, place);
    }
    let last = found.rows.last().unwrap().1;
    assert_same("slip", found.slip, last.u);
}
