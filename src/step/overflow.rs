//! A cheap look for reals that no finite number of 64 bits holds.
//!
//! Decides nothing: whoever reads the records finds out what the text is. It only tells the many files in
//! which no such real can stand from the few in which one may.

/// Digits of an exponent from which a real may overflow: the greatest finite one has three.
const EXPONENT_DIGITS: usize = 3;

/// Digits in a row from which a number without exponent may overflow.
const PLAIN_DIGITS: usize = 308;

/// Whether a real beyond the finite ones may stand in the bytes. Texts and comments count as well.
#[must_use]
pub fn may_overflow(bytes: &[u8]) -> bool {
    memchr::memchr2_iter(b'E', b'e', bytes).any(|at| large_exponent(bytes, at)) || many_digits(bytes)
}

/// Whether the exponent behind an `E` that stands behind a digit or a point is not negative and long.
fn large_exponent(bytes: &[u8], at: usize) -> bool {
    let behind_number =
        at.checked_sub(1).is_some_and(|before| bytes[before] == b'.' || bytes[before].is_ascii_digit());
    let digits = bytes.get(at + 1..).unwrap_or_default();
    let digits = digits.strip_prefix(b"+").unwrap_or(digits);
    behind_number
        && digits.iter().take(EXPONENT_DIGITS).filter(|b| b.is_ascii_digit()).count() == EXPONENT_DIGITS
}

/// Whether so many digits stand in a row. A run of that length covers one of the places at multiples of it, so
/// only these are looked at.
fn many_digits(bytes: &[u8]) -> bool {
    let is_digit = |at: &usize| bytes[*at].is_ascii_digit();
    (PLAIN_DIGITS - 1..bytes.len()).step_by(PLAIN_DIGITS).filter(is_digit).any(|at| {
        let before = bytes[..at].iter().rev().take_while(|b| b.is_ascii_digit()).take(PLAIN_DIGITS).count();
        let behind = bytes[at..].iter().take_while(|b| b.is_ascii_digit()).take(PLAIN_DIGITS).count();
        before + behind >= PLAIN_DIGITS
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_long_exponents_and_long_numbers_are_suspected() {
        let digits = |count: usize| format!("#1=FOO({}.);", "1".repeat(count));
        for text in ["#1=FOO(1.E400);", "(1.e+309)", "(1E999)", &digits(309), &format!(" {}", digits(400))] {
            assert!(may_overflow(text.as_bytes()), "{text}");
        }
        for text in ["", "E", "1.E", "#1=FOO(1.E-400);", "1.E+30", "ADVANCED_FACE1234", "E400", &digits(300)]
        {
            assert!(!may_overflow(text.as_bytes()), "{text}");
        }
    }
}
