//! How far points are from a surface, in figures and as a histogram.

use serde::{Deserialize, Serialize};

/// Distances of points from a surface. Lengths are in file units; without points all are 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Deviation {
    /// Points.
    pub points: usize,
    /// Mean distance.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Distance that 95 of 100 points keep.
    pub most: f64,
    /// Greatest distance.
    pub greatest: f64,
    /// Signed distances, sorted into classes.
    pub histogram: Histogram,
}

/// Counts of values in classes of equal width.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Histogram {
    /// Lower bound of the first class.
    pub low: f64,
    /// Width of a class.
    pub width: f64,
    /// Count of each class.
    pub counts: Vec<usize>,
}

/// Share of the points in [`Deviation::most`].
const MOST: f64 = 0.95;
/// Classes; odd, so that one lies about 0.
const CLASSES: usize = 41;

impl Deviation {
    /// Of signed distances.
    #[must_use]
    pub fn of(signed: &[f64]) -> Self {
        if signed.is_empty() {
            return Self::default();
        }
        let n = signed.len() as f64;
        let mut all: Vec<f64> = signed.iter().map(|d| d.abs()).collect();
        all.sort_unstable_by(f64::total_cmp);
        let greatest = all[all.len() - 1];
        Self {
            points: all.len(),
            mean: all.iter().sum::<f64>() / n,
            rms: (all.iter().map(|d| d * d).sum::<f64>() / n).sqrt(),
            most: all[((MOST * n) as usize).min(all.len() - 1)],
            greatest,
            histogram: Histogram::of(signed, greatest),
        }
    }
}

impl Histogram {
    /// Of values between `-bound` and `bound`.
    fn of(values: &[f64], bound: f64) -> Self {
        let width = 2.0 * bound / CLASSES as f64;
        let mut counts = vec![0; CLASSES];
        for value in values {
            let class = if width > 0.0 { ((value + bound) / width) as usize } else { CLASSES / 2 };
            counts[class.min(CLASSES - 1)] += 1;
        }
        Self { low: -bound, width, counts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_known_distances() {
        let found = Deviation::of(&[3.0, -4.0, 0.0, 1.0]);
        assert_eq!((found.points, found.mean, found.greatest, found.most), (4, 2.0, 4.0, 4.0));
        assert!((found.rms - 6.5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(found.histogram.counts.iter().sum::<usize>(), 4);
        assert_eq!((found.histogram.counts[0], found.histogram.counts[CLASSES / 2]), (1, 1));
        assert_eq!(Deviation::of(&[]), Deviation::default());
        assert_eq!(Deviation::of(&[0.0; 3]).histogram.counts[CLASSES / 2], 3);
    }
}
