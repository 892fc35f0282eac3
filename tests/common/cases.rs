//! The number of random cases of a property.

use proptest::prelude::ProptestConfig;

/// Returns a configuration with `usual` cases, unless `PROPTEST_CASES` gives another number.
///
/// `.cargo/config.toml` fixes the seed, and `scripts/dev/soak` varies it. A failing case is stored in a file of proptest-regressions
/// and runs each time from then on.
pub fn cases(usual: u32) -> ProptestConfig {
    let mut config = ProptestConfig::default();
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = usual;
    }
    config
}
