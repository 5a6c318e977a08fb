//! What the page shows, as the data that its script reads.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::{MOST_BODIES, Overlay, base64};
use crate::brep::{BodyId, BodyKind, EdgeId, EdgeSampling, FaceId, sample_edge};
use crate::geometry::Carried;
use crate::math::Point3;
use crate::mesh::{Mesh, Tolerances, tessellate_faces};
use crate::model::{Colour, Instances, Model, PlacedBody};
use crate::units::LengthUnit;

/// Everything that is shown.
#[derive(Debug, Serialize)]
pub(super) struct Scene {
    title: String,
    unit: String,
    nodes: Vec<NodeData>,
    bodies: Vec<BodyData>,
    placed: Vec<PlacedData>,
    colours: Vec<String>,
    /// What the numbers over the faces are.
    #[serde(skip_serializing_if = "Option::is_none")]
    legend: Option<LegendData>,
    #[serde(skip)]
    pub(super) missing: Vec<String>,
    #[serde(skip)]
    pub(super) cut: bool,
}

#[derive(Debug, Serialize)]
struct LegendData {
    label: String,
    most: f64,
    lines: Vec<String>,
}

/// A product instance.
#[derive(Debug, Serialize)]
struct NodeData {
    name: String,
    id: String,
    parent: Option<usize>,
}

/// A body in its own coordinates.
#[derive(Debug, Serialize)]
struct BodyData {
    id: String,
    name: String,
    solid: bool,
    unit: String,
    /// Corners of the triangles, three numbers each, face by face.
    positions: String,
    normals: String,
    faces: Vec<FaceData>,
    /// The number at each corner of the triangles; below zero on a face that is new.
    #[serde(skip_serializing_if = "Option::is_none")]
    values: Option<String>,
    /// Ends of the segments, three numbers each, edge by edge.
    segments: String,
    edges: Vec<EdgeData>,
}

#[derive(Debug, Serialize)]
struct FaceData {
    id: String,
    name: String,
    kind: String,
    product: String,
    layers: String,
    selector: String,
    /// Triangles.
    count: usize,
    area: f64,
    alpha: f64,
    hidden: bool,
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct EdgeData {
    id: String,
    kind: String,
    /// Segments.
    count: usize,
    length: f64,
    faces: String,
}

/// A body where the assembly has it.
#[derive(Debug, Serialize)]
struct PlacedData {
    body: usize,
    node: Option<usize>,
    /// Columns of the linear part, and the translation.
    matrix: [f64; 12],
    /// Colour of each face: an index, or none.
    colours: Vec<Option<usize>>,
}

impl Scene {
    pub(super) fn of(model: &Model, title: &str, chord: Option<f64>, overlay: Option<&Overlay<'_>>) -> Self {
        let unit =
            model.contexts.first().map_or_else(LengthUnit::millimetre, |context| context.length.clone());
        let instances = Instances::of(model, &unit, MOST_BODIES);
        let node = |node: &crate::model::Node| {
            let product = &model.products[node.product];
            let used = node.occurrence.map(|at| model.occurrences[at].name.as_str()).unwrap_or_default();
            let name = if product.name.is_empty() { used } else { &product.name };
            NodeData { name: name.to_owned(), id: product.origin.to_string(), parent: node.parent }
        };
        let mut scene = Self {
            title: title.to_owned(),
            unit: unit.name.clone(),
            nodes: instances.nodes.iter().map(node).collect(),
            bodies: Vec::new(),
            placed: Vec::new(),
            colours: Vec::new(),
            legend: overlay.map(|overlay| LegendData {
                label: overlay.label.clone(),
                most: overlay.most,
                lines: overlay.lines.clone(),
            }),
            missing: Vec::new(),
            cut: instances.cut,
        };
        let mut words = Words::of(model);
        if let Some(overlay) = overlay {
            words.tell(model, overlay);
        }
        let mut known: BTreeMap<BodyId, usize> = BTreeMap::new();
        for placed in instances.bodies.iter().take(MOST_BODIES) {
            let body = *known.entry(placed.body).or_insert_with(|| {
                scene.bodies.push(body(model, placed.body, chord, &words, overlay, &mut scene.missing));
                scene.bodies.len() - 1
            });
            scene.place(model, &instances, placed, body);
        }
        scene
    }

    fn place(&mut self, model: &Model, instances: &Instances, placed: &PlacedBody, body: usize) {
        let colours = faces_of(model, placed.body).into_iter().map(|face| {
            let name = instances.colour(model, placed, face).map(hex)?;
            let known = self.colours.iter().position(|other| *other == name);
            Some(known.unwrap_or_else(|| {
                self.colours.push(name);
                self.colours.len() - 1
            }))
        });
        let colours = colours.collect();
        let transform = &placed.transform;
        let mut matrix = [0.0; 12];
        matrix[..9].copy_from_slice(transform.linear.as_slice());
        matrix[9..].copy_from_slice(transform.translation.as_slice());
        self.placed.push(PlacedData { body, node: placed.node, matrix, colours });
    }
}

/// What is told of faces and needs all of them to be known.
struct Words {
    /// Names that one face alone has.
    unique: BTreeSet<String>,
    /// Faces of each edge.
    users: crate::brep::Arena<EdgeId, Vec<FaceId>>,
    notes: BTreeMap<FaceId, Vec<String>>,
}

impl Words {
    fn of(model: &Model) -> Self {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for (_, face) in model.faces.iter() {
            *counts.entry(&face.name).or_insert(0) += 1;
        }
        let one = |(name, count): (&str, usize)| (count == 1 && !name.is_empty()).then(|| name.to_owned());
        let mut notes: BTreeMap<FaceId, Vec<String>> = BTreeMap::new();
        for annotation in &model.annotations {
            for element in &annotation.on {
                if let crate::model::Element::Face(face) = element {
                    let text = format!("{} {} {}", annotation.origin, annotation.entity, annotation.name);
                    notes.entry(*face).or_default().push(text.trim_end().to_owned());
                }
            }
        }
        Self {
            unique: counts.into_iter().filter_map(one).collect(),
            users: model.brep.faces_of_edges(),
            notes,
        }
    }

    /// Puts what an overlay tells of faces before what the file tells.
    fn tell(&mut self, model: &Model, overlay: &Overlay<'_>) {
        for (face, origin) in model.origins.faces.iter() {
            if let Some(lines) = overlay.notes.get(&origin.to_string()) {
                self.notes.entry(face).or_default().splice(0..0, lines.iter().cloned());
            }
        }
    }
}

fn faces_of(model: &Model, body: BodyId) -> Vec<FaceId> {
    let shells = model.brep.bodies[body].shells.iter();
    shells.flat_map(|&shell| model.brep.shells[shell].faces.iter().copied()).collect()
}

fn hex(colour: Colour) -> String {
    // The cast is of a number between 0 and 255.
    let part = |part: f64| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
    format!("#{:02x}{:02x}{:02x}", part(colour.red), part(colour.green), part(colour.blue))
}

fn body(
    model: &Model,
    id: BodyId,
    chord: Option<f64>,
    words: &Words,
    overlay: Option<&Overlay<'_>>,
    missing: &mut Vec<String>,
) -> BodyData {
    let faces = faces_of(model, id);
    let mut tolerances = Tolerances::for_size(size(model, &faces));
    tolerances.chord = chord.unwrap_or(tolerances.chord);
    let meshes = meshes(model, &faces, &tolerances, missing);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let (mut data, mut values) = (Vec::new(), Vec::new());
    for &face in &faces {
        let (corners, of_corners) = meshes.get(&face).cloned().unwrap_or_default();
        let area = corners.iter().map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum();
        data.push(face_data(model, face, words, corners.len(), area));
        if let Some(overlay) = overlay {
            let points: Vec<Point3<f64>> = corners.iter().flatten().copied().collect();
            values.extend((overlay.values)(face, &points).unwrap_or_else(|| vec![NEW; points.len()]));
        }
        positions.extend(corners.iter().flatten().flat_map(|p| [p.x, p.y, p.z]));
        normals.extend(of_corners.iter().flatten().flat_map(|n| [n.x, n.y, n.z]));
    }
    let (segments, edges) = edges(model, &faces, &tolerances, words);
    let own = &model.bodies[id];
    BodyData {
        id: model.origins.bodies[id].to_string(),
        name: own.own.name.clone(),
        solid: model.brep.bodies[id].kind == BodyKind::Solid,
        unit: model.contexts[model.body_context[id]].length.name.clone(),
        positions: base64::floats(positions),
        normals: base64::floats(normals),
        faces: data,
        values: overlay.map(|_| base64::floats(values)),
        segments: base64::floats(segments),
        edges,
    }
}

/// Number on a face that is new.
const NEW: f64 = -1.0;

/// Diagonal of the box of the vertices; 1 when they all coincide.
fn size(model: &Model, faces: &[FaceId]) -> f64 {
    let brep = &model.brep;
    let edges =
        faces.iter().flat_map(|&face| brep.coedges_of(face)).map(|c| &brep.edges[brep.coedges[c].edge]);
    let points: Vec<Point3<f64>> =
        edges.flat_map(|edge| [edge.start, edge.end]).map(|vertex| brep.vertices[vertex].point).collect();
    let size = crate::mesh::Extents::around(&points).map_or(0.0, |extents| extents.diagonal());
    if size > 0.0 { size } else { 1.0 }
}

type Corners = (Vec<[Point3<f64>; 3]>, Vec<[crate::math::Vector3<f64>; 3]>);

/// Triangles and normals of each face; all at once where that goes, else face by face.
fn meshes(
    model: &Model,
    faces: &[FaceId],
    tolerances: &Tolerances,
    missing: &mut Vec<String>,
) -> BTreeMap<FaceId, Corners> {
    let mut found = BTreeMap::new();
    if let Ok(mesh) = tessellate_faces(&model.brep, faces, tolerances) {
        sort_in(&mesh, &mut found);
        return found;
    }
    for &face in faces {
        match tessellate_faces(&model.brep, &[face], tolerances) {
            Ok(mesh) => sort_in(&mesh, &mut found),
            Err(error) => missing.push(format!("{}: {error}", model.origins.faces[face])),
        }
    }
    found
}

fn sort_in(mesh: &Mesh, found: &mut BTreeMap<FaceId, Corners>) {
    for ((corners, face), normals) in mesh.corners().zip(&mesh.faces).zip(&mesh.normals) {
        let entry = found.entry(*face).or_default();
        entry.0.push(corners);
        entry.1.push(*normals);
    }
}

fn face_data(model: &Model, face: FaceId, words: &Words, count: usize, area: f64) -> FaceData {
    let own = &model.faces[face];
    let id = model.origins.faces[face].to_string();
    let selector = if words.unique.contains(&own.name) && !own.name.contains(['*', '?', '[', '{', '"', '\\'])
    {
        format!("{{ name = \"{}\" }}", own.name)
    } else {
        format!("\"{id}\"")
    };
    FaceData {
        selector,
        id,
        name: own.name.clone(),
        kind: kind(model.brep.surface_of(face), |surface| surface.kind()),
        product: model.product_of(face).map(|product| product.name.clone()).unwrap_or_default(),
        layers: model.layers_of(face).collect::<Vec<_>>().join(", "),
        count,
        area,
        alpha: 1.0 - model.transparency_of(face),
        hidden: model.is_hidden(face),
        notes: words.notes.get(&face).cloned().unwrap_or_default(),
    }
}

fn kind<G>(carried: &Carried<G>, word: impl Fn(&G) -> &'static str) -> String {
    match carried {
        Carried::Read(geometry) => word(geometry).to_owned(),
        Carried::Unread { entity, .. } => entity.clone(),
    }
}

/// Segments and data of the edges of some faces, each once.
fn edges(
    model: &Model,
    faces: &[FaceId],
    tolerances: &Tolerances,
    words: &Words,
) -> (Vec<f64>, Vec<EdgeData>) {
    let brep = &model.brep;
    let (mut segments, mut data, mut seen) = (Vec::new(), Vec::new(), BTreeSet::new());
    let used = faces.iter().flat_map(|&face| brep.coedges_of(face)).map(|coedge| brep.coedges[coedge].edge);
    for edge in used.filter(|&edge| seen.insert(edge)) {
        let points = polyline(model, edge, tolerances);
        let mut length = 0.0;
        for pair in points.windows(2) {
            length += (pair[1] - pair[0]).norm();
            segments.extend(pair.iter().flat_map(|p| [p.x, p.y, p.z]));
        }
        let mut users: Vec<String> =
            words.users[edge].iter().map(|&face| model.origins.faces[face].to_string()).collect();
        users.dedup();
        data.push(EdgeData {
            id: model.origins.edges[edge].to_string(),
            kind: kind(brep.curve_of(edge), |curve| curve.kind()),
            count: points.len().saturating_sub(1),
            length,
            faces: users.join(", "),
        });
    }
    (segments, data)
}

fn polyline(model: &Model, edge: EdgeId, tolerances: &Tolerances) -> Vec<Point3<f64>> {
    let sampling = EdgeSampling { chord: tolerances.chord, per_span: 4 };
    sample_edge(&model.brep, edge, &sampling).into_iter().flatten().map(|sample| sample.point).collect()
}
