//! One pass over all records that keeps the names of those where meaning begins.
//!
//! Follows no reference. Most records, points first, are looked at once here and never again by type.

use std::sync::OnceLock;

use crate::step::entity::Entity;
use crate::step::view::EntityView;
use crate::step::{ExchangeStructure, InstanceName, schema};

/// Kinds of records where meaning begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Root {
    /// Solids and surface models.
    Body,
    /// Face sets, of bodies or not.
    Shell,
    /// Representations with items, parametric ones aside.
    Representation,
    /// Contexts with units.
    Context,
    /// Relationships of representations without a transformation.
    Relationship,
    /// Relationships of representations with one.
    TransformedRelationship,
    /// What ties such a relationship to the use of a product.
    ContextDependentShape,
    /// Product definitions.
    Product,
    /// What ties a representation to a product definition.
    ShapeDefinition,
    /// Uses of a product definition in another.
    Occurrence,
    /// What ties a document to products, and names to documents.
    Document,
    /// Styled items.
    StyledItem,
    /// Layers.
    Layer,
    /// Lists of what is hidden.
    Invisibility,
    /// Sizes and locations.
    Dimension,
    /// Geometric tolerances.
    Tolerance,
    /// Datums and their targets.
    Datum,
    /// Callouts and annotation occurrences.
    Presentation,
    /// Property definitions that are no shape.
    Property,
    /// Representations of property definitions that are no shape.
    PropertyRepresentation,
    /// Values of dimensions.
    DimensionValue,
    /// Which elements an aspect of the shape, or an annotation, is about.
    ItemUsage,
    /// How aspects of the shape belong together.
    AspectRelationship,
    /// Tessellated items.
    Tessellation,
}

/// How many kinds there are.
const ROOTS: usize = Root::Tessellation as usize + 1;

/// Names of the records where meaning begins, each list in file order.
pub(super) struct Roots([Vec<InstanceName>; ROOTS]);

impl Roots {
    /// Looks at each record once.
    pub(super) fn find(file: &ExchangeStructure) -> Self {
        let mut roots = Self([const { Vec::new() }; ROOTS]);
        // A point begins nothing, and most records are points: it is put aside by its first letters.
        let bytes = file.source().bytes();
        let is_point = |at: usize| bytes.get(at..).is_some_and(|body| body.starts_with(b"CARTESIAN_POINT("));
        let others = file.instances().filter(|instance| !instance.body_start().is_some_and(is_point));
        for view in others.filter_map(EntityView::of) {
            if let Some(root) = root_of(&view) {
                roots.0[root as usize].push(view.name());
            }
        }
        roots
    }

    /// Names of one kind, in file order.
    pub(super) fn of(&self, root: Root) -> &[InstanceName] {
        &self.0[root as usize]
    }
}

fn root_of(view: &EntityView<'_>) -> Option<Root> {
    let root = kinds()[view.entity() as usize];
    if !view.instance().is_complex() {
        return root;
    }
    // The deepest partial type may be any of several.
    if view.is(Entity::GlobalUnitAssignedContext) {
        return Some(Root::Context);
    }
    if view.is(Entity::RepresentationRelationshipWithTransformation) {
        return Some(Root::TransformedRelationship);
    }
    let partial = view.instance().records().filter_map(|record| schema::classify(record.keyword()));
    root.or_else(|| partial.filter_map(|entity| kinds()[entity as usize]).next())
}

/// The kind of each entity, by its number.
fn kinds() -> &'static [Option<Root>] {
    static KINDS: OnceLock<Vec<Option<Root>>> = OnceLock::new();
    KINDS.get_or_init(|| Entity::ALL.iter().map(|&entity| kind(entity)).collect())
}

fn kind(entity: Entity) -> Option<Root> {
    let of = |other| schema::is_a(entity, other);
    match entity {
        Entity::DefinitionalRepresentation => None,
        Entity::ManifoldSolidBrep
        | Entity::BrepWithVoids
        | Entity::FacetedBrep
        | Entity::ShellBasedSurfaceModel
        | Entity::FaceBasedSurfaceModel => Some(Root::Body),
        Entity::OpenShell | Entity::ClosedShell | Entity::ConnectedFaceSet => Some(Root::Shell),
        Entity::GlobalUnitAssignedContext => Some(Root::Context),
        Entity::RepresentationRelationship | Entity::ShapeRepresentationRelationship => {
            Some(Root::Relationship)
        }
        Entity::RepresentationRelationshipWithTransformation => Some(Root::TransformedRelationship),
        Entity::ContextDependentShapeRepresentation => Some(Root::ContextDependentShape),
        Entity::ShapeDefinitionRepresentation => Some(Root::ShapeDefinition),
        Entity::PropertyDefinitionRepresentation => Some(Root::PropertyRepresentation),
        Entity::PropertyDefinition => Some(Root::Property),
        Entity::NextAssemblyUsageOccurrence => Some(Root::Occurrence),
        Entity::AppliedDocumentReference | Entity::AppliedExternalIdentificationAssignment => {
            Some(Root::Document)
        }
        Entity::PresentationLayerAssignment => Some(Root::Layer),
        Entity::Invisibility => Some(Root::Invisibility),
        Entity::DimensionalCharacteristicRepresentation => Some(Root::DimensionValue),
        _ if of(Entity::ProductDefinition) => Some(Root::Product),
        _ if of(Entity::DimensionalSize) || of(Entity::DimensionalLocation) => Some(Root::Dimension),
        _ if of(Entity::GeometricTolerance) => Some(Root::Tolerance),
        _ if of(Entity::Datum) || of(Entity::DatumTarget) => Some(Root::Datum),
        _ if of(Entity::ShapeAspectRelationship) => Some(Root::AspectRelationship),
        _ if of(Entity::ItemIdentifiedRepresentationUsage) => Some(Root::ItemUsage),
        _ if of(Entity::AnnotationOccurrence) || of(Entity::DraughtingCallout) => Some(Root::Presentation),
        _ if of(Entity::StyledItem) => Some(Root::StyledItem),
        _ if of(Entity::TessellatedItem) => Some(Root::Tessellation),
        _ if of(Entity::Representation) => Some(Root::Representation),
        _ => None,
    }
}
