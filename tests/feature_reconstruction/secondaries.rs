//! The secondary surface against the clouds and the formulas of the parts.

use crate::parts::{points, primary};
use crate::scan::{Kind, Part, cloud};
use resurf::geometry::nurbs::{NurbsSurface, Wrap};
use resurf::math::Point3;
use resurf::ops::feature_reconstruction::backbone::Backbone;
use resurf::ops::feature_reconstruction::fishbone::FishboneSettings;
use resurf::ops::feature_reconstruction::metric::ParameterLine;
use resurf::ops::feature_reconstruction::secondary::{
    CharacterLines, CloudUse, Secondary, SecondarySettings, Sources, secondary,
};
use resurf::ops::feature_reconstruction::{Closure, Projector};
use resurf::ops::force_density::Criteria;

/// A scanned feature with its true limiting lines.
struct Scanned {
    part: Part,
    surface: NurbsSurface,
    objective: Vec<Point3<f64>>,
    spacing: f64,
    rims: Vec<ParameterLine>,
}

impl Scanned {
    fn new(kind: Kind, count: usize, noise: f64, seed: u64) -> Self {
        let part = Part::new(kind);
        let cloud = part.cloud(count, noise, seed);
        let surface = primary(&part);
        let surface =
            if part.closed { surface } else { surface.extended((13.0, 13.0), (30.0, 30.0)).unwrap() };
        let closure = if part.closed { Closure::Closed } else { Closure::Open };
        // The parameters of the primary are x and y.
        let rim = |contacts: &crate::scan::Contacts| ParameterLine {
            points: contacts.limiting.iter().map(|p| [p[0], p[1]]).collect(),
            closure,
        };
        let rims = part.truth.iter().map(rim).collect();
        let objective = points(&cloud.labelled(cloud::OBJECTIVE));
        Self { part, surface, objective, spacing: cloud.spacing, rims }
    }

    fn secondary(&self, settings: &SecondarySettings<'_>) -> Secondary {
        let projector = Projector::new(&self.surface, Wrap::default());
        let feet = projector.feet(&self.objective);
        let (primary, points, spacing, rims) = (&projector, &self.objective[..], self.spacing, &self.rims[..]);
        secondary(&Sources { primary, points, feet: &feet, spacing, rims }, settings).unwrap()
    }

    /// Mean and greatest distance of the surface from the formula under the objective's points.
    fn from_formula(&self, found: &NurbsSurface) -> [f64; 2] {
        let projector = Projector::new(found, Wrap::default());
        let feet = projector.feet(&self.objective);
        let off = feet.iter().map(|foot| {
            let p = foot.point;
            let normal = self.part.secondary_normal(p.x, p.y);
            ((p.z - self.part.secondary(p.x, p.y)) * normal[2]).abs()
        });
        let (sum, most) = off.fold((0.0, 0.0_f64), |(sum, most), d| (sum + d, most.max(d)));
        [sum / feet.len() as f64, most]
    }
}

fn settings<'a>(along: usize, ribs: usize, cloud: CloudUse, spans: Option<[usize; 2]>) -> SecondarySettings<'a> {
    SecondarySettings {
        lines: CharacterLines::Fishbone {
            backbone: Backbone::Fit,
            settings: FishboneSettings { along, ribs },
        },
        cloud,
        criteria: Criteria { force_variation: 1.0, ..Criteria::NONE },
        spans,
        limits: Some([1.0, 10.0]),
    }
}

#[test]
fn table() {
    for (kind, count, noise, along, ribs, spans) in [
        (Kind::Pad, 40_000, 0.0, 3, 11, [24, 16]),
        (Kind::Pad, 40_000, 0.05, 3, 11, [24, 16]),
        (Kind::Pad, 40_000, 0.05, 3, 23, [24, 16]),
        (Kind::Groove, 34_989, 0.0, 1, 31, [14, 40]),
        (Kind::Groove, 34_989, 0.05, 1, 31, [14, 40]),
        (Kind::Sector, 63_160, 0.0, 3, 11, [24, 16]),
        (Kind::Sector, 63_160, 0.002, 3, 11, [24, 16]),
        (Kind::Border, 20_000, 0.05, 3, 11, [24, 10]),
    ] {
        let scanned = Scanned::new(kind, count, noise, 1);
        println!("{kind:?} {noise} {ribs} spacing {}", scanned.spacing);
        for (cloud, spans) in [
            (CloudUse::Compared, Some(spans)),
            (CloudUse::Fitted, Some(spans)),
            (CloudUse::Compared, None),
            (CloudUse::Fitted, None),
        ] {
            let start = std::time::Instant::now();
            let found = scanned.secondary(&settings(along, ribs, cloud, spans));
            let seconds = start.elapsed().as_secs_f64();
            let m = &found.measures;
            println!(
                "  {cloud:?} net {:?} lines {:?} skipped {} points {} agree {:?} noise {:.4} mean {:.4} most {:.4} greatest {:.4} truth {:.4?} {seconds:.2} s",
                m.net, m.lines, m.skipped, m.line_points, m.agreement, m.noise, m.deviation.mean, m.deviation.most, m.deviation.greatest,
                scanned.from_formula(&found.surface)
            );
        }
    }
}
