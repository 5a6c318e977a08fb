//! Who refers to whom, the other way round.
//!
//! One compressed table over the whole file, built in two passes over its text on demand; the file's
//! own references stay where they are. References to names without record are not counted.

use std::collections::BTreeSet;

use memchr::memchr3;

use super::exchange_structure::{ExchangeStructure, Instance, InstanceName};
use super::{Code, syntax};
use crate::diagnostic::Sink;
use crate::exchange::Users;
use crate::source::Span;

/// Users of each instance, by position in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReverseIndex(Users);

impl ReverseIndex {
    /// Builds the table. Linear in the file.
    #[must_use]
    pub fn build(structure: &ExchangeStructure) -> Self {
        Self(Users::of(structure.len(), |found| {
            for instance in structure.instances() {
                for target in references(instance).filter_map(|(name, _)| structure.position(name)) {
                    found(target, instance.position());
                }
            }
        }))
    }

    /// Positions of the instances that refer to the instance at `position`, ascending, each once.
    #[must_use]
    pub fn users_at(&self, position: u32) -> &[u32] {
        self.0.at(position)
    }

    /// Positions of the instances that refer to an instance, ascending, each once.
    #[must_use]
    pub fn users(&self, structure: &ExchangeStructure, name: InstanceName) -> &[u32] {
        structure.position(name).map_or(&[], |position| self.users_at(position))
    }

    /// How many instances refer to an instance.
    #[must_use]
    pub fn count(&self, structure: &ExchangeStructure, name: InstanceName) -> usize {
        self.users(structure, name).len()
    }
}

/// Positions of the instances that anchors export.
pub(super) fn anchored(structure: &ExchangeStructure) -> BTreeSet<u32> {
    let names = structure.anchors().flat_map(|(_, item)| References { bytes: item, at: 0 });
    names.filter_map(|(name, _)| structure.position(name?)).collect()
}

/// Reports every reference to a name that neither a record nor the reference section defines.
pub fn unresolved_references(structure: &ExchangeStructure, sink: &mut dyn Sink) {
    let external: BTreeSet<InstanceName> =
        structure.references().filter_map(|(name, _)| InstanceName::parse(name)).collect();
    for instance in structure.instances() {
        for (target, span) in written(instance) {
            let Some(target) = target else {
                let message =
                    format!("refers to a name of {} digits, more than 64 bits hold", span.len() - 1);
                sink.report(Code::InstanceNameTooLarge.note_on(instance.name(), span, message));
                continue;
            };
            if structure.position(target).is_none() && !external.contains(&target) {
                let message = format!("refers to {target}, which the file does not define");
                sink.report(Code::UnresolvedReference.note_on(instance.name(), span, message));
            }
        }
    }
}

/// Every reference of an instance with its place, in the order of its text, repetitions included.
pub fn references(instance: Instance<'_>) -> impl Iterator<Item = (InstanceName, Span)> {
    written(instance).filter_map(|(name, span)| Some((name?, span)))
}

fn written(instance: Instance<'_>) -> References<'_> {
    let (start, end) = instance.body();
    References { bytes: &instance.bytes()[..end], at: start }
}

/// The `#n` of a text, outside strings and comments; without name where 64 bits cannot hold it.
struct References<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Iterator for References<'_> {
    type Item = (Option<InstanceName>, Span);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            self.at += memchr3(b'#', b'\'', b'/', self.bytes.get(self.at..)?)?;
            let start = self.at;
            match self.bytes[start] {
                b'#' => {
                    self.at = crate::number::digits_end(self.bytes, start + 1);
                    if self.at > start + 1 {
                        let name = InstanceName::parse(&self.bytes[start..self.at]);
                        return Some((name, syntax::span(start, self.at)));
                    }
                }
                b'\'' => self.at = syntax::string_end(self.bytes, start)?,
                _ => self.at = syntax::comment_end(self.bytes, start).unwrap_or(start + 1),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    fn read(data: &str) -> ExchangeStructure {
        let text =
            format!("ISO-10303-21;HEADER;ENDSEC;ANCHOR;<x>=#90;ENDSEC;DATA;{data}ENDSEC;END-ISO-10303-21;");
        ExchangeStructure::parse(Source::new(text.into_bytes()).expect("small"), &mut Vec::new())
    }

    #[test]
    fn users_are_each_counted_once_and_text_in_strings_not_at_all() {
        let structure = read("#1=A();#2=B(#1,(#1,#3));#3=C('#1',/*#1*/#1);#4=D(#77);");
        let index = ReverseIndex::build(&structure);
        assert_eq!(index.users(&structure, InstanceName(1)), [1, 2]);
        assert_eq!(index.users(&structure, InstanceName(3)), [1]);
        assert_eq!(index.count(&structure, InstanceName(2)), 0);
        assert_eq!(index.users(&structure, InstanceName(77)), [0_u32; 0]);
    }

    #[test]
    fn a_reference_of_forty_digits_and_an_open_parenthesis_are_reported() {
        let structure = read(&format!("#1=A(#{});#2=B((1.,2.);#3=C();", "1".repeat(40)));
        let mut sink = Vec::new();
        structure.unresolved_references(&mut sink);
        structure.damaged_records(&mut sink);
        let found: Vec<_> = sink.iter().map(|fact| (fact.code, fact.entity.as_deref())).collect();
        let expected = [("step.instance-name-too-large", Some("#1")), ("step.damaged-record", Some("#2"))];
        assert_eq!(found, expected);
    }

    #[test]
    fn dangling_references_are_named_with_their_record() {
        let structure = read("#1=A(#2,#3);#3=B();#90=C();");
        let mut sink = Vec::new();
        structure.unresolved_references(&mut sink);
        assert_eq!(sink.len(), 1);
        assert_eq!(sink[0].entity.as_deref(), Some("#1"));
        assert_eq!(structure.source().slice(sink[0].span.expect("a place")), b"#2");
    }
}
