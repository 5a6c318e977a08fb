//! The filter bank against its vectors, and its laws.

use proptest::prelude::*;
use resurf::geometry::bspline_wavelet::{Level, coarsened, decompose};
use resurf::geometry::nurbs::{KnotVector, gram_band};

use crate::{difference, knots, list, numbers, rows, vector, whole};

#[test]
fn filters_are_those_of_the_vectors() {
    let file = vector("a1_filters.json");
    let tolerance = file["tolerance"].as_f64().expect("a number");
    for case in list(&file, "cases") {
        let (degree, ends) = (whole(case, "degree"), whole(case, "k"));
        if ends > degree {
            // The other program knows no bound; what is held beyond the degree are knots, not derivatives.
            continue;
        }
        let level = Level::new(&knots(case, "fine_knots", degree), ends).expect("good").expect("a level");
        assert_eq!(level.coarse().knots(), numbers(&case["coarse_knots"]));
        for (i, row) in list(case, "P").iter().enumerate() {
            let (first, entries) = level.refinement().row(i);
            for (j, expected) in numbers(row).iter().enumerate() {
                let found = j.checked_sub(first).and_then(|at| entries.get(at)).copied().unwrap_or(0.0);
                assert!((found - expected).abs() <= tolerance, "{} k={ends} P[{i}][{j}]", case["name"]);
            }
        }
        for (i, row) in list(case, "Q").iter().enumerate() {
            for (j, expected) in numbers(row).iter().enumerate() {
                let (first, column) = level.wavelet(j);
                let found = i.checked_sub(first).and_then(|at| column.get(at)).copied().unwrap_or(0.0);
                assert!((found - expected).abs() <= tolerance, "{} k={ends} Q[{i}][{j}]", case["name"]);
            }
        }
        for (found, expected) in level.centres().iter().zip(numbers(&case["wavelet_centres"])) {
            assert!((found - expected).abs() <= tolerance);
        }
    }
}

#[test]
fn decompositions_are_those_of_the_vectors() {
    let file = vector("a2_decompose.json");
    let tolerance = file["tolerance"].as_f64().expect("a number");
    for case in list(&file, "cases") {
        let (degree, ends) = (whole(case, "degree"), whole(case, "k"));
        let controls = rows(&case["controls"]);
        let found =
            decompose(&knots(case, "knots", degree), &controls, usize::MAX, ends).expect("a decomposition");
        let levels = list(case, "levels_finest_first");
        assert_eq!(found.levels.len(), levels.len());
        assert_eq!(found.base_knots.knots(), numbers(&case["base_knots"]));
        assert!(difference(&found.base, &rows(&case["base_controls"])) <= tolerance);
        for (found, level) in found.details.iter().zip(levels) {
            assert!(difference(found, &rows(&level["D"])) <= tolerance);
        }
        assert!(difference(&found.joined(), &controls) <= 1e-12 * 12.0);
    }
}

/// Knots of degree 1 to 5: spans over two orders of magnitude, some knots double or full.
fn uneven_knots() -> impl Strategy<Value = KnotVector> {
    let span = (-1.0..1.0f64, 0..8usize);
    (1..=5usize, prop::collection::vec(span, 2..60)).prop_map(|(degree, spans)| {
        let mut all = vec![0.0; degree + 1];
        let mut at = 0.0;
        let last = spans.len() - 1;
        for (i, (exponent, kind)) in spans.into_iter().enumerate() {
            at += 10f64.powf(exponent);
            let multiplicity = match kind {
                0 => degree,
                1 => 2.min(degree),
                _ => 1,
            };
            let count = if i == last { degree + 1 } else { multiplicity };
            all.extend(std::iter::repeat_n(at, count));
        }
        KnotVector::new(degree, all).expect("good knots")
    })
}

/// Control points of size 1 from a seed.
fn controls(count: usize, seed: u32) -> Vec<[f64; 3]> {
    let wave = |i: usize, c: f64| (f64::from(seed % 1000) + i as f64 * (1.7 + c) + c).sin();
    (0..count).map(|i| [wave(i, 0.0), wave(i, 0.31), wave(i, 0.77)]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn reconstruction_is_perfect_at_every_level(knots in uneven_knots(), ends in 0..4usize, seed: u32) {
        let ends = ends.min(knots.degree());
        let points = controls(knots.n_basis(), seed);
        let found = decompose(&knots, &points, usize::MAX, ends).expect("a decomposition");
        let off = difference(&found.joined(), &points);
        prop_assert!(off <= 1e-11, "{off:e}");
        let rows: usize = found.details.iter().map(Vec::len).sum();
        prop_assert_eq!(rows + found.base.len(), points.len());
        // The held ends are the same on all levels, bit by bit.
        let m = found.base.len();
        prop_assert_eq!(&found.base[..ends], &points[..ends]);
        prop_assert_eq!(&found.base[m - ends..], &points[points.len() - ends..]);
    }

    #[test]
    fn wavelets_are_orthogonal_to_coarse_splines(knots in uneven_knots(), ends in 0..3usize, seed: u32) {
        let ends = ends.min(knots.degree());
        if let Some(level) = Level::new(&knots, ends).expect("good knots") {
            let p = knots.degree();
            let gram = gram_band(&knots, 0, 0);
            let m = level.coarse().n_basis();
            let mut coarse = controls(m, seed);
            coarse[..ends].fill([0.0; 3]);
            coarse[m - ends..].fill([0.0; 3]);
            let fine = level.refinement().apply(&coarse);
            // The greatest possible product is the norm of the coarse spline, whose own scale is the domain's.
            let scale = knots.domain().1.sqrt();
            for j in 0..level.wavelet_count() {
                let (first, column) = level.wavelet(j);
                let mut product = 0.0;
                for (i, q) in (first..).zip(column) {
                    for k in i.saturating_sub(p)..(i + p + 1).min(fine.len()) {
                        product += q * gram[i * (2 * p + 1) + k + p - i] * fine[k][0];
                    }
                }
                prop_assert!(product.abs() <= 1e-10 * scale, "{product:e} of {scale}");
            }
        }
    }

    #[test]
    fn what_is_coarse_has_no_detail(knots in uneven_knots(), ends in 0..3usize, seed: u32) {
        let ends = ends.min(knots.degree());
        if let Some(level) = Level::new(&knots, ends).expect("good knots") {
            let base = controls(level.coarse().n_basis(), seed);
            let (found, detail) = level.split(&level.refinement().apply(&base)).expect("as many points");
            prop_assert!(difference(&found, &base) <= 1e-10);
            let none = vec![[0.0; 3]; detail.len()];
            let shape = level.join(&vec![[0.0; 3]; base.len()], &detail);
            let flat = level.join(&vec![[0.0; 3]; base.len()], &none);
            prop_assert!(difference(&shape, &flat) <= 1e-10);
        }
    }

    #[test]
    fn refinement_keeps_the_spline(knots in uneven_knots(), seed: u32, at in 0.0..1.0f64) {
        if let Some(coarse) = coarsened(&knots, 0).expect("good knots") {
            let refinement = resurf::geometry::bspline_wavelet::Refinement::new(&coarse.knots, &knots);
            let base = controls(coarse.knots.n_basis(), seed);
            let fine = refinement.apply(&base);
            let x = at * knots.domain().1;
            let value = |knots: &KnotVector, points: &[[f64; 3]]| {
                let basis = knots.basis_derivatives(x, 0);
                basis.values().iter().zip(&points[basis.first()..]).map(|(b, p)| b * p[0]).sum::<f64>()
            };
            prop_assert!((value(&coarse.knots, &base) - value(&knots, &fine)).abs() <= 1e-12);
        }
    }
}
