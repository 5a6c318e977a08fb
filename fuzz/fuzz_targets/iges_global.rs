#![no_main]

include!("../bodies/iges_global.rs");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| iges_global(bytes));
