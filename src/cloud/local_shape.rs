//! The shape of a cloud round one of its points: a quadric over the plane of its neighbours.

use super::Neighbours;
use crate::math::{NormalEquations, Point3, PrincipalAxes, Vector3};

/// Normal and curvatures at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalShape {
    /// Unit normal; its sign has no meaning.
    pub normal: Vector3<f64>,
    /// Gaussian curvature.
    pub gaussian: f64,
    /// Mean curvature, positive where the cloud bends towards the normal.
    pub mean: f64,
    /// Root mean square of the neighbours' distances from the quadric, along the normal.
    pub residual: f64,
    /// Neighbours, the point itself among them.
    pub count: usize,
}

impl LocalShape {
    /// The greater absolute value of the principal curvatures.
    #[must_use]
    pub fn greatest_curvature(&self) -> f64 {
        self.mean.abs() + (self.mean * self.mean - self.gaussian).max(0.0).sqrt()
    }
}

/// Unknowns of a quadric.
const UNKNOWNS: usize = 6;

/// The shape round a place from the points within a radius; `None` when fewer than the quadric's unknowns are there or
/// they lie along a curve.
#[must_use]
pub fn local_shape(cloud: &Neighbours, at: &Point3<f64>, radius: f64) -> Option<LocalShape> {
    let mut near = Vec::new();
    cloud.within(at, radius, |k, _| near.push(cloud.points()[k]));
    if near.len() < UNKNOWNS {
        return None;
    }
    let [x, y, normal] = PrincipalAxes::of(near.iter())?.axes;
    // In units of the radius, so that all columns are of one size.
    let local = |p: &Point3<f64>| {
        let d = (p - at) / radius;
        [d.dot(&x), d.dot(&y), d.dot(&normal)]
    };
    let mut equations = NormalEquations::<UNKNOWNS>::default();
    for point in &near {
        let [x, y, z] = local(point);
        equations.add(&row(x, y), z, 1.0);
    }
    let c = equations.solved()?.values;
    let height = |x: f64, y: f64| row(x, y).iter().zip(&c).map(|(r, c)| r * c).sum::<f64>();
    let squares: f64 = near.iter().map(local).map(|[x, y, z]| (z - height(x, y)).powi(2)).sum();
    let (fx, fy) = (c[1], c[2]);
    let (fxx, fxy, fyy) = (2.0 * c[3] / radius, c[4] / radius, 2.0 * c[5] / radius);
    let area = 1.0 + fx * fx + fy * fy;
    let mean = ((1.0 + fy * fy) * fxx - 2.0 * fx * fy * fxy + (1.0 + fx * fx) * fyy) / (2.0 * area.powf(1.5));
    Some(LocalShape {
        normal: (normal - x * fx - y * fy).normalize(),
        gaussian: (fxx * fyy - fxy * fxy) / (area * area),
        mean,
        residual: radius * (squares / near.len() as f64).sqrt(),
        count: near.len(),
    })
}

fn row(x: f64, y: f64) -> [f64; UNKNOWNS] {
    [1.0, x, y, x * x, x * y, y * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a sphere, a cylinder and a plane on a grid about the first axis.
    fn grid(height: impl Fn(f64, f64) -> f64) -> Neighbours {
        let places = (0..41).flat_map(|i| (0..41).map(move |j| (f64::from(i - 20), f64::from(j - 20))));
        let points: Vec<_> =
            places.map(|(a, b)| (0.05 * a, 0.05 * b)).map(|(x, y)| Point3::new(x, y, height(x, y))).collect();
        Neighbours::new(&points)
    }

    #[test]
    fn a_sphere_a_cylinder_and_a_plane_have_their_curvatures() {
        let r = 4.0_f64;
        let radius = 0.3;
        for (cloud, gaussian, mean, greatest) in [
            (grid(|x, y| (r * r - x * x - y * y).sqrt()), 1.0 / (r * r), 1.0 / r, 1.0 / r),
            (grid(|x, _| (r * r - x * x).sqrt()), 0.0, 0.5 / r, 1.0 / r),
            (grid(|x, y| 0.3 * x - 0.2 * y), 0.0, 0.0, 0.0),
        ] {
            for k in [0, 400, 840] {
                let at = cloud.points()[k];
                if at.x.abs().max(at.y.abs()) > 0.7 {
                    continue;
                }
                let found = local_shape(&cloud, &at, radius).unwrap();
                // Terms of the fourth order: (radius / r)² of the curvature.
                let slack = 2.0 * (radius / r).powi(2) / r + 1e-9;
                assert!((found.gaussian - gaussian).abs() < slack / r + 1e-9);
                assert!((found.mean.abs() - mean).abs() < slack, "{found:?}");
                assert!((found.greatest_curvature() - greatest).abs() < 2.0 * slack.sqrt() * 0.1 + slack);
                assert!(found.residual < 1e-4);
            }
        }
    }

    #[test]
    fn points_along_a_line_or_too_few_have_no_shape() {
        let line: Vec<_> = (0..30).map(|k| Point3::new(0.01 * f64::from(k), 0.0, 0.0)).collect();
        assert_eq!(local_shape(&Neighbours::new(&line), &line[10], 1.0), None);
        assert_eq!(local_shape(&Neighbours::new(&line[..5]), &line[2], 1.0), None);
    }
}
