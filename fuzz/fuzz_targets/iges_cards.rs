#![no_main]

include!("../bodies/iges_cards.rs");

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| iges_cards(bytes));
