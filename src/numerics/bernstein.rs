//! The coefficients of a polynomial → bounds, sign changes and greatest value on [0, 1], by its Bernstein coefficients.
//!
//! ```text
//! p(τ) = Σ a_k τᵏ = Σ b_j C(n, j) τʲ (1 − τ)ⁿ⁻ʲ,    b_j = Σ a_k C(j, k) / C(n, k)
//! ```
//!
//! The least and the greatest b_j bound p on [0, 1], b_0 and b_n are its values at the ends, and p has as many zeros inside as the b_j
//! change their sign, or fewer by an even number. The differences of the b_j tell the same of its slope. Bounds of the halves, by de
//! Casteljau's algorithm, are four times closer (R. T. Farouki, "The Bernstein polynomial basis: a centennial retrospective",
//! Computer Aided Geometric Design 29 (2012) 379–419).

use crate::numerics::roots::sign_change;

/// The highest degree.
pub const DEGREE: usize = 16;

/// A polynomial on [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Bernstein {
    degree: usize,
    powers: [f64; DEGREE + 1],
    coefficients: [f64; DEGREE + 1],
}

/// The first zero of a polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zero {
    /// There is none.
    None,
    /// It is at this place.
    At(f64),
    /// Zeros too close to each other, or to the beginning, to be told apart.
    Unclear,
}

/// `C(j, k)` in row k and column j.
static BINOMIAL: [[f64; DEGREE + 1]; DEGREE + 1] = binomials();

const fn binomials() -> [[f64; DEGREE + 1]; DEGREE + 1] {
    let mut binomials = [[0.0; DEGREE + 1]; DEGREE + 1];
    let mut j = 0;
    while j <= DEGREE {
        let (mut k, mut binomial) = (0, 1);
        while k <= j {
            binomials[k][j] = binomial as f64;
            binomial = binomial * (j - k) / (k + 1);
            k += 1;
        }
        j += 1;
    }
    binomials
}

impl Bernstein {
    /// The polynomial with these coefficients of the powers, one to [`DEGREE`] + 1 of them.
    pub fn of(from: &[f64]) -> Bernstein {
        let degree = DEGREE.min(from.len() - 1);
        let (mut powers, mut coefficients) = ([0.0; DEGREE + 1], [0.0; DEGREE + 1]);
        for k in 0..degree + 1 {
            powers[k] = from[k];
            // Columns beyond the degree are not used; sums of the same length for all degrees stay in registers.
            let (row, part) = (&BINOMIAL[k], from[k] / BINOMIAL[k][degree]);
            for j in 0..DEGREE + 1 {
                coefficients[j] += part * row[j];
            }
        }
        Bernstein { degree, powers, coefficients }
    }

    /// The linear combination `a p + b q` with a polynomial q of the same degree.
    pub fn combined(&self, a: f64, other: &Bernstein, b: f64) -> Bernstein {
        let mut sum = *self;
        for k in 0..self.degree + 1 {
            sum.powers[k] = a * self.powers[k] + b * other.powers[k];
            sum.coefficients[k] = a * self.coefficients[k] + b * other.coefficients[k];
        }
        sum
    }

    fn all(&self) -> &[f64] {
        &self.coefficients[..self.degree + 1]
    }

    /// The value at a place.
    pub fn at(&self, place: f64) -> f64 {
        let mut sum = 0.0;
        for k in (0..self.degree + 1).rev() {
            sum = sum * place + self.powers[k];
        }
        sum
    }

    /// Slope and curvature at a place.
    fn slope(&self, place: f64) -> [f64; 2] {
        let (mut slope, mut curvature) = (0.0, 0.0);
        for k in (1..self.degree + 1).rev() {
            curvature = curvature * place + slope;
            slope = slope * place + self.powers[k] * k as f64;
        }
        [slope, curvature]
    }

    /// The values at both ends.
    pub fn ends(&self) -> [f64; 2] {
        [self.coefficients[0], self.coefficients[self.degree]]
    }

    /// Whether bounds show that it exceeds `floor` everywhere: those of the whole, or of its parts after at most `halvings`.
    pub fn stays_above(&self, floor: f64, halvings: u32) -> bool {
        if self.all().iter().all(|&b| b > floor) {
            return true;
        }
        let ends_above = self.ends().iter().all(|&end| end > floor);
        ends_above && halvings > 0 && self.halves().iter().all(|half| half.stays_above(floor, halvings - 1))
    }

    /// The same on both halves of the interval: other bounds of the same polynomial.
    fn halves(&self) -> [Bernstein; 2] {
        let (mut left, mut right) = (*self, *self);
        for j in 1..self.degree + 1 {
            for k in 0..self.degree + 1 - j {
                right.coefficients[k] = 0.5 * (right.coefficients[k] + right.coefficients[k + 1]);
            }
            left.coefficients[j] = right.coefficients[0];
        }
        [left, right]
    }

    /// The first zero of a polynomial that begins above zero; to 4 ulp.
    pub fn zero(&self) -> Zero {
        self.first_zero(|place| self.at(place))
    }

    /// The first zero of a function with these `values`, which the polynomial approximates closely.
    pub fn first_zero(&self, mut values: impl FnMut(f64) -> f64) -> Zero {
        /// Halvings of the interval, as long as there may be several zeros.
        const HALVINGS: u32 = 4;
        if self.coefficients[0] > 0.0 { self.zero_within([0.0, 1.0], &mut values, HALVINGS) } else { Zero::Unclear }
    }

    /// The same of a part of the interval.
    fn zero_within(&self, [low, high]: [f64; 2], values: &mut impl FnMut(f64) -> f64, halvings: u32) -> Zero {
        match (sign_changes(self.all()), self.coefficients[self.degree] > 0.0) {
            (0, true) => Zero::None,
            (1, false) => match [values(low), values(high)] {
                [at_low, at_high] if at_low > 0.0 && at_high < 0.0 => {
                    Zero::At(sign_change(low, high, at_low, at_high, values))
                }
                _ => Zero::Unclear,
            },
            _ if halvings == 0 => Zero::Unclear,
            _ => {
                let middle = 0.5 * (low + high);
                let [left, right] = self.halves();
                match left.zero_within([low, middle], values, halvings - 1) {
                    Zero::None => right.zero_within([middle, high], values, halvings - 1),
                    found => found,
                }
            }
        }
    }

    /// The place inside the interval of the greatest value, if that exceeds `most` and the values at both ends.
    pub fn highest(&self, most: f64) -> Option<f64> {
        let [first, last] = self.ends();
        let (mut place, mut value) = (None, if first > last { first } else { last });
        if most > value {
            value = most;
        }
        self.raise(&mut place, &mut value, [0.0, 1.0]);
        place
    }

    /// [`Bernstein::highest`] of a part of the interval, if that exceeds the value that has been found.
    fn raise(&self, place: &mut Option<f64>, value: &mut f64, [low, high]: [f64; 2]) {
        /// Parts that are not divided further: extrema that close to each other are of round-off.
        const LEAST: f64 = 1.0 / 1024.0;
        if self.all().iter().all(|b| b <= value) {
            return;
        }
        let mut include = |at: f64, found: f64| {
            if found > *value {
                (*place, *value) = (Some(at), found);
            }
        };
        let [first, last] = self.ends();
        include(low, first);
        include(high, last);
        let mut differences = [0.0; DEGREE];
        for k in 1..self.degree + 1 {
            differences[k - 1] = self.coefficients[k] - self.coefficients[k - 1];
        }
        match sign_changes(&differences[..self.degree]) {
            1 if self.coefficients[1] > first || self.coefficients[self.degree - 1] > last => {
                let at = self.top(low, high);
                include(at, self.at(at));
            }
            0 | 1 => {}
            _ if high - low > LEAST => {
                let middle = 0.5 * (low + high);
                let [left, right] = self.halves();
                left.raise(place, value, [low, middle]);
                right.raise(place, value, [middle, high]);
            }
            _ => {}
        }
    }

    /// The only maximum between two places, by Newton's method, or by bisection where that would leave them.
    pub fn top(&self, mut low: f64, mut high: f64) -> f64 {
        /// Of the place: the value at a maximum is as exact as its square.
        const WIDTH: f64 = 1e-9;
        let mut place = 0.5 * (low + high);
        while high - low > WIDTH {
            let [slope, curvature] = self.slope(place);
            if slope > 0.0 {
                low = place
            } else {
                high = place
            }
            let next = place - slope / curvature;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - place).abs() < WIDTH {
                return next;
            }
            place = next;
        }
        place
    }
}

/// Number of sign changes; zeros do not count.
fn sign_changes(values: &[f64]) -> u32 {
    let (mut changes, mut last) = (0, 0.0);
    for &value in values {
        changes += u32::from(value * last < 0.0);
        last = if value == 0.0 { last } else { value };
    }
    changes
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const N: usize = 9;

    fn value(powers: &[f64], at: f64) -> f64 {
        powers.iter().rev().fold(0.0, |sum, power| sum * at + power)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

        /// Values, bounds, halves and the greatest value of random polynomials are those of the powers.
        #[test]
        fn the_form_is_that_of_the_powers(powers in prop::collection::vec(-1.0..1.0_f64, 2..N + 1)) {
            let form = Bernstein::of(&powers);
            let halves = form.halves();
            let samples = (0..=2000).map(|i| f64::from(i) / 2000.0);
            let mut greatest = f64::NEG_INFINITY;
            let (least, most) = (form.all().iter().copied().fold(f64::INFINITY, f64::min), form.all().iter().copied().fold(f64::NEG_INFINITY, f64::max));
            prop_assert!(form.stays_above(least - 1e-9, 0) && !form.stays_above(least, 0));
            for at in samples {
                let exact = value(&powers, at);
                prop_assert!((form.at(at) - exact).abs() < 1e-13);
                let terms = || powers.iter().enumerate().map(|(k, power)| (k as i32, power));
                let slope: f64 = terms().map(|(k, power)| f64::from(k) * power * at.powi(k - 1)).skip(1).sum();
                prop_assert!((form.slope(at)[0] - slope).abs() < 1e-12);
                prop_assert!(least - 1e-13 <= exact && exact <= most + 1e-13, "{} beyond {} to {}", exact, least, most);
                let half = if at < 0.5 { halves[0] } else { halves[1] };
                prop_assert!(!half.stays_above(exact + 1e-13, 0), "{} below the bounds of its half", exact);
                greatest = f64::max(greatest, exact);
            }
            let ends = value(&powers, 0.0).max(value(&powers, 1.0));
            let found = form.highest(f64::NEG_INFINITY).map_or(ends, |place| form.at(place));
            prop_assert!(found >= greatest - 1e-13 && found <= greatest + 1e-5, "{} instead of {}", found, greatest);
            prop_assert_eq!(form.highest(greatest + 1e-5), None);
        }

        /// The first of two zeros is found if they are at least a sixteenth of the interval apart, and one of two such maxima.
        #[test]
        fn separate_zeros_and_maxima_are_found(first in 0.01..0.9_f64, apart in 0.07..2.0_f64, c in 0.15..0.85_f64) {
            let zeros = [first, first + apart];
            let form = Bernstein::of(&[zeros[0] * zeros[1], -zeros[0] - zeros[1], 1.0]);
            let Zero::At(found) = form.zero() else { return Err(TestCaseError::fail(format!("{:?}", form.zero()))) };
            prop_assert!((found - first).abs() < 1e-14, "{} instead of {}", found, first);
            // 1 − q² has maxima at the zeros c ± 0.1 of q = τ² + q₁ τ + q₀.
            let (q0, q1) = (c * c - 0.01, -2.0 * c);
            let form = Bernstein::of(&[1.0 - q0 * q0, -2.0 * q0 * q1, -2.0 * q0 - q1 * q1, -2.0 * q1, -1.0]);
            let place = form.highest(0.0).unwrap_or_default();
            prop_assert!(((place - c).abs() - 0.1).abs() < 1e-6, "{} instead of {} ± 0.1", place, c);
        }

        /// Polynomials with known zeros change their sign as often, or more often by an even number.
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
            let form = Bernstein::of(&powers);
            let changes = sign_changes(form.all()) as usize;
            prop_assert!(changes >= inside && (changes - inside).is_multiple_of(2), "{} of {}", changes, inside);
            prop_assert!(!form.stays_above(0.0, 4) || inside == 0);
            // The least zero inside is found, or unclear if others are near.
            let first = zeros.iter().copied().filter(|zero| (0.0..1.0).contains(zero)).fold(f64::INFINITY, f64::min);
            let sign = if powers[0] < 0.0 { -1.0 } else { 1.0 };
            match form.combined(sign, &form, 0.0).zero() {
                Zero::None => prop_assert_eq!(inside, 0),
                Zero::At(place) => prop_assert!((place - first).abs() < 1e-6, "{} instead of {}", place, first),
                Zero::Unclear => prop_assert!(zeros.len() > 1),
            }
        }
    }
    /// Halvings bring the lowest coefficient of `(τ − 1/3)² + d`, `(l − 1/3)(h − 1/3) + d` on the part from l to h around 1/3, up
    /// from d − 2/9 to d − 1/18, d − 1/72 and d − 1/288.
    #[test]
    fn halves_have_closer_bounds() {
        let third = 1.0 / 3.0;
        for (d, enough) in [(0.23, 0), (0.1, 1), (0.05, 2), (0.01, 3)] {
            let form = Bernstein::of(&[third * third + d, -2.0 * third, 1.0]);
            for halvings in 0..4 {
                assert_eq!(form.stays_above(0.0, halvings), halvings >= enough, "d = {d} after {halvings} halvings");
            }
        }
    }
}
