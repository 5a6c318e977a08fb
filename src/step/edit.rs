//! Edits that ISO 10303-21 asks for: the stamp of a changed file, records that come and records that go.
//!
//! Everything here gives byte edits for [`Patch`](crate::exchange::Patch) and changes nothing itself.

use super::exchange_structure::ExchangeStructure;
use super::parameter::{Parameter, ParameterKind};
use super::{string, syntax};
use crate::exchange::Edit;
use crate::source::{LineEnding, Span};

/// Place of `time_stamp` in `FILE_NAME` (ISO 10303-21:2016 clause 8.2.2).
const TIME_STAMP: usize = 1;
/// Place of `preprocessor_version` in `FILE_NAME`.
const PREPROCESSOR_VERSION: usize = 4;

/// New time stamp (ISO 8601, as the caller decides) and preprocessor version in `FILE_NAME`; everything else of
/// it stays. No edits for a file without `FILE_NAME`, and none for values that are no strings.
#[must_use]
pub fn stamp(structure: &ExchangeStructure, timestamp: &str, preprocessor: &str) -> Vec<Edit> {
    let Some(file_name) = structure.header_record(b"FILE_NAME") else { return Vec::new() };
    let values = [(TIME_STAMP, timestamp), (PREPROCESSOR_VERSION, preprocessor)];
    let edit = |(at, parameter): (usize, Parameter<'_>)| {
        let (_, value) = values.iter().find(|(place, _)| *place == at)?;
        let replaceable = matches!(parameter.kind(), ParameterKind::String | ParameterKind::Omitted);
        replaceable.then(|| Edit::replace(parameter.span(), string::encode(value)))
    };
    file_name.parameters().enumerate().filter_map(edit).collect()
}

/// Insertions of new records, one for each, before `ENDSEC` of the last data section, each on lines of its own
/// where the file has lines. `None` when there are records and the file has no data section.
#[must_use]
pub fn append(structure: &ExchangeStructure, records: Vec<String>) -> Option<Vec<Edit>> {
    if records.is_empty() {
        return Some(Vec::new());
    }
    let offset = structure.insertion_offset()?;
    let bytes = structure.source().bytes();
    let ending = LineEnding::of(bytes).as_str();
    let before = &bytes[..offset as usize];
    let mut lead = if before.ends_with(b"\n") || before.ends_with(b"\r") { "" } else { ending };
    let insert =
        |record: String| Edit::insert(offset, format!("{}{record}{ending}", std::mem::take(&mut lead)));
    Some(records.into_iter().map(insert).collect())
}

/// What to remove so that no blank line is left of a record: its span, and its lines as a whole when nothing else
/// stands on them.
#[must_use]
pub fn with_line(bytes: &[u8], record: Span) -> Span {
    let is_blank = |byte: &u8| matches!(byte, b' ' | b'\t');
    let is_break = |byte: &u8| matches!(byte, b'\n' | b'\r');
    let range = record.range();
    let before = &bytes[..range.start];
    let start = before.iter().rposition(|byte| !is_blank(byte)).map_or(0, |at| at + 1);
    let begins_line = start == 0 || is_break(&bytes[start - 1]);
    let after = &bytes[range.end..];
    let end = range.end + after.iter().position(|byte| !is_blank(byte)).unwrap_or(after.len());
    match (begins_line, bytes.get(end..).unwrap_or_default()) {
        (true, [b'\r', b'\n', ..]) => syntax::span(start, end + 2),
        (true, [b'\r' | b'\n', ..]) => syntax::span(start, end + 1),
        _ => record,
    }
}

/// Edits that remove instances, by position in the file, with their lines.
#[must_use]
pub fn remove(structure: &ExchangeStructure, positions: impl IntoIterator<Item = u32>) -> Vec<Edit> {
    let bytes = structure.source().bytes();
    let spans = positions.into_iter().filter_map(|position| structure.instance_at(position));
    spans.map(|instance| Edit::remove(with_line(bytes, instance.span()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::Patch;
    use crate::source::Source;

    fn read(text: &str) -> ExchangeStructure {
        ExchangeStructure::parse(Source::new(text.into()).expect("small"), &mut Vec::new())
    }

    fn patched(text: &str, edits: Vec<Edit>) -> String {
        let patch = Patch::new(text.len(), edits).expect("disjoint");
        String::from_utf8(patch.apply(text.as_bytes())).expect("ASCII stays ASCII")
    }

    #[test]
    fn only_time_and_preprocessor_are_stamped() {
        let text =
            "ISO-10303-21;HEADER;FILE_NAME('n','old',('a'),\n('o'),'p','s','x');ENDSEC;END-ISO-10303-21;";
        let edits = stamp(&read(text), "2026-01-02T03:04:05", "it's");
        let expected = text.replace("'old'", "'2026-01-02T03:04:05'").replace("'p'", "'it''s'");
        assert_eq!(patched(text, edits), expected);
    }

    #[test]
    fn records_go_with_their_lines_and_come_on_lines_of_their_own() {
        let file = |data: &str| {
            format!("ISO-10303-21;\r\nHEADER;\r\nENDSEC;\r\nDATA;\r\n{data}ENDSEC;\r\nEND-ISO-10303-21;\r\n")
        };
        let text = file("#1=A();\r\n  #2=B(\r\n1);  \r\n#3=C(); #4=D();\r\n");
        let structure = read(&text);
        let edits = remove(&structure, [1, 3]);
        assert_eq!(patched(&text, edits), file("#1=A();\r\n#3=C(); \r\n"));
        let edits = append(&structure, vec!["#5=E();".into(), "#6=F();".into()]).expect("a data section");
        let expected = file("#1=A();\r\n  #2=B(\r\n1);  \r\n#3=C(); #4=D();\r\n#5=E();\r\n#6=F();\r\n");
        assert_eq!(patched(&text, edits), expected);
    }

    #[test]
    fn new_records_stand_before_endsec_of_the_last_data_section() {
        let text = "ISO-10303-21;HEADER;ENDSEC;DATA;#1=A();ENDSEC;DATA;#2=B();ENDSEC;END-ISO-10303-21;";
        let edits = append(&read(text), vec!["#3=C();".into()]).expect("a data section");
        assert_eq!(patched(text, edits), text.replace("#2=B();", "#2=B();#3=C();"));
        assert_eq!(append(&read("ISO-10303-21;END-ISO-10303-21;"), vec!["#3=C();".into()]), None);
    }
}
