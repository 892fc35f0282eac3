//! A number with its exact derivatives in several directions.
//!
//! Each operation treats the value as it treats an `f64`, so that values have the bits of plain numbers and decide alike. Derivatives are
//! formed in loops over indices: closures over arrays become calls, which would take most of the time, and iterators take ten times as
//! long to compile.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::numerics::dual::{Dual, constants_with_duals};
use crate::numerics::scalar::{Elementary, Scalar};

/// Derivatives in several directions: an array of numbers, or a vector of the processor.
pub trait Directions: Copy {
    /// No derivatives.
    fn zeros() -> Self;
    /// Sum in each direction.
    fn plus(self, other: Self) -> Self;
    /// Difference in each direction.
    fn minus(self, other: Self) -> Self;
    /// Opposite number in each direction.
    fn negated(self) -> Self;
    /// Product with a factor.
    fn times(self, factor: f64) -> Self;
}

impl<const N: usize> Directions for [f64; N] {
    #[inline(always)]
    fn zeros() -> Self {
        [0.0; N]
    }

    #[inline(always)]
    fn plus(mut self, other: Self) -> Self {
        let mut i = 0;
        while i < N {
            self[i] += other[i];
            i += 1;
        }
        self
    }

    #[inline(always)]
    fn minus(mut self, other: Self) -> Self {
        let mut i = 0;
        while i < N {
            self[i] -= other[i];
            i += 1;
        }
        self
    }

    #[inline(always)]
    fn negated(mut self) -> Self {
        let mut i = 0;
        while i < N {
            self[i] = -self[i];
            i += 1;
        }
        self
    }

    #[inline(always)]
    fn times(mut self, factor: f64) -> Self {
        let mut i = 0;
        while i < N {
            self[i] *= factor;
            i += 1;
        }
        self
    }
}

/// A number and its derivatives in several directions.
///
/// The alignment makes the compiler load four derivatives as one vector, apart from the number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct MultiDual<D> {
    /// Its derivatives.
    pub eps: D,
    /// The number.
    pub re: f64,
}

/// A number with its derivatives in N directions.
pub type Gradient<const N: usize> = MultiDual<[f64; N]>;

/// A number with its derivative in one direction. Unlike a [`Dual`], its value has the bits of a plain number.
pub type DirectionalDual = Gradient<1>;

impl<D: Directions> MultiDual<D> {
    /// A number with these derivatives.
    #[inline(always)]
    pub fn new(re: f64, eps: D) -> Self {
        MultiDual { re, eps }
    }

    /// Applies the chain rule to a function of two numbers. Its value and partial derivatives are given.
    #[inline(always)]
    fn chain(self, other: Self, re: f64, [by_self, by_other]: [f64; 2]) -> Self {
        MultiDual { re, eps: self.eps.times(by_self).plus(other.eps.times(by_other)) }
    }

    /// Applies the chain rule to a function with the value `re` and the derivative `slope`.
    #[inline(always)]
    fn map(self, re: f64, slope: f64) -> Self {
        MultiDual { re, eps: self.eps.times(slope) }
    }
}

impl<D> MultiDual<D> {
    /// The number with its derivatives in an array.
    #[inline(always)]
    pub fn stored<const N: usize>(self) -> Gradient<N>
    where
        D: Into<[f64; N]>,
    {
        MultiDual { re: self.re, eps: self.eps.into() }
    }
}

impl<D: Directions> Default for MultiDual<D> {
    #[inline(always)]
    fn default() -> Self {
        MultiDual::from(0.0)
    }
}

impl<D: Directions> From<f64> for MultiDual<D> {
    #[inline(always)]
    fn from(re: f64) -> Self {
        MultiDual { re, eps: D::zeros() }
    }
}

impl<D: Directions> Neg for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        MultiDual { re: -self.re, eps: self.eps.negated() }
    }
}

impl<D: Directions> Add for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        MultiDual { re: self.re + other.re, eps: self.eps.plus(other.eps) }
    }
}

impl<D: Directions> Sub for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        MultiDual { re: self.re - other.re, eps: self.eps.minus(other.eps) }
    }
}

impl<D: Directions> Mul for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain(other, self.re * other.re, [other.re, self.re])
    }
}

impl<D: Directions> Div for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, inverse) = (self.re / other.re, 1.0 / other.re);
        self.chain(other, quotient, [inverse, -quotient * inverse])
    }
}

impl<D: Directions> Add<f64> for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: f64) -> Self {
        MultiDual { re: self.re + other, ..self }
    }
}

impl<D: Directions> Sub<f64> for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        MultiDual { re: self.re - other, ..self }
    }
}

impl<D: Directions> Mul<f64> for MultiDual<D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self.map(self.re * other, other)
    }
}

impl<D: Directions> Scalar for MultiDual<D> {
    type Real = f64;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        MultiDual::from(value)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = libm::sincos(self.re);
        (self.map(sin, cos), self.map(cos, -sin))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let power = libm::exp(self.re);
        self.map(power, power)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.map(root, 0.5 / root)
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.re
    }

    #[inline(always)]
    fn select_less(a: f64, b: f64, yes: Self, no: Self) -> Self {
        if a < b { yes } else { no }
    }
}

/// Four numbers as one vector, with the derivatives of each. Sums of a step are thus sums of vectors.
#[cfg(feature = "lanes")]
#[derive(Clone, Copy, Debug)]
pub struct SoaDuals<D> {
    /// The numbers.
    pub re: D,
    /// Their derivatives.
    pub eps: [D; 4],
}

#[cfg(feature = "lanes")]
impl<D: Directions + From<[f64; 4]> + Into<[f64; 4]>> SoaDuals<D> {
    /// Packs four numbers.
    #[inline(always)]
    pub fn of([a, b, c, d]: [MultiDual<D>; 4]) -> Self {
        SoaDuals { re: [a.re, b.re, c.re, d.re].into(), eps: [a.eps, b.eps, c.eps, d.eps] }
    }

    /// Unpacks the numbers.
    #[inline(always)]
    pub fn numbers(&self) -> [MultiDual<D>; 4] {
        let ([a, b, c, d], eps) = (self.re.into(), self.eps);
        [MultiDual::new(a, eps[0]), MultiDual::new(b, eps[1]), MultiDual::new(c, eps[2]), MultiDual::new(d, eps[3])]
    }
}

#[cfg(feature = "lanes")]
impl<D: Directions> Add for SoaDuals<D> {
    type Output = Self;

    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self.re = self.re.plus(other.re);
        for i in 0..4 {
            self.eps[i] = self.eps[i].plus(other.eps[i]);
        }
        self
    }
}

#[cfg(feature = "lanes")]
impl<D: Directions> Mul<f64> for SoaDuals<D> {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, factor: f64) -> Self {
        self.re = self.re.times(factor);
        for i in 0..4 {
            self.eps[i] = self.eps[i].times(factor);
        }
        self
    }
}

impl<const N: usize> Elementary for Gradient<N> {
    fn asin(self) -> Self {
        self.map(libm::asin(self.re), 1.0 / ((1.0 - self.re) * (1.0 + self.re)).sqrt())
    }

    fn atan2(self, x: Self) -> Self {
        let square = self.re * self.re + x.re * x.re;
        self.chain(x, libm::atan2(self.re, x.re), [x.re / square, -self.re / square])
    }

    fn hypot(self, other: Self) -> Self {
        let length = libm::hypot(self.re, other.re);
        self.chain(other, length, [self.re / length, other.re / length])
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        let (mut is_zero, mut i) = (self.re == 0.0, 0);
        while i < N {
            is_zero &= self.eps[i] == 0.0;
            i += 1;
        }
        is_zero
    }

    #[inline(always)]
    fn slope(self) -> f64 {
        if N == 1 { self.eps[0] } else { 0.0 }
    }
}

constants_with_duals!([const N: usize] Gradient<N>);

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::{Dual64, DualNum};
    use proptest::prelude::*;

    type Pair = Gradient<2>;

    fn along(x: Pair, i: usize) -> Dual64 {
        Dual64::new(x.re, x.eps[i])
    }

    proptest! {
        /// The derivatives agree with those of `num-dual`. The values have the bits of plain numbers.
        #[test]
        fn each_direction_is_that_of_a_dual(a in [-9.0..9.0, -9.0..9.0, -9.0..9.0], b in [0.1..9.0, -9.0..9.0, -9.0..9.0], x in 0.01..0.99) {
            let [a, b] = [a, b].map(|[re, one, other]| Pair::new(re, [one, other]));
            let x = Pair::new(x, a.eps);
            for i in 0..2 {
                let [c, d, y] = [a, b, x].map(|number| along(number, i));
                for (ours, theirs, plain) in [
                    (a + b, c + d, a.re + b.re),
                    (a - b, c - d, a.re - b.re),
                    (a * b, c * d, a.re * b.re),
                    (a / b, c / d, a.re / b.re),
                    (-a, -c, -a.re),
                    (a * 3.0 - 2.0 + 7.0, c * 3.0 - 2.0 + 7.0, a.re * 3.0 - 2.0 + 7.0),
                    (a.sin(), c.sin(), libm::sin(a.re)),
                    (a.cos(), c.cos(), libm::cos(a.re)),
                    (b.sqrt(), d.sqrt(), b.re.sqrt()),
                    (x.asin(), y.asin(), libm::asin(x.re)),
                    (a.atan2(b), c.atan2(d), libm::atan2(a.re, b.re)),
                    (a.exp(), c.exp(), libm::exp(a.re)),
                    (a.hypot(b), (c * c + d * d).sqrt(), libm::hypot(a.re, b.re)),
                ] {
                    prop_assert_eq!(ours.re.to_bits(), plain.to_bits());
                    prop_assert!((ours.eps[i] - theirs.eps).abs() <= 1e-12 * (1.0 + theirs.eps.abs()), "{:?} {:?}", ours, theirs);
                }
            }
        }
    }
}
