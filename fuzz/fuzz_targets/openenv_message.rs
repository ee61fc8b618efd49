#![no_main]

#[path = "../src/openenv_messages.rs"]
mod openenv_messages;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    openenv_messages::message(data);
});
