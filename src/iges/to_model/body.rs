//! Bodies and free curves in the order of the directory.
//!
//! A solid, a shell of its own, and a group of loose faces is each a body; a loose face of no group is one by itself. Its
//! faces have a shell each: what meets is not joined here.

use std::collections::HashMap;

use super::builder::{Builder, of_body, origin};
use super::code::ModelCode;
use super::curve;
use super::presentation::{attributes, name};
use super::roots::{Root, Roots};
use super::topology::{Shared, Taken};
use crate::brep::{Arena, Body, BodyId, BodyKind, CurveId};
use crate::geometry::{Carried, Curve};
use crate::iges::{EntryNumber, Instance};
use crate::math::Affine;
use crate::model::{Attributes, BodyAttributes};

/// The bodies that were built, beside the topology in the builder.
#[derive(Default)]
pub(super) struct Bodies {
    pub(super) attributes: Arena<BodyId, BodyAttributes>,
    pub(super) free_curves: Vec<CurveId>,
    pub(super) free_curve_names: Vec<String>,
    /// Entity that puts each body into a subfigure: its own, or for a group's body the first face's.
    pub(super) placed_by: Arena<BodyId, EntryNumber>,
    groups: HashMap<EntryNumber, BodyId>,
    taken: Taken,
}

impl Bodies {
    /// Builds everything that stands in the file.
    pub(super) fn build(&mut self, builder: &mut Builder<'_, '_>, roots: &Roots) {
        for &(number, root) in &roots.all {
            let Ok(instance) = builder.scope.instance(number) else { continue };
            match root {
                Root::Solid => self.solid(builder, roots, instance),
                Root::Shell => self.shell(builder, roots, instance),
                Root::Face | Root::Surface => self.loose_face(builder, roots, instance),
                Root::Curve => self.free_curve(builder, instance),
                Root::Unread => {
                    let message = format!("{}: not read yet", builder.scope.name(number));
                    builder.report(ModelCode::NotReadYet, number, message);
                }
                Root::Definition | Root::Use => {}
            }
        }
    }

    fn open(
        &mut self,
        builder: &mut Builder<'_, '_>,
        number: EntryNumber,
        by: EntryNumber,
        kind: BodyKind,
        own: Attributes,
    ) -> BodyId {
        builder.origins.bodies.push(origin(number));
        self.attributes.push(BodyAttributes { own, product: None });
        self.placed_by.push(by);
        builder.brep.bodies.push(Body { kind, shells: Vec::new() })
    }

    fn solid(&mut self, builder: &mut Builder<'_, '_>, roots: &Roots, instance: Instance<'_>) {
        let number = instance.number();
        let own = attributes(&builder.scope, roots, instance, builder.sink);
        let body = self.open(builder, number, number, BodyKind::Solid, own);
        match builder.solid(number, body, roots, &mut self.taken) {
            Ok(shells) => builder.brep.bodies[body].shells = shells,
            Err(error) => builder.report_topology(number, &error),
        }
    }

    fn shell(&mut self, builder: &mut Builder<'_, '_>, roots: &Roots, instance: Instance<'_>) {
        let number = instance.number();
        let own = attributes(&builder.scope, roots, instance, builder.sink);
        let body = self.open(builder, number, number, BodyKind::Surface, own);
        let mut shared = Shared::new(Affine::identity());
        let shell = builder.shell(number, body, true, roots, &mut shared, &mut self.taken);
        builder.brep.bodies[body].shells.extend(shell);
    }

    fn loose_face(&mut self, builder: &mut Builder<'_, '_>, roots: &Roots, instance: Instance<'_>) {
        let number = instance.number();
        let group = roots.groups.get(&number).copied();
        let body = match group.and_then(|group| self.groups.get(&group)) {
            Some(body) => *body,
            None => {
                let named = group.and_then(|group| builder.scope.file.instance(group));
                let own = named
                    .map(|group| Attributes { name: name(&builder.scope, group), ..Attributes::default() });
                let of = group.unwrap_or(number);
                self.open(builder, of, number, BodyKind::Surface, own.unwrap_or_default())
            }
        };
        if let Some(group) = group {
            self.groups.insert(group, body);
        }
        let shell = builder.push_shell(number, of_body(body, false, true));
        builder.brep.bodies[body].shells.push(shell);
        let own = attributes(&builder.scope, roots, instance, builder.sink);
        let face = builder.loose_face(instance, shell, own);
        builder.brep.shells[shell].faces.push(face);
    }

    fn free_curve(&mut self, builder: &mut Builder<'_, '_>, instance: Instance<'_>) {
        let number = instance.number();
        let curve: Carried<Curve> = match curve::read(&builder.scope, number, &Affine::identity()) {
            Ok(piece) => Carried::Read(piece.bounded()),
            Err(error) => {
                builder.report_geometry(number, number, &error);
                Carried::Unread { entity: builder.scope.name(number).to_owned(), reason: error.to_string() }
            }
        };
        let id = builder.push_curve(number, curve);
        self.free_curves.push(id);
        self.free_curve_names.push(name(&builder.scope, instance));
    }
}
