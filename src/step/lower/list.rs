//! Members that come to and go from lists of references. Each list is edited once, when everything is known.

use std::collections::{BTreeMap, BTreeSet};

use super::super::exchange_structure::{Instance, InstanceName};
use super::super::parameter::{Parameter, Parameters};
use crate::exchange::Edit;
use crate::source::{LineEnding, Span};

/// New members on one line.
const PER_LINE: usize = 8;

/// Where a record refers to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place<'a> {
    /// The reference.
    pub(super) token: Span,
    /// The list that it is a member of; `None` where it is an attribute of its own.
    pub(super) list: Option<Parameter<'a>>,
}

/// Every place where a record refers to `target`.
pub(super) fn places<'a>(instance: Instance<'a>, target: InstanceName) -> Vec<Place<'a>> {
    let mut found = Vec::new();
    let mut open: Vec<(Parameters<'a>, Option<Parameter<'a>>)> =
        instance.records().map(|record| (record.parameters(), None)).collect();
    while let Some((members, list)) = open.pop() {
        for member in members {
            if member.as_reference() == Some(target) {
                found.push(Place { token: member.span(), list });
            }
            if let Some(inner) = member.members() {
                // A typed value holds its own parentheses, and is no list that may lose a member.
                open.push((inner, member.as_list().map(|_| member)));
            }
        }
    }
    found
}

/// All lists that change, by their place, with their owner.
#[derive(Debug, Default)]
pub(super) struct ListEdits(BTreeMap<Span, ListEdit>);

#[derive(Debug)]
struct ListEdit {
    owner: u32,
    members: Vec<Span>,
    gone: BTreeSet<Span>,
    new: Vec<InstanceName>,
}

impl ListEdits {
    fn of(&mut self, owner: u32, list: Parameter<'_>) -> &mut ListEdit {
        self.0.entry(list.span()).or_insert_with(|| {
            let members = list.as_list().into_iter().flatten().map(|member| member.span()).collect();
            ListEdit { owner, members, gone: BTreeSet::new(), new: Vec::new() }
        })
    }

    /// A member comes to the end of a list of the record at `owner`.
    pub(super) fn add(&mut self, owner: u32, list: Parameter<'_>, member: InstanceName) {
        self.of(owner, list).new.push(member);
    }

    /// A member goes. Gives whether the list is empty then.
    pub(super) fn remove(&mut self, owner: u32, list: Parameter<'_>, member: Span) -> bool {
        let edit = self.of(owner, list);
        edit.gone.insert(member);
        edit.new.is_empty() && edit.gone.len() == edit.members.len()
    }

    /// Edits of all lists but those of owners that are no more.
    pub(super) fn finish(self, removed: &BTreeSet<u32>, ending: LineEnding) -> Vec<Edit> {
        let staying = self.0.into_iter().filter(|(_, edit)| !removed.contains(&edit.owner));
        staying.flat_map(|(list, edit)| edit.edits(list, ending)).collect()
    }
}

impl ListEdit {
    fn edits(&self, list: Span, ending: LineEnding) -> Vec<Edit> {
        let Some(first) = self.members.iter().position(|member| !self.gone.contains(member)) else {
            let text = self.text(ending);
            let inside = Span::new(list.start + 1, list.end - 1);
            return vec![Edit::replace(inside, text.trim_start_matches([',', '\r', '\n']))];
        };
        let mut edits = Vec::new();
        if first > 0 {
            edits.push(Edit::remove(Span::new(self.members[0].start, self.members[first].start)));
        }
        for pair in self.members[first..].windows(2).filter(|pair| self.gone.contains(&pair[1])) {
            edits.push(Edit::remove(Span::new(pair[0].end, pair[1].end)));
        }
        // Before the list's closing parenthesis.
        edits.push(Edit::insert(list.end - 1, self.text(ending)));
        edits
    }

    /// The new members, each behind a comma.
    fn text(&self, ending: LineEnding) -> String {
        let mut text = String::new();
        for (k, name) in self.new.iter().enumerate() {
            let next_line = if k > 0 && k % PER_LINE == 0 { ending.as_str() } else { "" };
            text.push_str(&format!(",{next_line}{name}"));
        }
        text
    }
}
