//! A cheap look for reals that no finite number of 64 bits holds.
//!
//! Decides nothing: whoever reads the records finds out what the text is. It only tells the many files in
//! which no such real can stand from the few in which one may.

/// Digits of an exponent from which a real may overflow: the greatest finite one has three.
const EXPONENT_DIGITS: usize = 3;

/// Digits in a row from which a number without exponent may overflow.
const PLAIN_DIGITS: usize = 308;

/// Places looked at together: a count that compilers turn into vector instructions.
const LANES: usize = 64;

/// Whether a real beyond the finite ones may stand in the bytes. Texts and comments count as well.
#[must_use]
pub fn may_overflow(bytes: &[u8]) -> bool {
    let mut at = 0;
    while let Some(window) = bytes.get(at..).and_then(|rest| rest.first_chunk::<{ LANES + 2 }>()) {
        if any_exponent(window) && exponents_in(bytes, at, at + LANES) {
            return true;
        }
        at += LANES;
    }
    exponents_in(bytes, at, bytes.len()) || many_digits(bytes)
}

/// Whether an `E` that stands behind a digit or a point, and before something else than a minus, is in the window,
/// its first and last byte left out. No branches, so that it goes on many bytes at a time.
fn any_exponent(window: &[u8; LANES + 2]) -> bool {
    let mut any = false;
    for lane in 0..LANES {
        let [before, here, behind] = [window[lane], window[lane + 1], window[lane + 2]];
        let in_number = (before.wrapping_sub(b'0') <= 9) | (before == b'.');
        any |= in_number & (here | 0x20 == b'e') & (behind != b'-');
    }
    any
}

/// Whether a large exponent stands behind one of the bytes from `from` to before `to`.
fn exponents_in(bytes: &[u8], from: usize, to: usize) -> bool {
    (from + 1..(to + 1).min(bytes.len())).any(|at| bytes[at] | 0x20 == b'e' && large_exponent(bytes, at))
}

/// Whether the exponent behind an `E` that stands behind a digit or a point is not negative and long.
fn large_exponent(bytes: &[u8], at: usize) -> bool {
    let behind_number = bytes[at - 1] == b'.' || bytes[at - 1].is_ascii_digit();
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
    fn an_exponent_is_found_wherever_it_stands() {
        for place in 1..300 {
            let mut bytes = vec![b' '; 300];
            bytes.splice(place..place, *b"1.E+400");
            assert!(may_overflow(&bytes), "at {place}");
        }
    }

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
