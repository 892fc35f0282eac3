//! A seed and a number of samples → a Latin hypercube.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

/// A Latin hypercube: n random points in the unit cube. Each of n equal strata of every direction has one.
///
/// M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239–245. The same seed gives the same points on every
/// machine: ChaCha with 8 rounds, two streams per direction.
#[derive(Clone, Debug)]
pub struct LatinHypercube {
    seed: u64,
    /// The stratum of each sample, per direction.
    strata: Vec<Vec<u32>>,
}

impl LatinHypercube {
    /// Draws the strata of the samples in each direction.
    pub fn new(samples: u32, directions: usize, seed: u64) -> LatinHypercube {
        let strata = (0..directions).map(|direction| shuffled(samples, seed, 2 * direction as u64));
        LatinHypercube { seed, strata: strata.collect() }
    }

    /// A coordinate of a point, in [0, 1).
    pub fn coordinate(&self, sample: u32, direction: usize) -> f64 {
        let strata = &self.strata[direction];
        let mut random = stream(self.seed, 2 * direction as u64 + 1);
        // A word is 32 bits.
        random.set_word_pos(2 * u128::from(sample));
        let offset = (random.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON);
        let count = strata.len() as f64;
        ((f64::from(strata[sample as usize]) + offset) / count).min(1.0 - 0.5 * f64::EPSILON)
    }
}

/// The numbers below `count` in random order, by seed and number of the stream.
pub(crate) fn shuffled(count: u32, seed: u64, number: u64) -> Vec<u32> {
    let mut random = stream(seed, number);
    let mut order: Vec<u32> = (0..count).collect();
    // Fisher–Yates shuffle; the bias of the remainder of 64 bits is below 2⁻³².
    for i in (1..order.len()).rev() {
        order.swap(i, (random.next_u64() % (i as u64 + 1)) as usize);
    }
    order
}

/// A stream of random words; those of one seed are independent of each other.
pub(crate) fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(number);
    random
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stratum_holds_one_point() {
        let cube = LatinHypercube::new(1000, 3, 7);
        for direction in 0..3 {
            let mut strata: Vec<usize> = (0..1000).map(|i| (cube.coordinate(i, direction) * 1000.0) as usize).collect();
            assert!(strata.iter().enumerate().any(|(i, stratum)| i != *stratum));
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..1000));
        }
    }

    /// The correlation of 1000 independent pairs has a standard deviation of 0.032.
    #[test]
    fn directions_are_independent() {
        let cube = LatinHypercube::new(1000, 4, 1);
        for (a, b) in [(0, 1), (0, 2), (1, 3), (2, 3)] {
            let pairs = (0..1000).map(|i| (cube.coordinate(i, a) - 0.5) * (cube.coordinate(i, b) - 0.5));
            let correlation = 12.0 * pairs.sum::<f64>() / 1000.0;
            assert!(correlation.abs() < 0.13, "{a}, {b}: {correlation}");
        }
    }

    #[test]
    fn the_seed_determines_the_points() {
        let of = |seed| (0..10).map(|i| LatinHypercube::new(10, 1, seed).coordinate(i, 0)).collect::<Vec<_>>();
        assert_eq!(of(3), of(3));
        assert_ne!(of(3), of(4));
    }
}
