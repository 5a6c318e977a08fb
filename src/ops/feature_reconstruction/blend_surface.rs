//! The blend as a surface: circular arcs between the contacts as rational quadratics, lofted by a cubic along the line.

use super::Closure;
use super::ball::Section;
use crate::geometry::nurbs::{KnotVector, NurbsCurve2, NurbsSurface, open_cubic, periodic_cubic};
use crate::math::Vector3;

/// Cosine of the arc below which two quadratics would be needed.
const WIDEST: f64 = -0.99;

/// A blend and the curves along which it touches.
#[derive(Debug, Clone, PartialEq)]
pub struct Blend {
    /// Degree 2 across, from the primary at 0 to the secondary at 1; degree 3 along the line, over [0, 1]. The borders
    /// across are polynomial: their weights are 1.
    pub surface: NurbsSurface,
    /// Contacts in the parameters of primary and secondary, over the parameter along the line.
    pub contacts: [NurbsCurve2; 2],
}

/// An arc of half a turn or nearly: its number among the sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooWide(pub usize);

/// The middle control point of the quadratic arc of a section, times its weight, and the weight.
///
/// # Errors
/// [`TooWide`] without a number, for arcs near half a turn.
pub fn middle(section: &Section) -> Option<[f64; 4]> {
    let arms: [Vector3<f64>; 2] = section.contacts.map(|c| c.point - section.centre);
    let cosine = arms[0].dot(&arms[1]) / (arms[0].norm() * arms[1].norm());
    if cosine.is_nan() || cosine <= WIDEST {
        return None;
    }
    let weight = (0.5 * (1.0 + cosine)).sqrt();
    let p = (section.centre + (arms[0] + arms[1]) / (1.0 + cosine)) * weight;
    Some([p.x, p.y, p.z, weight])
}

/// Lofts sections at even steps along the line, at least four.
///
/// # Errors
/// [`TooWide`].
pub fn lofted(sections: &[Section], closure: Closure) -> Result<Blend, TooWide> {
    let mut rows = Vec::with_capacity(12 * sections.len());
    let mut feet = Vec::with_capacity(4 * sections.len());
    for (k, section) in sections.iter().enumerate() {
        let [a, b] = section.contacts.map(|c| [c.point.x, c.point.y, c.point.z, 1.0]);
        rows.extend([a, middle(section).ok_or(TooWide(k))?, b].into_iter().flatten());
        feet.extend(section.contacts.iter().flat_map(|c| c.at));
    }
    let through = match closure {
        Closure::Closed => periodic_cubic,
        Closure::Open => open_cubic,
    };
    let (along, net) = through(&rows, 12);
    let (_, feet) = through(&feet, 4);
    let across = KnotVector::clamped_uniform(2, 1, 0.0, 1.0).expect("one span");
    let n = net.len() / 12;
    let mut points = Vec::with_capacity(3 * n);
    for side in 0..3 {
        points.extend((0..n).map(|j| {
            let at = 12 * j + 4 * side;
            let mut p = [net[at], net[at + 1], net[at + 2], net[at + 3]];
            if side != 1 {
                // The loft of ones is one but for rounding.
                p[3] = 1.0;
            }
            p
        }));
    }
    let contact = |k: usize| {
        let points = feet.chunks_exact(4).map(|f| [f[2 * k], f[2 * k + 1], 1.0]).collect();
        NurbsCurve2::new(along.clone(), points).expect("as many points as the knots ask for")
    };
    let contacts = [contact(0), contact(1)];
    let surface = NurbsSurface::new(across, along, points).map_err(|_| TooWide(0))?;
    Ok(Blend { surface, contacts })
}
