//! Free curves of two models: those that belong to no edge.

use std::collections::BTreeMap;

use super::placed::{Side, kind};
use super::{Change, FaceChange, Named, Sampled, exact};
use crate::brep::{CurveId, EdgeRange, EdgeSampling, sample_curve};
use crate::geometry::Curve;
use crate::math::{Affine, Point3};
use crate::mesh::to_segment;

/// A free curve of one side: its place among them, and itself.
struct Free<'a> {
    side: &'a Side<'a>,
    curve: CurveId,
    name: &'a str,
    transform: Affine,
}

/// Free curves that differ; those that are equal within the tolerance are passed over.
pub(super) fn differences(before: &Side<'_>, after: &Side<'_>, tolerance: f64) -> Vec<FaceChange> {
    let (mut a, mut b) = (listed(before), listed(after));
    take_identical(&mut a, &mut b);
    let mut changes = Vec::new();
    a.retain(|curve| {
        let partner =
            b.iter().position(|other| distance(curve, other).is_some_and(|d| d.distance <= tolerance));
        partner.map(|at| b.remove(at)).is_none()
    });
    for curve in a {
        let partner = b.iter().position(|other| curve.origin() == other.origin());
        let named = || b.iter().position(|other| !curve.name.is_empty() && curve.name == other.name);
        changes.push(match partner.or_else(named) {
            Some(at) => {
                let other = b.remove(at);
                let sampled = distance(&curve, &other);
                change(Change::Changed, Some(curve.named()), Some(other.named()), sampled)
            }
            None => change(Change::Removed, Some(curve.named()), None, None),
        });
    }
    changes.extend(b.iter().map(|curve| change(Change::Added, None, Some(curve.named()), None)));
    changes
}

fn change(
    change: Change,
    before: Option<Named>,
    after: Option<Named>,
    sampled: Option<Sampled>,
) -> FaceChange {
    FaceChange { change, before, after, sampled, certified: None, motion: None }
}

fn listed<'a>(side: &'a Side<'a>) -> Vec<Free<'a>> {
    let model = side.model;
    // A free curve has the unit of the first context: the file ties it to no body.
    let scale = model.contexts.first().map_or(1.0, |context| context.length.metres / side.unit.metres);
    let names = model.free_curve_names.iter().map(String::as_str).chain(std::iter::repeat(""));
    let curves = model.free_curves.iter().zip(names);
    curves.map(|(&curve, name)| Free { side, curve, name, transform: Affine::scale(scale) }).collect()
}

fn take_identical(a: &mut Vec<Free<'_>>, b: &mut Vec<Free<'_>>) {
    let mut known: BTreeMap<u128, usize> = BTreeMap::new();
    for curve in b.iter() {
        *known.entry(curve.hash()).or_insert(0) += 1;
    }
    let mut both: BTreeMap<u128, usize> = BTreeMap::new();
    a.retain(|curve| match known.get_mut(&curve.hash()) {
        Some(count) if *count > 0 => {
            *count -= 1;
            *both.entry(curve.hash()).or_insert(0) += 1;
            false
        }
        _ => true,
    });
    b.retain(|curve| match both.get_mut(&curve.hash()) {
        Some(count) if *count > 0 => {
            *count -= 1;
            false
        }
        _ => true,
    });
}

impl Free<'_> {
    fn hash(&self) -> u128 {
        exact::of_curve(self.side.model, self.curve, &self.transform)
    }

    fn origin(&self) -> crate::model::Origin {
        self.side.model.origins.curves[self.curve]
    }

    fn named(&self) -> Named {
        Named {
            id: self.origin().to_string(),
            name: self.name.to_owned(),
            kind: kind(&self.side.model.brep.curves[self.curve], Curve::kind),
            product: String::new(),
        }
    }

    /// Points along it; empty where it was not read or has no end.
    fn points(&self) -> Vec<Point3<f64>> {
        let Some(curve) = self.side.model.brep.curves[self.curve].read() else { return Vec::new() };
        let (start, end) = curve.domain();
        if !(start.is_finite() && end.is_finite()) {
            return Vec::new();
        }
        let sampling = EdgeSampling { chord: f64::INFINITY, per_span: 16 };
        let points = sample_curve(curve, EdgeRange { start, end }, &sampling);
        points.into_iter().map(|at| self.transform.point(&at.point)).collect()
    }
}

/// Greatest distance of the points of either curve from the chords of the other.
fn distance(a: &Free<'_>, b: &Free<'_>) -> Option<Sampled> {
    let (from, to) = (a.points(), b.points());
    if from.len() < 2 || to.len() < 2 {
        return None;
    }
    let away = |point: &Point3<f64>, other: &[Point3<f64>]| {
        other.windows(2).map(|pair| to_segment(point, &pair[0], &pair[1])).fold(f64::INFINITY, f64::min)
    };
    let both = to.iter().map(|p| (p, away(p, &from))).chain(from.iter().map(|p| (p, away(p, &to))));
    let worst = both.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Sampled { distance: worst.1, at: worst.0.coords.into(), points: from.len() + to.len() })
}
