//! Bounds that cross themselves in the parameter plane by less than anybody means, made simple.
//!
//! Where two edges meet, the end of one may run past the other by the tolerance of the data. The points in space
//! are shared with neighbours and stay; only their places in the parameter plane of one face move.

use super::region::Corner;

/// Share of a loop's length, in space, that a knot may have to be drawn straight: a greater one is a loop that
/// crosses itself in earnest.
const KNOT: f64 = 0.02;

/// Knots drawn straight in one loop at most.
const MOST: usize = 64;

/// Corners of a loop at most: the search looks at all pairs of its sides.
const MOST_CORNERS: usize = 6000;

/// Draws small knots of a closed polygon straight.
pub(super) fn untangle(corners: &mut [Corner]) {
    let count = corners.len();
    if !(4..=MOST_CORNERS).contains(&count) {
        return;
    }
    let length = |corners: &[Corner], from: usize, to: usize| -> f64 {
        (from..to).map(|i| (corners[(i + 1) % count].point - corners[i % count].point).norm()).sum()
    };
    let whole = length(corners, 0, count);
    for _ in 0..MOST {
        let Some((i, j)) = first_knot(corners) else { return };
        // The knot is the shorter way round between the two sides that cross.
        let (inner, outer) = (length(corners, i + 1, j), length(corners, j + 1, i + count));
        let (from, to) = if inner <= outer { (i, j + 1) } else { (j, i + count + 1) };
        if inner.min(outer) > KNOT * whole {
            return;
        }
        straighten(corners, from, to);
    }
}

/// Puts the corners strictly between two on the line between these, by their distances in space.
fn straighten(corners: &mut [Corner], from: usize, to: usize) {
    let count = corners.len();
    let step = |corners: &[Corner], i: usize| {
        (corners[(i + 1) % count].point - corners[i % count].point).norm().max(f64::MIN_POSITIVE)
    };
    let total: f64 = (from..to).map(|i| step(corners, i)).sum();
    let (a, b) = (corners[from % count].uv, corners[to % count].uv);
    let mut walked = 0.0;
    for i in from + 1..to {
        walked += step(corners, i - 1);
        corners[i % count].uv = [0, 1].map(|k| a[k] + (b[k] - a[k]) * (walked / total));
    }
}

/// The first two sides, neither neighbours nor of common vertices, that meet: by the corners where they begin.
fn first_knot(corners: &[Corner]) -> Option<(usize, usize)> {
    let count = corners.len();
    let end = |i: usize| &corners[(i + 1) % count];
    let boxes: Vec<[f64; 4]> = (0..count)
        .map(|i| {
            let (a, b) = (corners[i].uv, end(i).uv);
            [a[0].min(b[0]), a[0].max(b[0]), a[1].min(b[1]), a[1].max(b[1])]
        })
        .collect();
    let apart = |a: &[f64; 4], b: &[f64; 4]| a[1] < b[0] || b[1] < a[0] || a[3] < b[2] || b[3] < a[2];
    for i in 0..count {
        for j in i + 2..count {
            if (i == 0 && j + 1 == count) || apart(&boxes[i], &boxes[j]) {
                continue;
            }
            if meets([corners[i].uv, end(i).uv], [corners[j].uv, end(j).uv]) {
                return Some((i, j));
            }
        }
    }
    None
}

/// Whether two segments cross properly.
fn meets([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Point3;

    fn corners(uvs: &[[f64; 2]]) -> Vec<Corner> {
        let one = |(uv, vertex): (&[f64; 2], u32)| Corner {
            uv: *uv,
            vertex,
            point: Point3::new(uv[0], uv[1], 0.0),
        };
        uvs.iter().zip(0..).map(one).collect()
    }

    #[test]
    fn a_small_knot_at_a_corner_is_drawn_straight() {
        // The last side runs a little past the first corner and comes back over it.
        let mut square =
            corners(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.001, 0.002], [-0.001, 0.001]]);
        square[5].uv = [0.0015, -0.001];
        assert!(first_knot(&square).is_some());
        untangle(&mut square);
        assert_eq!(first_knot(&square), None);
        // The far corners stay.
        assert_eq!((square[2].uv, square[3].uv), ([1.0, 1.0], [0.0, 1.0]));
    }

    #[test]
    fn a_bow_tie_stays() {
        let mut bow = corners(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        let before = bow.clone();
        untangle(&mut bow);
        assert_eq!(bow, before);
    }
}
