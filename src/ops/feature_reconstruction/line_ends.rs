//! Limiting lines carried on beyond the border of the primary: the last slices lie within it, and a blend must reach over it
//! to be cut there.

use super::Closure;
use super::limiting_line::{LimitingLine, cubic};
use super::metric::{Metric, ParameterLine};
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Point2, Vector2};

/// Places of a line.
const PLACES: usize = 161;
/// Places from one of the three that give direction and bend of an end to the next.
const APART: usize = 5;

/// The line with both ends longer by a length, bent on as they are; a closed one as it is.
#[must_use]
pub fn carried_on(line: &LimitingLine, primary: &NurbsSurface, metric: &Metric, length: f64) -> LimitingLine {
    if line.closure == Closure::Closed || line.length <= 0.0 {
        return line.clone();
    }
    let at = |k: usize| line.curve.point_at(k as f64 / (PLACES - 1) as f64).into();
    let own: Vec<Point2<f64>> = (0..PLACES).map(at).map(|at| Point2::from(metric.lengths(at))).collect();
    let step = line.length / (PLACES - 1) as f64;
    let more = (length / step).ceil() as usize;
    let end = |first: [Point2<f64>; 3]| {
        let bent = End::through(first, APART as f64 * step);
        (1..=more).map(move |k| bent.at(k as f64 * step))
    };
    let mut points: Vec<Point2<f64>> = end([own[0], own[APART], own[2 * APART]]).collect();
    points.reverse();
    let last = PLACES - 1;
    points.extend(&own);
    points.extend(end([own[last], own[last - APART], own[last - 2 * APART]]));
    let points = points.into_iter().map(|p| metric.parameters(p.into())).collect();
    let (even, length) =
        ParameterLine { points, closure: Closure::Open }.resampled(primary, PLACES + 2 * more);
    LimitingLine { curve: cubic(&even), length, ..line.clone() }
}

/// The parabola through an end and two places before it, by the way beyond the end.
struct End {
    point: Point2<f64>,
    slope: Vector2<f64>,
    bend: Vector2<f64>,
}

impl End {
    fn through([first, second, third]: [Point2<f64>; 3], apart: f64) -> Self {
        let slope = (first.coords * 3.0 - second.coords * 4.0 + third.coords) / (2.0 * apart);
        let bend = (first.coords - second.coords * 2.0 + third.coords) / (apart * apart);
        Self { point: first, slope, bend }
    }

    fn at(&self, beyond: f64) -> Point2<f64> {
        self.point + self.slope * beyond + self.bend * (0.5 * beyond * beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::nurbs::{KnotVector, NurbsSurface};

    #[test]
    fn a_parabola_goes_on_as_one() {
        let knots = KnotVector::clamped_uniform(1, 1, 0.0, 100.0).unwrap();
        let corners = [[0.0, 0.0], [0.0, 100.0], [100.0, 0.0], [100.0, 100.0]];
        let net = corners.map(|[x, y]| [x, y, 0.0, 1.0]).to_vec();
        let plane = NurbsSurface::new(knots.clone(), knots, net).unwrap();
        let height = |x: f64| 40.0 + 0.002 * (x - 50.0).powi(2);
        let points = (0..=200).map(|k| 20.0 + 0.3 * f64::from(k)).map(|x| [x, height(x)]).collect();
        let (even, length) = ParameterLine { points, closure: Closure::Open }.resampled(&plane, 120);
        let line = LimitingLine {
            curve: cubic(&even),
            closure: Closure::Open,
            length,
            deviation: 0.0,
            slices: (1, 0),
            gap: 0.0,
        };
        let metric = Metric::around(&plane, &[]);
        assert!(metric.lengths([1.0, 1.0])[0] == 0.0, "no feet, no lengths");
        let foot = crate::ops::feature_reconstruction::Foot {
            at: [50.0, 50.0],
            point: crate::math::Point3::origin(),
            height: 0.0,
        };
        let found = carried_on(&line, &plane, &Metric::around(&plane, &[foot]), 8.0);
        assert!(found.length >= length + 16.0 && found.length < length + 18.0);
        for k in 0..=100 {
            let p = found.curve.point_at(f64::from(k) / 100.0);
            assert!((p.y - height(p.x)).abs() < 0.02, "{p}");
        }
        assert!(found.curve.point_at(0.0).x < 12.5 && found.curve.point_at(1.0).x > 87.5);
    }
}
