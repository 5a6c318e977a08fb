//! Stable codes of what may be wrong with an IGES file.
//!
//! Knows no grammar: the readers find the facts and give span and words. A code's text is `iges.` and
//! its name, its severity follows from the code alone, and [`Code::note`] is the only constructor of the
//! diagnostics of this format. Texts never change once released.

use crate::diagnostic::codes;

codes! {
    /// What is wrong with an IGES file.
    enum Code;

    /// No line of the file is a card of an IGES section.
    NotIges, "iges.not-iges", Error;
    /// The file is in the binary form, which IGES 5.3 still describes and nobody writes.
    BinaryForm, "iges.binary-form", Error;
    /// The global, directory or parameter section is missing.
    MissingSection, "iges.missing-section", Error;
    /// The file ends inside a directory entry or a parameter record.
    Truncated, "iges.truncated", Error;
    /// A line that belongs to no section: too short, or without a section letter in column 73.
    StrayLine, "iges.stray-line", Error;
    /// Bytes stand behind column 80; they are kept and not read.
    LongCard, "iges.long-card", Warning;
    /// A card of a section that was over already.
    SectionOrder, "iges.section-order", Warning;
    /// Sequence numbers that do not count from one.
    SequenceNumber, "iges.sequence-number", Warning;
    /// The terminate card is missing.
    MissingTerminate, "iges.missing-terminate", Warning;
    /// The terminate card states other counts than the sections have.
    TerminateCounts, "iges.terminate-counts", Warning;
    /// Text behind the terminate card.
    TrailingData, "iges.trailing-data", Note;
    /// The delimiters of the global section are none; comma and semicolon are taken.
    BadDelimiters, "iges.bad-delimiters", Error;
    /// A parameter of the global section that is not what it must be; its default is taken.
    BadGlobal, "iges.bad-global", Warning;
    /// A field of a directory entry that is no number; it counts as blank.
    BadDirectoryField, "iges.bad-directory-field", Error;
    /// The two cards of a directory entry, or the entry and its parameters, state different entity types.
    TypeMismatch, "iges.type-mismatch", Error;
    /// A directory entry whose parameter pointer leads to no card of its own.
    ParameterPointer, "iges.parameter-pointer", Error;
    /// A directory entry that states another count of parameter cards than there are.
    ParameterCount, "iges.parameter-count", Warning;
    /// Parameter cards that point back to another entry than the one that they belong to.
    BackPointer, "iges.back-pointer", Warning;
    /// Parameter cards that no directory entry leads to.
    UnownedCards, "iges.unowned-cards", Warning;
    /// A record without a record delimiter at its end.
    MissingDelimiter, "iges.missing-record-delimiter", Error;
    /// A pointer to an entry that the file does not have.
    UnresolvedPointer, "iges.unresolved-pointer", Error;
    /// A line of the compressed form that cannot be read.
    BadCompression, "iges.bad-compression", Error;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_distinct_and_well_formed() {
        let mut texts: Vec<_> = Code::ALL.iter().map(|code| code.text()).collect();
        texts.sort_unstable();
        texts.dedup();
        assert_eq!(texts.len(), Code::ALL.len());
        for text in texts {
            let name = text.strip_prefix("iges.").expect("every code begins with the format");
            assert!(!name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{text}");
        }
    }
}
