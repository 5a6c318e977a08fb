//! Points and derivatives of B-spline curves and surfaces.
//!
//! A4.2 and A4.4 of The NURBS Book to second order, on flat homogeneous nets with the basis on the stack;
//! nothing is allocated for a point. Parameters outside the domain continue the nearest span's polynomials.

use super::basis::LocalBasis;
use super::{KnotVector, NurbsCurve, NurbsCurve2, NurbsCurve3, NurbsSurface};
use crate::math::{Point2, Point3, Vector2, Vector3};

/// A point of a surface with its partial derivatives to second order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceDerivatives {
    /// The point.
    pub point: Point3<f64>,
    /// By `u`.
    pub du: Vector3<f64>,
    /// By `v`.
    pub dv: Vector3<f64>,
    /// Twice by `u`.
    pub duu: Vector3<f64>,
    /// By `u` and `v`.
    pub duv: Vector3<f64>,
    /// Twice by `v`.
    pub dvv: Vector3<f64>,
}

impl SurfaceDerivatives {
    /// `du × dv`, which is zero where the parametrisation is singular.
    #[must_use]
    pub fn cross(&self) -> Vector3<f64> {
        self.du.cross(&self.dv)
    }

    /// Unit normal; `None` where the parametrisation is singular.
    #[must_use]
    pub fn normal(&self) -> Option<Vector3<f64>> {
        self.cross().try_normalize(0.0)
    }

    /// Gaussian and mean curvature, the latter positive where the surface bends towards `du × dv`;
    /// `None` where the parametrisation is singular.
    #[must_use]
    pub fn curvatures(&self) -> Option<(f64, f64)> {
        let n = self.normal()?;
        let (e, f, g) = (self.du.norm_squared(), self.du.dot(&self.dv), self.dv.norm_squared());
        let (l, m, k) = (self.duu.dot(&n), self.duv.dot(&n), self.dvv.dot(&n));
        let det = e * g - f * f;
        (det > 0.0).then(|| ((l * k - m * m) / det, (e * k - 2.0 * f * m + g * l) / (2.0 * det)))
    }

    /// The greater absolute value of the two principal curvatures; `None` where the parametrisation is singular.
    #[must_use]
    pub fn greatest_curvature(&self) -> Option<f64> {
        let (gaussian, mean) = self.curvatures()?;
        Some(mean.abs() + (mean * mean - gaussian).max(0.0).sqrt())
    }
}

impl<const H: usize> NurbsCurve<H> {
    /// First and last parameter.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        self.knots().domain()
    }

    /// Homogeneous point and derivatives up to `order`, at most 2.
    fn homogeneous_at(&self, t: f64, order: usize) -> [[f64; H]; 3] {
        if self.knots().degree() < USUAL {
            return self.homogeneous(&self.knots().basis_in_room::<USUAL>(t, order), order);
        }
        self.homogeneous(&self.knots().basis_derivatives(t, order), order)
    }

    /// Homogeneous point and derivatives up to `order`, at most 2, by a given basis.
    fn homogeneous<const N: usize>(&self, basis: &LocalBasis<N>, order: usize) -> [[f64; H]; 3] {
        let mut out = [[0.0; H]; 3];
        let points = &self.points()[basis.first()..];
        for (k, sum) in out.iter_mut().enumerate().take(order + 1) {
            for (factor, point) in basis.derivatives(k).iter().zip(points) {
                for (s, c) in sum.iter_mut().zip(point) {
                    *s += factor * c;
                }
            }
        }
        out
    }

    /// Coordinates (all but the last) of point and derivatives after division by the weight.
    pub(super) fn rational(&self, t: f64, order: usize) -> [[f64; H]; 3] {
        divide(self.homogeneous_at(t, order))
    }
}

/// The quotient rule to second order (A4.2); the last coordinate of the result has no meaning.
fn divide<const H: usize>(mut a: [[f64; H]; 3]) -> [[f64; H]; 3] {
    let [point, first, second] = &mut a;
    let (w, w1, w2) = (point[H - 1], first[H - 1], second[H - 1]);
    for ((p, d), dd) in point.iter_mut().zip(first.iter_mut()).zip(second.iter_mut()).take(H - 1) {
        *p /= w;
        *d = (*d - w1 * *p) / w;
        *dd = (*dd - 2.0 * w1 * *d - w2 * *p) / w;
    }
    a
}

impl NurbsCurve3 {
    /// Homogeneous point `(w x, w y, w z, w)` at `t`.
    #[must_use]
    pub fn homogeneous_point(&self, t: f64) -> [f64; 4] {
        self.homogeneous_at(t, 0)[0]
    }

    /// Point at `t`.
    #[must_use]
    pub fn point_at(&self, t: f64) -> Point3<f64> {
        let [p, _, _] = self.rational(t, 0);
        Point3::new(p[0], p[1], p[2])
    }

    /// Point as a vector from the origin, first and second derivative at `t`.
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [Vector3<f64>; 3] {
        self.rational(t, 2).map(|d| Vector3::new(d[0], d[1], d[2]))
    }
}

impl NurbsCurve2 {
    /// Point at `t`.
    #[must_use]
    pub fn point_at(&self, t: f64) -> Point2<f64> {
        let [p, _, _] = self.rational(t, 0);
        Point2::new(p[0], p[1])
    }

    /// Point as a vector from the origin, first and second derivative at `t`.
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [Vector2<f64>; 3] {
        self.rational(t, 2).map(|d| Vector2::new(d[0], d[1]))
    }
}

/// Room for the functions of the degrees that nearly all surfaces have: below 6.
const USUAL: usize = 6;

/// Homogeneous sums of a surface: value, u, v, uu, uv, vv.
type Sums = [[f64; 4]; 6];

impl NurbsSurface {
    /// First and last `u`, first and last `v`.
    #[must_use]
    pub fn domain(&self) -> ((f64, f64), (f64, f64)) {
        (self.knots_u().domain(), self.knots_v().domain())
    }

    /// Homogeneous point `(w x, w y, w z, w)`.
    #[must_use]
    pub fn homogeneous_point(&self, u: f64, v: f64) -> [f64; 4] {
        self.sums_at::<0>(u, v)[0]
    }

    /// Point at `(u, v)`.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let h = self.homogeneous_point(u, v);
        Point3::new(h[0] / h[3], h[1] / h[3], h[2] / h[3])
    }

    /// Point and first derivatives by `u` and `v`: cheaper than [`derivatives`](Self::derivatives).
    #[must_use]
    pub fn first_derivatives(&self, u: f64, v: f64) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        let d = quotients(&self.sums_at::<1>(u, v));
        (d.point, d.du, d.dv)
    }

    /// Point and derivatives to second order.
    #[must_use]
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        quotients(&self.sums_at::<2>(u, v))
    }

    /// As [`derivatives`](Self::derivatives), of the plane through the point and both tangents: the second are zero.
    pub(super) fn tangent_plane(&self, u: f64, v: f64) -> SurfaceDerivatives {
        let (point, du, dv) = self.first_derivatives(u, v);
        let zero = Vector3::zeros();
        SurfaceDerivatives { point, du, dv, duu: zero, duv: zero, dvv: zero }
    }

    /// As [`derivatives`](Self::derivatives), by bases that were computed before with order 2.
    #[must_use]
    pub fn derivatives_by(&self, bu: &LocalBasis, bv: &LocalBasis) -> SurfaceDerivatives {
        quotients(&self.sums::<2, _>(bu, bv))
    }

    /// As [`point`](Self::point), by bases that were computed before.
    #[must_use]
    pub fn point_by(&self, bu: &LocalBasis, bv: &LocalBasis) -> Point3<f64> {
        let h = self.sums::<0, _>(bu, bv)[0];
        Point3::new(h[0] / h[3], h[1] / h[3], h[2] / h[3])
    }

    /// Unit normal `du × dv / |du × dv|`; `None` where the parametrisation is singular.
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<Vector3<f64>> {
        let (_, du, dv) = self.first_derivatives(u, v);
        du.cross(&dv).try_normalize(0.0)
    }

    /// Points over the grid `us × vs`, row by row in `u`; each basis is computed once.
    #[must_use]
    pub fn grid(&self, us: &[f64], vs: &[f64]) -> Vec<Point3<f64>> {
        let bases: Vec<LocalBasis> = vs.iter().map(|&v| self.knots_v().basis_derivatives(v, 0)).collect();
        let mut points = Vec::with_capacity(us.len() * vs.len());
        let nv = self.shape().1;
        let mut row = vec![[0.0; 4]; nv];
        for &u in us {
            let bu = self.knots_u().basis_derivatives(u, 0);
            self.row_at(&bu, &mut row);
            points.extend(bases.iter().map(|bv| {
                let mut h = [0.0; 4];
                for (factor, point) in bv.values().iter().zip(&row[bv.first()..]) {
                    accumulate(&mut h, *factor, point);
                }
                Point3::new(h[0] / h[3], h[1] / h[3], h[2] / h[3])
            }));
        }
        points
    }

    /// Derivatives to second order over the grid `us × vs`, row by row in `u`.
    #[must_use]
    pub fn grid_derivatives(&self, us: &[f64], vs: &[f64]) -> Vec<SurfaceDerivatives> {
        let bases: Vec<LocalBasis> = vs.iter().map(|&v| self.knots_v().basis_derivatives(v, 2)).collect();
        let mut out = Vec::with_capacity(us.len() * vs.len());
        // The columns of the net that any of the bases reaches.
        let first = bases.iter().map(LocalBasis::first).min().unwrap_or(0);
        let last = bases.iter().map(|basis| basis.span + 1).max().unwrap_or(0);
        let nv = self.shape().1;
        let mut rows = vec![[[0.0; 4]; 3]; last - first];
        for &u in us {
            let bu = self.knots_u().basis_derivatives(u, 2);
            rows.fill([[0.0; 4]; 3]);
            for i in 0..bu.values().len() {
                let source = &self.net()[(bu.first() + i) * nv..][first..last];
                let factors = [0, 1, 2].map(|order| bu.derivatives(order)[i]);
                for (row, point) in rows.iter_mut().zip(source) {
                    (0..3).for_each(|order| accumulate(&mut row[order], factors[order], point));
                }
            }
            out.extend(bases.iter().map(|bv| {
                let mut sums: Sums = [[0.0; 4]; 6];
                let values = bv.values().iter().zip(bv.derivatives(1)).zip(bv.derivatives(2));
                for (((&b, &db), &ddb), [p, pu, puu]) in values.zip(&rows[bv.first() - first..]) {
                    accumulate(&mut sums[0], b, p);
                    accumulate(&mut sums[1], b, pu);
                    accumulate(&mut sums[2], db, p);
                    accumulate(&mut sums[3], b, puu);
                    accumulate(&mut sums[4], db, pu);
                    accumulate(&mut sums[5], ddb, p);
                }
                quotients(&sums)
            }));
        }
        out
    }

    /// Points and first derivatives at places `(i, j)` of the grid `us × vs`; each basis is computed once.
    ///
    /// # Panics
    /// For a place outside the grid.
    #[must_use]
    pub fn grid_tangents(
        &self,
        us: &[f64],
        vs: &[f64],
        places: &[[usize; 2]],
    ) -> Vec<(Point3<f64>, Vector3<f64>, Vector3<f64>)> {
        if self.knots_u().degree().max(self.knots_v().degree()) < USUAL {
            self.tangents_by::<USUAL>(us, vs, places)
        } else {
            self.tangents_by::<{ KnotVector::MAX_DEGREE + 1 }>(us, vs, places)
        }
    }

    fn tangents_by<const N: usize>(
        &self,
        us: &[f64],
        vs: &[f64],
        places: &[[usize; 2]],
    ) -> Vec<(Point3<f64>, Vector3<f64>, Vector3<f64>)> {
        let along = |knots: &KnotVector, at: &[f64]| -> Vec<LocalBasis<N>> {
            at.iter().map(|&t| knots.basis_in_room(t, 1)).collect()
        };
        let (us, vs) = (along(self.knots_u(), us), along(self.knots_v(), vs));
        let at = |&[i, j]: &[usize; 2]| quotients(&self.sums::<1, N>(&us[i], &vs[j]));
        places.iter().map(at).map(|d| (d.point, d.du, d.dv)).collect()
    }

    /// Control points of the iso-curve of constant `u`.
    pub(super) fn row_at(&self, bu: &LocalBasis, row: &mut [[f64; 4]]) {
        let nv = self.shape().1;
        row.fill([0.0; 4]);
        for (i, factor) in bu.values().iter().enumerate() {
            let source = &self.net()[(bu.first() + i) * nv..][..nv];
            for (sum, point) in row.iter_mut().zip(source) {
                accumulate(sum, *factor, point);
            }
        }
    }

    /// Tensor-product sums at a place, up to the order that the constant names.
    #[inline]
    fn sums_at<const ORDER: usize>(&self, u: f64, v: f64) -> Sums {
        let (knots_u, knots_v) = (self.knots_u(), self.knots_v());
        if knots_u.degree().max(knots_v.degree()) < USUAL {
            let bu = knots_u.basis_in_room::<USUAL>(u, ORDER);
            let bv = knots_v.basis_in_room::<USUAL>(v, ORDER);
            return self.sums::<ORDER, USUAL>(&bu, &bv);
        }
        let (bu, bv) = (knots_u.basis_derivatives(u, ORDER), knots_v.basis_derivatives(v, ORDER));
        self.sums::<ORDER, _>(&bu, &bv)
    }

    /// Tensor-product sums up to the order that the constant names.
    #[inline]
    fn sums<const ORDER: usize, const N: usize>(&self, bu: &LocalBasis<N>, bv: &LocalBasis<N>) -> Sums {
        let nv = self.shape().1;
        let mut out = [[0.0; 4]; 6];
        let (u0, v0) = (bu.derivatives(0), bv.derivatives(0));
        let (u1, v1) = (bu.derivatives(1), bv.derivatives(1));
        let (u2, v2) = (bu.derivatives(2), bv.derivatives(2));
        for i in 0..u0.len() {
            let row = &self.net()[(bu.first() + i) * nv + bv.first()..][..v0.len()];
            let (mut a, mut b, mut c) = ([0.0; 4], [0.0; 4], [0.0; 4]);
            for (j, point) in row.iter().enumerate() {
                accumulate(&mut a, v0[j], point);
                if ORDER >= 1 {
                    accumulate(&mut b, v1[j], point);
                }
                if ORDER >= 2 {
                    accumulate(&mut c, v2[j], point);
                }
            }
            accumulate(&mut out[0], u0[i], &a);
            if ORDER >= 1 {
                accumulate(&mut out[1], u1[i], &a);
                accumulate(&mut out[2], u0[i], &b);
            }
            if ORDER >= 2 {
                accumulate(&mut out[3], u2[i], &a);
                accumulate(&mut out[4], u1[i], &b);
                accumulate(&mut out[5], u0[i], &c);
            }
        }
        out
    }
}

#[inline]
fn accumulate(sum: &mut [f64; 4], factor: f64, point: &[f64; 4]) {
    for (s, c) in sum.iter_mut().zip(point) {
        *s += factor * c;
    }
}

/// The quotient rule for a surface to second order (A4.4).
#[inline]
fn quotients(sums: &Sums) -> SurfaceDerivatives {
    let xyz = |k: usize| Vector3::new(sums[k][0], sums[k][1], sums[k][2]);
    let [_, wu, wv, wuu, wuv, wvv] = [0, 1, 2, 3, 4, 5].map(|k| sums[k][3]);
    let inverse = 1.0 / sums[0][3];
    let s = xyz(0) * inverse;
    let du = (xyz(1) - s * wu) * inverse;
    let dv = (xyz(2) - s * wv) * inverse;
    SurfaceDerivatives {
        point: Point3::from(s),
        du,
        dv,
        duu: (xyz(3) - du * (2.0 * wu) - s * wuu) * inverse,
        duv: (xyz(4) - dv * wu - du * wv - s * wuv) * inverse,
        dvv: (xyz(5) - dv * (2.0 * wv) - s * wvv) * inverse,
    }
}
