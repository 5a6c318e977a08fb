//! The limiting line against the lines that the parts' formulas have.

use crate::parts::{points, primary};
use crate::scan::{Kind, Part, cloud};
use resurf::geometry::nurbs::{NurbsSurface, Wrap};
use resurf::math::Point3;
use resurf::ops::feature_reconstruction::guide::guides;
use resurf::ops::feature_reconstruction::limiting_line::{
    LimitingLine, LineSettings, Objective, limiting_line,
};
use resurf::ops::feature_reconstruction::metric::{Metric, ParameterLine};
use resurf::ops::feature_reconstruction::{Closure, Foot, Projector};

/// Mean and greatest distance of a line's points from a polyline.
pub fn errors(points: &[Point3<f64>], truth: &[[f64; 3]], closed: bool) -> (f64, f64) {
    let n = truth.len();
    let segments: Vec<(Point3<f64>, Point3<f64>)> = (0..if closed { n } else { n - 1 })
        .map(|k| (Point3::from(truth[k]), Point3::from(truth[(k + 1) % n])))
        .collect();
    let distance = |p: &Point3<f64>| {
        let to = |(a, b): &(Point3<f64>, Point3<f64>)| {
            let along = b - a;
            let t = ((p - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (a + along * t - p).norm()
        };
        segments.iter().map(to).fold(f64::INFINITY, f64::min)
    };
    let all: Vec<f64> = points.iter().map(distance).collect();
    (all.iter().sum::<f64>() / all.len() as f64, all.iter().copied().fold(0.0, f64::max))
}

/// Points of a line at even parameters.
pub fn sampled(line: &LimitingLine, surface: &NurbsSurface, count: usize) -> Vec<Point3<f64>> {
    let last = if line.closure == Closure::Closed { count } else { count - 1 };
    let at = |k: usize| line.curve.point_at(k as f64 / last as f64);
    (0..count).map(at).map(|p| surface.point(p.x, p.y)).collect()
}

/// A part's primary and the lines that were found on it.
pub struct Found {
    /// The primary, longer than the part where the feature runs out over its border.
    pub surface: NurbsSurface,
    /// The lines.
    pub lines: Vec<LimitingLine>,
}

impl Found {
    /// Finds the lines in a cloud with labels.
    pub fn of(part: &Part, cloud: &cloud::Cloud) -> Self {
        let [objective, blend] = [cloud::OBJECTIVE, cloud::BLEND].map(|label| points(&cloud.labelled(label)));
        let surface = primary(part);
        let surface =
            if part.closed { surface } else { surface.extended((13.0, 13.0), (30.0, 30.0)).unwrap() };
        let projector = Projector::new(&surface, Wrap::default());
        let (feet, band) = (projector.feet(&objective), projector.feet(&blend));
        let metric = Metric::around(&surface, &feet);
        let guides = guides(&metric, &feet, &band, cloud.spacing).unwrap();
        let objective = Objective::new(&feet, cloud.spacing);
        let share = guides.len();
        let line = |guide: &ParameterLine| {
            let settings = LineSettings { band: width(&surface, guide, &band, share), wavelength: None };
            limiting_line(&surface, &metric, &objective, guide, &settings).unwrap()
        };
        let lines = guides.iter().map(line).collect();
        Self { surface, lines }
    }
}

/// Twice the distance within which nine tenths of a guide's share of the feet lie.
fn width(surface: &NurbsSurface, guide: &ParameterLine, band: &[Foot], share: usize) -> f64 {
    let (dense, _) = guide.resampled(surface, 400);
    let dense: Vec<[f64; 3]> = dense.points.iter().map(|[u, v]| surface.point(*u, *v).into()).collect();
    let away = |foot: &Foot| errors(&[foot.point], &dense, guide.closure == Closure::Closed).0;
    let mut off: Vec<f64> = band.iter().map(away).collect();
    off.sort_by(f64::total_cmp);
    2.0 * off[off.len() * 9 / 10 / share]
}

/// The points over the part's own extent.
pub fn within(part: &Part, all: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    let [x0, x1, y0, y1] = part.extent;
    let inside = |p: &Point3<f64>| (x0..=x1).contains(&p.x) && (y0..=y1).contains(&p.y);
    all.into_iter().filter(inside).collect()
}

/// Mean and greatest distance from that one of several true lines that is the nearest.
pub fn errors_from(points: &[Point3<f64>], truth: &[&Vec<[f64; 3]>], closed: bool) -> (f64, f64) {
    let all = truth.iter().map(|line| errors(points, line, closed));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// The seed had 0.117 in the mean and 0.216 at most for the groove without noise, 0.191 and 1.165 with a noise of 0.05; the
/// specification asks for more.
#[test]
fn limiting_lines_follow_those_of_the_formulas() {
    let cases = [
        (Kind::Pad, 40_000, 0.0, 1, [0.01, 0.02]),
        (Kind::Pad, 40_000, 0.05, 1, [0.08, 0.25]),
        (Kind::Pad, 40_000, 0.05, 2, [0.08, 0.25]),
        (Kind::Groove, 34_989, 0.0, 1, [0.05, 0.2]),
        (Kind::Groove, 34_989, 0.05, 1, [0.12, 0.5]),
        (Kind::Groove, 34_989, 0.05, 2, [0.12, 0.5]),
        (Kind::Sector, 63_160, 0.0, 1, [0.0002, 0.001]),
        (Kind::Sector, 63_160, 0.002, 1, [0.0025, 0.008]),
        (Kind::Sector, 1579, 0.002, 1, [0.0043, 0.018]),
        (Kind::Border, 20_000, 0.0, 1, [0.01, 0.03]),
        (Kind::Border, 20_000, 0.05, 1, [0.08, 0.4]),
    ];
    for (kind, count, noise, seed, most) in cases {
        let part = Part::new(kind);
        let found = Found::of(&part, &part.cloud(count, noise, seed));
        assert_eq!(found.lines.len(), part.truth.len(), "{kind:?}");
        let truth: Vec<_> = part.truth.iter().map(|contacts| &contacts.limiting).collect();
        for line in &found.lines {
            let points = within(&part, sampled(line, &found.surface, 500));
            let (mean, greatest) = errors_from(&points, &truth, part.closed);
            assert!(mean <= most[0] && greatest <= most[1], "{kind:?} {noise} {seed}: {mean} {greatest}");
            assert!(points.len() > 450 && line.slices.1 == 0, "{kind:?} {noise} {seed}: {:?}", line.slices);
        }
    }
}
