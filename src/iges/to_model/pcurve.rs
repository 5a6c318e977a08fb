//! Parameter-space curves beside their counterparts in space: in the model's parameters, running as the edge's curve
//! does, over the same parameter.

use super::curve::Piece;
use super::curve2d::Piece2d;
use super::surface::SurfaceRead;
use crate::geometry::{Curve2d, ParameterMap, Surface, Trimmed};
use crate::math::{Point2, Point3};

/// Part of an edge's size by which a parameter-space curve may leave it and still be its own: how badly it fits is for
/// the checks to say.
const OWN: f64 = 0.05;

/// How a curve of the file becomes that of an edge in the model's parameters.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::iges) struct Fit {
    pub(in crate::iges) curve: Curve2d,
    /// From the file's parameters to the model's.
    pub(in crate::iges) map: ParameterMap,
    /// Whether the file's curve runs against the edge's.
    pub(in crate::iges) reversed: bool,
}

/// The curve of an edge in the parameters of a surface; `None` where it is nowhere near.
pub(in crate::iges) fn fit(on: &SurfaceRead, flat: &Piece2d, edge: &Piece, resolution: f64) -> Option<Fit> {
    let targets = [edge.start(), edge.middle(), edge.end()];
    let size = (targets[0] - targets[1]).norm() + (targets[1] - targets[2]).norm();
    let mut best: Option<(f64, Piece2d, ParameterMap, bool)> = None;
    for map in &on.parameters {
        let Ok(forward) = flat.mapped(map) else { continue };
        let backward = reversed(&forward);
        for (candidate, reversed) in [(Some(forward), false), (backward, true)] {
            let Some(candidate) = candidate else { continue };
            let off = distance(&on.surface, &candidate, &targets);
            if best.as_ref().is_none_or(|(least, ..)| off < *least) {
                best = Some((off, candidate, *map, reversed));
            }
        }
    }
    let (off, piece, map, reversed) = best?;
    let near = off <= (OWN * size).max(resolution);
    near.then(|| Fit { curve: piece.over(edge.range), map, reversed })
}

/// Greatest distance of the ends, and of any point near the middle, from where they should be.
fn distance(surface: &Surface, piece: &Piece2d, [start, middle, end]: &[Point3<f64>; 3]) -> f64 {
    let image = |p: Point2<f64>| surface.point(p.x, p.y);
    let ends = (image(piece.start()) - start).norm().max((image(piece.end()) - end).norm());
    // The two need not count alike: the middle of one lies anywhere inside the other, but not at a closed one's ends.
    let (from, to) = piece.range;
    let near = (1..8).map(|k| from + (to - from) * f64::from(k) / 8.0);
    let inside = near.map(|t| (image(piece.curve.point_at(t)) - middle).norm()).fold(f64::INFINITY, f64::min);
    ends.max(0.25 * inside)
}

/// The piece run the other way.
pub(in crate::iges) fn reversed(piece: &Piece2d) -> Option<Piece2d> {
    let (start, end) = piece.range;
    Some(match &piece.curve {
        Curve2d::Line { origin, direction } => {
            let (at_end, back) = (origin + direction * end, -direction);
            Piece2d {
                curve: Curve2d::Line { origin: at_end + direction * start, direction: back },
                range: (start, end),
            }
        }
        Curve2d::Nurbs(curve) => {
            let (first, last) = curve.domain();
            let range = (first + (last - end), first + (last - start));
            Piece2d { curve: Curve2d::Nurbs(curve.reversed()), range }
        }
        Curve2d::Polyline(curve) => {
            let (first, last) = curve.domain();
            let range = (first + (last - end), first + (last - start));
            Piece2d { curve: Curve2d::Polyline(curve.reversed()), range }
        }
        other => {
            let basis = Box::new(other.clone());
            let range = (-end, -start);
            Piece2d { curve: Curve2d::Trimmed(Trimmed { basis, start, end, forward: false }), range }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vector2;

    #[test]
    fn a_reversed_line_runs_over_the_same_parameters() {
        let line = Piece2d {
            curve: Curve2d::Line { origin: Point2::new(1.0, 0.0), direction: Vector2::new(2.0, 1.0) },
            range: (0.5, 2.0),
        };
        let back = reversed(&line).expect("a line");
        assert!((back.start() - line.end()).norm() < 1e-15);
        assert!((back.end() - line.start()).norm() < 1e-15);
        let moved = line.clone().over((10.0, 13.0));
        assert!((moved.point_at(10.0) - line.start()).norm() < 1e-14);
        assert!((moved.point_at(13.0) - line.end()).norm() < 1e-14);
    }
}
