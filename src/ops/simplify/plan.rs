//! From a model and parameters to a change set: the face gets a surface with fewer knots, and nothing else changes.

use serde::Serialize;

use super::{SimplifyError, simplified};
use crate::brep::FaceId;
use crate::geometry::Surface;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;
use crate::ops::net::layout::{face_name, lay_out_on, spline_of};
use crate::ops::net::sampling::steps;
use crate::ops::net::{CellGrid, Mask};

/// Parameters of the operation.
#[derive(Debug, Clone, Copy)]
pub struct Params {
    /// The face.
    pub face: FaceId,
    /// Greatest distance from the old surface, in file units.
    pub tolerance: f64,
    /// Rows and columns at the border that stay: 1 keeps the border, 2 its tangents too.
    pub margin: usize,
}

/// What is to be done, and what is known about it beforehand.
#[derive(Debug, Clone)]
pub struct Plan {
    /// New geometry; empty when no knot can go.
    pub change_set: ChangeSet,
    /// Figures for the report.
    pub measures: Measures,
}

/// Figures of one operation. Lengths are in file units.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Measures {
    /// The face.
    pub face: String,
    /// Control points before and after.
    pub control_points: [usize; 2],
    /// Rows and columns of the net before and after.
    pub net: [[usize; 2]; 2],
    /// Knots removed along `u` and along `v`.
    pub knots_removed: [usize; 2],
    /// Certified bound of the distance from the old surface at equal parameters.
    pub deviation_bound: f64,
    /// Greatest such distance at samples.
    pub deviation_sampled: f64,
}

/// Samples in each direction.
const SAMPLES: usize = 61;

/// Plans the removal of knots.
///
/// # Errors
/// See [`SimplifyError`]; nothing is changed in part.
pub fn plan(model: &Model, params: &Params) -> Result<Plan, OperationError> {
    let name = face_name(model, params.face);
    let Some(surface) = spline_of(model, params.face) else {
        let kind = model.brep.surface_of(params.face).read().map_or("not read", Surface::kind).to_owned();
        return Err(SimplifyError::SurfaceKind { face: name, kind }.into());
    };
    let layout = lay_out_on(model, params.face, surface)?;
    let contours: Vec<_> = layout.loops.iter().flatten().map(|l| l.contour.clone()).collect();
    let held = |u: &KnotVector, v: &KnotVector| {
        let whole = Mask::empty(u.n_basis(), v.n_basis()).complement();
        let mut held = whole.without(&whole.off_border(params.margin));
        let grid = CellGrid::new(u, v);
        for contour in &contours {
            let next = contour.points.iter().cycle().skip(1);
            let sides = contour.points.iter().copied().zip(next.copied());
            // Along the border only the outermost rows act, which stay anyway.
            let inner = sides.filter(|(a, b)| !on_border(*a, *b, [u.domain(), v.domain()], contour.margin));
            held.unite(&grid.control_points(&grid.met_by_sides(inner, contour.margin)));
        }
        held
    };
    let result = simplified(surface, params.tolerance, &held).map_err(OperationError::from)?;
    let (old, new) = (surface.shape(), result.surface.shape());
    let measures = Measures {
        face: name,
        control_points: [surface.net().len(), result.surface.net().len()],
        net: [[old.0, old.1], [new.0, new.1]],
        knots_removed: result.removed,
        deviation_bound: result.bound,
        deviation_sampled: sampled(surface, &result.surface),
    };
    let mut change_set = ChangeSet::default();
    if result.removed != [0, 0] {
        change_set.surfaces.insert(params.face, Surface::Nurbs(result.surface));
    }
    Ok(Plan { change_set, measures })
}

fn on_border(a: [f64; 2], b: [f64; 2], border: [(f64, f64); 2], margin: [f64; 2]) -> bool {
    (0..2).any(|k| {
        let ends = [border[k].0, border[k].1];
        ends.iter().any(|x| (a[k] - x).abs() <= margin[k] && (b[k] - x).abs() <= margin[k])
    })
}

fn sampled(a: &NurbsSurface, b: &NurbsSurface) -> f64 {
    let (u, v) = a.domain();
    let off = |x: f64, y: f64| (a.point(x, y) - b.point(x, y)).norm();
    let all = steps(u.0, u.1, SAMPLES).flat_map(|x| steps(v.0, v.1, SAMPLES).map(move |y| (x, y)));
    all.map(|(x, y)| off(x, y)).fold(0.0, f64::max)
}
