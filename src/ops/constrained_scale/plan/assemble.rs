//! The change set: every element of the scope gets the image that its motion asks for, shared ones once.

use std::collections::{BTreeMap, BTreeSet};

use super::hold::Held;
use super::rigid::{moved_curve, moved_surface};
use super::scope::{Scope, face_name};
use super::stretch::Stretched;
use crate::brep::{CoedgeId, EdgeId, FaceId, VertexId};
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::{Carried, Curve, Surface};
use crate::math::Affine;
use crate::model::{ChangeSet, Model};
use crate::ops::{Obstacle, OperationError};

/// Makes the change set.
pub(super) fn change_set(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    held: &Held,
    stretched: &Stretched,
    plain: &Affine,
    notes: &mut Vec<Diagnostic>,
    what: &Scope,
) -> Result<ChangeSet, OperationError> {
    let motions = stretched.motions.iter().map(|m| Mover {
        map: Affine { linear: m.linear, translation: m.apply(&crate::math::Point3::origin()).coords },
        rigid: m.is_rigid(),
    });
    let mut build = Build {
        model,
        held,
        plain: Mover { map: *plain, rigid: false },
        motions: motions.collect(),
        changes: ChangeSet::default(),
        obstacles: Vec::new(),
    };
    for &face in scope {
        match stretched.faces.get(&face) {
            Some(scaled) => {
                build.changes.surfaces.insert(face, Surface::Nurbs(scaled.surface.clone()));
            }
            None => build.face(face),
        }
    }
    let edges: BTreeSet<EdgeId> =
        scope.iter().flat_map(|&f| model.brep.coedges_of(f)).map(|c| model.brep.coedges[c].edge).collect();
    for &edge in &edges {
        build.edge(edge);
    }
    build.vertices(scope, &edges)?;
    if *what == Scope::Part {
        build.free_curves(notes);
    }
    if build.obstacles.is_empty() {
        Ok(build.changes)
    } else {
        Err(OperationError::CannotFollow { obstacles: build.obstacles })
    }
}

/// One motion.
#[derive(Debug, Clone, Copy)]
struct Mover {
    map: Affine,
    /// Whether it keeps all distances, so that kinds and radii stay.
    rigid: bool,
}

struct Build<'a> {
    model: &'a Model,
    held: &'a Held,
    plain: Mover,
    motions: Vec<Mover>,
    changes: ChangeSet,
    obstacles: Vec<Obstacle>,
}

impl Build<'_> {
    fn mover(&self, group: Option<usize>) -> Mover {
        group.map_or(self.plain, |g| self.motions[g])
    }

    fn obstacle(&mut self, entity: String, kind: &str, reason: String) {
        self.obstacles.push(Obstacle { entity, kind: kind.to_owned(), reason });
    }

    /// A face without held loops: an image of its surface, and of its parameter curves where the parameters change.
    fn face(&mut self, face: FaceId) {
        let mover = self.mover(self.held.hanging.get(&face).copied());
        let model = self.model;
        let surface = match model.brep.surface_of(face) {
            Carried::Read(surface) => surface,
            Carried::Unread { entity, reason } => {
                return self.obstacle(face_name(model, face), entity, reason.clone());
            }
        };
        if mover.rigid {
            let image = moved_surface(surface, &mover.map);
            if image != *surface {
                self.changes.surfaces.insert(face, image);
            }
            return;
        }
        match surface.transformed(&mover.map) {
            Ok(image) => {
                if image != *surface {
                    self.changes.surfaces.insert(face, image);
                }
                self.parameter_curves(face, surface, &mover.map);
            }
            Err(error) => self.obstacle(face_name(model, face), surface.kind(), error.to_string()),
        }
    }

    fn parameter_curves(&mut self, face: FaceId, surface: &Surface, map: &Affine) {
        let model = self.model;
        let parameters = match surface.parameter_map(map) {
            Ok(parameters) if parameters.is_identity() => return,
            Ok(parameters) => parameters,
            Err(error) => return self.obstacle(face_name(model, face), surface.kind(), error.to_string()),
        };
        for coedge in model.brep.coedges_of(face) {
            let Some(curve) = &model.brep.coedges[coedge].pcurve else { continue };
            match curve.transformed(&parameters) {
                Ok(image) if image == *curve => {}
                Ok(image) => {
                    self.changes.pcurves.insert(coedge, image);
                }
                Err(error) => {
                    let entity = self.parameter_curve_name(coedge);
                    self.obstacle(entity, "parameter curve", error.to_string());
                }
            }
        }
    }

    fn parameter_curve_name(&self, coedge: CoedgeId) -> String {
        let own = self.model.origins.pcurves[coedge];
        own.unwrap_or(self.model.origins.coedges[coedge]).to_string()
    }

    fn edge(&mut self, edge: EdgeId) {
        let mover = self.mover(self.held.edges.get(&edge).copied());
        match self.model.brep.curve_of(edge) {
            Carried::Read(curve) => match image(curve, &mover) {
                Ok(image) if image == *curve => {}
                Ok(image) => {
                    self.changes.curves.insert(edge, image);
                }
                Err(reason) => {
                    self.obstacle(self.model.origins.edges[edge].to_string(), curve.kind(), reason)
                }
            },
            Carried::Unread { entity, reason } => {
                self.obstacle(self.model.origins.edges[edge].to_string(), entity, reason.clone());
            }
        }
    }

    /// Moves each vertex with its edges; refuses one that would have to follow two motions.
    fn vertices(&mut self, scope: &BTreeSet<FaceId>, edges: &BTreeSet<EdgeId>) -> Result<(), OperationError> {
        let mut movers: BTreeMap<VertexId, (Option<usize>, Option<EdgeId>)> = BTreeMap::new();
        for &edge in edges {
            let group = self.held.edges.get(&edge).copied();
            for vertex in [self.model.brep.edges[edge].start, self.model.brep.edges[edge].end] {
                let (known, by) = *movers.entry(vertex).or_insert((group, Some(edge)));
                if known != group {
                    return Err(self.torn(edge, by, group.is_some()));
                }
            }
        }
        for &face in scope {
            let group = self.held.hanging.get(&face).copied();
            let loops = self.model.brep.faces[face].loops.iter();
            for vertex in loops.filter_map(|&l| self.model.brep.loops[l].vertex) {
                movers.entry(vertex).or_insert((group, None));
            }
        }
        self.refuse_shared_vertices(edges, &movers)?;
        for (vertex, (group, _)) in movers {
            let before = self.model.brep.vertices[vertex].point;
            let after = self.mover(group).map.point(&before);
            if after != before {
                self.changes.points.insert(vertex, after);
            }
        }
        Ok(())
    }

    fn torn(&self, edge: EdgeId, other: Option<EdgeId>, edge_is_held: bool) -> OperationError {
        let name = |e: EdgeId| self.model.origins.edges[e].to_string();
        let (edge_name, other_name) = (name(edge), other.map_or_else(String::new, name));
        let face = self.model.brep.coedges.iter().find(|(_, c)| c.edge == edge);
        let face = face.map(|(_, c)| face_name(self.model, self.model.brep.loops[c.in_loop].face));
        let face = face.unwrap_or_default();
        let (held, scaled) = if edge_is_held { (edge_name, other_name) } else { (other_name, edge_name) };
        OperationError::PartlyHeld { face, held, scaled }
    }

    /// An edge outside the scope may not lose its vertex.
    fn refuse_shared_vertices(
        &self,
        edges: &BTreeSet<EdgeId>,
        movers: &BTreeMap<VertexId, (Option<usize>, Option<EdgeId>)>,
    ) -> Result<(), OperationError> {
        let brep = &self.model.brep;
        let mut neighbours = BTreeSet::new();
        for (_, coedge) in brep.coedges.iter().filter(|(_, c)| !edges.contains(&c.edge)) {
            let edge = &brep.edges[coedge.edge];
            let moved = [edge.start, edge.end].iter().any(|v| {
                let point = brep.vertices[*v].point;
                movers.get(v).is_some_and(|(group, _)| self.mover(*group).map.point(&point) != point)
            });
            if moved {
                neighbours.insert(brep.loops[coedge.in_loop].face);
            }
        }
        if neighbours.is_empty() {
            return Ok(());
        }
        let neighbours = neighbours.into_iter().map(|f| face_name(self.model, f)).collect();
        Err(OperationError::NeighboursOutside { faces: vec!["a shared vertex".to_owned()], neighbours })
    }

    /// Curves that belong to no edge follow the plain scaling; those that were not understood stay, with a note.
    fn free_curves(&mut self, notes: &mut Vec<Diagnostic>) {
        for &id in &self.model.free_curves {
            let entity = Some(self.model.origins.curves[id].to_string());
            let stays = match &self.model.brep.curves[id] {
                Carried::Read(curve) => match curve.transformed(&self.plain.map) {
                    Ok(image) => {
                        if image != *curve {
                            self.changes.free_curves.insert(id, image);
                        }
                        continue;
                    }
                    Err(error) => error.to_string(),
                },
                Carried::Unread { entity, reason } => format!("{entity}: {reason}"),
            };
            notes.push(Diagnostic {
                code: "scale.curve-stayed",
                severity: Severity::Warning,
                entity,
                span: None,
                message: format!("curve stays as it is: {stays}"),
            });
        }
    }
}

/// Image of an edge's curve.
fn image(curve: &Curve, mover: &Mover) -> Result<Curve, String> {
    if mover.rigid {
        return Ok(moved_curve(curve, &mover.map));
    }
    curve.transformed(&mover.map).map_err(|error| error.to_string())
}
