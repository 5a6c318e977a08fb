//! The input bytes of one file, and places in them.
//!
//! Bytes are never decoded, normalised or copied here. A file is at most 4 GiB - 1 byte, so that a
//! place fits in 32 bits: an index over a file then costs half of what it would with `usize`.

use std::sync::{Arc, OnceLock};

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
#[derive(Debug, Clone)]
pub struct Source {
    file: Arc<File>,
}

#[derive(Debug)]
struct File {
    bytes: Vec<u8>,
    /// The line at the start of each block, found when a place is first asked for.
    blocks: OnceLock<Vec<Block>>,
}

/// The line in which a block of bytes begins.
#[derive(Debug, Clone, Copy)]
struct Block {
    line: u32,
    line_start: u32,
}

/// Bytes between two places whose lines are kept.
const BLOCK: usize = 1 << 14;

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        self.bytes() == other.bytes()
    }
}

impl Eq for Source {}

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
        Ok(Self { file: Arc::new(File { bytes, blocks: OnceLock::new() }) })
    }

    /// All bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.file.bytes
    }

    /// The bytes of a span.
    #[must_use]
    pub fn slice(&self, span: Span) -> &[u8] {
        &self.file.bytes[span.range()]
    }

    /// Line and column of a byte offset. The first call reads the whole file once.
    #[must_use]
    pub fn position(&self, offset: u32) -> Position {
        let offset = (offset as usize).min(self.bytes().len());
        let block = offset / BLOCK;
        let start = self.file.blocks()[block];
        let mut at = start;
        self.file.walk(block * BLOCK..offset, &mut at);
        Position { line: at.line as usize, column: offset - at.line_start as usize + 1 }
    }
}

impl File {
    fn blocks(&self) -> &[Block] {
        self.blocks.get_or_init(|| {
            let mut at = Block { line: 1, line_start: 0 };
            let mut blocks = vec![at];
            for start in (0..self.bytes.len()).step_by(BLOCK) {
                self.walk(start..(start + BLOCK).min(self.bytes.len()), &mut at);
                blocks.push(at);
            }
            blocks
        })
    }

    /// Counts the lines that end within a range.
    #[expect(clippy::cast_possible_truncation, reason = "a source is below 4 GiB")]
    fn walk(&self, range: std::ops::Range<usize>, at: &mut Block) {
        for found in memchr2_iter(b'\n', b'\r', &self.bytes[range.clone()]) {
            let end = range.start + found;
            let cr_of_crlf = self.bytes[end] == b'\r' && self.bytes.get(end + 1) == Some(&b'\n');
            if !cr_of_crlf {
                *at = Block { line: at.line + 1, line_start: end as u32 + 1 };
            }
        }
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

    #[test]
    fn places_far_into_a_file_are_those_of_a_plain_count() {
        // Ends of lines on both sides of blocks, and a CRLF over one.
        let mut text = Vec::new();
        for k in 0..4000usize {
            text.extend(std::iter::repeat_n(b'x', k % 13));
            text.extend_from_slice([b"\n".as_slice(), b"\r\n", b"\r"][k % 3]);
        }
        text.resize(2 * BLOCK - 1, b'y');
        text.extend_from_slice(b"\r\nz");
        let source = Source::new(text.clone()).expect("small");
        let (mut line, mut column) = (1, 1);
        for (offset, &byte) in text.iter().enumerate() {
            let at = u32::try_from(offset).expect("small");
            assert_eq!(source.position(at), Position { line, column });
            let ends = byte == b'\n' || byte == b'\r' && text.get(offset + 1) != Some(&b'\n');
            (line, column) = if ends { (line + 1, 1) } else { (line, column + 1) };
        }
    }
}
