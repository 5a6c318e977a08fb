//! Meshes with names and colours: what formats for viewing take beside triangles.
//!
//! Names, colours and unit come from the caller; nothing here knows where they stand in a file.

use super::Mesh;
use crate::brep::FaceId;
use std::collections::BTreeMap;

/// A colour, each part within [0, 1], in the sRGB encoding of screens.
pub type Rgb = [f64; 3];

/// Colour of what has none.
pub const GREY: Rgb = [0.7, 0.7, 0.7];

/// Parts of one file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// Metres for one unit of the coordinates.
    pub metres: f64,
    /// Bodies, in file order.
    pub parts: Vec<Part>,
}

/// A body as triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Part {
    /// Name, any text; may be empty.
    pub name: String,
    /// Its triangles.
    pub mesh: Mesh,
    /// Colour of faces without one of their own.
    pub colour: Option<Rgb>,
    /// Own colours of faces.
    pub faces: BTreeMap<FaceId, Rgb>,
}

impl Part {
    /// Colour of each triangle: an index into the colours, which come in the order of first use.
    pub(super) fn palette(&self) -> (Vec<Rgb>, Vec<usize>) {
        let base = self.colour.unwrap_or(GREY);
        let mut colours: Vec<Rgb> = Vec::new();
        let mut known: BTreeMap<[u64; 3], usize> = BTreeMap::new();
        let mut of = Vec::with_capacity(self.mesh.triangles.len());
        for at in 0..self.mesh.triangles.len() {
            let own = self.mesh.faces.get(at).and_then(|face| self.faces.get(face));
            let colour = own.copied().unwrap_or(base).map(|c| if c >= 0.0 { c.min(1.0) } else { 0.0 });
            of.push(*known.entry(colour.map(f64::to_bits)).or_insert_with(|| {
                colours.push(colour);
                colours.len() - 1
            }));
        }
        (colours, of)
    }
}

/// A colour as two hexadecimal digits for each part.
pub(super) fn hex(colour: Rgb) -> String {
    let byte = |part: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and 255")]
        let byte = (part.clamp(0.0, 1.0) * 255.0).round() as u8;
        byte
    };
    let [r, g, b] = colour.map(byte);
    format!("#{r:02X}{g:02X}{b:02X}")
}
