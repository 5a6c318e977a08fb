//! A set of byte edits and its application.
//!
//! INVARIANT: the edits of a [`Patch`] are sorted, disjoint and inside the file they were made for.

use crate::source::Span;

/// Puts `text` in the place of `span`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// Bytes that go; an empty span inserts.
    pub span: Span,
    /// Bytes that come; empty removes.
    pub text: Vec<u8>,
}

impl Edit {
    /// New bytes in the place of old ones.
    #[must_use]
    pub fn replace(span: Span, text: impl Into<Vec<u8>>) -> Self {
        Self { span, text: text.into() }
    }

    /// New bytes before the byte at `offset`.
    #[must_use]
    pub fn insert(offset: u32, text: impl Into<Vec<u8>>) -> Self {
        Self { span: Span::new(offset, offset), text: text.into() }
    }

    /// Old bytes go.
    #[must_use]
    pub fn remove(span: Span) -> Self {
        Self { span, text: Vec::new() }
    }
}

/// Edits that do not make a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PatchError {
    /// Two edits want the same bytes.
    #[error("edits of the bytes {}..{} and {}..{} overlap", first.start, first.end, second.start, second.end)]
    Overlap {
        /// The one that begins first.
        first: Span,
        /// The other.
        second: Span,
    },
    /// An edit reaches behind the file.
    #[error("edit of the bytes {}..{} in a file of {length} bytes", span.start, span.end)]
    OutOfBounds {
        /// What it wants.
        span: Span,
        /// Length of the file.
        length: usize,
    },
}

/// What a patch does, in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EditCounts {
    /// Edits that replace bytes by others.
    pub replaced: usize,
    /// Edits that insert.
    pub added: usize,
    /// Edits that remove.
    pub removed: usize,
    /// Bytes of the input that are in no edit's span.
    pub bytes_untouched: usize,
}

/// Sorted, disjoint edits on one file. The empty patch is the identity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patch {
    edits: Vec<Edit>,
    length: usize,
}

impl Patch {
    /// Orders edits of a file of `length` bytes. Insertions at one place keep their order, and come before
    /// an edit that begins there. Edits that neither remove nor insert are dropped.
    ///
    /// # Errors
    /// [`PatchError::Overlap`] and [`PatchError::OutOfBounds`].
    pub fn new(length: usize, mut edits: Vec<Edit>) -> Result<Self, PatchError> {
        edits.retain(|edit| !edit.span.is_empty() || !edit.text.is_empty());
        edits.sort_by_key(|edit| (edit.span.start, edit.span.end));
        if let Some(edit) = edits.iter().find(|edit| edit.span.end as usize > length) {
            return Err(PatchError::OutOfBounds { span: edit.span, length });
        }
        for pair in edits.windows(2) {
            let (first, second) = (pair[0].span, pair[1].span);
            if second.start < first.end {
                return Err(PatchError::Overlap { first, second });
            }
        }
        Ok(Self { edits, length })
    }

    /// The edits in file order.
    #[must_use]
    pub fn edits(&self) -> &[Edit] {
        &self.edits
    }

    /// Whether the file stays as it is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.edits.is_empty()
    }

    /// The patched file.
    ///
    /// # Panics
    /// When `bytes` has another length than the file that the patch was made for.
    #[must_use]
    pub fn apply(&self, bytes: &[u8]) -> Vec<u8> {
        assert_eq!(bytes.len(), self.length, "a patch fits only the file it was made for");
        let added: usize = self.edits.iter().map(|edit| edit.text.len()).sum();
        let mut out = Vec::with_capacity(self.counts().bytes_untouched + added);
        let mut at = 0;
        for edit in &self.edits {
            out.extend_from_slice(&bytes[at..edit.span.start as usize]);
            out.extend_from_slice(&edit.text);
            at = edit.span.end as usize;
        }
        out.extend_from_slice(&bytes[at..]);
        out
    }

    /// What the patch does, in numbers.
    #[must_use]
    pub fn counts(&self) -> EditCounts {
        let mut counts = EditCounts { bytes_untouched: self.length, ..EditCounts::default() };
        for edit in &self.edits {
            counts.bytes_untouched -= edit.span.len();
            match (edit.span.is_empty(), edit.text.is_empty()) {
                (true, _) => counts.added += 1,
                (false, true) => counts.removed += 1,
                (false, false) => counts.replaced += 1,
            }
        }
        counts
    }
}
