//! What one file means: bodies, units, product structure, names and colours, and which record of the file
//! each element came from.
//!
//! The model is read-only and in file units. Operations return a [`ChangeSet`]; nothing writes a model
//! back.

pub mod change_set;
pub mod inventory;
pub mod origin;

pub use change_set::ChangeSet;
pub use inventory::Inventory;
pub use origin::{Origin, Origins};

use crate::brep::{Arena, BodyId, Brep, CurveId, FaceId};
use crate::units::{AngleUnit, LengthUnit, Tolerance};

/// Everything that operations, checks and reports know of a file.
#[derive(Debug, Clone)]
pub struct Model {
    /// Schema names of the header, as written.
    pub schema: Vec<String>,
    /// Topology and geometry.
    pub brep: Brep,
    /// Contexts: units and uncertainty.
    pub contexts: Vec<Context>,
    /// Context of each body: an index into `contexts`.
    pub body_context: Arena<BodyId, usize>,
    /// Names, colours and layers of the faces.
    pub faces: Arena<FaceId, Attributes>,
    /// Names, colours and layers of the bodies; a body's colour is inherited by faces without one.
    pub bodies: Arena<BodyId, BodyAttributes>,
    /// Curves that belong to no edge: wires and geometric sets.
    pub free_curves: Vec<CurveId>,
    /// Product definitions in file order.
    pub products: Vec<Product>,
    /// Uses of one product in another, in file order.
    pub occurrences: Vec<Occurrence>,
    /// Which record each element came from.
    pub origins: Origins,
}

/// Units and uncertainty of one representation context.
#[derive(Debug, Clone, PartialEq)]
pub struct Context {
    /// Unit of length.
    pub length: LengthUnit,
    /// Unit of plane angle in the file; the model's angles are radians.
    pub angle: AngleUnit,
    /// Distance below which the file does not tell points apart, in file units, when it says so.
    pub uncertainty: Option<Tolerance>,
}

/// A colour, each part within [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour {
    /// Red.
    pub red: f64,
    /// Green.
    pub green: f64,
    /// Blue.
    pub blue: f64,
}

/// What a file says about a face beside its shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// Decoded name; empty when the file gives none.
    pub name: String,
    /// Own colour, not an inherited one.
    pub colour: Option<Colour>,
    /// Names of the layers that it lies on.
    pub layers: Vec<String>,
}

/// What a file says about a body beside its shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodyAttributes {
    /// Name, colour, layers.
    pub own: Attributes,
    /// Product that it is a shape of: an index into [`Model::products`].
    pub product: Option<usize>,
}

/// A product definition.
#[derive(Debug, Clone, PartialEq)]
pub struct Product {
    /// Decoded `PRODUCT.id`.
    pub id: String,
    /// Decoded `PRODUCT.name`.
    pub name: String,
    /// The product definition's record.
    pub origin: Origin,
}

/// The use of one product in another.
#[derive(Debug, Clone, PartialEq)]
pub struct Occurrence {
    /// Index of the assembly into [`Model::products`].
    pub parent: usize,
    /// Index of the component into [`Model::products`].
    pub child: usize,
    /// Decoded name of the usage.
    pub name: String,
}

impl Model {
    /// Body of a face.
    #[must_use]
    pub fn body_of(&self, face: FaceId) -> BodyId {
        self.brep.shells[self.brep.faces[face].shell].body
    }

    /// Context of a face.
    #[must_use]
    pub fn context_of(&self, face: FaceId) -> &Context {
        &self.contexts[self.body_context[self.body_of(face)]]
    }

    /// Product of a face, when the file ties one to its body.
    #[must_use]
    pub fn product_of(&self, face: FaceId) -> Option<&Product> {
        self.bodies[self.body_of(face)].product.map(|at| &self.products[at])
    }

    /// Colour of a face: its own, or else its body's.
    #[must_use]
    pub fn colour_of(&self, face: FaceId) -> Option<Colour> {
        self.faces[face].colour.or(self.bodies[self.body_of(face)].own.colour)
    }

    /// Layers of a face: its own, then those of its body.
    pub fn layers_of(&self, face: FaceId) -> impl Iterator<Item = &str> {
        let body = &self.bodies[self.body_of(face)].own.layers;
        self.faces[face].layers.iter().chain(body).map(String::as_str)
    }
}
