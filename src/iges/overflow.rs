//! A cheap look for numbers that no finite one of 64 bits holds, with Fortran's exponents too.
//!
//! Decides nothing: whoever reads the records finds out what the text is.

use memchr::memchr2_iter;

/// Digits of an exponent from which a number may overflow: the greatest finite one has three.
const EXPONENT_DIGITS: usize = 3;

/// Whether a number beyond the finite ones may stand in the bytes. Texts and card numbers count as well.
#[must_use]
pub fn may_overflow(bytes: &[u8]) -> bool {
    crate::number::may_overflow(bytes) || memchr2_iter(b'D', b'd', bytes).any(|at| large_exponent(bytes, at))
}

/// Whether a `D` behind a digit or a point has a long exponent that is not negative.
fn large_exponent(bytes: &[u8], at: usize) -> bool {
    let before = at.checked_sub(1).and_then(|at| bytes.get(at));
    if !before.is_some_and(|byte| byte.is_ascii_digit() || *byte == b'.') {
        return false;
    }
    let digits = bytes.get(at + 1..).unwrap_or_default();
    let digits = digits.strip_prefix(b"+").unwrap_or(digits);
    digits.iter().take(EXPONENT_DIGITS).filter(|byte| byte.is_ascii_digit()).count() == EXPONENT_DIGITS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_of_both_letters_are_suspected() {
        for text in ["1.D400,", "2D+309;", "1.E999"] {
            assert!(may_overflow(text.as_bytes()), "{text}");
        }
        for text in ["1.D-400", "1.D30", "D400", "00000000D      1"] {
            assert!(!may_overflow(text.as_bytes()), "{text}");
        }
    }
}
