//! Volume, area and centroid of what a statement of a file speaks of: faces, bodies, a product with its components, a
//! use of one.
//!
//! Adds up what [`brep::mass_properties`](crate::brep::mass_properties) knows of single bodies, each where the assembly
//! has it. Densities are one.

use std::collections::BTreeMap;

use super::assembly::{Instances, Node};
use super::{Element, Model};
use crate::brep::mass_properties::{MassProperties, MassPropertiesError, Quadrature, of_body, of_face};
use crate::brep::{BodyId, BodyKind, FaceId};
use crate::math::{Affine, Point3, Vector3};
use crate::units::LengthUnit;

/// Bodies where a subject has them, or faces.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// Each body with the map from its own coordinates to the subject's.
    pub bodies: Vec<(BodyId, Affine)>,
    /// Faces, where the subject is some of them.
    pub faces: Vec<FaceId>,
    /// The unit of the subject's coordinates.
    pub unit: LengthUnit,
    /// Whether components are counted in: other programs may weigh them by their materials.
    pub has_components: bool,
}

impl Subject {
    /// What a statement on some elements is about: faces, bodies, or one product or one use of a product with everything
    /// below.
    ///
    /// `None` for edges, for nothing, for a mixture, for a product part of which stands in another file, and for one of
    /// more than [`Instances::LIMIT`] components.
    #[must_use]
    pub fn of(model: &Model, elements: &[Element]) -> Option<Self> {
        match elements {
            [] => None,
            [Element::Product(product)] => Self::of_product(model, *product),
            [Element::Occurrence(occurrence)] => {
                let used = &model.occurrences[*occurrence];
                let mut subject = Self::of_product(model, used.child)?;
                let placement = used.placement?;
                for (_, transform) in &mut subject.bodies {
                    *transform = placement.after(transform);
                }
                subject.unit = model.products[used.parent].unit.clone()?;
                Some(subject)
            }
            elements => Self::of_elements(model, elements),
        }
    }

    fn of_elements(model: &Model, elements: &[Element]) -> Option<Self> {
        let (mut bodies, mut faces) = (Vec::new(), Vec::new());
        for element in elements {
            match element {
                Element::Body(body) => bodies.push((*body, Affine::identity())),
                Element::Face(face) => faces.push(*face),
                Element::Edge(_) | Element::Product(_) | Element::Occurrence(_) => return None,
            }
        }
        let first = match (bodies.first(), faces.first()) {
            (Some((body, _)), None) => *body,
            (None, Some(face)) => model.body_of(*face),
            _ => return None,
        };
        let unit = model.contexts[model.body_context[first]].length.clone();
        Some(Self { bodies, faces, unit, has_components: false })
    }

    fn of_product(model: &Model, product: usize) -> Option<Self> {
        let unit = model.products[product].unit.clone()?;
        let instances = Instances::below(model, product, Instances::LIMIT);
        let elsewhere = |node: &Node| !model.products[node.product].external.is_empty();
        if instances.cut || instances.bodies.is_empty() || instances.nodes.iter().any(elsewhere) {
            return None;
        }
        let bodies = instances.bodies.iter().map(|placed| (placed.body, placed.transform)).collect();
        let has_components = instances.nodes.len() > 1;
        Some(Self { bodies, faces: Vec::new(), unit, has_components })
    }

    /// Measures it, each body once, as exactly as the quadrature for a body says.
    ///
    /// # Errors
    /// What a body or a face has no measures for.
    pub fn mass(
        &self,
        model: &Model,
        quadrature: impl Fn(BodyId) -> Quadrature,
    ) -> Result<Mass, MassPropertiesError> {
        let mut known: BTreeMap<BodyId, MassProperties> = BTreeMap::new();
        let mut sums = Sums::default();
        for (body, transform) in &self.bodies {
            if !known.contains_key(body) {
                known.insert(*body, of_body(&model.brep, *body, &quadrature(*body))?);
            }
            sums.add(&known[body], model.brep.bodies[*body].kind == BodyKind::Solid, transform);
        }
        for &face in &self.faces {
            let quadrature = quadrature(model.body_of(face));
            let found = of_face(&model.brep, face, &quadrature, Point3::origin())?;
            sums.add(&found, false, &Affine::identity());
        }
        Ok(sums.mass())
    }
}

/// What a subject measures, in its own unit and coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    /// Volume, where all bodies are solids.
    pub volume: Option<f64>,
    /// Area of all faces.
    pub area: f64,
    /// Centroid of the volume where all bodies are solids, and of the area where none is.
    pub centroid: Option<Point3<f64>>,
}

#[derive(Default)]
struct Sums {
    solids: usize,
    sheets: usize,
    volume: f64,
    area: f64,
    /// First moments about the origin.
    of_volume: Vector3<f64>,
    of_area: Vector3<f64>,
}

impl Sums {
    fn add(&mut self, of: &MassProperties, solid: bool, transform: &Affine) {
        let scale = transform.linear.determinant().abs();
        let (volume, area) = (of.volume() * scale, of.area() * scale.powf(2.0 / 3.0));
        self.area += area;
        self.of_area += transform.point(&of.area_centroid()).coords * area;
        if solid {
            self.solids += 1;
            self.volume += volume;
            self.of_volume += transform.point(&of.centroid()).coords * volume;
        } else {
            self.sheets += 1;
        }
    }

    fn mass(&self) -> Mass {
        let mean = |moment: Vector3<f64>, whole: f64| (whole != 0.0).then(|| Point3::from(moment / whole));
        let centroid = match (self.solids, self.sheets) {
            (_, 0) => mean(self.of_volume, self.volume),
            (0, _) => mean(self.of_area, self.area),
            _ => None,
        };
        Mass { volume: (self.sheets == 0).then_some(self.volume), area: self.area, centroid }
    }
}
