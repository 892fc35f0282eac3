//! The cases of a property: new ones in each run, and the same ones again on request.

use std::hash::{BuildHasher, RandomState};

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;

/// As many cases as `PROPTEST_CASES` says, or `usual`, from the seed in `PROPTEST_RNG_SEED`, or a new one. The seed is told
/// where a case fails (the output of tests that pass is hidden), and repeats the run.
pub fn cases(usual: u32) -> ProptestConfig {
    // Nothing is written into the folder of the tests.
    let mut config = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = usual;
    }
    let seed = match config.rng_seed {
        RngSeed::Fixed(seed) => seed,
        RngSeed::Random => RandomState::new().hash_one("seed"),
    };
    config.rng_seed = RngSeed::Fixed(seed);
    println!("the same cases again: PROPTEST_RNG_SEED={seed} PROPTEST_CASES={}", config.cases);
    config
}
