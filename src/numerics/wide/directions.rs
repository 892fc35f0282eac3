//! Derivatives in four directions, as one vector of processors that have vectors of four numbers.

use std::ops::{Add, Mul, Sub};

use crate::numerics::gradient::{Directions, Gradient, MultiDual};
use crate::numerics::scalar::CombinesWith;
use crate::numerics::wide::{Simd, Wide};

/// Number of directions in a batch.
pub const DIRECTIONS: usize = 4;

/// A number with its derivatives in the directions of a batch, in memory.
pub type Number = Gradient<DIRECTIONS>;

/// Derivatives in the directions of a batch, as an array or as a vector.
pub trait Packed: Directions + From<[f64; DIRECTIONS]> + Into<[f64; DIRECTIONS]> {}

impl<D: Directions + From<[f64; DIRECTIONS]> + Into<[f64; DIRECTIONS]>> Packed for D {}

/// A computation with derivatives in the directions of a batch.
pub trait DirectionsTask {
    /// Its result.
    type Output;

    /// Runs the task. As in a [`Task`](super::Task), only inlined functions are compiled for the processor's vectors.
    fn run<D: Packed>(self) -> Self::Output
    where
        MultiDual<D>: CombinesWith<Number>;
}

/// A vector of [`DIRECTIONS`] numbers.
pub trait DirectionVector: Simd {}

impl<V: Simd> Directions for Wide<V> {
    #[inline(always)]
    fn zeros() -> Self {
        Wide::from(0.0)
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn negated(self) -> Self {
        -self
    }

    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        self * factor
    }
}

impl<V: DirectionVector> From<[f64; DIRECTIONS]> for Wide<V> {
    #[inline(always)]
    fn from([a, b, c, d]: [f64; DIRECTIONS]) -> Self {
        Wide::load(&[a, b, c, d, 0.0, 0.0, 0.0, 0.0])
    }
}

impl<V: DirectionVector> From<Wide<V>> for [f64; DIRECTIONS] {
    #[inline(always)]
    fn from(derivatives: Wide<V>) -> Self {
        let [a, b, c, d, ..] = derivatives.store();
        [a, b, c, d]
    }
}

impl<V: DirectionVector> From<Number> for MultiDual<Wide<V>> {
    #[inline(always)]
    fn from(MultiDual { re, eps }: Number) -> Self {
        MultiDual { re, eps: eps.into() }
    }
}

/// Implements an operator between a number in vectors and one in memory.
macro_rules! operator {
    ($trait:ident, $operate:ident) => {
        impl<V: DirectionVector> $trait<Number> for MultiDual<Wide<V>> {
            type Output = Self;

            #[inline(always)]
            fn $operate(self, other: Number) -> Self {
                self.$operate(Self::from(other))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::Scalar;
    use crate::numerics::wide::with_directions;

    /// All operations of two numbers, also with the second one as it is stored.
    #[derive(Clone, Copy)]
    struct Operations([Number; 2]);

    impl DirectionsTask for Operations {
        type Output = Vec<Number>;

        fn run<D: Packed>(self) -> Vec<Number>
        where
            MultiDual<D>: CombinesWith<Number>,
        {
            let Operations([x, other]) = self;
            let [a, b] = [MultiDual::<D>::from(x), MultiDual::from(other)];
            let (sin, cos) = a.sin_cos();
            let made = [a + b, a - b, a * b, a / b, -a, a + 2.0, a - 2.0, a * 2.0, sin, cos, a.exp(), b.sqrt()];
            let mixed = [a + other, a - other, a * other, MultiDual::from(0.7)];
            made.into_iter().chain(mixed).map(MultiDual::stored).collect()
        }
    }

    #[test]
    fn vectors_of_derivatives_have_the_bits_of_arrays() {
        let task =
            Operations([Number::new(0.3, [1.5, -0.0, 3e200, -7.25]), Number::new(2.5, [0.1, 1e-310, -2.0, 0.7])]);
        let bits = |made: Vec<Number>| -> Vec<[u64; 5]> {
            made.iter().map(|x| [x.re, x.eps[0], x.eps[1], x.eps[2], x.eps[3]].map(f64::to_bits)).collect()
        };
        if let Some(found) = with_directions(task) {
            assert_eq!(bits(found), bits(task.run::<[f64; DIRECTIONS]>()));
        }
    }
}
