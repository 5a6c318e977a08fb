//! Changed records set anew on their lines, as few of them as possible.
//!
//! A line whose values stay is not touched. One whose new values do not fit is cut behind delimiters into several. Lines
//! that a value ties together, since it runs over the end of one, are set as one.

use std::collections::BTreeMap;
use std::ops::Range;

use super::parameter::{Parameters, Place, Text};
use super::write::{LineWriter, ParameterText};

/// What becomes of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum RecordChange {
    /// Parameters that go, by their start, and what comes for each.
    Values(BTreeMap<Place, Vec<ParameterText>>),
    /// All parameters are others.
    Whole(Vec<ParameterText>),
}

/// Lines of a record and what stands in their place, at least one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Relaid {
    /// Lines that go, by position in the record.
    pub(super) lines: Range<usize>,
    /// Data that comes, without blanks at the end.
    pub(super) data: Vec<Vec<u8>>,
}

/// A parameter with its delimiter.
struct Item {
    start: Place,
    /// Behind the value.
    end: Place,
    /// Behind the delimiter.
    stop: Place,
    delimiter: Option<u8>,
}

/// The lines of a record that change, in order; `width` is how many columns a line has.
pub(super) fn relaid(record: Parameters<'_>, width: usize, change: &RecordChange) -> Vec<Relaid> {
    let text = record.text();
    let items = items(record);
    match change {
        RecordChange::Values(values) => {
            let units = units(&items, values, text.lines.len());
            let layout = Layout { text, width, items: &items, values };
            units.into_iter().map(|unit| layout.unit(unit)).collect()
        }
        RecordChange::Whole(parameters) => vec![whole(text, width, &items, parameters)],
    }
}

fn items(mut record: Parameters<'_>) -> Vec<Item> {
    let mut items = Vec::new();
    while let Some(parameter) = record.next() {
        let delimiter = record.passed_delimiter();
        // A record without an end ends with its value.
        let stop = if delimiter.is_some() { record.place() } else { parameter.end() };
        items.push(Item { start: parameter.start(), end: parameter.end(), stop, delimiter });
    }
    items
}

/// Runs of lines that changed values tie together.
fn units(items: &[Item], values: &BTreeMap<Place, Vec<ParameterText>>, lines: usize) -> Vec<Range<usize>> {
    let mut tied = vec![false; lines];
    for item in items {
        tied[item.start.line as usize..item.stop.line as usize].fill(true);
    }
    let mut units: Vec<Range<usize>> = Vec::new();
    for start in values.keys() {
        let line = start.line as usize;
        if units.last().is_some_and(|unit| unit.contains(&line)) {
            continue;
        }
        let first = (0..line).rev().take_while(|before| tied[*before]).last().unwrap_or(line);
        let last = (line..lines).find(|at| !tied[*at]).unwrap_or(lines - 1);
        units.push(first..last + 1);
    }
    units
}

struct Layout<'a> {
    text: Text<'a>,
    width: usize,
    items: &'a [Item],
    values: &'a BTreeMap<Place, Vec<ParameterText>>,
}

impl Layout<'_> {
    fn unit(&self, lines: Range<usize>) -> Relaid {
        let first = self.items.partition_point(|item| (item.start.line as usize) < lines.start);
        let end = self.items.partition_point(|item| (item.start.line as usize) < lines.end);
        let items = &self.items[first..end];
        if lines.len() == 1 {
            let line = self.spliced(self.text.line(lines.start), items);
            // A line of the compressed form may be longer than it should.
            if line.len() <= self.width.max(self.text.line(lines.start).len()) {
                return Relaid { lines, data: vec![line] };
            }
        }
        let mut writer = LineWriter::new(self.width);
        for item in items {
            match self.values.get(&item.start) {
                Some(new) => place(&mut writer, new, self.between(), item.delimiter),
                None => writer.value(&piece(self.text, item.start, item.end), item.delimiter),
            }
        }
        if let Some(last) = items.last() {
            writer.flow(comment(self.text, last));
        }
        Relaid { lines, data: writer.finish() }
    }

    /// Delimiter between parameters, as the record has it.
    fn between(&self) -> u8 {
        self.text.delimiters.parameter
    }

    /// The line with its new values in the place of the old ones.
    fn spliced(&self, line: &[u8], items: &[Item]) -> Vec<u8> {
        let mut out = Vec::with_capacity(line.len());
        let mut at = 0;
        for item in items {
            let Some(new) = self.values.get(&item.start) else { continue };
            out.extend_from_slice(&line[at..item.start.column as usize]);
            out.extend(new.join(&self.between()));
            at = item.end.column as usize;
        }
        out.extend_from_slice(&line[at..]);
        let blanks = out.iter().rev().take_while(|byte| **byte == b' ').count();
        out.truncate(out.len() - blanks);
        out
    }
}

fn place(writer: &mut LineWriter, values: &[ParameterText], between: u8, delimiter: Option<u8>) {
    for (at, value) in values.iter().enumerate() {
        let last = at + 1 == values.len();
        writer.value(value, if last { delimiter } else { Some(between) });
    }
}

/// The bytes between two places of a text.
fn piece(text: Text<'_>, start: Place, end: Place) -> Vec<u8> {
    let mut bytes = Vec::new();
    for line in start.line..=end.line {
        let all = text.line(line as usize);
        let from = if line == start.line { start.column as usize } else { 0 };
        let to = if line == end.line { end.column as usize } else { all.len() };
        bytes.extend_from_slice(all.get(from..to).unwrap_or_default());
    }
    bytes
}

/// What stands behind the record delimiter on its line, without blanks at the end.
fn comment<'a>(text: Text<'a>, last: &Item) -> &'a [u8] {
    if last.delimiter != Some(text.delimiters.record) {
        return &[];
    }
    let line = text.line(last.stop.line as usize);
    line.get(last.stop.column as usize..).unwrap_or_default().trim_ascii_end()
}

fn whole(text: Text<'_>, width: usize, items: &[Item], parameters: &[ParameterText]) -> Relaid {
    let mut writer = LineWriter::new(width);
    place(&mut writer, parameters, text.delimiters.parameter, Some(text.delimiters.record));
    let end = match items.last() {
        Some(last) => {
            writer.flow(comment(text, last));
            last.stop.line as usize + 1
        }
        None => text.lines.len(),
    };
    Relaid { lines: 0..end, data: writer.finish() }
}

#[cfg(test)]
mod tests {
    use super::super::parameter::Delimiters;
    use super::*;

    /// Lays a record out with new values for the parameters at some places, counted from 0.
    fn changed(lines: &[&str], new: &[(usize, &[&str])]) -> Vec<(Range<usize>, Vec<String>)> {
        let bytes: String = lines.iter().map(|line| format!("{line:64}\n")).collect();
        let starts: Vec<u32> = (0..lines.len()).map(|at| 65 * at as u32).collect();
        let record = Parameters::new(Text::of_cards(bytes.as_bytes(), &starts, Delimiters::default()));
        let all: Vec<_> = record.clone().collect();
        let value = |texts: &[&str]| texts.iter().map(|text| text.as_bytes().to_vec()).collect();
        let values = new.iter().map(|(at, texts)| (all[*at].start(), value(texts))).collect();
        let laid = relaid(record, 64, &RecordChange::Values(values));
        let text = |data: Vec<u8>| String::from_utf8(data).expect("ASCII");
        laid.into_iter().map(|unit| (unit.lines, unit.data.into_iter().map(text).collect())).collect()
    }

    #[test]
    fn values_that_fit_change_their_line_alone() {
        let lines = ["126,  1.5 ,2.,", "3.,4.;note"];
        assert_eq!(
            changed(&lines, &[(1, &["0.1234567"])]),
            [(0..1, vec!["126,  0.1234567 ,2.,".to_owned()])]
        );
        assert_eq!(changed(&lines, &[(4, &["5.", "6."])]), [(1..2, vec!["3.,5.,6.;note".to_owned()])]);
        assert_eq!(changed(&lines, &[]), []);
    }

    #[test]
    fn a_line_that_overflows_is_cut_behind_a_delimiter() {
        let long = format!("{}1.;c", "1234567,".repeat(7));
        let new = "0.12345678901234567";
        let laid = changed(&["126,", &long, "more"], &[(3, &[new])]);
        let expected =
            vec![format!("1234567,1234567,{new},1234567,1234567,1234567,"), "1234567,1.;c".to_owned()];
        assert_eq!(laid, [(1..2, expected)]);
    }

    #[test]
    fn lines_tied_by_a_text_are_set_as_one() {
        let first = format!("406,2,{}70H{}", " ".repeat(40), "a".repeat(15));
        let second = format!("{},1.;", "a".repeat(55));
        let laid = changed(&[&first, &second], &[(3, &["0.12345678"])]);
        let expected =
            vec![format!("406,2,70H{}", "a".repeat(55)), format!("{},0.12345678;", "a".repeat(15))];
        assert_eq!(laid, [(0..2, expected)]);
    }

    #[test]
    fn a_record_without_an_end_stays_without() {
        let laid = changed(&["116,1.,2.,", "3."], &[(3, &["7."])]);
        assert_eq!(laid, [(1..2, vec!["7.".to_owned()])]);
    }
}
