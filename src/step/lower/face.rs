//! New faces, with the shell, name, style and layers of the face that they stand beside; and faces that go, with
//! what speaks of nothing but them.

use super::super::entity::Entity;
use super::super::exchange_structure::{Instance, InstanceName};
use super::super::view::EntityView;
use super::compose::{Body, Inherited, Value, verbatim};
use super::edge::{Ground, Owner, PcurveUses, gather};
use super::list::places;
use super::{LowerError, Lowering};
use crate::brep::{Arena, FaceId};
use crate::model::change_set::{NewEdgeId, NewFace, NewSurface};
use crate::model::{ChangeSet, Model};

/// Keyword of the list of everything styled; not in the tables, because nothing of it is read.
const STYLED_LIST: [&[u8]; 2] = [
    b"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION",
    b"MECHANICAL_DESIGN_PRESENTATION_REPRESENTATION_WITH_DRAUGHTING",
];

impl<'a> Lowering<'a> {
    /// Writes everything that comes and goes. The surfaces of old faces must be decided already.
    pub(super) fn topology(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        let mut grounds = Vec::new();
        for (k, face) in changes.new_faces.iter().enumerate() {
            grounds.push(self.new_ground(k, face, changes)?);
        }
        let mut uses: PcurveUses<'_> = changes.new_edges.iter().map(|_| Vec::new()).collect();
        for (&face, bounds) in &changes.new_bounds {
            gather(&mut uses, self.ground(face, changes)?, bounds);
        }
        for (face, &ground) in changes.new_faces.iter().zip(&grounds) {
            gather(&mut uses, ground, &face.bounds);
        }
        let edges = self.new_edges(changes, &uses)?;
        self.bounds_of_old_faces(changes, &edges)?;
        for (face, ground) in changes.new_faces.iter().zip(&grounds) {
            self.new_face(face, ground.surface, &edges)?;
        }
        for &face in &changes.removed_faces {
            let name = super::instance_name(self.model.origins.faces[face])?;
            self.retire(name)?;
        }
        Ok(())
    }

    /// The surface that a face of the model will have.
    fn ground<'c>(&self, face: FaceId, changes: &'c ChangeSet) -> Result<Ground<'c>, LowerError>
    where
        'a: 'c,
    {
        let model: &'a Model = self.model;
        let surface = match self.own_surfaces.get(&face) {
            Some(name) => *name,
            None => super::instance_name(model.origins.surfaces[model.brep.faces[face].surface])?,
        };
        let geometry = changes.surfaces.get(&face).or_else(|| model.brep.surface_of(face).read());
        Ok(Ground { owner: Owner::Old(face), surface, face, geometry })
    }

    /// The surface of a new face, appended where it is its own.
    fn new_ground<'c>(
        &mut self,
        number: usize,
        face: &'c NewFace,
        changes: &'c ChangeSet,
    ) -> Result<Ground<'c>, LowerError>
    where
        'a: 'c,
    {
        let owner = Owner::New(number);
        match &face.surface {
            NewSurface::Own(surface) => {
                let beside = super::instance_name(self.model.origins.faces[face.beside])?;
                let radians = self.radians_of(face.beside);
                let body = self.surface_body(beside, surface, radians, &Inherited::nothing())?;
                let name = self.append(&body)?;
                Ok(Ground { owner, surface: name, face: face.beside, geometry: Some(surface) })
            }
            NewSurface::Of(old) => {
                let ground = self.ground(*old, changes)?;
                self.gain(ground.surface);
                Ok(Ground { owner, ..ground })
            }
        }
    }

    fn new_face(
        &mut self,
        face: &NewFace,
        surface: InstanceName,
        edges: &Arena<NewEdgeId, InstanceName>,
    ) -> Result<(), LowerError> {
        let beside = super::instance_name(self.model.origins.faces[face.beside])?;
        let mut bounds = Vec::new();
        for bound in &face.bounds {
            bounds.push(Value::Reference(self.append_bound(bound, false, edges)?));
        }
        let values = vec![
            verbatim(&self.raw(beside, "name", "''")),
            Value::List(bounds),
            Value::Reference(surface),
            verbatim(if face.same_sense { ".T." } else { ".F." }),
        ];
        let name = self.append(&Body::simple("ADVANCED_FACE", values))?;
        let shell = self.model.origins.shells[self.model.brep.faces[face.beside].shell];
        let (position, list) = self.list(super::instance_name(shell)?, "cfs_faces")?;
        self.lists.add(position, list, name);
        self.inherit_presentation(beside, name)
    }

    /// Puts a new record on the layers of an old one and gives it copies of its styles.
    fn inherit_presentation(&mut self, old: InstanceName, new: InstanceName) -> Result<(), LowerError> {
        for user in self.users_of(old) {
            if is(user, Entity::PresentationLayerAssignment) {
                self.join(user, old, new);
            } else if is(user, Entity::StyledItem) && !is(user, Entity::ContextDependentOverRidingStyledItem)
            {
                let copy = self.copy(user, old, new)?;
                for list in self.users_of(user.name()) {
                    self.join(list, user.name(), copy);
                }
            }
        }
        Ok(())
    }

    /// Lists a record beside another wherever a record lists that one.
    fn join(&mut self, user: Instance<'_>, beside: InstanceName, new: InstanceName) {
        for list in places(user, beside).into_iter().filter_map(|place| place.list) {
            self.lists.add(user.position(), list, new);
        }
    }

    /// Appends a copy of a record that speaks of another one.
    fn copy(
        &mut self,
        record: Instance<'_>,
        old: InstanceName,
        new: InstanceName,
    ) -> Result<InstanceName, LowerError> {
        let unwritable =
            LowerError::Unwritable { name: record.name(), kind: "style in bytes that are no text" };
        let body = record.body_span();
        let (mut text, mut at) = (String::new(), body.start);
        let mut ends: Vec<_> = places(record, old).into_iter().map(|place| place.token).collect();
        ends.sort_unstable();
        for token in ends.iter().copied().map(Some).chain([None]) {
            let upto = token.map_or(body.end, |token| token.start);
            let bytes = self.structure.source().slice(crate::source::Span::new(at, upto));
            text.push_str(std::str::from_utf8(bytes).map_err(|_| unwritable.clone())?);
            if let Some(token) = token {
                text.push_str(&new.to_string());
                at = token.end;
            }
        }
        for (target, _) in
            super::super::reverse_index::references(record).filter(|(target, _)| *target != old)
        {
            self.gain(target);
        }
        let name = InstanceName(self.names.allocate()?);
        self.appended.push(format!("{name}={text};"));
        Ok(name)
    }

    /// Takes a record out of everything that speaks of it. What spoke of nothing else goes too.
    fn retire(&mut self, record: InstanceName) -> Result<(), LowerError> {
        let mut open = vec![record];
        while let Some(name) = open.pop() {
            if !self.retired.insert(name) {
                continue;
            }
            for user in self.users_of(name) {
                if self.leave(user.name(), name)? {
                    open.push(user.name());
                }
            }
        }
        Ok(())
    }

    /// Takes a record out of one that refers to it. Gives whether that one has nothing left to say.
    pub(super) fn leave(&mut self, user: InstanceName, name: InstanceName) -> Result<bool, LowerError> {
        let instance = self.structure.instance(user).ok_or(LowerError::Unresolved { name: user })?;
        let mut spent = false;
        for place in places(instance, name) {
            self.lose(name);
            spent |= place.list.is_none_or(|list| self.lists.remove(instance.position(), list, place.token));
        }
        if spent && !goes_with_its_item(instance) {
            let line = self.structure.source().position(instance.span().start).line;
            let entity = String::from_utf8_lossy(instance.keyword().unwrap_or(b"a record")).into_owned();
            return Err(LowerError::StillNeeded { name, user, entity, line });
        }
        Ok(spent)
    }

    fn users_of(&self, name: InstanceName) -> Vec<Instance<'a>> {
        let users = self.users.users(self.structure, name).iter();
        users.filter_map(|&user| self.structure.instance_at(user)).collect()
    }
}

fn is(instance: Instance<'_>, entity: Entity) -> bool {
    EntityView::of(instance).is_some_and(|view| view.is(entity))
}

/// Records that say how others look or are turned, and nothing else.
fn goes_with_its_item(instance: Instance<'_>) -> bool {
    const FOLLOWING: [Entity; 4] =
        [Entity::StyledItem, Entity::PresentationLayerAssignment, Entity::Invisibility, Entity::OrientedFace];
    FOLLOWING.iter().any(|&entity| is(instance, entity))
        || STYLED_LIST.iter().any(|keyword| instance.record(keyword).is_some())
}
