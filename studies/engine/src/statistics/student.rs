//! Student's t distribution: a p-value of both sides and the degrees of freedom → the deviate.

use rocking_block::numerics::roots::sign_change;

/// The deviate t of Student's t distribution with P(|T| > t) = `probability`, which is above 0 and below 1.
pub fn quantile(probability: f64, freedom: f64) -> f64 {
    let excess = |t: f64| p_value(t, freedom) - probability;
    let mut high = 1.0;
    while excess(high) > 0.0 {
        high *= 2.0;
    }
    sign_change(0.0, high, 1.0 - probability, excess(high), excess)
}

/// P(|T| > t) of Student's t distribution, as an incomplete beta function (M. Abramowitz, I. A. Stegun, Handbook of
/// mathematical functions, 26.7.1).
pub fn p_value(t: f64, freedom: f64) -> f64 {
    let x = freedom / (freedom + t * t);
    let [a, b] = [0.5 * freedom, 0.5];
    match x < (a + 1.0) / (a + b + 2.0) {
        true => beta_ratio(a, b, x, 1.0 - x),
        false => 1.0 - beta_ratio(b, a, 1.0 - x, x),
    }
}

/// The incomplete beta function I_x(a, b), y = 1 − x, by its continued fraction (W. H. Press et al., Numerical recipes,
/// 6.4), which converges fast for x < (a + 1)/(a + b + 2).
fn beta_ratio(a: f64, b: f64, x: f64, y: f64) -> f64 {
    const MAX_TERMS: u32 = 100_000;
    if x <= 0.0 {
        return 0.0;
    }
    let front = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log(y);
    let mut d = 1.0 / (1.0 - (a + b) * x / (a + 1.0));
    let (mut c, mut fraction) = (1.0, d);
    for m in (1..MAX_TERMS).map(f64::from) {
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for term in [even, odd] {
            d = 1.0 / (1.0 + term * d);
            c = 1.0 + term / c;
            fraction *= d * c;
        }
        if (fraction - before).abs() <= 1e-15 * fraction.abs() {
            break;
        }
    }
    libm::exp(front) * fraction / a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::normal;

    /// Compares with table 26.10 of Abramowitz and Stegun. One and two degrees of freedom have closed forms.
    #[test]
    fn student_deviates_match_the_tables() {
        for (freedom, exact) in [(1.0, 12.706), (2.0, 4.303), (5.0, 2.571), (20.0, 2.086), (120.0, 1.980)] {
            assert!((quantile(0.05, freedom) - exact).abs() < 6e-4, "{freedom}");
        }
        for t in [0.01_f64, 0.7, 3.0, 500.0] {
            let exact = 2.0 / std::f64::consts::PI * (1.0 / t).atan();
            assert!((p_value(t, 1.0) / exact - 1.0).abs() < 1e-12, "{t}");
            let exact = 2.0 / ((2.0 + t * t).sqrt() * ((2.0 + t * t).sqrt() + t));
            assert!((p_value(t, 2.0) / exact - 1.0).abs() < 1e-12, "{t}");
        }
        let [near, normal] = [quantile(0.05, 1e6), normal::quantile(0.975)];
        assert!((near / normal - 1.0).abs() < 1e-5);
        assert_eq!(p_value(f64::INFINITY, 7.0), 0.0);
    }
}
