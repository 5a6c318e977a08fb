//! Points of a dense line that are enough: no chord farther from the line than a height, none longer than a length.

use crate::math::Point3;

/// Rounding of a length that still counts as kept.
const ROUNDING: f64 = 1e-12;

/// Indices of a dense line's points, both ends among them: from each, the next is the last one up to which the line stays
/// within `height` of the chord and the way along it within `length`. At least the next point, however far it is.
#[must_use]
pub fn sampled_by_chord(line: &[Point3<f64>], height: f64, length: f64) -> Vec<usize> {
    let mut chosen: Vec<usize> = line.first().map(|_| 0).into_iter().collect();
    let mut from = 0;
    while from + 1 < line.len() {
        let mut way = (line[from + 1] - line[from]).norm();
        let mut to = from + 1;
        while to + 1 < line.len() {
            way += (line[to + 1] - line[to]).norm();
            if way > length + ROUNDING || !is_flat(&line[from..=to + 1], height) {
                break;
            }
            to += 1;
        }
        chosen.push(to);
        from = to;
    }
    chosen
}

/// Whether the inner points of a piece lie within a height of its chord.
fn is_flat(piece: &[Point3<f64>], height: f64) -> bool {
    let [first, inner @ .., last] = piece else { return true };
    let along = (last - first).try_normalize(0.0);
    let rise = |point: &Point3<f64>| {
        let away = point - first;
        along.map_or(away, |along| away - along * away.dot(&along)).norm()
    };
    inner.iter().all(|point| rise(point) <= height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The specification's reference line.
    #[test]
    fn the_reference_line_has_39_samples() {
        let at = |k: usize| PI * k as f64 / 399.0;
        let line: Vec<Point3<f64>> =
            (0..400).map(at).map(|t| Point3::new(10.0 * t, 4.0 * (2.0 * t).sin(), t.cos())).collect();
        let chosen = sampled_by_chord(&line, 0.05, 20.0 * 0.05);
        assert_eq!(chosen.len(), 39);
        assert_eq!(chosen[..8], [0, 9, 19, 29, 39, 49, 60, 71]);
        assert_eq!(chosen[38], 399);
    }

    #[test]
    fn ends_and_long_steps() {
        let line = [0.0, 1.0, 2.0, 10.0, 10.5].map(|x| Point3::new(x, 0.0, 0.0));
        assert_eq!(sampled_by_chord(&line, 0.1, 2.0), [0, 2, 3, 4]);
        assert_eq!(sampled_by_chord(&line, 0.1, 100.0), [0, 4]);
        assert_eq!(sampled_by_chord(&line[..1], 0.1, 1.0), [0]);
        assert!(sampled_by_chord(&[], 0.1, 1.0).is_empty());
    }
}
