//! Lanes as the numbers of equations: sines and cosines in each lane, and duals of lanes.

use std::ops::{Add, Mul, Sub};

use crate::numerics::dual::{Dual, constants_with_duals};
use crate::numerics::scalar::{Real, Scalar};
use crate::numerics::wide::{Array, MOST_LANES, Simd, Wide};

impl<V: Simd> Scalar for Wide<V> {
    type Real = Wide<V>;

    #[inline(always)]
    fn constant(value: Wide<V>) -> Wide<V> {
        value
    }

    #[inline(always)]
    fn sin_cos(self) -> (Wide<V>, Wide<V>) {
        if self.abs().less(Wide::from(QUARTER_PI)).all() {
            near_zero(self)
        } else {
            let (sines, cosines) = far_from_zero(&self.store());
            (Wide::load(&sines), Wide::load(&cosines))
        }
    }

    #[inline(always)]
    fn exp(self) -> Wide<V> {
        Wide::load(&self.store().map(libm::exp))
    }

    #[inline(always)]
    fn sqrt(self) -> Wide<V> {
        Wide(self.0.sqrt())
    }

    #[inline(always)]
    fn value(self) -> Wide<V> {
        self
    }

    #[inline(always)]
    fn select_less(a: Wide<V>, b: Wide<V>, yes: Wide<V>, no: Wide<V>) -> Wide<V> {
        yes.in_lanes(a.less(b), no)
    }
}

impl<V: Simd> Real for Wide<V> {
    #[inline(always)]
    fn abs(self) -> Wide<V> {
        Wide(self.0.abs())
    }
}

/// The least angle (rad), π/4 or so, that `libm` brings nearer to zero before it takes its sine: the least number above those
/// with these upper 32 bits.
const QUARTER_PI: f64 = f64::from_bits((0x3fe9_21fb + 1) << 32);

/// Sine and cosine with the operations of `libm::sincos` up to [`QUARTER_PI`], in their order: the polynomials of FreeBSD's
/// k_sin.c and k_cos.c (Copyright (C) 1993 by Sun Microsystems, Inc.; permission to use, copy, modify, and distribute this
/// software is freely granted, provided that this notice is preserved).
///
/// Below 2^−27 `libm` gives the angle and 1, and so do these, but for −0.
#[inline(always)]
fn near_zero<V: Simd>(x: Wide<V>) -> (Wide<V>, Wide<V>) {
    const S: [f64; 6] = [
        -0.16666666666666632,
        0.00833333333332249,
        -0.0001984126982985795,
        2.7557313707070068e-06,
        -2.5050760253406863e-08,
        1.58969099521155e-10,
    ];
    const C: [f64; 6] = [
        0.0416666666666666,
        -0.001388888888887411,
        2.480158728947673e-05,
        -2.7557314351390663e-07,
        2.087572321298175e-09,
        -1.1359647557788195e-11,
    ];
    let z = x * x;
    let w = z * z;
    let r = (z * S[3] + S[2]) * z + S[1] + z * w * (z * S[5] + S[4]);
    let sin = x + z * x * (z * r + S[0]);
    let sin = sin.in_lanes(Wide::default().less(z), x);
    let r = z * ((z * C[2] + C[1]) * z + C[0]) + w * w * ((z * C[5] + C[4]) * z + C[3]);
    let half = z * 0.5;
    let one = Wide::from(1.0);
    let cos = one - half;
    (sin, cos + (((one - cos) - half) + z * r))
}

#[cold]
#[inline(never)]
fn far_from_zero(angles: &Array) -> (Array, Array) {
    let (mut sines, mut cosines) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
    for ((angle, sine), cosine) in angles.iter().zip(&mut sines).zip(&mut cosines) {
        (*sine, *cosine) = libm::sincos(*angle);
    }
    (sines, cosines)
}

constants_with_duals!([V: Simd] Wide<V>);
