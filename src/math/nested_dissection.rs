//! An order of elimination for unknowns on a grid: halves first, and last the lines that keep them apart.
//!
//! Works on places alone, not on a matrix. It assumes that unknowns farther apart than a reach are not coupled; where
//! they are, the order is as correct and costs more.
//!
//! Source: A. George, Nested dissection of a regular finite element mesh, 1973.

/// Parts of this many unknowns are not cut further: their factor is dense in any order.
const LEAF: usize = 48;

/// A permutation of the unknowns at these places of a grid, first to last.
///
/// `reach` is the greatest distance of coupled unknowns in rows and in columns.
#[must_use]
pub fn nested_dissection(places: &[[usize; 2]], reach: [usize; 2]) -> Vec<usize> {
    let reach = reach.map(|r| r.max(1));
    let mut order = Vec::with_capacity(places.len());
    dissect((0..places.len()).collect(), places, reach, &mut order);
    order
}

fn dissect(part: Vec<usize>, places: &[[usize; 2]], reach: [usize; 2], order: &mut Vec<usize>) {
    let Some(cut) = Cut::of(&part, places, reach) else {
        order.extend(part);
        return;
    };
    let (mut below, mut apart, mut above) = (Vec::new(), Vec::new(), Vec::new());
    for unknown in part {
        let line = places[unknown][cut.direction];
        match line {
            _ if line < cut.from => below.push(unknown),
            _ if line < cut.from + reach[cut.direction] => apart.push(unknown),
            _ => above.push(unknown),
        }
    }
    dissect(below, places, reach, order);
    dissect(above, places, reach, order);
    order.extend(apart);
}

/// Lines of one direction that keep two halves apart.
struct Cut {
    direction: usize,
    from: usize,
}

impl Cut {
    /// The cut with the fewest unknowns that leaves as many before it as behind; `None` for parts that stay whole.
    fn of(part: &[usize], places: &[[usize; 2]], reach: [usize; 2]) -> Option<Self> {
        if part.len() <= LEAF {
            return None;
        }
        let ends = [0, 1].map(|k| {
            let lines = || part.iter().map(|&unknown| places[unknown][k]);
            (lines().min().unwrap_or(0), lines().max().unwrap_or(0))
        });
        let wide = ends.map(|(low, high)| high - low + 1);
        let direction = usize::from(reach[1] * wide[0] < reach[0] * wide[1]);
        if wide[direction] <= 2 * reach[direction] {
            return None;
        }
        let (low, high) = ends[direction];
        let mut counts = vec![0_usize; wide[direction]];
        for &unknown in part {
            counts[places[unknown][direction] - low] += 1;
        }
        let mut before = 0;
        let half = counts.iter().position(|count| {
            before += count;
            2 * before >= part.len()
        });
        let from = (low + half.unwrap_or(0)).saturating_sub(reach[direction] / 2);
        Some(Self { direction, from: from.clamp(low + 1, high - reach[direction]) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disc of places.
    fn disc(side: usize) -> Vec<[usize; 2]> {
        let inside =
            |i: usize, j: usize| (2 * i + 1).abs_diff(side).pow(2) + (2 * j + 1).abs_diff(side).pow(2);
        let all = (0..side).flat_map(|i| (0..side).map(move |j| (i, j)));
        all.filter(|&(i, j)| inside(i, j) <= side * side).map(|(i, j)| [i, j]).collect()
    }

    #[test]
    fn every_unknown_stands_in_the_order_once() {
        for side in [1, 2, 7, 8, 40, 77] {
            for reach in [[1, 1], [3, 3], [2, 5], [0, 1]] {
                let places = disc(side);
                let mut order = nested_dissection(&places, reach);
                order.sort_unstable();
                assert!(order.into_iter().eq(0..places.len()), "{side} {reach:?}");
            }
        }
    }

    /// Entries of the factor's columns, by elimination on sets.
    fn fill(places: &[[usize; 2]], reach: usize, order: &[usize]) -> usize {
        let coupled = |a: usize, b: usize| (0..2).all(|k| places[a][k].abs_diff(places[b][k]) <= reach);
        let mut open: Vec<std::collections::BTreeSet<usize>> = order
            .iter()
            .enumerate()
            .map(|(at, &a)| (at + 1..order.len()).filter(|&b| coupled(a, order[b])).collect())
            .collect();
        let mut sum = 0;
        for at in 0..order.len() {
            let column = std::mem::take(&mut open[at]);
            sum += column.len();
            if let Some(&next) = column.first() {
                open[next].extend(column.into_iter().skip(1));
            }
        }
        sum
    }

    /// By rows a factor grows as `n^1.5`; dissected it grows as `n log n`.
    #[test]
    fn the_factor_grows_slower_than_in_the_order_of_the_rows() {
        let fills = [32, 96].map(|side| {
            let places = disc(side);
            let rows: Vec<usize> = (0..places.len()).collect();
            [rows, nested_dissection(&places, [1, 1])].map(|order| fill(&places, 1, &order))
        });
        let [by_rows, dissected] = [0, 1].map(|k| fills[1][k] as f64 / fills[0][k] as f64);
        assert!(by_rows > 25.0 && dissected < 18.0, "{by_rows} times by rows, {dissected} dissected");
        assert!(3 * fills[1][1] < 2 * fills[1][0], "{fills:?}");
    }
}
