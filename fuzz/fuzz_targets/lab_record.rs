#![no_main]

#[path = "../src/lab_records.rs"]
mod lab_records;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    lab_records::record(data);
});
