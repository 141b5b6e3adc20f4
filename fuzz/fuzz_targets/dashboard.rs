#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| franka_fuzz::dashboard(bytes));
