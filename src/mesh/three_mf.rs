//! 3MF: the core specification 1.3 of the 3MF consortium, written as a zip archive of stored entries.
//!
//! Objects carry names, triangles the colours of their faces as base materials. The bytes are the same for the
//! same scene: entries bear the least date that zip can say.

use super::scene::{Scene, hex};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Units that the format names, with their metres.
const UNITS: [(&str, f64); 6] = [
    ("millimeter", 1e-3),
    ("meter", 1.0),
    ("inch", 0.0254),
    ("centimeter", 1e-2),
    ("foot", 0.3048),
    ("micron", 1e-6),
];

/// Relative difference of lengths below which two units are one.
const SAME_UNIT: f64 = 1e-9;

const CONTENT_TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\
</Types>\n";

const RELATIONSHIPS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\
</Relationships>\n";

/// Writes a scene. A unit that the format does not name is converted to millimetres.
///
/// # Errors
/// Those of `out`; `InvalidInput` when the archive would pass 4 GiB.
pub fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let model = model(scene);
    archive(
        &[
            ("[Content_Types].xml", CONTENT_TYPES.as_bytes()),
            ("_rels/.rels", RELATIONSHIPS.as_bytes()),
            ("3D/3dmodel.model", model.as_bytes()),
        ],
        out,
    )
}

fn model(scene: &Scene) -> String {
    let named = UNITS.iter().find(|(_, metres)| (scene.metres / metres - 1.0).abs() <= SAME_UNIT);
    let (unit, factor) = named.map_or(("millimeter", scene.metres / 1e-3), |(name, _)| (*name, 1.0));
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{unit}\" xml:lang=\"en-US\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n"
    );
    let mut items = String::new();
    for (at, part) in scene.parts.iter().enumerate() {
        let (materials, object) = (2 * at + 1, 2 * at + 2);
        let (colours, of) = part.palette();
        let name = escaped(&part.name);
        // A string takes all that is written to it.
        let _ = writeln!(text, "<basematerials id=\"{materials}\">");
        for colour in &colours {
            let hex = hex(*colour);
            let _ = writeln!(text, "<base name=\"{hex}\" displaycolor=\"{hex}\"/>");
        }
        if colours.is_empty() {
            text.push_str("<base name=\"none\" displaycolor=\"#B3B3B3\"/>\n");
        }
        let _ = writeln!(
            text,
            "</basematerials>\n<object id=\"{object}\" type=\"model\" name=\"{name}\" pid=\"{materials}\" \
             pindex=\"0\">\n<mesh>\n<vertices>"
        );
        for p in &part.mesh.vertices {
            let [x, y, z] = [p.x, p.y, p.z].map(|c| c * factor);
            let _ = writeln!(text, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
        }
        text.push_str("</vertices>\n<triangles>\n");
        for ([a, b, c], colour) in part.mesh.triangles.iter().zip(&of) {
            let _ = match colour {
                0 => writeln!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>"),
                p => writeln!(
                    text,
                    "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" pid=\"{materials}\" p1=\"{p}\"/>"
                ),
            };
        }
        text.push_str("</triangles>\n</mesh>\n</object>\n");
        let _ = writeln!(items, "<item objectid=\"{object}\"/>");
    }
    text.push_str("</resources>\n<build>\n");
    text.push_str(&items);
    text.push_str("</build>\n</model>\n");
    text
}

/// Text as the value of an attribute; characters that XML 1.0 cannot say become blanks.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{FFFE}' | '\u{FFFF}' => out.push(' '),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// 1980-01-01, the first day that zip can say.
const FIRST_DAY: u16 = 0x21;

/// A zip archive of entries as they are (PKWARE APPNOTE 4.3, method 0).
fn archive(entries: &[(&str, &[u8])], out: &mut impl Write) -> io::Result<()> {
    let large = |_| io::Error::new(io::ErrorKind::InvalidInput, "the archive would pass 4 GiB");
    let mut bytes: Vec<u8> = Vec::new();
    let mut directory: Vec<u8> = Vec::new();
    for (name, content) in entries {
        let offset = u32::try_from(bytes.len()).map_err(large)?;
        let size = u32::try_from(content.len()).map_err(large)?;
        let length = u16::try_from(name.len()).map_err(large)?;
        let mut common = Vec::new();
        // Version 2.0, no flags, stored, midnight.
        for word in [20, 0, 0, 0, FIRST_DAY] {
            common.extend_from_slice(&u16::to_le_bytes(word));
        }
        for word in [crc32(content), size, size] {
            common.extend_from_slice(&word.to_le_bytes());
        }
        common.extend_from_slice(&length.to_le_bytes());
        common.extend_from_slice(&[0, 0]);
        bytes.extend_from_slice(b"PK\x03\x04");
        bytes.extend_from_slice(&common);
        bytes.extend_from_slice(name.as_bytes());
        bytes.extend_from_slice(content);
        directory.extend_from_slice(b"PK\x01\x02\x14\x00");
        directory.extend_from_slice(&common);
        // No comment, first disk, no attributes.
        directory.extend_from_slice(&[0; 10]);
        directory.extend_from_slice(&offset.to_le_bytes());
        directory.extend_from_slice(name.as_bytes());
    }
    let offset = u32::try_from(bytes.len()).map_err(large)?;
    let size = u32::try_from(directory.len()).map_err(large)?;
    let count = u16::try_from(entries.len()).map_err(large)?;
    bytes.extend_from_slice(&directory);
    bytes.extend_from_slice(b"PK\x05\x06\0\0\0\0");
    for word in [count, count] {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    for word in [size, offset] {
        bytes.extend_from_slice(&word.to_le_bytes());
    }
    bytes.extend_from_slice(&[0, 0]);
    out.write_all(&bytes)
}

/// The checksum of zip: CRC-32 of ISO 3309, reflected.
fn crc32(bytes: &[u8]) -> u32 {
    let mut table = [0u32; 256];
    for (entry, byte) in table.iter_mut().zip(0u32..) {
        *entry = (0..8).fold(byte, |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 });
    }
    let step = |c: u32, byte: &u8| table[usize::from(c.to_le_bytes()[0] ^ byte)] ^ (c >> 8);
    !bytes.iter().fold(!0, step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::scene::Part;
    use crate::mesh::triangle_mesh::tests::cube;

    #[test]
    fn the_checksum_is_that_of_the_catalogue() {
        // The check value of CRC-32/ISO-HDLC.
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn names_are_escaped_and_odd_units_converted() {
        let part = Part { name: "<a & \"b\">\u{1}".to_owned(), mesh: cube([0.0; 3]), ..Part::default() };
        let text = model(&Scene { metres: 2e-3, parts: vec![part] });
        assert!(text.contains("name=\"&lt;a &amp; &quot;b&quot;&gt; \""));
        assert!(text.contains("unit=\"millimeter\"") && text.contains("<vertex x=\"2\" y=\"2\" z=\"2\"/>"));
        assert_eq!(text.matches("<triangle ").count(), 12);
        assert!(model(&Scene { metres: 0.0254, parts: vec![] }).contains("unit=\"inch\""));
    }
}
