//! Curves made one: end to end, or as two opposite borders of a ruled surface.

use super::knot_vector::COINCIDENT;
use super::{KnotVector, KnotVectorError, NetError, NurbsCurve3, NurbsSurface};

/// Why curves cannot be made one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JoinError {
    /// There is no curve.
    #[error("there is no curve")]
    Nothing,
    /// Knots or degrees do not allow it.
    #[error(transparent)]
    Knots(#[from] KnotVectorError),
    /// The net does not.
    #[error(transparent)]
    Net(#[from] NetError),
}

impl NurbsCurve3 {
    /// The curves end to end, each over an interval of the length of its own domain, the first from `start` on. Where two
    /// meet, the latter says where; the degree is the highest among them.
    ///
    /// # Errors
    /// See [`JoinError`].
    pub fn joined(pieces: &[Self], start: f64) -> Result<Self, JoinError> {
        let degree = pieces.iter().map(|piece| piece.knots().degree()).max().ok_or(JoinError::Nothing)?;
        let (mut knots, mut points, mut at) = (Vec::new(), Vec::<[f64; 4]>::new(), start);
        for piece in pieces {
            let piece = piece.clamped().elevated(degree)?;
            let (first, last) = piece.domain();
            // The weight at a joint is that of both: a common factor moves no point.
            let weight = points.pop().map_or(1.0, |end| end[3] / piece.points()[0][3]);
            points.extend(piece.points().iter().map(|point| point.map(|coordinate| coordinate * weight)));
            let own = piece.knots().knots();
            let inner = &own[degree + 1..own.len() - degree - 1];
            knots.extend(std::iter::repeat_n(at, if knots.is_empty() { degree + 1 } else { degree }));
            knots.extend(inner.iter().map(|knot| at + (knot - first)));
            at += last - first;
        }
        knots.extend(std::iter::repeat_n(at, degree + 1));
        Ok(Self::new(KnotVector::new(degree, knots)?, points)?)
    }

    /// Clamped, over the interval from 0 to 1.
    fn unit(&self) -> Result<Self, JoinError> {
        let clamped = self.clamped();
        let (first, last) = clamped.domain();
        let factor = 1.0 / (last - first);
        let knots = clamped.knots().affine(factor, -first * factor)?;
        Ok(Self::new(knots, clamped.points().to_vec())?)
    }

    /// With the knots that another has more often.
    fn with_knots_of(&self, other: &Self) -> Result<Self, JoinError> {
        let (values, counts) = self.knots().distinct();
        let (wanted, wanted_counts) = other.knots().distinct();
        let mut more = Vec::new();
        for (&value, &count) in wanted.iter().zip(&wanted_counts) {
            let near = values.iter().position(|own| (own - value).abs() <= COINCIDENT);
            let (value, own) = near.map_or((value, 0), |at| (values[at], counts[at]));
            more.extend(std::iter::repeat_n(value, count.saturating_sub(own)));
        }
        Ok(self.refined(&more)?)
    }
}

impl NurbsSurface {
    /// The surface of the straight lines between points of equal parameters of two curves: `u` from 0 to 1 along both,
    /// `v` from 0 on the first to 1 on the second. Where their weights differ, `v` counts along a line as the weights of
    /// its ends have it; the points are those of the lines all the same.
    ///
    /// # Errors
    /// See [`JoinError`].
    pub fn ruled(first: &NurbsCurve3, second: &NurbsCurve3) -> Result<Self, JoinError> {
        let degree = first.knots().degree().max(second.knots().degree());
        let first = first.unit()?.elevated(degree)?;
        let second = second.unit()?.elevated(degree)?.with_knots_of(&first)?;
        let first = first.with_knots_of(&second)?;
        let net = first.points().iter().zip(second.points()).flat_map(|(a, b)| [*a, *b]).collect();
        let across = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0])?;
        Ok(Self::new(first.knots().clone(), across, net)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Curve;
    use crate::math::{Frame, Point3, Vector3};

    fn arc(from: f64, to: f64) -> NurbsCurve3 {
        let frame = Frame::from_axis(Point3::origin(), Vector3::z(), Some(Vector3::x())).expect("a frame");
        Curve::Circle { frame, radius: 2.0 }.to_nurbs((from, to)).expect("an arc")
    }

    fn line(a: [f64; 3], b: [f64; 3]) -> NurbsCurve3 {
        let (origin, end) = (Point3::from(a), Point3::from(b));
        Curve::Line { origin, direction: end - origin }.to_nurbs((0.0, 1.0)).expect("a line")
    }

    #[test]
    fn curves_end_to_end_are_each_where_they_were() {
        let pieces = [line([5.0, 0.0, 0.0], [2.0, 0.0, 0.0]), arc(0.0, 3.0), arc(3.0, 4.0)];
        let whole = NurbsCurve3::joined(&pieces, 10.0).expect("they join");
        assert_eq!(whole.domain(), (10.0, 15.0));
        assert_eq!(whole.knots().degree(), 2);
        let mut at = 10.0;
        for piece in &pieces {
            let (first, last) = piece.domain();
            for part in [0.0, 0.3, 0.77, 1.0] {
                let t = (last - first) * part;
                let off = (whole.point_at(at + t) - piece.point_at(first + t)).norm();
                assert!(off < 1e-13, "{off} at {part}");
            }
            at += last - first;
        }
    }

    #[test]
    fn a_ruled_surface_has_the_lines_between_equal_parameters() {
        let (a, b) = (arc(0.5, 2.5), line([0.0, 0.0, 3.0], [1.0, 1.0, 4.0]));
        let surface = NurbsSurface::ruled(&a, &b).expect("it is ruled");
        for u in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let (p, q) = (a.point_at(0.5 + 2.0 * u), b.point_at(u));
            assert!((surface.point(u, 0.0) - p).norm() < 1e-13);
            assert!((surface.point(u, 1.0) - q).norm() < 1e-13);
            let middle = surface.point(u, 0.4) - p;
            assert!(middle.cross(&(q - p)).norm() < 1e-12, "off the line at {u}");
        }
    }
}
