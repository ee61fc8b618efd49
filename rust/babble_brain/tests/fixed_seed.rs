//! Property tests of all crates draw the same values in each run.

use proptest::test_runner::{Config, RngSeed};

/// `.cargo/config.toml` sets it for every folder of the workspace, and `make fuzz` another one.
#[test]
fn property_tests_have_a_seed() {
    assert_ne!(Config::default().rng_seed, RngSeed::Random);
}
