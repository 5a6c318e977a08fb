//! The input bytes of one file, and places in them.
//!
//! Bytes are never decoded, normalised or copied here. A file is at most 4 GiB - 1 byte, so that a
//! place fits in 32 bits: an index over a file then costs half of what it would with `usize`.

use std::sync::Arc;

use memchr::{memchr2, memchr2_iter};

/// A half-open byte range `[start, end)` of a [`Source`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Span {
    /// Offset of the first byte.
    pub start: u32,
    /// Offset behind the last byte.
    pub end: u32,
}

impl Span {
    /// The span `[start, end)`.
    #[must_use]
    pub fn new(start: u32, end: u32) -> Self {
        debug_assert!(start <= end);
        Self { start, end }
    }

    /// Number of bytes.
    #[must_use]
    pub fn len(self) -> usize {
        (self.end - self.start) as usize
    }

    /// Whether no byte is covered.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.start == self.end
    }

    /// The span as an index range.
    #[must_use]
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// Line and column of a byte, both counted from 1; the column counts bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Line, from 1. LF, CR and CRLF each end one line.
    pub line: usize,
    /// Column in bytes, from 1.
    pub column: usize,
}

impl std::fmt::Display for Position {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// The file is larger than a [`Span`] can address.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("file of {bytes} bytes is over the limit of 4294967295 bytes")]
pub struct SourceTooLarge {
    /// Size of the refused file.
    pub bytes: u64,
}

/// The bytes of one input file, owned and unchanged. Clones share them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    bytes: Arc<Vec<u8>>,
}

impl Source {
    /// Whether a file of some bytes can be taken.
    ///
    /// # Errors
    /// [`SourceTooLarge`] from 4 GiB on.
    pub fn check_size(bytes: u64) -> Result<(), SourceTooLarge> {
        u32::try_from(bytes).map(|_| ()).map_err(|_| SourceTooLarge { bytes })
    }

    /// Takes the bytes of a file.
    ///
    /// # Errors
    /// [`SourceTooLarge`] from 4 GiB on.
    pub fn new(bytes: Vec<u8>) -> Result<Self, SourceTooLarge> {
        Self::check_size(bytes.len() as u64)?;
        Ok(Self { bytes: Arc::new(bytes) })
    }

    /// All bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The bytes of a span.
    #[must_use]
    pub fn slice(&self, span: Span) -> &[u8] {
        &self.bytes[span.range()]
    }

    /// Line and column of a byte offset. Linear in the offset: for messages, not for loops.
    #[must_use]
    pub fn position(&self, offset: u32) -> Position {
        let before = &self.bytes[..(offset as usize).min(self.bytes.len())];
        let mut line = 1;
        let mut line_start = 0;
        for at in memchr2_iter(b'\n', b'\r', before) {
            let cr_of_crlf = before[at] == b'\r' && self.bytes.get(at + 1) == Some(&b'\n');
            if !cr_of_crlf {
                line += 1;
                line_start = at + 1;
            }
        }
        Position { line, column: before.len() - line_start + 1 }
    }
}

/// How lines end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineEnding {
    /// LF
    Lf,
    /// CR LF
    CrLf,
    /// CR
    Cr,
    /// The file has no line ends.
    None,
}

impl LineEnding {
    /// The ending of the first line.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        match memchr2(b'\n', b'\r', bytes) {
            None => Self::None,
            Some(at) if bytes[at] == b'\n' => Self::Lf,
            Some(at) if bytes.get(at + 1) == Some(&b'\n') => Self::CrLf,
            Some(_) => Self::Cr,
        }
    }

    /// Its characters.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Lf => "\n",
            Self::CrLf => "\r\n",
            Self::Cr => "\r",
            Self::None => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_every_line_ending_once() {
        let source = Source::new(b"a\r\nb\rc\nd".to_vec()).expect("small");
        let at = |offset| source.position(offset);
        assert_eq!(at(0), Position { line: 1, column: 1 });
        assert_eq!(at(3), Position { line: 2, column: 1 });
        assert_eq!(at(5), Position { line: 3, column: 1 });
        assert_eq!(at(7), Position { line: 4, column: 1 });
        assert_eq!(at(8), Position { line: 4, column: 2 });
    }

    #[test]
    fn the_first_line_tells_the_ending() {
        assert_eq!(LineEnding::of(b"a\r\nb\n"), LineEnding::CrLf);
        assert_eq!(LineEnding::of(b"a\rb"), LineEnding::Cr);
        assert_eq!(LineEnding::of(b"a\nb"), LineEnding::Lf);
        assert_eq!(LineEnding::of(b"ab"), LineEnding::None);
    }
}
