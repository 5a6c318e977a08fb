//! From models and parameters to a change set: the target face gets its new surface, and nothing else changes.
//!
//! The source may be a face of another file, in other units. Loops of the target are kept clear of the feature, or
//! the paste is refused. Pure: no I/O. All or nothing.

mod holes;
mod measure;
mod source;
mod target;

pub use holes::Hole;
pub use measure::{Measures, PlaceMeasures};
pub use source::{Extracted, extract};

use super::across_seam::paste_across;
use super::settings::{Existing, Mirror, Pasted, Settings};
use super::{Feature, Ground, PasteError, contour::Plane};
use crate::brep::{BodyKind, FaceId};
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Affine, Matrix3, Point3, Vector3, rotation};
use crate::model::change_set::NewBound;
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;
use crate::ops::net::Mask;
use crate::ops::net::layout::face_name;
use crate::ops::net::spline_form::carry_tolerance;

/// What holds the feature on the source face. Lengths are in the source's units.
#[derive(Debug, Clone, PartialEq)]
pub enum Region {
    /// The face's outer loop.
    Outer,
    /// The inner loop of this number, counted from 0 in the face's order.
    Inner(usize),
    /// A closed polygon in the parameters of the surface.
    Parameters(Vec<[f64; 2]>),
    /// A closed polyline, and the plane along whose normal it goes onto the surface; without one, the polyline's own.
    Contour(Vec<Point3<f64>>, Option<Plane>),
}

/// What becomes of loops of the source inside the region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Holes {
    /// The surface is pasted across them.
    #[default]
    Close,
    /// The target gets them too.
    Carry,
}

/// The feature's face.
#[derive(Debug, Clone)]
pub struct FaceSource<'a> {
    /// Model that the face is in.
    pub model: &'a Model,
    /// The face.
    pub face: FaceId,
    /// What holds the feature.
    pub region: Region,
    /// Point near the face that goes to the place; `None` for the middle of the region.
    pub anchor: Option<Point3<f64>>,
}

/// One place on the target, in the target's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// A point on, or near, the target face.
    pub at: Point3<f64>,
    /// Direction of the feature's `u` in space, before the angle; `None` for the target's own `u`.
    pub along: Option<Vector3<f64>>,
    /// Angle of the feature there, in radians.
    pub angle: f64,
    /// Mirror of the feature there.
    pub mirror: Mirror,
    /// Factors along `u`, `v` and the normal.
    pub scale: [f64; 3],
}

/// What becomes of loops of the target that the feature meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TargetLoops {
    /// The paste is refused.
    #[default]
    Refuse,
    /// Control points that act on the loops stay: the feature is cut off there.
    Protect,
}

/// Parameters of the operation.
#[derive(Debug, Clone)]
pub struct Params<'a> {
    /// Where the feature comes from.
    pub source: &'a Extracted,
    /// The face that takes it.
    pub target: FaceId,
    /// Where it goes; each place has its own angle, mirror and scale, those of `settings` are not read.
    pub places: Vec<Place>,
    /// Method and the like; a tolerance of `None` is chosen by the feature's size.
    pub settings: Settings,
    /// Greatest deviation of a fit, in the target's units.
    pub tolerance: Option<f64>,
    /// Loops of the target in the way.
    pub loops: TargetLoops,
    /// Loops of the source inside the region.
    pub holes: Holes,
}

/// What is to be done, and what is known about it beforehand.
#[derive(Debug, Clone)]
pub struct Plan {
    /// New geometry.
    pub change_set: ChangeSet,
    /// Figures for the report.
    pub measures: Measures,
    /// Facts worth telling.
    pub notes: Vec<Diagnostic>,
}

/// Tolerance of a fit that nobody set, as a part of the feature's size.
const TOLERANCE: f64 = 2e-5;

/// Detail that is left out without a word, as a part of the feature's size.
const LOST: f64 = 1e-6;

/// Plans a paste, place after place on one surface.
///
/// # Errors
/// See [`PasteError`]; nothing is changed in part.
pub fn plan(model: &Model, params: &Params<'_>) -> Result<Plan, OperationError> {
    let target = target::Target::of(model, params.target)?;
    let sense = target::natural_sense(model, params.target);
    let source = source::Prepared::of(params.source, model.context_of(params.target), sense)?;
    let mut notes = Vec::new();
    let carries = params.holes == Holes::Carry && !source.holes.is_empty();
    if carries && opens_solid(model, params.target) {
        return Err(PasteError::HoleOpensSolid { face: face_name(model, params.target) }.into());
    }
    if !carries && !source.holes.is_empty() {
        let count = source.holes.len();
        let message =
            format!("{count} holes of the feature are not carried: the surface is pasted across them");
        notes.push(note("paste.holes-closed", Severity::Warning, message));
    }
    let mut holes: Vec<Hole> = Vec::new();
    let mut surface = target.form.surface.clone();
    let mut places: Vec<PlaceMeasures> = Vec::new();
    let mut regions: Vec<[(f64, f64); 2]> = Vec::new();
    let mut seam_moved = [false; 2];
    let before = surface.net().len();
    for place in &params.places {
        let one = pasted_at(&target, &source, &surface, place, params)?;
        if let Some(first) = regions.iter().position(|other| target.overlap(other, &one.region)) {
            return Err(PasteError::PlacesOverlap { first, second: regions.len() }.into());
        }
        regions.push(one.region);
        if one.cut > 0 {
            let message = format!(
                "{} control points stay, because they act on loops of the target: the feature is cut off there",
                one.cut
            );
            notes.push(note("paste.cut-at-loops", Severity::Warning, message));
        }
        for (k, moved) in seam_moved.iter_mut().enumerate() {
            *moved |= on_seam(&one.pasted.changed, k);
        }
        if carries {
            for hole in &source.holes {
                holes.push(holes::carried(hole, &one.pasted.map, &one.pasted.surface, target.form.round)?);
            }
        }
        places.push(measure::measure(place, &one.pasted, one.region, one.cut));
        surface = one.pasted.surface;
    }
    let lost = places.iter().map(|place| place.lost_detail).fold(0.0, f64::max);
    if lost > LOST * source.size {
        let message = format!(
            "the feature is cut off where it is up to {lost:.3e} high: control points there are too near to a border"
        );
        notes.push(note("paste.region-reduced", Severity::Warning, message));
    }
    let mut measures = Measures {
        face: model.origins.faces[params.target].to_string(),
        control_points: [before, surface.net().len()],
        holes: holes.len(),
        hole_error: None,
        converted: target.form.converted.map(str::to_owned),
        pcurve_error: target.form.converted.map(|_| target.form.pcurve_error),
        seam_moved,
        places,
    };
    let mut change_set = target.form.changes(model, params.target, surface.clone(), seam_moved);
    if !holes.is_empty() {
        let (bounds, error) = new_bounds(model, params.target, &surface, &holes, &mut change_set)?;
        measures.hole_error = Some(error);
        change_set.new_bounds.insert(params.target, bounds);
    }
    Ok(Plan { change_set, measures, notes })
}

/// The carried holes as bounds of the target on its finished surface, and how far they miss it.
fn new_bounds(
    model: &Model,
    face: FaceId,
    surface: &NurbsSurface,
    holes: &[Hole],
    changes: &mut ChangeSet,
) -> Result<(Vec<NewBound>, f64), OperationError> {
    let uncertainty = model.context_of(face).uncertainty.map(|t| t.0);
    let tolerance = carry_tolerance(uncertainty, surface.bounding_box().diagonal());
    let sense = model.brep.faces[face].same_sense;
    let mut bounds = Vec::new();
    let mut worst = 0.0_f64;
    for hole in holes {
        let (bound, error) = holes::bound(hole, surface, sense, tolerance, changes)?;
        worst = worst.max(error);
        bounds.push(bound);
    }
    Ok((bounds, worst))
}

/// Whether a hole in the face would open a closed shell.
fn opens_solid(model: &Model, face: FaceId) -> bool {
    let shell = &model.brep.shells[model.brep.faces[face].shell];
    shell.closed || model.brep.bodies[shell.body].kind == BodyKind::Solid
}

/// One place done.
struct PastedAt {
    pasted: Pasted,
    /// Parameters that it acts on, in the covering plane.
    region: [(f64, f64); 2],
    /// Control points that stayed for loops of the target.
    cut: usize,
}

fn pasted_at(
    target: &target::Target,
    source: &source::Prepared,
    surface: &NurbsSurface,
    place: &Place,
    params: &Params<'_>,
) -> Result<PastedAt, OperationError> {
    let at = target.locate(surface, place)?;
    let greatest = place.scale.iter().fold(0.0, |a: f64, s| a.max(s.abs()));
    let settings = Settings {
        scale: place.scale,
        mirror: place.mirror,
        angle: snapped(place.angle + turn_to(surface, at, place.along)?),
        tolerance: params.tolerance.unwrap_or(TOLERANCE * source.size * greatest),
        // An exact quadric has nothing in the feature's way.
        existing: match (params.settings.existing, target.form.converted) {
            (Existing::Replace, Some(_)) => Existing::Keep,
            (existing, _) => existing,
        },
        ..params.settings.clone()
    };
    target.refuse_method(&settings)?;
    let feature = Feature { source: &source.surface, contour: &source.contour, anchor: source.anchor };
    let crossed = paste_across(&feature, &Ground { target: surface, at }, &settings, target.form.round)?;
    let (mut pasted, region) = (crossed.pasted, crossed.region);
    let cut = keep_loops(target, &mut pasted, params.loops)?;
    Ok(PastedAt { pasted, region, cut })
}

/// Whether a set has a place on the first line of a direction.
fn on_seam(changed: &Mask, k: usize) -> bool {
    let (rows, columns) = changed.shape();
    if k == 0 {
        (0..columns).any(|j| changed.contains(0, j))
    } else {
        (0..rows).any(|i| changed.contains(i, 0))
    }
}

fn note(code: &'static str, severity: Severity, message: String) -> Diagnostic {
    Diagnostic { code, severity, entity: None, span: None, message }
}

/// Turns, in radians, that are rounding: the feature's own lines are then those of the target.
const NO_TURN: f64 = 1e-9;

fn snapped(angle: f64) -> f64 {
    let turn = angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round();
    if turn.abs() <= NO_TURN { 0.0 } else { angle }
}

/// Angle from the surface's `u` to a direction in space, about the surface's normal.
fn turn_to(surface: &NurbsSurface, at: [f64; 2], along: Option<Vector3<f64>>) -> Result<f64, PasteError> {
    let Some(along) = along else { return Ok(0.0) };
    let frame: Matrix3<f64> = super::frames::frame_at(surface, at, "target")?;
    let (x, y) = (frame.column(0).dot(&along), frame.column(1).dot(&along));
    if x == 0.0 && y == 0.0 {
        let found = format!("({}, {}, {})", along.x, along.y, along.z);
        return Err(PasteError::BadSetting { what: "along", expected: "a direction in the surface", found });
    }
    Ok(y.atan2(x))
}

/// Takes back what would move a loop of the target, or refuses; gives the count of control points that stay.
fn keep_loops(
    target: &target::Target,
    pasted: &mut Pasted,
    loops: TargetLoops,
) -> Result<usize, OperationError> {
    let mut stay = Mask::empty(pasted.changed.shape().0, pasted.changed.shape().1);
    for (name, acting) in target.form.acting_on_loops(&pasted.refined) {
        if acting.meets(&pasted.changed) {
            if loops == TargetLoops::Refuse {
                return Err(PasteError::TargetLoopInRegion { held: name }.into());
            }
            stay.unite(&acting);
        }
    }
    let kept = pasted.changed.without(&stay);
    let cut = pasted.changed.count() - kept.count();
    if cut > 0 {
        let refined = pasted.refined.net();
        let mut net = pasted.surface.net().to_vec();
        for at in pasted.changed.indices().filter(|&at| !kept.contains_index(at)) {
            net[at] = refined[at];
        }
        pasted.surface = super::base::with_net(&pasted.refined, net)?;
        pasted.changed = kept;
    }
    Ok(cut)
}

/// The places of a row: `count` of them, each `step` from the one before.
#[must_use]
pub fn linear_pattern(first: &Place, step: &Vector3<f64>, count: usize) -> Vec<Place> {
    (0..count).map(|k| Place { at: first.at + step * k as f64, ..*first }).collect()
}

/// The places of a ring about an axis: `count` of them over `angle`, the feature turning with them.
///
/// Over a full turn the last place stands one step before the first; else it stands at the end of the angle.
#[must_use]
pub fn circular_pattern(
    first: &Place,
    axis: (&Point3<f64>, &Vector3<f64>),
    angle: f64,
    count: usize,
    along: &Vector3<f64>,
) -> Vec<Place> {
    let Some(direction) = axis.1.try_normalize(0.0) else { return vec![*first] };
    let full = (angle.abs() - std::f64::consts::TAU).abs() < NO_TURN;
    let steps = if full { count } else { count.saturating_sub(1).max(1) };
    let place = |k: usize| {
        let turn = rotation(&direction, angle * k as f64 / steps as f64);
        let map = Affine::about(axis.0, turn);
        Place { at: map.point(&first.at), along: Some(turn * along), ..*first }
    };
    (0..count).map(place).collect()
}

/// Direction of the target's `u` at a point of a face: where a pattern begins to turn.
///
/// # Errors
/// [`PasteError::SurfaceKind`], [`PasteError::PlaceOffFace`], [`PasteError::SingularParametrisation`].
pub fn direction_at(model: &Model, face: FaceId, place: &Place) -> Result<Vector3<f64>, OperationError> {
    let target = target::Target::of(model, face)?;
    let at = target.locate(&target.form.surface, place)?;
    let frame = super::frames::frame_at(&target.form.surface, at, "target")?;
    Ok(frame.column(0).into_owned())
}
