#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bilux_fuzz::read_scene("radiance", bytes));
