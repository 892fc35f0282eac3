//! Zeros and maxima of polynomials against their known places and dense samples.

use proptest::prelude::*;

use super::*;

const N: usize = 9;

/// The polynomial with these coefficients of the powers.
fn polynomial(from: &[f64]) -> Bernstein {
    let mut powers = [0.0; DEGREE + 1];
    powers[..from.len()].copy_from_slice(from);
    Bernstein::of(powers, from.len() - 1)
}

fn value(powers: &[f64], at: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, power| sum * at + power)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    /// Values, bounds, halves and the greatest value of random polynomials are those of the powers.
    #[test]
    fn the_form_is_that_of_the_powers(powers in prop::collection::vec(-1.0..1.0_f64, 2..N + 1)) {
        let form = polynomial(&powers);
        let halves = Bernstein::halves(&form.coefficients);
        let samples = (0..=2000).map(|i| f64::from(i) / 2000.0);
        let mut greatest = f64::NEG_INFINITY;
        let bounds = |row: &Row| {
            let all = row.iter().copied();
            (all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max))
        };
        let ((least, most), halves) = (bounds(&form.coefficients), halves.map(|half| bounds(&half)));
        for at in samples {
            let exact = value(&powers, at);
            prop_assert!((form.at(at) - exact).abs() < 1e-13);
            let terms = || powers.iter().enumerate().map(|(k, power)| (k as i32, power));
            let slope: f64 = terms().map(|(k, power)| f64::from(k) * power * at.powi(k - 1)).skip(1).sum();
            prop_assert!((value_and_slope(&slopes(&form.powers), N, at)[0] - slope).abs() < 1e-12);
            prop_assert!((form.value_and_slope(at)[0] - exact).abs() < 1e-13);
            prop_assert!((form.value_and_slope(at)[1] - slope).abs() < 1e-12);
            prop_assert!(least - 1e-13 <= exact && exact <= most + 1e-13, "{} beyond {} to {}", exact, least, most);
            let half = if at < 0.5 { halves[0] } else { halves[1] };
            prop_assert!(half.0 - 1e-13 <= exact && exact <= half.1 + 1e-13, "{} beyond {:?}", exact, half);
            greatest = f64::max(greatest, exact);
        }
        let ends = value(&powers, 0.0).max(value(&powers, 1.0));
        let found = form.highest(f64::NEG_INFINITY).map_or(ends, |place| form.at(place));
        prop_assert!(found >= greatest - 1e-13 && found <= greatest + 1e-5, "{} instead of {}", found, greatest);
        prop_assert_eq!(form.highest(greatest + 1e-5), None);
    }

    /// Two zeros or two maxima at least a sixteenth of the interval apart. The first zero is found, and one of the maxima.
    #[test]
    fn separate_zeros_and_maxima_are_found(first in 0.01..0.9_f64, apart in 0.07..2.0_f64, c in 0.15..0.85_f64) {
        let zeros = [first, first + apart];
        let form = polynomial(&[zeros[0] * zeros[1], -zeros[0] - zeros[1], 1.0]);
        let Zero::At(found) = form.zero() else { return Err(TestCaseError::fail(format!("{:?}", form.zero()))) };
        prop_assert!((found - first).abs() < 1e-14, "{} instead of {}", found, first);
        // 1 − q² has maxima at the zeros c ± 0.1 of q = τ² + q₁ τ + q₀.
        let (q0, q1) = (c * c - 0.01, -2.0 * c);
        let form = polynomial(&[1.0 - q0 * q0, -2.0 * q0 * q1, -2.0 * q0 - q1 * q1, -2.0 * q1, -1.0]);
        let place = form.highest(0.0).unwrap_or_default();
        prop_assert!(((place - c).abs() - 0.1).abs() < 1e-6, "{} instead of {} ± 0.1", place, c);
    }

    /// The sign changes of the coefficients exceed the number of zeros by an even number.
    #[test]
    fn sign_changes_count_zeros(zeros in prop::collection::vec(-1.0..2.0_f64, 1..N)) {
        let mut powers = vec![1.0];
        for zero in &zeros {
            powers.push(0.0);
            for k in (0..powers.len()).rev() {
                powers[k] = if k > 0 { powers[k - 1] } else { 0.0 } - zero * powers[k];
            }
        }
        let inside = zeros.iter().filter(|zero| (0.0..1.0).contains(*zero)).count();
        let form = polynomial(&powers);
        let changes = sign_changes(&form.coefficients) as usize;
        prop_assert!(changes >= inside && (changes - inside).is_multiple_of(2), "{} of {}", changes, inside);
        // The least zero inside is found, or unclear if others are near.
        let first = zeros.iter().copied().filter(|zero| (0.0..1.0).contains(zero)).fold(f64::INFINITY, f64::min);
        let sign = if powers[0] < 0.0 { -1.0 } else { 1.0 };
        match polynomial(&powers.iter().map(|power| sign * power).collect::<Vec<_>>()).zero() {
            Zero::None => prop_assert_eq!(inside, 0),
            Zero::At(place) => prop_assert!((place - first).abs() < 1e-6, "{} instead of {}", place, first),
            Zero::Unclear => prop_assert!(zeros.len() > 1),
        }
    }
}

/// Each halving reduces the lowest coefficient of `(τ − 1/3)²` to about a quarter.
///
/// On a part from l to h around 1/3, the lowest one of degree n is about `−(h − l)²/4n`.
#[test]
fn halves_have_closer_bounds() {
    let third = 1.0 / 3.0;
    let form = polynomial(&[third * third, -2.0 * third, 1.0]);
    let (mut row, mut low, mut high) = (form.coefficients, 0.0, 1.0);
    for part in [1.0_f64, 0.5, 0.25, 0.125] {
        let found = row.iter().copied().fold(f64::INFINITY, f64::min);
        let lowest = -part * part / (4.0 * DEGREE as f64);
        assert!(found < 0.0 && found > 1.1 * lowest, "{found} from {low} to {high}");
        let middle = 0.5 * (low + high);
        let [left, right] = Bernstein::halves(&row);
        (row, low, high) = if third < middle { (left, low, middle) } else { (right, middle, high) };
    }
}

/// Pairs have the coefficients of each polynomial. Their combinations have the greatest value of the combined powers.
#[test]
fn pairs_combine_as_their_polynomials_do() {
    let (p, q) = ([0.3, -1.0, 2.0, -0.5], [0.1, 4.0, -7.0, 3.0]);
    let pair = Pair::of(std::array::from_fn(|k| [p, q].map(|powers| powers.get(k).copied().unwrap_or(0.0))), 3);
    let each = [polynomial(&p), polynomial(&q)];
    for (j, both) in pair.coefficients().iter().enumerate() {
        assert_eq!(*both, each.map(|form| form.coefficients[j]));
    }
    let sum = polynomial(&std::array::from_fn::<_, 4, _>(|k| -2.0 * p[k] + q[k]));
    let Highest { place, exceeds, known } = f64::highest(&pair, true, [-2.0, 1.0], 0.0);
    assert!(exceeds && known && (place - sum.highest(0.0).unwrap()).abs() < 1e-9);
    assert!(!f64::highest(&pair, true, [-2.0, 1.0], 1.0).exceeds);
}

/// A zero of a function near the polynomial, which has another slope there.
#[test]
fn the_zero_of_a_close_function_is_found() {
    let form = polynomial(&[1.0, -1.5, -0.25]);
    let function = |x: f64| 1.0 - 1.5 * x - 0.25 * x * x + 1e-8 * libm::sin(40.0 * x);
    let Zero::At(found) = form.zero_of(function) else { panic!("no zero") };
    assert!(function(found).abs() < 4e-16, "{:e}", function(found));
    assert_eq!(form.zero_of(|_| 1.0), Zero::Unclear);
}
