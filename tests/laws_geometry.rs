//! Laws of knot vectors and B-splines on random input: uneven and multiple knots, clamped or not, weights.
//! Expected values are closed forms, definitions, or the same geometry before an exact change of form.

#![expect(clippy::unwrap_used, reason = "builders of fixtures stop at what cannot be built")]

use proptest::prelude::*;
use resurf::geometry::nurbs::{
    GrevilleCollocation, KnotVector, NurbsCurve3, NurbsSurface, SurfaceLocator, Wrap, gram, interpolate_grid,
};
use resurf::math::{Affine, Matrix3, Point3, Vector3, quadrature::gauss_legendre};

/// Knots of degree 1 to 6 with uneven spans (1 : 1000) and multiplicities up to `most(p)`.
fn knots(most: fn(usize) -> usize) -> impl Strategy<Value = KnotVector> {
    (1_usize..=6, prop::collection::vec((-3.0..0.0_f64, 1_usize..=7), 1..6), any::<bool>(), -1.0..1.0_f64)
        .prop_map(move |(degree, spans, clamped, start)| {
            let mut at = start;
            let mut all = Vec::new();
            if clamped {
                all.extend(vec![at; degree + 1]);
            } else {
                all.extend((0..=degree).map(|i| start - 0.3 * (degree - i) as f64));
            }
            let last = spans.len() - 1;
            for (i, (log, m)) in spans.iter().enumerate() {
                at += 10f64.powf(*log);
                if i < last {
                    all.extend(vec![at; (*m).min(most(degree))]);
                }
            }
            all.extend((0..=degree).map(|i| if clamped { at } else { at + 0.2 * i as f64 }));
            KnotVector::new(degree, all).unwrap()
        })
}

fn smooth_knots() -> impl Strategy<Value = KnotVector> {
    knots(|p| p)
}

fn curve() -> impl Strategy<Value = NurbsCurve3> {
    knots(|p| p + 1).prop_flat_map(|k| {
        let n = k.n_basis();
        prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, 0.3..3.0_f64), n).prop_map(
            move |raw| {
                let points: Vec<_> = raw.iter().map(|p| Point3::new(p.0, p.1, p.2)).collect();
                let weights: Vec<_> = raw.iter().map(|p| p.3).collect();
                NurbsCurve3::from_points(k.clone(), &points, Some(&weights)).unwrap()
            },
        )
    })
}

fn surface() -> impl Strategy<Value = NurbsSurface> {
    (smooth_knots(), smooth_knots()).prop_flat_map(|(ku, kv)| {
        let n = ku.n_basis() * kv.n_basis();
        prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, 0.3..3.0_f64), n).prop_map(
            move |raw| {
                let points: Vec<_> = raw.iter().map(|p| Point3::new(p.0, p.1, p.2)).collect();
                let weights: Vec<_> = raw.iter().map(|p| p.3).collect();
                NurbsSurface::from_points(ku.clone(), kv.clone(), &points, Some(&weights)).unwrap()
            },
        )
    })
}

/// Parameters that avoid knots of full multiplicity, where a curve may jump.
fn parameters((start, end): (f64, f64)) -> impl Iterator<Item = f64> {
    (0..23).map(move |i| start + (end - start) * (f64::from(i) + 0.31) / 23.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn basis_functions_are_a_partition_of_unity(k in knots(|p| p + 1)) {
        let (start, end) = k.domain();
        for u in parameters((start, end)).chain([start, end]) {
            let basis = k.basis_derivatives(u, 2);
            prop_assert!((basis.values().iter().sum::<f64>() - 1.0).abs() < 1e-14);
            prop_assert!(basis.values().iter().all(|&b| b >= 0.0));
            for order in 1..=2 {
                let (sum, size) = basis.derivatives(order).iter()
                    .fold((0.0, 0.0_f64), |(s, m), d| (s + d, m.max(d.abs())));
                prop_assert!(sum.abs() <= 1e-13 * size);
            }
            let mut plain = [0.0; 26];
            prop_assert_eq!(k.basis(u, &mut plain), basis.span);
            prop_assert_eq!(&plain[..=k.degree()], basis.values());
        }
    }

    /// Marsden: the control points of `f(u) = u` are the Greville abscissae.
    #[test]
    fn greville_abscissae_reproduce_the_parameter(k in knots(|p| p + 1)) {
        let g = k.greville();
        let size = k.knots().iter().fold(1.0_f64, |m, v| m.max(v.abs()));
        for u in parameters(k.domain()) {
            let basis = k.basis_derivatives(u, 2);
            let sum: f64 = basis.values().iter().zip(&g[basis.first()..]).map(|(b, g)| b * g).sum();
            prop_assert!((sum - u).abs() < 1e-13 * size);
            let big = basis.derivatives(1).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let slope: f64 = basis.derivatives(1).iter().zip(&g[basis.first()..]).map(|(b, g)| b * g).sum();
            prop_assert!((slope - 1.0).abs() < 1e-13 * size * big.max(1.0));
        }
    }

    #[test]
    fn insertion_keeps_points(c in curve(), parts in prop::collection::vec(0.0..1.0_f64, 1..6)) {
        let (start, end) = c.domain();
        let more: Vec<f64> = parts.iter().map(|x| start + (end - start) * x).collect();
        let fine = c.refined(&more).unwrap();
        for u in parameters((start, end)) {
            prop_assert!((fine.point_at(u) - c.point_at(u)).norm() < 1e-13);
        }
    }

    #[test]
    fn insertion_up_to_full_multiplicity_keeps_points(c in curve(), part in 0.01..0.99_f64) {
        let (start, end) = c.domain();
        let x = start + (end - start) * part;
        let fine = c.refined(&vec![x; c.knots().degree() + 1]).unwrap();
        for u in parameters((start, end)) {
            prop_assert!((fine.point_at(u) - c.point_at(u)).norm() < 1e-13);
        }
    }

    #[test]
    fn elevation_keeps_points(c in curve(), by in 1_usize..=3) {
        let raised = c.elevated(c.knots().degree() + by).unwrap();
        prop_assert_eq!(raised.knots().degree(), c.knots().degree() + by);
        for u in parameters(c.domain()) {
            prop_assert!((raised.point_at(u) - c.point_at(u)).norm() < 1e-11);
        }
    }

    #[test]
    fn clamping_pieces_and_reversal_keep_points(c in curve(), a in 0.0..0.45_f64, b in 0.55..1.0_f64) {
        let (start, end) = c.domain();
        let at = |x: f64| start + (end - start) * x;
        let clamped = c.clamped();
        prop_assert!(clamped.knots().is_clamped());
        prop_assert_eq!(clamped.domain(), (start, end));
        let piece = c.piece(at(a), at(b)).unwrap();
        let back = c.reversed();
        prop_assert_eq!(back.domain(), (start, end));
        for u in parameters((start, end)) {
            prop_assert!((clamped.point_at(u) - c.point_at(u)).norm() < 1e-12);
            if u > at(a) && u < at(b) {
                prop_assert!((piece.point_at(u) - c.point_at(u)).norm() < 1e-12);
            }
        }
        // Reversal exactly at the middle, off any knot it may sit on.
        let u = at(0.377);
        prop_assert!((back.point_at(start + (end - u)) - c.point_at(u)).norm() < 1e-9);
    }

    /// Central differences with a step of 1e-4 of the span: truncation below 1e-6 of the third derivative's size.
    #[test]
    fn surface_derivatives_agree_with_differences(s in surface(), x in 0.1..0.9_f64, y in 0.1..0.9_f64) {
        let inside = |k: &KnotVector, x: f64| {
            let span = k.span(k.domain().0 + (k.domain().1 - k.domain().0) * x);
            let (low, high) = (k.knots()[span], k.knots()[span + 1]);
            (low + (high - low) * (0.3 + 0.4 * x), (high - low) * 1e-4)
        };
        let ((u, hu), (v, hv)) = (inside(s.knots_u(), x), inside(s.knots_v(), y));
        let d = s.derivatives(u, v);
        let (point, du, dv) = s.first_derivatives(u, v);
        prop_assert!((point - d.point).norm() < 1e-14);
        prop_assert!((du - d.du).norm() <= 1e-12 * d.du.norm() && (dv - d.dv).norm() <= 1e-12 * d.dv.norm());
        // In units of the step: first derivatives to 1e-9, second ones to 1e-10 absolute on a net of size 1.
        let near = |a: Vector3<f64>, b: Vector3<f64>, h: f64, t: f64| (a - b).norm() * h <= t;
        prop_assert!(near(d.du, (s.point(u + hu, v) - s.point(u - hu, v)) / (2.0 * hu), hu, 1e-8));
        prop_assert!(near(d.dv, (s.point(u, v + hv) - s.point(u, v - hv)) / (2.0 * hv), hv, 1e-8));
        let (_, up, vp) = s.first_derivatives(u + hu, v);
        let (_, um, vm) = s.first_derivatives(u - hu, v);
        prop_assert!(near(d.duu, (up - um) / (2.0 * hu), hu * hu, 1e-8));
        prop_assert!(near(d.duv, (vp - vm) / (2.0 * hu), hu * hv, 1e-8));
        let (_, _, vp) = s.first_derivatives(u, v + hv);
        let (_, _, vm) = s.first_derivatives(u, v - hv);
        prop_assert!(near(d.dvv, (vp - vm) / (2.0 * hv), hv * hv, 1e-8));
    }

    #[test]
    fn surface_forms_describe_the_same_points(s in surface(), x in 0.05..0.95_f64, y in 0.05..0.95_f64) {
        let ((u0, u1), (v0, v1)) = s.domain();
        let (u, v) = (u0 + (u1 - u0) * x, v0 + (v1 - v0) * y);
        let point = s.point(u, v);
        prop_assert!((s.swapped().point(v, u) - point).norm() < 1e-14);
        prop_assert!((s.clamped().point(u, v) - point).norm() < 1e-12);
        prop_assert!((s.iso_curve_u(u).point_at(v) - point).norm() < 1e-14);
        prop_assert!((s.iso_curve_v(v).point_at(u) - point).norm() < 1e-14);
        prop_assert!((s.grid(&[u], &[v])[0] - point).norm() < 1e-14);
        let (p, q) = (s.knots_u().degree(), s.knots_v().degree());
        prop_assert!((s.elevated(p + 1, q + 2).unwrap().point(u, v) - point).norm() < 1e-11);
        let fine = s.refined_u(&[u]).unwrap().refined_v(&[v, v]).unwrap();
        prop_assert!((fine.point(u, v) - point).norm() < 1e-13);
        let map = Affine {
            linear: Matrix3::new(1.0, 2.0, 0.5, -0.3, 1.5, 0.0, 0.2, 0.1, -2.0),
            translation: Vector3::new(3.0, -1.0, 2.0),
        };
        prop_assert!((s.transformed(&map).point(u, v) - map.point(&point)).norm() < 1e-13);
        prop_assert!(s.bounding_box().distance_squared(&point) < 1e-28);
    }

    #[test]
    fn pieces_spans_and_extensions_of_a_surface_keep_its_points(
        s in surface(), a in 0.0..0.45_f64, b in 0.55..1.0_f64, n in 1_usize..9, e in 0.0..0.1_f64,
    ) {
        let ((u0, u1), (v0, v1)) = s.domain();
        let at = |(low, high): (f64, f64), x: f64| low + (high - low) * x;
        let sides = [(at((u0, u1), a), at((u0, u1), b)), (at((v0, v1), 1.0 - b), at((v0, v1), 1.0 - a))];
        let piece = s.piece(sides[0], sides[1]).unwrap();
        prop_assert_eq!(piece.domain(), (sides[0], sides[1]));
        let cut = s.with_spans(n, n + 1).unwrap();
        let longest = |k: &KnotVector| k.spans().map(|i| k.knots()[i + 1] - k.knots()[i]).fold(0.0, f64::max);
        prop_assert!(longest(cut.knots_u()) <= (u1 - u0) / n as f64 * (1.0 + 1e-8));
        prop_assert!(longest(cut.knots_v()) <= (v1 - v0) / (n + 1) as f64 * (1.0 + 1e-8));
        // By a part of the end spans: further out, a polynomial of degree 6 with random coefficients is anything.
        let span = |k: &KnotVector, u: f64| { let i = k.span(u); k.knots()[i + 1] - k.knots()[i] };
        let by = [(u0, u1, s.knots_u()), (v0, v1, s.knots_v())]
            .map(|(low, high, k)| (e * span(k, low), 0.5 * e * span(k, high)));
        let Ok(larger) = s.extended(by[0], by[1]) else { return Ok(()) };
        prop_assert!((larger.domain().0.0 - (u0 - by[0].0)).abs() < 1e-15 + 1e-15 * u0.abs());
        for u in parameters((u0, u1)) {
            for v in parameters((v0, v1)) {
                let point = s.point(u, v);
                prop_assert!((cut.point(u, v) - point).norm() < 1e-11);
                prop_assert!((larger.point(u, v) - point).norm() < 1e-11);
                let inside = |x: f64, (low, high): (f64, f64)| x > low && x < high;
                if inside(u, sides[0]) && inside(v, sides[1]) {
                    prop_assert!((piece.point(u, v) - point).norm() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn gram_matrices_agree_with_finer_quadrature(k in smooth_knots()) {
        let (x, w) = gauss_legendre(12);
        let n = k.n_basis();
        for (a, b) in [(0, 0), (1, 0), (1, 1), (2, 2), (0, 2)] {
            let found = gram(&k, a, b);
            let mut exact = vec![0.0; n * n];
            let mut size = vec![0.0; n * n];
            for span in k.spans() {
                let (low, high) = (k.knots()[span], k.knots()[span + 1]);
                for (x, w) in x.iter().zip(&w) {
                    let basis = k.basis_derivatives(0.5 * (low + high) + 0.5 * (high - low) * x, 2);
                    for (i, left) in basis.derivatives(a).iter().enumerate() {
                        for (j, right) in basis.derivatives(b).iter().enumerate() {
                            let at = (basis.first() + i) * n + basis.first() + j;
                            exact[at] += 0.5 * (high - low) * w * left * right;
                            size[at] += 0.5 * (high - low) * w * (left * right).abs();
                        }
                    }
                }
            }
            for i in 0..n {
                for j in 0..n {
                    let value = found.get(i, j).copied().unwrap_or(0.0);
                    prop_assert!((value - exact[i * n + j]).abs() <= 1e-10 * size[i * n + j].max(1e-300));
                }
            }
        }
        // The basis sums to one: the mass matrix sums to the length of the domain.
        let mass: f64 = gram(&k, 0, 0).data().iter().sum();
        let (start, end) = k.domain();
        prop_assert!((mass - (end - start)).abs() <= 1e-12 * (end - start));
    }

    #[test]
    fn interpolation_returns_the_net(s in surface()) {
        prop_assume!(s.knots_u().is_clamped() && s.knots_v().is_clamped());
        let u = GrevilleCollocation::new(s.knots_u());
        let v = GrevilleCollocation::new(s.knots_v());
        let (Ok(u), Ok(v)) = (u, v) else { return Err(TestCaseError::reject("coinciding abscissae")); };
        let mut values = Vec::new();
        for &x in u.abscissae() {
            for &y in v.abscissae() {
                values.extend(s.homogeneous_point(x, y));
            }
        }
        interpolate_grid(&u, &v, &mut values, 4);
        for (found, exact) in values.iter().zip(s.net().as_flattened()) {
            prop_assert!((found - exact).abs() < 1e-9);
        }
    }
}

/// A bicubic panel with uneven knots: heights of a closed form at Greville abscissae.
fn panel() -> NurbsSurface {
    let ku = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.1, 0.15, 0.6, 1.0, 1.0, 1.0, 1.0]).unwrap();
    let kv = KnotVector::new(3, vec![-2.0, -2.0, -2.0, -2.0, 0.5, 0.5, 4.0, 4.0, 4.0, 4.0]).unwrap();
    let mut points = Vec::new();
    for &u in &ku.greville() {
        for &v in &kv.greville() {
            points.push(Point3::new(100.0 * u, 20.0 * v, 15.0 * (3.0 * u).sin() * (0.7 * v).cos()));
        }
    }
    NurbsSurface::from_points(ku, kv, &points, None).unwrap()
}

/// A spline that is one polynomial goes on as that polynomial.
#[test]
fn an_extension_is_the_same_polynomial() {
    let height = |x: f64, y: f64| 1.0 + x * x * x - 2.0 * x * y * y + 0.5 * y;
    let ku = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0, 1.0]).unwrap();
    let kv = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.3, 0.3, 1.0, 1.0, 1.0]).unwrap();
    let (u, v) = (GrevilleCollocation::new(&ku).unwrap(), GrevilleCollocation::new(&kv).unwrap());
    let places = u.abscissae().iter().flat_map(|&x| v.abscissae().iter().map(move |&y| [x, y]));
    let mut values: Vec<f64> = places.flat_map(|[x, y]| [x, y, height(x, y), 1.0]).collect();
    interpolate_grid(&u, &v, &mut values, 4);
    let surface = NurbsSurface::new(ku, kv, values.as_chunks::<4>().0.to_vec()).unwrap();
    let larger = surface.extended((0.5, 0.25), (0.0, 2.0)).unwrap();
    assert_eq!(larger.domain(), ((-0.5, 1.25), (0.0, 3.0)));
    for i in 0..=20 {
        for j in 0..=20 {
            let (x, y) = (-0.5 + 1.75 * f64::from(i) / 20.0, 3.0 * f64::from(j) / 20.0);
            let off = (larger.point(x, y) - Point3::new(x, y, height(x, y))).norm();
            assert!(off < 1e-12, "{off} at ({x}, {y})");
        }
    }
    assert!(surface.extended((-0.1, 0.0), (0.0, 0.0)).is_err());
    assert!(surface.extended((f64::NAN, 0.0), (0.0, 0.0)).is_err());
    // The weight 1 - 0.5 u vanishes at 2.
    let line = KnotVector::clamped_uniform(1, 1, 0.0, 1.0).unwrap();
    let net = vec![[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.5, 0.0, 0.0, 0.5], [0.5, 0.5, 0.0, 0.5]];
    let rational = NurbsSurface::new(line.clone(), line, net).unwrap();
    assert!(rational.extended((0.0, 0.9), (0.0, 0.0)).is_ok());
    assert!(rational.extended((0.0, 1.1), (0.0, 0.0)).is_err());
}

#[test]
fn points_offset_along_normals_project_back() {
    let panel = panel();
    let locator = SurfaceLocator::new(&panel, Wrap::default());
    for i in 0..20 {
        for j in 0..20 {
            let (u, v) = (f64::from(i) / 19.0, -2.0 + 6.0 * f64::from(j) / 19.0);
            for height in [0.0, 0.7, -2.0] {
                let target = panel.point(u, v) + panel.normal(u, v).unwrap() * height;
                let found = locator.closest(&target);
                assert!((found.u - u).abs() < 1e-9 && (found.v - v).abs() < 1e-8, "({u}, {v}): {found:?}");
                assert!((found.distance - height.abs()).abs() < 1e-11);
                let near = panel.closest_from(&target, (u + 0.03, v - 0.2), Wrap::default());
                assert!((near.u - u).abs() < 1e-9 && (near.v - v).abs() < 1e-8, "({u}, {v}): {near:?}");
            }
        }
    }
}

#[test]
fn beyond_the_border_the_closest_point_is_on_it() {
    let panel = panel();
    let target = panel.point(0.0, 1.0) - Vector3::x() * 30.0;
    let found = SurfaceLocator::new(&panel, Wrap::default()).closest(&target);
    assert_eq!(found.u, 0.0);
    // On the border curve the residual is perpendicular to the border.
    let (point, _, dv) = panel.first_derivatives(found.u, found.v);
    assert!((point - target).dot(&dv).abs() < 1e-9 * dv.norm() * found.distance);
}

#[test]
fn a_global_search_on_a_curve_beats_a_dense_scan() {
    let knots = KnotVector::clamped_uniform(3, 12, 0.0, 1.0).unwrap();
    let points: Vec<Point3<f64>> = (0..knots.n_basis())
        .map(|i| {
            let t = i as f64;
            Point3::new((1.1 * t).cos() * t, (1.1 * t).sin() * t, 0.3 * t)
        })
        .collect();
    let curve = NurbsCurve3::from_points(knots, &points, None).unwrap();
    for k in 0..50 {
        let t = f64::from(k);
        let target = Point3::new(12.0 * (2.3 * t).sin(), 9.0 * (1.7 * t).cos(), 4.0 * (0.9 * t).sin());
        let found = curve.closest(&target);
        let scan = (0..=4000)
            .map(|i| (curve.point_at(f64::from(i) / 4000.0) - target).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(found.distance <= scan + 1e-12, "{} against {scan}", found.distance);
    }
}

/// Quarter circle as a rational quadratic: curvature 1 / r everywhere, from the textbook's closed form.
#[test]
fn a_rational_quarter_circle_has_constant_curvature() {
    let h = 0.5_f64.sqrt();
    let knots = KnotVector::clamped_uniform(2, 1, 0.0, 1.0).unwrap();
    let points = [Point3::new(3.0, 0.0, 0.0), Point3::new(3.0, 3.0, 0.0), Point3::new(0.0, 3.0, 0.0)];
    let circle = NurbsCurve3::from_points(knots, &points, Some(&[1.0, h, 1.0])).unwrap();
    for i in 0..=10 {
        let [p, d1, d2] = circle.derivatives(f64::from(i) / 10.0);
        assert!((p.norm() - 3.0).abs() < 1e-14);
        assert!(p.dot(&d1).abs() < 1e-13 * d1.norm());
        assert!((d1.cross(&d2).norm() / d1.norm().powi(3) - 1.0 / 3.0).abs() < 1e-13);
    }
}

/// An octant of a sphere as a rational biquadratic: K = 1 / r², |H| = 1 / r.
#[test]
fn a_rational_sphere_octant_has_the_sphere_s_curvatures() {
    let h = 0.5_f64.sqrt();
    let knots = KnotVector::clamped_uniform(2, 1, 0.0, 1.0).unwrap();
    let arc = [(1.0, 0.0, 1.0), (1.0, 1.0, h), (0.0, 1.0, 1.0)];
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (x, y, wu) in arc {
        for (r, z, wv) in arc {
            points.push(Point3::new(2.0 * r * x, 2.0 * r * y, 2.0 * z));
            weights.push(wu * wv);
        }
    }
    let sphere = NurbsSurface::from_points(knots.clone(), knots, &points, Some(&weights)).unwrap();
    for i in 0..=8 {
        for j in 0..8 {
            let d = sphere.derivatives(f64::from(i) / 8.0, f64::from(j) / 8.0);
            assert!((d.point.coords.norm() - 2.0).abs() < 1e-14);
            let (gauss, mean) = d.curvatures().unwrap();
            assert!((gauss - 0.25).abs() < 1e-11 && (mean.abs() - 0.5).abs() < 1e-11, "{gauss} {mean}");
            assert!((d.greatest_curvature().unwrap() - 0.5).abs() < 1e-5);
        }
    }
    assert!(sphere.normal(0.5, 1.0).is_none_or(|n| n.iter().all(|c| c.is_finite())));
}
