//! Loose faces: trimmed and bounded surfaces (IGES 5.3 sections 4.33 and 4.34), bounded planes, and surfaces within
//! their own bounds.
//!
//! Each is built by itself. Faces that meet share nothing unless they are sewn.

use super::boundary::{Bit, Ground};
use super::builder::{Builder, NewCoedge, bound, on_surface, origin};
use super::code::ModelCode;
use super::curve::Piece;
use super::error::ReadError;
use super::scope::{MAX_PARTS, kind, small};
use super::spline::Rectangle;
use super::surface::{self, SurfaceRead};
use super::{natural, orient, pcurve};
use crate::brep::{EdgeId, FaceId, LoopId, ShellId, VertexId};
use crate::iges::{Entity, EntryNumber, Instance};
use crate::math::{Affine, Point3};
use crate::model::Attributes;

/// What bounds a loose face.
struct Bounds {
    surface: EntryNumber,
    /// Entities of the loops.
    loops: Vec<EntryNumber>,
    /// What the outer loop is.
    outer: Outer,
}

/// The outer loop of a loose face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outer {
    /// The rectangle of the surface.
    Natural,
    /// The first loop.
    First,
    /// Whichever is the greatest: the file does not say, but says how the loops run.
    Greatest,
}

/// A face while its loops are built.
struct Draft {
    face: FaceId,
    loops: Vec<LoopId>,
    corners: Corners,
    edges: Vec<(EdgeId, Bit)>,
}

impl Builder<'_, '_> {
    /// Builds the face of a trimmed or bounded surface, or of a surface within its own bounds. What cannot be built
    /// is reported, and the face counts as unread.
    pub(super) fn loose_face(
        &mut self,
        instance: Instance<'_>,
        shell: ShellId,
        attributes: Attributes,
    ) -> FaceId {
        let number = instance.number();
        let bounds = match self.bounds_of(instance) {
            Ok(bounds) => bounds,
            Err(error) => {
                self.report_topology(number, &error);
                let surface = self.push_unread(number, &error);
                return self.push_face(number, on_surface(surface, true, shell), attributes);
            }
        };
        let within = self.scope.matrix(instance);
        // A surface that is a face itself has its own matrix and no other.
        let within = if bounds.surface == number { Ok(Affine::identity()) } else { within };
        let read =
            within.and_then(|within| Ok((surface::read(&self.scope, bounds.surface, &within)?, within)));
        match read {
            Ok((read, within)) => self.face_on(number, &bounds, &read, &within, shell, attributes),
            Err(error) => {
                self.report_geometry(bounds.surface, number, &error);
                let surface = self.push_unread(bounds.surface, &error);
                self.push_face(number, on_surface(surface, true, shell), attributes)
            }
        }
    }

    fn bounds_of(&self, instance: Instance<'_>) -> Result<Bounds, ReadError> {
        let number = instance.number();
        let view = self.scope.view(number)?;
        let fields = view.fields();
        match kind(instance) {
            Some(Entity::TrimmedSurface) => {
                small(fields, "inner_count", MAX_PARTS)?;
                let inner = fields.pointers_of("inner")?;
                let surface = fields.pointer("surface")?;
                if fields.integer("outer_given")? == 0 {
                    return Ok(Bounds { surface, loops: inner, outer: Outer::Natural });
                }
                let loops = [fields.pointer("outer")?].into_iter().chain(inner).collect();
                Ok(Bounds { surface, loops, outer: Outer::First })
            }
            Some(Entity::BoundedSurface) => {
                small(fields, "count", MAX_PARTS)?;
                let loops = fields.pointers_of("boundaries")?;
                Ok(Bounds { surface: fields.pointer("surface")?, loops, outer: Outer::Greatest })
            }
            Some(Entity::Plane) => {
                let loops = vec![fields.pointer("boundary")?];
                Ok(Bounds { surface: number, loops, outer: Outer::First })
            }
            _ => Ok(Bounds { surface: number, loops: Vec::new(), outer: Outer::Natural }),
        }
    }

    fn face_on(
        &mut self,
        number: EntryNumber,
        bounds: &Bounds,
        read: &SurfaceRead,
        within: &Affine,
        shell: ShellId,
        attributes: Attributes,
    ) -> FaceId {
        let surface = self.push_read(bounds.surface, read);
        let face = self.push_face(number, on_surface(surface, !read.turned, shell), attributes);
        let mut draft = Draft { face, loops: Vec::new(), corners: Corners::default(), edges: Vec::new() };
        let built = self.loops(&mut draft, bounds, read, within);
        self.brep.faces[face].loops.clone_from(&draft.loops);
        if let Err(error) = built {
            self.report_topology(number, &error);
            let unread = self.push_unread(bounds.surface, &error);
            self.brep.faces[face].surface = unread;
            return face;
        }
        self.orient(&draft, number, bounds.outer);
        face
    }

    fn loops(
        &mut self,
        draft: &mut Draft,
        bounds: &Bounds,
        read: &SurfaceRead,
        within: &Affine,
    ) -> Result<(), ReadError> {
        if bounds.outer == Outer::Natural {
            let rectangle = read.bounds.ok_or(ReadError::Unbounded { kind: read.surface.kind() })?;
            self.natural_loop(draft, bounds.surface, read, rectangle)?;
        }
        for (at, &number) in bounds.loops.iter().enumerate() {
            let bits = self.boundary(number, &Ground { within, surface: Some(read) })?;
            self.given_loop(draft, number, &bits, read, bounds.outer == Outer::First && at == 0)?;
        }
        if draft.loops.is_empty() { Err(ReadError::Empty("boundaries")) } else { Ok(()) }
    }

    fn natural_loop(
        &mut self,
        draft: &mut Draft,
        number: EntryNumber,
        read: &SurfaceRead,
        rectangle: Rectangle,
    ) -> Result<(), ReadError> {
        let sides = natural::sides(&read.surface, rectangle, self.scope.resolution)?;
        let tolerance = self.corner_tolerance(sides.iter().map(|side| &side.piece));
        let mut edges: Vec<EdgeId> = Vec::new();
        let mut coedges = Vec::new();
        for side in &sides {
            let edge = match side.same_as {
                Some(at) => edges[at],
                None => {
                    let ends = [side.piece.start(), side.piece.end()]
                        .map(|point| self.corner(&mut draft.corners, number, point, tolerance));
                    let ends = self.ends(number, &side.piece, ends);
                    self.push_piece(number, &side.piece, ends)
                }
            };
            edges.push(edge);
            let pcurve = Some((number, side.pcurve.clone()));
            coedges.push(NewCoedge { edge, forward: side.forward, origin: origin(number), pcurve });
        }
        let mut around = bound(draft.face, true);
        // Counter-clockwise in the model's parameters.
        around.forward = !read.turned;
        draft.loops.push(self.push_loop(number, around, coedges));
        Ok(())
    }

    fn given_loop(
        &mut self,
        draft: &mut Draft,
        number: EntryNumber,
        bits: &[Bit],
        read: &SurfaceRead,
        outer: bool,
    ) -> Result<(), ReadError> {
        let tolerance = self.corner_tolerance(bits.iter().map(|bit| &bit.piece));
        let long: Vec<&Bit> = bits.iter().filter(|bit| !is_point(&bit.piece, tolerance)).collect();
        if long.is_empty() {
            return Err(ReadError::Empty("boundary"));
        }
        let corners: Vec<VertexId> = long
            .iter()
            .map(|bit| self.corner(&mut draft.corners, bit.number, bit.start(), tolerance))
            .collect();
        let closed = read.surface.periods() != (None, None);
        let mut coedges = Vec::new();
        for (at, bit) in long.iter().enumerate() {
            let ends = [corners[at], corners[(at + 1) % corners.len()]];
            let twin = if closed { twin(&draft.edges, bit, tolerance) } else { None };
            let (edge, on, forward) = match twin {
                Some((edge, of)) => (edge, of.piece.clone(), !of.forward),
                None => {
                    let ends = if bit.forward { ends } else { [ends[1], ends[0]] };
                    let ends = self.ends(bit.number, &bit.piece, ends);
                    let edge = self.push_piece(bit.number, &bit.piece, ends);
                    if closed {
                        draft.edges.push((edge, (*bit).clone()));
                    }
                    (edge, bit.piece.clone(), bit.forward)
                }
            };
            let pcurve = self.own_pcurve(bit, &on, read);
            coedges.push(NewCoedge { edge, forward, origin: origin(bit.number), pcurve });
        }
        draft.loops.push(self.push_loop(number, bound(draft.face, outer), coedges));
        Ok(())
    }

    /// Vertices at both ends of a piece, as its curve runs. One that comes back to where it began, but for a gap, has
    /// two.
    fn ends(&mut self, number: EntryNumber, piece: &Piece, [start, end]: [VertexId; 2]) -> [VertexId; 2] {
        if start != end || piece.curve.period().is_some() {
            return [start, end];
        }
        let shared = self.brep.vertices[start].point;
        let [from, to] = [piece.start(), piece.end()];
        if (shared - from).norm() <= (shared - to).norm() {
            [start, self.push_vertex(origin(number), to)]
        } else {
            [self.push_vertex(origin(number), from), end]
        }
    }

    fn own_pcurve(
        &mut self,
        bit: &Bit,
        on: &Piece,
        read: &SurfaceRead,
    ) -> Option<(EntryNumber, crate::geometry::Curve2d)> {
        let (number, flat) = bit.flat.as_ref()?;
        let found = pcurve::fit(read, flat, on, self.scope.resolution).map(|fit| fit.curve);
        if found.is_none() {
            let message = format!("its image on the surface is nowhere near {}, which stands", bit.number);
            self.report(ModelCode::BadPcurve, *number, message);
        }
        found.map(|curve| (*number, curve))
    }

    /// Distance below which corners of a face are one.
    fn corner_tolerance<'p>(&self, pieces: impl Iterator<Item = &'p Piece>) -> f64 {
        let mut bounds = crate::math::BoundingBox::EMPTY;
        for piece in pieces {
            [piece.start(), piece.middle(), piece.end()].iter().for_each(|point| bounds.include(point));
        }
        let size = if bounds.is_empty() { 0.0 } else { bounds.diagonal() };
        self.scope.resolution.clamp(FINEST * size, (COARSEST * size).max(FINEST * size))
    }

    /// The vertex at a point: one that the face has there, or a new one.
    fn corner(
        &mut self,
        known: &mut Corners,
        from: EntryNumber,
        point: Point3<f64>,
        tolerance: f64,
    ) -> VertexId {
        if let Some(vertex) = known.near(&point, tolerance) {
            return vertex;
        }
        let vertex = self.push_vertex(origin(from), point);
        known.0.push((point, vertex));
        vertex
    }

    /// Turns the loops that run with the face to their right.
    fn orient(&mut self, draft: &Draft, number: EntryNumber, outer: Outer) {
        let first = (outer != Outer::Greatest).then_some(0);
        let Some(reversed) = orient::reversed(&self.brep, draft.face, first, self.scope.resolution) else {
            return;
        };
        for (at, (&bound, reversed)) in draft.loops.iter().zip(reversed).enumerate() {
            if outer == Outer::Greatest && draft.loops.len() == 1 {
                self.brep.loops[bound].outer = true;
            }
            let given = outer == Outer::Natural && at == 0;
            if !reversed || given {
                continue;
            }
            self.brep.loops[bound].forward = !self.brep.loops[bound].forward;
            if outer == Outer::Greatest {
                let message = "a boundary runs with the face to its right; it is taken the other way round";
                self.report(ModelCode::ReversedBoundary, number, message.to_owned());
            }
        }
    }
}

/// Least and greatest part of a face's size within which its corners are one, whatever the file's resolution.
const FINEST: f64 = 1e-9;
const COARSEST: f64 = 1e-5;

/// Vertices of a face by their points.
#[derive(Debug, Default)]
struct Corners(Vec<(Point3<f64>, VertexId)>);

/// Corners that are compared one by one: beyond, a face has so many that none is likely to be met again.
const COMPARED: usize = 4096;

impl Corners {
    fn near(&self, point: &Point3<f64>, tolerance: f64) -> Option<VertexId> {
        let latest = self.0.iter().rev().take(COMPARED);
        latest.filter(|(at, _)| (at - point).norm() <= tolerance).map(|(_, vertex)| *vertex).next()
    }
}

/// Whether a piece is no longer than the distance below which points are one.
fn is_point(piece: &Piece, tolerance: f64) -> bool {
    let start = piece.start();
    [piece.middle(), piece.end()].iter().all(|point| (point - start).norm() <= tolerance)
}

/// The edge of the face that runs where a piece does, the other way: a seam.
fn twin<'e>(edges: &'e [(EdgeId, Bit)], bit: &Bit, tolerance: f64) -> Option<(EdgeId, &'e Bit)> {
    let latest = edges.iter().rev().take(COMPARED);
    let runs_back = |of: &Bit| {
        (of.start() - bit.end()).norm() <= tolerance
            && (of.end() - bit.start()).norm() <= tolerance
            && (bit.start() - bit.end()).norm() > tolerance
            && on_curve(of, &bit.piece.middle(), tolerance)
    };
    latest.filter(|(_, of)| runs_back(of)).map(|(edge, of)| (*edge, of)).next()
}

fn on_curve(of: &Bit, point: &Point3<f64>, tolerance: f64) -> bool {
    let curve = &of.piece.curve;
    (curve.point_wrapped(curve.parameter_of(point, None)) - point).norm() <= tolerance
}
