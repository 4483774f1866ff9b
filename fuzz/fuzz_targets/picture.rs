#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| nullray_fuzz::run("picture", data));
