#![no_main]

include!("../bodies/iges_parameters.rs");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| iges_parameters(bytes));
