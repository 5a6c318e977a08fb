//! Numbers as the formats spell them: text to value, and value to the shortest text that reads back to the same
//! bits.
//!
//! [`format_real`] is the one function of the project that writes a real: its text is legal in
//! ISO 10303-21 (a point is required, the exponent is an upper-case `E`) and in IGES. Knows nothing of what stands
//! around a number.

mod decimal;
mod digits;
mod overflow;

pub use decimal::real_at;
pub use digits::{digits_end, number_at};
pub use overflow::may_overflow;

/// Value of a number in the spelling of ISO 10303-21, or with the liberties that real files take.
/// `None` when the text is no number or its value is not finite.
#[must_use]
pub fn parse_real(text: &[u8]) -> Option<f64> {
    if let Some((value, end)) = decimal::real_at(text, 0)
        && end == text.len()
    {
        return Some(value);
    }
    // The number parser of the standard library also takes `inf` and `nan`, in which no digit occurs.
    let text = std::str::from_utf8(text).ok()?;
    let first = text.bytes().find(|byte| !matches!(byte, b'+' | b'-' | b'.'))?;
    if !first.is_ascii_digit() {
        return None;
    }
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Value of an integer; `None` beyond 64 bits.
#[must_use]
pub fn parse_integer(text: &[u8]) -> Option<i64> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

/// Shortest text that reads back to the same bits, with a point and an upper-case exponent: `1.`, `-0.5`, `1.E-7`.
///
/// # Panics
/// When the value is not finite: neither format can say it, so it must have been refused before.
#[must_use]
pub fn format_real(value: f64) -> String {
    assert!(value.is_finite(), "a value that is not finite cannot be written");
    let mut buffer = zmij::Buffer::new();
    let shortest = buffer.format_finite(value);
    let (mantissa, exponent) = match shortest.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (shortest, None),
    };
    let mut text = String::with_capacity(shortest.len() + 2);
    text.push_str(mantissa.strip_suffix(".0").unwrap_or(mantissa));
    if !text.contains('.') {
        text.push('.');
    }
    if let Some(exponent) = exponent {
        text.push('E');
        text.push_str(exponent.strip_prefix('+').unwrap_or(exponent));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_are_written_short_and_legal() {
        let check = |value: f64, text: &str| assert_eq!(format_real(value), text);
        check(0.0, "0.");
        check(-0.0, "-0.");
        check(1.0, "1.");
        check(-12.5, "-12.5");
        check(0.1, "0.1");
        check(1e-7, "1.E-7");
        check(-2.5e-9, "-2.5E-9");
        check(1e300, "1.E300");
        check(f64::MIN_POSITIVE, "2.2250738585072014E-308");
    }

    #[test]
    fn numbers_are_read_in_every_spelling_of_real_files() {
        let check = |text: &str, value: Option<f64>| assert_eq!(parse_real(text.as_bytes()), value, "{text}");
        check("1.", Some(1.0));
        check("+1.5", Some(1.5));
        check("1.0E+0", Some(1.0));
        check("-1.e-3", Some(-0.001));
        check(".5", Some(0.5));
        check("-.5", Some(-0.5));
        check("7", Some(7.0));
        check("1.E400", None);
        check("inf", None);
        check("-nan", None);
        check("", None);
        check(".", None);
        assert_eq!(parse_integer(b"-42"), Some(-42));
        assert_eq!(parse_integer(b"99999999999999999999"), None);
    }
}
