//! The numbers the equations are written in: `f64`, or a dual number that carries a derivative along.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_dual::Dual64;

/// What the equations of motion need of a number.
///
/// `f64` runs the simulation. A dual number in its place gives exact derivatives of the same formulas.
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
    /// Sine and cosine of an angle in radians, from the one implementation that gives the same bits on every platform
    /// (`libm`, a port of FreeBSD's msun: at most 1 ulp of error, no platform-dependent instruction).
    fn sin_cos(self) -> (Self, Self);

    /// The value without its derivative.
    fn value(self) -> f64;
}

impl Scalar for f64 {
    #[inline]
    fn sin_cos(self) -> (f64, f64) {
        libm::sincos(self)
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
    fn value(self) -> f64 {
        self.re
    }
}
