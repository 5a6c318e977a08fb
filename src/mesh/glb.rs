//! GLB: glTF 2.0 (ISO/IEC 12113) in one binary file, with names, normals and a material for each colour.
//!
//! Lengths are metres and the vertical axis is `y` there: the root node scales and turns, so the coordinates
//! stay those of the part, in single precision.

use super::scene::{Rgb, Scene};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// `glTF`, version 2.
const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
/// Of a buffer view: vertices, indices.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
/// Of an accessor: 32-bit float, 32-bit unsigned integer.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;

/// Writes a scene.
///
/// # Errors
/// Those of `out`; `InvalidInput` when the file would pass 4 GiB.
pub fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let mut build = Build::default();
    let mut nodes = vec![];
    let mut meshes: Vec<Value> = vec![];
    for part in &scene.parts {
        let primitives = build.primitives(part);
        if primitives.is_empty() {
            continue;
        }
        nodes.push(json!({ "name": part.name, "mesh": meshes.len() }));
        meshes.push(json!({ "name": part.name, "primitives": primitives }));
    }
    let children: Vec<usize> = (0..nodes.len()).collect();
    let s = scene.metres;
    // Columns: x stays, y goes to -z, z goes up to y.
    let matrix = [s, 0.0, 0.0, 0.0, 0.0, 0.0, -s, 0.0, 0.0, s, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let mut root = json!({ "matrix": matrix });
    if !children.is_empty() {
        root["children"] = json!(children);
    }
    nodes.push(root);
    let mut text = json!({
        "asset": { "version": "2.0", "generator": concat!("resurf ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [children.len()] }],
        "nodes": nodes,
    });
    if !meshes.is_empty() {
        text["meshes"] = json!(meshes);
        text["materials"] = json!(build.materials);
        text["accessors"] = json!(build.accessors);
        text["bufferViews"] = json!(build.views);
        text["buffers"] = json!([{ "byteLength": build.bytes.len() }]);
    }
    file(text.to_string().into_bytes(), build.bytes, out)
}

/// The header, a chunk of text and one of data, each padded to four bytes.
fn file(mut text: Vec<u8>, mut data: Vec<u8>, out: &mut impl Write) -> io::Result<()> {
    text.resize(text.len().next_multiple_of(4), b' ');
    data.resize(data.len().next_multiple_of(4), 0);
    let length = |n: usize| u32::try_from(n).map_err(|e| io::Error::new(io::ErrorKind::InvalidInput, e));
    let chunks = if data.is_empty() { 8 } else { 16 };
    out.write_all(MAGIC)?;
    out.write_all(&VERSION.to_le_bytes())?;
    out.write_all(&length(12 + chunks + text.len() + data.len())?.to_le_bytes())?;
    out.write_all(&length(text.len())?.to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    if !data.is_empty() {
        out.write_all(&length(data.len())?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(&data)?;
    }
    Ok(())
}

/// The lists of a file in the making, and its data.
#[derive(Default)]
struct Build {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    known: BTreeMap<[u64; 3], usize>,
}

impl Build {
    /// One primitive for each colour of a part.
    fn primitives(&mut self, part: &super::scene::Part) -> Vec<Value> {
        let (colours, of) = part.palette();
        let mesh = &part.mesh;
        let smooth = mesh.normals.len() == mesh.triangles.len();
        let mut primitives = Vec::new();
        for (at, &colour) in colours.iter().enumerate() {
            // A vertex counts anew for every normal that it has.
            let mut places: BTreeMap<(u32, [u32; 3]), u32> = BTreeMap::new();
            let (mut points, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::<u32>::new());
            for (triangle, _) in of.iter().enumerate().filter(|(_, c)| **c == at) {
                let corners = mesh.triangles[triangle];
                let [a, b, c] = corners.map(|v| mesh.vertices[v as usize]);
                let flat = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(crate::math::Vector3::z);
                for (k, &vertex) in corners.iter().enumerate() {
                    let normal = if smooth { mesh.normals[triangle][k] } else { flat };
                    let normal = single(normal.as_slice());
                    let next = u32::try_from(points.len()).unwrap_or(u32::MAX);
                    let place = *places.entry((vertex, normal.map(f32::to_bits))).or_insert(next);
                    if place == next {
                        points.push(single(mesh.vertices[vertex as usize].coords.as_slice()));
                        normals.push(normal);
                    }
                    indices.push(place);
                }
            }
            let position = self.vectors(&points, true);
            let normal = self.vectors(&normals, false);
            let indices = self.indices(&indices);
            let material = self.material(colour);
            let attributes = json!({ "POSITION": position, "NORMAL": normal });
            primitives.push(json!({ "attributes": attributes, "indices": indices, "material": material }));
        }
        primitives
    }

    fn view(&mut self, bytes: &[u8], target: u32) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len(), "target": target });
        self.views.push(view);
        self.views.len() - 1
    }

    fn vectors(&mut self, vectors: &[[f32; 3]], bounded: bool) -> usize {
        let bytes: Vec<u8> = vectors.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes, ARRAY_BUFFER);
        let mut accessor = json!({
            "bufferView": view, "componentType": FLOAT, "count": vectors.len(), "type": "VEC3"
        });
        if bounded {
            let over = |pick: fn(f32, f32) -> f32, start: f32| {
                [0, 1, 2].map(|k| vectors.iter().fold(start, |m, v| pick(m, v[k])))
            };
            accessor["min"] = json!(over(f32::min, f32::INFINITY));
            accessor["max"] = json!(over(f32::max, f32::NEG_INFINITY));
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes, ELEMENT_ARRAY_BUFFER);
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED, "count": indices.len(), "type": "SCALAR"
        }));
        self.accessors.len() - 1
    }

    fn material(&mut self, colour: Rgb) -> usize {
        let materials = &mut self.materials;
        *self.known.entry(colour.map(f64::to_bits)).or_insert_with(|| {
            let [r, g, b] = colour.map(linear);
            materials.push(json!({
                "pbrMetallicRoughness": {
                    "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6
                }
            }));
            materials.len() - 1
        })
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the format holds single precision")]
fn single(values: &[f64]) -> [f32; 3] {
    [values[0] as f32, values[1] as f32, values[2] as f32]
}

/// From the encoding of screens to light (IEC 61966-2-1).
fn linear(part: f64) -> f64 {
    if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::scene::Part;
    use crate::mesh::triangle_mesh::tests::cube;

    #[test]
    fn the_chunks_are_of_the_length_that_they_say() {
        let part = Part { name: "würfel".to_owned(), mesh: cube([0.0; 3]), ..Part::default() };
        let mut bytes = Vec::new();
        write(&Scene { metres: 1e-3, parts: vec![part] }, &mut bytes).expect("a vector takes all bytes");
        let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|k| bytes[at + k])) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (&MAGIC[..], 2, bytes.len()));
        let text: Value = serde_json::from_slice(&bytes[20..20 + word(12)]).expect("JSON");
        assert_eq!(text["nodes"][0]["name"], "würfel");
        // A cube has 8 corners with 3 normals each; 12 triangles.
        assert_eq!(
            (&text["accessors"][0]["count"], &text["accessors"][2]["count"]),
            (&json!(24), &json!(36))
        );
        assert_eq!(text["accessors"][0]["max"], json!([1.0, 1.0, 1.0]));
        let data = 20 + word(12);
        assert_eq!((word(data), &bytes[data + 4..data + 8]), (24 * 24 + 36 * 4, &b"BIN\0"[..]));
        assert_eq!(bytes.len(), data + 8 + word(data));
    }
}
