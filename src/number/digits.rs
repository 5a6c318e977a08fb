//! Runs of decimal digits, eight at a time: where they end and what number they are.

/// Reads the digits from `at` on: their value, `None` when it exceeds 64 bits or there are none, and their end.
#[inline]
#[must_use]
pub fn number_at(bytes: &[u8], at: usize) -> (Option<u64>, usize) {
    /// Digits that always fit.
    const SAFE_DIGITS: usize = 19;
    let mut value = 0;
    let end = digits_at(bytes, at, &mut value);
    match end - at {
        0 => (None, end),
        1..=SAFE_DIGITS => (Some(value), end),
        _ => (checked_number(&bytes[at..end]), end),
    }
}

fn checked_number(digits: &[u8]) -> Option<u64> {
    digits.iter().try_fold(0_u64, |value, digit| value.checked_mul(10)?.checked_add(u64::from(digit - b'0')))
}

/// Eight digits `0`, as [`leading_digits`] takes them.
const DIGIT_ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);

/// How many of eight bytes, the first in the lowest place, are digits before the first that is none.
#[inline]
fn leading_digits(word: u64) -> usize {
    const HIGH: u64 = 0xf0f0_f0f0_f0f0_f0f0;
    const SIXES: u64 = 0x0606_0606_0606_0606;
    // A digit has the high half 3, and keeps it when 6 is added. A carry out of a byte disturbs only bytes
    // behind it, and that byte is no digit itself.
    let others = ((word & HIGH) ^ DIGIT_ZEROS) | ((word.wrapping_add(SIXES) & HIGH) ^ DIGIT_ZEROS);
    (others.trailing_zeros() / 8) as usize
}

/// The eight bytes from `at` on, the first in the lowest place; zeros behind the end.
#[inline]
fn word_at(bytes: &[u8], at: usize) -> u64 {
    match bytes.get(at..).and_then(|rest| rest.first_chunk()) {
        Some(chunk) => u64::from_le_bytes(*chunk),
        None => last_word(bytes, at),
    }
}

/// Like [`word_at`], for less than eight bytes from `at` on.
#[inline(never)]
fn last_word(bytes: &[u8], at: usize) -> u64 {
    match bytes.last_chunk() {
        // The last eight bytes, less those before `at`.
        Some(chunk) if at < bytes.len() => u64::from_le_bytes(*chunk) >> (8 * (at + 8 - bytes.len())),
        _ => bytes.iter().skip(at).rev().fold(0, |word, &byte| word << 8 | u64::from(byte)),
    }
}

/// End of the decimal digits from `at` on. Coordinates have many, so eight are looked at together.
#[inline]
#[must_use]
pub fn digits_end(bytes: &[u8], mut at: usize) -> usize {
    loop {
        let found = leading_digits(word_at(bytes, at));
        if found < 8 {
            return at + found;
        }
        // Not by `found`: the next word can be looked at before this one is counted.
        at += 8;
    }
}

/// Appends the digits from `at` on to a number, which wraps around beyond 64 bits; gives their end.
#[inline]
pub(super) fn digits_at(bytes: &[u8], mut at: usize, number: &mut u64) -> usize {
    const SCALE: [u64; 8] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000];
    loop {
        let word = word_at(bytes, at);
        let found = leading_digits(word);
        if found == 0 {
            return at;
        }
        if found < 8 {
            // What is no digit is shifted out, and zeros come in before the first digit.
            let digits = (word ^ DIGIT_ZEROS) << (64 - 8 * found);
            *number = number.wrapping_mul(SCALE[found]).wrapping_add(eight_digits(digits));
            return at + found;
        }
        *number = number.wrapping_mul(100_000_000).wrapping_add(eight_digits(word ^ DIGIT_ZEROS));
        at += 8;
    }
}

/// The number of eight digits 0 to 9, the first in the lowest byte: neighbours are joined
/// three times, the left one times its power of ten moved onto the right one.
#[inline]
fn eight_digits(digits: u64) -> u64 {
    let pairs = digits.wrapping_mul(1 + (10 << 8)) >> 8;
    let fours = (pairs & 0x00ff_00ff_00ff_00ff).wrapping_mul(1 + (100 << 16)) >> 16;
    (fours & 0x0000_ffff_0000_ffff).wrapping_mul(1 + (10_000 << 32)) >> 32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_digits_end_at_the_first_other_byte() {
        for length in 0..20 {
            for other in 0..=255_u8 {
                let mut bytes = b"01234567890123456789"[..length].to_vec();
                bytes.push(other);
                bytes.extend_from_slice(b"7777777777");
                let expected = if other.is_ascii_digit() { bytes.len() } else { length };
                assert_eq!(digits_end(&bytes, 0), expected, "{other} behind {length} digits");
            }
        }
    }
}
