//! Exact changes of form: nets from points and weights, reversal, swapped parameters, affine images,
//! iso-curves, boxes, closedness.

use super::refine::transposed;
use super::surface::Extent;
use super::{KnotVector, NetError, NurbsCurve, NurbsCurve2, NurbsCurve3, NurbsSurface};
use crate::math::{Affine, BoundingBox, Point2, Point3};

impl<const H: usize> NurbsCurve<H> {
    /// For callers that keep the invariants by construction.
    pub(super) fn from_valid(knots: KnotVector, points: Vec<[f64; H]>) -> Self {
        debug_assert_eq!(knots.n_basis(), points.len(), "count of control points");
        Self::new_unchecked(knots, points)
    }

    /// Weights of the control points.
    pub fn weights(&self) -> impl Iterator<Item = f64> + '_ {
        self.points().iter().map(|p| p[H - 1])
    }

    /// The same curve run the other way over the same domain.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self::from_valid(self.knots().reversed(), self.points().iter().rev().copied().collect())
    }
}

impl NurbsCurve3 {
    /// From control points in space with weights; `None` for weights that are all 1.
    ///
    /// # Errors
    /// See [`NetError`].
    pub fn from_points(
        knots: KnotVector,
        points: &[Point3<f64>],
        weights: Option<&[f64]>,
    ) -> Result<Self, NetError> {
        check_weights(points.len(), weights)?;
        let net = points.iter().enumerate().map(|(i, p)| lift(p, weights.map_or(1.0, |w| w[i])));
        Self::new(knots, net.collect())
    }

    /// Control points in space.
    pub fn control_points(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        self.points().iter().map(project)
    }

    /// Exact image under an affine map: weights and knots stay.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        Self::from_valid(self.knots().clone(), self.points().iter().map(|p| image(map, p)).collect())
    }

    /// Box of the control points, which holds the curve.
    #[must_use]
    pub fn bounding_box(&self) -> BoundingBox {
        let mut bounds = BoundingBox::EMPTY;
        self.control_points().for_each(|p| bounds.include(&p));
        bounds
    }

    /// Whether the ends of the domain meet within a distance.
    #[must_use]
    pub fn is_closed(&self, tolerance: f64) -> bool {
        let (start, end) = self.domain();
        (self.point_at(start) - self.point_at(end)).norm() <= tolerance
    }
}

impl NurbsCurve2 {
    /// From control points in the plane with weights; `None` for weights that are all 1.
    ///
    /// # Errors
    /// See [`NetError`].
    pub fn from_points(
        knots: KnotVector,
        points: &[Point2<f64>],
        weights: Option<&[f64]>,
    ) -> Result<Self, NetError> {
        check_weights(points.len(), weights)?;
        let net = points.iter().enumerate().map(|(i, p)| {
            let w = weights.map_or(1.0, |w| w[i]);
            [p.x * w, p.y * w, w]
        });
        Self::new(knots, net.collect())
    }

    /// Control points in the plane.
    pub fn control_points(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.points().iter().map(|p| Point2::new(p[0] / p[2], p[1] / p[2]))
    }
}

impl NurbsSurface {
    /// For callers that keep the invariants by construction.
    pub(super) fn from_valid(knots_u: KnotVector, knots_v: KnotVector, net: Vec<[f64; 4]>) -> Self {
        debug_assert_eq!(knots_u.n_basis() * knots_v.n_basis(), net.len(), "count of control points");
        Self::new_unchecked(knots_u, knots_v, net)
    }

    /// From control points in space, row by row in `u`, with weights; `None` for weights that are all 1.
    ///
    /// # Errors
    /// See [`NetError`].
    pub fn from_points(
        knots_u: KnotVector,
        knots_v: KnotVector,
        points: &[Point3<f64>],
        weights: Option<&[f64]>,
    ) -> Result<Self, NetError> {
        check_weights(points.len(), weights)?;
        let net = points.iter().enumerate().map(|(i, p)| lift(p, weights.map_or(1.0, |w| w[i])));
        Self::new(knots_u, knots_v, net.collect())
    }

    /// Control points in space, row by row in `u`.
    pub fn control_points(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        self.net().iter().map(project)
    }

    /// Weights, row by row in `u`.
    pub fn weights(&self) -> impl Iterator<Item = f64> + '_ {
        self.net().iter().map(|p| p[3])
    }

    /// The surface with its parameters exchanged; the normal turns round.
    #[must_use]
    pub fn swapped(&self) -> Self {
        let (nu, nv) = self.shape();
        Self::from_valid(self.knots_v().clone(), self.knots_u().clone(), transposed(self.net(), nu, nv))
    }

    /// The surface with `u` running the other way over the same domain; the normal turns round.
    #[must_use]
    pub fn reversed_u(&self) -> Self {
        let nv = self.shape().1;
        let net = self.net().chunks_exact(nv).rev().flatten().copied().collect();
        Self::from_valid(self.knots_u().reversed(), self.knots_v().clone(), net)
    }

    /// The surface with `v` running the other way over the same domain; the normal turns round.
    #[must_use]
    pub fn reversed_v(&self) -> Self {
        let nv = self.shape().1;
        let net = self.net().chunks_exact(nv).flat_map(|row| row.iter().rev()).copied().collect();
        Self::from_valid(self.knots_u().clone(), self.knots_v().reversed(), net)
    }

    /// Exact image under an affine map: weights and knots stay. A mirror turns `du × dv` against the image
    /// of the old normal.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let net = self.net().iter().map(|p| image(map, p)).collect();
        Self::from_valid(self.knots_u().clone(), self.knots_v().clone(), net)
    }

    /// The curve of constant `u`, running with `v`.
    #[must_use]
    pub fn iso_curve_u(&self, u: f64) -> NurbsCurve3 {
        let basis = self.knots_u().basis_derivatives(u, 0);
        let mut row = vec![[0.0; 4]; self.shape().1];
        self.row_at(&basis, &mut row);
        NurbsCurve3::from_valid(self.knots_v().clone(), row)
    }

    /// The curve of constant `v`, running with `u`.
    #[must_use]
    pub fn iso_curve_v(&self, v: f64) -> NurbsCurve3 {
        let basis = self.knots_v().basis_derivatives(v, 0);
        let combine = |row: &[[f64; 4]]| {
            let mut sum = [0.0; 4];
            for (factor, point) in basis.values().iter().zip(&row[basis.first()..]) {
                for (s, c) in sum.iter_mut().zip(point) {
                    *s += factor * c;
                }
            }
            sum
        };
        let points = self.net().chunks_exact(self.shape().1).map(combine).collect();
        NurbsCurve3::from_valid(self.knots_u().clone(), points)
    }

    /// Box of the control points, which holds the surface.
    #[must_use]
    pub fn bounding_box(&self) -> BoundingBox {
        self.spanned().bounds
    }

    /// Whether the first and last curve of constant `u` agree within a distance, control point by control
    /// point.
    #[must_use]
    pub fn is_closed_u(&self, tolerance: f64) -> bool {
        self.spanned().apart[0] <= tolerance
    }

    /// Whether the first and last curve of constant `v` agree within a distance, control point by control
    /// point.
    #[must_use]
    pub fn is_closed_v(&self, tolerance: f64) -> bool {
        self.spanned().apart[1] <= tolerance
    }

    fn spanned(&self) -> &Extent {
        self.extent(|| {
            let apart = |a: NurbsCurve3, b: NurbsCurve3| {
                let pairs = a.control_points().zip(b.control_points());
                pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
            };
            let ((u0, u1), (v0, v1)) = self.domain();
            let around_u = apart(self.iso_curve_u(u0), self.iso_curve_u(u1));
            let around_v = apart(self.iso_curve_v(v0), self.iso_curve_v(v1));
            let mut bounds = BoundingBox::EMPTY;
            self.control_points().for_each(|p| bounds.include(&p));
            Extent { bounds, apart: [around_u, around_v] }
        })
    }
}

fn check_weights(points: usize, weights: Option<&[f64]>) -> Result<(), NetError> {
    match weights {
        Some(w) if w.len() != points => Err(NetError::CountMismatch { expected: points, found: w.len() }),
        _ => Ok(()),
    }
}

fn lift(point: &Point3<f64>, weight: f64) -> [f64; 4] {
    [point.x * weight, point.y * weight, point.z * weight, weight]
}

fn project(point: &[f64; 4]) -> Point3<f64> {
    Point3::new(point[0] / point[3], point[1] / point[3], point[2] / point[3])
}

fn image(map: &Affine, point: &[f64; 4]) -> [f64; 4] {
    let moved = map.linear * scaled_part(point) + map.translation * point[3];
    [moved.x, moved.y, moved.z, point[3]]
}

fn scaled_part(point: &[f64; 4]) -> crate::math::Vector3<f64> {
    crate::math::Vector3::new(point[0], point[1], point[2])
}
