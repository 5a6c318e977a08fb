//! The text of new records, and of whole files.
//!
//! [`RecordWriter`] gathers the parameters of one entity; [`laid_out`] sets them on lines. Neither knows a schema: which
//! parameter comes when is the caller's business. [`file()`] puts entities together to a file of the fixed form.

use super::card::{DATA, PARAMETER_DATA};
use super::directory_entry::{DirectoryEntry, EntryNumber};
use super::global::Global;
use super::parameter::Delimiters;
use super::string;
use crate::number::format_real;

/// A parameter as it stands in a file, without delimiter.
pub type ParameterText = Vec<u8>;

/// Builds the parameters of one record.
///
/// ```
/// use resurf::iges::write::{RecordWriter, laid_out};
/// use resurf::iges::{Delimiters, EntryNumber};
/// let mut record = RecordWriter::of_type(142);
/// record.integer(1).pointer(Some(EntryNumber(7))).pointer(None).real(0.5).text("a;b");
/// let lines = laid_out(&record.finish(), Delimiters::default(), 64);
/// assert_eq!(lines, [b"142,1,7,0,0.5,3Ha;b;"]);
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RecordWriter {
    parameters: Vec<ParameterText>,
}

impl RecordWriter {
    /// Begins the record of an entity of a type.
    #[must_use]
    pub fn of_type(entity_type: i32) -> Self {
        Self { parameters: vec![entity_type.to_string().into_bytes()] }
    }

    /// Begins in the middle of a record.
    #[must_use]
    pub fn part() -> Self {
        Self::default()
    }

    fn push(&mut self, text: String) -> &mut Self {
        self.parameters.push(text.into_bytes());
        self
    }

    /// An integer.
    pub fn integer(&mut self, value: i64) -> &mut Self {
        self.push(value.to_string())
    }

    /// A count.
    pub fn count(&mut self, value: usize) -> &mut Self {
        self.push(value.to_string())
    }

    /// A logical value: 1 or 0. It is data, not an option.
    pub fn logical(&mut self, value: bool) -> &mut Self {
        self.integer(i64::from(value))
    }

    /// A real (see [`format_real`]).
    ///
    /// # Panics
    /// When the value is not finite.
    pub fn real(&mut self, value: f64) -> &mut Self {
        self.push(format_real(value))
    }

    /// Reals one after the other.
    ///
    /// # Panics
    /// When a value is not finite.
    pub fn reals(&mut self, values: impl IntoIterator<Item = f64>) -> &mut Self {
        for value in values {
            self.real(value);
        }
        self
    }

    /// A pointer; zero for none.
    pub fn pointer(&mut self, to: Option<EntryNumber>) -> &mut Self {
        self.push(to.map_or(0, |number| number.0).to_string())
    }

    /// Pointers one after the other.
    pub fn pointers(&mut self, to: impl IntoIterator<Item = EntryNumber>) -> &mut Self {
        for number in to {
            self.pointer(Some(number));
        }
        self
    }

    /// A Hollerith text.
    pub fn text(&mut self, value: &str) -> &mut Self {
        self.push(string::encode(value))
    }

    /// A parameter as it stands in a file.
    pub fn verbatim(&mut self, text: &[u8]) -> &mut Self {
        self.parameters.push(text.to_vec());
        self
    }

    /// All parameters.
    #[must_use]
    pub fn finish(&self) -> Vec<ParameterText> {
        self.parameters.clone()
    }
}

/// Parameters on lines of at most `width` columns, each with its delimiter. Only a text that is longer than a line is cut.
#[must_use]
pub fn laid_out(parameters: &[ParameterText], delimiters: Delimiters, width: usize) -> Vec<Vec<u8>> {
    let mut lines = LineWriter::new(width);
    for (at, parameter) in parameters.iter().enumerate() {
        let last = at + 1 == parameters.len();
        lines.value(parameter, Some(if last { delimiters.record } else { delimiters.parameter }));
    }
    lines.finish()
}

/// Sets values and comments on lines.
#[derive(Debug)]
pub(super) struct LineWriter {
    width: usize,
    lines: Vec<Vec<u8>>,
}

impl LineWriter {
    pub(super) fn new(width: usize) -> Self {
        Self { width, lines: vec![Vec::new()] }
    }

    fn last(&mut self) -> &mut Vec<u8> {
        if self.lines.is_empty() {
            self.lines.push(Vec::new());
        }
        let at = self.lines.len() - 1;
        &mut self.lines[at]
    }

    /// Places a value and the delimiter behind it, on a new line when they do not fit.
    pub(super) fn value(&mut self, value: &[u8], delimiter: Option<u8>) {
        let length = value.len() + usize::from(delimiter.is_some());
        let left = self.width - self.last().len();
        if length > left && !self.last().is_empty() && (length <= self.width || left <= COUNT_LENGTH) {
            self.lines.push(Vec::new());
        }
        self.flow(value);
        if let Some(delimiter) = delimiter {
            self.flow(&[delimiter]);
        }
    }

    /// Places bytes where they come, cut at the end of lines.
    pub(super) fn flow(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            if self.last().len() == self.width {
                self.lines.push(Vec::new());
            }
            let room = self.width - self.last().len();
            let (now, later) = bytes.split_at(bytes.len().min(room));
            self.last().extend_from_slice(now);
            bytes = later;
        }
    }

    pub(super) fn finish(self) -> Vec<Vec<u8>> {
        self.lines
    }
}

/// Columns that the count of a text takes at most: it is not parted from the beginning of its text.
const COUNT_LENGTH: usize = 8;

/// An entity to be written: its directory entry, whose pointer and count of cards are not looked at, and its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct NewEntity {
    /// Directory entry.
    pub entry: DirectoryEntry,
    /// Parameters, the entity type first.
    pub parameters: Vec<ParameterText>,
}

/// Columns 1 to 72 of the two cards of a directory entry.
#[must_use]
pub fn directory_cards(entry: &DirectoryEntry) -> [String; 2] {
    let DirectoryEntry { entity_type, parameter_data, structure, line_font, level, view, .. } = *entry;
    let DirectoryEntry { transformation, label_display, line_weight, colour, .. } = *entry;
    let label = String::from_utf8_lossy(&entry.label.0);
    let first = format!(
        "{entity_type:8}{parameter_data:8}{structure:8}{line_font:8}{level:8}{view:8}{transformation:8}\
         {label_display:8}{}",
        entry.status.text()
    );
    let second = format!(
        "{entity_type:8}{line_weight:8}{colour:8}{:8}{:8}{:16}{label:>8}{:8}",
        entry.parameter_cards, entry.form, "", entry.subscript
    );
    [first, second]
}

/// A whole card: columns 1 to 72, the section letter and the sequence number.
#[must_use]
pub fn card(data: &[u8], letter: char, sequence: usize) -> Vec<u8> {
    let mut card = data.to_vec();
    card.resize(DATA, b' ');
    card.extend_from_slice(format!("{letter}{sequence:7}").as_bytes());
    card
}

/// Columns 1 to 72 of a parameter card: parameters and the pointer back.
#[must_use]
pub fn parameter_data(parameters: &[u8], back: EntryNumber) -> Vec<u8> {
    let mut data = parameters.to_vec();
    data.resize(PARAMETER_DATA, b' ');
    data.extend_from_slice(format!("{:8}", back.0).as_bytes());
    data
}

/// A file of the fixed form with lines that end in LF: text for people, what the global section says, and entities,
/// the first of which is `D1`, the next `D3` and so on.
#[must_use]
pub fn file(start: &[&str], global: &Global, entities: &[NewEntity]) -> Vec<u8> {
    let delimiters = global.delimiters;
    let mut sections: [Vec<Vec<u8>>; 4] = Default::default();
    sections[0] = start.iter().map(|line| line.as_bytes().to_vec()).collect();
    sections[1] = laid_out(&global_parameters(global), delimiters, DATA);
    for (at, entity) in entities.iter().enumerate() {
        let number = EntryNumber(u32::try_from(2 * at + 1).unwrap_or(u32::MAX));
        let lines = laid_out(&entity.parameters, delimiters, PARAMETER_DATA);
        let entry = DirectoryEntry {
            parameter_data: i32::try_from(sections[3].len() + 1).unwrap_or(i32::MAX),
            parameter_cards: i32::try_from(lines.len()).unwrap_or(i32::MAX),
            ..entity.entry
        };
        sections[2].extend(directory_cards(&entry).map(String::into_bytes));
        sections[3].extend(lines.iter().map(|line| parameter_data(line, number)));
    }
    let mut out = Vec::new();
    for (letter, cards) in ['S', 'G', 'D', 'P'].into_iter().zip(&sections) {
        for (at, data) in cards.iter().enumerate() {
            out.extend(card(data, letter, at + 1));
            out.push(b'\n');
        }
    }
    let counts: String = ['S', 'G', 'D', 'P']
        .iter()
        .zip(&sections)
        .map(|(letter, cards)| format!("{letter}{:7}", cards.len()))
        .collect();
    out.extend(card(counts.as_bytes(), 'T', 1));
    out.push(b'\n');
    out
}

/// The parameters of a global section, all 26.
#[must_use]
pub fn global_parameters(global: &Global) -> Vec<ParameterText> {
    let mut writer = RecordWriter::part();
    let Delimiters { parameter, record } = global.delimiters;
    writer.verbatim(&[b'1', b'H', parameter]).verbatim(&[b'1', b'H', record]);
    let integer = |writer: &mut RecordWriter, value: Option<i64>| {
        match value {
            Some(value) => writer.integer(value),
            None => writer.verbatim(b""),
        };
    };
    let real = |writer: &mut RecordWriter, value: Option<f64>| {
        match value {
            Some(value) => writer.real(value),
            None => writer.verbatim(b""),
        };
    };
    writer.text(&global.sender_product).text(&global.file_name).text(&global.native_system);
    writer.text(&global.preprocessor_version);
    let [single, double] = [global.single_precision, global.double_precision];
    for value in [global.integer_bits, single[0], single[1], double[0], double[1]] {
        integer(&mut writer, value);
    }
    writer.text(&global.receiver_product);
    real(&mut writer, global.scale);
    integer(&mut writer, global.unit_flag);
    writer.text(&global.unit_name);
    integer(&mut writer, global.line_weights);
    real(&mut writer, global.line_width);
    writer.text(&global.written);
    real(&mut writer, global.resolution);
    real(&mut writer, global.greatest_coordinate);
    writer.text(&global.author).text(&global.organisation);
    integer(&mut writer, global.version);
    integer(&mut writer, global.drafting_standard);
    writer.text(&global.changed).text(&global.protocol);
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::super::exchange_structure::ExchangeStructure;
    use super::*;
    use crate::source::Source;

    #[test]
    fn values_stay_whole_and_long_texts_are_cut() {
        let mut record = RecordWriter::of_type(406);
        record.integer(1).text(&"x".repeat(100)).real(-0.1);
        let lines = laid_out(&record.finish(), Delimiters::default(), 64);
        let lengths: Vec<usize> = lines.iter().map(Vec::len).collect();
        assert_eq!(lengths, [64, 52]);
        assert_eq!(
            lines.concat(),
            [b"406,1,100H".as_slice(), "x".repeat(100).as_bytes(), b",-0.1;"].concat()
        );
        let mut record = RecordWriter::of_type(126);
        record.reals((0..40).map(|k| f64::from(k) + 0.123));
        for line in laid_out(&record.finish(), Delimiters::default(), 64) {
            assert!(line.len() <= 64 && line.ends_with(b",") || line.ends_with(b";"));
        }
    }

    #[test]
    fn a_file_reads_back_as_it_was_written() {
        let mut global = Global {
            sender_product: "part; of, many".into(),
            unit_flag: Some(2),
            unit_name: "MM".into(),
            scale: Some(1.0),
            resolution: Some(1e-6),
            version: Some(11),
            written: "20261126.093000".into(),
            ..Global::default()
        };
        global.integer_bits = Some(32);
        let mut point = RecordWriter::of_type(116);
        point.reals([1.0, 2.0, 1.0 / 3.0]).pointer(None);
        let mut name = RecordWriter::of_type(406);
        name.integer(1).text(&"long name ".repeat(12));
        let entry = |entity_type, form| DirectoryEntry {
            entity_type,
            form,
            label: super::super::Label(*b"       P"),
            ..Default::default()
        };
        let entities = [
            NewEntity { entry: entry(116, 0), parameters: point.finish() },
            NewEntity { entry: entry(406, 15), parameters: name.finish() },
        ];
        let bytes = file(&["made"], &global, &entities);
        let mut sink = Vec::new();
        let read = ExchangeStructure::parse(Source::new(bytes).expect("small"), &mut sink);
        read.damaged_records(&mut sink);
        assert_eq!(sink, []);
        assert_eq!(read.global(), &global);
        for (instance, entity) in read.instances().zip(&entities) {
            let texts: Vec<Vec<u8>> =
                instance.record().map(|parameter| parameter.text().into_owned()).collect();
            assert_eq!(texts, entity.parameters);
            assert_eq!(instance.entry().label, entity.entry.label);
            assert_eq!(instance.entry().form, entity.entry.form);
        }
    }
}
