//! What one file means: bodies, units, product structure, names and colours, and which record of the file
//! each element came from.
//!
//! The model is read-only and in file units. Operations return a [`ChangeSet`]; nothing writes a model
//! back.

pub mod annotation;
pub mod assembly;
pub mod balance;
pub mod change_set;
pub mod inventory;
pub mod loss;
pub mod mass;
pub mod origin;

pub use annotation::{Annotation, AnnotationKind, Element, Measure};
pub use assembly::{
    Instances, Node, Occurrence, Override, OverrideTarget, PlacedBody, PlacedShape, Product, instance_counts,
};
pub use balance::Balance;
pub use change_set::ChangeSet;
pub use inventory::Inventory;
pub use loss::Loss;
pub use mass::{Mass, Subject};
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
    /// Names, looks and layers of the faces.
    pub faces: Arena<FaceId, Attributes>,
    /// Names, looks and layers of the bodies; a body's colour is inherited by faces without one.
    pub bodies: Arena<BodyId, BodyAttributes>,
    /// Curves that belong to no edge: wires and geometric sets.
    pub free_curves: Vec<CurveId>,
    /// Their names, in the same order: each its own, or else that of the set that holds it; empty without one.
    pub free_curve_names: Vec<String>,
    /// Product definitions in file order.
    pub products: Vec<Product>,
    /// Uses of one product in another, in file order.
    pub occurrences: Vec<Occurrence>,
    /// Dimensions, tolerances, datums, notes, validation properties and tessellations, in file order.
    pub annotations: Vec<Annotation>,
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

/// How a file wants something shown.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Appearance {
    /// Colour of its surfaces.
    pub colour: Option<Colour>,
    /// How much of what is behind shows through: 0 opaque, 1 clear.
    pub transparency: Option<f64>,
    /// Whether the file hides it.
    pub hidden: bool,
}

/// What a file says about a face beside its shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// Decoded name; empty when the file gives none.
    pub name: String,
    /// Own look, not an inherited one.
    pub appearance: Appearance,
    /// Names of the layers that it lies on.
    pub layers: Vec<String>,
}

/// What a file says about a body beside its shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodyAttributes {
    /// Name, look, layers.
    pub own: Attributes,
    /// Product that it is a shape of: an index into [`Model::products`].
    pub product: Option<usize>,
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

    /// Colour of a face: its own, or else its body's, or else that of its product's whole shape. What a use
    /// in an assembly changes is [`Instances::colour`]'s knowledge.
    #[must_use]
    pub fn colour_of(&self, face: FaceId) -> Option<Colour> {
        let of_product = || self.product_of(face).and_then(|product| product.appearance.colour);
        let body = &self.bodies[self.body_of(face)].own;
        self.faces[face].appearance.colour.or(body.appearance.colour).or_else(of_product)
    }

    /// Transparency of a face: its own or else its body's; 0 when the file says none.
    #[must_use]
    pub fn transparency_of(&self, face: FaceId) -> f64 {
        let body = &self.bodies[self.body_of(face)].own.appearance;
        let own = &self.faces[face].appearance;
        // A colour of its own without a transparency is opaque, whatever the body is.
        let inherited = if own.colour.is_some() { None } else { body.transparency };
        own.transparency.or(inherited).unwrap_or(0.0)
    }

    /// Whether the file hides a face or its body.
    #[must_use]
    pub fn is_hidden(&self, face: FaceId) -> bool {
        self.faces[face].appearance.hidden || self.bodies[self.body_of(face)].own.appearance.hidden
    }

    /// Layers of a face: its own, then those of its body.
    pub fn layers_of(&self, face: FaceId) -> impl Iterator<Item = &str> {
        let body = &self.bodies[self.body_of(face)].own.layers;
        self.faces[face].layers.iter().chain(body).map(String::as_str)
    }
}
