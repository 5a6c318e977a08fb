//! Reconstructed features sewn into the body: the primary gets new bounds, blends and secondary surfaces become faces, all
//! over shared edges.
//!
//! A feature inside the primary makes a hole in it. One that runs out over the border cuts the border's edges; the faces on
//! their other side, if any, are trimmed by the feature as the primary is. A hole across a seam cuts the seam. Whatever stood
//! in the feature's place before goes.

pub mod chart;
pub mod outline;
pub mod rail;
mod region;
pub mod section;
mod trim;

use std::collections::{BTreeMap, BTreeSet};

use super::Closure;
use super::error::ReconstructionError;
use crate::brep::{EdgeId, FaceId};
use crate::geometry::nurbs::{NurbsCurve2, NurbsSurface};
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::{Point2, Vector2};
use crate::model::change_set::{
    EdgeCurve, EdgeRef, NewBound, NewCoedge, NewEdge, NewEdgeId, NewFace, NewSurface, NewVertexId, VertexRef,
};
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;
use chart::Chart;
use outline::{Meeting, Outline, within};
use rail::{Chain, Rail, reversed};
use section::{Cutter, Section};
use trim::{Cut, Gap, Pieces, Trimmed};

/// A feature in its place.
#[derive(Debug, Clone)]
pub struct Shape {
    /// The secondary surface.
    pub secondary: NurbsSurface,
    /// Its blends, one for each limiting line.
    pub rails: Vec<Rail>,
}

/// Part of the parameter of a rail within which two cuts are one.
const ONE_CUT: f64 = 1e-9;

/// Sews features into the shell of their primary.
///
/// # Errors
/// [`ReconstructionError::Trim`], [`ReconstructionError::RegionGoesOn`], [`ReconstructionError::FeaturesOverlap`].
pub fn sewn(
    model: &Model,
    primary: FaceId,
    chart: &Chart<'_>,
    shapes: &[Shape],
    tolerance: f64,
) -> Result<ChangeSet, OperationError> {
    let outline = Outline::of(model, primary)?;
    let mut sewing = Sewing::new(model, primary, chart, shapes, outline, tolerance);
    sewing.refuse_overlaps()?;
    sewing.cut_rails()?;
    let trimmed = sewing.trim()?;
    sewing.end_rails(&trimmed.gaps)?;
    sewing.faces()?;
    sewing.walls(&trimmed.gaps)?;
    sewing.bounds(trimmed)?;
    Ok(sewing.changes)
}

/// A rail on its way to edges.
struct Progress<'a> {
    rail: &'a Rail,
    shape: usize,
    near: Option<Chain>,
    far: Option<Chain>,
    /// Sections at its ends, or its seam twice.
    ends: [Option<End>; 2],
}

/// An end of a blend: an edge from the contact with the primary to that with the secondary.
#[derive(Debug, Clone)]
struct End {
    edge: NewEdgeId,
    on_blend: Curve2d,
    on_wall: Option<Curve2d>,
    far: (f64, NewVertexId),
}

/// A section of the secondary at a border.
struct Joint {
    edge: NewEdgeId,
    on_secondary: Curve2d,
    on_wall: Option<Curve2d>,
}

struct Sewing<'a> {
    model: &'a Model,
    primary: FaceId,
    chart: &'a Chart<'a>,
    shapes: &'a [Shape],
    outline: Outline,
    tolerance: f64,
    changes: ChangeSet,
    rails: Vec<Progress<'a>>,
    cuts: Vec<Cut>,
    pieces: Pieces,
    /// Sections of secondaries, by the rail at whose end they begin, with the rail at whose start they end.
    joints: BTreeMap<usize, (usize, Joint)>,
    /// Walls that have to be longer: their surface and the parameters that it must hold.
    walls: BTreeMap<FaceId, Vec<NurbsCurve2>>,
}

impl<'a> Sewing<'a> {
    fn new(
        model: &'a Model,
        primary: FaceId,
        chart: &'a Chart<'a>,
        shapes: &'a [Shape],
        outline: Outline,
        tolerance: f64,
    ) -> Self {
        let of = |(shape, of): (usize, &'a Shape)| {
            let start = move |rail| Progress { rail, shape, near: None, far: None, ends: [None, None] };
            of.rails.iter().map(start).collect::<Vec<_>>()
        };
        let rails = shapes.iter().enumerate().flat_map(of).collect();
        Self {
            model,
            primary,
            chart,
            shapes,
            outline,
            tolerance,
            changes: ChangeSet::default(),
            rails,
            cuts: Vec::new(),
            pieces: Pieces::default(),
            joints: BTreeMap::new(),
            walls: BTreeMap::new(),
        }
    }

    fn fault(&self, rail: usize, reason: &str) -> ReconstructionError {
        let near = self.rails[rail].rail.space.point_at(0.0).coords.into();
        ReconstructionError::Trim { near, reason: reason.to_owned() }
    }

    /// Features that share a point of the primary.
    fn refuse_overlaps(&self) -> Result<(), ReconstructionError> {
        let closed = |p: &&Progress<'_>| p.rail.closure == Closure::Closed;
        let rails: Vec<&Progress<'_>> = self.rails.iter().filter(closed).collect();
        let polygons: Vec<Vec<[f64; 2]>> = rails.iter().map(|p| p.rail.polygon((0.0, 1.0))).collect();
        let boxes: Vec<_> = polygons.iter().map(|polygon| outline::box_of(polygon)).collect();
        for (i, a) in rails.iter().enumerate() {
            for (j, b) in rails.iter().enumerate().skip(i + 1).filter(|(_, b)| b.shape != a.shape) {
                let near = outline::meet_boxes(&boxes[i], &boxes[j]);
                let inside = || {
                    polygons[j].iter().any(|&p| within(a.rail, p))
                        || polygons[i].iter().any(|&p| within(b.rail, p))
                };
                if near && inside() {
                    return Err(ReconstructionError::FeaturesOverlap {
                        first: a.shape + 1,
                        second: b.shape + 1,
                    });
                }
            }
        }
        Ok(())
    }

    /// Finds where rails meet the outline and makes the edges of their contacts with the primary.
    fn cut_rails(&mut self) -> Result<(), ReconstructionError> {
        for number in 0..self.rails.len() {
            let rail = self.rails[number].rail;
            let meetings = self.outline.meetings(&self.model.brep, rail, self.tolerance)?;
            self.check_meetings(number, &meetings)?;
            let mut breaks: Vec<(f64, NewVertexId)> = Vec::new();
            for meeting in meetings {
                let same = breaks.last().filter(|(at, _)| meeting.rail_at - at <= ONE_CUT);
                let vertex = match same {
                    Some((_, vertex)) => *vertex,
                    None => {
                        let vertex = self.changes.new_vertices.push(meeting.point);
                        breaks.push((meeting.rail_at, vertex));
                        vertex
                    }
                };
                self.cuts.push(Cut { meeting, vertex, rail: number });
            }
            if rail.closure == Closure::Closed {
                breaks = self.closed_breaks(rail, breaks);
            }
            self.rails[number].near = Some(Chain::new(&mut self.changes, &rail.space, &breaks)?);
        }
        self.pieces = Pieces::of(&self.model.brep, &self.cuts);
        Ok(())
    }

    /// Breaks of a closed rail: its start, which is its end, and the cuts.
    fn closed_breaks(&mut self, rail: &Rail, cuts: Vec<(f64, NewVertexId)>) -> Vec<(f64, NewVertexId)> {
        let at_start = |at: f64| at <= ONE_CUT || at >= 1.0 - ONE_CUT;
        let start = cuts.iter().find(|(at, _)| at_start(*at)).map(|(_, vertex)| *vertex);
        let start = start.unwrap_or_else(|| self.changes.new_vertices.push(rail.space.point_at(0.0)));
        let mut breaks = vec![(0.0, start)];
        breaks.extend(cuts.into_iter().filter(|(at, _)| !at_start(*at)));
        breaks.push((1.0, start));
        breaks
    }

    /// A closed rail meets nothing but seams, an open one the border at both its ends.
    fn check_meetings(&self, number: usize, meetings: &[Meeting]) -> Result<(), ReconstructionError> {
        let rail = self.rails[number].rail;
        match rail.closure {
            Closure::Closed if meetings.is_empty() => {
                let inside = self.outline.contains(rail.flat.point_at(0.0).into());
                if inside == Some(false) {
                    return Err(self.fault(number, "the feature lies outside of the face's bounds"));
                }
            }
            Closure::Closed => {
                if !meetings.iter().all(|m| self.is_seam(self.edge_of(m))) {
                    return Err(self.fault(number, "the feature's contact curve crosses a bound of the face"));
                }
            }
            Closure::Open => {
                if !matches!(meetings, [first, last] if !first.enters && last.enters) {
                    let reason = format!(
                        "a line of the feature must come from the border of the face and end on it; it crosses the border {} times",
                        meetings.len()
                    );
                    return Err(self.fault(number, &reason));
                }
            }
        }
        Ok(())
    }

    fn edge_of(&self, meeting: &Meeting) -> EdgeId {
        self.model.brep.coedges[meeting.coedge].edge
    }

    /// Whether the primary uses an edge on both sides.
    fn is_seam(&self, edge: EdgeId) -> bool {
        let brep = &self.model.brep;
        brep.coedges_of(self.primary).filter(|&c| brep.coedges[c].edge == edge).count() == 2
    }

    fn trim(&mut self) -> Result<Trimmed, ReconstructionError> {
        let rails = &self.rails;
        let periods = self.chart.periods();
        let uses = |number: usize, way: (f64, f64)| {
            let progress = &rails[number];
            let flat = |from: f64, to: f64| piece_on(&progress.rail.flat, (from, to), periods, self.chart);
            let coedges = progress.near.as_ref().map(|chain| chain.along(way, &flat)).unwrap_or_default();
            (coedges, progress.rail.polygon(way))
        };
        let made = (&mut self.pieces, &mut self.changes);
        trim::trimmed(&self.model.brep, &self.outline, &self.cuts, made, &uses)
    }

    /// The wall that stands on a border edge.
    fn wall_of(&self, edge: EdgeId) -> Option<FaceId> {
        let brep = &self.model.brep;
        brep.coedges
            .iter()
            .filter(|(_, c)| c.edge == edge)
            .map(|(_, c)| brep.loops[c.in_loop].face)
            .find(|&f| f != self.primary)
    }

    fn cutter(&self, gap: &Gap) -> Result<Cutter<'a>, ReconstructionError> {
        let brep = &self.model.brep;
        let Some(wall) = self.wall_of(brep.coedges[gap.coedge].edge) else {
            let bound = &self.outline.bounds[self.cuts[gap.enters].meeting.bound];
            return Ok(Cutter::line(brep, *self.chart, bound, gap.coedge));
        };
        let Some(surface) = brep.surface_of(wall).read() else {
            return Err(self.fault(self.cuts[gap.enters].rail, "the face on the border is not understood"));
        };
        Ok(Cutter::Wall(longer(surface)))
    }

    /// Sections of blends and secondaries at the border, and the seams of closed blends.
    fn end_rails(&mut self, gaps: &[Gap]) -> Result<(), ReconstructionError> {
        for gap in gaps {
            if !self.is_seam(self.model.brep.coedges[gap.coedge].edge) {
                self.end_at(gap)?;
            }
        }
        for number in 0..self.rails.len() {
            if self.rails[number].rail.closure == Closure::Closed {
                self.seam(number);
            }
            let progress = &self.rails[number];
            let [Some(start), Some(end)] = &progress.ends else {
                return Err(self.fault(number, "a line of the feature ends on no border"));
            };
            let last = if progress.rail.closure == Closure::Closed { (1.0, end.far.1) } else { end.far };
            let breaks = [start.far, last];
            let far = Chain::new(&mut self.changes, &progress.rail.far, &breaks)?;
            self.rails[number].far = Some(far);
        }
        Ok(())
    }

    fn seam(&mut self, number: usize) {
        let rail = self.rails[number].rail;
        let Some(start) = self.start_vertex(number) else { return };
        let far = self.changes.new_vertices.push(rail.far.point_at(0.0));
        let curve = EdgeCurve::Own(Curve::Nurbs(rail.blend.iso_curve_v(0.0)));
        let [from, to] = [start, far].map(VertexRef::New);
        let edge = self.changes.new_edges.push(NewEdge { curve, start: from, end: to });
        let across = |v: f64| Curve2d::Line { origin: Point2::new(0.0, v), direction: Vector2::x() };
        let end = |v: f64| End { edge, on_blend: across(v), on_wall: None, far: (0.0, far) };
        self.rails[number].ends = [Some(end(0.0)), Some(end(1.0))];
    }

    /// The vertex at the start of a closed rail.
    fn start_vertex(&self, number: usize) -> Option<NewVertexId> {
        let first = self.rails[number].near.as_ref().and_then(Chain::first_edge)?;
        match self.changes.new_edges[first].start {
            VertexRef::New(vertex) => Some(vertex),
            VertexRef::Kept(_) => None,
        }
    }

    /// Cuts the blends on both sides of a stretch of border, and the secondary between them.
    fn end_at(&mut self, gap: &Gap) -> Result<(), ReconstructionError> {
        let cutter = self.cutter(gap)?;
        let (i, j) = (self.cuts[gap.enters].rail, self.cuts[gap.leaves].rail);
        if self.rails[i].shape != self.rails[j].shape {
            let [a, b] = [i, j].map(|k| self.rails[k].shape + 1);
            return Err(ReconstructionError::FeaturesOverlap { first: a.min(b), second: a.max(b) });
        }
        let end = self.end(&cutter, gap.enters)?;
        let start = self.end(&cutter, gap.leaves)?;
        let secondary = &self.shapes[self.rails[i].shape].secondary;
        let place = |rail: usize, at: f64| self.rails[rail].rail.on_secondary.point_at(at).into();
        let section =
            cutter.of_surface(secondary, [place(i, end.far.0), place(j, start.far.0)], self.tolerance)?;
        let ends = [end.far.1, start.far.1].map(VertexRef::New);
        let curve = EdgeCurve::Own(Curve::Nurbs(section.space.clone()));
        let edge = self.changes.new_edges.push(NewEdge { curve, start: ends[0], end: ends[1] });
        let on_wall = section.on_wall.as_ref().map(Section::curve2d);
        self.note_wall(gap, &section);
        let joint = Joint { edge, on_secondary: Section::curve2d(&section.on_surface), on_wall };
        self.joints.insert(i, (j, joint));
        self.rails[i].ends[1] = Some(end);
        self.rails[j].ends[0] = Some(start);
        Ok(())
    }

    /// The section of a blend at a cut.
    fn end(&mut self, cutter: &Cutter<'_>, cut: usize) -> Result<End, ReconstructionError> {
        let Cut { meeting, vertex, rail: number } = self.cuts[cut];
        let rail = self.rails[number].rail;
        let far = cutter.on_curve(&rail.far, meeting.rail_at);
        let far = far.ok_or_else(|| {
            self.fault(
                number,
                "the contact with the secondary does not reach the border: the line is too short there",
            )
        })?;
        let section = cutter.of_blend(&rail.blend, (meeting.rail_at, far), self.tolerance)?;
        let corner = self.changes.new_vertices.push(rail.far.point_at(far));
        let [start, end] = [vertex, corner].map(VertexRef::New);
        let curve = EdgeCurve::Own(Curve::Nurbs(section.space.clone()));
        let edge = self.changes.new_edges.push(NewEdge { curve, start, end });
        let on_wall = section.on_wall.as_ref().map(Section::curve2d);
        if let Some(flat) = section.on_wall {
            self.keep_on_wall(self.model.brep.coedges[meeting.coedge].edge, flat);
        }
        Ok(End { edge, on_blend: Section::curve2d(&section.on_surface), on_wall, far: (far, corner) })
    }

    fn note_wall(&mut self, gap: &Gap, section: &Section) {
        if let Some(flat) = &section.on_wall {
            self.keep_on_wall(self.model.brep.coedges[gap.coedge].edge, flat.clone());
        }
    }

    fn keep_on_wall(&mut self, edge: EdgeId, flat: NurbsCurve2) {
        if let Some(wall) = self.wall_of(edge) {
            self.walls.entry(wall).or_default().push(flat);
        }
    }

    /// Blend faces and secondary faces.
    fn faces(&mut self) -> Result<(), ReconstructionError> {
        for number in 0..self.rails.len() {
            let coedges = self.blend_bound(number)?;
            let surface = NewSurface::Own(Surface::Nurbs(self.rails[number].rail.blend.clone()));
            // A blend's normal looks into the ball's side of it, against the primary's.
            self.add_face(surface, coedges, Sense::Against);
        }
        for shape in 0..self.shapes.len() {
            let coedges = self.secondary_bound(shape)?;
            let surface = NewSurface::Own(Surface::Nurbs(self.shapes[shape].secondary.clone()));
            self.add_face(surface, coedges, Sense::With);
        }
        Ok(())
    }

    fn add_face(&mut self, surface: NewSurface, coedges: Vec<NewCoedge>, sense: Sense) {
        let same_sense = (sense == Sense::With) == self.outline.same_sense;
        let coedges = if same_sense { coedges } else { reversed(coedges) };
        let bounds = vec![NewBound { outer: true, coedges }];
        self.changes.new_faces.push(NewFace { beside: self.primary, surface, same_sense, bounds });
    }

    /// Once round a blend, counter-clockwise in its parameters.
    fn blend_bound(&self, number: usize) -> Result<Vec<NewCoedge>, ReconstructionError> {
        let progress = &self.rails[number];
        let Progress { near: Some(near), far: Some(far), ends: [Some(start), Some(end)], .. } = progress
        else {
            return Err(self.fault(number, "a line of the feature has no edges"));
        };
        let border = |u: f64| {
            move |_: f64, _: f64| Some(Curve2d::Line { origin: Point2::new(u, 0.0), direction: Vector2::y() })
        };
        let across = |end: &End, forward| NewCoedge {
            edge: EdgeRef::New(end.edge),
            forward,
            pcurve: Some(end.on_blend.clone()),
        };
        let mut coedges = vec![across(start, true)];
        coedges.extend(far.along(far.range(), &border(1.0)));
        coedges.push(across(end, false));
        coedges.extend(reversed(near.along(near.range(), &border(0.0))));
        Ok(coedges)
    }

    /// Once round a secondary surface, its inside to the left against the normal.
    fn secondary_bound(&self, shape: usize) -> Result<Vec<NewCoedge>, ReconstructionError> {
        let mine: Vec<usize> = (0..self.rails.len()).filter(|&k| self.rails[k].shape == shape).collect();
        let Some(&first) = mine.first() else { return Ok(Vec::new()) };
        let (mut coedges, mut at, mut seen) = (Vec::new(), first, BTreeSet::new());
        while seen.insert(at) {
            let rail = self.rails[at].rail;
            let flat = |from: f64, to: f64| rail.on_secondary.piece(from, to).ok().map(Curve2d::Nurbs);
            if let Some(far) = &self.rails[at].far {
                coedges.extend(far.along(far.range(), &flat));
            }
            let Some((next, joint)) = self.joints.get(&at) else { break };
            let pcurve = Some(joint.on_secondary.clone());
            coedges.push(NewCoedge { edge: EdgeRef::New(joint.edge), forward: true, pcurve });
            at = *next;
        }
        if seen.len() != mine.len() {
            return Err(
                self.fault(first, "the feature's lines do not make one bound of the secondary surface")
            );
        }
        Ok(coedges)
    }

    /// New bounds of the faces that stand on the border, and their surfaces where these have to be longer.
    fn walls(&mut self, gaps: &[Gap]) -> Result<(), ReconstructionError> {
        let brep = &self.model.brep;
        let edges: Vec<EdgeId> = self.pieces.edges().collect();
        let walls: BTreeSet<FaceId> = edges.iter().filter_map(|&edge| self.wall_of(edge)).collect();
        let chains = self.wall_chains(gaps);
        for wall in walls {
            for &bound in &brep.faces[wall].loops {
                let chain = |edge: EdgeId, k: usize| chains.get(&(edge, k)).cloned();
                let made = (&mut self.pieces, &mut self.changes);
                if let Some(new) = trim::rewired(brep, bound, &self.cuts, made, &chain) {
                    self.changes.removed_bounds.insert(bound);
                    self.changes.new_bounds.entry(wall).or_default().push(new);
                }
            }
            self.lengthen(wall);
        }
        Ok(())
    }

    /// For each stretch of border inside a feature, by its edge and its number there: the feature's edges along it.
    fn wall_chains(&self, gaps: &[Gap]) -> BTreeMap<(EdgeId, usize), Vec<NewCoedge>> {
        let brep = &self.model.brep;
        let mut chains = BTreeMap::new();
        for gap in gaps {
            let edge = brep.coedges[gap.coedge].edge;
            let (i, j) = (self.cuts[gap.enters].rail, self.cuts[gap.leaves].rail);
            let (Some((_, joint)), [_, Some(end)], [Some(start), _]) =
                (self.joints.get(&i), &self.rails[i].ends, &self.rails[j].ends)
            else {
                continue;
            };
            let one = |edge: NewEdgeId, pcurve: &Option<Curve2d>, forward| NewCoedge {
                edge: EdgeRef::New(edge),
                forward,
                pcurve: pcurve.clone(),
            };
            let chain = vec![
                one(end.edge, &end.on_wall, true),
                one(joint.edge, &joint.on_wall, true),
                one(start.edge, &start.on_wall, false),
            ];
            let all = self.pieces.cuts_of(edge);
            let place = |cut: usize| all.iter().position(|&k| self.cuts[k].vertex == self.cuts[cut].vertex);
            let (Some(from), Some(to)) = (place(gap.enters), place(gap.leaves)) else { continue };
            // The chain runs as the primary's bound does, along the edge or against it.
            let along = from < to;
            let k = from.max(to);
            chains.insert((edge, k), if along { chain } else { reversed(chain) });
        }
        chains
    }

    /// Gives a wall a surface that holds the feature's sections.
    fn lengthen(&mut self, wall: FaceId) {
        let Some(Surface::Nurbs(surface)) = self.model.brep.surface_of(wall).read() else { return };
        let held = self.walls.get(&wall).into_iter().flatten().flat_map(NurbsCurve2::control_points);
        let mut range = [surface.domain().0, surface.domain().1];
        for p in held {
            for k in 0..2 {
                range[k] = (range[k].0.min(p[k]), range[k].1.max(p[k]));
            }
        }
        let domain = [surface.domain().0, surface.domain().1];
        let beyond = |k: usize| {
            let margin = MARGIN * (range[k].1 - range[k].0);
            let more = |x: f64| if x > 0.0 { x + margin } else { 0.0 };
            (more(domain[k].0 - range[k].0), more(range[k].1 - domain[k].1))
        };
        let (u, v) = (beyond(0), beyond(1));
        if (u, v) == ((0.0, 0.0), (0.0, 0.0)) {
            return;
        }
        if let Ok(longer) = surface.extended(u, v) {
            self.changes.surfaces.insert(wall, Surface::Nurbs(longer));
        }
    }

    /// New bounds of the primary, and of its parts where a channel divides it; and what stood inside the features goes.
    fn bounds(&mut self, trimmed: Trimmed) -> Result<(), ReconstructionError> {
        let mut parts: Vec<Vec<NewBound>> = Vec::new();
        for coedges in trimmed.bounds {
            let outer = trimmed.cut.iter().any(|&k| self.model.brep.loops[self.outline.bounds[k].of].outer);
            parts.push(vec![self.turned(NewBound { outer, coedges })]);
        }
        let part_of = |at: [f64; 2]| trimmed.polygons.iter().position(|polygon| outline::inside(polygon, at));
        let mut gone = Vec::new();
        for (number, bound) in self.outline.bounds.iter().enumerate() {
            let Some(first) = bound.points.first().filter(|_| !trimmed.cut.contains(&number)) else {
                continue;
            };
            let at = [first.u, first.v];
            if self.rails.iter().any(|p| within(p.rail, at)) {
                gone.push(bound.of);
                continue;
            }
            match part_of(at) {
                None if parts.is_empty() => {}
                None => gone.push(bound.of),
                Some(0) => {}
                Some(part) => {
                    let kept = |&(c, forward): &(_, bool)| NewCoedge {
                        edge: EdgeRef::Kept(self.model.brep.coedges[c].edge),
                        forward,
                        pcurve: None,
                    };
                    let coedges = bound.coedges.iter().map(kept).collect();
                    parts[part].push(self.turned(NewBound { outer: false, coedges }));
                    self.changes.removed_bounds.insert(bound.of);
                }
            }
        }
        for number in 0..self.rails.len() {
            let cut = self.cuts.iter().any(|cut| cut.rail == number);
            let (Some(near), false) = (&self.rails[number].near, cut) else { continue };
            let rail = self.rails[number].rail;
            let flat =
                |from: f64, to: f64| piece_on(&rail.flat, (from, to), self.chart.periods(), self.chart);
            let coedges = reversed(near.along(near.range(), &flat));
            let hole = self.turned(NewBound { outer: false, coedges });
            match part_of(rail.flat.point_at(0.0).into()).unwrap_or(0) {
                part if part < parts.len() => parts[part].push(hole),
                _ => self.changes.new_bounds.entry(self.primary).or_default().push(hole),
            }
        }
        for &number in &trimmed.cut {
            self.changes.removed_bounds.insert(self.outline.bounds[number].of);
        }
        region::clear(self.model, self.primary, &gone, &mut self.changes)?;
        let mut parts = parts.into_iter();
        if let Some(first) = parts.next() {
            self.changes.new_bounds.entry(self.primary).or_default().extend(first);
        }
        for bounds in parts {
            let (surface, same_sense) = (NewSurface::Of(self.primary), self.outline.same_sense);
            self.changes.new_faces.push(NewFace { beside: self.primary, surface, same_sense, bounds });
        }
        Ok(())
    }

    /// A bound as seen against the face's normal.
    fn turned(&self, bound: NewBound) -> NewBound {
        let coedges = if self.outline.same_sense { bound.coedges } else { reversed(bound.coedges) };
        NewBound { coedges, ..bound }
    }
}

/// Whether a face looks the way the primary does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sense {
    With,
    Against,
}

/// Part of a wall's range of parameters by which it reaches beyond a section.
const MARGIN: f64 = 0.02;

/// A surface that reaches farther in its directions, by as much again on every side, where it can.
fn longer(surface: &Surface) -> Surface {
    let Surface::Nurbs(spline) = surface else { return surface.clone() };
    let (u, v) = spline.domain();
    let side = |(low, high): (f64, f64)| (high - low, high - low);
    spline.extended(side(u), side(v)).map_or_else(|_| surface.clone(), Surface::Nurbs)
}

/// A piece of a contact curve in the parameters of the face, moved by whole periods into the domain.
fn piece_on(
    flat: &NurbsCurve2,
    (from, to): (f64, f64),
    periods: [Option<f64>; 2],
    chart: &Chart<'_>,
) -> Option<Curve2d> {
    let piece = flat.piece(from, to).ok()?;
    let middle = flat.point_at(0.5 * (from + to));
    let starts = chart.starts();
    let shift = [0, 1].map(|k| match periods[k] {
        Some(period) => -period * ((middle[k] - starts[k]) / period).floor(),
        None => 0.0,
    });
    if shift == [0.0; 2] {
        return Some(Curve2d::Nurbs(piece));
    }
    let moved = piece.points().iter().map(|p| [p[0] + shift[0] * p[2], p[1] + shift[1] * p[2], p[2]]);
    NurbsCurve2::new(piece.knots().clone(), moved.collect()).ok().map(Curve2d::Nurbs)
}
