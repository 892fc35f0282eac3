//! The numbers in which equations are written: `f64`, one number per lane, or a dual number with its derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The operations that the equations of motion need.
///
/// `f64` runs the simulation. A dual number in its place gives exact derivatives of the same formulas; lanes run several blocks.
pub trait Scalar:
    Copy
    + Default
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
    /// The number without its derivative.
    type Real: Real;

    /// A number that does not change.
    fn constant(value: Self::Real) -> Self;

    /// Sine and cosine of an angle in radians, from the one implementation that gives the same bits on every platform
    /// (`libm`, a port of FreeBSD's msun: at most 1 ulp of error, no platform-dependent instruction).
    fn sin_cos(self) -> (Self, Self);

    /// Sine of an angle in radians.
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Cosine of an angle in radians.
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// The exponential function, from `libm` as well.
    fn exp(self) -> Self;

    /// The square root.
    fn sqrt(self) -> Self;

    /// The value without its derivative.
    fn value(self) -> Self::Real;

    /// `yes` where `a < b`, `no` elsewhere.
    fn select_less(a: Self::Real, b: Self::Real, yes: Self, no: Self) -> Self;
}

/// A number without a derivative, or one per lane: steps are made of these.
pub trait Real: Scalar<Real = Self> {
    /// The absolute value.
    fn abs(self) -> Self;
}

/// The lesser of two numbers; the first if they are equal.
#[inline(always)]
pub fn least<T: Scalar>(a: T, b: T) -> T {
    T::select_less(b.value(), a.value(), b, a)
}

/// The greater of two numbers; the first if they are equal.
#[inline(always)]
pub fn greatest<T: Scalar>(a: T, b: T) -> T {
    T::select_less(a.value(), b.value(), b, a)
}

/// A number that combines with the parameters `P` of a block: of the same type, or a dual number beside plain parameters.
pub trait Beside<P>: Scalar + Add<P, Output = Self> + Sub<P, Output = Self> + Mul<P, Output = Self> + From<P> {}

impl<P, T> Beside<P> for T where T: Scalar + Add<P, Output = T> + Sub<P, Output = T> + Mul<P, Output = T> + From<P> {}

/// The further functions, from `libm`, of formulas that are evaluated once from parameters and initial values.
pub trait Elementary: Scalar<Real = f64> {
    /// The angle in radians whose sine this is, from −π/2 to π/2.
    fn asin(self) -> Self;

    /// The angle in radians of the point `(x, self)`.
    fn atan2(self, x: Self) -> Self;

    /// `√(self² + other²)`.
    fn hypot(self, other: Self) -> Self;

    /// Whether it is zero, of either sign, and with it its derivative.
    fn is_zero(self) -> bool;
}

impl Scalar for f64 {
    type Real = f64;

    #[inline(always)]
    fn constant(value: f64) -> f64 {
        value
    }

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
    fn exp(self) -> f64 {
        libm::exp(self)
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        self.sqrt()
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn select_less(a: f64, b: f64, yes: f64, no: f64) -> f64 {
        if a < b { yes } else { no }
    }
}

impl Real for f64 {
    #[inline(always)]
    fn abs(self) -> f64 {
        self.abs()
    }
}

impl Elementary for f64 {
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
    fn is_zero(self) -> bool {
        self == 0.0
    }
}
