//! Strings: ISO 10303-21 text to Unicode and back.
//!
//! Decoding never fails: what the standard does not allow is kept as it stands and the result says that it
//! was not clean. Nothing is decoded before somebody asks; untouched strings keep their bytes.

use std::borrow::Cow;

/// A decoded string.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Decoded<'a> {
    /// The text.
    pub text: Cow<'a, str>,
    /// Raw bytes that are not UTF-8 were read as ISO 8859-1, or a directive could not be read.
    pub lossy: bool,
}

/// Text of a string token, with or without its quotes.
#[must_use]
pub fn decode(token: &[u8]) -> Decoded<'_> {
    let inside = token.strip_prefix(b"'").unwrap_or(token);
    let inside = inside.strip_suffix(b"'").unwrap_or(inside);
    if inside.iter().all(|byte| matches!(byte, b' '..=b'~') && !matches!(byte, b'\'' | b'\\')) {
        let text = std::str::from_utf8(inside).expect("printable ASCII is UTF-8");
        return Decoded { text: Cow::Borrowed(text), lossy: false };
    }
    Decoder { rest: inside, text: String::with_capacity(inside.len()), lossy: false, alphabet: 1 }.run()
}

struct Decoder<'a> {
    rest: &'a [u8],
    text: String,
    lossy: bool,
    /// Part of ISO 8859 that `\S\` means.
    alphabet: u8,
}

impl<'a> Decoder<'a> {
    fn run(mut self) -> Decoded<'a> {
        let utf8 = std::str::from_utf8(self.rest).is_ok();
        while let Some(&byte) = self.rest.first() {
            match byte {
                // Only doubled quotes occur inside a token.
                b'\'' => {
                    self.text.push('\'');
                    self.advance(if self.rest.get(1) == Some(&b'\'') { 2 } else { 1 });
                }
                b'\\' => self.directive(),
                // A record may be broken over lines anywhere; the break is no part of the text.
                b'\r' | b'\n' => self.advance(1),
                _ => self.plain(utf8),
            }
        }
        Decoded { text: Cow::Owned(self.text), lossy: self.lossy }
    }

    fn advance(&mut self, count: usize) {
        self.rest = self.rest.get(count..).unwrap_or_default();
    }

    /// A run without quotes, directives and line ends.
    fn plain(&mut self, utf8: bool) {
        let special = |byte: &u8| matches!(byte, b'\'' | b'\\' | b'\r' | b'\n');
        let len = self.rest.iter().position(special).unwrap_or(self.rest.len());
        let run = &self.rest[..len];
        match std::str::from_utf8(run) {
            Ok(run) if utf8 => self.text.push_str(run),
            _ => {
                self.lossy |= !run.is_ascii();
                self.text.extend(run.iter().map(|&byte| char::from(byte)));
            }
        }
        self.advance(len);
    }

    /// One directive (ISO 10303-21:2016 clause 6.4.3); an unknown one stays as it is written.
    fn directive(&mut self) {
        let rest = self.rest;
        match rest {
            [b'\\', b'\\', ..] => {
                self.text.push('\\');
                self.advance(2);
            }
            [b'\\', b'S', b'\\', c @ b' '..=b'~', ..] => {
                let character = super::alphabet::character(self.alphabet, c - b' ');
                self.push_or_replace(character);
                self.advance(4);
            }
            [b'\\', b'P', page @ b'A'..=b'I', b'\\', ..] => {
                self.alphabet = page - b'A' + 1;
                self.advance(4);
            }
            [b'\\', b'X', b'\\', high, low, ..] if high.is_ascii_hexdigit() && low.is_ascii_hexdigit() => {
                let character = hexadecimal(&rest[3..5]).and_then(char::from_u32);
                self.push_or_replace(character);
                self.advance(5);
            }
            [b'\\', b'X', b'2', b'\\', ..] => self.extended(Width::Two),
            [b'\\', b'X', b'4', b'\\', ..] => self.extended(Width::Four),
            _ => self.keep_backslash(),
        }
    }

    fn keep_backslash(&mut self) {
        self.lossy = true;
        self.text.push('\\');
        self.advance(1);
    }

    fn push_or_replace(&mut self, character: Option<char>) {
        self.lossy |= character.is_none();
        self.text.push(character.unwrap_or(char::REPLACEMENT_CHARACTER));
    }

    /// `\X2\…\X0\` or `\X4\…\X0\`. Line breaks between the digits are skipped; a missing end is tolerated.
    fn extended(&mut self, width: Width) {
        let body = &self.rest[4..];
        let end = body.iter().position(|byte| !byte.is_ascii_hexdigit() && !matches!(byte, b'\r' | b'\n'));
        let end = end.unwrap_or(body.len());
        let digits: Vec<u8> = body[..end].iter().copied().filter(u8::is_ascii_hexdigit).collect();
        if digits.is_empty() {
            return self.keep_backslash();
        }
        let size = match width {
            Width::Two => 4,
            Width::Four => 8,
        };
        let units: Vec<u32> = digits.chunks(size).filter_map(hexadecimal).collect();
        self.lossy |= !digits.len().is_multiple_of(size) || !body[end..].starts_with(b"\\X0\\");
        match width {
            // Some writers put surrogate pairs here, though the standard means UCS-2.
            Width::Two => {
                let units = units.into_iter().filter_map(|unit| u16::try_from(unit).ok());
                for character in char::decode_utf16(units) {
                    self.push_or_replace(character.ok());
                }
            }
            Width::Four => units.into_iter().for_each(|unit| self.push_or_replace(char::from_u32(unit))),
        }
        let closing = if body[end..].starts_with(b"\\X0\\") { 4 } else { 0 };
        self.advance(4 + end + closing);
    }
}

/// Digits of one character in an extended directive.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Width {
    Two,
    Four,
}

fn hexadecimal(digits: &[u8]) -> Option<u32> {
    u32::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
}

/// A string token, quotes included, in the printable ASCII that every edition allows: `''`, `\\`, and `\X2\` or
/// `\X4\` for everything else. [`decode`] gives the text back.
#[must_use]
pub fn encode(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('\'');
    let mut open: Option<Width> = None;
    for character in text.chars() {
        let wanted = match character {
            ' '..='~' => None,
            '\u{10000}'.. => Some(Width::Four),
            _ => Some(Width::Two),
        };
        if open != wanted {
            if open.is_some() {
                out.push_str("\\X0\\");
            }
            out.push_str(match wanted {
                Some(Width::Two) => "\\X2\\",
                Some(Width::Four) => "\\X4\\",
                None => "",
            });
            open = wanted;
        }
        match (wanted, character) {
            (Some(Width::Two), _) => out.push_str(&format!("{:04X}", character as u32)),
            (Some(Width::Four), _) => out.push_str(&format!("{:08X}", character as u32)),
            (None, '\'') => out.push_str("''"),
            (None, '\\') => out.push_str("\\\\"),
            (None, _) => out.push(character),
        }
    }
    if open.is_some() {
        out.push_str("\\X0\\");
    }
    out.push('\'');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(token: &[u8], text: &str, lossy: bool) {
        let decoded = decode(token);
        assert_eq!((&*decoded.text, decoded.lossy), (text, lossy), "{}", String::from_utf8_lossy(token));
    }

    #[test]
    fn directives_decode_as_the_standard_says() {
        check(b"''", "", false);
        check(b"'plain'", "plain", false);
        check(b"'it''s'", "it's", false);
        check(b"'a\\\\b'", "a\\b", false);
        // ISO 10303-21 clause 6.4.3.2: \S\D is the character D + 128, Ä in ISO 8859-1.
        check(b"'\\S\\Drger'", "\u{c4}rger", false);
        check(b"'\\PE\\\\S\\2'", "\u{412}", false);
        check(b"'\\PG\\\\S\\A'", "\u{391}", false);
        check(b"'\\PF\\\\S\\G'", "\u{627}", false);
        check(b"'\\PH\\\\S\\`'", "\u{5d0}", false);
        check(b"'\\X\\D8'", "\u{d8}", false);
        check(b"'\\X2\\03C003C1\\X0\\!'", "\u{3c0}\u{3c1}!", false);
        check(b"'\\X4\\0001F600\\X0\\'", "\u{1f600}", false);
        check(b"'two\r\nlines'", "twolines", false);
    }

    #[test]
    fn what_the_standard_does_not_allow_is_kept() {
        check("'\u{e9}\u{3c0}'".as_bytes(), "\u{e9}\u{3c0}", false);
        check(b"'caf\xe9'", "caf\u{e9}", true);
        check(b"'C:\\temp'", "C:\\temp", true);
        check(b"'\\X2\\zz'", "\\X2\\zz", true);
        check(b"'\\X2\\03C0'", "\u{3c0}", true);
        check(b"'\\X2\\D83DDE00\\X0\\'", "\u{1f600}", false);
        check(b"'\\X4\\FFFFFFFF\\X0\\'", "\u{fffd}", true);
    }

    #[test]
    fn text_is_encoded_in_printable_ascii() {
        assert_eq!(encode("it's a \\"), "'it''s a \\\\'");
        assert_eq!(encode("\u{3c0}r\u{b2}"), "'\\X2\\03C0\\X0\\r\\X2\\00B2\\X0\\'");
        assert_eq!(encode("\u{1f600}\u{e9}"), "'\\X4\\0001F600\\X0\\\\X2\\00E9\\X0\\'");
        assert_eq!(encode("a\nb"), "'a\\X2\\000A\\X0\\b'");
    }
}
