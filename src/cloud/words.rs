//! Lines and words of text formats, on bytes: a file of points may be gigabytes, and need not be UTF-8 in its comments.

/// Lines with their numbers from 1, without their ends; LF, CR and CRLF each end one.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0 }
    }

    /// What comes behind the lines that were taken.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Lines taken so far.
    pub fn number(&self) -> usize {
        self.number
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = memchr::memchr2(b'\n', b'\r', self.rest);
        let (line, behind) = match end {
            None => (self.rest, &[][..]),
            Some(at) if self.rest[at] == b'\r' && self.rest.get(at + 1) == Some(&b'\n') => {
                (&self.rest[..at], &self.rest[at + 2..])
            }
            Some(at) => (&self.rest[..at], &self.rest[at + 1..]),
        };
        self.rest = behind;
        Some((self.number, line))
    }
}

/// Words between blanks.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A number as Rust and C write it; `1.5D3` too.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| text.replace(['d', 'D'], "e").parse().ok())
}

/// Words for a message.
pub(super) fn shown(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(SHOWN)]).into_owned();
    if bytes.len() > SHOWN { text + "…" } else { text }
}

/// Bytes of a word that a message quotes.
const SHOWN: usize = 60;
