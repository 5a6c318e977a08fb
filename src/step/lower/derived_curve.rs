//! Bodies of curves that are made of other curves: trimmed, composite and offset ones.
//!
//! What a curve is trimmed by is told where the file's unit of angle does not matter: by points on circles and
//! ellipses, by parameters on everything else, whose parameters carry no unit.

use super::super::exchange_structure::InstanceName;
use super::compose::{Body, Inherited, Value};
use super::{LowerError, Lowering};
use crate::geometry::{Composite, Curve, Segment, Trimmed};
use crate::math::Vector3;
use crate::number::format_real;

impl Lowering<'_> {
    /// `TRIMMED_CURVE`.
    pub(super) fn trimmed_body(
        &mut self,
        old: InstanceName,
        piece: &Trimmed<Curve>,
        inherited: &Inherited,
    ) -> Result<Body, LowerError> {
        let basis = self.append_curve(old, &piece.basis, &Inherited::nothing())?;
        let (from, to) = if piece.forward { (piece.start, piece.end) } else { (piece.end, piece.start) };
        let angular = matches!(*piece.basis, Curve::Circle { .. } | Curve::Ellipse { .. });
        let mut trim = |t: f64| -> Result<Value, LowerError> {
            let at = if angular {
                Value::Reference(self.append_point(piece.basis.point_at(t).coords.as_slice())?)
            } else {
                Value::Verbatim(format!("PARAMETER_VALUE({})", format_real(t)))
            };
            Ok(Value::List(vec![at]))
        };
        let (from, to) = (trim(from)?, trim(to)?);
        let master = if angular { ".CARTESIAN." } else { ".PARAMETER." };
        let [sense, master] = [logical(piece.forward), master].map(|text| Value::Verbatim(text.to_owned()));
        Ok(Body::simple(
            "TRIMMED_CURVE",
            vec![inherited.name(), Value::Reference(basis), from, to, sense, master],
        ))
    }

    /// `COMPOSITE_CURVE` with its segments; how smoothly these meet was the old curve's to say, so that the new
    /// ones are continuous, and the last is open.
    pub(super) fn composite_body(
        &mut self,
        old: InstanceName,
        whole: &Composite<Curve>,
        inherited: &Inherited,
    ) -> Result<Body, LowerError> {
        let n_segments = whole.segments().len();
        let mut segments = Vec::with_capacity(n_segments);
        for (place, segment) in whole.segments().iter().enumerate() {
            let parent = self.append_segment_curve(old, segment)?;
            let transition = if place + 1 < n_segments { ".CONTINUOUS." } else { ".DISCONTINUOUS." };
            let [transition, sense] =
                [transition, logical(segment.forward)].map(|text| Value::Verbatim(text.to_owned()));
            let body =
                Body::simple("COMPOSITE_CURVE_SEGMENT", vec![transition, sense, Value::Reference(parent)]);
            segments.push(Value::Reference(self.append(&body)?));
        }
        let intersects = Value::Verbatim(inherited.self_intersect.clone());
        Ok(Body::simple("COMPOSITE_CURVE", vec![inherited.name(), Value::List(segments), intersects]))
    }

    /// The curve of a segment, which must be bounded: what has no ends of its own gets them.
    fn append_segment_curve(
        &mut self,
        old: InstanceName,
        segment: &Segment<Curve>,
    ) -> Result<InstanceName, LowerError> {
        if !matches!(segment.curve, Curve::Line { .. } | Curve::Parabola { .. } | Curve::Hyperbola { .. }) {
            return self.append_curve(old, &segment.curve, &Inherited::nothing());
        }
        let (start, end) = segment.domain;
        let piece = Trimmed { basis: Box::new(segment.curve.clone()), start, end, forward: true };
        self.append_curve(old, &Curve::Trimmed(piece), &Inherited::nothing())
    }

    /// `OFFSET_CURVE_3D`.
    pub(super) fn offset_body(
        &mut self,
        old: InstanceName,
        (basis, distance, direction): (&Curve, f64, &Vector3<f64>),
        inherited: &Inherited,
    ) -> Result<Body, LowerError> {
        let basis = Value::Reference(self.append_curve(old, basis, &Inherited::nothing())?);
        let direction = Value::Reference(self.append_direction(direction.as_slice())?);
        let intersects = Value::Verbatim(inherited.self_intersect.clone());
        let values = vec![inherited.name(), basis, Value::Real(distance), intersects, direction];
        Ok(Body::simple("OFFSET_CURVE_3D", values))
    }
}

fn logical(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}
