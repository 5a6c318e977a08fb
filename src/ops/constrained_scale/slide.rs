//! The slide reference: the plainly scaled surface, re-parametrised so that it slips under the held features.
//!
//! The published energy compares new and scaled surface at equal parameters. A held feature slips relative to the
//! parameter lines, and on a curved surface that slip was mistaken for a displacement: it pushed features off the
//! surface.

use super::sampling::{Tangents, closest};
use super::solve::{FaceSystem, Held};
use crate::geometry::nurbs::{GrevilleCollocation, LocalBasis, NurbsSurface, interpolate_grid};
use crate::math::Point3;
use crate::math::banded::SingularBand;

/// The reference net: homogeneous x, y, z for the weights of the surface, in net order.
///
/// `original` and `plain` share knots and weights; `system` holds the bending energy and its factor.
///
/// # Errors
/// [`SingularBand`] when knots do not allow interpolation at the Greville abscissae.
pub fn slide_reference(
    original: &NurbsSurface,
    plain: &NurbsSurface,
    held: &[Held<'_>],
    system: &FaceSystem,
) -> Result<Vec<[f64; 3]>, SingularBand> {
    let u = GrevilleCollocation::new(original.knots_u())?;
    let v = GrevilleCollocation::new(original.knots_v())?;
    let slip = slip(original, plain, held, system, [u.abscissae(), v.abscissae()]);
    let domain = [original.knots_u().domain(), original.knots_v().domain()];
    let columns = original.shape().1;
    let across: Vec<LocalBasis> =
        v.abscissae().iter().map(|&g| original.knots_v().basis_derivatives(g, 0)).collect();
    let mut values = Vec::with_capacity(original.net().len() * 3);
    for &gu in u.abscissae() {
        let along = original.knots_u().basis_derivatives(gu, 0);
        for (&gv, across) in v.abscissae().iter().zip(&across) {
            let (mut weight, mut moved) = (0.0, [0.0; 2]);
            for (k, nu) in along.values().iter().enumerate() {
                for (l, nv) in across.values().iter().enumerate() {
                    let index = (along.first() + k) * columns + across.first() + l;
                    weight += nu * nv * original.net()[index][3];
                    moved[0] += nu * nv * slip[0][index];
                    moved[1] += nu * nv * slip[1][index];
                }
            }
            let at = [gu + moved[0], gv + moved[1]];
            let at = [0, 1].map(|k| at[k].clamp(domain[k].0, domain[k].1));
            let point = plain.point(at[0], at[1]);
            values.extend(point.iter().map(|c| c * weight));
        }
    }
    interpolate_grid(&u, &v, &mut values, 3);
    Ok(values.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
}

/// The slip field's control values in `u` and in `v`: known on the held points, zero on the fixed ones, of least
/// bending in between.
fn slip(
    original: &NurbsSurface,
    plain: &NurbsSurface,
    held: &[Held<'_>],
    system: &FaceSystem,
    abscissae: [&[f64]; 2],
) -> [Vec<f64>; 2] {
    let columns = original.shape().1;
    let mut slip = [vec![0.0; original.net().len()], vec![0.0; original.net().len()]];
    for group in held {
        for &index in group.points {
            let start = [abscissae[0][index / columns], abscissae[1][index % columns]];
            let point: Point3<f64> = Tangents::of(original, start[0], start[1]).point;
            let target = group.motion.apply(&point);
            let found = closest(plain, &target, start);
            slip[0][index] = found[0] - start[0];
            slip[1][index] = found[1] - start[1];
        }
    }
    for component in &mut slip {
        system.relax(component);
    }
    slip
}
