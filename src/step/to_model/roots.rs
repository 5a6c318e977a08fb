//! One pass over all records that keeps the names of those where meaning begins.
//!
//! Follows no reference. Most records, points first, are looked at once here and never again by type.

use crate::step::entity::Entity;
use crate::step::view::EntityView;
use crate::step::{ExchangeStructure, InstanceName};

/// Names of the records where meaning begins, each list in file order.
#[derive(Default)]
pub(super) struct Roots {
    /// Solids and surface models.
    pub(super) bodies: Vec<InstanceName>,
    /// Face sets, of bodies or not.
    pub(super) shells: Vec<InstanceName>,
    /// Representations with items, parametric ones aside.
    pub(super) representations: Vec<InstanceName>,
    /// Contexts with units.
    pub(super) contexts: Vec<InstanceName>,
    /// Relationships of representations without a transformation.
    pub(super) relationships: Vec<InstanceName>,
    /// Product definitions.
    pub(super) products: Vec<InstanceName>,
    /// What ties a representation to a product definition.
    pub(super) shape_definitions: Vec<InstanceName>,
    /// Uses of a product definition in another.
    pub(super) occurrences: Vec<InstanceName>,
    /// Styled items.
    pub(super) styled_items: Vec<InstanceName>,
    /// Layers.
    pub(super) layers: Vec<InstanceName>,
}

impl Roots {
    /// Looks at each record once.
    pub(super) fn find(file: &ExchangeStructure) -> Self {
        let mut roots = Self::default();
        // A point begins nothing, and most records are points: it is put aside by its first letters.
        let bytes = file.source().bytes();
        let is_point = |at: usize| bytes.get(at..).is_some_and(|body| body.starts_with(b"CARTESIAN_POINT("));
        let others = file.instances().filter(|instance| !instance.body_start().is_some_and(is_point));
        for view in others.filter_map(EntityView::of) {
            if let Some(list) = roots.list_of(&view) {
                list.push(view.name());
            }
        }
        roots
    }

    fn list_of(&mut self, view: &EntityView<'_>) -> Option<&mut Vec<InstanceName>> {
        match view.entity() {
            Entity::CartesianPoint | Entity::Direction | Entity::DefinitionalRepresentation => None,
            Entity::ManifoldSolidBrep
            | Entity::BrepWithVoids
            | Entity::FacetedBrep
            | Entity::ShellBasedSurfaceModel
            | Entity::FaceBasedSurfaceModel => Some(&mut self.bodies),
            Entity::OpenShell | Entity::ClosedShell | Entity::ConnectedFaceSet => Some(&mut self.shells),
            Entity::GeometricRepresentationContext
            | Entity::GlobalUnitAssignedContext
            | Entity::GlobalUncertaintyAssignedContext
            | Entity::ParametricRepresentationContext => {
                view.is(Entity::GlobalUnitAssignedContext).then_some(&mut self.contexts)
            }
            Entity::RepresentationRelationship | Entity::ShapeRepresentationRelationship => {
                let plain = !view.is(Entity::RepresentationRelationshipWithTransformation);
                plain.then_some(&mut self.relationships)
            }
            Entity::ProductDefinition | Entity::ProductDefinitionWithAssociatedDocuments => {
                Some(&mut self.products)
            }
            Entity::ShapeDefinitionRepresentation => Some(&mut self.shape_definitions),
            Entity::NextAssemblyUsageOccurrence => Some(&mut self.occurrences),
            Entity::StyledItem | Entity::OverRidingStyledItem => Some(&mut self.styled_items),
            Entity::PresentationLayerAssignment => Some(&mut self.layers),
            _ if view.is(Entity::Representation) => Some(&mut self.representations),
            _ => None,
        }
    }
}
