//! Figures of a paste for the report.

use serde::Serialize;

use super::super::settings::Pasted;
use super::Place;
use crate::ops::net::sampling::steps;

/// Figures of one operation.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Measures {
    /// The target face.
    pub face: String,
    /// Control points before and after.
    pub control_points: [usize; 2],
    /// Kind of the surface that was made a B-spline, exactly; absent for a face that was one, or a plane.
    pub converted: Option<String>,
    /// Greatest distance in space by which its new curves in parameters miss the old ones.
    pub pcurve_error: Option<f64>,
    /// Holes of the feature that became bounds of the face.
    pub holes: usize,
    /// Greatest distance of their curves from the surface.
    pub hole_error: Option<f64>,
    /// Whether the seam along `u`, and along `v`, moved with the feature.
    pub seam_moved: [bool; 2],
    /// One for each place, in order.
    pub places: Vec<PlaceMeasures>,
}

/// Figures of one place. Lengths are in file units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaceMeasures {
    /// The place.
    pub at: [f64; 3],
    /// How the feature was carried.
    pub method: String,
    /// Rows and columns of the net after this place.
    pub net: [usize; 2],
    /// Control points that changed.
    pub changed: usize,
    /// Control points of the feature that were left out.
    pub lost: usize,
    /// Greatest displacement that was left out with them.
    pub lost_detail: f64,
    /// Control points that stayed because of loops of the target.
    pub protected: usize,
    /// Greatest distance between the surface before and after at equal parameters: the height of the feature.
    pub height: f64,
    /// Greatest mean curvature in the outermost cells of the region, over the target's there; absent where the target
    /// is flat.
    pub collar_curvature_ratio: Option<f64>,
    /// Greatest deviation of a fit.
    pub fit_error: Option<f64>,
}

/// Samples in each direction.
const SAMPLES: usize = 61;
/// Part of the region, on each side, that is its collar: the cells that only blend.
const COLLAR: f64 = 0.08;
/// Curvature times size below which a surface counts as flat.
const FLAT: f64 = 1e-9;

/// Measures one place.
///
/// The region may reach past the ends of a domain that closes on itself.
pub(super) fn measure(
    place: &Place,
    pasted: &Pasted,
    region: [(f64, f64); 2],
    protected: usize,
) -> PlaceMeasures {
    let (du, dv) = pasted.surface.domain();
    let wrapped = |x: f64, (start, end): (f64, f64)| {
        if x >= start && x <= end { x } else { start + (x - start).rem_euclid(end - start) }
    };
    let (rows, columns) = pasted.surface.shape();
    let mut height = 0.0_f64;
    let mut curvature = [0.0_f64; 2];
    for (i, u) in steps(region[0].0, region[0].1, SAMPLES).enumerate() {
        for (j, v) in steps(region[1].0, region[1].1, SAMPLES).enumerate() {
            let (u, v) = (wrapped(u, du), wrapped(v, dv));
            let (new, old) = (pasted.surface.derivatives(u, v), pasted.refined.derivatives(u, v));
            height = height.max((new.point - old.point).norm());
            let near = |k: usize| (k.min(SAMPLES - 1 - k) as f64) < COLLAR * SAMPLES as f64;
            if near(i) || near(j) {
                for (greatest, at) in curvature.iter_mut().zip([&new, &old]) {
                    let mean = at.curvatures().map_or(0.0, |(_, mean)| mean.abs());
                    *greatest = greatest.max(mean);
                }
            }
        }
    }
    let curved = curvature[1] * pasted.surface.bounding_box().diagonal() > FLAT;
    PlaceMeasures {
        at: place.at.coords.into(),
        method: pasted.method.as_str().to_owned(),
        net: [rows, columns],
        changed: pasted.changed.count(),
        lost: pasted.lost,
        lost_detail: pasted.lost_detail,
        protected,
        height,
        collar_curvature_ratio: curved.then(|| curvature[0] / curvature[1]),
        fit_error: pasted.fit_error,
    }
}
