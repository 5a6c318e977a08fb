//! The scanned parts of the samples as the library's own types.

use crate::scan::{Kind, Part};
use resurf::geometry::nurbs::{GrevilleCollocation, KnotVector, NurbsSurface, interpolate_grid};
use resurf::math::Point3;

/// Points of the library.
pub fn points(all: &[[f64; 3]]) -> Vec<Point3<f64>> {
    all.iter().map(|p| Point3::from(*p)).collect()
}

/// The primary surface of a part over its extent, with x and y as parameters: exact for the polynomials, within 1e-9 of
/// the sector of the membrane.
pub fn primary(part: &Part) -> NurbsSurface {
    let [x0, x1, y0, y1] = part.extent;
    let (degree, spans) = if part.kind == Kind::Sector { (5, [24, 6]) } else { (3, [1, 1]) };
    let knots = |n, low, high| KnotVector::clamped_uniform(degree, n, low, high).unwrap();
    let (ku, kv) = (knots(spans[0], x0, x1), knots(spans[1], y0, y1));
    let (u, v) = (GrevilleCollocation::new(&ku).unwrap(), GrevilleCollocation::new(&kv).unwrap());
    let places = u.abscissae().iter().flat_map(|&x| v.abscissae().iter().map(move |&y| (x, y)));
    let mut values: Vec<f64> = places.flat_map(|(x, y)| [x, y, part.primary(x, y), 1.0]).collect();
    interpolate_grid(&u, &v, &mut values, 4);
    NurbsSurface::new(ku, kv, values.as_chunks::<4>().0.to_vec()).unwrap()
}
