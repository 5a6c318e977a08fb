//! The engine against the reference vectors `r1` and `r2`, against its own definition, and against the solution with
//! multipliers by dense elimination.

use super::network::of;
use super::*;
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::math::{GridMatrix, Point3, Vector3};
use crate::ops::net::Mask;
use nalgebra::DMatrix;
use serde_json::Value;

fn vector(name: &str) -> Value {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors").join(name);
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

fn points(value: &Value) -> Vec<Point3<f64>> {
    numbers(value).chunks_exact(3).map(|c| Point3::new(c[0], c[1], c[2])).collect()
}

/// A surface with a net of the first vector: its knots play no part.
fn first_net(data: &Value) -> NurbsSurface {
    let knots = |n: usize| KnotVector::clamped_uniform(2, n - 2, 0.0, 1.0).unwrap();
    NurbsSurface::from_points(knots(4), knots(3), &points(&data["net"]), None).unwrap()
}

/// The surface of the second vector.
fn second_surface(data: &Value) -> NurbsSurface {
    let knots = |name: &str| KnotVector::new(3, numbers(&data[name])).unwrap();
    NurbsSurface::from_points(knots("tu"), knots("tv"), &points(&data["controls"]), None).unwrap()
}

/// A wavy surface with uneven knots, and with weights when asked for.
fn wavy(weighted: &[f64]) -> NurbsSurface {
    let u = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.1, 0.35, 0.5, 0.8, 1.0, 1.0, 1.0, 1.0]).unwrap();
    let v = KnotVector::new(2, vec![-1.0, -1.0, -1.0, -0.2, 0.1, 0.7, 1.0, 1.0, 1.0]).unwrap();
    let (gu, gv) = (u.greville(), v.greville());
    let at = |x: f64, y: f64| Point3::new(100.0 * x, 40.0 * y, 8.0 * (3.0 * x).sin() * (2.0 * y).cos());
    let net: Vec<_> = gu.iter().flat_map(|&x| gv.iter().map(move |&y| at(x, y))).collect();
    let weights: Vec<f64> = (0..net.len()).map(|k| weighted.get(k % 3).copied().unwrap_or(1.0)).collect();
    NurbsSurface::from_points(u, v, &net, Some(&weights)).unwrap()
}

const ENGINES: [(&str, Criteria); 4] = [
    ("dforce", Criteria { force_variation: 1.0, ..Criteria::NONE }),
    ("force", Criteria { force: 1.0, ..Criteria::NONE }),
    ("length", Criteria { bar_length: 1.0, ..Criteria::NONE }),
    ("disp", Criteria { displacement: 1.0, ..Criteria::NONE }),
];
const GHOSTS: [(&str, Ghosts); 3] =
    [("fixed", Ghosts::Fixed), ("floating", Ghosts::Floating), ("none", Ghosts::None)];

/// Numbers without a pattern, within [-1, 1].
fn scattered(count: usize) -> Vec<[f64; 3]> {
    (0..count).map(|k| [0.0, 1.0, 2.0].map(|c| (12.9898 * k as f64 + 78.233 * c + 1.0).sin())).collect()
}

fn coordinates(surface: &NurbsSurface) -> Vec<[f64; 3]> {
    surface.control_points().map(|p| p.coords.into()).collect()
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (k, (f, e)) in found.iter().zip(expected).enumerate() {
        assert!((f - e).abs() <= tolerance, "{what}, number {k}: {f} against {e}");
    }
}

/// The change of the forces as a dense matrix.
fn force_matrix(network: &Network) -> DMatrix<f64> {
    let columns = network.shape()[1];
    let rows = network.force_rows();
    let mut dense = DMatrix::zeros(rows.len(), rows.len());
    for (a, row) in rows.iter().enumerate() {
        row.nodes(columns).zip(&row.values).for_each(|(b, x)| dense[(a, b)] = *x);
    }
    dense
}

fn dense(matrix: &GridMatrix) -> DMatrix<f64> {
    let n = matrix.size();
    let unit = |k: usize| (0..n).map(|a| [f64::from(u8::from(a == k))]).collect::<Vec<_>>();
    let mut out = DMatrix::zeros(n, n);
    for k in 0..n {
        matrix.times(&unit(k)).iter().enumerate().for_each(|(a, x)| out[(a, k)] = x[0]);
    }
    out
}

fn by_rows(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.transpose().as_slice().to_vec()
}

#[test]
fn operators_are_those_of_the_vector() {
    let data = vector("r1_force_density.json");
    let surface = first_net(&data);
    let net = coordinates(&surface);
    for (name, ghosts) in GHOSTS {
        let network = Network::unsupported(&surface, [1.5, 0.5], ghosts);
        assert_near(&by_rows(&force_matrix(&network)), &numbers(&data[name]["D"]), 1e-10, name);
        assert_near(network.forces(&net).as_flattened(), &numbers(&data[name]["f0"]), 1e-10, name);
    }
    for (name, criteria) in ENGINES {
        let expected = &data[format!("engine_{name}")];
        let network = Network::unsupported(&surface, [1.5, 0.5], Ghosts::Fixed);
        let (g, h) = criteria.quadratic(&network, &net, [2, 2]);
        assert_near(&by_rows(&dense(&g)), &numbers(&expected["G"]), 1e-10, name);
        assert_near(h.as_flattened(), &numbers(&expected["H"]), 1e-10, name);
    }
}

fn second_constraints(data: &Value, surface: &NurbsSurface) -> Vec<Constraint> {
    let (us, vs) = (numbers(&data["u"]), numbers(&data["v"]));
    let moves = points(&data["displacement"]);
    let one =
        |k: usize| Constraint::through([us[k], vs[k]], &(surface.point(us[k], vs[k]) + moves[k].coords), 1.0);
    (0..us.len()).map(one).collect()
}

#[test]
fn deformations_are_those_of_the_vector() {
    let data = vector("r2_deform.json");
    let surface = second_surface(&data);
    let constraints = second_constraints(&data, &surface);
    for (name, criteria) in ENGINES {
        let network = Network::unsupported(&surface, [1.0; 2], Ghosts::Fixed);
        let mut system = System::new(&surface, &network, &criteria).unwrap();
        let expected = |form: &str| numbers(&data["results"][format!("{name}_{form}")]["eps"]);
        let hard = system.exact(&constraints, 1e-9).unwrap();
        assert_near(hard.displacements.as_flattened(), &expected("hard"), 1e-7, name);
        system.add(constraints.iter().copied()).unwrap();
        let soft = system.balanced(10.0).unwrap();
        assert_near(soft.displacements.as_flattened(), &expected("soft_lam10"), 1e-7, name);
    }
    let network = Network::unsupported(&surface, [1.0; 2], Ghosts::Floating);
    let floating = System::new(&surface, &network, &ENGINES[0].1).unwrap().exact(&constraints, 1e-9).unwrap();
    let expected = numbers(&data["results"]["dforce_floating_hard"]["eps"]);
    assert_near(floating.displacements.as_flattened(), &expected, 1e-6, "floating");
}

/// Half the sum of squares that an engine makes least, bar by bar from the moved net.
fn directly(network: &Network, criteria: &Criteria, net: &[[f64; 3]], moves: &[[f64; 3]]) -> f64 {
    let square = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
    let mut before = vec![[0.0; 3]; net.len()];
    let mut after = before.clone();
    let mut lengths = 0.0;
    for bar in network.bars() {
        let (old, change) = (of(&bar.before, net), of(&bar.change, moves));
        let new = [0, 1, 2].map(|k| old[k] + change[k]);
        lengths += bar.density * square(new);
        for (to, sign) in bar.pull {
            (0..3).for_each(|k| before[to][k] += sign * bar.density * old[k]);
            (0..3).for_each(|k| after[to][k] += sign * bar.density * new[k]);
        }
    }
    let free = |(a, v): (usize, [f64; 3])| if network.free().contains_index(a) { square(v) } else { 0.0 };
    let changes = before.iter().zip(&after).map(|(b, a)| [0, 1, 2].map(|k| a[k] - b[k]));
    0.5 * (criteria.force_variation * changes.enumerate().map(free).sum::<f64>()
        + criteria.force * after.iter().copied().enumerate().map(free).sum::<f64>()
        + criteria.bar_length * lengths
        + criteria.displacement * moves.iter().copied().map(square).sum::<f64>())
}

#[test]
fn the_quadratic_form_is_the_measure_itself() {
    let surface = wavy(&[]);
    let net = coordinates(&surface);
    let mixed = Criteria { force_variation: 0.7, force: 0.2, bar_length: 1.3, displacement: 0.4 };
    let (rows, columns) = surface.shape();
    let whole = Mask::empty(rows, columns).complement();
    for free in [whole.clone(), whole.off_border(1)] {
        for (name, ghosts) in GHOSTS {
            for (engine, criteria) in ENGINES.iter().chain(&[("mixed", mixed)]) {
                let network = Network::new(&surface, [1.5, 0.5], ghosts, free.clone());
                let mut moves = scattered(net.len());
                (0..net.len()).filter(|&a| !free.contains_index(a)).for_each(|a| moves[a] = [0.0; 3]);
                let (g, h) = criteria.quadratic(&network, &net, [3, 2]);
                let product = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 {
                    a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| x * y).sum()
                };
                let found = 0.5 * product(&moves, &g.times(&moves)) + product(&h, &moves);
                let expected = directly(&network, criteria, &net, &moves)
                    - directly(&network, criteria, &net, &vec![[0.0; 3]; net.len()]);
                let off = (found - expected).abs() / expected.abs().max(1.0);
                assert!(off < 1e-9, "{engine}, {name} ghosts: {found} against {expected}");
            }
        }
    }
}

#[test]
fn the_stencil_is_whole_up_to_the_corners_and_has_the_rank_of_its_ghosts() {
    let surface = wavy(&[]);
    let n = surface.net().len();
    for ((_, ghosts), rank) in GHOSTS.into_iter().zip([n, n - 4, n - 1]) {
        let matrix = force_matrix(&Network::unsupported(&surface, [1.5, 0.5], ghosts));
        if ghosts == Ghosts::Fixed {
            assert!((0..n).all(|a| matrix[(a, a)].to_bits() == 4.0_f64.to_bits()));
        }
        let values = matrix.singular_values();
        let found = values.iter().filter(|s| **s > 1e-9 * values[0]).count();
        assert_eq!(found, rank, "{ghosts:?}");
    }
}

#[test]
fn without_constraints_a_drawn_net_is_in_balance_and_a_kept_one_stays() {
    let surface = wavy(&[]);
    let network = Network::unsupported(&surface, [1.5, 0.5], Ghosts::Fixed);
    let lengths = System::new(&surface, &network, &ENGINES[2].1).unwrap().balanced(1.0).unwrap();
    // Forces with the ghosts where they were.
    let (matrix, before) = (force_matrix(&network), network.forces(&coordinates(&surface)));
    let moves = DMatrix::from_fn(before.len(), 3, |a, k| lengths.displacements[a][k]);
    let change = matrix * moves;
    for (a, force) in before.iter().enumerate() {
        (0..3).for_each(|k| assert!((force[k] + change[(a, k)]).abs() < 1e-9));
    }
    for engine in [0, 3] {
        let still = Constraint::through([0.3, 0.2], &surface.point(0.3, 0.2), 1.0);
        let mut system = System::new(&surface, &network, &ENGINES[engine].1).unwrap();
        let hard = system.exact(&[still], 1e-9).unwrap();
        system.add([still]).unwrap();
        for result in [hard, system.balanced(10.0).unwrap()] {
            assert!(result.displacements.as_flattened().iter().all(|x| x.abs() < 1e-12));
        }
    }
}

/// Points pulled off the surface, over the whole domain.
fn pulled(surface: &NurbsSurface) -> Vec<Constraint> {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let places = [[0.1, 0.15], [0.85, 0.2], [0.5, 0.5], [0.2, 0.9], [0.9, 0.85], [0.45, 0.1]];
    let one = |(k, [a, b]): (usize, &[f64; 2])| {
        let at = [u0 + a * (u1 - u0), v0 + b * (v1 - v0)];
        let shift = Vector3::new(0.3 * k as f64, -0.5, 4.0 - k as f64);
        Constraint::through(at, &(surface.point(at[0], at[1]) + shift), 1.0)
    };
    places.iter().enumerate().map(one).collect()
}

/// Least displacements under constraints by elimination with multipliers.
fn with_multipliers(
    system: (&GridMatrix, &[[f64; 3]]),
    rows: &[constraint::Prepared],
    columns: usize,
) -> DMatrix<f64> {
    let (n, m) = (system.1.len(), rows.len());
    let mut matrix = DMatrix::zeros(n + m, n + m);
    matrix.view_mut((0, 0), (n, n)).copy_from(&dense(system.0));
    let mut right = DMatrix::zeros(n + m, 3);
    for (a, h) in system.1.iter().enumerate() {
        (0..3).for_each(|k| right[(a, k)] = -h[k]);
    }
    for (r, row) in rows.iter().enumerate() {
        for (a, x) in row.row.nodes(columns).zip(&row.row.values) {
            matrix[(n + r, a)] = *x;
            matrix[(a, n + r)] = *x;
        }
        (0..3).for_each(|k| right[(n + r, k)] = row.lack[k]);
    }
    matrix.lu().solve(&right).unwrap()
}

#[test]
fn the_exact_form_is_the_solution_with_multipliers() {
    for weights in [vec![], vec![1.0, 0.6, 1.7]] {
        let surface = wavy(&weights);
        let constraints = pulled(&surface);
        let net = coordinates(&surface);
        for (name, criteria) in ENGINES {
            let network = Network::unsupported(&surface, [1.5, 0.5], Ghosts::Fixed);
            let found =
                System::new(&surface, &network, &criteria).unwrap().exact(&constraints, 1e-9).unwrap();
            let (g, h) = criteria.quadratic(&network, &net, [3, 2]);
            let rows: Vec<_> = constraints.iter().map(|c| c.prepared(&surface)).collect();
            let expected = with_multipliers((&g, &h), &rows, surface.shape().1);
            for (a, moved) in found.displacements.iter().enumerate() {
                (0..3).for_each(|k| {
                    let off = (moved[k] - expected[(a, k)]).abs();
                    assert!(off < 1e-6, "{name}: {} against {}", moved[k], expected[(a, k)]);
                });
            }
            for c in &constraints {
                let at = found.surface.point(c.at[0], c.at[1]);
                assert!((at.coords - c.wanted).norm() < 1e-9, "{name}: a point is missed");
            }
        }
    }
}

#[test]
fn nodes_that_are_not_free_keep_their_bits_and_what_reaches_only_them_is_refused() {
    let surface = wavy(&[1.0, 0.6, 1.7]);
    let (rows, columns) = surface.shape();
    let free = Mask::empty(rows, columns).complement().off_border(1);
    let network = Network::new(&surface, [1.0; 2], Ghosts::Fixed, free.clone());
    let system = System::new(&surface, &network, &ENGINES[0].1).unwrap();
    let inside = Constraint::through([0.5, 0.0], &Point3::new(50.0, 3.0, 9.0), 1.0);
    let moved = system.exact(&[inside], 1e-9).unwrap().surface;
    for (a, (old, new)) in surface.control_points().zip(moved.control_points()).enumerate() {
        assert_eq!(old == new, !free.contains_index(a), "node {a}");
    }
    let corner = Constraint::through([0.0, -1.0], &Point3::new(50.0, 3.0, 9.0), 1.0);
    assert!(matches!(system.exact(&[corner], 1e-9), Err(ForceDensityError::Conflict { misses: 1, .. })));
    assert_eq!(redundant(&surface, &network, &[inside, corner]), [1]);
    let nothing = Network::new(&surface, [1.0; 2], Ghosts::Fixed, Mask::empty(rows, columns));
    assert!(matches!(System::new(&surface, &nothing, &ENGINES[0].1), Err(ForceDensityError::NothingFree)));
}

#[test]
fn what_is_said_twice_is_found_and_what_contradicts_is_refused() {
    let surface = wavy(&[]);
    let network = Network::unsupported(&surface, [1.0; 2], Ghosts::Fixed);
    let system = System::new(&surface, &network, &ENGINES[0].1).unwrap();
    let once = pulled(&surface);
    let mut twice = once.clone();
    twice.insert(3, once[1]);
    twice.push(once[4]);
    assert_eq!(redundant(&surface, &network, &twice), [3, 7]);
    let (a, b) = (system.exact(&once, 1e-9).unwrap(), system.exact(&twice, 1e-6).unwrap());
    for (a, b) in a.displacements.as_flattened().iter().zip(b.displacements.as_flattened()) {
        assert!((a - b).abs() < 1e-6);
    }
    // One row against two that want 1 mm less: the compromise is two thirds off for the one.
    let higher = Constraint { wanted: once[4].wanted + Vector3::z(), ..once[4] };
    let rest = [higher, once[4], once[4]];
    let Err(ForceDensityError::Conflict { residual, misses, .. }) = system.exact(&rest, 1e-3) else {
        panic!("contradicting constraints were met")
    };
    assert!((residual - 2.0 / 3.0).abs() < 1e-6, "{residual}");
    assert_eq!(misses, 3);
}

#[test]
fn rows_beyond_the_degrees_of_freedom_are_redundant_one_by_one() {
    // 7 functions of degree 2 along v at one u: of 20 points on that line 7 are independent.
    let surface = wavy(&[]);
    let network = Network::unsupported(&surface, [1.0; 2], Ghosts::Fixed);
    let line = |k: usize| {
        let at = [0.37, -1.0 + 2.0 * (k as f64 / 19.0)];
        Constraint::through(at, &surface.point(at[0], at[1]), 1.0)
    };
    let line: Vec<Constraint> = (0..20).map(line).collect();
    assert_eq!(redundant(&surface, &network, &line).len(), 20 - surface.shape().1);
}

#[test]
fn a_border_gets_the_normals_that_it_is_given_without_turning_round() {
    for weights in [vec![], vec![1.0, 0.6, 1.7]] {
        let surface = wavy(&weights);
        let network = Network::unsupported(&surface, [1.0; 2], Ghosts::Fixed);
        let mut constraints = Vec::new();
        let places: Vec<f64> = vec![0.05, 0.3, 0.62, 0.93];
        let wish = |u: f64| {
            let old = surface.normal(u, -1.0).unwrap();
            (old + Vector3::new(0.3 * u, 0.4 - u, 0.0)).normalize()
        };
        for &u in &places {
            constraints.push(Constraint::through([u, -1.0], &surface.point(u, -1.0), 1.0));
            constraints.extend(Constraint::with_normal(&surface, [u, -1.0], &wish(u), 1.0).unwrap());
        }
        let moved = System::new(&surface, &network, &ENGINES[0].1).unwrap();
        let moved = moved.exact(&constraints, 1e-6).unwrap().surface;
        for &u in &places {
            let angle = moved.normal(u, -1.0).unwrap().angle(&wish(u)).to_degrees();
            assert!(angle < 1e-4, "{angle} degrees at {u}");
            assert!((moved.point(u, -1.0) - surface.point(u, -1.0)).norm() < 1e-6);
        }
    }
}

#[test]
fn numbers_that_mean_nothing_are_refused() {
    let surface = wavy(&[]);
    let network = Network::unsupported(&surface, [1.0; 2], Ghosts::Fixed);
    let positive =
        |e: Result<(), ForceDensityError>| assert!(matches!(e, Err(ForceDensityError::NotPositive { .. })));
    positive(System::new(&surface, &network, &Criteria::NONE).map(drop));
    positive(System::new(&surface, &network, &Criteria { force: f64::NAN, ..Criteria::NONE }).map(drop));
    let flat = Network::unsupported(&surface, [0.0, 1.0], Ghosts::Fixed);
    positive(System::new(&surface, &flat, &ENGINES[0].1).map(drop));
    let mut system = System::new(&surface, &network, &ENGINES[0].1).unwrap();
    positive(system.balanced(0.0).map(drop));
    positive(system.add([Constraint::through([0.5, 0.0], &Point3::origin(), -1.0)]));
}
