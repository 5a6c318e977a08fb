//! The method before fix-and-stretch, which `docs/scaling-methods.md` puts beside the two others: its figures are those
//! of the specification (section 3.12 of its part on one face).

use resurf::ops::constrained_scale::fold::strongest_compression;
use resurf::ops::constrained_scale::measures::quality;
use resurf::ops::constrained_scale::{ScaledFace, Scaling, scale_face};
use resurf::ops::net::Mask;

use super::parts::door;

#[path = "../../samples/scale_methods/attach_and_deform.rs"]
mod attach_and_deform;
use attach_and_deform::attach_and_deform;

#[test]
fn attach_and_deform_is_fairer_and_not_exact() {
    let (surface, held) = door();
    let scaling = Scaling::new([2.0; 3]);
    let default = scale_face(&surface, &held, None, &scaling).unwrap();
    let default = &default.faces[0];
    let loops: Vec<_> = held.iter().map(|l| l.contour.points.clone()).collect();
    let attached = attach_and_deform(&surface, &default.plain, &scaling.affine().unwrap(), &loops);
    let (rows, columns) = attached.surface.shape();
    let face = ScaledFace {
        compression: strongest_compression(&attached.surface, &default.plain),
        surface: attached.surface,
        held: Mask::empty(rows, columns),
        ..default.clone()
    };
    let found = quality(&face, 101);
    assert!((found.deviation_max - 0.37).abs() <= 0.005, "{found:?}");
    assert!((found.mean_correlation.unwrap() - 0.989).abs() <= 0.001, "{found:?}");
    assert!(attached.deviation.iter().all(|off| (2e-6..=2.5e-5).contains(off)), "{:?}", attached.deviation);
    assert_eq!(attached.loops.len(), 3);
}
