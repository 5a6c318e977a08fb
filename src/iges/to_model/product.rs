//! Products: the file itself, and each definition of a subfigure (IGES 5.3 sections 4.92 and 4.133); its uses put it
//! where they are.

use std::collections::HashMap;

use super::body::Bodies;
use super::builder::{Builder, origin};
use super::code::ModelCode;
use super::error::ReadError;
use super::roots::{Root, Roots};
use super::scope::Scope;
use crate::iges::{Entity, EntryNumber};
use crate::math::{Affine, Vector3};
use crate::model::assembly::circular_occurrences;
use crate::model::{Appearance, Occurrence, Origin, PlacedShape, Product};
use crate::units::LengthUnit;

/// Products and their uses.
#[derive(Default)]
pub(super) struct Assembly {
    pub(super) products: Vec<Product>,
    pub(super) occurrences: Vec<Occurrence>,
    /// Product of each definition.
    of: HashMap<EntryNumber, usize>,
}

/// Place of the product that is the file.
const FILE: usize = 0;

impl Assembly {
    pub(super) fn read(
        builder: &mut Builder<'_, '_>,
        roots: &Roots,
        bodies: &mut Bodies,
        unit: &LengthUnit,
    ) -> Self {
        let mut assembly = Self::default();
        assembly.add_products(&builder.scope, roots, unit);
        assembly.add_uses(builder, roots);
        assembly.add_shapes(roots, bodies);
        assembly
    }

    fn add_products(&mut self, scope: &Scope<'_>, roots: &Roots, unit: &LengthUnit) {
        let product = |id: String, name: String, from: Origin| Product {
            id,
            name,
            origin: from,
            unit: Some(unit.clone()),
            shapes: Vec::new(),
            appearance: Appearance::default(),
            external: Vec::new(),
        };
        let global = scope.file.global();
        let named = if global.sender_product.is_empty() { &global.file_name } else { &global.sender_product };
        self.products.push(product(named.clone(), named.clone(), Origin::File));
        for &(number, root) in &roots.all {
            if root == Root::Definition {
                let name = scope.view(number).map(|view| view.fields().text("name")).unwrap_or_default();
                self.of.insert(number, self.products.len());
                self.products.push(product(number.to_string(), name, origin(number)));
            }
        }
    }

    /// The product that lists an entity.
    fn holder(&self, roots: &Roots, number: EntryNumber) -> usize {
        roots.definitions.get(&number).and_then(|definition| self.of.get(definition)).copied().unwrap_or(FILE)
    }

    fn add_uses(&mut self, builder: &mut Builder<'_, '_>, roots: &Roots) {
        let uses = roots.all.iter().filter(|(_, root)| *root == Root::Use).map(|(number, _)| *number);
        let mut found = Vec::new();
        for number in uses {
            match self.occurrence(&builder.scope, roots, number) {
                Ok(occurrence) => found.push(occurrence),
                Err(error) => builder.report_topology(number, &error),
            }
        }
        let pairs: Vec<_> = found.iter().map(|occurrence| (occurrence.parent, occurrence.child)).collect();
        let circular = circular_occurrences(self.products.len(), &pairs);
        for (at, occurrence) in found.into_iter().enumerate() {
            if circular.binary_search(&at).is_err() {
                self.occurrences.push(occurrence);
            } else if let Origin::DirectoryEntry(number) = occurrence.origin {
                let message = "the subfigure holds itself; this use of it is left out".to_owned();
                builder.report(ModelCode::Cycle, EntryNumber(number), message);
            }
        }
    }

    fn occurrence(
        &self,
        scope: &Scope<'_>,
        roots: &Roots,
        number: EntryNumber,
    ) -> Result<Occurrence, ReadError> {
        let view = scope.view_of(number, Entity::SubfigureInstance, "SINGULAR_SUBFIGURE_INSTANCE")?;
        let definition = view.fields().pointer("definition")?;
        let found = scope.name(definition);
        let wrong = ReadError::WrongEntity { number: definition, found, expected: "SUBFIGURE_DEFINITION" };
        let child = *self.of.get(&definition).ok_or(wrong)?;
        Ok(Occurrence {
            parent: self.holder(roots, number),
            child,
            id: number.to_string(),
            name: super::presentation::name(scope, view.instance()),
            placement: Some(placement(scope, number)?),
            overrides: Vec::new(),
            origin: origin(number),
        })
    }

    fn add_shapes(&mut self, roots: &Roots, bodies: &mut Bodies) {
        for (body, &by) in bodies.placed_by.iter() {
            let at = self.holder(roots, by);
            self.products[at].shapes.push(PlacedShape { body, transform: Affine::identity() });
            bodies.attributes[body].product = Some(at);
        }
    }
}

/// Scaled about the definition's origin, moved, and then by the matrix of the directory entry.
fn placement(scope: &Scope<'_>, number: EntryNumber) -> Result<Affine, ReadError> {
    let view = scope.view(number)?;
    let fields = view.fields();
    let translation = Vector3::from(fields.array::<3>("translation")?);
    let scale = match fields.get("scale") {
        Some(_) => fields.real_or("scale", 1.0)?,
        None => 1.0,
    };
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(ReadError::NotPositive { field: "scale", value: scale });
    }
    let own = Affine { translation, ..Affine::scale(scale) };
    let matrix = scope.matrix(view.instance())?;
    Ok(if matrix.is_identity() { own } else { matrix.after(&own) })
}
