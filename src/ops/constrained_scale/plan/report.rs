//! Figures of a plan for the report.

use serde::Serialize;

use super::Wall;
use super::contour::SpaceLoop;
use super::held::Held;
use super::scope::face_name;
use super::stretch::{Solved, Stretched};
use crate::brep::{LoopId, edge_range};
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::nurbs::Deviation;
use crate::math::Point3;
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;
use crate::ops::constrained_scale::measures::{
    MotionDeviation, REPORT_SAMPLES, certified, motion_deviation, quality,
};
use crate::ops::constrained_scale::motion::Motion;
use crate::ops::constrained_scale::skins::Thickness;

/// Figures of all faces with held loops.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Measures {
    /// Stretched faces, in order.
    pub faces: Vec<FaceMeasures>,
    /// Groups of held loops.
    pub groups: Vec<GroupMeasures>,
    /// Opposite faces that a feature ties together, with the material between them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub skins: Vec<SkinMeasures>,
}

/// The material between two opposite faces, measured along the normal of the first. Lengths are in file units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SkinMeasures {
    /// The faces.
    pub faces: [String; 2],
    /// Least, greatest and mean thickness as it was.
    pub thickness_before: [f64; 3],
    /// The same of the plain scaling.
    pub thickness_plain: [f64; 3],
    /// The same now.
    pub thickness: [f64; 3],
    /// Least quotient of the thickness now and the lesser of the two others at its place; below 0.8 is refused.
    pub least_ratio: f64,
}

/// Figures of one stretched face. Lengths are in file units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaceMeasures {
    /// The face.
    pub face: String,
    /// Control points before and after.
    pub control_points: [usize; 2],
    /// How often the spans were bisected.
    pub refinements: usize,
    /// Smallest ratio of the new oriented area element to the plainly scaled one.
    pub area_ratio_min: f64,
    /// Greatest distance from the closest point of the plainly scaled surface that was found outside the held cells, at
    /// samples and at the corners of cells.
    pub deviation_max: f64,
    /// Root mean square of these distances.
    pub deviation_rms: f64,
    /// Proved bound of these distances over all of the surface outside the held cells, not only at samples; absent where
    /// nothing could be proved.
    pub deviation_bound: Option<f64>,
    /// The same within the held cells, which keep their shape where the plain scaling does not.
    pub deviation_bound_held: Option<f64>,
    /// Greatest angle between the normals there, in degrees.
    pub normal_angle_max_deg: f64,
    /// Correlation of the Gaussian curvatures.
    pub gaussian_correlation: Option<f64>,
    /// Correlation of the mean curvatures.
    pub mean_correlation: Option<f64>,
    /// Ratio of the integrals of the squared principal curvatures.
    pub bending_ratio: Option<f64>,
}

/// Figures of held loops that move as one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupMeasures {
    /// Its loops.
    pub loops: Vec<LoopMeasures>,
    /// The motion `x -> linear x + translation` of the loops and of all that hangs on them, row by row.
    pub linear: [[f64; 3]; 3],
    /// Its translation, in file units.
    pub translation: [f64; 3],
    /// Its normal after the scaling.
    pub axis: [f64; 3],
    /// Displacement that the solve chose, in file units.
    pub shift: [f64; 3],
    /// Whether loops were joined because they lie too near to each other.
    pub merged: bool,
    /// Relative residual of the stationarity conditions.
    pub residual: f64,
}

/// Figures of one held loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoopMeasures {
    /// The loop.
    pub held: String,
    /// Its face.
    pub face: String,
    /// Greatest deviation from the motion that the mode imposes, relative to the loop's extent.
    pub motion_deviation: f64,
    /// Greatest deviation from a rigid copy, relative to the loop's extent: that of the motion where it is rigid, and
    /// of the best fit where `mode = "axes"` lets the loop scale.
    pub rigid_deviation: f64,
}

/// Deviation from the imposed motion above which the result is thrown away: a bug of ours.
const RIGIDITY: f64 = 1e-12;

/// Measures all stretched faces and held loops.
pub(super) fn measure(
    model: &Model,
    held: &Held,
    stretched: &Stretched,
    changes: &ChangeSet,
) -> Result<Measures, OperationError> {
    let faces = stretched.faces.iter().map(|(&id, face)| {
        let (q, proved) = (quality(face, REPORT_SAMPLES), certified(face));
        let bound = |part: Option<Deviation>| part.map(|part| part.bound).filter(|bound| bound.is_finite());
        FaceMeasures {
            face: face_name(model, id),
            control_points: [face.points_before, face.surface.net().len()],
            refinements: face.level,
            area_ratio_min: face.compression.ratio,
            deviation_max: proved.outside.map_or(0.0, |outside| outside.found).max(q.deviation_max),
            deviation_rms: q.deviation_rms,
            deviation_bound: bound(proved.outside),
            deviation_bound_held: bound(proved.held),
            normal_angle_max_deg: q.normal_angle_max.to_degrees(),
            gaussian_correlation: q.gaussian_correlation,
            mean_correlation: q.mean_correlation,
            bending_ratio: q.bending_ratio,
        }
    });
    let faces = faces.collect();
    let groups = stretched.pieces.iter().map(|solved| group(model, held, stretched, changes, solved));
    let skins = stretched.skins.iter().map(|(faces, pair)| {
        let numbers = |t: Thickness| [t.least, t.greatest, t.mean];
        SkinMeasures {
            faces: faces.map(|face| face_name(model, face)),
            thickness_before: numbers(pair.before),
            thickness_plain: numbers(pair.plain),
            thickness: numbers(pair.after),
            least_ratio: pair.least_ratio,
        }
    });
    Ok(Measures { faces, groups: groups.collect::<Result<_, _>>()?, skins: skins.collect() })
}

fn group(
    model: &Model,
    held: &Held,
    stretched: &Stretched,
    changes: &ChangeSet,
    solved: &Solved,
) -> Result<GroupMeasures, OperationError> {
    let motion = &solved.piece.motion;
    let mut loops = Vec::new();
    for &number in &solved.piece.part.loops {
        let of = &held.loops[number];
        let net = held.bases[&of.face].net().zip(stretched.faces.get(&of.face));
        let deviation = match net {
            Some((base, after)) => {
                let contour = base.held.iter().find(|(k, _)| *k == number).map(|(_, contour)| contour);
                let points = contour.map_or(&[][..], |contour| &contour.points);
                motion_deviation(&base.surface, &after.surface, points, motion)
            }
            None => curve_deviation(model, of.id, changes, motion)?,
        };
        let (face, held) = (face_name(model, of.face), model.origins.loops[of.id].to_string());
        let MotionDeviation { rigid, relative, rounding } = deviation;
        if relative.is_nan() || relative > RIGIDITY + rounding {
            return Err(OperationError::RigidityLost { face, held, deviation: relative });
        }
        loops.push(LoopMeasures { held, face, motion_deviation: relative, rigid_deviation: rigid });
    }
    Ok(GroupMeasures {
        loops,
        linear: [0, 1, 2].map(|i| [0, 1, 2].map(|k| motion.linear[(i, k)])),
        translation: motion.apply(&Point3::origin()).coords.into(),
        axis: motion.axis.into(),
        shift: motion.shift().into(),
        merged: solved.merged,
        residual: solved.residual,
    })
}

/// Deviation of the new curves of a loop from the motion of the old ones: all there is where a loop lies on a plane.
fn curve_deviation(
    model: &Model,
    id: LoopId,
    changes: &ChangeSet,
    motion: &Motion,
) -> Result<MotionDeviation, OperationError> {
    let mut pairs: Vec<(Point3<f64>, Point3<f64>)> = Vec::new();
    for &coedge in &model.brep.loops[id].coedges {
        let edge = model.brep.coedges[coedge].edge;
        let before = SpaceLoop::points_of(model, edge)?;
        let (Some(range), Some(old)) = (edge_range(&model.brep, edge), model.brep.curve_of(edge).read())
        else {
            continue;
        };
        let new = changes.curves.get(&edge).unwrap_or(old);
        let last = (before.len() - 1) as f64;
        for (k, point) in before.into_iter().enumerate() {
            let expected = motion.apply(&point);
            let t = range.start + (range.end - range.start) * (k as f64 / last);
            let at = if motion.is_rigid() { t } else { new.parameter_of(&expected, None) };
            pairs.push((point, new.point_wrapped(at)));
        }
    }
    Ok(MotionDeviation::of_pairs(&pairs, motion))
}

/// What the report says beside figures: features that were joined, walls that became longer by themselves.
pub(super) fn notes(model: &Model, held: &Held, stretched: &Stretched, wall: Wall) -> Vec<Diagnostic> {
    let mut notes = Vec::new();
    for solved in stretched.pieces.iter().filter(|solved| solved.merged) {
        let loops = solved.piece.part.loops.iter();
        let names: Vec<String> = loops.map(|&k| model.origins.loops[held.loops[k].id].to_string()).collect();
        notes.push(warning(
            "scale.features-merged",
            names.first().cloned(),
            format!("too near to each other to part, the loops {} move as one", names.join(", ")),
        ));
    }
    if wall == Wall::Rigid {
        for ring in &stretched.rings {
            let faces: Vec<String> = ring.faces.iter().map(|&f| face_name(model, f)).collect();
            notes.push(warning(
                "scale.wall-length-scaled",
                faces.first().cloned(),
                format!(
                    "the wall of {} is made longer: planes at its ends move apart, and only its cross-section is held",
                    faces.join(", ")
                ),
            ));
        }
    }
    notes
}

fn warning(code: &'static str, entity: Option<String>, message: String) -> Diagnostic {
    Diagnostic { code, severity: Severity::Warning, entity, span: None, message }
}
