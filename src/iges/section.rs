//! Sections of an IGES file: what they are and which cards make them.

/// Kind of a section, by the letter in column 73 (IGES 5.3 section 2.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SectionKind {
    /// `C`, or `B` in the binary form: says that what follows is not in the fixed form.
    Flag,
    /// `S`: text for people.
    Start,
    /// `G`: delimiters, units, precision, who wrote the file and when.
    Global,
    /// `D`: two cards for each entity.
    Directory,
    /// `P`: the parameters of the entities.
    Parameter,
    /// `T`: counts of the others.
    Terminate,
}

impl SectionKind {
    /// The section of a letter.
    #[must_use]
    pub fn from_letter(letter: u8) -> Option<Self> {
        match letter {
            b'C' | b'B' => Some(Self::Flag),
            b'S' => Some(Self::Start),
            b'G' => Some(Self::Global),
            b'D' => Some(Self::Directory),
            b'P' => Some(Self::Parameter),
            b'T' => Some(Self::Terminate),
            _ => None,
        }
    }

    /// Word in messages.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Flag => "flag",
            Self::Start => "start",
            Self::Global => "global",
            Self::Directory => "directory",
            Self::Parameter => "parameter",
            Self::Terminate => "terminate",
        }
    }
}

/// How the directory and parameter sections are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Cards of 80 columns (IGES 5.3 section 2.2).
    Fixed,
    /// One data section of free lines (IGES 5.3 section 2.3).
    Compressed,
}

/// Offsets of the cards of each section, in file order.
///
/// In the compressed form the directory is empty, and the parameter section holds the lines of the data section.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Sections {
    /// Flag card.
    pub flag: Vec<u32>,
    /// Start section.
    pub start: Vec<u32>,
    /// Global section.
    pub global: Vec<u32>,
    /// Directory section.
    pub directory: Vec<u32>,
    /// Parameter section.
    pub parameter: Vec<u32>,
    /// Terminate section.
    pub terminate: Vec<u32>,
}

impl Sections {
    /// The cards of one section.
    #[must_use]
    pub fn of(&self, kind: SectionKind) -> &[u32] {
        match kind {
            SectionKind::Flag => &self.flag,
            SectionKind::Start => &self.start,
            SectionKind::Global => &self.global,
            SectionKind::Directory => &self.directory,
            SectionKind::Parameter => &self.parameter,
            SectionKind::Terminate => &self.terminate,
        }
    }

    pub(super) fn push(&mut self, kind: SectionKind, offset: u32) {
        match kind {
            SectionKind::Flag => self.flag.push(offset),
            SectionKind::Start => self.start.push(offset),
            SectionKind::Global => self.global.push(offset),
            SectionKind::Directory => self.directory.push(offset),
            SectionKind::Parameter => self.parameter.push(offset),
            SectionKind::Terminate => self.terminate.push(offset),
        }
    }
}
