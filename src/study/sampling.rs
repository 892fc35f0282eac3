//! A seed and a number of samples → a Latin hypercube.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

/// Points in the unit cube such that in each direction each of as many equal strata holds exactly one (M. D. McKay,
/// R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239–245), at a random place in it.
///
/// The same seed gives the same points on every machine: ChaCha with 8 rounds, a stream of numbers for each direction.
#[derive(Clone, Debug)]
pub struct LatinHypercube {
    seed: u64,
    /// Strata by sample, for each direction: four bytes a sample.
    strata: Vec<Vec<u32>>,
}

impl LatinHypercube {
    /// So many points in so many directions.
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
        let place = (random.next_u64() >> 11) as f64 * (0.5 * f64::EPSILON);
        let count = strata.len() as f64;
        ((f64::from(strata[sample as usize]) + place) / count).min(1.0 - 0.5 * f64::EPSILON)
    }
}

/// The numbers from 0 to below `count` in an order that follows from the seed and the stream's number.
pub(super) fn shuffled(count: u32, seed: u64, number: u64) -> Vec<u32> {
    let mut random = stream(seed, number);
    let mut order: Vec<u32> = (0..count).collect();
    // Fisher and Yates; the remainder of 64 bits favours no place by more than 2⁻³².
    for i in (1..order.len()).rev() {
        order.swap(i, (random.next_u64() % (i as u64 + 1)) as usize);
    }
    order
}

fn stream(seed: u64, number: u64) -> ChaCha8Rng {
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

    /// Directions are independent: the correlation of 1000 pairs has a standard deviation of 0.032.
    #[test]
    fn directions_do_not_follow_each_other() {
        let cube = LatinHypercube::new(1000, 4, 1);
        for (a, b) in [(0, 1), (0, 2), (1, 3), (2, 3)] {
            let pairs = (0..1000).map(|i| (cube.coordinate(i, a) - 0.5) * (cube.coordinate(i, b) - 0.5));
            let correlation = 12.0 * pairs.sum::<f64>() / 1000.0;
            assert!(correlation.abs() < 0.13, "{a}, {b}: {correlation}");
        }
    }

    #[test]
    fn the_seed_decides() {
        let of = |seed| (0..10).map(|i| LatinHypercube::new(10, 1, seed).coordinate(i, 0)).collect::<Vec<_>>();
        assert_eq!(of(3), of(3));
        assert_ne!(of(3), of(4));
    }
}
