//! From a model and parameters to a change set: the face gets a deformed surface, and nothing else changes.

use serde::Serialize;

use super::line::{Traced, Tracer};
use super::{DeformError, Line, Normal, net};
use crate::brep::FaceId;
use crate::geometry::Surface;
use crate::geometry::nurbs::{NurbsSurface, Wrap};
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;
use crate::ops::force_density::{
    Constraint, Criteria, Deformed, ForceDensityError, Ghosts, Network, System, redundant,
};
use crate::ops::net::acting::closed_directions;
use crate::ops::net::layout::{Layout, face_name, lay_out_on, spline_of};
use crate::ops::net::sampling::steps;

/// How lines are met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// In balance with what is minimised, so many times as stiff.
    Penalty {
        /// Stiffness.
        strength: f64,
    },
    /// All at once at the points that count: the solution with multipliers.
    Exact,
}

/// Parameters of the operation.
#[derive(Debug, Clone)]
pub struct Params {
    /// The face.
    pub face: FaceId,
    /// Lines that it is pulled to.
    pub lines: Vec<Line>,
    /// What is minimised: weights for a net of `spans`, kept in their meaning when it is refined.
    pub criteria: Criteria,
    /// How lines are met.
    pub form: Form,
    /// Rows and columns at the border of the net that stay: 1 keeps the border, 2 its tangents too, 3 its curvature.
    pub margin: usize,
    /// Greatest distance of the lines from the surface, in file units. Left out: a thousandth of the greatest pull, at
    /// least the file's uncertainty.
    pub tolerance: Option<f64>,
    /// Least count of spans along `u` and `v`.
    pub spans: [usize; 2],
}

/// What is to be done, and what is known about it beforehand.
#[derive(Debug, Clone)]
pub struct Plan {
    /// New geometry.
    pub change_set: ChangeSet,
    /// Figures for the report.
    pub measures: Measures,
}

/// Figures of one operation. Lengths are in file units.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Measures {
    /// The face.
    pub face: String,
    /// Rows and columns of the net before and after.
    pub net: [[usize; 2]; 2],
    /// Control points that were free to move.
    pub free: usize,
    /// Points and normals that were asked for.
    pub constraints: usize,
    /// Those among them that say nothing new; in the exact form.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub redundant: Option<usize>,
    /// Times that the net was refined.
    pub refinements: usize,
    /// Greatest pull: the farthest point of a line from where it was on the face.
    pub pull: f64,
    /// Mean and greatest distance of the lines from the surface.
    pub deviation: [f64; 2],
    /// What the greatest one had to keep to.
    pub tolerance: f64,
    /// Greatest way of a point of the surface.
    pub moved: f64,
    /// Greatest turn of the surface's normal, in degrees.
    pub turned: f64,
}

/// Parts of a span between the points of a curve that count, in the penalty and in the exact form: more of the latter
/// would say more than the net can follow.
const STEP: [f64; 2] = [1.0 / 3.0, 1.0];
/// Refinements before the operation gives up.
const REFINEMENTS: usize = 5;
/// Control points of a net beyond which it is not refined any more.
const MOST_CONTROLS: usize = 60_000;
/// Constraints beyond which redundant ones are not counted.
const MOST_COUNTED: usize = 4000;
/// Default tolerance as a part of the greatest pull.
const RELATIVE: f64 = 1e-3;
/// Samples in each direction.
const SAMPLES: usize = 61;

/// Plans a deformation.
///
/// # Errors
/// See [`DeformError`]; nothing is changed in part.
pub fn plan(model: &Model, params: &Params) -> Result<Plan, OperationError> {
    let name = face_name(model, params.face);
    let Some(surface) = spline_of(model, params.face) else {
        let kind = model.brep.surface_of(params.face).read().map_or("not read", Surface::kind).to_owned();
        return Err(DeformError::SurfaceKind { face: name, kind }.into());
    };
    let layout = lay_out_on(model, params.face, surface)?;
    let [u, v] = closed_directions(surface).map(|period| period.is_some());
    let tracer = Tracer { model, face: params.face, surface, layout: &layout, wrap: Wrap { u, v } };
    let lines = tracer.traced(&params.lines)?;
    let pull = greatest(
        lines.iter().flat_map(|l| &l.points).map(|p| (surface.point(p.at[0], p.at[1]) - p.to).norm()),
    );
    let uncertainty = model.context_of(params.face).uncertainty.map_or(0.0, |t| t.0);
    let tolerance = params.tolerance.unwrap_or((RELATIVE * pull).max(uncertainty));
    let task = Task { surface, layout: &layout, lines: &lines, params, tolerance };
    let reached = task.carried_out()?;
    let (old, new) = (surface.shape(), reached.surface.shape());
    let measures = Measures {
        face: name,
        net: [[old.0, old.1], [new.0, new.1]],
        free: reached.free,
        constraints: reached.constraints,
        redundant: reached.redundant,
        refinements: reached.refinements,
        pull,
        deviation: [reached.deviation.mean, reached.deviation.greatest],
        tolerance,
        moved: reached.moved,
        turned: reached.turned,
    };
    let mut change_set = ChangeSet::default();
    change_set.surfaces.insert(params.face, Surface::Nurbs(reached.surface));
    Ok(Plan { change_set, measures })
}

struct Task<'a> {
    surface: &'a NurbsSurface,
    layout: &'a Layout,
    lines: &'a [Traced],
    params: &'a Params,
    tolerance: f64,
}

/// A deformation that meets the lines.
struct Reached {
    surface: NurbsSurface,
    free: usize,
    constraints: usize,
    redundant: Option<usize>,
    refinements: usize,
    deviation: Deviation,
    moved: f64,
    turned: f64,
}

/// Distances of the lines from a surface.
#[derive(Debug, Clone, Copy)]
struct Deviation {
    mean: f64,
    greatest: f64,
    /// Line and point of the greatest.
    worst: (usize, usize),
}

impl Task<'_> {
    /// Deforms nets that are finer and finer until the lines are met.
    fn carried_out(&self) -> Result<Reached, OperationError> {
        let fault = |_| DeformError::Network(ForceDensityError::NothingFree);
        let mut net = net::prepared(self.surface, self.params.spans).map_err(fault)?;
        let coarsest = net.net().len() as f64;
        let mut refinements = 0;
        loop {
            let criteria = self.params.criteria.refined((coarsest / net.net().len() as f64).sqrt());
            let result = self.deformed(&net, &criteria);
            let finer = net::halved(&net, self.lines).ok().filter(|n| n.net().len() <= MOST_CONTROLS);
            let finer = finer.filter(|_| refinements < REFINEMENTS);
            match result {
                Ok(mut reached) if reached.deviation.greatest <= self.tolerance => {
                    reached.refinements = refinements;
                    return Ok(reached);
                }
                // A finer net has more freedom: what contradicts or folds on a coarse one need not there.
                Err(error) if finer.is_none() || !error.may_go_on_a_finer_net() => return Err(error.into()),
                Ok(reached) if finer.is_none() => return Err(self.missed(&reached).into()),
                Ok(_) | Err(_) => {}
            }
            net = finer.unwrap_or(net);
            refinements += 1;
        }
    }

    fn deformed(&self, net: &NurbsSurface, criteria: &Criteria) -> Result<Reached, DeformError> {
        let free = net::free(self.surface, net, self.layout, self.params.margin);
        let count = free.count();
        let network = Network::new(net, Network::even_densities(net), Ghosts::Fixed, free);
        let constraints = self.constraints(net);
        let mut system = System::new(net, &network, criteria)?;
        let (Deformed { surface, .. }, redundant) = match self.params.form {
            Form::Penalty { strength } => {
                system.add(constraints.iter().copied())?;
                (system.balanced(strength)?, None)
            }
            Form::Exact => {
                let counted = constraints.len() <= MOST_COUNTED;
                let redundant = counted.then(|| redundant(net, &network, &constraints).len());
                (system.exact(&constraints, self.tolerance)?, redundant)
            }
        };
        let deviation = self.deviation(&surface);
        let (moved, turned) = compared(self.surface, &surface)?;
        Ok(Reached {
            moved,
            turned,
            surface,
            free: count,
            constraints: constraints.len(),
            redundant,
            refinements: 0,
            deviation,
        })
    }

    /// What is asked of a net.
    fn constraints(&self, net: &NurbsSurface) -> Vec<Constraint> {
        let step = STEP[usize::from(self.params.form == Form::Exact)];
        let mut all = Vec::new();
        for line in self.lines {
            for point in net::spaced(net, line, step).into_iter().map(|k| line.points[k]) {
                all.push(Constraint::through(point.at, &point.to, line.weight));
                let normal = match line.normal {
                    Normal::Free => None,
                    Normal::Keep => self.surface.normal(point.at[0], point.at[1]),
                    Normal::Along(direction) => Some(direction),
                };
                let wish = normal.and_then(|n| Constraint::with_normal(net, point.at, &n, line.weight));
                all.extend(wish.into_iter().flatten());
            }
        }
        all
    }

    fn deviation(&self, surface: &NurbsSurface) -> Deviation {
        let (mut sum, mut count) = (0.0, 0.0);
        let (mut greatest, mut worst) = (0.0, (0, 0));
        for (l, line) in self.lines.iter().enumerate() {
            for (k, point) in line.points.iter().enumerate() {
                let found = surface.closest_from(&point.to, (point.at[0], point.at[1]), Wrap::default());
                sum += found.distance;
                count += 1.0;
                if found.distance > greatest {
                    (greatest, worst) = (found.distance, (l, k));
                }
            }
        }
        Deviation { mean: sum / count, greatest, worst }
    }

    /// Why the lines are not met: because the face is held where they are missed most, or because its net is too coarse.
    fn missed(&self, reached: &Reached) -> DeformError {
        let (l, k) = reached.deviation.worst;
        let (line, point) = (self.lines[l].number, self.lines[l].points[k]);
        let free = net::free(self.surface, &reached.surface, self.layout, self.params.margin);
        if free_share(&reached.surface, &free, point.at) < HELD {
            let distance = (self.surface.point(point.at[0], point.at[1]) - point.to).norm();
            return DeformError::PullsHeld { line, at: point.to, distance };
        }
        let (rows, columns) = reached.surface.shape();
        let (reached, tolerance) = (reached.deviation.greatest, self.tolerance);
        DeformError::Tolerance { line, at: point.to, reached, tolerance, rows, columns }
    }
}

/// Share of the control points acting at a place that are free, by their weights there, below which it counts as held.
const HELD: f64 = 0.2;

fn free_share(net: &NurbsSurface, free: &crate::ops::net::Mask, at: [f64; 2]) -> f64 {
    let bu = net.knots_u().basis_derivatives(at[0], 0);
    let bv = net.knots_v().basis_derivatives(at[1], 0);
    let mut share = 0.0;
    for (i, x) in bu.values().iter().enumerate() {
        for (j, y) in bv.values().iter().enumerate() {
            if free.contains(bu.first() + i, bv.first() + j) {
                share += x * y;
            }
        }
    }
    share
}

/// Greatest way of a point and greatest turn of a normal in degrees, at equal parameters.
fn compared(old: &NurbsSurface, new: &NurbsSurface) -> Result<(f64, f64), DeformError> {
    let (u, v) = old.domain();
    let (us, vs): (Vec<f64>, Vec<f64>) =
        (steps(u.0, u.1, SAMPLES).collect(), steps(v.0, v.1, SAMPLES).collect());
    let (mut moved, mut turned) = (0.0_f64, 0.0_f64);
    for (a, b) in old.grid_derivatives(&us, &vs).iter().zip(new.grid_derivatives(&us, &vs)) {
        moved = moved.max((a.point - b.point).norm());
        let Some(normal) = a.normal() else { continue };
        match b.normal().filter(|n| n.dot(&normal) > 0.0) {
            Some(now) => turned = turned.max(now.angle(&normal)),
            None => return Err(DeformError::Folded { at: b.point }),
        }
    }
    Ok((moved, turned.to_degrees()))
}

fn greatest(all: impl Iterator<Item = f64>) -> f64 {
    all.fold(0.0, f64::max)
}
