//! The χ² distribution: a deviance and its degrees of freedom → the p-value.

/// P(χ² > x) for a whole number of degrees of freedom above zero (M. Abramowitz, I. A. Stegun, Handbook of mathematical functions, 26.4.4
/// and 26.4.5).
pub fn p_value(x: f64, freedom: usize) -> f64 {
    let half = 0.5 * x;
    let (mut sum, mut term, first) = match freedom % 2 {
        0 => (0.0, libm::exp(-half), 1.0),
        _ => (libm::erfc(half.sqrt()), libm::exp(-half) * (half / std::f64::consts::FRAC_PI_4).sqrt(), 1.5),
    };
    for number in 0..freedom / 2 {
        sum += term;
        term *= half / (first + number as f64);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 26.8 of Abramowitz and Stegun.
    #[test]
    fn p_values_match_the_tables() {
        for (freedom, x, p) in [
            (1, 3.84146, 0.05),
            (2, 9.21034, 0.01),
            (3, 6.25139, 0.1),
            (5, 11.0705, 0.05),
            (10, 18.3070, 0.05),
            (9, 27.8772, 0.001),
        ] {
            assert!((p_value(x, freedom) / p - 1.0).abs() < 1e-4, "{freedom}");
        }
        assert_eq!(p_value(0.0, 3), 1.0);
    }
}
