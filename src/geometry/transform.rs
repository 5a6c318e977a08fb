//! Exact affine images of curves and surfaces.
//!
//! A kind that has no exact image of a kind of ISO 10303-42 is refused by name, never approximated.
//!
//! The natural normal `du × dv` of an image points where `M⁻ᵀ n` does, except where
//! [`Surface::image_turns_normal`] says otherwise: a mirror turns it on surfaces that keep their parameters.

use super::nurbs::NurbsCurve2;
use super::{Curve, Curve2d, Surface, Trimmed};
use crate::math::{Affine, Frame, Matrix2, Point2, Vector2, Vector3, cofactor};
use std::f64::consts::FRAC_PI_2;

/// The affine image is not of a kind that the exchange formats know.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotRepresentable {
    /// The map would turn the kind into one that is not offered (a sphere into an ellipsoid).
    #[error("a {kind} has no exact image under this map")]
    Kind {
        /// Kind of curve or surface.
        kind: &'static str,
    },
    /// The map flattens the curve or surface.
    #[error("the map flattens a {kind}")]
    Degenerate {
        /// Kind of curve or surface.
        kind: &'static str,
    },
}

/// An affine map of the parameter plane: what an exact image does to the parameters of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterMap {
    /// Linear part.
    pub linear: Matrix2<f64>,
    /// Translation.
    pub translation: Vector2<f64>,
}

/// Relative difference of lengths, or cosine, below which two axes count as equal or perpendicular.
///
/// A few thousand rounding errors, so that composed rotations keep a circle a circle, while a scale of
/// six decimals does not pass for a uniform one.
const SAME: f64 = 1e-12;

impl ParameterMap {
    /// Parameters that stay.
    #[must_use]
    pub fn identity() -> Self {
        Self { linear: Matrix2::identity(), translation: Vector2::zeros() }
    }

    /// Factors along both parameters, then a shift.
    #[must_use]
    pub fn stretch(u: f64, v: f64, translation: Vector2<f64>) -> Self {
        Self { linear: Matrix2::new(u, 0.0, 0.0, v), translation }
    }

    /// Image of a point.
    #[must_use]
    pub fn point(&self, point: &Point2<f64>) -> Point2<f64> {
        Point2::from(self.linear * point.coords + self.translation)
    }

    /// Whether every parameter stays.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        *self == Self::identity()
    }
}

impl Curve {
    /// Exact image, parametrised as the curve is up to the constant of
    /// [`transformed_with_shift`](Self::transformed_with_shift).
    ///
    /// # Errors
    /// [`NotRepresentable::Degenerate`] when a line or conic is flattened.
    pub fn transformed(&self, map: &Affine) -> Result<Self, NotRepresentable> {
        self.transformed_with_shift(map).map(|(curve, _)| curve)
    }

    /// Exact image with the constant `s` for which `image(t - s)` is the image of `curve(t)`: not zero only
    /// where the axes of an ellipse turn against the material.
    ///
    /// # Errors
    /// [`NotRepresentable::Degenerate`] when a line or conic is flattened.
    pub fn transformed_with_shift(&self, map: &Affine) -> Result<(Self, f64), NotRepresentable> {
        match self {
            Self::Line { origin, direction } => {
                let image = map.vector(direction);
                if vanishes(image.norm(), SAME * map.linear.norm() * direction.norm()) {
                    return Err(NotRepresentable::Degenerate { kind: self.kind() });
                }
                Ok((Self::Line { origin: map.point(origin), direction: image }, 0.0))
            }
            Self::Circle { frame, radius } => conic_image(map, frame, *radius, *radius, self.kind()),
            Self::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
                conic_image(map, frame, *semi_axis_1, *semi_axis_2, self.kind())
            }
            Self::Nurbs(curve) => Ok((Self::Nurbs(curve.transformed(map)), 0.0)),
            Self::Polyline(curve) => Ok((Self::Polyline(curve.transformed(map)), 0.0)),
            Self::Parabola { frame, focal_distance } => {
                let (frame, factor) = similar_frame(map, frame, self.kind())?;
                Ok((Self::Parabola { frame, focal_distance: focal_distance * factor }, 0.0))
            }
            Self::Hyperbola { frame, semi_axis, semi_imaginary_axis } => {
                let (frame, factor) = similar_frame(map, frame, self.kind())?;
                let (semi_axis, semi_imaginary_axis) = (semi_axis * factor, semi_imaginary_axis * factor);
                Ok((Self::Hyperbola { frame, semi_axis, semi_imaginary_axis }, 0.0))
            }
            Self::Trimmed(piece) => {
                let (basis, shift) = piece.basis.transformed_with_shift(map)?;
                let (start, end) = (piece.start - shift, piece.end - shift);
                let shift = if piece.forward { shift } else { -shift };
                Ok((
                    Self::Trimmed(Trimmed { basis: Box::new(basis), start, end, forward: piece.forward }),
                    shift,
                ))
            }
            Self::Composite(whole) => {
                // A segment whose parameter would shift would need another interval: not offered.
                let image = whole.try_map(|curve| {
                    let (image, shift) = curve.transformed_with_shift(map)?;
                    let refused = NotRepresentable::Kind { kind: self.kind() };
                    if shift == 0.0 { Ok(image) } else { Err(refused) }
                })?;
                Ok((Self::Composite(image), 0.0))
            }
            Self::Offset { basis, distance, direction } => {
                let refused = NotRepresentable::Kind { kind: self.kind() };
                let factor = map.similarity_factor().ok_or(refused)?;
                let (basis, shift) = basis.transformed_with_shift(map)?;
                // A mirror turns a cross product against the images of its factors.
                let turn = if map.keeps_orientation() { 1.0 } else { -1.0 };
                let direction = map.vector(direction) / factor;
                let distance = distance * factor * turn;
                Ok((Self::Offset { basis: Box::new(basis), distance, direction }, shift))
            }
        }
    }
}

/// The frame of a curve's image under a similarity, its second axis the image of the second axis, and the
/// growth.
fn similar_frame(map: &Affine, frame: &Frame, kind: &'static str) -> Result<(Frame, f64), NotRepresentable> {
    let factor = map.similarity_factor().ok_or(NotRepresentable::Kind { kind })?;
    let (x, y) = (map.vector(&frame.x), map.vector(&frame.y));
    let frame = Frame::from_axis(map.point(&frame.origin), x.cross(&y), Some(x));
    Ok((frame.ok_or(NotRepresentable::Degenerate { kind })?, factor))
}

/// By how much a map makes lengths along a direction grow.
fn growth_along(map: &Affine, direction: &Vector3<f64>) -> f64 {
    map.vector(direction).norm() / direction.norm()
}

/// Whether a length is not above a bound, or not a number.
fn vanishes(length: f64, bound: f64) -> bool {
    length.is_nan() || length <= bound
}

/// Image of a conic by its conjugate radii `A = M x a`, `B = M y b`: `A cos t + B sin t` has its axes at `t0`
/// with `tan 2 t0 = 2 A·B / (A² - B²)`.
fn conic_image(
    map: &Affine,
    frame: &Frame,
    a: f64,
    b: f64,
    kind: &'static str,
) -> Result<(Curve, f64), NotRepresentable> {
    let (ca, cb) = (map.vector(&frame.x) * a, map.vector(&frame.y) * b);
    let (sa, sb, ab) = (ca.norm_squared(), cb.norm_squared(), ca.dot(&cb));
    let perpendicular = ab.abs() <= SAME * (sa * sb).sqrt();
    let mut shift = if perpendicular { 0.0 } else { 0.5 * (2.0 * ab).atan2(sa - sb) };
    let (sin, cos) = shift.sin_cos();
    let (mut first, mut second) = (ca * cos + cb * sin, cb * cos - ca * sin);
    // Readers are known that take the greater semi-axis for the first and count angles from it, whatever the file says.
    if a >= b && second.norm() > first.norm() * (1.0 + SAME) {
        (first, second) = (second, -first);
        shift += FRAC_PI_2;
    }
    let (r1, r2) = (first.norm(), second.norm());
    if vanishes(r1.min(r2), SAME * map.linear.norm() * a.max(b)) {
        return Err(NotRepresentable::Degenerate { kind });
    }
    let frame = Frame::from_axis(map.point(&frame.origin), first.cross(&second), Some(first))
        .ok_or(NotRepresentable::Degenerate { kind })?;
    let curve = if (r1 - r2).abs() <= SAME * r1.max(r2) {
        Curve::Circle { frame, radius: r1 }
    } else {
        Curve::Ellipse { frame, semi_axis_1: r1, semi_axis_2: r2 }
    };
    Ok((curve, shift))
}

/// How a map treats a frame whose turns about `z` it keeps as turns.
struct AxialImage {
    frame: Frame,
    /// Growth across the axis.
    across: f64,
    /// Growth along the axis.
    along: f64,
}

/// The image of a frame when the map commutes with turns about its axis.
fn axial_image(map: &Affine, frame: &Frame) -> Option<AxialImage> {
    let (x, y, z) = (map.vector(&frame.x), map.vector(&frame.y), map.vector(&frame.z));
    let (a, b, c) = (x.norm(), y.norm(), z.norm());
    let kept = (a - b).abs() <= SAME * a.max(b)
        && x.dot(&y).abs() <= SAME * a * b
        && x.dot(&z).abs() <= SAME * a * c
        && y.dot(&z).abs() <= SAME * b * c;
    let frame = Frame::from_axis(map.point(&frame.origin), z, Some(x))?;
    (kept && a > 0.0 && c > 0.0).then_some(AxialImage { frame, across: 0.5 * (a + b), along: c })
}

/// A frame of a plane's image: the normal as `M⁻ᵀ n`, the first axis as the image of the first axis.
fn plane_image(map: &Affine, frame: &Frame) -> Option<Frame> {
    let sign = if map.keeps_orientation() { 1.0 } else { -1.0 };
    let normal = cofactor(&map.linear) * frame.z * sign;
    Frame::from_axis(map.point(&frame.origin), normal, Some(map.vector(&frame.x)))
}

impl Surface {
    /// Exact image; parameters change by [`parameter_map`](Self::parameter_map).
    ///
    /// Planes, extrusions and B-splines follow every map that is not singular; cylinders, cones and
    /// revolutions those that keep turns about their axis; spheres and tori similarities.
    ///
    /// # Errors
    /// See [`NotRepresentable`].
    pub fn transformed(&self, map: &Affine) -> Result<Self, NotRepresentable> {
        let kind = self.kind();
        let refused = NotRepresentable::Kind { kind };
        match self {
            Self::Plane(frame) => {
                plane_image(map, frame).map(Self::Plane).ok_or(NotRepresentable::Degenerate { kind })
            }
            Self::Cylinder { frame, radius } => {
                let image = axial_image(map, frame).ok_or(refused)?;
                Ok(Self::Cylinder { frame: image.frame, radius: radius * image.across })
            }
            Self::Cone { frame, radius, semi_angle } => {
                let image = axial_image(map, frame).ok_or(refused)?;
                let similar = (image.across - image.along).abs() <= SAME * image.along;
                let slope = semi_angle.tan() * image.across / image.along;
                let semi_angle = if similar { *semi_angle } else { slope.atan() };
                Ok(Self::Cone { frame: image.frame, radius: radius * image.across, semi_angle })
            }
            Self::Sphere { frame, radius } => {
                let factor = map.similarity_factor().ok_or(refused.clone())?;
                let frame = axial_image(map, frame).ok_or(refused)?.frame;
                Ok(Self::Sphere { frame, radius: radius * factor })
            }
            Self::Torus { frame, major_radius, minor_radius } => {
                let factor = map.similarity_factor().ok_or(refused.clone())?;
                let frame = axial_image(map, frame).ok_or(refused)?.frame;
                Ok(Self::Torus {
                    frame,
                    major_radius: major_radius * factor,
                    minor_radius: minor_radius * factor,
                })
            }
            Self::LinearExtrusion { curve, direction } => {
                let growth = growth_along(map, direction);
                if vanishes(growth, 0.0) {
                    return Err(NotRepresentable::Degenerate { kind });
                }
                // The magnitude stays, since readers are known that do not look at it; the second parameter grows.
                let direction = map.vector(direction) / growth;
                Ok(Self::LinearExtrusion { curve: Box::new(curve.transformed(map)?), direction })
            }
            Self::Revolution { curve, frame } => {
                let mut image = axial_image(map, frame).ok_or(refused)?.frame;
                if !map.keeps_orientation() {
                    // A mirror turns the sense of the angle; the opposite axis gives it back.
                    image = Frame { origin: image.origin, x: image.x, y: -image.y, z: -image.z };
                }
                Ok(Self::Revolution { curve: Box::new(curve.transformed(map)?), frame: image })
            }
            Self::Nurbs(surface) => Ok(Self::Nurbs(surface.transformed(map))),
            Self::Offset { basis, distance } => {
                let factor = map.similarity_factor().ok_or(refused)?;
                let turn = if basis.image_turns_normal(map) { -1.0 } else { 1.0 };
                let distance = distance * factor * turn;
                Ok(Self::Offset { basis: Box::new(basis.transformed(map)?), distance })
            }
            // The rectangle stays what it is only where the parameters do.
            Self::Trimmed { basis, u, v, forward } => {
                if !basis.parameter_map(map)?.is_identity() {
                    return Err(refused);
                }
                let basis = Box::new(basis.transformed(map)?);
                Ok(Self::Trimmed { basis, u: *u, v: *v, forward: *forward })
            }
            Self::CurveBounded { .. } => Err(refused),
            Self::Composite(grid) => {
                let image = grid.try_map(|surface| {
                    if surface.parameter_map(map)?.is_identity() {
                        surface.transformed(map)
                    } else {
                        Err(NotRepresentable::Kind { kind })
                    }
                })?;
                Ok(Self::Composite(image))
            }
        }
    }

    /// Whether the natural normal of the image points against `M⁻ᵀ n`, so that the face's sense has to turn.
    #[must_use]
    pub fn image_turns_normal(&self, map: &Affine) -> bool {
        match self {
            Self::Nurbs(_) | Self::LinearExtrusion { .. } | Self::Revolution { .. } => {
                !map.keeps_orientation()
            }
            Self::Offset { basis, .. } | Self::Trimmed { basis, .. } | Self::CurveBounded { basis } => {
                basis.image_turns_normal(map)
            }
            Self::Composite(grid) => grid.patches()[0].surface.image_turns_normal(map),
            _ => false,
        }
    }

    /// The parameters on [`transformed`](Self::transformed) of the image of the point at given parameters.
    ///
    /// # Errors
    /// As [`transformed`](Self::transformed).
    pub fn parameter_map(&self, map: &Affine) -> Result<ParameterMap, NotRepresentable> {
        let kind = self.kind();
        let refused = NotRepresentable::Kind { kind };
        let zero = Vector2::zeros();
        let turn = if map.keeps_orientation() { 1.0 } else { -1.0 };
        match self {
            Self::Plane(frame) => {
                let image = plane_image(map, frame).ok_or(NotRepresentable::Degenerate { kind })?;
                let (x, y) = (map.vector(&frame.x), map.vector(&frame.y));
                let at = |v: &Vector3<f64>| (v.dot(&image.x), v.dot(&image.y));
                let ((a, c), (b, d)) = (at(&x), at(&y));
                Ok(ParameterMap { linear: Matrix2::new(a, b, c, d), translation: zero })
            }
            Self::Cylinder { frame, .. } | Self::Cone { frame, .. } => {
                let image = axial_image(map, frame).ok_or(refused)?;
                Ok(ParameterMap::stretch(turn, image.along, zero))
            }
            Self::Sphere { .. } | Self::Torus { .. } => {
                map.similarity_factor().ok_or(refused)?;
                Ok(ParameterMap::stretch(turn, 1.0, zero))
            }
            Self::LinearExtrusion { curve, direction } => {
                let shift = curve.transformed_with_shift(map)?.1;
                Ok(ParameterMap::stretch(1.0, growth_along(map, direction), Vector2::new(-shift, 0.0)))
            }
            Self::Revolution { curve, frame } => {
                axial_image(map, frame).ok_or(refused)?;
                let shift = curve.transformed_with_shift(map)?.1;
                Ok(ParameterMap::stretch(1.0, 1.0, Vector2::new(0.0, -shift)))
            }
            Self::Nurbs(_) | Self::Composite(_) => Ok(ParameterMap::identity()),
            Self::Offset { basis, .. } | Self::Trimmed { basis, .. } | Self::CurveBounded { basis } => {
                basis.parameter_map(map)
            }
        }
    }
}

impl Curve2d {
    /// Exact image in the parameter plane, with the parameter kept; an ellipse whose axes would turn is
    /// refused, since its parameter would shift against that of its edge.
    ///
    /// # Errors
    /// See [`NotRepresentable`].
    pub fn transformed(&self, map: &ParameterMap) -> Result<Self, NotRepresentable> {
        match self {
            Self::Line { origin, direction } => {
                let direction = map.linear * direction;
                if vanishes(direction.norm(), 0.0) {
                    return Err(NotRepresentable::Degenerate { kind: "line" });
                }
                Ok(Self::Line { origin: map.point(origin), direction })
            }
            Self::Ellipse { center, x, y, semi_axis_1, semi_axis_2 } => {
                let (a, b) = (map.linear * x * *semi_axis_1, map.linear * y * *semi_axis_2);
                let (r1, r2) = (a.norm(), b.norm());
                let right = a.x * b.y - a.y * b.x;
                if !(r1 > 0.0 && r2 > 0.0) {
                    return Err(NotRepresentable::Degenerate { kind: "ellipse" });
                }
                // A mirrored conic would run clockwise, which a placement in the plane cannot say.
                if a.dot(&b).abs() > SAME * r1 * r2 || right < 0.0 {
                    return Err(NotRepresentable::Kind { kind: "ellipse" });
                }
                let x = a / r1;
                let y = Vector2::new(-x.y, x.x);
                Ok(Self::Ellipse { center: map.point(center), x, y, semi_axis_1: r1, semi_axis_2: r2 })
            }
            Self::Nurbs(curve) => {
                let points = curve.points().iter().map(|p| {
                    let q = map.linear * Vector2::new(p[0], p[1]) + map.translation * p[2];
                    [q.x, q.y, p[2]]
                });
                let image = NurbsCurve2::new(curve.knots().clone(), points.collect())
                    .map_err(|_| NotRepresentable::Degenerate { kind: "b_spline" })?;
                Ok(Self::Nurbs(image))
            }
            _ => self.transformed_kept(map),
        }
    }

    /// The image under the maps that keep the other kinds: shifts for all but the scaled ones.
    fn transformed_kept(&self, map: &ParameterMap) -> Result<Self, NotRepresentable> {
        let shifts = map.linear == Matrix2::identity();
        let refused = NotRepresentable::Kind { kind: self.kind() };
        match self {
            Self::Polyline(curve) => match Self::Nurbs(curve.clone()).transformed(map)? {
                Self::Nurbs(image) => Ok(Self::Polyline(image)),
                _ => Err(refused),
            },
            Self::Trimmed(piece) => {
                let basis = Box::new(piece.basis.transformed(map)?);
                Ok(Self::Trimmed(Trimmed { basis, ..piece.clone() }))
            }
            Self::Composite(whole) => whole.try_map(|curve| curve.transformed(map)).map(Self::Composite),
            Self::Parabola { vertex, x, focal_distance } if shifts => {
                Ok(Self::Parabola { vertex: map.point(vertex), x: *x, focal_distance: *focal_distance })
            }
            Self::Hyperbola { center, .. } if shifts => {
                let mut image = self.clone();
                if let Self::Hyperbola { center: moved, .. } = &mut image {
                    *moved = map.point(center);
                }
                Ok(image)
            }
            Self::Offset { basis, distance } if shifts => {
                Ok(Self::Offset { basis: Box::new(basis.transformed(map)?), distance: *distance })
            }
            _ if map.is_identity() => Ok(self.clone()),
            _ => Err(refused),
        }
    }
}
