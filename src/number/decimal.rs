//! The value of a real in one pass over its bytes, for the numbers that real files have.
//!
//! Freeform parts are mostly coordinates, and finding the end of one, checking its bytes and reading them are
//! three passes elsewhere. Numbers that are not spelled as ISO 10303-21 has it, or whose value is not certain
//! here, are left to [`parse_real`](super::parse_real).
//!
//! INVARIANT: a value that is given is the nearest one, ties to even: the same bits as the standard library's.

use super::digits::digits_at;

/// Decimal digits that 64 bits always hold.
const MAX_DIGITS: usize = 19;
/// Integers up to here are exact in an `f64`.
const MAX_EXACT: u64 = 1 << 53;
/// Powers of ten that an `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];
/// Powers of five that 63 bits hold: 5^0 to 5^27.
const FIVES: usize = 28;
/// For 5^k (k > 0) its bit length less one, b, and 2^(128 + b) / 5^k, rounded down: 128 bits.
const RECIPROCALS: [(u32, u128); FIVES] = reciprocals();

/// The real at `at` and the offset behind it: `[sign] digits . [digits] [E [sign] digits]`.
///
/// `None` for anything else, and for the few values that are not certain here.
#[inline]
#[must_use]
pub fn real_at(bytes: &[u8], at: usize) -> Option<(f64, usize)> {
    let negative = *bytes.get(at)? == b'-';
    let start = at + usize::from(negative || bytes[at] == b'+');
    let mut mantissa = 0;
    let point = digits_at(bytes, start, &mut mantissa);
    if point == start || bytes.get(point) != Some(&b'.') {
        return None;
    }
    let mut end = digits_at(bytes, point + 1, &mut mantissa);
    let n_decimals = end - point - 1;
    let n_digits = point - start + n_decimals;
    if n_digits > MAX_DIGITS && n_digits - leading_zeros(&bytes[start..end]) > MAX_DIGITS {
        return None;
    }
    let mut exponent = -i32::try_from(n_decimals).ok()?;
    if bytes.get(end) == Some(&b'E') {
        let (written, behind) = exponent_at(bytes, end + 1)?;
        exponent = exponent.checked_add(written)?;
        end = behind;
    }
    let value = value(mantissa, exponent)?;
    Some((if negative { -value } else { value }, end))
}

/// Zeros before the first other digit; a point between them is passed over.
fn leading_zeros(text: &[u8]) -> usize {
    let front = text.iter().take_while(|byte| matches!(byte, b'0' | b'.'));
    front.filter(|&&byte| byte == b'0').count()
}

fn exponent_at(bytes: &[u8], at: usize) -> Option<(i32, usize)> {
    let negative = *bytes.get(at)? == b'-';
    let start = at + usize::from(negative || bytes[at] == b'+');
    let mut number = 0;
    let end = digits_at(bytes, start, &mut number);
    // Four digits are beyond every finite value, and no text of them wraps around.
    let number = i32::try_from(number).ok().filter(|_| (1..=4).contains(&(end - start)))?;
    Some((if negative { -number } else { number }, end))
}

/// `mantissa * 10^exponent`; `None` where it is not certain.
#[inline]
fn value(mantissa: u64, exponent: i32) -> Option<f64> {
    let places = exponent.unsigned_abs() as usize;
    if mantissa <= MAX_EXACT
        && let Some(power) = POWERS.get(places)
    {
        // Both are exact, so that there is one rounding (Clinger 1990).
        let exact = mantissa as f64;
        return Some(if exponent < 0 { exact / power } else { exact * power });
    }
    if exponent >= 0 { None } else { quotient(mantissa, places) }
}

/// `mantissa / 10^places` by the reciprocal of the power; `None` within its error of a tie.
#[inline]
fn quotient(mantissa: u64, places: usize) -> Option<f64> {
    /// Bits of the quotient below the 53 that are kept.
    const BELOW: u32 = 128 - f64::MANTISSA_DIGITS;
    const HALF: u128 = 1 << (BELOW - 1);
    /// The true quotient lies less than this above the one found: reciprocal and product are each cut by less
    /// than one, and may be doubled.
    const ERROR: u128 = 4;
    let (length, reciprocal) = *RECIPROCALS.get(places)?;
    if mantissa == 0 {
        return None;
    }
    let shift = mantissa.leading_zeros();
    let normal = u128::from(mantissa << shift);
    let low = u128::from(reciprocal as u64);
    let product = normal * (reciprocal >> 64) + ((normal * low) >> 64);
    let doubled = product.leading_zeros();
    let product = product << doubled;
    let rest = product & ((1 << BELOW) - 1);
    if (HALF - ERROR..=HALF).contains(&rest) {
        return None;
    }
    let kept = (product >> BELOW) as u64 + u64::from(rest > HALF);
    // product * 2^-64, scaled by the reciprocal's 2^(128 + length), the two shifts and 2^places of the ten.
    let exponent = i64::from(BELOW + 64) - i64::from(128 + length + shift + doubled) - places as i64;
    // At least 1e-27 and below 2^53: far inside the normal range, so the scaling is exact.
    let scale = f64::from_bits(((1023 + exponent) as u64) << 52);
    Some(kept as f64 * scale)
}

const fn reciprocals() -> [(u32, u128); FIVES] {
    let mut table = [(0, 0); FIVES];
    let mut power = 1_u128;
    let mut k = 1;
    while k < FIVES {
        power *= 5;
        let length = power.ilog2();
        // Long division of 2^(128 + length), bit by bit: its head alone is below the divisor.
        let (mut rest, mut quotient, mut bit) = (1_u128 << length, 0_u128, 0);
        while bit < 128 {
            rest <<= 1;
            quotient <<= 1;
            if rest >= power {
                rest -= power;
                quotient |= 1;
            }
            bit += 1;
        }
        table[k] = (length, quotient);
        k += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Holds the value against the standard library's parser; gives whether there was one.
    fn agrees(text: &str) -> bool {
        let expected: f64 = text.parse().expect("a number");
        for tail in ["", ",", "),77777777777"] {
            let bytes = format!("{text}{tail}");
            if let Some((value, end)) = real_at(bytes.as_bytes(), 0) {
                assert_eq!((value.to_bits(), end), (expected.to_bits(), text.len()), "{text}");
            }
        }
        real_at(text.as_bytes(), 0).is_some()
    }

    #[test]
    fn usual_spellings_are_read_here() {
        for text in [
            "0.",
            "-0.",
            "1.",
            "+1.5",
            "-12.E-1",
            "1.0E+03",
            "0.25031289111389245",
            "49.0613266583229",
            "0.00012345678901234567",
            "9.00000000000001E22",
            "18446744073709551.61",
            "1.7976931348623157E-8",
        ] {
            assert!(agrees(text), "{text}");
        }
    }

    #[test]
    fn other_text_is_left_alone() {
        for text in ["", "-", ".", ".5", "7", "1e5", "+-1.", "1.E", "1.E+", "1.E99999", "inf", "nan", "E1"] {
            assert_eq!(real_at(text.as_bytes(), 0), None, "{text}");
        }
        assert_eq!(real_at(b"1.2.3", 0), Some((1.2, 3)));
        assert_eq!(real_at(b"12345678901234567890.", 0), None);
    }

    #[test]
    fn ties_and_their_neighbours_round_to_even() {
        // 2^53 + 1 lies between two values, and so does 2^54 + 2.
        for whole in [9_007_199_254_740_991_u64, 9_007_199_254_740_993, 18_014_398_509_481_986] {
            for text in
                [format!("{whole}.0"), format!("{whole}.00"), format!("{whole}.01"), format!("{whole}.")]
            {
                agrees(&text);
            }
        }
        agrees("900719925474099.25");
        agrees("4503599627370497.5");
        agrees("4503599627370496.5");
    }

    proptest! {
        #[test]
        fn values_are_those_of_the_standard_library(mantissa: u64, digits in 1..20_u32, places in 0..28_usize,
            exponent in -30..30_i32) {
            let mantissa = mantissa % 10_u64.pow(digits);
            let padded = format!("{mantissa:0>width$}", width = places + 1);
            let (whole, decimals) = padded.split_at(padded.len() - places);
            agrees(&format!("{whole}.{decimals}"));
            agrees(&format!("-{whole}.{decimals}E{exponent}"));
        }

        #[test]
        fn shortest_spellings_are_read_back(value in -1000.0..1000.0_f64) {
            let text = format!("{value:?}");
            prop_assert!(text.contains('e') || agrees(&text), "{text}");
        }
    }
}
