#![no_main]

include!("../bodies/p21_tile.rs");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| p21_tile(bytes));
