//! Statements about a shape: numbers that get new values, and properties that go.

use super::super::edit;
use super::super::entity::Entity;
use super::super::exchange_structure::InstanceName;
use super::super::reverse_index::references;
use super::super::view::EntityView;
use super::compose::{Body, Value};
use super::{LowerError, Lowering, instance_name};
use crate::model::ChangeSet;

impl Lowering<'_> {
    /// Gives measures and points that state something their new numbers.
    pub(super) fn state(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        for (&origin, values) in &changes.stated {
            let item = instance_name(origin)?;
            let view = self.view(item).ok_or(LowerError::Unresolved { name: item })?;
            if !view.is(Entity::CartesianPoint) {
                let [value] = values[..] else {
                    return Err(LowerError::Attribute { name: item, attribute: "value_component" });
                };
                self.edit_real(item, "value_component", value)?;
            } else if self.shape_uses(item) {
                self.state_apart(item, values)?;
            } else {
                self.edit_reals(item, "coordinates", values)?;
            }
        }
        Ok(())
    }

    /// Whether something else than a representation refers to a record.
    fn shape_uses(&mut self, item: InstanceName) -> bool {
        let users = self.users.users(self.structure, item).iter();
        let mut views = users.map(|&user| self.structure.instance_at(user).and_then(EntityView::of));
        views.any(|view| !view.is_some_and(|view| view.is(Entity::Representation)))
    }

    /// A point that is also a point of the shape stays; the statement gets one of its own, of the same name.
    fn state_apart(&mut self, item: InstanceName, values: &[f64]) -> Result<(), LowerError> {
        let name = Value::Verbatim(self.raw(item, "name", "''"));
        let numbers = Value::List(values.iter().map(|&value| Value::Real(value)).collect());
        let new = self.append(&Body::simple("CARTESIAN_POINT", vec![name, numbers]))?;
        for user in self.users.users(self.structure, item).to_vec() {
            let Some(view) = self.structure.instance_at(user).and_then(EntityView::of) else { continue };
            if !view.is(Entity::Representation) {
                continue;
            }
            for (token, target) in self.references(view.name(), "items").unwrap_or_default() {
                if target == item {
                    self.repoint(token, item, new);
                }
            }
        }
        Ok(())
    }

    /// Takes properties away with what ties them to their values; the values go with their last user. A property that
    /// something else refers to stays.
    pub(super) fn unstate(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        for &origin in &changes.unstated {
            let property = instance_name(origin)?;
            let users = self.users.users(self.structure, property).to_vec();
            let tie = |user: &u32| {
                let view = self.structure.instance_at(*user).and_then(EntityView::of);
                view.is_some_and(|view| view.is(Entity::PropertyDefinitionRepresentation))
            };
            let Some(position) = self.structure.position(property) else { continue };
            if !users.iter().all(tie) {
                continue;
            }
            for &user in &users {
                for (target, _) in self.structure.instance_at(user).into_iter().flat_map(references) {
                    self.lose(target);
                }
            }
            self.lost.remove(&property);
            self.edits.extend(edit::remove(self.structure, users.into_iter().chain([position])));
        }
        Ok(())
    }
}
