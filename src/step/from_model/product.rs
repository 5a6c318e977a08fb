//! Products, their shapes and their uses in each other (ISO 10303-41 and -43).

use super::super::exchange_structure::InstanceName;
use super::super::lower::compose::{Value, verbatim};
use super::body::representation_kind;
use super::{FromModelError, Writer, list, text, to};
use crate::brep::{BodyId, BodyKind};
use crate::math::{Affine, Frame, Point3, Vector3};
use crate::model::{Loss, Occurrence, Origin};

/// Records of one product.
#[derive(Clone, Copy)]
struct Written {
    definition: InstanceName,
    shape: InstanceName,
    /// Origin of its coordinates.
    origin: InstanceName,
}

/// Frame of a product's own coordinates.
fn world() -> Frame {
    Frame { origin: Point3::origin(), x: Vector3::x(), y: Vector3::y(), z: Vector3::z() }
}

impl Writer<'_, '_> {
    /// Writes products with their shapes and uses.
    pub(super) fn products(&mut self) -> Result<(), FromModelError> {
        let mut written = Vec::with_capacity(self.model.products.len());
        for product in &self.model.products {
            for file in &product.external {
                Loss::External.report(product.origin, &format!("its shape in {file}"), self.sink);
            }
            written.push(self.product(&product.id, &product.name)?);
        }
        let mut items: Vec<Vec<Value>> = written.iter().map(|product| vec![to(product.origin)]).collect();
        let mut targets = Vec::with_capacity(self.model.occurrences.len());
        for occurrence in &self.model.occurrences {
            let frame = rigid_frame(occurrence)?;
            let target = self.lowering.append_frame(&frame)?;
            items[occurrence.parent].push(to(target));
            targets.push(target);
        }
        let representations = self.representations(&written, items)?;
        for (occurrence, target) in self.model.occurrences.iter().zip(targets) {
            self.occurrence(occurrence, &written, &representations, target)?;
        }
        Ok(())
    }

    fn product(&mut self, id: &str, name: &str) -> Result<Written, FromModelError> {
        let application = to(self.application);
        let name = if name.is_empty() { id } else { name };
        let values = vec![text(""), application.clone(), text("mechanical")];
        let discipline = self.add("PRODUCT_CONTEXT", values)?;
        let values = vec![text(id), text(name), text(""), list([discipline])];
        let product = self.add("PRODUCT", values)?;
        let values = vec![text("part"), verbatim("$"), list([product])];
        self.add("PRODUCT_RELATED_PRODUCT_CATEGORY", values)?;
        let values = vec![text(""), text(""), to(product)];
        let version = self.add("PRODUCT_DEFINITION_FORMATION", values)?;
        let values = vec![text("part definition"), application, text("design")];
        let stage = self.add("PRODUCT_DEFINITION_CONTEXT", values)?;
        let values = vec![text("design"), text(""), to(version), to(stage)];
        let definition = self.add("PRODUCT_DEFINITION", values)?;
        let shape = self.add("PRODUCT_DEFINITION_SHAPE", vec![text(""), text(""), to(definition)])?;
        let origin = self.lowering.append_frame(&world())?;
        Ok(Written { definition, shape, origin })
    }

    /// The representation of each product, of which `items` have their frames.
    fn representations(
        &mut self,
        written: &[Written],
        items: Vec<Vec<Value>>,
    ) -> Result<Vec<InstanceName>, FromModelError> {
        let free = self.free_curves()?;
        let mut representations = Vec::with_capacity(written.len());
        for (at, mut items) in items.into_iter().enumerate() {
            let shapes = &self.model.products[at].shapes;
            let moved = shapes.iter().find(|shape| !shape.transform.is_identity());
            if let Some(shape) = moved {
                let origin = self.model.origins.bodies[shape.body];
                return Err(FromModelError::Placement { origin });
            }
            let bodies: Vec<BodyId> =
                shapes.iter().map(|shape| shape.body).filter(|body| self.bodies.contains_key(body)).collect();
            let is_solid = |body: &&BodyId| self.model.brep.bodies[**body].kind == BodyKind::Solid;
            let solids = bodies.iter().filter(is_solid).count();
            items.extend(bodies.iter().map(|body| to(self.bodies[body])));
            items.extend(free.filter(|_| at == 0).map(to));
            let kind = representation_kind(&items, solids, bodies.len() - solids);
            let values = vec![text(&self.model.products[at].name), Value::List(items), to(self.space)];
            let representation = self.add(kind, values)?;
            let values = vec![to(written[at].shape), to(representation)];
            self.add("SHAPE_DEFINITION_REPRESENTATION", values)?;
            representations.push(representation);
        }
        Ok(representations)
    }

    fn occurrence(
        &mut self,
        occurrence: &Occurrence,
        written: &[Written],
        representations: &[InstanceName],
        target: InstanceName,
    ) -> Result<(), FromModelError> {
        let [parent, child] = [occurrence.parent, occurrence.child];
        let values = vec![
            text(&occurrence.id),
            text(&occurrence.name),
            text(""),
            to(written[parent].definition),
            to(written[child].definition),
            verbatim("$"),
        ];
        let usage = self.add("NEXT_ASSEMBLY_USAGE_OCCURRENCE", values)?;
        let shape = self.add("PRODUCT_DEFINITION_SHAPE", vec![text(""), text(""), to(usage)])?;
        let values = vec![text(""), text(""), to(written[child].origin), to(target)];
        let transformation = self.add("ITEM_DEFINED_TRANSFORMATION", values)?;
        let pair = [representations[child], representations[parent]].map(to);
        let relationship = self.add_complex(vec![
            ("REPRESENTATION_RELATIONSHIP", [vec![text(""), text("")], pair.to_vec()].concat()),
            ("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION", vec![to(transformation)]),
            ("SHAPE_REPRESENTATION_RELATIONSHIP", vec![]),
        ])?;
        self.add("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION", vec![to(relationship), to(shape)])?;
        if !occurrence.overrides.is_empty() {
            Loss::UseColour.report(occurrence.origin, "its own colours", self.sink);
        }
        Ok(())
    }
}

/// The frame that a use puts its component's coordinates into.
fn rigid_frame(occurrence: &Occurrence) -> Result<Frame, FromModelError> {
    let map = occurrence.placement.unwrap_or_else(Affine::identity);
    let origin: Origin = occurrence.origin;
    if !(map.is_rigid() && map.keeps_orientation()) {
        return Err(FromModelError::Placement { origin });
    }
    let axis = |at: usize| map.linear.column(at).into_owned();
    let frame = Frame { origin: Point3::from(map.translation), x: axis(0), y: axis(1), z: axis(2) };
    Ok(frame)
}
