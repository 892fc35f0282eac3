//! The numbers of the equations: `f64`, one number per lane, or a dual number with its derivative.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number of the equations of motion.
///
/// Simulations use `f64`. Dual numbers give the exact derivatives of the same formulas; lanes run several blocks.
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
    /// The type of the value without its derivative.
    type Real: Real;

    /// Returns a constant, with a derivative of zero.
    fn constant(value: Self::Real) -> Self;

    /// Returns the sine and cosine of an angle in radians.
    ///
    /// They have the same bits on every platform: `libm`, a port of FreeBSD's msun, uses no platform-dependent instruction and is
    /// accurate to 1 ulp.
    fn sin_cos(self) -> (Self, Self);

    /// Returns the sine of an angle in radians.
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Returns the cosine of an angle in radians.
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// Returns the exponential function, also from `libm`.
    fn exp(self) -> Self;

    /// Returns the square root.
    fn sqrt(self) -> Self;

    /// Returns the value without its derivative.
    fn value(self) -> Self::Real;

    /// Returns `yes` if `a < b`, and otherwise `no`, in each lane.
    fn select_less(a: Self::Real, b: Self::Real, yes: Self, no: Self) -> Self;
}

/// Some of the runs in lanes, or whether it is a single run.
pub trait Runs<R>: Copy {
    /// The runs in both.
    fn and(self, other: Self) -> Self;
    /// The runs in either.
    fn or(self, other: Self) -> Self;
    /// These runs without the others.
    fn except(self, other: Self) -> Self;
    /// Whether there is one.
    fn any(self) -> bool;
    /// One number in these runs, the other elsewhere.
    fn choose(self, one: R, other: R) -> R;
}

/// A number without a derivative, or one per lane: the type of states and steps.
pub trait Real: Scalar<Real = Self> {
    /// Some of the runs.
    type Runs: Runs<Self>;

    /// Returns the absolute value.
    fn abs(self) -> Self;

    /// Returns the runs in which this number is less than another.
    fn less(self, other: Self) -> Self::Runs;
}

/// Returns the lesser of two numbers, or the first if they are equal.
#[inline(always)]
pub fn least<T: Scalar>(a: T, b: T) -> T {
    T::select_less(b.value(), a.value(), b, a)
}

/// Returns the greater of two numbers, or the first if they are equal.
#[inline(always)]
pub fn greatest<T: Scalar>(a: T, b: T) -> T {
    T::select_less(a.value(), b.value(), b, a)
}

/// A number that combines with parameters of type `P`. It is of the same type, or a dual number with plain parameters.
pub trait CombinesWith<P>:
    Scalar + Add<P, Output = Self> + Sub<P, Output = Self> + Mul<P, Output = Self> + From<P>
{
}

impl<P, T> CombinesWith<P> for T where T: Scalar + Add<P, Output = T> + Sub<P, Output = T> + Mul<P, Output = T> + From<P>
{}

/// A number with further functions from `libm` for parameters and initial values.
pub trait Elementary: Scalar<Real = f64> {
    /// Returns the arcsine in radians, from −π/2 to π/2.
    fn asin(self) -> Self;

    /// Returns the angle in radians of the point `(x, self)`.
    fn atan2(self, x: Self) -> Self;

    /// Returns `√(self² + other²)`.
    fn hypot(self, other: Self) -> Self;

    /// Returns true if the value is zero, of either sign, and its derivative too.
    fn is_zero(self) -> bool;

    /// Returns the derivative in the direction; 0 of a plain number, and of one with several directions.
    fn slope(self) -> f64;
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

impl Runs<f64> for bool {
    #[inline(always)]
    fn and(self, other: bool) -> bool {
        self && other
    }

    #[inline(always)]
    fn or(self, other: bool) -> bool {
        self || other
    }

    #[inline(always)]
    fn except(self, other: bool) -> bool {
        self && !other
    }

    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn choose(self, one: f64, other: f64) -> f64 {
        if self { one } else { other }
    }
}

impl Real for f64 {
    type Runs = bool;

    #[inline(always)]
    fn abs(self) -> f64 {
        self.abs()
    }

    #[inline(always)]
    fn less(self, other: f64) -> bool {
        self < other
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

    #[inline(always)]
    fn slope(self) -> f64 {
        0.0
    }
}
