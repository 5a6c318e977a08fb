//! The primary's bounds, and those of the walls on its border, cut where contact curves meet them and joined again.

use std::collections::BTreeMap;

use super::super::error::ReconstructionError;
use super::outline::{Bound, Meeting, Outline};
use crate::brep::{Brep, CoedgeId, EdgeId};
use crate::model::ChangeSet;
use crate::model::change_set::{
    EdgeCurve, EdgeRef, NewBound, NewCoedge, NewEdge, NewEdgeId, NewVertexId, VertexRef,
};

/// A meeting with the vertex that it becomes. `rail` counts the rails of all features.
#[derive(Debug, Clone, Copy)]
pub struct Cut {
    /// Where.
    pub meeting: Meeting,
    /// Its vertex.
    pub vertex: NewVertexId,
    /// The rail.
    pub rail: usize,
}

/// A stretch of border inside a feature, as the primary's bound runs.
#[derive(Debug, Clone, Copy)]
pub struct Gap {
    /// Where the bound enters the feature: the end of a rail. A number of a cut.
    pub enters: usize,
    /// Where it leaves the feature: the start of a rail.
    pub leaves: usize,
    /// The coedge.
    pub coedge: CoedgeId,
}

/// Cuts of edges, and the pieces that were made of them.
#[derive(Debug, Default)]
pub struct Pieces {
    /// Numbers of the cuts of each edge, from its start to its end.
    cuts: BTreeMap<EdgeId, Vec<usize>>,
    made: BTreeMap<(EdgeId, usize), NewEdgeId>,
}

impl Pieces {
    /// Of all cuts. A seam is cut twice at each place: by both its uses, with one vertex.
    #[must_use]
    pub fn of(brep: &Brep, cuts: &[Cut]) -> Self {
        let mut of: BTreeMap<EdgeId, Vec<usize>> = BTreeMap::new();
        for (number, cut) in cuts.iter().enumerate() {
            let all = of.entry(brep.coedges[cut.meeting.coedge].edge).or_default();
            if !all.iter().any(|&other| cuts[other].vertex == cut.vertex) {
                all.push(number);
            }
        }
        for (&edge, all) in &mut of {
            all.sort_by(|&a, &b| cuts[a].meeting.edge_at.total_cmp(&cuts[b].meeting.edge_at));
            if !brep.edges[edge].same_sense {
                all.reverse();
            }
        }
        Self { cuts: of, made: BTreeMap::new() }
    }

    /// The cut edges.
    pub fn edges(&self) -> impl Iterator<Item = EdgeId> + '_ {
        self.cuts.keys().copied()
    }

    /// Cuts of an edge, from its start to its end.
    #[must_use]
    pub fn cuts_of(&self, edge: EdgeId) -> &[usize] {
        self.cuts.get(&edge).map_or(&[], Vec::as_slice)
    }

    /// The edge between two neighbouring cuts: before the `k`-th, counted from the edge's start.
    pub fn piece(
        &mut self,
        brep: &Brep,
        changes: &mut ChangeSet,
        cuts: &[Cut],
        edge: EdgeId,
        k: usize,
    ) -> NewEdgeId {
        if let Some(&known) = self.made.get(&(edge, k)) {
            return known;
        }
        let all = self.cuts_of(edge);
        let of = &brep.edges[edge];
        let start =
            k.checked_sub(1).map_or(VertexRef::Kept(of.start), |k| VertexRef::New(cuts[all[k]].vertex));
        let end = all.get(k).map_or(VertexRef::Kept(of.end), |&cut| VertexRef::New(cuts[cut].vertex));
        let made = changes.new_edges.push(NewEdge { curve: EdgeCurve::Of(edge), start, end });
        self.made.insert((edge, k), made);
        made
    }
}

/// A place on the way round a bound.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// A whole edge, and whether the bound runs along it.
    Whole(EdgeId, bool),
    /// The piece of an edge before its `k`-th cut.
    Piece(EdgeId, usize, bool),
    /// A cut, by its number.
    Cut(usize),
}

impl Step {
    fn coedge(
        self,
        brep: &Brep,
        cuts: &[Cut],
        pieces: &mut Pieces,
        changes: &mut ChangeSet,
    ) -> Option<NewCoedge> {
        let (edge, forward) = match self {
            Self::Whole(edge, forward) => (EdgeRef::Kept(edge), forward),
            Self::Piece(edge, k, forward) => {
                (EdgeRef::New(pieces.piece(brep, changes, cuts, edge, k)), forward)
            }
            Self::Cut(_) => return None,
        };
        Some(NewCoedge { edge, forward, pcurve: None })
    }
}

/// Bounds of the primary after all cuts.
#[derive(Debug, Default)]
pub struct Trimmed {
    /// New bounds, run as the outline's are. Each is the outer one of a part of the primary.
    pub bounds: Vec<Vec<NewCoedge>>,
    /// A place within the primary's parameters on each bound.
    pub polygons: Vec<Vec<[f64; 2]>>,
    /// Bounds of the model that they take the place of, by their number in the outline.
    pub cut: Vec<usize>,
    /// Stretches of border inside features.
    pub gaps: Vec<Gap>,
}

/// For a rail, by its number, and two places on it: the uses of its edges from one to the other, and their polygon.
pub type RailUses<'a> = dyn Fn(usize, (f64, f64)) -> (Vec<NewCoedge>, Vec<[f64; 2]>) + 'a;

/// Cuts the outline and joins what is left along the rails.
///
/// # Errors
/// [`ReconstructionError::Trim`] where the cuts do not make bounds.
pub fn trimmed(
    brep: &Brep,
    outline: &Outline,
    cuts: &[Cut],
    (pieces, changes): (&mut Pieces, &mut ChangeSet),
    rail_uses: &RailUses<'_>,
) -> Result<Trimmed, ReconstructionError> {
    let mut out = Trimmed::default();
    let mut ways: Vec<(usize, Vec<Step>)> = Vec::new();
    for (number, bound) in outline.bounds.iter().enumerate() {
        let on_it = |cut: &Cut| cut.meeting.bound == number;
        if cuts.iter().any(on_it) {
            ways.push((number, steps(brep, bound, number, cuts, pieces)));
            out.cut.push(number);
        }
    }
    let mut done = vec![false; cuts.len()];
    for first in 0..cuts.len() {
        if cuts[first].meeting.enters || done[first] {
            continue;
        }
        let (mut coedges, mut polygon) = (Vec::new(), Vec::new());
        let mut at = first;
        loop {
            if std::mem::replace(&mut done[at], true) {
                return Err(lost(cuts, at));
            }
            let (kept, enters) = kept_from(&ways, at, cuts).ok_or_else(|| lost(cuts, at))?;
            polygon.extend(stretch(&outline.bounds[cuts[at].meeting.bound], cuts, at, enters));
            for step in kept {
                coedges.extend(step.coedge(brep, cuts, pieces, changes));
            }
            let leaves = back_along(cuts, enters).ok_or_else(|| lost(cuts, enters))?;
            let way = (cuts[leaves].meeting.rail_at, cuts[enters].meeting.rail_at);
            let (uses, line) = rail_uses(cuts[enters].rail, way);
            coedges.extend(super::rail::reversed(uses));
            polygon.extend(line.into_iter().rev());
            at = leaves;
            if at == first {
                break;
            }
        }
        out.bounds.push(coedges);
        out.polygons.push(polygon);
    }
    for (number, way) in &ways {
        gaps(*number, way, cuts, &mut out.gaps)?;
    }
    Ok(out)
}

fn lost(cuts: &[Cut], at: usize) -> ReconstructionError {
    ReconstructionError::Trim {
        near: cuts[at].meeting.point.coords.into(),
        reason: "the feature's lines and the border do not make a bound".to_owned(),
    }
}

/// The way round a bound: uses of whole edges and of pieces, and the cuts between them.
fn steps(brep: &Brep, bound: &Bound, number: usize, cuts: &[Cut], pieces: &Pieces) -> Vec<Step> {
    let mut way = Vec::new();
    for &(coedge, forward) in &bound.coedges {
        let edge = brep.coedges[coedge].edge;
        let mine = |vertex: NewVertexId| {
            let found = |cut: &Cut| {
                cut.vertex == vertex && cut.meeting.bound == number && cut.meeting.coedge == coedge
            };
            cuts.iter().position(found)
        };
        let all = pieces.cuts_of(edge).to_vec();
        if all.is_empty() {
            way.push(Step::Whole(edge, forward));
            continue;
        }
        for k in 0..=all.len() {
            let k = if forward { k } else { all.len() - k };
            way.push(Step::Piece(edge, k, forward));
            let next = if forward { all.get(k) } else { k.checked_sub(1).map(|k| &all[k]) };
            way.extend(next.and_then(|&cut| mine(cuts[cut].vertex)).map(Step::Cut));
        }
    }
    way
}

/// What is kept from a cut on, and the cut at which the feature begins.
fn kept_from(ways: &[(usize, Vec<Step>)], from: usize, cuts: &[Cut]) -> Option<(Vec<Step>, usize)> {
    let (_, way) = ways.iter().find(|(number, _)| *number == cuts[from].meeting.bound)?;
    let place = way.iter().position(|step| matches!(step, Step::Cut(cut) if *cut == from))?;
    let mut kept = Vec::new();
    for k in 1..=way.len() {
        match way[(place + k) % way.len()] {
            Step::Cut(cut) => return cuts[cut].meeting.enters.then_some((kept, cut)),
            step => kept.push(step),
        }
    }
    None
}

/// The cut at which a rail, followed backwards from where a bound enters the feature, comes back to a bound.
fn back_along(cuts: &[Cut], enters: usize) -> Option<usize> {
    let of = cuts[enters].rail;
    let here = cuts[enters].meeting.rail_at;
    let leaving = || (0..cuts.len()).filter(|&k| cuts[k].rail == of && !cuts[k].meeting.enters);
    let greatest = |k: &usize, l: &usize| cuts[*k].meeting.rail_at.total_cmp(&cuts[*l].meeting.rail_at);
    // A seam is cut at one place by both its uses: the one at the same place is no way back.
    let before = |k: &usize| cuts[*k].meeting.rail_at < here && cuts[*k].vertex != cuts[enters].vertex;
    leaving().filter(before).max_by(greatest).or_else(|| leaving().max_by(greatest))
}

/// Points of a bound between two cuts.
fn stretch(bound: &Bound, cuts: &[Cut], from: usize, to: usize) -> Vec<[f64; 2]> {
    let (from, to) = (cuts[from].meeting.along, cuts[to].meeting.along);
    let n = bound.points.len();
    let first = from.floor() as usize + 1;
    let last = to.floor() as usize + if to > from { 0 } else { n };
    (first..=last).map(|k| &bound.points[k % n]).map(|p| [p.u, p.v]).collect()
}

/// Stretches of a way inside features. A seam has none: what it loses has no other side.
fn gaps(number: usize, way: &[Step], cuts: &[Cut], out: &mut Vec<Gap>) -> Result<(), ReconstructionError> {
    let marks: Vec<usize> =
        way.iter().filter_map(|step| if let Step::Cut(cut) = step { Some(*cut) } else { None }).collect();
    for (k, &enters) in marks.iter().enumerate().filter(|(_, cut)| cuts[**cut].meeting.enters) {
        let leaves = marks[(k + 1) % marks.len()];
        let (a, b) = (&cuts[enters].meeting, &cuts[leaves].meeting);
        if b.enters || a.bound != number {
            return Err(lost(cuts, enters));
        }
        if a.coedge != b.coedge {
            return Err(ReconstructionError::Trim {
                near: a.point.coords.into(),
                reason: "the feature runs out over a corner of the border, between two edges".to_owned(),
            });
        }
        out.push(Gap { enters, leaves, coedge: a.coedge });
    }
    Ok(())
}

/// The bounds of a face beside the primary with the cut edges replaced: pieces where they are kept, and for each stretch
/// inside a feature what `chain` gives, along the edge. `None` for bounds that none of the edges is in.
pub fn rewired(
    brep: &Brep,
    bound: crate::brep::LoopId,
    cuts: &[Cut],
    (pieces, changes): (&mut Pieces, &mut ChangeSet),
    chain: &dyn Fn(EdgeId, usize) -> Option<Vec<NewCoedge>>,
) -> Option<NewBound> {
    let of = &brep.loops[bound];
    if !of.coedges.iter().any(|&c| !pieces.cuts_of(brep.coedges[c].edge).is_empty()) {
        return None;
    }
    let mut order: Vec<(CoedgeId, bool)> =
        of.coedges.iter().map(|&c| (c, brep.coedges[c].forward == of.forward)).collect();
    if !of.forward {
        order.reverse();
    }
    let mut coedges = Vec::new();
    for (coedge, forward) in order {
        let edge = brep.coedges[coedge].edge;
        let count = pieces.cuts_of(edge).len();
        if count == 0 {
            coedges.push(NewCoedge { edge: EdgeRef::Kept(edge), forward, pcurve: None });
            continue;
        }
        let mut along = Vec::new();
        for k in 0..=count {
            match chain(edge, k) {
                Some(section) => along.extend(section),
                None => {
                    let piece = pieces.piece(brep, changes, cuts, edge, k);
                    along.push(NewCoedge { edge: EdgeRef::New(piece), forward: true, pcurve: None });
                }
            }
        }
        coedges.extend(if forward { along } else { super::rail::reversed(along) });
    }
    Some(NewBound { outer: of.outer, coedges })
}
