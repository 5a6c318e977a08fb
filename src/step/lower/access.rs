//! Reading attributes of records that are about to change, editing their values in place, and counting
//! who still needs them.

use std::collections::{BTreeMap, BTreeSet};

use super::super::edit;
use super::super::entity::Entity;
use super::super::exchange_structure::{ExchangeStructure, InstanceName};
use super::super::parameter::Parameter;
use super::super::reverse_index::{anchored, references};
use super::super::view::EntityView;
use super::super::write::RecordWriter;
use super::compose::{Body, Inherited};
use super::{LowerError, Lowering};
use crate::geometry::Surface;
use crate::geometry::nurbs::KnotVector;
use crate::number::format_real;
use crate::source::Span;

impl<'a> Lowering<'a> {
    pub(super) fn view(&self, name: InstanceName) -> Option<EntityView<'a>> {
        EntityView::of(self.structure.instance(name)?)
    }

    pub(super) fn attribute(
        &self,
        name: InstanceName,
        attribute: &'static str,
    ) -> Result<Parameter<'a>, LowerError> {
        let found = self.view(name).and_then(|view| view.get(attribute));
        found.ok_or(LowerError::Attribute { name, attribute })
    }

    /// A list, with the position of its record.
    pub(super) fn list(
        &self,
        name: InstanceName,
        attribute: &'static str,
    ) -> Result<(u32, Parameter<'a>), LowerError> {
        let list = self.attribute(name, attribute)?;
        let position = self.structure.position(name).ok_or(LowerError::Unresolved { name })?;
        list.as_list().map(|_| (position, list)).ok_or(LowerError::Attribute { name, attribute })
    }

    /// Where the value of an attribute stands.
    pub(super) fn attribute_span(
        &self,
        name: InstanceName,
        attribute: &'static str,
    ) -> Result<Span, LowerError> {
        self.attribute(name, attribute).map(|parameter| parameter.span())
    }

    /// The token and the target of a reference.
    pub(super) fn reference(
        &self,
        name: InstanceName,
        attribute: &'static str,
    ) -> Result<(Span, InstanceName), LowerError> {
        self.optional_reference(name, attribute)?.ok_or(LowerError::Attribute { name, attribute })
    }

    /// The token and the target of a reference, unless something else stands there.
    pub(super) fn optional_reference(
        &self,
        name: InstanceName,
        attribute: &'static str,
    ) -> Result<Option<(Span, InstanceName)>, LowerError> {
        let parameter = self.attribute(name, attribute)?;
        Ok(parameter.as_reference().map(|target| (parameter.span(), target)))
    }

    /// The first reference of a list.
    pub(super) fn first_reference(
        &self,
        name: InstanceName,
        attribute: &'static str,
    ) -> Result<(Span, InstanceName), LowerError> {
        let first = self.references(name, attribute).and_then(|list| list.first().copied());
        first.ok_or(LowerError::Attribute { name, attribute })
    }

    /// Tokens and targets of a list of references, or of a list of such lists, in order.
    pub(super) fn references(
        &self,
        name: InstanceName,
        attribute: &'static str,
    ) -> Option<Vec<(Span, InstanceName)>> {
        let parameter = self.attribute(name, attribute).ok()?;
        let mut found = Vec::new();
        for member in parameter.as_list()? {
            if let Some(target) = member.as_reference() {
                found.push((member.span(), target));
                continue;
            }
            for member in member.as_list()? {
                found.push((member.span(), member.as_reference()?));
            }
        }
        Some(found)
    }

    /// The numbers of a list with their tokens.
    fn real_tokens(&self, name: InstanceName, attribute: &'static str) -> Option<Vec<(Span, f64)>> {
        let parameter = self.attribute(name, attribute).ok()?;
        parameter.as_list()?.map(|member| Some((member.span(), member.as_f64()?))).collect()
    }

    /// The numbers of a list.
    pub(super) fn reals(&self, name: InstanceName, attribute: &'static str) -> Option<Vec<f64>> {
        Some(self.real_tokens(name, attribute)?.into_iter().map(|(_, value)| value).collect())
    }

    /// Whether a spline record writes these very knots, or is of a kind that implies clamped ones.
    pub(super) fn writes_knots(
        &self,
        name: InstanceName,
        multiplicities: &'static str,
        knots: &'static str,
        wanted: &KnotVector,
    ) -> bool {
        let (Some(counts), Some(values)) = (self.reals(name, multiplicities), self.reals(name, knots)) else {
            return self.view(name).is_some_and(|view| CLAMPED.iter().any(|&entity| view.is(entity)));
        };
        let (wanted_values, wanted_counts) = wanted.to_multiplicities();
        values == wanted_values && counts.iter().copied().eq(wanted_counts.iter().map(|&count| count as f64))
    }

    /// Whether the file already says these numbers, to the bit.
    pub(super) fn reads_as(&self, name: InstanceName, attribute: &'static str, wanted: &[f64]) -> bool {
        self.reals(name, attribute).is_some_and(|found| {
            found.len() == wanted.len() && found.iter().zip(wanted).all(|(a, b)| a.to_bits() == b.to_bits())
        })
    }

    /// Edits a number; one that reads back to the same bits keeps its spelling.
    pub(super) fn edit_real(
        &mut self,
        name: InstanceName,
        attribute: &'static str,
        value: f64,
    ) -> Result<(), LowerError> {
        let parameter = self.attribute(name, attribute)?;
        let old = parameter.as_f64().ok_or(LowerError::Attribute { name, attribute })?;
        if old.to_bits() != value.to_bits() {
            let text = match parameter.keyword() {
                Some(keyword) => {
                    format!("{}({})", String::from_utf8_lossy(keyword), format_real(value))
                }
                None => format_real(value),
            };
            self.edit(parameter.span(), text);
        }
        Ok(())
    }

    /// Edits the numbers of a list; those that read back to the same bits keep their spelling.
    pub(super) fn edit_reals(
        &mut self,
        name: InstanceName,
        attribute: &'static str,
        values: &[f64],
    ) -> Result<(), LowerError> {
        let tokens = self.real_tokens(name, attribute).ok_or(LowerError::Attribute { name, attribute })?;
        if tokens.len() != values.len() {
            return Err(LowerError::Attribute { name, attribute });
        }
        for ((span, old), &new) in tokens.into_iter().zip(values) {
            if old.to_bits() != new.to_bits() {
                self.edit(span, format_real(new));
            }
        }
        Ok(())
    }

    /// Replaces everything between `=` and `;` of a record. What it referred to loses a user.
    pub(super) fn rewrite(&mut self, name: InstanceName, body: &Body) -> Result<(), LowerError> {
        let instance = self.structure.instance(name).ok_or(LowerError::Unresolved { name })?;
        for (target, _) in references(instance) {
            self.lose(target);
        }
        let span = instance.body_span();
        let column = self.structure.source().position(span.start).column - 1;
        let mut writer = RecordWriter::parameter(column, self.ending);
        body.write(&mut writer);
        self.edit(span, writer.finish());
        Ok(())
    }

    /// Whether everything that depends on a record's shape is among `n_requests` references that ask for
    /// the new one. Presentation follows whatever stands behind a name, so it is not asked.
    pub(super) fn is_covered(&mut self, target: InstanceName, n_requests: usize) -> bool {
        let users: Vec<u32> = self.users.users(self.structure, target).to_vec();
        let mut dependent = 0;
        for user in users {
            if !self.is_presentation(user) {
                dependent += self.n_references(user, target);
            }
        }
        dependent == n_requests + self.n_lost(target)
    }

    fn n_lost(&self, target: InstanceName) -> usize {
        self.lost.get(&target).copied().unwrap_or(0)
    }

    /// How often the record at a position refers to `target`.
    fn n_references(&mut self, user: u32, target: InstanceName) -> usize {
        let structure = self.structure;
        let counts = self.repeated.entry(user).or_insert_with(|| repeated_references(structure, user));
        counts.get(&target).copied().unwrap_or(1)
    }

    fn is_presentation(&self, user: u32) -> bool {
        let view = self.structure.instance_at(user).and_then(EntityView::of);
        view.is_some_and(|view| PRESENTATION.iter().any(|&entity| view.is(entity)))
    }

    /// Removes every record that lost its last user, and what only it used, and so on. One that an anchor
    /// exports, or that nobody used before, stays.
    pub(super) fn remove_orphans(&mut self) {
        let exported = anchored(self.structure);
        let mut candidates: BTreeSet<InstanceName> = self.lost.keys().chain(&self.retired).copied().collect();
        let mut removed = BTreeSet::new();
        while let Some(name) = candidates.pop_first() {
            let Some(instance) = self.structure.instance(name) else { continue };
            let users: Vec<u32> = self.users.users(self.structure, name).to_vec();
            let n_users: usize = users.into_iter().map(|user| self.n_references(user, name)).sum();
            let orphan =
                self.n_lost(name) >= n_users && self.gained.get(&name).is_none_or(|&count| count == 0);
            let orphan = self.retired.contains(&name) || orphan && !exported.contains(&instance.position());
            if !orphan || !removed.insert(instance.position()) {
                continue;
            }
            for (target, _) in references(instance) {
                self.lose(target);
                candidates.insert(target);
            }
        }
        self.edits.extend(std::mem::take(&mut self.lists).finish(&removed, self.ending));
        self.edits.extend(edit::remove(self.structure, removed));
    }

    /// Raw text that a new curve takes over from the record that it replaces.
    pub(super) fn inherited_by_curve(&self, name: InstanceName) -> Inherited {
        let closed = self.raw(name, "closed_curve", ".U.");
        self.inherited(name, [closed.clone(), closed])
    }

    /// Raw text that a new surface takes over from the record that it replaces. Whether a spline is closed is its own to
    /// say where that record did not.
    pub(super) fn inherited_by_surface(&self, name: InstanceName, new: &Surface) -> Inherited {
        let closed = match new {
            Surface::Nurbs(spline) => {
                let tolerance = SAME_BORDER * spline.bounding_box().diagonal();
                [spline.is_closed_u(tolerance), spline.is_closed_v(tolerance)]
            }
            _ => [false, false],
        };
        let text = closed.map(|closed| if closed { ".T." } else { ".F." });
        self.inherited(name, [self.raw(name, "u_closed", text[0]), self.raw(name, "v_closed", text[1])])
    }

    fn inherited(&self, name: InstanceName, closed: [String; 2]) -> Inherited {
        Inherited {
            name: self.raw(name, "name", "''"),
            closed,
            self_intersect: self.raw(name, "self_intersect", ".U."),
        }
    }

    pub(super) fn raw(&self, name: InstanceName, attribute: &'static str, missing: &str) -> String {
        let span = self.attribute_span(name, attribute).ok();
        let text = span.and_then(|span| std::str::from_utf8(self.structure.source().slice(span)).ok());
        text.unwrap_or(missing).to_owned()
    }
}

/// Targets that the record at a position refers to more than once, with how often.
fn repeated_references(structure: &ExchangeStructure, user: u32) -> BTreeMap<InstanceName, usize> {
    let Some(instance) = structure.instance_at(user) else { return BTreeMap::new() };
    let mut all: Vec<InstanceName> = references(instance).map(|(target, _)| target).collect();
    all.sort_unstable();
    let runs = all.chunk_by(|a, b| a == b).filter(|run| run.len() > 1);
    runs.map(|run| (run[0], run.len())).collect()
}

/// Distance of opposite borders, as a part of a surface's size, at which it says of itself that it is closed.
const SAME_BORDER: f64 = 1e-9;

/// Splines without knots in the file whose implied knots are clamped.
const CLAMPED: [Entity; 4] =
    [Entity::QuasiUniformCurve, Entity::QuasiUniformSurface, Entity::BezierCurve, Entity::BezierSurface];

/// Users that speak of a record whatever its shape: style, layer, and tolerances that point at an item.
const PRESENTATION: [Entity; 2] = [Entity::StyledItem, Entity::PresentationLayerAssignment];
