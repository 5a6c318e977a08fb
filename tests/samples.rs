//! The committed sample parts are what their generator writes, byte for byte.

#[path = "../samples/generate/mod.rs"]
mod generate;

use std::path::Path;

#[test]
fn samples_are_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples");
    for sample in generate::all() {
        let committed = std::fs::read(root.join(sample.path)).unwrap_or_default();
        assert!(
            committed == sample.bytes,
            "samples/{} is stale: write it again with `cargo run --example make-samples`",
            sample.path
        );
    }
}

/// What the formulas of a scanned part promise: the ball's centre is its radius away from both contacts, along the
/// normals there, and every point of a cloud without noise lies where its label says.
#[test]
fn scanned_parts_are_what_their_formulas_say() {
    use generate::scan::{Kind, Part, cloud};
    let difference = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
    let norm = |a: [f64; 3]| a.iter().map(|c| c * c).sum::<f64>().sqrt();
    for kind in [Kind::Pad, Kind::Border, Kind::Groove, Kind::Sector] {
        let part = Part::new(kind);
        for contacts in &part.truth {
            for k in 0..contacts.centre.len() {
                let up = difference(contacts.centre[k], contacts.secondary[k]);
                let off = (norm(up) - part.radius).abs() / part.radius;
                assert!(off < 1e-7, "{kind:?}: contact {k} is off by {off} radii");
                let [x, y, _] = contacts.secondary[k];
                let n = part.secondary_normal(x, y);
                let straight: f64 = (0..3).map(|c| up[c] * n[c]).sum::<f64>() * part.side / part.radius;
                assert!((straight - 1.0).abs() < 1e-7, "{kind:?}: the ball does not touch at {k}");
                let [x, y, z] = contacts.limiting[k];
                assert!((z - part.secondary(x, y)).abs() < 1e-9, "{kind:?}: the sheets do not meet at {k}");
            }
        }
        let cloud = part.cloud(4000, 0.0, 7);
        let counts = [cloud::PRIMARY, cloud::OBJECTIVE, cloud::BLEND].map(|l| cloud.labelled(l).len());
        assert!(counts.iter().all(|c| *c > 100), "{kind:?}: {counts:?}");
        for [x, y, z] in cloud.labelled(cloud::PRIMARY) {
            assert!((z - part.primary(x, y)).abs() < 1e-12);
        }
        for [x, y, z] in cloud.labelled(cloud::OBJECTIVE) {
            assert!((z - part.secondary(x, y)).abs() < 1e-12);
        }
        // The blend fills the edge: it lies on the ball's side of both sheets, but for the chords between stations.
        let sag = 1e-3 * part.radius;
        for [x, y, z] in cloud.labelled(cloud::BLEND) {
            let (a, b) = (part.primary(x, y), part.secondary(x, y));
            let edge = if part.side > 0.0 { a.max(b) } else { a.min(b) };
            assert!((z - edge) * part.side > -sag, "{kind:?}: a blend point is inside the part");
            assert!((z - edge).abs() < part.radius, "{kind:?}: a blend point is far out");
        }
    }
}

/// A seed means the same points, and noise is as large as it was asked for.
#[test]
fn clouds_repeat_and_their_noise_is_what_was_asked_for() {
    use generate::scan::{Kind, Part};
    let part = Part::new(Kind::Pad);
    let (a, b) = (part.cloud(4000, 0.05, 3), part.cloud(4000, 0.05, 3));
    assert!(a.points == b.points && a.labels == b.labels);
    assert!(part.cloud(4000, 0.05, 4).points != a.points);
    let clean = part.cloud(4000, 0.0, 3);
    let off = a.points.as_flattened().iter().zip(clean.points.as_flattened()).map(|(a, b)| a - b);
    let (sum, squares) = off.fold((0.0, 0.0), |(s, q), d| (s + d, q + d * d));
    let n = 3.0 * clean.points.len() as f64;
    assert!((sum / n).abs() < 0.002 && ((squares / n).sqrt() - 0.05).abs() < 0.002);
    let all = Part::new(Kind::Diaphragm).cloud(20_000, 0.0, 3);
    assert!((15_000..25_000).contains(&all.points.len()), "{}", all.points.len());
}
