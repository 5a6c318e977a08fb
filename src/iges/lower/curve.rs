//! Curves: asked for by the uses of edges, then edited in place or given to those that ask.

use std::collections::{BTreeMap, BTreeSet};

use super::super::EntryNumber;
use super::draft::Look;
use super::lift::{in_file, lifted};
use super::slot::{Leaf, Slot, slot, unreadable};
use super::{Ground, LowerError, Lowering, entry_of, member_of};
use crate::brep::{Brep, CoedgeId, Edge, EdgeId, FaceId, Vertex, edge_range};
use crate::geometry::{Carried, Curve, Curve2d};
use crate::iges::to_model::curve::{self, Piece};
use crate::iges::to_model::curve2d::Piece2d;
use crate::iges::to_model::pcurve;
use crate::math::{Affine, Point3};

/// A pointer that asks for other content of the curve that it points to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Request {
    pub(super) chain: Vec<Slot>,
    /// The curve in the space of the user.
    pub(super) piece: Piece,
}

impl Lowering<'_> {
    /// Asks for the curves of everything that moves.
    pub(super) fn edges(&mut self) -> Result<(), LowerError> {
        let mut moved: BTreeSet<EdgeId> = self.changes.curves.keys().copied().collect();
        let ends = |edge: &Edge| [edge.start, edge.end].iter().any(|v| self.changes.points.contains_key(v));
        moved.extend(self.model.brep.edges.iter().filter(|(_, edge)| ends(edge)).map(|(id, _)| id));
        let mut uses: BTreeMap<EdgeId, Vec<CoedgeId>> = BTreeMap::new();
        let mut flat: BTreeSet<CoedgeId> = self.changes.pcurves.keys().copied().collect();
        let counted_anew: BTreeSet<FaceId> = self
            .grounds
            .iter()
            .filter(|(_, ground)| ground.map != ground.map_now)
            .map(|(face, _)| *face)
            .collect();
        for (id, coedge) in self.model.brep.coedges.iter() {
            if moved.contains(&coedge.edge) {
                uses.entry(coedge.edge).or_default().push(id);
                flat.insert(id);
            }
            if counted_anew.contains(&self.face_of(id)) {
                flat.insert(id);
            }
        }
        for (edge, uses) in uses {
            self.request_edge(edge, &uses)?;
        }
        for coedge in flat {
            self.request_pcurve(coedge)?;
        }
        Ok(())
    }

    pub(super) fn face_of(&self, coedge: CoedgeId) -> FaceId {
        self.model.brep.loops[self.model.brep.coedges[coedge].in_loop].face
    }

    /// Whether a use of an edge goes.
    fn goes(&self, coedge: CoedgeId) -> bool {
        let in_loop = self.model.brep.coedges[coedge].in_loop;
        self.changes.removed_bounds.contains(&in_loop)
            || self.changes.removed_faces.contains(&self.model.brep.loops[in_loop].face)
    }

    fn request_edge(&mut self, edge: EdgeId, uses: &[CoedgeId]) -> Result<(), LowerError> {
        let of_edge = self.model.origins.edges[edge];
        let unread = |of: EntryNumber| LowerError::Unreadable { number: of, reason: "no such edge".into() };
        for &coedge in uses {
            if self.goes(coedge) {
                continue;
            }
            let ground = self.ground(self.face_of(coedge))?.clone();
            if ground.is_solid {
                let (list, at) = member_of(of_edge)?;
                let within = self.space_of_list(list, &ground)?;
                let piece = self.piece_now(edge).ok_or_else(|| unread(list))?;
                let slot = self.curve_of_edge(list, at)?;
                self.request(slot.target, vec![slot], piece, &within)?;
                return Ok(());
            }
            let number = entry_of(self.model.origins.coedges[coedge])?;
            let leaves: Vec<Leaf> =
                ground.leaves.space.iter().filter(|leaf| leaf.number == number).cloned().collect();
            for leaf in leaves {
                let piece = self.piece_now(edge).ok_or_else(|| unread(number))?;
                let piece =
                    if self.runs_back(&leaf, edge) { super::compose_curve::reversed(piece) } else { piece };
                self.request(number, leaf.chain, piece, &leaf.within)?;
            }
        }
        Ok(())
    }

    fn request(
        &mut self,
        number: EntryNumber,
        chain: Vec<Slot>,
        piece: Piece,
        within: &Affine,
    ) -> Result<(), LowerError> {
        let kind = piece.curve.kind();
        let piece = in_space(piece, within).ok_or(LowerError::Unwritable { number, kind })?;
        self.requests.entry(number).or_default().push(Request { chain, piece });
        Ok(())
    }

    /// Whether the file's curve of a loose face runs against the edge.
    fn runs_back(&self, leaf: &Leaf, edge: EdgeId) -> bool {
        let old = curve::read(&self.scope, leaf.number, &leaf.within).ok();
        let Some((old, edge)) = old.zip(self.piece_of(edge)) else { return false };
        let along = |piece: &Piece, part: f64| {
            piece.curve.point_wrapped(piece.range.0 + (piece.range.1 - piece.range.0) * part)
        };
        let off = |parts: [f64; 2]| {
            let pairs = [0.25, 0.75].into_iter().zip(parts);
            pairs.map(|(of_edge, of_old)| (along(&edge, of_edge) - along(&old, of_old)).norm()).sum::<f64>()
        };
        off([0.75, 0.25]) < off([0.25, 0.75])
    }

    /// Space of a list of edges or vertices within that of its shell.
    pub(super) fn space_of_list(&self, list: EntryNumber, ground: &Ground) -> Result<Affine, LowerError> {
        let instance = self.scope.instance(list).map_err(|error| unreadable(list, &error))?;
        self.scope.placed(instance, &ground.within).map_err(|error| unreadable(list, &error))
    }

    /// The pointer to the curve of a member of an edge list.
    pub(super) fn curve_of_edge(&mut self, list: EntryNumber, at: usize) -> Result<Slot, LowerError> {
        if !self.edge_lists.contains_key(&list) {
            let view = self.view(list)?;
            let edges = view.fields().group("edges").map_err(|error| unreadable(list, &error))?;
            let slots = edges.iter().map(|edge| slot(list, edge, "curve")).collect();
            self.edge_lists.insert(list, slots);
        }
        let found = self.edge_lists.get(&list).and_then(|slots| slots.get(at.checked_sub(1)?).copied());
        found.flatten().ok_or_else(|| super::slot::missing(list, "curve"))
    }

    fn request_pcurve(&mut self, coedge: CoedgeId) -> Result<(), LowerError> {
        if self.goes(coedge) || self.model.origins.pcurves[coedge].is_none() {
            return Ok(());
        }
        let ground = self.ground(self.face_of(coedge))?.clone();
        let Some(number) = self.model.origins.pcurves[coedge].map(entry_of).transpose()? else {
            return Ok(());
        };
        if number == ground.face && ground.is_natural() || number == ground.surface {
            return Ok(());
        }
        let unwritable = |curve: &Curve2d| LowerError::Unwritable { number, kind: curve.kind() };
        let Some(curve) = self.pcurve_now(coedge) else { return Ok(()) };
        let Some((flat, fit)) = self.fit(&ground, coedge) else { return Ok(()) };
        let edge = self.model.brep.coedges[coedge].edge;
        let Some(range) = self.piece_now(edge).map(|piece| piece.range) else { return Ok(()) };
        let own = in_file(&Piece2d { curve: curve.clone(), range }, &ground.map_now);
        let own = own.and_then(|own| if fit.reversed { pcurve::reversed(&own) } else { Some(own) });
        let own = own.ok_or_else(|| unwritable(&curve))?;
        let same_knots = knots(&curve) == self.model.brep.coedges[coedge].pcurve.as_ref().and_then(knots);
        let own = if same_knots { over_knots_of(own, &flat) } else { own };
        let piece = lifted(&own).ok_or_else(|| unwritable(&curve))?;
        for leaf in self.pcurve_leaves(coedge, number, &ground)? {
            self.request(number, leaf.chain, piece.clone(), &leaf.within)?;
        }
        Ok(())
    }

    fn pcurve_leaves(
        &self,
        coedge: CoedgeId,
        number: EntryNumber,
        ground: &Ground,
    ) -> Result<Vec<Leaf>, LowerError> {
        if !ground.is_solid {
            let found = ground.leaves.plane.iter().filter(|leaf| leaf.number == number);
            return Ok(found.cloned().collect());
        }
        let (list, at) = member_of(self.model.origins.coedges[coedge])?;
        let view = self.view(list)?;
        let edges = view.fields().group("edges").map_err(|error| unreadable(list, &error))?;
        let edge = at.checked_sub(1).and_then(|at| edges.get(at));
        let pcurves = edge.and_then(|edge| edge.group("pcurves").ok()).unwrap_or_default();
        let slots = pcurves.iter().filter_map(|pcurve| slot(list, pcurve, "curve"));
        let leaf = |slot: Slot| Leaf { chain: vec![slot], number, within: Affine::identity() };
        Ok(slots.filter(|slot| slot.target == number).map(leaf).collect())
    }

    /// The curve of a coedge in the parameters of its surface once the changes are made.
    pub(super) fn pcurve_now(&self, coedge: CoedgeId) -> Option<Curve2d> {
        let old = || self.model.brep.coedges[coedge].pcurve.as_ref();
        self.changes.pcurves.get(&coedge).or_else(old).cloned()
    }

    /// The piece that an edge of the model will be.
    pub(super) fn piece_now(&self, edge: EdgeId) -> Option<Piece> {
        let old = || self.model.brep.curve_of(edge).read();
        let curve = self.changes.curves.get(&edge).or_else(old)?;
        let Edge { start, end, same_sense, .. } = self.model.brep.edges[edge];
        let (start, end) = if same_sense { (start, end) } else { (end, start) };
        let point = |vertex| {
            let old = || self.model.brep.vertices[vertex].point;
            self.changes.points.get(&vertex).copied().unwrap_or_else(old)
        };
        between(curve, point(start), if start == end { None } else { Some(point(end)) })
    }

    /// Gives all curves that were asked for.
    pub(super) fn curves(&mut self) -> Result<(), LowerError> {
        for (number, requests) in std::mem::take(&mut self.requests) {
            let asked: BTreeSet<Slot> =
                requests.iter().filter_map(|request| request.chain.last().copied()).collect();
            let agree = requests.iter().all(|request| request.piece == requests[0].piece);
            let private = requests.iter().all(|request| self.is_private(&request.chain));
            if agree && private && self.draft.use_count(number) == asked.len() {
                self.put_curve(number, &requests[0].piece)?;
                continue;
            }
            self.part_curves(number, requests)?;
        }
        Ok(())
    }

    /// Gives each different piece an entity of its own.
    fn part_curves(&mut self, number: EntryNumber, requests: Vec<Request>) -> Result<(), LowerError> {
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        let entry = *instance.entry();
        let mut made: Vec<(Piece, EntryNumber)> = Vec::new();
        let mut turned: BTreeSet<Slot> = BTreeSet::new();
        for Request { chain, piece } in requests {
            // A chain that two uses of one edge share is turned once.
            if chain.last().is_some_and(|slot| !turned.insert(*slot)) {
                continue;
            }
            let known = made.iter().find(|(other, _)| *other == piece).map(|(_, to)| *to);
            let to = match known {
                Some(to) => to,
                None => {
                    let to = self.add_curve(number, &piece, Look::same(&entry))?;
                    made.push((piece, to));
                    to
                }
            };
            self.retarget(&chain, to)?;
        }
        Ok(())
    }

    /// Replaces curves that belong to no edge.
    pub(super) fn free_curves(&mut self) -> Result<(), LowerError> {
        for (&id, new) in &self.changes.free_curves {
            let number = entry_of(self.model.origins.curves[id])?;
            let piece = Piece { curve: new.clone(), range: new.domain() };
            self.put_curve(number, &piece)?;
        }
        Ok(())
    }

    /// Moves vertices that stand in lists; those of loose faces are the ends of their curves.
    pub(super) fn vertices(&mut self) -> Result<(), LowerError> {
        let mut grounds: BTreeMap<crate::brep::VertexId, FaceId> = BTreeMap::new();
        for (id, coedge) in self.model.brep.coedges.iter() {
            let Edge { start, end, .. } = self.model.brep.edges[coedge.edge];
            for vertex in [start, end] {
                if self.changes.points.contains_key(&vertex) {
                    grounds.entry(vertex).or_insert_with(|| self.face_of(id));
                }
            }
        }
        for (vertex, face) in grounds {
            let Ok((list, at)) = member_of(self.model.origins.vertices[vertex]) else { continue };
            let ground = self.ground(face)?.clone();
            let space = self.space_of_list(list, &ground)?;
            let back = space.inverse().ok_or_else(|| unreadable(list, &"its matrix flattens"))?;
            let point = back.point(&self.changes.points[&vertex]);
            self.set_vertex(list, at, &point)?;
        }
        Ok(())
    }

    fn set_vertex(&mut self, list: EntryNumber, at: usize, point: &Point3<f64>) -> Result<(), LowerError> {
        if !self.vertex_lists.contains_key(&list) {
            let numbers: Vec<_> = self.view(list)?.fields().list("vertices").collect();
            self.vertex_lists.insert(list, numbers);
        }
        let numbers = self.vertex_lists.get(&list).map(Vec::as_slice).unwrap_or_default();
        let first = 3 * at.saturating_sub(1);
        for (parameter, value) in numbers.iter().skip(first).take(3).zip(point.iter()) {
            self.draft.set(list, parameter, super::record::Value::Real(*value));
        }
        Ok(())
    }
}

/// A piece of a curve between two points; all of a closed one when there is no second.
pub(super) fn between(curve: &Curve, start: Point3<f64>, end: Option<Point3<f64>>) -> Option<Piece> {
    let mut alone = Brep::default();
    let own = alone.curves.push(Carried::Read(curve.clone()));
    let start = alone.vertices.push(Vertex { point: start });
    let end = end.map_or(start, |point| alone.vertices.push(Vertex { point }));
    let edge = alone.edges.push(Edge { curve: own, start, end, same_sense: true });
    let range = edge_range(&alone, edge)?;
    Some(Piece { curve: curve.clone(), range: (range.start, range.end) })
}

/// A piece of the model in a space from which `within` leads to it.
pub(super) fn in_space(piece: Piece, within: &Affine) -> Option<Piece> {
    if within.is_identity() {
        return Some(piece);
    }
    let (curve, shift) = piece.curve.transformed_with_shift(&within.inverse()?).ok()?;
    Some(Piece { curve, range: (piece.range.0 - shift, piece.range.1 - shift) })
}

fn knots(curve: &Curve2d) -> Option<&crate::geometry::nurbs::KnotVector> {
    match curve {
        Curve2d::Nurbs(curve) => Some(curve.knots()),
        _ => None,
    }
}

/// A spline over the knots that the file has for it.
fn over_knots_of(own: Piece2d, flat: &Piece2d) -> Piece2d {
    let (Curve2d::Nurbs(new), Curve2d::Nurbs(old)) = (&own.curve, &flat.curve) else { return own };
    if new.points().len() != old.points().len() {
        return own;
    }
    match crate::geometry::nurbs::NurbsCurve2::new(old.knots().clone(), new.points().to_vec()) {
        Ok(curve) => Piece2d { curve: Curve2d::Nurbs(curve), range: flat.range },
        Err(_) => own,
    }
}
