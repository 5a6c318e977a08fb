//! Directory entries: the twenty fields of IGES 5.3 section 2.2.4.4, decoded.
//!
//! A field that is no number counts as blank, and whoever decodes is told so. What a number means is not known here.

use super::card;

/// Sequence number of the first card of a directory entry: the name of an entity in its file, `D57`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EntryNumber(pub u32);

impl EntryNumber {
    /// The entry that a pointer leads to; `None` for zero, a negative or an even number.
    #[must_use]
    pub fn from_pointer(pointer: i64) -> Option<Self> {
        let number = u32::try_from(pointer).ok()?;
        (number % 2 == 1).then_some(Self(number))
    }

    /// Reads `D57`; `None` when it is no such name.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text.strip_prefix(['D', 'd'])?;
        let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
        digits.parse().ok().filter(|_| plain).map(Self)
    }
}

impl std::fmt::Display for EntryNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "D{}", self.0)
    }
}

/// Fields of a directory entry by their numbers in the standard.
///
/// Fields 10 and 20 are the sequence numbers of the two cards, field 11 repeats the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Field {
    /// Entity type.
    EntityType = 1,
    /// Sequence number of the first parameter card.
    ParameterData = 2,
    /// Pointer to a definition, negated; or nothing.
    Structure = 3,
    /// Number, or negated pointer to a definition.
    LineFont = 4,
    /// Number, or negated pointer to a list of levels.
    Level = 5,
    /// Pointer to a view.
    View = 6,
    /// Pointer to a transformation matrix.
    Transformation = 7,
    /// Pointer to how the label is shown.
    LabelDisplay = 8,
    /// Four pairs of digits.
    Status = 9,
    /// The entity type again.
    EntityTypeAgain = 11,
    /// Line weight.
    LineWeight = 12,
    /// Number, or negated pointer to a definition.
    Colour = 13,
    /// Count of parameter cards.
    ParameterCards = 14,
    /// Form number.
    Form = 15,
    /// Reserved.
    ReservedFirst = 16,
    /// Reserved.
    ReservedSecond = 17,
    /// Label.
    Label = 18,
    /// Subscript of the label.
    Subscript = 19,
}

impl Field {
    /// Every field, in the order of the cards.
    pub const ALL: [Self; 18] = [
        Self::EntityType,
        Self::ParameterData,
        Self::Structure,
        Self::LineFont,
        Self::Level,
        Self::View,
        Self::Transformation,
        Self::LabelDisplay,
        Self::Status,
        Self::EntityTypeAgain,
        Self::LineWeight,
        Self::Colour,
        Self::ParameterCards,
        Self::Form,
        Self::ReservedFirst,
        Self::ReservedSecond,
        Self::Label,
        Self::Subscript,
    ];

    /// The field of a number in the standard.
    #[must_use]
    pub fn from_number(number: usize) -> Option<Self> {
        Self::ALL.into_iter().find(|field| *field as usize == number)
    }

    /// Which of the two cards holds it, and in which columns, counted from 0.
    #[must_use]
    pub fn place(self) -> (usize, std::ops::Range<usize>) {
        let at = self as usize - 1;
        let start = 8 * (at % 10);
        (at / 10, start..start + 8)
    }
}

/// What the status number says (field 9), each part as written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Status {
    /// 0 visible, 1 blanked.
    pub blank: u8,
    /// 0 independent, 1 physically, 2 logically, 3 both ways dependent.
    pub subordinate: u8,
    /// 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 in two parameters, 6 construction.
    pub usage: u8,
    /// 0 the entity's own attributes hold for all below, 1 for none, 2 as a property says.
    pub hierarchy: u8,
}

impl Status {
    /// Reads eight columns: pairs of digits; blanks count as zeros.
    #[must_use]
    pub fn parse(field: &[u8]) -> Option<Self> {
        let digit = |at: usize| match field.get(at) {
            Some(byte @ b'0'..=b'9') => Some(byte - b'0'),
            Some(b' ') => Some(0),
            _ => None,
        };
        let pair = |at: usize| Some(10 * digit(at)? + digit(at + 1)?);
        Some(Self { blank: pair(0)?, subordinate: pair(2)?, usage: pair(4)?, hierarchy: pair(6)? })
    }

    /// The eight digits as a number.
    #[must_use]
    pub fn number(self) -> i32 {
        let parts = [self.blank, self.subordinate, self.usage, self.hierarchy];
        parts.into_iter().fold(0, |number, part| 100 * number + i32::from(part))
    }

    /// The eight columns.
    #[must_use]
    pub fn text(self) -> String {
        let Self { blank, subordinate, usage, hierarchy } = self;
        format!("{blank:02}{subordinate:02}{usage:02}{hierarchy:02}")
    }
}

/// The label of an entity: eight columns, blanks included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Label(pub [u8; 8]);

impl Default for Label {
    fn default() -> Self {
        Self([b' '; 8])
    }
}

/// One directory entry.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DirectoryEntry {
    /// Field 1.
    pub entity_type: i32,
    /// Field 2, as written.
    pub parameter_data: i32,
    /// Field 3.
    pub structure: i32,
    /// Field 4.
    pub line_font: i32,
    /// Field 5.
    pub level: i32,
    /// Field 6.
    pub view: i32,
    /// Field 7.
    pub transformation: i32,
    /// Field 8.
    pub label_display: i32,
    /// Field 9.
    pub status: Status,
    /// Field 12.
    pub line_weight: i32,
    /// Field 13.
    pub colour: i32,
    /// Field 14, as written.
    pub parameter_cards: i32,
    /// Field 15.
    pub form: i32,
    /// Field 18, as written.
    pub label: Label,
    /// Field 19.
    pub subscript: i32,
}

impl DirectoryEntry {
    /// Decodes two cards of at least 72 columns; `bad` is called for each field that is not what it must be.
    pub(super) fn decode(first: &[u8], second: &[u8], mut bad: impl FnMut(Field)) -> Self {
        let mut entry = Self::default();
        let cards = [first, second];
        for field in Field::ALL {
            let (card, columns) = field.place();
            // The sequence number of a card ends in column 80, and may be cut.
            if !entry.set(field, &cards[card][columns]) {
                bad(field);
            }
        }
        entry
    }

    /// Sets a field from its text; whether that is what the field must be.
    pub(super) fn set(&mut self, field: Field, text: &[u8]) -> bool {
        let number = match field {
            Field::EntityType => &mut self.entity_type,
            Field::ParameterData => &mut self.parameter_data,
            Field::Structure => &mut self.structure,
            Field::LineFont => &mut self.line_font,
            Field::Level => &mut self.level,
            Field::View => &mut self.view,
            Field::Transformation => &mut self.transformation,
            Field::LabelDisplay => &mut self.label_display,
            Field::LineWeight => &mut self.line_weight,
            Field::Colour => &mut self.colour,
            Field::ParameterCards => &mut self.parameter_cards,
            Field::Form => &mut self.form,
            Field::Subscript => &mut self.subscript,
            Field::Status => {
                let status = Status::parse(text);
                self.status = status.unwrap_or_default();
                return status.is_some();
            }
            Field::Label => {
                self.label = Label::default();
                let length = text.len().min(8);
                self.label.0[8 - length..].copy_from_slice(&text[..length]);
                return text.len() <= 8;
            }
            Field::EntityTypeAgain => return card::integer(text) == Some(self.entity_type),
            Field::ReservedFirst | Field::ReservedSecond => return true,
        };
        let found = (text.len() <= 8).then(|| card::integer(text)).flatten();
        *number = found.unwrap_or(0);
        found.is_some()
    }

    /// Label and subscript as people read them: `FACE` or `FACE(12)`; empty when the label is blank.
    #[must_use]
    pub fn label_text(&self) -> String {
        let label = String::from_utf8_lossy(&self.label.0);
        match (label.trim(), self.subscript) {
            ("", _) => String::new(),
            (label, 0) => label.to_owned(),
            (label, subscript) => format!("{label}({subscript})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_stand_where_the_standard_has_them() {
        let first = "     128       7      -3       1       2       0      21       0 1 2 5 1D     33";
        let second = "     128       4      -5      12       6                 SURFACE       9D     34";
        let mut bad = Vec::new();
        let entry = DirectoryEntry::decode(first.as_bytes(), second.as_bytes(), |field| bad.push(field));
        assert_eq!(bad, []);
        let expected = DirectoryEntry {
            entity_type: 128,
            parameter_data: 7,
            structure: -3,
            line_font: 1,
            level: 2,
            view: 0,
            transformation: 21,
            label_display: 0,
            status: Status { blank: 1, subordinate: 2, usage: 5, hierarchy: 1 },
            line_weight: 4,
            colour: -5,
            parameter_cards: 12,
            form: 6,
            label: Label(*b" SURFACE"),
            subscript: 9,
        };
        assert_eq!(entry, expected);
        assert_eq!(entry.label_text(), "SURFACE(9)");
        assert_eq!(entry.status.text(), "01020501");
    }

    #[test]
    fn pointers_lead_to_odd_numbers() {
        let of = EntryNumber::from_pointer;
        assert_eq!([of(0), of(-3), of(4), of(1 << 40)], [None; 4]);
        assert_eq!(of(57), Some(EntryNumber(57)));
        assert_eq!(EntryNumber::parse("D57"), Some(EntryNumber(57)));
        assert_eq!([EntryNumber::parse("57"), EntryNumber::parse("D"), EntryNumber::parse("D+5")], [None; 3]);
    }
}
