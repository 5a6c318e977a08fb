//! Knots and nets of the B-spline entities, shared by curves in space, curves in the plane and surfaces.

use super::error::ReadError;
use crate::geometry::nurbs::{KnotVector, KnotVectorError};
use crate::step::entity::Entity;
use crate::step::view::EntityView;
use crate::step::{Parameter, Parameters};

/// How the knots of a B-spline entity follow from its type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// Knots and multiplicities are written.
    WithKnots,
    /// Simple knots, one apart, not clamped.
    Uniform,
    /// Knots one apart, clamped.
    QuasiUniform,
    /// Knots one apart, of multiplicity `degree` inside and `degree + 1` at the ends.
    Bezier,
}

impl Form {
    /// The form of a curve's or surface's type, or `None` when it names none.
    pub(super) fn of(view: &EntityView<'_>) -> Option<Self> {
        let forms = [
            (Entity::BSplineCurveWithKnots, Self::WithKnots),
            (Entity::BSplineSurfaceWithKnots, Self::WithKnots),
            (Entity::QuasiUniformCurve, Self::QuasiUniform),
            (Entity::QuasiUniformSurface, Self::QuasiUniform),
            (Entity::UniformCurve, Self::Uniform),
            (Entity::UniformSurface, Self::Uniform),
            (Entity::BezierCurve, Self::Bezier),
            (Entity::BezierSurface, Self::Bezier),
        ];
        // The deepest partial type decides without a look at the others.
        let by_entity = forms.iter().find(|(entity, _)| *entity == view.entity());
        by_entity.or_else(|| forms.iter().find(|(entity, _)| view.is(*entity))).map(|(_, form)| *form)
    }
}

/// Knots as they are written: distinct values with multiplicities.
pub(super) struct WrittenKnots<'a> {
    pub(super) multiplicities: Parameters<'a>,
    pub(super) knots: Parameters<'a>,
    /// ` in u`, ` in v`, or nothing: for the message.
    pub(super) direction: &'static str,
}

impl WrittenKnots<'_> {
    /// The knot vector for a degree and a count of control points.
    pub(super) fn read(self, degree: usize, points: usize) -> Result<KnotVector, ReadError> {
        check_degree(degree)?;
        let values: Vec<f64> = self.knots.map(|knot| knot.as_f64().unwrap_or(f64::NAN)).collect();
        let direction = self.direction;
        let positive = |(index, written): (usize, Parameter<'_>)| {
            let value = written.as_i64();
            let count = value.and_then(|value| usize::try_from(value).ok()).filter(|&count| count > 0);
            count.ok_or(ReadError::Multiplicity { direction, index, value })
        };
        let multiplicities: Vec<usize> =
            self.multiplicities.enumerate().map(positive).collect::<Result<_, _>>()?;
        let found = multiplicities.iter().fold(0_usize, |sum, &m| sum.saturating_add(m));
        let expected = points + degree + 1;
        if found != expected {
            return Err(ReadError::KnotCount { direction: self.direction, degree, points, expected, found });
        }
        Ok(KnotVector::from_multiplicities(degree, &values, &multiplicities)?)
    }
}

/// The knot vector of a form without written knots, ISO 10303-42 `default_b_spline_knots`.
pub(super) fn implied_knots(form: Form, degree: usize, points: usize) -> Result<KnotVector, ReadError> {
    check_degree(degree)?;
    let too_few = KnotVectorError::TooFew { degree, expected: 2 * (degree + 1), found: points + degree + 1 };
    let n_spans = points.checked_sub(degree).filter(|&n| n > 0).ok_or(too_few)?;
    let knots = match form {
        Form::Uniform => (0..points + degree + 1).map(|i| i as f64 - degree as f64).collect(),
        Form::Bezier => {
            let segments = (points - 1) / degree;
            if segments * degree != points - 1 {
                let expected = (segments + 1) * degree + 1;
                return Err(
                    crate::geometry::nurbs::NetError::CountMismatch { expected, found: points }.into()
                );
            }
            std::iter::once(0.0)
                .chain((0..=segments).flat_map(|i| std::iter::repeat_n(i as f64, degree)))
                .chain([segments as f64])
                .collect()
        }
        Form::QuasiUniform | Form::WithKnots => {
            return Ok(KnotVector::clamped_uniform(degree, n_spans, 0.0, n_spans as f64)?);
        }
    };
    Ok(KnotVector::new(degree, knots)?)
}

fn check_degree(degree: usize) -> Result<(), ReadError> {
    if degree == 0 || degree > KnotVector::MAX_DEGREE {
        return Err(KnotVectorError::Degree { degree }.into());
    }
    Ok(())
}

/// Multiplies homogeneous points of weight one by their weights.
///
/// A weight that is no number becomes NaN, which the net's constructor refuses with its index.
pub(super) fn apply_weights<const H: usize>(
    points: &mut [[f64; H]],
    weights: impl Iterator<Item = f64>,
) -> Result<(), ReadError> {
    let mut found = 0;
    for weight in weights {
        if let Some(point) = points.get_mut(found) {
            point.iter_mut().for_each(|coordinate| *coordinate *= weight);
        }
        found += 1;
    }
    if found != points.len() {
        return Err(ReadError::WeightCount { expected: points.len(), found });
    }
    Ok(())
}
