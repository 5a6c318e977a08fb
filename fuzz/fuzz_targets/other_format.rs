#![no_main]

include!("../bodies/other_format.rs");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| other_format(bytes));
