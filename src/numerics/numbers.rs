//! Vectors of numbers that are integrated together: states and quadratures.
//!
//! The order of the operations determines the bits of a run.

use std::ops::{Add, Index, IndexMut, Mul, Sub};

use serde::{Deserialize, Serialize};

use crate::numerics::scalar::Scalar;

/// A vector of N numbers, one per lane if `R` is a lane type.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[R; N]: Serialize", deserialize = "[R; N]: Deserialize<'de>"))]
pub struct Numbers<R, const N: usize>(pub [R; N]);

impl<R: Scalar, const N: usize> Numbers<R, N> {
    /// Returns a vector of zeros.
    #[inline(always)]
    pub fn zeros() -> Self {
        Numbers([R::default(); N])
    }

    /// Returns a vector of the first of these numbers.
    #[inline(always)]
    #[expect(clippy::manual_memcpy, reason = "number by number they stay in registers")]
    pub fn first_of<const M: usize>(numbers: [R; M]) -> Self {
        let mut first = Self::zeros();
        for i in 0..N {
            first.0[i] = numbers[i];
        }
        first
    }

    /// Returns the vector times a factor.
    #[inline(always)]
    pub fn times(mut self, factor: R) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] * factor;
        }
        self
    }

    /// Returns the products with the elements of `weights`.
    #[inline(always)]
    pub fn weighted(mut self, weights: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] * weights.0[i];
        }
        self
    }

    /// Returns the sum of the squares.
    ///
    /// Four are added as `(a + c) + (b + d)`, eight as the sums of the two halves.
    #[inline(always)]
    pub fn square(self) -> R {
        let squares = self.weighted(self).0;
        match *squares.as_slice() {
            [a, b] => a + b,
            [a, b, c, d] => (a + c) + (b + d),
            [a, b, c, d, e, f, g, h] => ((a + c) + (b + d)) + ((e + g) + (f + h)),
            [a, b, c, d, e, f, g, h, i] => (((a + c) + (b + d)) + ((e + g) + (f + h))) + i,
            _ => unreachable!("a state has four, eight or nine numbers, the quadratures two"),
        }
    }

    /// Returns the root of the sum of the squares.
    #[inline(always)]
    pub fn norm(self) -> R {
        self.square().sqrt()
    }
}

impl<const N: usize> Numbers<f64, N> {
    /// Whether all numbers are finite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }
}

impl<R: Scalar, const N: usize> Default for Numbers<R, N> {
    #[inline(always)]
    fn default() -> Self {
        Numbers::zeros()
    }
}

impl<R, const N: usize> From<[R; N]> for Numbers<R, N> {
    #[inline(always)]
    fn from(numbers: [R; N]) -> Self {
        Numbers(numbers)
    }
}

impl<R, const N: usize> Index<usize> for Numbers<R, N> {
    type Output = R;

    #[inline(always)]
    fn index(&self, i: usize) -> &R {
        &self.0[i]
    }
}

impl<R, const N: usize> IndexMut<usize> for Numbers<R, N> {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut R {
        &mut self.0[i]
    }
}

impl<R: Scalar, const N: usize> Add for Numbers<R, N> {
    type Output = Self;

    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] + other.0[i];
        }
        self
    }
}

impl<R: Scalar, const N: usize> Sub for Numbers<R, N> {
    type Output = Self;

    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] - other.0[i];
        }
        self
    }
}

/// The product with a constant.
impl<R: Scalar, const N: usize> Mul<f64> for Numbers<R, N> {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, factor: f64) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] * factor;
        }
        self
    }
}
