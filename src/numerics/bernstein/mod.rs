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

#[cfg(feature = "lanes")]
pub(crate) mod lanes;

use crate::numerics::scalar::Real;

/// Relative error of a zero.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Width of the last Newton step to a maximum, over the interval. The error of its place is of the order of the width's square, that of the
/// value of its fourth power.
const WIDTH: f64 = 1e-5;

/// Maximum number of Newton's steps to a zero or a maximum.
const MAX_NEWTON: u32 = 100;

/// The highest degree.
pub const DEGREE: usize = 16;

/// One number per power or per Bernstein coefficient; those beyond the degree are zero.
pub type Row<T = f64> = [T; DEGREE + 1];

/// A polynomial on [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Bernstein<T = f64> {
    /// In lanes the highest degree.
    degree: usize,
    powers: Row<T>,
    coefficients: Row<T>,
}

/// Two polynomials p and q on [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Pair<T = f64> {
    /// In lanes the highest degree.
    degree: usize,
    powers: Row<[T; 2]>,
    coefficients: Row<[T; 2]>,
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

/// The greatest values of polynomials, one per run.
pub struct Highest<T: Real> {
    /// Their places.
    pub place: T,
    /// The runs in which they exceed the given numbers and the values at both ends.
    pub exceeds: T::Runs,
    /// The runs in which this is known.
    pub known: T::Runs,
}

/// A number whose polynomials are searched for their greatest values.
pub trait Searched: Real {
    /// The place inside the interval of the greatest value of `a p + b q` in some runs. It exceeds `most` and both ends.
    fn highest(pair: &Pair<Self>, runs: Self::Runs, combination: [Self; 2], most: Self) -> Highest<Self>;
}

/// `1/C(n, k)` with the highest degree n.
static RECIPROCALS: Row = reciprocals();

const fn reciprocals() -> Row {
    let mut reciprocals = [0.0; DEGREE + 1];
    let (mut k, mut binomial) = (0, 1);
    while k <= DEGREE {
        reciprocals[k] = 1.0 / binomial as f64;
        binomial = binomial * (DEGREE - k) / (k + 1);
        k += 1;
    }
    reciprocals
}

/// The Bernstein coefficients of N polynomials from those of the powers. The differences of the b_j at j = 0 are `a_k / C(n, k)`;
/// additions as in Pascal's triangle restore the b_j.
#[inline(always)]
pub fn convert<const N: usize, T: Real>(powers: &Row<[T; N]>) -> Row<[T; N]> {
    let mut coefficients = *powers;
    for k in 0..DEGREE + 1 {
        for coefficient in &mut coefficients[k] {
            *coefficient = *coefficient * RECIPROCALS[k];
        }
    }
    // Written out, so that all sums stay in registers.
    macro_rules! sweeps {
        ($($from:literal)*) => {
            $(for k in ($from..DEGREE + 1).rev() {
                for i in 0..N {
                    coefficients[k][i] = coefficients[k][i] + coefficients[k - 1][i];
                }
            })*
        };
    }
    sweeps!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16);
    coefficients
}

impl<T: Real> Pair<T> {
    /// The polynomials of this degree with these coefficients of the powers. Those beyond the degree are zero.
    #[inline(always)]
    pub fn of(powers: Row<[T; 2]>, degree: usize) -> Pair<T> {
        Pair { degree, powers, coefficients: convert(&powers) }
    }

    /// Values at both ends, and between them numbers that bound the polynomials. Their least and greatest also bound linear combinations.
    #[inline(always)]
    pub fn coefficients(&self) -> &Row<[T; 2]> {
        &self.coefficients
    }

    /// The values at a place.
    #[inline(always)]
    pub fn at(&self, place: T) -> [T; 2] {
        values(&self.powers, self.degree, place)
    }
}

impl Pair {
    /// The linear combination `a p + b q`.
    #[inline]
    pub fn combined(&self, [a, b]: [f64; 2]) -> Bernstein {
        let (mut powers, mut coefficients) = ([0.0; DEGREE + 1], [0.0; DEGREE + 1]);
        for k in 0..DEGREE + 1 {
            powers[k] = a * self.powers[k][0] + b * self.powers[k][1];
            coefficients[k] = a * self.coefficients[k][0] + b * self.coefficients[k][1];
        }
        Bernstein { degree: self.degree, powers, coefficients }
    }
}

impl Searched for f64 {
    #[inline(always)]
    fn highest(pair: &Pair, run: bool, [a, b]: [f64; 2], most: f64) -> Highest<f64> {
        let exceeds = run && pair.coefficients.iter().any(|[p, q]| a * p + b * q > most);
        let place = if exceeds { pair.combined([a, b]).highest(most) } else { None };
        Highest { place: place.unwrap_or(0.0), exceeds: place.is_some(), known: run }
    }
}

impl<T: Real> Bernstein<T> {
    /// The polynomial of this degree with these coefficients of the powers. Those beyond the degree are zero.
    #[inline(always)]
    pub fn of(powers: Row<T>, degree: usize) -> Bernstein<T> {
        let (mut rows, mut coefficients) = ([[T::from(0.0)]; DEGREE + 1], powers);
        for k in 0..DEGREE + 1 {
            rows[k] = [powers[k]];
        }
        let rows = convert(&rows);
        for k in 0..DEGREE + 1 {
            coefficients[k] = rows[k][0];
        }
        Bernstein { degree, powers, coefficients }
    }
}

impl Bernstein {
    /// The value at a place.
    #[inline]
    pub fn at(&self, place: f64) -> f64 {
        let [value, _] = self.value_and_slope(place);
        value
    }

    /// Value and slope at a place.
    #[inline]
    fn value_and_slope(&self, place: f64) -> [f64; 2] {
        value_and_slope(&self.powers, self.degree, place)
    }

    /// The values at both ends.
    pub fn ends(&self) -> [f64; 2] {
        [self.coefficients[0], self.coefficients[DEGREE]]
    }

    /// The coefficients on both halves of the interval: closer bounds of the same polynomial.
    fn halves(coefficients: &Row) -> [Row; 2] {
        let (mut left, mut right) = (*coefficients, *coefficients);
        for (j, left) in left.iter_mut().enumerate().skip(1) {
            for k in 0..DEGREE + 1 - j {
                right[k] = 0.5 * (right[k] + right[k + 1]);
            }
            *left = right[0];
        }
        [left, right]
    }

    /// The first zero of a polynomial that begins above zero; to 4 ulp.
    pub fn zero(&self) -> Zero {
        /// Halvings of the interval, as long as there may be several zeros.
        const HALVINGS: u32 = 4;
        if self.coefficients[0] > 0.0 {
            self.zero_within([0.0, 1.0], &self.coefficients, HALVINGS)
        } else {
            Zero::Unclear
        }
    }

    /// The first zero of a function with these `values`, which the polynomial approximates closely.
    pub fn zero_of(&self, mut values: impl FnMut(f64) -> f64) -> Zero {
        /// The polynomial's zero is so close that two steps suffice.
        const MAX: u32 = 4;
        let Zero::At(mut place) = self.zero() else { return self.zero() };
        let [_, slope] = self.value_and_slope(place);
        for _ in 0..MAX {
            let next = place - values(place) / slope;
            if !(next > 0.0 && next <= 1.0) {
                return Zero::Unclear;
            }
            let step = (next - place).abs();
            place = next;
            if step <= ROUNDING * place {
                break;
            }
        }
        Zero::At(place)
    }

    /// The first zero in a segment of the interval.
    fn zero_within(&self, [low, high]: [f64; 2], coefficients: &Row, halvings: u32) -> Zero {
        match (sign_changes(coefficients), coefficients[DEGREE] > 0.0) {
            (0, true) => Zero::None,
            (1, false) => Zero::At(self.only_zero([low, high], crossing(coefficients))),
            _ if halvings == 0 => Zero::Unclear,
            _ => {
                let middle = 0.5 * (low + high);
                let [left, right] = Bernstein::halves(coefficients);
                match self.zero_within([low, middle], &left, halvings - 1) {
                    Zero::None => self.zero_within([middle, high], &right, halvings - 1),
                    found => found,
                }
            }
        }
    }

    /// The only zero between two places, near this fraction of the way. Newton's method, or bisection where that would leave the places.
    /// The polynomial is positive at the first place, and negative at the last.
    fn only_zero(&self, [mut low, mut high]: [f64; 2], near: f64) -> f64 {
        let mut place = low + (high - low) * near;
        for _ in 0..MAX_NEWTON {
            let [value, slope] = self.value_and_slope(place);
            if value > 0.0 {
                low = place;
            } else {
                high = place;
            }
            let next = place - value / slope;
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            let step = (next - place).abs();
            place = next;
            if step <= ROUNDING * place {
                break;
            }
        }
        place
    }

    /// The place inside the interval of the greatest value. `None` unless it exceeds `most` and both ends.
    pub fn highest(&self, most: f64) -> Option<f64> {
        let [first, last] = self.ends();
        let (mut place, mut value) = (None, if first > last { first } else { last });
        if most > value {
            value = most;
        }
        self.raise(&mut place, &mut value, [0.0, 1.0], &self.coefficients);
        place
    }

    /// [`Bernstein::highest`] of a segment of the interval, if it exceeds the value found before.
    fn raise(&self, place: &mut Option<f64>, value: &mut f64, [low, high]: [f64; 2], coefficients: &Row) {
        /// Parts that are not divided further: extrema that close to each other are of round-off.
        const MIN: f64 = 1.0 / 1024.0;
        if coefficients.iter().all(|b| b <= value) {
            return;
        }
        let mut include = |at: f64, found: f64| {
            if found > *value {
                (*place, *value) = (Some(at), found);
            }
        };
        let [first, last] = [coefficients[0], coefficients[DEGREE]];
        include(low, first);
        include(high, last);
        let mut differences = [0.0; DEGREE];
        for k in 0..DEGREE {
            differences[k] = coefficients[k + 1] - coefficients[k];
        }
        match sign_changes(&differences) {
            1 if coefficients[1] > first || coefficients[DEGREE - 1] > last => {
                let at = self.top([low, high], crossing(&differences));
                include(at, self.at(at));
            }
            0 | 1 => {}
            _ if high - low > MIN => {
                let middle = 0.5 * (low + high);
                let [left, right] = Bernstein::halves(coefficients);
                self.raise(place, value, [low, middle], &left);
                self.raise(place, value, [middle, high], &right);
            }
            _ => {}
        }
    }

    /// The only maximum between two places, near this fraction of the way. Newton's method, or bisection where that would leave the places.
    fn top(&self, [mut low, mut high]: [f64; 2], near: f64) -> f64 {
        let slopes = slopes(&self.powers);
        let mut place = low + (high - low) * near;
        for _ in 0..MAX_NEWTON {
            let [slope, curvature] = value_and_slope(&slopes, self.degree, place);
            if slope > 0.0 {
                low = place
            } else {
                high = place
            }
            let next = place - slope / curvature;
            let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
            if (next - place).abs() <= WIDTH {
                return next;
            }
            place = next;
        }
        place
    }
}

/// The values of two polynomials with these coefficients of the powers.
#[inline(always)]
fn values<T: Real>(powers: &Row<[T; 2]>, degree: usize, place: T) -> [T; 2] {
    let mut values = [T::from(0.0); 2];
    for k in (0..degree + 1).rev() {
        for i in 0..2 {
            values[i] = values[i] * place + powers[k][i];
        }
    }
    values
}

/// Value and slope of the polynomial with these coefficients of the powers. Even and odd powers are summed side by side, which takes half
/// the time of one sum after the other.
#[inline(always)]
fn value_and_slope<T: Real>(powers: &Row<T>, degree: usize, place: T) -> [T; 2] {
    let square = place * place;
    let (mut values, mut slopes) = ([T::from(0.0); 2], [T::from(0.0); 2]);
    for k in (0..degree / 2 + 1).rev() {
        for i in 0..2 {
            slopes[i] = slopes[i] * square + values[i];
        }
        let odd = if 2 * k < DEGREE { powers[2 * k + 1] } else { T::from(0.0) };
        values = [values[0] * square + powers[2 * k], values[1] * square + odd];
    }
    [values[0] + place * values[1], values[1] + (place * slopes[0] + square * slopes[1]) * 2.0]
}

/// The coefficients of the slope of the polynomial with these coefficients of the powers.
#[inline(always)]
fn slopes<T: Real>(powers: &Row<T>) -> Row<T> {
    let mut slopes = [T::from(0.0); DEGREE + 1];
    for k in 0..DEGREE {
        slopes[k] = powers[k + 1] * (k + 1) as f64;
    }
    slopes
}

/// The fraction of the way at which a control polygon first crosses zero. Its ordinates are the Bernstein coefficients of a polynomial.
fn crossing(coefficients: &[f64]) -> f64 {
    let last = coefficients.len() - 1;
    for k in 0..last {
        let [here, next] = [coefficients[k], coefficients[k + 1]];
        if here * next < 0.0 {
            return (k as f64 + here / (here - next)) / last as f64;
        }
    }
    0.5
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
mod tests;
