//! Several numbers side by side → the same operations on each, in the same order, by the processor's vectors.
//!
//! Sums, differences, products, quotients and square roots of vectors are rounded as those of single numbers are, and none is
//! fused with another; so each lane has the bits that the same operations give on `f64`.

mod directions;
#[cfg(any(not(target_arch = "x86_64"), test))]
mod portable;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod x86;

use std::ops::{Add, Div, Mul, Neg, Sub};

#[cfg(not(target_arch = "x86_64"))]
use portable as processor;
#[cfg(target_arch = "x86_64")]
use x86 as processor;

pub use directions::{DIRECTIONS, DirectionsTask, Number, Packed};

/// Maximum number of lanes of a vector.
pub const MAX_LANES: usize = 8;

/// One number per lane; numbers beyond a vector's lanes are not read.
pub type Array = [f64; MAX_LANES];

/// Four numbers of one lane.
pub type Four = [f64; 4];

/// A processor's vector of `f64`.
pub trait Simd: Copy + 'static {
    /// Number of lanes, at most [`MAX_LANES`].
    const LANES: usize;
    /// A Boolean per lane.
    type Mask: Copy;

    /// A vector of the first [`Simd::LANES`] numbers.
    fn load(numbers: &Array) -> Self;
    /// Transposes rows, four numbers of each lane, into four vectors. Rows beyond the lanes are not read.
    #[inline(always)]
    fn columns(rows: [&Four; MAX_LANES]) -> [Self; 4] {
        let mut columns = [[0.0; MAX_LANES]; 4];
        for lane in 0..Self::LANES {
            for i in 0..4 {
                columns[i][lane] = rows[lane][i];
            }
        }
        [Self::load(&columns[0]), Self::load(&columns[1]), Self::load(&columns[2]), Self::load(&columns[3])]
    }
    /// The numbers of the lanes, then zeros.
    fn store(self) -> Array;
    /// Fills all lanes with a number.
    fn splat(number: f64) -> Self;
    /// Sum in each lane.
    fn add(self, other: Self) -> Self;
    /// Difference in each lane.
    fn sub(self, other: Self) -> Self;
    /// Product in each lane.
    fn mul(self, other: Self) -> Self;
    /// Quotient in each lane.
    fn div(self, other: Self) -> Self;
    /// Square root in each lane.
    fn sqrt(self) -> Self;
    /// Opposite number in each lane.
    fn neg(self) -> Self;
    /// Absolute value in each lane.
    fn abs(self) -> Self;
    /// Powers of two with these exponents, whole numbers from −1022 to 1023. Otherwise the result is unspecified.
    fn power_of_two(self) -> Self;
    /// The lanes in which `self` is less than `other`.
    fn less(self, other: Self) -> Self::Mask;
    /// `self` where `mask` is true, `other` elsewhere.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// Logical and.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Logical or.
    fn either(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Logical and of `a` and not `b`.
    fn except(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// A bit per lane, the first lane in the least significant one.
    fn bits(mask: Self::Mask) -> u32;
}

/// A computation, generic over the vector type.
pub trait Task {
    /// Its result.
    type Output;

    /// Runs the task. It and all functions that it calls must be inlined: only the body of the function that [`VectorWidth::run`] enters
    /// is compiled for the processor's vectors.
    fn run<V: Simd>(self) -> Self::Output;
}

/// Runs a task with vectors of four numbers on x86-64, or returns `None` without AVX2. Other processors take arrays, which their compilers
/// vectorize. The results have the same bits.
#[inline(always)]
pub fn with_directions<T: DirectionsTask>(task: T) -> Option<T::Output> {
    #[cfg(target_arch = "x86_64")]
    return x86::with_directions(task);
    #[cfg(not(target_arch = "x86_64"))]
    Some(task.run::<[f64; DIRECTIONS]>())
}

/// A vector width that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VectorWidth(processor::Vectors);

impl VectorWidth {
    /// Returns the widest vectors of at most this many lanes, or `None` for one lane.
    pub fn at_most(lanes: usize) -> Option<VectorWidth> {
        processor::Vectors::at_most(lanes).map(VectorWidth)
    }

    /// Returns the processor's widest vectors, or `None` if they have a single lane.
    pub fn widest() -> Option<VectorWidth> {
        VectorWidth::at_most(MAX_LANES)
    }

    /// Returns the number of lanes.
    pub fn lanes(self) -> usize {
        self.0.lanes()
    }

    /// Runs a task with these vectors.
    pub fn run<T: Task>(self, task: T) -> T::Output {
        self.0.run(task)
    }
}

/// Added to an integer n, leaves the biased exponent of 2ⁿ in the low bits.
const TO_EXPONENT: f64 = 1.0 / f64::EPSILON + 1023.0;

/// Number of bits of the mantissa, below the exponent.
const BELOW_EXPONENT: i32 = 52;

/// A number in each lane.
#[derive(Clone, Copy)]
pub struct Wide<V>(V);

/// A Boolean per lane.
#[derive(Clone, Copy)]
pub struct Lanes<V: Simd>(V::Mask);

impl<V: Simd> Wide<V> {
    /// A vector of `number(lane)` for each lane.
    #[inline(always)]
    pub fn each(mut number: impl FnMut(usize) -> f64) -> Wide<V> {
        let mut numbers = [0.0; MAX_LANES];
        for (lane, slot) in numbers.iter_mut().enumerate().take(V::LANES) {
            *slot = number(lane);
        }
        Wide(V::load(&numbers))
    }

    /// A vector of the first numbers, one per lane.
    #[inline(always)]
    pub fn load(numbers: &Array) -> Wide<V> {
        Wide(V::load(numbers))
    }

    /// Powers of two with these exponents, whole numbers from −1022 to 1023. Otherwise the result is unspecified.
    #[inline(always)]
    fn power_of_two(self) -> Wide<V> {
        Wide(self.0.power_of_two())
    }

    /// Transposes rows, four numbers of each lane, into four vectors. It is many times faster than number by number.
    #[inline(always)]
    pub fn columns(rows: [&Four; MAX_LANES]) -> [Wide<V>; 4] {
        let [a, b, c, d] = V::columns(rows);
        [Wide(a), Wide(b), Wide(c), Wide(d)]
    }

    /// The numbers of the lanes, then zeros.
    #[inline(always)]
    pub fn store(self) -> Array {
        self.0.store()
    }

    /// The number of one lane.
    #[inline(always)]
    pub fn of_lane(self, lane: usize) -> f64 {
        self.0.store()[lane]
    }
}

impl<V: Simd> Lanes<V> {
    /// A bit per lane, the first lane in the least significant one.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        V::bits(self.0)
    }

    /// Whether all lanes are set.
    #[inline(always)]
    pub fn all(self) -> bool {
        self.bits() == (1 << V::LANES) - 1
    }
}

impl<V: Simd> From<f64> for Wide<V> {
    #[inline(always)]
    fn from(number: f64) -> Wide<V> {
        Wide(V::splat(number))
    }
}

impl<V: Simd> Default for Wide<V> {
    #[inline(always)]
    fn default() -> Wide<V> {
        Wide(V::splat(0.0))
    }
}

impl<V: Simd> Neg for Wide<V> {
    type Output = Wide<V>;

    #[inline(always)]
    fn neg(self) -> Wide<V> {
        Wide(self.0.neg())
    }
}

/// An operator between vectors, and between a vector and a number.
macro_rules! operator {
    ($trait:ident, $operate:ident) => {
        impl<V: Simd> $trait for Wide<V> {
            type Output = Wide<V>;

            #[inline(always)]
            fn $operate(self, other: Wide<V>) -> Wide<V> {
                Wide(self.0.$operate(other.0))
            }
        }

        impl<V: Simd> $trait<f64> for Wide<V> {
            type Output = Wide<V>;

            #[inline(always)]
            fn $operate(self, other: f64) -> Wide<V> {
                Wide(self.0.$operate(V::splat(other)))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

#[cfg(test)]
mod tests {
    use super::*;

    const NUMBERS: [Array; 2] = [
        [1.5, -0.0, 3e200, -7.25, 1e-310, f64::INFINITY, 0.1, 2.0],
        [0.3, 0.0, 4e200, -7.25, 2.0, 5.0, f64::NAN, -1e-3],
    ];

    const ROWS: [Four; MAX_LANES] = [
        [0.0, 0.1, 0.2, 0.3],
        [1.0, 1.1, 1.2, 1.3],
        [2.0, 2.1, 2.2, 2.3],
        [3.0, 3.1, 3.2, 3.3],
        [4.0, 4.1, 4.2, 4.3],
        [5.0, 5.1, 5.2, 5.3],
        [6.0, 6.1, 6.2, 6.3],
        [7.0, 7.1, 7.2, 7.3],
    ];

    const EXPONENTS: Array = [-1022.0, 1023.0, 0.0, -0.0, 1.0, -1.0, 52.0, -500.0];

    /// All operations of a vector with two others.
    struct Operations;

    impl Task for Operations {
        type Output = (Vec<Array>, Vec<u32>);

        fn run<V: Simd>(self) -> (Vec<Array>, Vec<u32>) {
            let [a, b] = NUMBERS.map(|numbers| V::load(&numbers));
            let (less, small) = (a.less(b), b.less(V::splat(1.0)));
            let picked = a.select(less, b);
            let powers = V::load(&EXPONENTS).power_of_two();
            let [first, second, third, fourth] = V::columns(ROWS.each_ref());
            let made = [
                first,
                second,
                third,
                fourth,
                a.add(b),
                a.sub(b),
                a.mul(b),
                a.div(b),
                a.abs().sqrt(),
                a.neg(),
                a.abs(),
                powers,
                picked,
                V::splat(0.7),
            ];
            let masks = [less, small, V::both(less, small), V::either(less, small), V::except(less, small)];
            (made.map(V::store).to_vec(), masks.map(V::bits).to_vec())
        }
    }

    /// Bits of the numbers, except that a NaN is like any other.
    fn bits(arrays: &[Array]) -> Vec<[u64; MAX_LANES]> {
        arrays.iter().map(|array| array.map(|x| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() })).collect()
    }

    fn check(lanes: usize, (made, masks): (Vec<Array>, Vec<u32>)) {
        let [a, b] = NUMBERS;
        let each = |number: &dyn Fn(usize) -> f64| {
            let mut array = [0.0; MAX_LANES];
            array.iter_mut().enumerate().take(lanes).for_each(|(i, place)| *place = number(i));
            array
        };
        let expected = [
            each(&|i| ROWS[i][0]),
            each(&|i| ROWS[i][1]),
            each(&|i| ROWS[i][2]),
            each(&|i| ROWS[i][3]),
            each(&|i| a[i] + b[i]),
            each(&|i| a[i] - b[i]),
            each(&|i| a[i] * b[i]),
            each(&|i| a[i] / b[i]),
            each(&|i| a[i].abs().sqrt()),
            each(&|i| -a[i]),
            each(&|i| a[i].abs()),
            each(&|i| EXPONENTS[i].exp2()),
            each(&|i| if a[i] < b[i] { a[i] } else { b[i] }),
            each(&|_| 0.7),
        ];
        assert_eq!(bits(&made), bits(&expected), "{lanes} lanes");
        let mask = |is: &dyn Fn(usize) -> bool| (0..lanes).map(|i| u32::from(is(i)) << i).sum::<u32>();
        let (less, small) = (|i: usize| a[i] < b[i], |i: usize| b[i] < 1.0);
        let expected = [
            mask(&less),
            mask(&small),
            mask(&|i| less(i) && small(i)),
            mask(&|i| less(i) || small(i)),
            mask(&|i| less(i) && !small(i)),
        ];
        assert_eq!(masks, expected, "{lanes} lanes");
    }

    /// Tests all vectors that this processor has, and the portable pairs.
    #[test]
    fn vectors_do_what_single_numbers_do() {
        for width in [2, 4, 8].into_iter().filter_map(VectorWidth::at_most) {
            check(width.lanes(), width.run(Operations));
        }
        assert_eq!(portable::Vectors::at_most(1), None);
        let pairs = portable::Vectors::at_most(3).expect("pairs");
        assert_eq!(pairs.lanes(), 2);
        check(2, pairs.run(Operations));
    }
}
