#![no_main]

include!("../bodies/p21_edit_locality.rs");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| p21_edit_locality(bytes));
