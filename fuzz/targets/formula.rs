#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lieflow_fuzz::scene::formula(data));
