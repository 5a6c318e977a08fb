//! Counts and sizes of a model, for reports and for comparing a part before and after.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::brep::mass_properties::{self, Quadrature};
use crate::brep::{BodyId, BodyKind, FaceId};
use crate::geometry::{Carried, Surface};
use crate::job::report::finding::tolerance;
use crate::math::Point3;
use crate::model::{Context, Inventory, Model};

/// What is inside a part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Figures {
    /// Names of the application protocol, as the file writes them.
    pub schema: Vec<String>,
    /// Units of length of the contexts, each once: `mm`.
    pub units: Vec<String>,
    /// Counts of `products`, `solids`, `surface_bodies`, `shells`, `faces`, `edges`, `vertices`, and `curves`
    /// that belong to no edge.
    pub counts: BTreeMap<String, usize>,
    /// Count of surfaces by kind; those that are not read yet by the name of their entity.
    pub surfaces: BTreeMap<String, usize>,
    /// Least and greatest coordinates of the vertices, in file units; absent when units differ within the
    /// file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertex_extents: Option<[[f64; 3]; 2]>,
}

impl Figures {
    /// Counts a model.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        let inventory = Inventory::of(model);
        let Inventory { schema, contexts, surfaces, unread_surfaces, vertex_extents, .. } = &inventory;
        let counts = [
            ("products", inventory.products),
            ("solids", inventory.solids),
            ("surface_bodies", inventory.surface_bodies),
            ("shells", inventory.shells),
            ("faces", inventory.faces),
            ("edges", inventory.edges),
            ("vertices", inventory.vertices),
            ("curves", inventory.curves),
        ];
        let read = surfaces.iter().map(|(kind, count)| ((*kind).to_owned(), *count));
        let unread = unread_surfaces.iter().map(|(entity, count)| (unread_kind(entity), *count));
        Self {
            schema: schema.clone(),
            units: distinct_units(contexts),
            counts: counts.into_iter().map(|(name, count)| (name.to_owned(), count)).collect(),
            surfaces: read.chain(unread).collect(),
            vertex_extents: vertex_extents.map(|corners| corners.map(|corner| corner.coords.into())),
        }
    }

    /// Names of the counts, each with those of two parts.
    pub fn counts_beside<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (&'a str, usize, usize)> {
        let count = |name: &String| other.counts.get(name).copied().unwrap_or(0);
        self.counts.iter().map(move |(name, &own)| (name.as_str(), own, count(name)))
    }
}

/// Mass properties of one body of density one, in its file units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyMeasures {
    /// Its record.
    pub id: String,
    /// Volume of a solid; negative where it is turned inside out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<f64>,
    /// Bound on its error by the quadrature's own estimate; gaps between edges and surfaces are not in it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume_error: Option<f64>,
    /// Area of its faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<f64>,
    /// Bound on its error, as for the volume.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_error: Option<f64>,
    /// Centroid of a solid's volume, else of the area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centroid: Option<[f64; 3]>,
    /// Inertia of a solid about its centroid, row by row: `∫ (|r|² I - r rᵀ) dV`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inertia: Option<[[f64; 3]; 3]>,
    /// Greatest distance of an edge from a surface that it bounds: where the faces end is open to this extent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Why there are no numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unknown: Option<String>,
}

/// What one face measures, in its file units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FaceMeasures {
    /// Its area.
    pub area: f64,
    /// Bound on its error by the quadrature's own estimate.
    pub area_error: f64,
    /// What it adds to the volume by the divergence theorem: that of the cone from the origin.
    pub flux: f64,
    /// Its centroid.
    pub centroid: [f64; 3],
    /// Greatest distance of its edges from its surface.
    pub gap: f64,
}

/// Measures every body as exactly as makes sense, in file order.
#[must_use]
pub fn measure_bodies(model: &Model) -> Vec<BodyMeasures> {
    measure_bodies_by(model, Quadrature::exact)
}

/// Measures every body by the quadrature for its tolerance, in file order.
#[must_use]
pub fn measure_bodies_by(model: &Model, quadrature: fn(f64) -> Quadrature) -> Vec<BodyMeasures> {
    let measured = |body| measure_body(model, body, &quadrature(tolerance(model, body)));
    model.brep.bodies.ids().map(measured).collect()
}

fn measure_body(model: &Model, body: BodyId, quadrature: &Quadrature) -> BodyMeasures {
    let mut measures = BodyMeasures {
        id: model.origins.bodies[body].to_string(),
        volume: None,
        volume_error: None,
        area: None,
        area_error: None,
        centroid: None,
        inertia: None,
        gap: None,
        unknown: None,
    };
    match mass_properties::of_body(&model.brep, body, quadrature) {
        Ok(found) => {
            let solid = model.brep.bodies[body].kind == BodyKind::Solid;
            let centroid = if solid { found.centroid() } else { found.area_centroid() };
            measures.volume = solid.then(|| found.volume());
            measures.volume_error = solid.then(|| found.volume_error());
            measures.area = Some(found.area());
            measures.area_error = Some(found.area_error());
            measures.centroid = Some(centroid.coords.into());
            let inertia = found.inertia();
            measures.inertia = solid.then(|| [0, 1, 2].map(|i| [0, 1, 2].map(|j| inertia[(i, j)])));
            measures.gap = Some(found.gap());
        }
        Err(error) => measures.unknown = Some(error.to_string()),
    }
    measures
}

/// Measures a face; `None` where its surface or its bounds are not known.
#[must_use]
pub fn measure_face(model: &Model, face: FaceId) -> Option<FaceMeasures> {
    let brep = &model.brep;
    let body = brep.shells[brep.faces[face].shell].body;
    let quadrature = Quadrature::exact(tolerance(model, body));
    let found = mass_properties::of_face(brep, face, &quadrature, Point3::origin()).ok()?;
    Some(FaceMeasures {
        area: found.area(),
        area_error: found.area_error(),
        flux: found.volume(),
        centroid: found.area_centroid().coords.into(),
        gap: found.gap(),
    })
}

fn distinct_units(contexts: &[Context]) -> Vec<String> {
    let mut units: Vec<String> = Vec::new();
    for context in contexts {
        if !units.contains(&context.length.name) {
            units.push(context.length.name.clone());
        }
    }
    units
}

/// Word for a face's surface: its kind, or the entity that is not read.
#[must_use]
pub fn kind(surface: &Carried<Surface>) -> String {
    match surface {
        Carried::Read(surface) => surface.kind().to_owned(),
        Carried::Unread { entity, .. } => unread_kind(entity),
    }
}

fn unread_kind(entity: &str) -> String {
    if entity.is_empty() { "missing".to_owned() } else { entity.to_owned() }
}
