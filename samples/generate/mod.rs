//! Sample parts from formulas: car panels with elliptic holes, one of them once more as a thin solid, an
//! assembly of two; sheets with features, and a plate, a vase, a wheel and a shell to take them; wires with and without
//! detail; parts that were scanned, with the clouds.
//!
//! Nothing here uses the library: a sample that the library helped to write could not tell on it. Every
//! coordinate is rounded to [`records::DECIMALS`] decimals, so that the last bit of somebody's sine does
//! not change a file.

mod assembly;
mod crease;
mod feature;
mod panel;
mod plate;
mod records;
pub mod scan;
mod scanned;
mod sheet;
mod spline;
mod thin_solid;
mod vase;
mod wheel;
mod wires;

use panel::Panel;
use records::Schema;
use scan::Kind;
use thin_solid::SHEET;
use wires::Target;

/// One file of the samples.
pub struct Sample {
    /// Path below `samples/`.
    pub path: &'static str,
    /// The whole file.
    pub bytes: Vec<u8>,
}

/// All sample parts, in order of their paths.
pub fn all() -> Vec<Sample> {
    let sample = |path, text: String| Sample { path, bytes: text.into_bytes() };
    vec![
        sample("assembly/assembly.step", assembly::write(&Panel::door(), Schema::Ap214)),
        sample("crease/lines.step", crease::lines()),
        sample("curves/arch.step", wires::one_target(Target::Arch, "arch")),
        sample("curves/bow.step", wires::one_target(Target::Bow, "bow")),
        sample("curves/hook.step", wires::one_target(Target::Hook, "hook")),
        sample("curves/sources.step", wires::sources()),
        sample("door/door-ap242.step", sheet::write(&Panel::door(), Schema::Ap242)),
        sample("door/door.step", sheet::write(&Panel::door(), Schema::Ap214)),
        sample(
            "door-solid/door-solid.step",
            thin_solid::write("door-solid", &Panel::door(), SHEET, Schema::Ap242),
        ),
        sample("features/bump.step", sheet::write(&feature::bump(), Schema::Ap214)),
        sample("features/groove.step", sheet::write(&feature::groove(), Schema::Ap214)),
        sample("features/symbol.step", sheet::write(&feature::symbol(), Schema::Ap242)),
        sample("hood/hood-ap242.step", sheet::write(&Panel::hood(), Schema::Ap242)),
        sample("hood/hood.step", sheet::write(&Panel::hood(), Schema::Ap214)),
        sample("plate/plate.step", plate::write(Schema::Ap214)),
        sample("scan/border.step", scanned::plate("border", Kind::Border, Schema::Ap242)),
        sample("scan/diaphragm.step", scanned::diaphragm(Schema::Ap214)),
        sample("scan/groove.step", scanned::groove(Schema::Ap214)),
        sample("scan/pad.step", scanned::plate("pad", Kind::Pad, Schema::Ap242)),
        sample("trunk/trunk-ap242.step", sheet::write(&Panel::trunk(), Schema::Ap242)),
        sample("trunk/trunk.step", sheet::write(&Panel::trunk(), Schema::Ap214)),
        sample("vamp/vamp.step", thin_solid::write("vamp", &Panel::vamp(), SHEET, Schema::Ap242)),
        sample("vase/vase.step", vase::write(Schema::Ap214)),
        sample("wheel/cone.step", wheel::write("cone", wheel::Tread::Cone, Schema::Ap214)),
        sample("wheel/cylinder.step", wheel::write("cylinder", wheel::Tread::Cylinder, Schema::Ap242)),
        sample("wheel/wheel.step", wheel::write("wheel", wheel::Tread::Profile, Schema::Ap214)),
    ]
}
