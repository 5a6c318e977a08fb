//! B-splines (IGES 5.3 sections 4.23 and 4.24), and the parametric splines (4.14 and 4.15), which are B-splines
//! written as polynomials.

use super::error::ReadError;
use super::scope::{MAX_PARTS, small};
use crate::geometry::nurbs::{KnotVector, NurbsCurve3, NurbsSurface};
use crate::iges::Fields;

/// A B-spline curve and the range of it that is meant.
pub(super) fn curve(fields: &Fields<'_>) -> Result<(NurbsCurve3, (f64, f64)), ReadError> {
    let degree = fields.count("degree")?;
    let knots = KnotVector::new(degree, fields.reals("knots")?)?;
    let net = weighted(&fields.reals("control_points")?, &fields.reals("weights")?);
    let curve = NurbsCurve3::new(knots, net)?;
    let range = held(curve.domain(), (fields.real("start")?, fields.real("end")?))?;
    Ok((curve, range))
}

/// The ranges of two parameters that are meant.
pub(in crate::iges) type Rectangle = ((f64, f64), (f64, f64));

/// A B-spline surface and the rectangle of it that is meant.
pub(super) fn surface(fields: &Fields<'_>) -> Result<(NurbsSurface, Rectangle), ReadError> {
    let [degree_u, degree_v] = [fields.count("degree_u")?, fields.count("degree_v")?];
    let knots_u = KnotVector::new(degree_u, fields.reals("knots_u")?)?;
    let knots_v = KnotVector::new(degree_v, fields.reals("knots_v")?)?;
    // The file runs along u first, the net along v.
    let (nu, nv) = (knots_u.n_basis(), knots_v.n_basis());
    let file = weighted(&fields.reals("control_points")?, &fields.reals("weights")?);
    let in_file = |(i, j): (usize, usize)| file.get(j * nu + i).copied().unwrap_or([f64::NAN; 4]);
    let net = (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))).map(in_file).collect();
    let surface = NurbsSurface::new(knots_u, knots_v, net)?;
    let (domain_u, domain_v) = surface.domain();
    let u = held(domain_u, (fields.real("start_u")?, fields.real("end_u")?))?;
    let v = held(domain_v, (fields.real("start_v")?, fields.real("end_v")?))?;
    Ok((surface, (u, v)))
}

/// Homogeneous points.
fn weighted(points: &[f64], weights: &[f64]) -> Vec<[f64; 4]> {
    let (points, _) = points.as_chunks::<3>();
    points.iter().zip(weights).map(|(&[x, y, z], &w)| [x * w, y * w, z * w, w]).collect()
}

/// A range within a domain. Left out, as some writers do, it is all of it; beyond an end by rounding, that end.
fn held((first, last): (f64, f64), (start, end): (f64, f64)) -> Result<(f64, f64), ReadError> {
    if start == 0.0 && end == 0.0 {
        return Ok((first, last));
    }
    let range = (start.clamp(first, last), end.clamp(first, last));
    if range.0 < range.1 { Ok(range) } else { Err(ReadError::EmptyRange { from: start, to: end }) }
}

/// Degree of the parametric splines.
const CUBIC: usize = 3;

/// A parametric spline curve as a B-spline: each polynomial a piece, the breakpoints as often as the degree.
pub(super) fn parametric_curve(fields: &Fields<'_>) -> Result<NurbsCurve3, ReadError> {
    let segments = small(fields, "segments", MAX_PARTS)?;
    let breaks = fields.reals("breaks")?;
    let coefficients = fields.reals("coefficients")?;
    if segments == 0 {
        return Err(ReadError::Empty("segments"));
    }
    let mut net = Vec::with_capacity(CUBIC * segments + 1);
    for (segment, ends) in coefficients.chunks_exact(12).zip(breaks.windows(2)) {
        let axis = |k: usize| bezier(&segment[4 * k..4 * k + 4], ends[1] - ends[0]);
        let (x, y, z) = (axis(0), axis(1), axis(2));
        // Where two pieces meet, the latter says where.
        net.truncate(net.len().saturating_sub(1));
        net.extend((0..4).map(|i| [x[i], y[i], z[i], 1.0]));
    }
    Ok(NurbsCurve3::new(piecewise(&breaks)?, net)?)
}

/// A parametric spline surface as a B-spline.
pub(super) fn parametric_surface(fields: &Fields<'_>) -> Result<NurbsSurface, ReadError> {
    let nu = small(fields, "segments_u", MAX_PARTS)?;
    let nv = small(fields, "segments_v", MAX_PARTS)?;
    let (u, v) = (fields.reals("breaks_u")?, fields.reals("breaks_v")?);
    // A row and a column of patches beyond the surface stand in the file, or not.
    let coefficients = reals_that_are_there(fields, "coefficients")?;
    let needed = 48 * ((nv + 1) * nu.saturating_sub(1) + nv);
    if nu == 0 || nv == 0 || coefficients.len() < needed {
        return Err(ReadError::Empty("coefficients"));
    }
    let columns = CUBIC * nv + 1;
    let mut net = vec![[0.0, 0.0, 0.0, 1.0]; (CUBIC * nu + 1) * columns];
    for i in 0..nu {
        for j in 0..nv {
            let patch = &coefficients[48 * (i * (nv + 1) + j)..][..48];
            for axis in 0..3 {
                let points =
                    bezier_patch(&patch[16 * axis..16 * axis + 16], u[i + 1] - u[i], v[j + 1] - v[j]);
                for (a, row) in points.iter().enumerate() {
                    for (b, value) in row.iter().enumerate() {
                        net[(CUBIC * i + a) * columns + CUBIC * j + b][axis] = *value;
                    }
                }
            }
        }
    }
    Ok(NurbsSurface::new(piecewise(&u)?, piecewise(&v)?, net)?)
}

fn reals_that_are_there(fields: &Fields<'_>, field: &'static str) -> Result<Vec<f64>, ReadError> {
    // Members that are no numbers become NaN, which the net's constructor refuses.
    Ok(fields.list(field).map(|parameter| parameter.as_f64().unwrap_or(f64::NAN)).collect())
}

/// Knots of cubic pieces over breakpoints.
fn piecewise(breaks: &[f64]) -> Result<KnotVector, ReadError> {
    let last = breaks.len() - 1;
    let multiplicities: Vec<usize> = (0..=last).map(|i| CUBIC + usize::from(i == 0 || i == last)).collect();
    Ok(KnotVector::from_multiplicities(CUBIC, breaks, &multiplicities)?)
}

/// Bezier ordinates over `[0, h]` of a polynomial by its coefficients, the constant first.
fn bezier(c: &[f64], h: f64) -> [f64; 4] {
    let (b, c2, d) = (c[1] * h, c[2] * h * h, c[3] * h * h * h);
    [c[0], c[0] + b / 3.0, c[0] + (2.0 * b + c2) / 3.0, c[0] + b + c2 + d]
}

/// Bezier ordinates of a patch by its coefficients, powers of the first parameter running first.
fn bezier_patch(c: &[f64], h: f64, k: f64) -> [[f64; 4]; 4] {
    let by_first: [[f64; 4]; 4] = std::array::from_fn(|power| bezier(&c[4 * power..4 * power + 4], h));
    let mut points = [[0.0; 4]; 4];
    for (a, row) in points.iter_mut().enumerate() {
        let column = by_first.map(|ordinates| ordinates[a]);
        *row = bezier(&column, k);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_become_bezier_pieces() {
        // 1 + 2 s - s^2 + 3 s^3 over [0, 2] at s = 0.5: 2.125.
        let p = bezier(&[1.0, 2.0, -1.0, 3.0], 2.0);
        let t: f64 = 0.25;
        let s = 1.0 - t;
        let value = s.powi(3) * p[0] + 3.0 * s * s * t * p[1] + 3.0 * s * t * t * p[2] + t.powi(3) * p[3];
        assert!((value - 2.125).abs() < 1e-14);
        // s^2 t over [0, 1] x [0, 3]: the far corner is 3, the middle 0.375.
        let mut c = [0.0; 16];
        c[6] = 1.0;
        let patch = bezier_patch(&c, 1.0, 3.0);
        assert!((patch[3][3] - 3.0).abs() < 1e-15);
        let b = |t: f64| [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
        let middle: f64 = (0..4)
            .flat_map(|i| (0..4).map(move |j| (i, j)))
            .map(|(i, j)| b(0.5)[i] * b(0.5)[j] * patch[i][j])
            .sum();
        assert!((middle - 0.375).abs() < 1e-15);
    }

    #[test]
    fn ranges_are_held_within_the_domain() {
        assert_eq!(held((0.0, 1.0), (0.0, 0.0)), Ok((0.0, 1.0)));
        assert_eq!(held((0.0, 1.0), (-1e-9, 0.5)), Ok((0.0, 0.5)));
        assert!(held((0.0, 1.0), (2.0, 3.0)).is_err());
    }
}
