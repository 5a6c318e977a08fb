//! Radius and blend against those of the parts' formulas.

use crate::lines::{errors, reconstructed, sampled};
use crate::parts::points;
use crate::scan::{Kind, Part, cloud};
use resurf::geometry::nurbs::{NurbsSurface, Wrap};
use resurf::math::Point3;
use resurf::ops::feature_reconstruction::limiting_line::LimitingLine;
use resurf::ops::feature_reconstruction::radius::{BlendCloud, Wanted, radius};
use resurf::ops::feature_reconstruction::rolling::{Edge, Roller, rolled};
use resurf::ops::feature_reconstruction::{Closure, Projector};
use resurf::ops::force_density::{Constraint, Criteria, Ghosts, Network, System};

pub fn secondary(surface: &NurbsSurface, lines: &[LimitingLine], objective: &[Point3<f64>], spans: [usize; 2]) -> NurbsSurface {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for line in lines {
        for k in 0..=400 {
            let p = line.curve.point_at(k as f64 / 400.0);
            for c in 0..2 {
                low[c] = low[c].min(p[c]);
                high[c] = high[c].max(p[c]);
            }
        }
    }
    let (u, v) = surface.domain();
    let range = |c: usize, d: (f64, f64)| {
        let more = 0.15 * (high[c] - low[c]);
        ((low[c] - more).max(d.0), (high[c] + more).min(d.1))
    };
    let piece = surface.piece(range(0, u), range(1, v)).unwrap().with_spans(spans[0], spans[1]).unwrap();
    let network = Network::unsupported(&piece, Network::even_densities(&piece), Ghosts::Floating);
    let mut system = System::new(&piece, &network, &Criteria { force_variation: 1.0, ..Criteria::NONE }).unwrap();
    let projector = Projector::new(surface, Wrap::default());
    system
        .add(projector.feet(objective).iter().zip(objective).map(|(f, p)| Constraint::through(f.at, p, 1.0)))
        .unwrap();
    for line in lines {
        system
            .add((0..400).map(|k| line.curve.point_at(k as f64 / 399.0)).map(|p| {
                Constraint::through([p.x, p.y], &surface.point(p.x, p.y), 0.2)
            }))
            .unwrap();
    }
    system.balanced(1e3).unwrap().surface
}

#[test]
fn radii_and_contacts_are_those_of_the_formulas() {
    let cases = [
        (Kind::Pad, 40_000, 0.0, 1, [24, 16], 5.0),
        (Kind::Pad, 40_000, 0.05, 1, [24, 16], 5.0),
        (Kind::Pad, 40_000, 0.05, 2, [24, 16], 5.0),
        (Kind::Pad, 40_000, 0.05, 3, [24, 16], 5.0),
        (Kind::Pad, 40_000, 0.05, 4, [24, 16], 5.0),
        (Kind::Groove, 34_989, 0.0, 1, [14, 40], 6.0),
        (Kind::Groove, 34_989, 0.05, 1, [14, 40], 6.0),
        (Kind::Groove, 34_989, 0.05, 2, [14, 40], 6.0),
        (Kind::Sector, 63_160, 0.0, 1, [24, 16], 0.06),
        (Kind::Sector, 63_160, 0.002, 1, [24, 16], 0.06),
        (Kind::Border, 20_000, 0.0, 1, [24, 10], 5.0),
        (Kind::Border, 20_000, 0.05, 1, [24, 10], 5.0),
    ];
    for (kind, count, noise, seed, spans, _) in cases {
        let part = Part::new(kind);
        let cloud = part.cloud(count, noise, seed);
        println!("BLEND {kind:?} {noise} {seed}");
        let (surface, lines) = reconstructed(&part, &cloud);
        let objective = points(&cloud.labelled(cloud::OBJECTIVE));
        let start = std::time::Instant::now();
        let second = secondary(&surface, &lines, &objective, spans);
        let projector = Projector::new(&second, Wrap::default());
        let feet = projector.feet(&objective);
        let off: Vec<f64> = feet.iter().map(|f| f.height.abs()).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        println!("  secondary mean {mean:.4} greatest {:.4} {:.2} s", off.iter().copied().fold(0.0, f64::max), start.elapsed().as_secs_f64());
        let blend = points(&cloud.labelled(cloud::BLEND));
        for line in &lines {
            let edge = Edge { surfaces: [&surface, &second], line: &line.curve, closure: line.closure, side: part.side };
            let near = sampled(line, &surface, 200);
            let mine: Vec<Point3<f64>> = if lines.len() == 1 { blend.clone() } else {
                blend.iter().filter(|p| near.iter().map(|q| (q - **p).norm()).fold(f64::INFINITY, f64::min) < 20.0).copied().collect()
            };
            let start = std::time::Instant::now();
            let roller = match Roller::new(edge, 160) { Ok(r) => r, Err(e) => { println!("  {e}"); continue } };
            let found = match radius(&BlendCloud::new(&mine, cloud.spacing, noise), &roller, Wanted::Tested) { Ok(r) => r, Err(e) => { println!("  {e}"); continue } };
            println!("  {found:?} {:.2} s", start.elapsed().as_secs_f64());
            let start = std::time::Instant::now();
            match rolled(edge, &found.law, 1e-4) {
                Ok(r) => {
                    println!("  rolled sections {} dev {:?} angle {:.5} deg {:.2} s", r.sections, r.deviation, r.angle.to_degrees(), start.elapsed().as_secs_f64());
                    for side in 0..2 {
                        let at = |k: usize| r.blend.contacts[side].point_at(k as f64 / 500.0);
                        let p: Vec<Point3<f64>> = (0..500).map(at).map(|p| if side == 0 { surface.point(p.x, p.y) } else { second.point(p.x, p.y) })
                            .filter(|p| { let [x0, x1, y0, y1] = part.extent; (x0..=x1).contains(&p.x) && (y0..=y1).contains(&p.y) }).collect();
                        let truth = part.truth.iter().map(|t| if side == 0 { &t.primary } else { &t.secondary });
                        let best = truth.map(|t| errors(&p, t, line.closure == Closure::Closed)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
                        println!("    contact {side} mean {:.4} greatest {:.4}", best.0, best.1);
                    }
                }
                Err(e) => println!("  {e}"),
            }
        }
    }
}
