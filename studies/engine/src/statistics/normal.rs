//! The standard normal distribution: deviate ↔ probability.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use rocking_block::numerics::roots::sign_change;

/// Density φ(x).
pub fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x) / (2.0 * PI).sqrt()
}

/// Cumulative probability Φ(x).
pub fn probability(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// P(|X| > x), the p-value of both sides of a deviate x ≥ 0.
pub fn p_value(x: f64) -> f64 {
    libm::erfc(x / std::f64::consts::SQRT_2)
}

/// The inverse Mills ratio φ(x)/Φ(x), the derivative of ln Φ(x).
pub fn inverse_mills_ratio(x: f64) -> f64 {
    if x > FAR { density(x) / probability(x) } else { -x / tail(x) }
}

/// ln Φ(x), accurate even where Φ(x) underflows, and its derivative.
pub fn log_probability_and_slope(x: f64) -> (f64, f64) {
    match x {
        0.0.. => {
            let other = probability(-x);
            (libm::log1p(-other), density(x) / (1.0 - other))
        }
        FAR.. => {
            let probability = probability(x);
            (libm::log(probability), density(x) / probability)
        }
        _ => {
            let log = -0.5 * x * x - 0.5 * libm::log(2.0 * PI) - libm::log(-x) + libm::log(tail(x));
            (log, inverse_mills_ratio(x))
        }
    }
}

/// The deviate x with Φ(x) = `probability`, above 0 and below 1, to round-off.
pub fn quantile(probability: f64) -> f64 {
    let lower = probability.min(1.0 - probability);
    // Φ(−38.5) is about the least positive number.
    let x = sign_change(-38.5, 0.0, lower, lower - 0.5, |x| lower - self::probability(x));
    if probability < 0.5 { x } else { -x }
}

/// Deviate below which Φ(x) loses digits. Five terms of its asymptotic series are exact to round-off there.
const FAR: f64 = -30.0;

/// −x Φ(x)/φ(x) for x below [`FAR`] (M. Abramowitz, I. A. Stegun, Handbook of mathematical functions, 26.2.12).
fn tail(x: f64) -> f64 {
    let s = 1.0 / (x * x);
    1.0 - s * (1.0 - 3.0 * s * (1.0 - 5.0 * s * (1.0 - 7.0 * s)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log_probability(x: f64) -> f64 {
        log_probability_and_slope(x).0
    }

    /// Compares with tables 26.1 and 26.2 of Abramowitz and Stegun. In the far tail it compares with mpmath.
    #[test]
    fn values_match_the_tables() {
        let near = |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 3e-14, "{value}, exactly {exact}");
        near(probability(1.0), 0.841_344_746_068_542_9);
        near(probability(-3.0), 0.001_349_898_031_630_094_5);
        near(quantile(0.975), 1.959_963_984_540_054);
        near(quantile(1e-10), -6.361_340_902_404_056);
        near(log_probability(-20.0), -203.917_155_371_097_26);
        near(log_probability(-40.0), -804.608_442_013_753_8);
        near(log_probability(7.0), -1.279_812_543_886_654e-12);
        assert!(quantile(0.5).abs() < 1e-15);
    }

    /// Both sides of the switch to the series agree. The Mills ratio is the derivative.
    #[test]
    fn the_tail_is_continuous() {
        for x in [-30.1_f64, -29.9, -5.0, 0.3, 8.0] {
            let h = 1e-5 * f64::max(1.0, x.abs());
            let slope = (log_probability(x + h) - log_probability(x - h)) / (2.0 * h);
            assert!((slope / inverse_mills_ratio(x) - 1.0).abs() < 1e-6, "{x}: {slope}");
            let (_, slope) = log_probability_and_slope(x);
            assert!((slope / inverse_mills_ratio(x) - 1.0).abs() < 1e-14, "{x}: {slope}");
        }
        let (below, above) = (FAR, FAR + 1e-12);
        assert!((log_probability(below) / log_probability(above) - 1.0).abs() < 1e-13);
        assert!((inverse_mills_ratio(below) / inverse_mills_ratio(above) - 1.0).abs() < 1e-11);
    }

    #[test]
    fn quantiles_invert_probabilities() {
        for exact in [1e-300, 1e-12, 0.05, 0.4999, 0.5, 0.7, 0.999] {
            assert!((probability(quantile(exact)) / exact - 1.0).abs() < 1e-12, "{exact}");
        }
    }
}
