#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    babble_fuzz::reach_snapshot(data);
});
