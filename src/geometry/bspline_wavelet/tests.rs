//! Closed forms from the literature, and refusals.

use super::{Level, WaveletError, coarsened, decompose};
use crate::geometry::nurbs::KnotVector;

fn uniform(degree: usize, spans: usize) -> KnotVector {
    KnotVector::clamped_uniform(degree, spans, 0.0, 1.0).expect("uniform knots")
}

fn level(knots: &KnotVector, ends: usize) -> Level {
    Level::new(knots, ends).expect("good knots").expect("a knot to remove")
}

#[test]
fn the_one_wavelet_of_two_cubic_spans() {
    let two = level(&uniform(3, 2), 0);
    let (first, column) = two.wavelet(0);
    assert_eq!((two.wavelet_count(), first), (1, 0));
    for (found, exact) in column.iter().zip([1.0, -2.0, 3.0, -2.0, 1.0]) {
        assert!((found - exact * 7.0f64.sqrt()).abs() < 1e-12, "{column:?}");
    }
}

#[test]
fn inner_columns_are_the_cardinal_wavelets() {
    // Chui and Wang 1992: the coefficients of the semi-orthogonal wavelets, up to norm and sign.
    let linear: &[f64] = &[1.0, -6.0, 10.0, -6.0, 1.0];
    let quadratic: &[f64] = &[1.0, -29.0, 147.0, -303.0, 303.0, -147.0, 29.0, -1.0];
    let cubic: &[f64] =
        &[1.0, -124.0, 1677.0, -7904.0, 18482.0, -24264.0, 18482.0, -7904.0, 1677.0, -124.0, 1.0];
    for (degree, known) in [(1, linear), (2, quadratic), (3, cubic)] {
        let level = level(&uniform(degree, 32), 0);
        let (_, column) = level.wavelet(level.wavelet_count() / 2);
        assert_eq!(column.len(), known.len());
        for (value, known) in column.iter().zip(known) {
            let found = value / column[0];
            assert!((found - known / 1.0).abs() < 1e-7 * known.abs(), "degree {degree}: {found} {known}");
        }
    }
}

#[test]
fn corners_and_the_neighbours_of_held_ends_stay() {
    let corner = [0.0, 0.0, 0.0, 0.0, 0.2, 0.5, 0.5, 0.5, 0.7, 0.9, 1.0, 1.0, 1.0, 1.0];
    let corner = KnotVector::new(3, corner.to_vec()).expect("good knots");
    let removed = |ends| coarsened(&corner, ends).expect("good knots").map(|c| c.removed);
    assert_eq!(removed(0), Some(vec![0.2, 0.7]));
    // Knots next to the ends are held with the tangents: 0.7 is the only one left.
    assert_eq!(removed(2), Some(vec![0.7]));
    assert_eq!(removed(3), None);
    assert_eq!(coarsened(&uniform(3, 1), 0).expect("good knots"), None);
}

#[test]
fn what_has_no_hierarchy_is_refused() {
    let torn = KnotVector::new(1, vec![0.0, 0.0, 0.5, 0.5, 1.0, 1.0]).expect("good knots");
    assert!(matches!(coarsened(&torn, 0), Err(WaveletError::Torn { multiplicity: 2, .. })));
    assert!(matches!(coarsened(&uniform(2, 4), 3), Err(WaveletError::EndOrder { .. })));
    let open = KnotVector::new(1, vec![0.0, 1.0, 2.0, 3.0]).expect("good knots");
    assert_eq!(coarsened(&open, 0), Err(WaveletError::NotClamped));
    let few = decompose(&uniform(3, 4), &[[0.0]; 3], 1, 0);
    assert!(matches!(few, Err(WaveletError::CountMismatch { expected: 7, found: 3 })));
}
