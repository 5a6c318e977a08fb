//! Products: the file is the one that no other uses; every other is a subfigure (IGES 5.3 sections 4.74 and 4.133).

use std::collections::HashMap;

use super::super::lower::record::{Matrix, Record};
use super::super::write::{NewEntity, RecordWriter};
use super::super::{DirectoryEntry, Entity, EntryNumber};
use super::{FromModelError, MAX_NESTING, Rank, Solids, Writer};
use crate::brep::{BodyId, BodyKind};
use crate::math::{Affine, Matrix3, Vector3};
use crate::model::{Loss, Model, Occurrence, Origin, Product};
use crate::units::LengthUnit;

/// Products that no other uses.
fn roots(model: &Model) -> Vec<usize> {
    let mut used = vec![false; model.products.len()];
    model.occurrences.iter().for_each(|occurrence| used[occurrence.child] = true);
    (0..model.products.len()).filter(|product| !used[*product]).collect()
}

/// What is known of the products before they are written, and what became of them.
#[derive(Default)]
pub(super) struct Products {
    /// Uses in each product: indices into the model's occurrences.
    uses: Vec<Vec<usize>>,
    /// How often each body is a shape of a product.
    shapes: HashMap<BodyId, usize>,
    definitions: HashMap<usize, Definition>,
    /// Definitions of bodies that stand in several places.
    shared: HashMap<BodyId, EntryNumber>,
    /// Products that are being written, one within the other.
    open: usize,
}

impl Products {
    pub(super) fn of(model: &Model) -> Self {
        let mut products = Self { uses: vec![Vec::new(); model.products.len()], ..Self::default() };
        for (at, occurrence) in model.occurrences.iter().enumerate() {
            products.uses[occurrence.parent].push(at);
        }
        for shape in model.products.iter().flat_map(|product| &product.shapes) {
            *products.shapes.entry(shape.body).or_insert(0) += 1;
        }
        products
    }
}

/// Unit of the file: that of the first product that is not a part of another.
pub(super) fn unit(model: &Model) -> LengthUnit {
    let of_root = roots(model).into_iter().find_map(|root| model.products[root].unit.clone());
    let of_context = || model.contexts.first().map(|context| context.length.clone());
    of_root.or_else(of_context).unwrap_or_else(LengthUnit::millimetre)
}

/// Name of the product that is the file.
pub(super) fn root_name(model: &Model) -> Option<String> {
    let root = &model.products[*roots(model).first()?];
    let name = if root.name.is_empty() { &root.id } else { &root.name };
    (!name.is_empty()).then(|| name.clone())
}

/// A definition and how deep it is nested.
type Definition = (EntryNumber, i64);

impl Writer<'_, '_> {
    /// Writes everything that the products hold, and what no product holds.
    pub(super) fn products(&mut self, unit: &LengthUnit) -> Result<(), FromModelError> {
        let model = self.model;
        let roots = roots(model);
        for &root in &roots {
            let own = model.products[root].unit.as_ref().unwrap_or(unit);
            let factor = own.metres / unit.metres;
            if roots.len() == 1 && factor == 1.0 {
                self.members(root, Rank::Own)?;
                continue;
            }
            let (number, _) = self.definition(root)?;
            self.used(number, &Affine::scale(factor), "", Rank::Own, model.products[root].origin)?;
        }
        for body in model
            .brep
            .bodies
            .ids()
            .filter(|body| !self.products.shapes.contains_key(body))
            .collect::<Vec<_>>()
        {
            self.body(body, Rank::Own)?;
        }
        self.free_curves()
    }

    /// What a product lists, and how deep it is nested.
    fn members(&mut self, product: usize, rank: Rank) -> Result<(Vec<EntryNumber>, i64), FromModelError> {
        let model = self.model;
        let of = &model.products[product];
        self.lost(of);
        let (mut members, mut depth) = (Vec::new(), 0);
        for shape in &of.shapes {
            if shape.transform.is_identity() && self.products.shapes.get(&shape.body) == Some(&1) {
                members.extend(self.body(shape.body, rank)?);
                continue;
            }
            let number = self.body_definition(shape.body)?;
            depth = depth.max(1);
            members.push(self.used(number, &shape.transform, "", rank, model.origins.bodies[shape.body])?);
        }
        for at in self.products.uses[product].clone() {
            let occurrence = &model.occurrences[at];
            let (number, below) = self.definition(occurrence.child)?;
            depth = depth.max(below + 1);
            let name = if occurrence.name.is_empty() { &occurrence.id } else { &occurrence.name };
            members.push(self.used(number, &placement(model, occurrence), name, rank, occurrence.origin)?);
            if !occurrence.overrides.is_empty() {
                Loss::UseColour.report(occurrence.origin, "its own colours", self.sink);
            }
        }
        Ok((members, depth))
    }

    fn lost(&mut self, of: &Product) {
        for file in &of.external {
            Loss::External.report(of.origin, &format!("its shape in {file}"), self.sink);
        }
        if !of.id.is_empty() && !of.name.is_empty() && of.id != of.name {
            Loss::Identifier.report(of.origin, &format!("its identifier, {}", of.id), self.sink);
        }
    }

    /// The definition of a product, written once.
    fn definition(&mut self, product: usize) -> Result<Definition, FromModelError> {
        if let Some(&known) = self.products.definitions.get(&product) {
            return Ok(known);
        }
        if self.products.open >= MAX_NESTING {
            return Err(FromModelError::Nesting);
        }
        self.products.open += 1;
        let (members, depth) = self.members(product, Rank::Part)?;
        self.products.open -= 1;
        let of = &self.model.products[product];
        let name = if of.name.is_empty() { &of.id } else { &of.name };
        let number = self.define(name, depth, &members)?;
        self.products.definitions.insert(product, (number, depth));
        Ok((number, depth))
    }

    /// The definition of a body that stands in several places, or not where it is drawn.
    fn body_definition(&mut self, body: BodyId) -> Result<EntryNumber, FromModelError> {
        if let Some(&known) = self.products.shared.get(&body) {
            return Ok(known);
        }
        let parts = self.body(body, Rank::Part)?;
        let number = self.define(&self.model.bodies[body].own.name, 0, &parts)?;
        self.products.shared.insert(body, number);
        Ok(number)
    }

    fn define(
        &mut self,
        name: &str,
        depth: i64,
        members: &[EntryNumber],
    ) -> Result<EntryNumber, FromModelError> {
        let entity_type = Entity::SubfigureDefinition.number();
        let mut writer = RecordWriter::of_type(entity_type);
        writer.integer(depth).text(name).count(members.len()).pointers(members.iter().copied());
        let entry =
            DirectoryEntry { entity_type, status: Rank::Definition.status(), ..DirectoryEntry::default() };
        Ok(self.lowering.draft.push(NewEntity { entry, parameters: writer.finish() })?)
    }

    /// The use of a definition.
    fn used(
        &mut self,
        definition: EntryNumber,
        placement: &Affine,
        name: &str,
        rank: Rank,
        origin: Origin,
    ) -> Result<EntryNumber, FromModelError> {
        let factor = placement.similarity_factor().filter(|factor| *factor > 0.0);
        let factor = factor.filter(|_| placement.keeps_orientation());
        let factor = factor.ok_or(FromModelError::Placement { origin })?;
        let turn = if (factor - 1.0).abs() <= ROUNDED { placement.linear } else { placement.linear / factor };
        let factor = if (factor - 1.0).abs() <= ROUNDED { 1.0 } else { factor };
        let mut record = Record::new(Entity::SubfigureInstance.number(), 0).pointer(definition);
        if turn == Matrix3::identity() {
            record = record.reals(placement.translation.iter().copied()).reals([factor]);
        } else {
            record = record.reals(Vector3::<f64>::zeros().iter().copied()).reals([factor]);
            record.matrix = Matrix::New(Affine { linear: turn, translation: placement.translation });
        }
        let behind = self.named(name)?;
        self.add_as(&record, &DirectoryEntry::default(), rank, &behind)
    }

    fn body(&mut self, body: BodyId, rank: Rank) -> Result<Vec<EntryNumber>, FromModelError> {
        if let Some(known) = self.bodies.get(&body) {
            return Ok(known.clone());
        }
        let brep = &self.model.brep;
        let of = &brep.bodies[body];
        let closed = of.shells.iter().all(|&shell| brep.shells[shell].closed) && !of.shells.is_empty();
        let numbers = if of.kind == BodyKind::Solid && closed && self.solids == Solids::Brep {
            vec![self.solid(body, rank)?]
        } else {
            if of.kind == BodyKind::Solid {
                let what = "that it is a solid; its faces are";
                Loss::OpenSolid.report(self.model.origins.bodies[body], what, self.sink);
            }
            self.trimmed(body, rank)?
        };
        self.bodies.insert(body, numbers.clone());
        Ok(numbers)
    }
}

/// Difference of a scale from one that is rounding.
const ROUNDED: f64 = 1e-12;

/// Where a use puts its product; where its own coordinates are, when the file does not say.
fn placement(model: &Model, occurrence: &Occurrence) -> Affine {
    let metres = |at: usize| model.products[at].unit.as_ref().map(|unit| unit.metres);
    occurrence.placement.unwrap_or_else(|| {
        let pair = metres(occurrence.child).zip(metres(occurrence.parent));
        Affine::scale(pair.map_or(1.0, |(child, own)| child / own))
    })
}
