//! Stable codes of what may be wrong with a STEP file.
//!
//! Knows no grammar: the readers find the facts and give span and words. A code's text is `step.` and
//! its name, its severity follows from the code alone, and [`Code::note`] is the only constructor of the
//! diagnostics of this format. Texts never change once released.

use crate::diagnostic::codes;

codes! {
    /// What is wrong with a STEP file.
    enum Code;

    /// The file is a gzip or zip container, not clear text.
    Compressed, "step.compressed", Error;
    /// `ISO-10303-21;` is nowhere in the file.
    NotExchangeStructure, "step.not-exchange-structure", Error;
    /// Bytes stand before `ISO-10303-21;`.
    LeadingJunk, "step.leading-junk", Warning;
    /// Bytes other than padding stand behind `END-ISO-10303-21;`.
    TrailingData, "step.trailing-data", Note;
    /// `END-ISO-10303-21;` is missing.
    MissingEnd, "step.missing-end", Warning;
    /// A section is not closed by `ENDSEC;`.
    MissingEndsec, "step.missing-endsec", Warning;
    /// The file ends inside a section or a record.
    Truncated, "step.truncated", Error;
    /// Text that is neither a section nor a record.
    UnexpectedText, "step.unexpected-text", Error;
    /// A record cannot be read as one; reading goes on behind it.
    DamagedRecord, "step.damaged-record", Error;
    /// A record is not closed by a semicolon.
    MissingSemicolon, "step.missing-semicolon", Error;
    /// An instance name has more digits than 64 bits hold; the record is carried but cannot be named.
    InstanceNameTooLarge, "step.instance-name-too-large", Error;
    /// Two records have one instance name; the first is used.
    DuplicateInstance, "step.duplicate-instance", Error;
    /// A reference to a record that the file does not define.
    UnresolvedReference, "step.unresolved-reference", Error;
    /// Keywords in lower case, against ISO 10303-21 clause 6.3.1.
    LowerCaseKeyword, "step.lower-case-keyword", Warning;
    /// The edition-1 scope construct, withdrawn since.
    ScopeStructure, "step.scope-structure", Warning;
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
            let name = text.strip_prefix("step.").expect("every code begins with the format");
            assert!(!name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{text}");
        }
    }
}
