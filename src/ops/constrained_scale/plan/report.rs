//! Figures of a plan for the report.

use serde::Serialize;

use super::hold::Held;
use super::layout::spline_of;
use super::scope::face_name;
use super::stretch::{SolvedGroup, Stretched};
use crate::geometry::nurbs::Deviation;
use crate::model::Model;
use crate::ops::OperationError;
use crate::ops::constrained_scale::measures::{
    MotionDeviation, REPORT_SAMPLES, certified, motion_deviation, quality,
};
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
    /// Greatest distance from the closest point of the plainly scaled surface, outside the held cells.
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

/// Figures of one group of held loops.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupMeasures {
    /// Its loops.
    pub loops: Vec<LoopMeasures>,
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
pub(super) fn measure(model: &Model, held: &Held, stretched: &Stretched) -> Result<Measures, OperationError> {
    let faces = stretched.faces.iter().map(|(&id, face)| {
        let (q, proved) = (quality(face, REPORT_SAMPLES), certified(face));
        let bound = |part: Option<Deviation>| part.map(|part| part.bound).filter(|bound| bound.is_finite());
        FaceMeasures {
            face: face_name(model, id),
            control_points: [face.points_before, face.surface.net().len()],
            refinements: face.level,
            area_ratio_min: face.compression.ratio,
            deviation_max: q.deviation_max,
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
    let mut groups = Vec::new();
    for SolvedGroup { loops, group, residual } in &stretched.groups {
        let mut measured = Vec::new();
        for &(face, k) in loops {
            let (id, contour, _) = &held.bases[&face].held[k];
            let before = spline_of(model, face).expect("a face with held loops is a B-spline");
            let after = &stretched.faces[&face].surface;
            let deviation = motion_deviation(before, after, &contour.points, &group.motion);
            let (face, held) = (face_name(model, face), model.origins.loops[*id].to_string());
            let MotionDeviation { rigid, relative, rounding } = deviation;
            if relative.is_nan() || relative > RIGIDITY + rounding {
                return Err(OperationError::RigidityLost { face, held, deviation: relative });
            }
            measured.push(LoopMeasures { held, face, motion_deviation: relative, rigid_deviation: rigid });
        }
        groups.push(GroupMeasures {
            loops: measured,
            axis: group.motion.axis.into(),
            shift: group.motion.shift().into(),
            merged: group.merged,
            residual: *residual,
        });
    }
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
    Ok(Measures { faces, groups, skins: skins.collect() })
}
