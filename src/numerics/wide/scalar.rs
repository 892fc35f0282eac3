//! Lanes as numbers of the equations: sine, cosine and exponential with the bits of `libm`, and duals of lanes.

use std::ops::{Add, Mul, Sub};

use crate::numerics::dual::{Dual, constants_with_duals};
use crate::numerics::numbers::Numbers;
use crate::numerics::scalar::{Real, Runs, Scalar};
use crate::numerics::wide::{Array, Lanes, MAX_LANES, Simd, Wide};

impl<V: Simd> Scalar for Wide<V> {
    type Real = Wide<V>;

    #[inline(always)]
    fn constant(value: Wide<V>) -> Wide<V> {
        value
    }

    #[inline(always)]
    fn sin_cos(self) -> (Wide<V>, Wide<V>) {
        if self.abs().less(Wide::from(QUARTER_PI)).all() { near_zero(self) } else { reduced(self) }
    }

    #[inline(always)]
    fn exp(self) -> Wide<V> {
        let powers = exp_in_range(self);
        let far = Wide::from(EXP_RANGE).less(self.abs()).bits();
        if far == 0 { powers } else { Wide::load(&exp_by_libm(&self.store(), far, powers.store())) }
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
        a.less(b).choose(yes, no)
    }
}

impl<V: Simd> Runs<Wide<V>> for Lanes<V> {
    #[inline(always)]
    fn and(self, other: Lanes<V>) -> Lanes<V> {
        Lanes(V::both(self.0, other.0))
    }

    #[inline(always)]
    fn or(self, other: Lanes<V>) -> Lanes<V> {
        Lanes(V::either(self.0, other.0))
    }

    #[inline(always)]
    fn except(self, other: Lanes<V>) -> Lanes<V> {
        Lanes(V::except(self.0, other.0))
    }

    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    #[inline(always)]
    fn choose(self, one: Wide<V>, other: Wide<V>) -> Wide<V> {
        Wide(one.0.select(self.0, other.0))
    }
}

impl<V: Simd> Real for Wide<V> {
    type Runs = Lanes<V>;

    #[inline(always)]
    fn abs(self) -> Wide<V> {
        Wide(self.0.abs())
    }

    #[inline(always)]
    fn less(self, other: Wide<V>) -> Lanes<V> {
        Lanes(self.0.less(other.0))
    }
}

/// Least angle (rad), about π/4, whose argument `libm` reduces. It compares the upper 32 bits.
const QUARTER_PI: f64 = f64::from_bits((0x3fe9_21fb + 1) << 32);

/// Sine and cosine up to [`QUARTER_PI`], with the operations of `libm::sincos` in their order. The polynomials are those of FreeBSD's
/// k_sin.c and k_cos.c (Copyright (C) 1993 by Sun Microsystems, Inc.; permission to use, copy, modify, and distribute this software is
/// freely granted, provided that this notice is preserved).
///
/// Below 2^−27 `libm` returns the angle and 1, and so do these polynomials, except for −0.
#[inline(always)]
fn near_zero<V: Simd>(x: Wide<V>) -> (Wide<V>, Wide<V>) {
    let z = x * x;
    let sin = x + z * x * (z * sine_polynomial(z) + S[0]);
    (Wide::default().less(z).choose(sin, x), cosine(z, z * cosine_polynomial(z)))
}

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

/// Evaluates the sine's polynomial, without its first terms, at the square of an angle.
#[inline(always)]
fn sine_polynomial<V: Simd>(z: Wide<V>) -> Wide<V> {
    (z * S[3] + S[2]) * z + S[1] + z * (z * z) * (z * S[5] + S[4])
}

/// Evaluates the cosine's polynomial, without its first terms, at the square of an angle.
#[inline(always)]
fn cosine_polynomial<V: Simd>(z: Wide<V>) -> Wide<V> {
    let w = z * z;
    z * ((z * C[2] + C[1]) * z + C[0]) + w * w * ((z * C[5] + C[4]) * z + C[3])
}

/// Returns `1 − z/2 + rest` with a compensated sum.
#[inline(always)]
fn cosine<V: Simd>(z: Wide<V>, rest: Wide<V>) -> Wide<V> {
    let (half, one) = (z * 0.5, Wide::from(1.0));
    let cos = one - half;
    cos + (((one - cos) - half) + rest)
}

/// Sine and cosine of reduced arguments, with the operations of `libm::sincos` in their order.
///
/// The nearest multiple of π/2 is subtracted in one round of FreeBSD's e_rem_pio2.c (Copyright (C) 1993 by Sun Microsystems, Inc., as
/// above). `libm` handles the lanes that need more rounds: large angles, those very near a multiple of π/2, and those about halfway
/// between two multiples, where it may choose the other one.
#[inline(always)]
fn reduced<V: Simd>(x: Wide<V>) -> (Wide<V>, Wide<V>) {
    const HALF_PI: [f64; 2] = [1.5707963267341256, 6.077100506506192e-11];
    /// Least reduced angle, relative to the angle, for which one round suffices.
    const NO_CANCELLATION: f64 = 1.0 / 65536.0;
    /// Greatest reduced angle (rad). `libm` chooses the multiple of π/2 by 20 bits after the first.
    const BETWEEN: f64 = std::f64::consts::FRAC_PI_4 - 1e-5;
    const LARGE: f64 = 1e6;

    let (zero, near) = (Wide::default(), x.abs().less(Wide::from(QUARTER_PI)));
    let multiple = near.choose(zero, nearest_whole(x * std::f64::consts::FRAC_2_PI));
    let (r, w) = (x - multiple * HALF_PI[0], multiple * HALF_PI[1]);
    let y = r - w;
    let tail = (r - y) - w;
    let near_a_multiple = (x.abs() * NO_CANCELLATION).less(y.abs());
    let in_one_round = near_a_multiple.and(y.abs().less(Wide::from(BETWEEN))).and(x.abs().less(Wide::from(LARGE)));

    let z = y * y;
    let (v, r) = (z * y, sine_polynomial(z));
    let sin = near.choose(y + v * (z * r + S[0]), y - ((z * (tail * 0.5 - v * r) - tail) - v * S[0]));
    let cos = cosine(z, z * cosine_polynomial(z) - y * tail);
    // −2 or 2, −1, 0, or 1 quarters of a turn beyond full turns.
    let quarters = multiple - nearest_whole(multiple * 0.25) * 4.0;
    let half = Wide::from(0.5);
    let (odd, opposite) = ((quarters.abs() - 1.0).abs().less(half), Wide::from(1.5).less(quarters.abs()));
    let (sin, cos) = (odd.choose(cos, sin), odd.choose(sin, cos));
    let sin = opposite.or(quarters.less(-half)).choose(-sin, sin);
    let cos = opposite.or(half.less(quarters)).choose(-cos, cos);
    if in_one_round.all() {
        return (sin, cos);
    }
    let others = (1 << V::LANES) - 1 - in_one_round.bits();
    let [sin, cos] = sin_cos_by_libm(&x.store(), others, [sin.store(), cos.store()]);
    (Wide::load(&sin), Wide::load(&cos))
}

/// Returns the nearest whole number.
#[inline(always)]
fn nearest_whole<V: Simd>(x: Wide<V>) -> Wide<V> {
    /// A sum with this is rounded to a whole number.
    const TO_WHOLE: f64 = 1.5 / f64::EPSILON;
    (x + TO_WHOLE) - TO_WHOLE
}

/// Replaces the sines and cosines in some lanes by those that `libm` computes from `angles`.
#[cold]
#[inline(never)]
fn sin_cos_by_libm(angles: &Array, lanes: u32, [mut sines, mut cosines]: [Array; 2]) -> [Array; 2] {
    for i in (0..MAX_LANES).filter(|i| lanes >> i & 1 == 1) {
        (sines[i], cosines[i]) = libm::sincos(angles[i]);
    }
    [sines, cosines]
}

/// Greatest magnitude for [`exp_in_range`]. Beyond it `libm`, which compares the upper 32 bits, tests for overflow and underflow.
const EXP_RANGE: f64 = f64::from_bits((0x4086_232b << 32) - 1);

/// The exponential function with the operations of `libm::exp` in their order. These are FreeBSD's e_exp.c (Copyright (C) 2004 by Sun
/// Microsystems, Inc.; permission to use, copy, modify, and distribute this software is freely granted, provided that this notice is
/// preserved).
#[inline(always)]
fn exp_in_range<V: Simd>(x: Wide<V>) -> Wide<V> {
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
    // x = k ln 2 + r, where k is x / ln 2 ± 1/2 truncated towards zero.
    let zero = Wide::default();
    let (half, one) = (Wide::from(0.5), Wide::from(1.0));
    let negative = x.less(zero);
    let y = x * std::f64::consts::LOG2_E + negative.choose(-half, half);
    let nearest = nearest_whole(y);
    let toward_zero = nearest - negative.choose(-one, one);
    let k = y.abs().less(nearest.abs()).choose(toward_zero, nearest);
    let k = Wide::from(HALF_LN_2).less(x.abs()).choose(k, zero);
    let power = k.power_of_two();
    let (hi, lo) = (x - k * LN_2[0], k * LN_2[1]);
    let r = hi - lo;
    let z = r * r;
    let c = r - z * (z * (z * (z * (z * P[4] + P[3]) + P[2]) + P[1]) + P[0]);
    let y = r * c / (Wide::from(2.0) - c) - lo + hi + 1.0;
    x.abs().less(Wide::from(TINY)).choose(x + 1.0, y * power)
}

/// Replaces the exponentials in the lanes `far` out of range by those of `libm`.
#[cold]
#[inline(never)]
fn exp_by_libm(numbers: &Array, far: u32, mut powers: Array) -> Array {
    for i in (0..MAX_LANES).filter(|i| far >> i & 1 == 1) {
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
        let limits = [
            0x3e30_0001_u64,
            0x3fd6_2e43,
            0x3fe9_21fc,
            0x3ff0_a2b2,
            0x4002_d97d,
            0x400f_6a7b,
            0x4015_fdbd,
            0x4086_232b,
        ]
        .map(|bits| f64::from_bits(bits << 32));
        let limit = prop::sample::select(limits.to_vec())
            .prop_flat_map(|x| prop::sample::select(vec![x, x.next_down(), x.next_up()]));
        let near_eighths = (0..2000_u32, prop_oneof![Just(0.0), -1e-3..1e-3, -1e-5..1e-5, -1e-12..1e-12])
            .prop_map(|(eighths, away)| (f64::from(eighths) * std::f64::consts::FRAC_PI_4 + away).abs());
        let magnitude = prop_oneof![
            limit,
            near_eighths,
            0.0..1.5,
            0.0..30.0,
            0.0..800.0,
            0.0..3e6,
            (-40.0..0.0).prop_map(libm::exp)
        ];
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
