//! A ball that rests against two surfaces with its centre in a given plane: one section of a rolling-ball blend.
//!
//! Newton's method on the parameters of the two contacts, with the exact derivatives of the normals.

use crate::geometry::nurbs::{NurbsSurface, SurfaceDerivatives};
use crate::math::{Matrix4, Point3, Vector3, Vector4};

/// The plane that a section lies in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// A point of the limiting line.
    pub point: Point3<f64>,
    /// Unit normal of the plane: along the line.
    pub tangent: Vector3<f64>,
}

/// Where the ball touches a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Parameters.
    pub at: [f64; 2],
    /// The point.
    pub point: Point3<f64>,
    /// Unit normal of the surface.
    pub normal: Vector3<f64>,
}

/// A ball at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Its centre.
    pub centre: Point3<f64>,
    /// Contacts with the primary and the secondary surface.
    pub contacts: [Contact; 2],
}

/// Why a ball does not rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unrest {
    /// The search ended nowhere.
    NotFound,
    /// It would touch a surface outside its domain: 0 the primary, 1 the secondary.
    Outside(usize),
    /// A surface bends more than the ball where they touch.
    TooCurved(usize),
}

/// Steps of Newton's method; a good start takes 5.
const STEPS: usize = 60;
/// Part of the domain that one step may cross.
const STRIDE: f64 = 0.1;
/// Part of the domain below which a step ends the search.
const STEP_END: f64 = 1e-14;
/// Distance of the two centres, in radii, that is rounding.
const MEETS: f64 = 1e-9;

/// The centre of a ball on a surface, and its derivatives.
struct Offset {
    point: Point3<f64>,
    normal: Vector3<f64>,
    centre: Point3<f64>,
    du: Vector3<f64>,
    dv: Vector3<f64>,
}

impl Offset {
    /// `None` where the surface is singular. `distance` counts along the normal.
    fn of(d: &SurfaceDerivatives, distance: f64) -> Option<Self> {
        let cross = d.cross();
        let length = cross.norm();
        let normal = cross.try_normalize(0.0)?;
        let across = |change: Vector3<f64>| (change - normal * normal.dot(&change)) / length;
        let by_u = across(d.duu.cross(&d.dv) + d.du.cross(&d.duv));
        let by_v = across(d.duv.cross(&d.dv) + d.du.cross(&d.dvv));
        Some(Self {
            point: d.point,
            normal,
            centre: d.point + normal * distance,
            du: d.du + by_u * distance,
            dv: d.dv + by_v * distance,
        })
    }
}

/// Rolls a ball to a station. `distance` is the radius, positive where the ball lies on the side of the normals; `start`
/// the parameters that the search begins with.
///
/// # Errors
/// [`Unrest`].
pub fn rest(
    surfaces: [&NurbsSurface; 2],
    distance: f64,
    station: &Station,
    start: [[f64; 2]; 2],
) -> Result<Section, Unrest> {
    let domains = surfaces.map(NurbsSurface::domain);
    let mut at = start;
    for _ in 0..STEPS {
        let offsets = offsets(surfaces, distance, at)?;
        let step = step(&offsets, station).ok_or(Unrest::NotFound)?;
        let mut greatest = 0.0_f64;
        for k in 0..4 {
            let (u, v) = domains[k / 2];
            let (low, high) = [u, v][k % 2];
            let stride = STRIDE * (high - low);
            let x = &mut at[k / 2][k % 2];
            let moved = (*x + step[k].clamp(-stride, stride)).clamp(low, high);
            greatest = greatest.max((moved - *x).abs() / (high - low));
            *x = moved;
        }
        if greatest < STEP_END {
            break;
        }
    }
    settled(surfaces, distance, station, at)
}

fn offsets(surfaces: [&NurbsSurface; 2], distance: f64, at: [[f64; 2]; 2]) -> Result<[Offset; 2], Unrest> {
    let of =
        |k: usize| Offset::of(&surfaces[k].derivatives(at[k][0], at[k][1]), distance).ok_or(Unrest::NotFound);
    Ok([of(0)?, of(1)?])
}

/// Newton's step for: the centres are one, and in the plane.
fn step([a, b]: &[Offset; 2], station: &Station) -> Option<Vector4<f64>> {
    let apart = a.centre - b.centre;
    let off = (a.centre - station.point).dot(&station.tangent);
    let columns = [(a.du, a.du), (a.dv, a.dv), (-b.du, Vector3::zeros()), (-b.dv, Vector3::zeros())]
        .map(|(apart, along)| apart.push(along.dot(&station.tangent)));
    let step = Matrix4::from_columns(&columns).lu().solve(&-apart.push(off))?;
    step.iter().all(|x| x.is_finite()).then_some(step)
}

/// The section at the end of a search, when it is one.
fn settled(
    surfaces: [&NurbsSurface; 2],
    distance: f64,
    station: &Station,
    at: [[f64; 2]; 2],
) -> Result<Section, Unrest> {
    let offsets = offsets(surfaces, distance, at)?;
    let centre = offsets[0].centre;
    let off = (centre - offsets[1].centre).norm().max((centre - station.point).dot(&station.tangent).abs());
    if off > MEETS * distance.abs() {
        return Err(held(surfaces, at).map_or(Unrest::NotFound, Unrest::Outside));
    }
    for (k, surface) in surfaces.into_iter().enumerate() {
        let bends = surface.derivatives(at[k][0], at[k][1]).curvatures();
        let bends = bends.map(|(gaussian, mean)| {
            let spread = (mean * mean - gaussian).max(0.0).sqrt();
            [mean - spread, mean + spread]
        });
        // The offset surface turns inside out where 1 - d k changes its sign.
        if bends.is_none_or(|bends| bends.iter().any(|k| 1.0 - distance * k <= 0.0)) {
            return Err(Unrest::TooCurved(k));
        }
    }
    let contact = |k: usize| Contact { at: at[k], point: offsets[k].point, normal: offsets[k].normal };
    Ok(Section { centre, contacts: [contact(0), contact(1)] })
}

/// The surface whose parameters lie at the end of its domain.
fn held(surfaces: [&NurbsSurface; 2], at: [[f64; 2]; 2]) -> Option<usize> {
    (0..2).find(|&k| {
        let (u, v) = surfaces[k].domain();
        let on = |x: f64, (low, high): (f64, f64)| x <= low || x >= high;
        on(at[k][0], u) || on(at[k][1], v)
    })
}
