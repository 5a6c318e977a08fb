//! The method before fix-and-stretch, as far as its description goes: each loop keeps its shape and is attached to the
//! scaled surface where that is closest, and the surface is bent through the attached points by least squares.
//!
//! For comparison only. It trims the face anew, so that curves in parameters change, and its loops are not exact.

use resurf::geometry::nurbs::{LocalBasis, NurbsSurface};
use resurf::math::sparse::SymmetricFactor;
use resurf::math::{Affine, CsMat, Point3, TriMat, Vector3, cofactor, minimal_rotation};
use resurf::ops::net::grams::Grams;

/// A bent surface with its loops.
pub struct Attached {
    /// The scaled surface, bent.
    pub surface: NurbsSurface,
    /// The loops in its parameters.
    pub loops: Vec<Vec<[f64; 2]>>,
    /// Greatest distance of each loop from the shape that it should have, as a part of its extent.
    pub deviation: Vec<f64>,
}

/// Rows of the net that stay at each side of the border.
const ROWS: usize = 2;
/// Weight of stretching beside bending.
const STRETCH: f64 = 0.1;
/// Weight of the attached points beside the energy.
const ATTACHED: f64 = 1e7;
/// Steps of the search for closest points; after the fourth and the eighth the loop is moved along its normal.
const STEPS: usize = 12;
/// Points on each side of a polygon at which the loop is judged.
const FINER: usize = 8;

/// Attaches loops, polygons in the parameters of `original`, to the scaled surface `plain` and deforms that.
pub fn attach_and_deform(
    original: &NurbsSurface,
    plain: &NurbsSurface,
    map: &Affine,
    loops: &[Vec<[f64; 2]>],
) -> Attached {
    let placed: Vec<Placed> =
        loops.iter().map(|polygon| Placed::new(original, plain, map, polygon)).collect();
    let surface = deformed(plain, &placed);
    let deviation = placed.iter().map(|placed| placed.deviation(original, &surface)).collect();
    Attached { surface, loops: placed.into_iter().map(|placed| placed.at).collect(), deviation }
}

/// A loop that was attached.
struct Placed {
    polygon: Vec<[f64; 2]>,
    /// The rigid motion that gives it its shape.
    motion: Affine,
    targets: Vec<Point3<f64>>,
    /// Where its points are attached.
    at: Vec<[f64; 2]>,
}

impl Placed {
    fn new(original: &NurbsSurface, plain: &NurbsSurface, map: &Affine, polygon: &[[f64; 2]]) -> Self {
        let points: Vec<Point3<f64>> = polygon.iter().map(|p| original.point(p[0], p[1])).collect();
        let (pivot, area) = frame(&points);
        let scaled = cofactor(&map.linear) * area;
        let turn = minimal_rotation(&area, &scaled, &Vector3::x());
        let axis = scaled.normalize();
        let target = map.point(&pivot);
        let mut motion = Affine { linear: turn, translation: target.coords - turn * pivot.coords };
        let mut targets: Vec<Point3<f64>> = points.iter().map(|p| motion.point(p)).collect();
        let n = polygon.len() as f64;
        let middle = polygon.iter().fold([0.0; 2], |sum, p| [sum[0] + p[0] / n, sum[1] + p[1] / n]);
        let shrink = 2.0 / (map.linear[(0, 0)] + map.linear[(1, 1)]);
        let mut at: Vec<[f64; 2]> =
            polygon.iter().map(|p| [0, 1].map(|k| middle[k] + (p[k] - middle[k]) * shrink)).collect();
        for step in 0..STEPS {
            if step == 4 || step == 8 {
                let height = mean_height(plain, &at, &targets);
                motion.translation -= axis * height;
                targets.iter_mut().for_each(|target| *target -= axis * height);
            }
            for (at, target) in at.iter_mut().zip(&targets) {
                *at = closer(plain, *at, target);
            }
        }
        Self { polygon: polygon.to_vec(), motion, targets, at }
    }

    fn deviation(&self, original: &NurbsSurface, surface: &NurbsSurface) -> f64 {
        let (mut worst, mut low, mut high) =
            (0.0_f64, Vector3::repeat(f64::INFINITY), Vector3::repeat(-f64::INFINITY));
        for (p, q) in finer(&self.polygon).zip(finer(&self.at)) {
            let wanted = self.motion.point(&original.point(p[0], p[1]));
            worst = worst.max((surface.point(q[0], q[1]) - wanted).norm());
            (low, high) = (low.inf(&wanted.coords), high.sup(&wanted.coords));
        }
        worst / (high - low).max()
    }
}

/// Points along the sides of a polygon.
fn finer(polygon: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> + '_ {
    polygon.iter().zip(polygon.iter().cycle().skip(1)).flat_map(|(a, b)| {
        (0..FINER).map(move |k| [0, 1].map(|c| a[c] + (b[c] - a[c]) * k as f64 / FINER as f64))
    })
}

/// Mean of a polygon by its length, and its vector area.
fn frame(points: &[Point3<f64>]) -> (Point3<f64>, Vector3<f64>) {
    let (mut sum, mut length, mut area) = (Vector3::zeros(), 0.0, Vector3::zeros());
    for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
        let side = (b - a).norm();
        sum += (a.coords + b.coords) * (0.5 * side);
        length += side;
        area += 0.5 * (a - points[0]).cross(&(b - points[0]));
    }
    (Point3::from(sum / length), area)
}

/// Mean distance of the targets from the surface along its normals.
fn mean_height(surface: &NurbsSurface, at: &[[f64; 2]], targets: &[Point3<f64>]) -> f64 {
    let heights = at.iter().zip(targets).map(|(at, target)| {
        let (point, du, dv) = surface.first_derivatives(at[0], at[1]);
        (target - point).dot(&du.cross(&dv).normalize())
    });
    heights.sum::<f64>() / at.len() as f64
}

/// One step of Gauss and Newton towards the closest point.
fn closer(surface: &NurbsSurface, at: [f64; 2], target: &Point3<f64>) -> [f64; 2] {
    let (point, du, dv) = surface.first_derivatives(at[0], at[1]);
    let rest = target - point;
    let (e, f, g) = (du.norm_squared(), du.dot(&dv), dv.norm_squared());
    let (a, b) = (rest.dot(&du), rest.dot(&dv));
    let det = e * g - f * f;
    let step = [(g * a - f * b) / det, (e * b - f * a) / det];
    [0, 1].map(|k| (at[k] + step[k]).clamp(0.001, 0.999))
}

/// The surface of least bending and stretching against `plain` that passes the targets, as nearly as the weight says.
fn deformed(plain: &NurbsSurface, placed: &[Placed]) -> NurbsSurface {
    let (rows, columns) = plain.shape();
    let inner = |k: usize, n: usize| k >= ROWS && k + ROWS < n;
    let free: Vec<usize> =
        (0..rows * columns).filter(|k| inner(k / columns, rows) && inner(k % columns, columns)).collect();
    let mut place = vec![None; rows * columns];
    free.iter().enumerate().for_each(|(k, &index)| place[index] = Some(k));
    let grams = Grams::new(plain, [1.0, 1.0]);
    // The published stretching without its cross term: that of u alone and v alone.
    let stretching = stretching(plain);
    let energy: CsMat<f64> = &grams.bending() + &stretching.map(|x| x * STRETCH);
    let mut matrix = TriMat::new((free.len(), free.len()));
    for (row, entries) in energy.outer_iterator().enumerate() {
        for (column, value) in entries.iter() {
            if let (Some(i), Some(j)) = (place[row], place[column]) {
                matrix.add_triplet(i, j, *value);
            }
        }
    }
    let mut right = vec![0.0; 3 * free.len()];
    for placed in placed {
        for (at, target) in placed.at.iter().zip(&placed.targets) {
            let rest = target - plain.point(at[0], at[1]);
            let acting = acting(plain, *at, &place);
            for &(i, a) in &acting {
                acting.iter().for_each(|&(j, b)| matrix.add_triplet(i, j, ATTACHED * a * b));
                (0..3).for_each(|c| right[c * free.len() + i] += ATTACHED * a * rest[c]);
            }
        }
    }
    let factor = SymmetricFactor::new(&matrix.to_csr()).expect("the border holds the rest");
    factor.solve(&mut right);
    let mut net = plain.net().to_vec();
    for (k, &index) in free.iter().enumerate() {
        (0..3).for_each(|c| net[index][c] += right[c * free.len() + k]);
    }
    NurbsSurface::new(plain.knots_u().clone(), plain.knots_v().clone(), net).expect("the net fits its knots")
}

/// Integral of `X_u² + X_v²` over the unit square.
fn stretching(surface: &NurbsSurface) -> CsMat<f64> {
    use resurf::geometry::nurbs::gram;
    use resurf::math::kronecker_product;
    let [u, v] = [surface.knots_u(), surface.knots_v()];
    let product = |a: usize, b: usize| kronecker_product(gram(u, a, a).view(), gram(v, b, b).view());
    &product(1, 0) + &product(0, 1)
}

/// Free control points that act at a place, with their shares.
fn acting(surface: &NurbsSurface, at: [f64; 2], place: &[Option<usize>]) -> Vec<(usize, f64)> {
    let u: LocalBasis = surface.knots_u().basis_derivatives(at[0], 0);
    let v: LocalBasis = surface.knots_v().basis_derivatives(at[1], 0);
    let columns = surface.shape().1;
    let mut found = Vec::new();
    for (k, a) in u.values().iter().enumerate() {
        for (l, b) in v.values().iter().enumerate() {
            if let Some(i) = place[(u.first() + k) * columns + v.first() + l] {
                found.push((i, a * b));
            }
        }
    }
    found
}
