//! Where the deformed surface should be: points, tangents, normals. Each is one row over the control points near it.

use crate::geometry::nurbs::{LocalBasis, NurbsSurface};
use crate::math::{GridRow, Point3, Vector3};

/// What of the surface is prescribed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// The point.
    Point,
    /// The derivative along a direction of the parameter plane.
    Derivative([f64; 2]),
}

/// A wish for the deformed surface at fixed parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constraint {
    /// Parameters, within the domain.
    pub at: [f64; 2],
    /// What is prescribed.
    pub quantity: Quantity,
    /// Its value: a position vector, or a derivative by the parameters.
    pub wanted: Vector3<f64>,
    /// Weight against other constraints, positive.
    pub weight: f64,
}

/// A constraint made ready: `row · e = lack`.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    pub row: GridRow,
    /// Wanted value less the present one, in lengths.
    pub lack: [f64; 3],
    pub weight: f64,
}

impl Constraint {
    /// The surface passes through a point at these parameters.
    #[must_use]
    pub fn through(at: [f64; 2], point: &Point3<f64>, weight: f64) -> Self {
        Self { at, quantity: Quantity::Point, wanted: point.coords, weight }
    }

    /// The surface gets a normal at these parameters: the derivatives by `u` and `v` become what is left of the present
    /// ones across the normal, with their old lengths. `None` when one of them lies along the normal.
    ///
    /// The wish is one for derivatives and not for a vanishing product with the normal, which a surface turned inside
    /// out would fulfil too.
    #[must_use]
    pub fn with_normal(
        surface: &NurbsSurface,
        at: [f64; 2],
        normal: &Vector3<f64>,
        weight: f64,
    ) -> Option<[Self; 2]> {
        let normal = normal.try_normalize(0.0)?;
        let (_, du, dv) = surface.first_derivatives(at[0], at[1]);
        let turned = |d: Vector3<f64>| (d - normal * normal.dot(&d)).try_normalize(0.0).map(|t| t * d.norm());
        let along =
            |direction, wanted| Self { at, quantity: Quantity::Derivative(direction), wanted, weight };
        Some([along([1.0, 0.0], turned(du)?), along([0.0, 1.0], turned(dv)?)])
    }

    /// Where the constraint wants the surface, or where it stands when no point is wanted.
    pub(super) fn place(&self, surface: &NurbsSurface) -> Point3<f64> {
        match self.quantity {
            Quantity::Point => Point3::from(self.wanted),
            Quantity::Derivative(_) => surface.point(self.at[0], self.at[1]),
        }
    }

    /// The row over the control points, and what the surface lacks. A derivative counts as the way over one span, so
    /// that all rows are in lengths.
    pub(super) fn prepared(&self, surface: &NurbsSurface) -> Prepared {
        let [u, v] = self.at;
        let bu: LocalBasis = surface.knots_u().basis_derivatives(u, 1);
        let bv: LocalBasis = surface.knots_v().basis_derivatives(v, 1);
        let (values, present, scale) = match self.quantity {
            Quantity::Point => (rational(surface, &bu, &bv, None), surface.point(u, v).coords, 1.0),
            Quantity::Derivative(direction) => {
                let (_, du, dv) = surface.first_derivatives(u, v);
                let present = du * direction[0] + dv * direction[1];
                let spans = [(surface.knots_u(), bu.span), (surface.knots_v(), bv.span)];
                let [a, b] = spans.map(|(knots, k)| knots.knots()[k + 1] - knots.knots()[k]);
                let scale = 1.0 / (direction[0] / a).hypot(direction[1] / b);
                (rational(surface, &bu, &bv, Some(direction)), present, scale)
            }
        };
        let shape = [bu.values().len(), bv.values().len()];
        let values = values.into_iter().map(|x| scale * x).collect();
        let row = GridRow { first: [bu.first(), bv.first()], shape, values };
        Prepared { row, lack: ((self.wanted - present) * scale).into(), weight: self.weight }
    }
}

/// Rational basis functions at a place, or their derivatives along a direction, over the block of control points.
fn rational(
    surface: &NurbsSurface,
    bu: &LocalBasis,
    bv: &LocalBasis,
    direction: Option<[f64; 2]>,
) -> Vec<f64> {
    let columns = surface.shape().1;
    let weights: Vec<f64> = (0..bu.values().len())
        .flat_map(|i| &surface.net()[(bu.first() + i) * columns + bv.first()..][..bv.values().len()])
        .map(|point| point[3])
        .collect();
    let product = |a: &[f64], b: &[f64]| -> Vec<f64> {
        let all = a.iter().flat_map(|x| b.iter().map(move |y| x * y));
        all.zip(&weights).map(|(n, w)| n * w).collect()
    };
    let values = product(bu.values(), bv.values());
    let total: f64 = values.iter().sum();
    let Some([a, b]) = direction else { return values.into_iter().map(|x| x / total).collect() };
    let by_u = product(bu.derivatives(1), bv.values());
    let by_v = product(bu.values(), bv.derivatives(1));
    let slopes: Vec<f64> = by_u.iter().zip(&by_v).map(|(x, y)| a * x + b * y).collect();
    let slope: f64 = slopes.iter().sum();
    slopes.iter().zip(&values).map(|(d, x)| (d - x * slope / total) / total).collect()
}
