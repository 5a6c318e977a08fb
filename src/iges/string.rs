//! Hollerith texts: `5Habcde`, counted, so that delimiters and quotes need no escape.
//!
//! The standard knows ASCII. Files have other bytes too; they are shown as UTF-8 where they are that, else as
//! ISO 8859-1, and never changed.

use std::borrow::Cow;

/// The text of counted bytes, blanks at both ends included.
#[must_use]
pub fn decode(bytes: Cow<'_, [u8]>) -> Cow<'_, str> {
    let latin = |bytes: &[u8]| bytes.iter().map(|&byte| char::from(byte)).collect::<String>();
    match bytes {
        Cow::Borrowed(bytes) => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => Cow::Owned(latin(bytes)),
        },
        Cow::Owned(bytes) => Cow::Owned(String::from_utf8(bytes).unwrap_or_else(|e| latin(e.as_bytes()))),
    }
}

/// A text with its count in bytes; nothing for the empty text, which the standard writes as a default.
#[must_use]
pub fn encode(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("{}H{text}", text.len()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counted_bytes_are_read_as_what_they_are() {
        assert_eq!(decode(Cow::Borrowed(b"a,b;c")), "a,b;c");
        assert_eq!(decode(Cow::Borrowed("ä".as_bytes())), "ä");
        assert_eq!(decode(Cow::Owned(vec![b'x', 0xe4])), "xä");
        assert_eq!([encode("a,b"), encode("ä"), encode("")], ["3Ha,b", "2Hä", ""]);
    }
}
