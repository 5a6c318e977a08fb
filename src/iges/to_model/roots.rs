//! One pass over all entities that keeps those where meaning begins, and who is a part of whom.
//!
//! Most entities, curves first, have no parts and are looked at once here by their type alone.

use std::collections::HashMap;

use super::curve::PATHS;
use super::scope::kind;
use crate::iges::{Entity, EntityView, EntryNumber, ExchangeStructure, Instance};

/// What begins at an entity that is no part of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Root {
    /// A solid.
    Solid,
    /// A shell of no solid.
    Shell,
    /// A trimmed or bounded surface, or a bounded plane.
    Face,
    /// A surface within its own bounds.
    Surface,
    /// A curve.
    Curve,
    /// A definition of a subfigure.
    Definition,
    /// The use of one.
    Use,
    /// Geometry that is not read.
    Unread,
}

/// What stands in a file, by position.
#[derive(Debug, Default)]
pub(super) struct Roots {
    /// In the order of the directory.
    pub(super) all: Vec<(EntryNumber, Root)>,
    /// The group that holds an entity: the first, when several do.
    pub(super) groups: HashMap<EntryNumber, EntryNumber>,
    /// The subfigure definition that lists an entity.
    pub(super) definitions: HashMap<EntryNumber, EntryNumber>,
    /// Names of levels that the file gives.
    pub(super) levels: HashMap<i32, String>,
}

/// Forms of associativities that are groups.
const GROUPS: [i32; 4] = [1, 7, 14, 15];
/// Form of a property that says what a level is for.
const LEVEL_FUNCTION: i32 = 3;
/// Entity types of constructive solids, arrays, networks and instances of solids.
const UNREAD: [i32; 17] =
    [150, 152, 154, 156, 158, 160, 162, 164, 168, 180, 182, 184, 412, 414, 416, 420, 430];

impl Roots {
    pub(super) fn find(file: &ExchangeStructure) -> Self {
        let mut roots = Self::default();
        let mut part = vec![false; file.len() as usize];
        for instance in file.instances() {
            roots.look(instance, &mut part);
        }
        for instance in file.instances().filter(|instance| !part[instance.position() as usize]) {
            if let Some(root) = root(instance) {
                roots.all.push((instance.number(), root));
            }
        }
        roots
    }

    /// Notes what an entity is made of, or gathers.
    fn look(&mut self, instance: Instance<'_>, part: &mut [bool]) {
        let Some(entity) = kind(instance) else { return };
        match entity {
            Entity::CompositeCurve
            | Entity::Plane
            | Entity::RuledSurface
            | Entity::SurfaceOfRevolution
            | Entity::TabulatedCylinder
            | Entity::OffsetCurve
            | Entity::OffsetSurface
            | Entity::Boundary
            | Entity::CurveOnSurface
            | Entity::BoundedSurface
            | Entity::TrimmedSurface
            | Entity::ManifoldSolid
            | Entity::EdgeList
            | Entity::Loop
            | Entity::Face
            | Entity::Shell => {
                let Some(view) = EntityView::of(instance) else { return };
                for (number, _) in view.pointers() {
                    if let Some(position) = instance.structure().position(number) {
                        part[position as usize] = true;
                    }
                }
            }
            Entity::Associativity if GROUPS.contains(&instance.entry().form) => {
                gather(instance, &mut self.groups);
            }
            Entity::SubfigureDefinition => gather(instance, &mut self.definitions),
            Entity::Property if instance.entry().form == LEVEL_FUNCTION => {
                let name = EntityView::of(instance).map(|view| view.fields().text("description"));
                if let Some(name) = name.filter(|name| !name.is_empty()) {
                    self.levels.entry(instance.entry().level).or_insert(name);
                }
            }
            _ => {}
        }
    }
}

fn gather(instance: Instance<'_>, into: &mut HashMap<EntryNumber, EntryNumber>) {
    let Some(view) = EntityView::of(instance) else { return };
    for member in view.fields().list("members").filter_map(|member| member.as_pointer()) {
        into.entry(member).or_insert(instance.number());
    }
}

/// Entity use of a geometry that is shown: geometry itself, and construction geometry.
const GEOMETRY: [u8; 3] = [0, 3, 6];

fn root(instance: Instance<'_>) -> Option<Root> {
    let entry = instance.entry();
    if UNREAD.contains(&entry.entity_type) {
        return Some(Root::Unread);
    }
    match kind(instance)? {
        Entity::ManifoldSolid => Some(Root::Solid),
        Entity::Shell => Some(Root::Shell),
        Entity::TrimmedSurface | Entity::BoundedSurface => Some(Root::Face),
        Entity::Plane
            if entry.form == 1
                && EntityView::of(instance)?.fields().optional_pointer("boundary").is_some() =>
        {
            Some(Root::Face)
        }
        Entity::SubfigureDefinition => Some(Root::Definition),
        Entity::SubfigureInstance => Some(Root::Use),
        Entity::CopiousData if !PATHS.contains(&entry.form) => None,
        entity if entity.is_curve() => GEOMETRY.contains(&entry.status.usage).then_some(Root::Curve),
        Entity::Plane
        | Entity::PlaneSurface
        | Entity::CylindricalSurface
        | Entity::ConicalSurface
        | Entity::SphericalSurface
        | Entity::ToroidalSurface => None,
        entity if entity.is_surface() => GEOMETRY.contains(&entry.status.usage).then_some(Root::Surface),
        _ => None,
    }
}
