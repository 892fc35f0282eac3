//! Pairs of numbers, for processors without intrinsics here: the compiler may turn them into vectors.

use crate::numerics::wide::{Array, BELOW_EXPONENT, MAX_LANES, Simd, TO_EXPONENT, Task};

/// Vectors of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vectors;

impl Vectors {
    pub fn at_most(lanes: usize) -> Option<Vectors> {
        (lanes >= Pair::LANES).then_some(Vectors)
    }

    pub fn lanes(self) -> usize {
        Pair::LANES
    }

    pub fn run<T: Task>(self, task: T) -> T::Output {
        task.run::<Pair>()
    }
}

#[derive(Clone, Copy)]
struct Pair([f64; 2]);

impl Pair {
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Pair {
        Pair([f(self.0[0]), f(self.0[1])])
    }

    #[inline(always)]
    fn with(self, other: Pair, f: impl Fn(f64, f64) -> f64) -> Pair {
        Pair([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

impl Simd for Pair {
    const LANES: usize = 2;
    type Mask = [bool; 2];

    #[inline(always)]
    fn load(numbers: &Array) -> Pair {
        Pair([numbers[0], numbers[1]])
    }

    #[inline(always)]
    fn store(self) -> Array {
        let mut numbers = [0.0; MAX_LANES];
        numbers[..2].copy_from_slice(&self.0);
        numbers
    }

    #[inline(always)]
    fn splat(number: f64) -> Pair {
        Pair([number; 2])
    }

    #[inline(always)]
    fn add(self, other: Pair) -> Pair {
        self.with(other, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, other: Pair) -> Pair {
        self.with(other, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, other: Pair) -> Pair {
        self.with(other, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, other: Pair) -> Pair {
        self.with(other, |a, b| a / b)
    }

    #[inline(always)]
    fn sqrt(self) -> Pair {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    fn neg(self) -> Pair {
        self.map(|a| -a)
    }

    #[inline(always)]
    fn abs(self) -> Pair {
        self.map(f64::abs)
    }

    #[inline(always)]
    fn power_of_two(self) -> Pair {
        self.map(|a| f64::from_bits((a + TO_EXPONENT).to_bits() << BELOW_EXPONENT))
    }

    #[inline(always)]
    fn less(self, other: Pair) -> [bool; 2] {
        [self.0[0] < other.0[0], self.0[1] < other.0[1]]
    }

    #[inline(always)]
    fn select(self, mask: [bool; 2], other: Pair) -> Pair {
        let pick = |i: usize| if mask[i] { self.0[i] } else { other.0[i] };
        Pair([pick(0), pick(1)])
    }

    #[inline(always)]
    fn both(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
        [a[0] & b[0], a[1] & b[1]]
    }

    #[inline(always)]
    fn either(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
        [a[0] | b[0], a[1] | b[1]]
    }

    #[inline(always)]
    fn except(a: [bool; 2], b: [bool; 2]) -> [bool; 2] {
        [a[0] & !b[0], a[1] & !b[1]]
    }

    #[inline(always)]
    fn bits(mask: [bool; 2]) -> u32 {
        u32::from(mask[0]) | u32::from(mask[1]) << 1
    }
}
