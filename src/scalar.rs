//! The numbers the equations are written in: `f64`, or a dual number that carries a derivative along.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::Dual64;

/// What the equations of motion, and the parameters in them, need of a number.
///
/// `f64` runs the simulation. A dual number in its place gives exact derivatives of the same formulas. What is computed from an
/// `f64` comes from the one implementation that gives the same bits on every platform (`libm`, a port of FreeBSD's msun: at
/// most 1 ulp of error, no platform-dependent instruction).
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + From<f64>
{
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// Sine of an angle in radians.
    fn sin(self) -> Self;

    /// Cosine of an angle in radians.
    fn cos(self) -> Self;

    /// The angle in radians whose sine this is, from −π/2 to π/2.
    fn asin(self) -> Self;

    /// The angle in radians of the point `(x, self)`.
    fn atan2(self, x: Self) -> Self;

    /// `√(self² + other²)`.
    fn hypot(self, other: Self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The value without its derivative.
    fn value(self) -> f64;
}

/// A number that goes together with the numbers `P` of a block: all are `f64`, or the block's are while this one carries a
/// derivative, or both carry one.
pub trait Beside<P>: Scalar + Add<P, Output = Self> + Sub<P, Output = Self> + Mul<P, Output = Self> + From<P> {}

impl<P, T> Beside<P> for T where T: Scalar + Add<P, Output = T> + Sub<P, Output = T> + Mul<P, Output = T> + From<P> {}

impl Scalar for f64 {
    #[inline]
    fn sin_cos(self) -> (f64, f64) {
        libm::sincos(self)
    }

    #[inline]
    fn sin(self) -> f64 {
        libm::sin(self)
    }

    #[inline]
    fn cos(self) -> f64 {
        libm::cos(self)
    }

    #[inline]
    fn asin(self) -> f64 {
        libm::asin(self)
    }

    #[inline]
    fn atan2(self, x: f64) -> f64 {
        libm::atan2(self, x)
    }

    #[inline]
    fn hypot(self, other: f64) -> f64 {
        libm::hypot(self, other)
    }

    #[inline]
    fn sqrt(self) -> f64 {
        self.sqrt()
    }

    #[inline]
    fn value(self) -> f64 {
        self
    }
}

impl Scalar for Dual64 {
    #[inline]
    fn sin_cos(self) -> (Dual64, Dual64) {
        let (sin, cos) = libm::sincos(self.re);
        (Dual64::new(sin, cos * self.eps), Dual64::new(cos, -sin * self.eps))
    }

    #[inline]
    fn sin(self) -> Dual64 {
        self.sin_cos().0
    }

    #[inline]
    fn cos(self) -> Dual64 {
        self.sin_cos().1
    }

    fn asin(self) -> Dual64 {
        Dual64::new(libm::asin(self.re), self.eps / ((1.0 - self.re) * (1.0 + self.re)).sqrt())
    }

    fn atan2(self, x: Dual64) -> Dual64 {
        let square = self.re * self.re + x.re * x.re;
        Dual64::new(libm::atan2(self.re, x.re), (x.re * self.eps - self.re * x.eps) / square)
    }

    fn hypot(self, other: Dual64) -> Dual64 {
        let length = libm::hypot(self.re, other.re);
        Dual64::new(length, (self.re * self.eps + other.re * other.eps) / length)
    }

    fn sqrt(self) -> Dual64 {
        let root = self.re.sqrt();
        Dual64::new(root, 0.5 * self.eps / root)
    }

    #[inline]
    fn value(self) -> f64 {
        self.re
    }
}
