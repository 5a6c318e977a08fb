//! The limiting line against the lines that the parts' formulas have.

use crate::parts::{points, primary};
use crate::scan::{Contacts, Kind, Part, cloud};
use resurf::geometry::nurbs::{NurbsSurface, Wrap};
use resurf::math::Point3;
use resurf::ops::feature_reconstruction::guide::guides;
use resurf::ops::feature_reconstruction::limiting_line::{
    LimitingLine, LineSettings, Objective, limiting_line,
};
use resurf::ops::feature_reconstruction::metric::Metric;
use resurf::ops::feature_reconstruction::{Closure, Projector};

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

pub fn reconstructed(part: &Part, cloud: &cloud::Cloud) -> (NurbsSurface, Vec<LimitingLine>) {
    let [objective, blend] = [cloud::OBJECTIVE, cloud::BLEND].map(|label| points(&cloud.labelled(label)));
    let surface = primary(part);
    let surface = if part.closed { surface } else { surface.extended((13.0, 13.0), (30.0, 30.0)).unwrap() };
    let projector = Projector::new(&surface, Wrap::default());
    let feet = projector.feet(&objective);
    let band = projector.feet(&blend);
    let metric = Metric::around(&surface, &feet);
    let start = std::time::Instant::now();
    let guides = guides(&metric, &feet, &band, cloud.spacing).unwrap();
    let objective = Objective::new(&feet, cloud.spacing);
    let lines = guides
        .iter()
        .map(|guide| {
            let (dense, _) = guide.resampled(&surface, 400);
            let dense: Vec<[f64; 3]> =
                dense.points.iter().map(|[u, v]| surface.point(*u, *v).into()).collect();
            let mut off: Vec<f64> = band
                .iter()
                .map(|foot| errors(&[foot.point], &dense, guide.closure == Closure::Closed).0)
                .collect();
            off.sort_by(f64::total_cmp);
            let width = 2.0 * off[off.len() * 9 / 10 / guides.len()];
            println!("  band {width:.3} spacing {:.3}", cloud.spacing);
            let settings = LineSettings { band: width, wavelength: None };
            limiting_line(&surface, &metric, &objective, guide, &settings).unwrap()
        })
        .collect();
    println!("  lines {:.2} s", start.elapsed().as_secs_f64());
    (surface, lines)
}

fn nearest<'a>(line: &[Point3<f64>], truth: &'a [Contacts]) -> &'a Contacts {
    let near = |c: &&Contacts| errors(&line[..3], &c.limiting, false).0;
    truth.iter().min_by(|a, b| near(a).total_cmp(&near(b))).unwrap()
}

#[test]
fn limiting_lines_follow_those_of_the_formulas() {
    let cases = [
        (Kind::Pad, 40_000, 0.0, 1),
        (Kind::Pad, 40_000, 0.05, 1),
        (Kind::Pad, 40_000, 0.05, 2),
        (Kind::Pad, 40_000, 0.05, 3),
        (Kind::Pad, 40_000, 0.05, 4),
        (Kind::Groove, 34_989, 0.0, 1),
        (Kind::Groove, 34_989, 0.05, 1),
        (Kind::Groove, 34_989, 0.05, 2),
        (Kind::Sector, 63_160, 0.0, 1),
        (Kind::Sector, 63_160, 0.002, 1),
        (Kind::Sector, 1579, 0.002, 1),
        (Kind::Border, 20_000, 0.0, 1),
        (Kind::Border, 20_000, 0.05, 1),
    ];
    for (kind, count, noise, seed) in cases {
        let part = Part::new(kind);
        let cloud = part.cloud(count, noise, seed);
        println!("{kind:?} {noise} {seed}");
        let (surface, lines) = reconstructed(&part, &cloud);
        for line in &lines {
            let inside = |p: &Point3<f64>| {
                let [x0, x1, y0, y1] = part.extent;
                (x0..=x1).contains(&p.x) && (y0..=y1).contains(&p.y)
            };
            let points: Vec<_> = sampled(line, &surface, 500).into_iter().filter(inside).collect();
            let truth = nearest(&points, &part.truth);
            let (mean, greatest) = errors(&points, &truth.limiting, part.closed);
            println!(
                "  mean {mean:.4} greatest {greatest:.4}; deviation {:.4} slices {:?} gap {:.3} knots {}",
                line.deviation,
                line.slices,
                line.gap,
                line.curve.points().len()
            );
        }
    }
}
