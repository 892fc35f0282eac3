//! Lanes as the numbers of equations: sines and cosines in each lane, and duals of lanes.

use std::ops::{Add, Mul, Sub};

use crate::numerics::dual::{Dual, constants_with_duals};
use crate::numerics::numbers::Numbers;
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
        let (sin, cos) = near_zero(self);
        let near = self.abs().less(Wide::from(QUARTER_PI));
        if near.all() {
            return (sin, cos);
        }
        let (sines, cosines) = far_from_zero(&self.store(), (1 << V::LANES) - 1 - near.bits());
        (sin.in_lanes(near, Wide::load(&sines)), cos.in_lanes(near, Wide::load(&cosines)))
    }

    #[inline(always)]
    fn exp(self) -> Wide<V> {
        let powers = in_range(self);
        let far = Wide::from(EXP_RANGE).less(self.abs()).bits();
        if far == 0 { powers } else { Wide::load(&out_of_range(&self.store(), far, powers.store())) }
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

/// Sines and cosines in the lanes that are `far`.
#[cold]
#[inline(never)]
fn far_from_zero(angles: &Array, far: u32) -> (Array, Array) {
    let (mut sines, mut cosines) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
    for i in (0..MOST_LANES).filter(|i| far >> i & 1 == 1) {
        (sines[i], cosines[i]) = libm::sincos(angles[i]);
    }
    (sines, cosines)
}

/// The magnitude up to which [`in_range`] holds: `libm` looks at the upper 32 bits, too, and then for overflow and underflow.
const EXP_RANGE: f64 = f64::from_bits((0x4086_232b << 32) - 1);

/// The exponential function with the operations of `libm::exp` in their order: FreeBSD's e_exp.c (Copyright (C) 2004 by Sun Microsystems,
/// Inc.; permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is preserved).
#[inline(always)]
fn in_range<V: Simd>(x: Wide<V>) -> Wide<V> {
    /// Up to this magnitude `k = 0`.
    const HALF_LN_2: f64 = f64::from_bits((0x3fd6_2e43 << 32) - 1);
    /// Below this magnitude `exp(x) = 1 + x`.
    const TINY: f64 = f64::from_bits(0x3e30_0001 << 32);
    const LN_2: [f64; 2] = [0.6931471803691238, 1.9082149292705877e-10];
    const P: [f64; 5] = [
        0.16666666666666602,
        -0.0027777777777015593,
        6.613756321437934e-05,
        -1.6533902205465252e-06,
        4.1381367970572385e-08,
    ];
    // x = k ln 2 + r.
    let (numbers, mut multiples, mut powers) = (x.store(), [0.0; MOST_LANES], [1.0; MOST_LANES]);
    for i in 0..V::LANES {
        let x = numbers[i];
        if x.abs() > HALF_LN_2 {
            let k = (std::f64::consts::LOG2_E * x + if x < 0.0 { -0.5 } else { 0.5 }) as i32;
            multiples[i] = f64::from(k);
            powers[i] = f64::from_bits(((i64::from(k.clamp(-1022, 1023)) + 1023) << 52) as u64);
        }
    }
    let (k, power) = (Wide::load(&multiples), Wide::load(&powers));
    let (hi, lo) = (x - k * LN_2[0], k * LN_2[1]);
    let r = hi - lo;
    let z = r * r;
    let c = r - z * (z * (z * (z * (z * P[4] + P[3]) + P[2]) + P[1]) + P[0]);
    let y = r * c / (Wide::from(2.0) - c) - lo + hi + 1.0;
    (x + 1.0).in_lanes(x.abs().less(Wide::from(TINY)), y * power)
}

/// These exponentials of `numbers`, with those in the lanes that are `far` by `libm`.
#[cold]
#[inline(never)]
fn out_of_range(numbers: &Array, far: u32, mut powers: Array) -> Array {
    for i in (0..MOST_LANES).filter(|i| far >> i & 1 == 1) {
        powers[i] = libm::exp(numbers[i]);
    }
    powers
}

impl<V: Simd, const N: usize> Numbers<Wide<V>, N> {
    /// Returns the numbers of one lane.
    #[inline(always)]
    pub fn of_lane(&self, lane: usize) -> Numbers<f64, N> {
        let mut numbers = Numbers::zeros();
        for i in 0..N {
            numbers.0[i] = self.0[i].of_lane(lane);
        }
        numbers
    }
}

constants_with_duals!([V: Simd] Wide<V>);

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::numerics::wide::{Task, VectorWidth};

    /// Sines, cosines and exponentials of these numbers.
    struct Functions(Array);

    impl Task for Functions {
        type Output = [Array; 3];

        fn run<V: Simd>(self) -> [Array; 3] {
            let x = Wide::<V>::load(&self.0);
            let (sin, cos) = x.sin_cos();
            [sin.store(), cos.store(), x.exp().store()]
        }
    }

    /// Numbers of all sizes, those at which `libm` changes its method, and their neighbours.
    fn number() -> impl Strategy<Value = f64> {
        let limits = [0x3e30_0001_u64, 0x3fd6_2e43, 0x3fe9_21fc, 0x3ff0_a2b2, 0x4086_232b]
            .map(|bits| f64::from_bits(bits << 32));
        let limit = prop::sample::select(limits.to_vec())
            .prop_flat_map(|x| prop::sample::select(vec![x, x.next_down(), x.next_up()]));
        let magnitude = prop_oneof![limit, 0.0..1.5, 0.0..800.0, (-40.0..0.0).prop_map(libm::exp)];
        (magnitude, any::<bool>()).prop_map(|(x, negative)| if negative { -x } else { x })
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(5000) })]

        #[test]
        fn functions_have_the_bits_of_libm(numbers in prop::array::uniform8(number())) {
            for width in [2, 4, 8].into_iter().filter_map(VectorWidth::at_most) {
                let found = width.run(Functions(numbers));
                for (i, x) in numbers.into_iter().enumerate().take(width.lanes()) {
                    let expected = [libm::sin(x), libm::cos(x), libm::exp(x)];
                    let found = found.map(|numbers| numbers[i]);
                    prop_assert!(found.map(f64::to_bits) == expected.map(f64::to_bits), "{x:e}: {found:?}, {expected:?}");
                }
            }
        }
    }
}
