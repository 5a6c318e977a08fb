//! Radius and blend against those of the parts' formulas.

use crate::lines::{Found, errors, errors_from, sampled, within};
use crate::parts::points;
use crate::scan::{Kind, Part, cloud};
use resurf::geometry::nurbs::{NurbsSurface, Wrap};
use resurf::math::Point3;
use resurf::ops::feature_reconstruction::backbone::Backbone;
use resurf::ops::feature_reconstruction::error::ReconstructionError;
use resurf::ops::feature_reconstruction::fishbone::FishboneSettings;
use resurf::ops::feature_reconstruction::limiting_line::LimitingLine;
use resurf::ops::feature_reconstruction::metric::ParameterLine;
use resurf::ops::feature_reconstruction::radius::{BlendCloud, RadiusLaw, Wanted, radius};
use resurf::ops::feature_reconstruction::rolling::{Edge, Roller, rolled};
use resurf::ops::feature_reconstruction::secondary::{
    CharacterLines, CloudUse, SecondarySettings, Sources, secondary,
};
use resurf::ops::feature_reconstruction::{Closure, Projector};
use resurf::ops::force_density::Criteria;

/// The secondary under the objective's points.
fn under(part: &Part, cloud: &cloud::Cloud, found: &Found) -> NurbsSurface {
    let objective = points(&cloud.labelled(cloud::OBJECTIVE));
    let projector = Projector::new(&found.surface, Wrap::default());
    let feet = projector.feet(&objective);
    let rim = |line: &LimitingLine| {
        let steps = if line.closure == Closure::Closed { 400.0 } else { 399.0 };
        let at = |k: usize| line.curve.point_at(k as f64 / steps).into();
        ParameterLine { points: (0..400).map(at).collect(), closure: line.closure }
    };
    let rims: Vec<ParameterLine> = found.lines.iter().map(rim).collect();
    let (primary, spacing) = (&projector, cloud.spacing);
    let sources = Sources { primary, points: &objective, feet: &feet, spacing, rims: &rims };
    let counts = if part.closed { [3, 11] } else { [1, 21] };
    let settings = SecondarySettings {
        lines: CharacterLines::Fishbone {
            backbone: Backbone::Fit,
            settings: FishboneSettings { along: counts[0], ribs: counts[1] },
        },
        cloud: CloudUse::Fitted,
        criteria: Criteria { force_variation: 1.0, ..Criteria::NONE },
        spans: None,
        limits: Some([1.0, 10.0]),
    };
    secondary(&sources, &settings).unwrap().surface
}

/// Points of the blend nearer to a line than to the others.
fn beside(found: &Found, line: usize, blend: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let dense: Vec<Vec<[f64; 3]>> = found
        .lines
        .iter()
        .map(|line| sampled(line, &found.surface, 200).into_iter().map(Into::into).collect())
        .collect();
    let away = |p: &Point3<f64>, k: usize| errors(&[*p], &dense[k], false).0;
    let own = |p: &&Point3<f64>| (0..dense.len()).all(|k| away(p, line) <= away(p, k));
    blend.iter().filter(own).copied().collect()
}

/// The pad's radius within a hundredth without noise and within three with it, blends on both surfaces and tangent to
/// them, and without noise contacts where the formulas have them.
#[test]
fn radii_and_contacts_are_those_of_the_formulas() {
    let cases = [
        (Kind::Pad, 40_000, 0.0, 1, Some([0.01, 0.05])),
        // With noise the contacts move as the radius does: only that is held.
        (Kind::Pad, 40_000, 0.05, 1, None),
    ];
    for (kind, count, noise, seed, most) in cases {
        let part = Part::new(kind);
        let what = format!("{kind:?}, noise {noise}, seed {seed}");
        let cloud = part.cloud(count, noise, seed);
        let found = Found::of(&part, &cloud);
        let second = under(&part, &cloud, &found);
        let blend = points(&cloud.labelled(cloud::BLEND));
        for (k, line) in found.lines.iter().enumerate() {
            let (closure, side) = (line.closure, part.side);
            let edge = Edge { surfaces: [&found.surface, &second], line: &line.curve, closure, side };
            let own = BlendCloud::new(&beside(&found, k, &blend), cloud.spacing, noise);
            let law = radius(&own, &Roller::new(edge, 160).unwrap(), Wanted::Tested).unwrap().law;
            let within_share = if noise > 0.0 { 0.03 } else { 0.01 };
            let off = (law.mean() / part.radius - 1.0).abs();
            assert!(matches!(law, RadiusLaw::Constant { .. }) && off <= within_share, "{what}: {law:?}");
            let ball = rolled(edge, &law, 2e-5 * part.radius).unwrap();
            assert!(ball.angle.to_degrees() <= 0.05, "{what}: {}", ball.angle);
            for (side, surface) in [&found.surface, &second].into_iter().enumerate() {
                let contact = |k: usize| ball.blend.contacts[side].point_at(f64::from(k as u32) / 500.0);
                let all = (0..500).map(contact).map(|p| surface.point(p.x, p.y)).collect();
                let truth = |c: &'_ crate::scan::Contacts| {
                    if side == 0 { c.primary.clone() } else { c.secondary.clone() }
                };
                let truth: Vec<Vec<[f64; 3]>> = part.truth.iter().map(truth).collect();
                let near: Vec<_> = truth.iter().collect();
                let (mean, greatest) = errors_from(&within(&part, all), &near, part.closed);
                let near = most.is_none_or(|[a, b]| mean <= a && greatest <= b);
                assert!(near, "{what}, side {side}: {mean} {greatest}");
            }
        }
    }
}

/// A ball larger than the feature finds no place, and the error says so.
#[test]
fn a_radius_larger_than_the_feature_is_refused() {
    let part = Part::new(Kind::Pad);
    let cloud = part.cloud(10_000, 0.0, 1);
    let found = Found::of(&part, &cloud);
    let second = under(&part, &cloud, &found);
    let line = &found.lines[0];
    let surfaces = [&found.surface, &second];
    let edge = Edge { surfaces, line: &line.curve, closure: line.closure, side: part.side };
    let error = rolled(edge, &RadiusLaw::Constant { radius: 200.0 }, 1e-4).unwrap_err();
    assert!(matches!(error, ReconstructionError::BallDoesNotFit { .. }), "{error}");
}
