//! Dual numbers: a number with its exact derivative.
//!
//! The rules of differentiation are those of `num-dual`, with the same operations in the same order, for `f64` and for lanes.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::numerics::scalar::{Elementary, Scalar};

/// `re + eps ε` with `ε² = 0`: a number and its derivative. It is with respect to time or a parameter.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Dual<R = f64> {
    /// The number.
    pub re: R,
    /// Its derivative.
    pub eps: R,
}

/// Implements operators between a dual of `$number` and a constant of that type. The type is not `f64`.
macro_rules! constants_with_duals {
    ([$($generics:tt)*] $number:ty) => {
        impl<$($generics)*> From<$number> for Dual<$number> {
            #[inline(always)]
            fn from(value: $number) -> Self {
                Dual::new(value, Default::default())
            }
        }

        impl<$($generics)*> Add<$number> for Dual<$number> {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: $number) -> Self {
                Dual::new(self.re + other, self.eps)
            }
        }

        impl<$($generics)*> Sub<$number> for Dual<$number> {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: $number) -> Self {
                Dual::new(self.re - other, self.eps)
            }
        }

        impl<$($generics)*> Mul<$number> for Dual<$number> {
            type Output = Self;

            #[inline(always)]
            fn mul(self, other: $number) -> Self {
                Dual::new(self.re * other, self.eps * other)
            }
        }
    };
}
pub(super) use constants_with_duals;

impl<R> Dual<R> {
    /// Returns a number with this derivative.
    #[inline(always)]
    pub fn new(re: R, eps: R) -> Dual<R> {
        Dual { re, eps }
    }
}

impl Dual {
    /// Returns the absolute value with its derivative.
    pub fn abs(self) -> Dual {
        if self.re < 0.0 { -self } else { self }
    }
}

impl<R: Default> Default for Dual<R> {
    #[inline(always)]
    fn default() -> Dual<R> {
        Dual::new(R::default(), R::default())
    }
}

impl<R: Scalar> From<f64> for Dual<R> {
    #[inline(always)]
    fn from(value: f64) -> Dual<R> {
        Dual::new(R::from(value), R::default())
    }
}

impl<R: Scalar> Neg for Dual<R> {
    type Output = Dual<R>;

    #[inline(always)]
    fn neg(self) -> Dual<R> {
        Dual::new(-self.re, -self.eps)
    }
}

/// Implements an operator between two duals and between a dual and a constant.
macro_rules! operator {
    ($trait:ident, $operate:ident, |$a:ident, $b:ident| $of_duals:expr, |$c:ident, $d:ident| $of_constant:expr) => {
        impl<R: Scalar> $trait for Dual<R> {
            type Output = Dual<R>;

            #[inline(always)]
            fn $operate(self, other: Dual<R>) -> Dual<R> {
                let ($a, $b) = (self, other);
                $of_duals
            }
        }

        impl<R: Scalar> $trait<f64> for Dual<R> {
            type Output = Dual<R>;

            #[inline(always)]
            fn $operate(self, other: f64) -> Dual<R> {
                let ($c, $d) = (self, other);
                $of_constant
            }
        }
    };
}
operator!(Add, add, |a, b| Dual::new(a.re + b.re, a.eps + b.eps), |a, b| Dual::new(a.re + b, a.eps));
operator!(Sub, sub, |a, b| Dual::new(a.re - b.re, a.eps - b.eps), |a, b| Dual::new(a.re - b, a.eps));
operator!(Mul, mul, |a, b| Dual::new(a.re * b.re, a.eps * b.re + b.eps * a.re), |a, b| Dual::new(a.re * b, a.eps * b));

/// Implements the operator that assigns, which vectors of nalgebra need.
macro_rules! assigning_operator {
    ($trait:ident, $assign:ident, $operate:ident) => {
        impl<R: Scalar> $trait for Dual<R> {
            #[inline(always)]
            fn $assign(&mut self, other: Dual<R>) {
                *self = (*self).$operate(other);
            }
        }
    };
}
assigning_operator!(AddAssign, add_assign, add);
assigning_operator!(SubAssign, sub_assign, sub);
assigning_operator!(MulAssign, mul_assign, mul);

impl<R: Scalar> Div for Dual<R> {
    type Output = Dual<R>;

    #[inline(always)]
    fn div(self, other: Dual<R>) -> Dual<R> {
        let inverse = R::from(1.0) / other.re;
        Dual::new(self.re * inverse, (self.eps * other.re - other.eps * self.re) * inverse * inverse)
    }
}

impl<R: Scalar> Scalar for Dual<R> {
    type Real = R::Real;

    #[inline(always)]
    fn constant(value: R::Real) -> Dual<R> {
        Dual::new(R::constant(value), R::default())
    }

    #[inline(always)]
    fn sin_cos(self) -> (Dual<R>, Dual<R>) {
        let (sin, cos) = self.re.sin_cos();
        (Dual::new(sin, cos * self.eps), Dual::new(cos, -sin * self.eps))
    }

    #[inline(always)]
    fn exp(self) -> Dual<R> {
        let power = self.re.exp();
        Dual::new(power, power * self.eps)
    }

    #[inline(always)]
    fn sqrt(self) -> Dual<R> {
        let root = self.re.sqrt();
        Dual::new(root, self.eps * R::from(0.5) / root)
    }

    #[inline(always)]
    fn value(self) -> R::Real {
        self.re.value()
    }

    #[inline(always)]
    fn select_less(a: R::Real, b: R::Real, yes: Dual<R>, no: Dual<R>) -> Dual<R> {
        Dual::new(R::select_less(a, b, yes.re, no.re), R::select_less(a, b, yes.eps, no.eps))
    }
}

impl Elementary for Dual {
    fn asin(self) -> Dual {
        Dual::new(libm::asin(self.re), self.eps / ((1.0 - self.re) * (1.0 + self.re)).sqrt())
    }

    /// The angle of the origin has no rate.
    fn atan2(self, x: Dual) -> Dual {
        let square = self.re * self.re + x.re * x.re;
        let rate = if square == 0.0 { 0.0 } else { (x.re * self.eps - self.re * x.eps) / square };
        Dual::new(libm::atan2(self.re, x.re), rate)
    }

    /// From zero it grows in any direction.
    fn hypot(self, other: Dual) -> Dual {
        let length = libm::hypot(self.re, other.re);
        if length == 0.0 {
            return Dual::new(0.0, libm::hypot(self.eps, other.eps));
        }
        Dual::new(length, (self.re * self.eps + other.re * other.eps) / length)
    }

    fn is_zero(self) -> bool {
        self.re == 0.0 && self.eps == 0.0
    }

    fn slope(self) -> f64 {
        self.eps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the same number as a dual of `num-dual`.
    fn other(x: Dual) -> num_dual::Dual64 {
        num_dual::Dual64::new(x.re, x.eps)
    }

    fn bits(x: Dual) -> [u64; 2] {
        [x.re.to_bits(), x.eps.to_bits()]
    }

    proptest! {
        /// The bits of each operation are those of `num-dual`.
        #[test]
        fn operations_are_those_of_num_dual(a in [-1e3..1e3, -1e3..1e3], b in [-1e3..1e3, -1e3..1e3], c in -1e3..1e3) {
            let [a, b] = [a, b].map(|[re, eps]| Dual::new(re, eps));
            for (ours, theirs) in [
                (a + b, other(a) + other(b)),
                (a - b, other(a) - other(b)),
                (a * b, other(a) * other(b)),
                (a / b, other(a) / other(b)),
                (-a, -other(a)),
                (a + c, other(a) + c),
                (a - c, other(a) - c),
                (a * c, other(a) * c),
                (Dual::from(c), num_dual::Dual64::from(c)),
            ] {
                prop_assert_eq!(bits(ours), [theirs.re.to_bits(), theirs.eps.to_bits()]);
            }
        }

        /// The derivative of each function is that of `num-dual`.
        #[test]
        fn functions_are_those_of_num_dual(x in 0.01..0.99, y in [0.1..9.0, -2.0..2.0], eps in -2.0..2.0) {
            use num_dual::DualNum;
            let (x, y) = (Dual::new(x, eps), Dual::new(y[0], y[1]));
            for (ours, theirs) in [
                (x.sin(), other(x).sin()),
                (x.cos(), other(x).cos()),
                (x.exp(), other(x).exp()),
                (y.sqrt(), other(y).sqrt()),
                (x.exp(), other(x).exp()),
            ] {
                prop_assert!((ours.re - theirs.re).abs() <= 1e-14 * theirs.re.abs(), "{ours:?} {theirs:?}");
                prop_assert!((ours.eps - theirs.eps).abs() <= 1e-12 * (1.0 + theirs.eps.abs()), "{ours:?} {theirs:?}");
            }
        }
    }
}
