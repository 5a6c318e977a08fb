//! STL, binary and text (3D Systems, StereoLithography Interface Specification, 1989).
//!
//! STL repeats every corner, so reading welds corners of equal bits into one vertex. The binary form holds
//! single precision: neighbours of one vertex still meet exactly, since each corner is rounded alike, but
//! triangles smaller than the rounding collapse; OFF has no such loss.

use super::{Mesh, MeshReadError};
use crate::math::{Point3, Vector3};
use std::collections::BTreeMap;
use std::io::{self, Write};

const HEADER: usize = 80;
const RECORD: usize = 50;

/// Writes a mesh as binary STL with the given header text, cut at 80 bytes.
///
/// # Errors
/// Those of `out`; `InvalidInput` when there are more triangles than the format can count.
pub fn write_binary(mesh: &Mesh, header: &str, out: &mut impl Write) -> io::Result<()> {
    let count = u32::try_from(mesh.triangles.len())
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
    // A header that begins with "solid" would make readers take the file for text.
    let mut head = [b' '; HEADER];
    let text = header.strip_prefix("solid").unwrap_or(header).as_bytes();
    let length = text.len().min(HEADER);
    head[..length].copy_from_slice(&text[..length]);
    out.write_all(&head)?;
    out.write_all(&count.to_le_bytes())?;
    for corners in mesh.corners() {
        let mut record = [0u8; RECORD];
        let normal = Point3::from(normal_of(&corners));
        for (k, value) in [normal].iter().chain(&corners).flat_map(|p| p.iter()).enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "the format holds single precision")]
            record[4 * k..4 * k + 4].copy_from_slice(&(*value as f32).to_le_bytes());
        }
        out.write_all(&record)?;
    }
    Ok(())
}

/// Writes a mesh as STL text with coordinates that read back to the same bits.
///
/// # Errors
/// Those of `out`.
pub fn write_text(mesh: &Mesh, name: &str, out: &mut impl Write) -> io::Result<()> {
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    writeln!(out, "solid {name}")?;
    for corners in mesh.corners() {
        let n = normal_of(&corners);
        writeln!(out, "facet normal {} {} {}\n outer loop", n.x, n.y, n.z)?;
        for p in corners {
            writeln!(out, "  vertex {} {} {}", p.x, p.y, p.z)?;
        }
        writeln!(out, " endloop\nendfacet")?;
    }
    writeln!(out, "endsolid {name}")
}

/// Unit normal by the right-hand rule; zero for a triangle without area, as the format wants it.
fn normal_of([a, b, c]: &[Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}

/// Reads STL: binary when the length fits the count at byte 80, text otherwise.
///
/// # Errors
/// The first facet or line that is not STL.
pub fn read(bytes: &[u8]) -> Result<Mesh, MeshReadError> {
    let count = bytes.get(HEADER..HEADER + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let records = bytes.get(HEADER + 4..).unwrap_or_default();
    if count.and_then(|count| count.checked_mul(RECORD)) == Some(records.len()) {
        return read_binary(records);
    }
    read_text(bytes)
}

fn read_binary(records: &[u8]) -> Result<Mesh, MeshReadError> {
    let mut welder = Welder::default();
    for (facet, record) in records.chunks_exact(RECORD).enumerate() {
        let value = |k: usize| {
            let at = 12 + 4 * k;
            f64::from(f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]))
        };
        let corners = std::array::from_fn(|k| Point3::new(value(3 * k), value(3 * k + 1), value(3 * k + 2)));
        welder.add(corners, facet + 1)?;
    }
    Ok(welder.mesh)
}

fn read_text(bytes: &[u8]) -> Result<Mesh, MeshReadError> {
    let malformed =
        |place, found: &str| MeshReadError::Malformed { format: "STL", place, found: found.into() };
    if !bytes.trim_ascii_start().starts_with(b"solid") {
        return Err(malformed(1, "neither 'solid' nor a count that fits the length"));
    }
    let mut welder = Welder::default();
    let mut corners = Vec::with_capacity(3);
    for (at, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = line.trim_ascii();
        let Some(numbers) = line.strip_prefix(b"vertex") else {
            if line.starts_with(b"endfacet") {
                let corners: [_; 3] =
                    corners[..].try_into().map_err(|_| malformed(at + 1, "facet without three corners"))?;
                welder.add(corners, at + 1)?;
            }
            if line.starts_with(b"facet") || line.starts_with(b"endfacet") {
                corners.clear();
            }
            continue;
        };
        let numbers =
            std::str::from_utf8(numbers).map_err(|_| malformed(at + 1, "bytes that are not UTF-8"))?;
        let values: Vec<f64> = numbers.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let [x, y, z] = values[..] else { return Err(malformed(at + 1, "vertex without three numbers")) };
        corners.push(Point3::new(x, y, z));
    }
    Ok(welder.mesh)
}

/// Joins corners of equal bits.
#[derive(Default)]
struct Welder {
    mesh: Mesh,
    known: BTreeMap<[u64; 3], u32>,
}

impl Welder {
    fn add(&mut self, corners: [Point3<f64>; 3], place: usize) -> Result<(), MeshReadError> {
        let mut triangle = [0; 3];
        for (index, point) in triangle.iter_mut().zip(corners) {
            if !point.iter().all(|c| c.is_finite()) {
                let found = "a number that is not finite".into();
                return Err(MeshReadError::Malformed { format: "STL", place, found });
            }
            // Adding zero turns -0 into 0: the two are one place.
            let key = [point.x, point.y, point.z].map(|c| (c + 0.0).to_bits());
            let count = self.mesh.vertices.len();
            let next = u32::try_from(count).map_err(|_| MeshReadError::TooLarge { count })?;
            *index = *self.known.entry(key).or_insert(next);
            if *index == next {
                self.mesh.vertices.push(point);
            }
        }
        self.mesh.triangles.push(triangle);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Integrity;
    use crate::mesh::triangle_mesh::tests::cube;

    #[test]
    fn both_forms_read_back_as_the_same_closed_cube() {
        let mesh = cube([0.25, -8.0, 0.5]);
        let mut binary = Vec::new();
        write_binary(&mesh, "solid cube", &mut binary).expect("a vector takes all bytes");
        assert_eq!(binary.len(), 84 + 50 * 12);
        assert!(!binary.starts_with(b"solid"));
        let mut text = Vec::new();
        write_text(&mesh, "cube", &mut text).expect("a vector takes all bytes");
        for bytes in [binary, text] {
            let back = read(&bytes).expect("our own file");
            assert!(Integrity::of(&back).is_closed());
            assert_eq!((back.vertices.len(), back.triangles.len()), (8, 12));
            assert!((back.signed_volume() - 1.0).abs() < 1e-12);
            assert_eq!(back.extents(), mesh.extents());
        }
    }

    #[test]
    fn text_keeps_every_bit() {
        let mesh = cube([0.1, 0.2, 1e-9]);
        let mut text = Vec::new();
        write_text(&mesh, "a\nb", &mut text).expect("a vector takes all bytes");
        let back = read(&text).expect("our own file");
        let bits = |mesh: &Mesh| -> Vec<_> { mesh.corners().flatten().collect() };
        assert_eq!(bits(&back), bits(&mesh));
    }

    #[test]
    fn damage_is_named() {
        for bytes in [
            &b""[..],
            b"solid x\nfacet\nvertex 0 0 0\nendfacet\n",
            b"solid x\nfacet\nvertex 0 0\n",
            b"solid x\nfacet\nvertex 0 0 nan\nvertex 0 0 0\nvertex 1 0 0\nendfacet",
            &[0; 90],
        ] {
            assert!(matches!(read(bytes), Err(MeshReadError::Malformed { format: "STL", .. })), "{bytes:?}");
        }
    }
}
