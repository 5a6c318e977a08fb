//! The change set: every element of the scope gets the image that its motion asks for, shared ones once.

use std::collections::{BTreeMap, BTreeSet};

use super::base::Base;
use super::follow::{Follow, Mover};
use super::held::Held;
use super::image::{CurveParameter, SurfaceParameters, curve_image, surface_image};
use super::pcurve;
use super::scope::{Scope, face_name};
use super::stretch::Stretched;
use crate::brep::{CoedgeId, EdgeId, FaceId, VertexId, edge_range};
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::{Carried, Curve, ParameterMap, Surface};
use crate::math::{Affine, Frame, Matrix2, Vector2, Vector3};
use crate::model::{ChangeSet, Model};
use crate::ops::{Obstacle, OperationError};

/// Makes the change set.
pub(super) fn change_set(
    model: &Model,
    scope: &BTreeSet<FaceId>,
    held: &Held,
    stretched: &Stretched,
    follow: &Follow,
    plain: &Affine,
) -> Result<ChangeSet, OperationError> {
    let plain = Mover { map: *plain, rigid: false };
    let mut build = Build {
        model,
        held,
        stretched,
        follow,
        plain,
        changes: ChangeSet::default(),
        edges: BTreeMap::new(),
        obstacles: Vec::new(),
    };
    let edges: BTreeSet<EdgeId> =
        scope.iter().flat_map(|&f| model.brep.coedges_of(f)).map(|c| model.brep.coedges[c].edge).collect();
    for &edge in &edges {
        build.edge(edge);
    }
    for &face in scope {
        build.face(face);
    }
    build.vertices(scope, &edges)?;
    if build.obstacles.is_empty() {
        Ok(build.changes)
    } else {
        Err(OperationError::CannotFollow { obstacles: build.obstacles })
    }
}

struct Build<'a> {
    model: &'a Model,
    held: &'a Held,
    stretched: &'a Stretched,
    follow: &'a Follow,
    plain: Mover,
    changes: ChangeSet,
    /// How the parameters of the edges follow.
    edges: BTreeMap<EdgeId, CurveParameter>,
    obstacles: Vec<Obstacle>,
}

impl Build<'_> {
    fn mover(&self, piece: Option<&usize>) -> Mover {
        piece.map_or(self.plain, |&k| self.follow.movers[k])
    }

    fn edge_mover(&self, edge: EdgeId) -> Mover {
        self.mover(self.follow.edges.get(&edge))
    }

    fn edge(&mut self, edge: EdgeId) {
        let image = match self.generator(edge) {
            Some(image) => Ok((image, CurveParameter::Shift(0.0))),
            None => curve_image(self.model, edge, &self.edge_mover(edge)),
        };
        match image {
            Ok((image, parameter)) => {
                if self.model.brep.curve_of(edge).read() != Some(&image) {
                    self.changes.curves.insert(edge, image);
                }
                self.edges.insert(edge, parameter);
            }
            Err(obstacle) => self.obstacles.push(obstacle),
        }
    }

    /// An edge along a wall that becomes longer: an endless line stays itself, another curve is drawn anew between its
    /// moved ends.
    fn generator(&self, edge: EdgeId) -> Option<Curve> {
        let brep = &self.model.brep;
        let curve = brep.curve_of(edge).read()?;
        if !self.follow.generators.contains(&edge) || matches!(curve, Curve::Line { .. }) {
            return None;
        }
        let range = edge_range(brep, edge)?;
        let ends = [brep.edges[edge].start, brep.edges[edge].end];
        let [start, end] = ends.map(|v| self.vertex_mover(v).map.point(&brep.vertices[v].point));
        let direction = (end - start) / (range.end - range.start);
        Some(Curve::Line { origin: start - direction * range.start, direction })
    }

    fn vertex_mover(&self, vertex: VertexId) -> Mover {
        self.mover(self.follow.vertices.get(&vertex))
    }

    /// The surface of a face, and its parameter curves.
    fn face(&mut self, face: FaceId) {
        let mover = self.mover(self.follow.faces.get(&face));
        let found = match (self.held.bases.get(&face), self.stretched.faces.get(&face)) {
            (Some(Base::Net(base)), Some(scaled)) => {
                let same = base.carrier.is_same();
                let lines = || SurfaceParameters::Lines(Box::new(base.carrier.clone()));
                let parameters = if same { SurfaceParameters::stay() } else { lines() };
                Ok((Surface::Nurbs(base.restored(&scaled.surface)), parameters))
            }
            _ => surface_image(self.model, face, &mover),
        };
        match found {
            Ok((image, parameters)) => {
                self.parameter_curves(face, &image, &parameters, &mover);
                if self.model.brep.surface_of(face).read() != Some(&image) {
                    self.changes.surfaces.insert(face, image);
                }
            }
            Err(obstacle) => self.obstacles.push(obstacle),
        }
    }

    fn parameter_curves(
        &mut self,
        face: FaceId,
        image: &Surface,
        parameters: &SurfaceParameters,
        mover: &Mover,
    ) {
        let model = self.model;
        for coedge in model.brep.coedges_of(face) {
            let use_of = &model.brep.coedges[coedge];
            let (Some(curve), Some(edge)) = (&use_of.pcurve, self.edges.get(&use_of.edge)) else { continue };
            let its = self.edge_mover(use_of.edge);
            // An edge that moves against its face: on a plane, or at the far end of a wall that becomes longer.
            let apart = (its != *mover && self.held.bases.get(&face).is_none_or(|b| b.net().is_none()))
                .then(|| self.moved_on(face, image, &its))
                .flatten()
                .map(SurfaceParameters::Affine);
            let parameters = apart.as_ref().unwrap_or(parameters);
            let found = edge_range(&model.brep, use_of.edge)
                .ok_or_else(|| "its ends have no parameters".to_owned())
                .and_then(|r| {
                    pcurve::image(curve, parameters, edge, (r.start.min(r.end), r.start.max(r.end)))
                });
            match found {
                Ok(image) if image == *curve => {}
                Ok(image) => {
                    self.changes.pcurves.insert(coedge, image);
                }
                Err(reason) => {
                    let entity = self.parameter_curve_name(coedge);
                    self.obstacles.push(Obstacle { entity, kind: "parameter curve".to_owned(), reason });
                }
            }
        }
    }

    /// Parameters on the new surface of what an edge's own motion makes of a point on the old one.
    fn moved_on(&self, face: FaceId, image: &Surface, edge: &Mover) -> Option<ParameterMap> {
        let old = self.model.brep.surface_of(face).read()?;
        match (old, image) {
            (Surface::Plane(from), Surface::Plane(onto)) => Some(plane_parameters(from, onto, &edge.map)),
            (Surface::Cylinder { frame: from, .. }, Surface::Cylinder { frame: onto, .. }) => {
                let height = (edge.map.point(&from.origin) - onto.origin).dot(&onto.z);
                Some(ParameterMap::stretch(1.0, 1.0, Vector2::new(0.0, height)))
            }
            (
                Surface::LinearExtrusion { curve: from, .. },
                Surface::LinearExtrusion { curve: onto, direction },
            ) => {
                // Any place on both will do; the domain of a line has no end to start from.
                let (first, last) = from.domain();
                let t = if first.is_finite() { first } else { last.min(0.0) };
                let offset = edge.map.point(&from.point_at(t)) - onto.point_at(t);
                let height = offset.dot(direction) / direction.norm_squared();
                Some(ParameterMap::stretch(1.0, 1.0, Vector2::new(0.0, height)))
            }
            _ => None,
        }
    }

    fn parameter_curve_name(&self, coedge: CoedgeId) -> String {
        let own = self.model.origins.pcurves[coedge];
        own.unwrap_or(self.model.origins.coedges[coedge]).to_string()
    }

    /// Moves each vertex with its edges; refuses one that would have to follow the scaling and a hold.
    fn vertices(&mut self, scope: &BTreeSet<FaceId>, edges: &BTreeSet<EdgeId>) -> Result<(), OperationError> {
        let brep = &self.model.brep;
        let mut moved: BTreeSet<VertexId> = BTreeSet::new();
        for &edge in edges {
            for vertex in [brep.edges[edge].start, brep.edges[edge].end] {
                if self.follow.vertices.contains_key(&vertex) && !self.follow.edges.contains_key(&edge) {
                    return Err(self.torn(edge, vertex));
                }
                moved.insert(vertex);
            }
        }
        let mut vertices: BTreeMap<VertexId, Mover> =
            moved.into_iter().map(|vertex| (vertex, self.vertex_mover(vertex))).collect();
        for &face in scope {
            let mover = self.mover(self.follow.faces.get(&face));
            let loops = brep.faces[face].loops.iter();
            for vertex in loops.filter_map(|&l| brep.loops[l].vertex) {
                vertices.entry(vertex).or_insert(mover);
            }
        }
        self.refuse_shared_vertices(edges, &vertices)?;
        for (vertex, mover) in vertices {
            let before = brep.vertices[vertex].point;
            let after = mover.map.point(&before);
            if after != before {
                self.changes.points.insert(vertex, after);
            }
        }
        Ok(())
    }

    fn torn(&self, scaled: EdgeId, vertex: VertexId) -> OperationError {
        let brep = &self.model.brep;
        let name = |e: EdgeId| self.model.origins.edges[e].to_string();
        let ends_here = |e: EdgeId| brep.edges[e].start == vertex || brep.edges[e].end == vertex;
        let held = self.follow.edges.keys().find(|&&e| ends_here(e)).map_or_else(String::new, |&e| name(e));
        let face = brep.coedges.iter().find(|(_, c)| c.edge == scaled);
        let face = face.map(|(_, c)| face_name(self.model, brep.loops[c.in_loop].face)).unwrap_or_default();
        OperationError::PartlyHeld { face, held, scaled: name(scaled) }
    }

    /// An edge outside the scope may not lose its vertex.
    fn refuse_shared_vertices(
        &self,
        edges: &BTreeSet<EdgeId>,
        movers: &BTreeMap<VertexId, Mover>,
    ) -> Result<(), OperationError> {
        let brep = &self.model.brep;
        let mut neighbours = BTreeSet::new();
        for (_, coedge) in brep.coedges.iter().filter(|(_, c)| !edges.contains(&c.edge)) {
            let edge = &brep.edges[coedge.edge];
            let moved = [edge.start, edge.end].iter().any(|v| {
                let point = brep.vertices[*v].point;
                movers.get(v).is_some_and(|mover| mover.map.point(&point) != point)
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
}

/// Parameters on one plane of the images of points given by their parameters on another.
fn plane_parameters(from: &Frame, onto: &Frame, map: &Affine) -> ParameterMap {
    let at = |v: Vector3<f64>| Vector2::new(v.dot(&onto.x), v.dot(&onto.y));
    let linear = Matrix2::from_columns(&[at(map.vector(&from.x)), at(map.vector(&from.y))]);
    ParameterMap { linear, translation: at(map.point(&from.origin) - onto.origin) }
}

/// Curves that belong to no edge follow the plain scaling; those that were not understood stay, with a note.
pub(super) fn free_curves(
    model: &Model,
    what: &Scope,
    plain: &Affine,
    changes: &mut ChangeSet,
    notes: &mut Vec<Diagnostic>,
) {
    if *what != Scope::Part {
        return;
    }
    for &id in &model.free_curves {
        let entity = Some(model.origins.curves[id].to_string());
        let stays = match &model.brep.curves[id] {
            Carried::Read(curve) => match curve.transformed(plain) {
                Ok(image) => {
                    if image != *curve {
                        changes.free_curves.insert(id, image);
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
