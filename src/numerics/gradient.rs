//! A number with its derivatives in several directions, which formulas carry along exactly.
//!
//! Each operation does to the number itself what it does to an `f64`: the values have the bits of plain numbers, and decide alike.
//! Derivatives are formed in loops over indices: closures over arrays are calls, which cost most of the time, and iterators are ten
//! times as much to compile, in each operation of each formula.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::numerics::dual::{Dual, constants_with_duals};
use crate::numerics::scalar::{Elementary, Scalar};

/// A number, and its derivatives in N directions. These are aligned so that the compiler takes four as one vector, and none of them with
/// the number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Gradient<const N: usize> {
    /// Its derivatives.
    pub eps: [f64; N],
    /// The number.
    pub re: f64,
}

/// A number with its derivative in one direction. Unlike that of a [`Dual`], its value has the bits of a plain number.
pub type Along = Gradient<1>;

impl<const N: usize> Gradient<N> {
    /// A number with these derivatives.
    #[inline(always)]
    pub fn new(re: f64, eps: [f64; N]) -> Self {
        Gradient { re, eps }
    }

    /// The value `re` of a function of both numbers, whose partial derivatives are these.
    #[inline(always)]
    fn chain(self, other: Self, re: f64, [by_self, by_other]: [f64; 2]) -> Self {
        let mut eps = self.eps;
        let mut i = 0;
        while i < N {
            eps[i] = eps[i] * by_self + other.eps[i] * by_other;
            i += 1;
        }
        Gradient { re, eps }
    }

    /// The value `re` of a function of this number, whose derivative is `slope`.
    #[inline(always)]
    fn map(self, re: f64, slope: f64) -> Self {
        let mut eps = self.eps;
        let mut i = 0;
        while i < N {
            eps[i] *= slope;
            i += 1;
        }
        Gradient { re, eps }
    }
}

impl<const N: usize> Default for Gradient<N> {
    #[inline(always)]
    fn default() -> Self {
        Gradient::from(0.0)
    }
}

impl<const N: usize> From<f64> for Gradient<N> {
    #[inline(always)]
    fn from(re: f64) -> Self {
        Gradient { re, eps: [0.0; N] }
    }
}

impl<const N: usize> Neg for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let mut eps = self.eps;
        let mut i = 0;
        while i < N {
            eps[i] = -eps[i];
            i += 1;
        }
        Gradient { re: -self.re, eps }
    }
}

impl<const N: usize> Add for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let mut eps = self.eps;
        let mut i = 0;
        while i < N {
            eps[i] += other.eps[i];
            i += 1;
        }
        Gradient { re: self.re + other.re, eps }
    }
}

impl<const N: usize> Sub for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let mut eps = self.eps;
        let mut i = 0;
        while i < N {
            eps[i] -= other.eps[i];
            i += 1;
        }
        Gradient { re: self.re - other.re, eps }
    }
}

impl<const N: usize> Mul for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain(other, self.re * other.re, [other.re, self.re])
    }
}

impl<const N: usize> Div for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, inverse) = (self.re / other.re, 1.0 / other.re);
        self.chain(other, quotient, [inverse, -quotient * inverse])
    }
}

impl<const N: usize> Add<f64> for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Gradient { re: self.re + other, ..self }
    }
}

impl<const N: usize> Sub<f64> for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Gradient { re: self.re - other, ..self }
    }
}

impl<const N: usize> Mul<f64> for Gradient<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self.map(self.re * other, other)
    }
}

impl<const N: usize> Scalar for Gradient<N> {
    type Real = f64;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Gradient::from(value)
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

    fn is_zero(self) -> bool {
        self.re.is_zero() && self.eps.iter().all(|eps| *eps == 0.0)
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
        /// In each direction the derivatives are those of `num-dual`; the values have the bits of plain numbers.
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
