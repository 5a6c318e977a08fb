//! Laws that hold for any input, checked on random ones.

mod p21;
mod patch;
