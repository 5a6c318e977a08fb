//! Object File Format: the text `OFF`, counts, vertices, faces (Geomview's format in its plain form).
//!
//! Coordinates are written with as many digits as they need to read back to the same bits, and vertices
//! stay shared, so the mesh loses nothing but its faces and normals. Colours are not read.

use super::{Mesh, MeshReadError};
use crate::math::Point3;
use std::io::{self, Write};

/// Writes a mesh as OFF.
///
/// # Errors
/// Those of `out`.
pub fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "OFF\n{} {} 0", mesh.vertices.len(), mesh.triangles.len())?;
    for p in &mesh.vertices {
        writeln!(out, "{} {} {}", p.x, p.y, p.z)?;
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}

/// Reads a mesh from OFF; polygons become fans about their first corner.
///
/// # Errors
/// The first place where the text is not OFF, or names a vertex that is not there.
pub fn read(bytes: &[u8]) -> Result<Mesh, MeshReadError> {
    let mut words = Words::new(bytes);
    let head = words.word("OFF")?;
    if head != "OFF" {
        return Err(words.malformed(format!("'OFF' expected, found '{head:.20}'")));
    }
    let [vertex_count, face_count, _edge_count] = [words.index()?, words.index()?, words.index()?];
    let mut mesh = Mesh::default();
    for _ in 0..vertex_count {
        mesh.vertices.push(Point3::new(words.coordinate()?, words.coordinate()?, words.coordinate()?));
    }
    for _ in 0..face_count {
        let corners = words.index()?;
        let mut corner = || match words.index() {
            Ok(at) if at < vertex_count => Ok(at),
            Ok(at) => Err(words.malformed(format!("vertex {at} of {vertex_count}"))),
            Err(error) => Err(error),
        };
        if corners < 3 {
            for _ in 0..corners {
                corner()?;
            }
            continue;
        }
        let [first, mut last] = [corner()?, corner()?];
        for _ in 2..corners {
            let next = corner()?;
            mesh.triangles.push([first, last, next]);
            last = next;
        }
        words.skip_line();
    }
    Ok(mesh)
}

/// Words of a text with comments, and the line that each stands on.
struct Words<'a> {
    lines: std::str::Lines<'a>,
    rest: std::str::SplitWhitespace<'a>,
    line: usize,
    valid: bool,
}

impl<'a> Words<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let text = std::str::from_utf8(bytes);
        Self {
            lines: text.unwrap_or_default().lines(),
            rest: "".split_whitespace(),
            line: 0,
            valid: text.is_ok(),
        }
    }

    fn malformed(&self, found: String) -> MeshReadError {
        MeshReadError::Malformed { format: "OFF", place: self.line.max(1), found }
    }

    fn word(&mut self, expected: &str) -> Result<&'a str, MeshReadError> {
        loop {
            if let Some(word) = self.rest.next() {
                return Ok(word);
            }
            let Some(line) = self.lines.next() else {
                let end = if self.valid { "end of text" } else { "bytes that are not UTF-8" };
                return Err(self.malformed(format!("{expected} expected, found {end}")));
            };
            self.line += 1;
            self.rest = line.split('#').next().unwrap_or_default().split_whitespace();
        }
    }

    fn index(&mut self) -> Result<u32, MeshReadError> {
        let word = self.word("a count or an index")?;
        word.parse().map_err(|_| self.malformed(format!("a count or an index expected, found '{word:.20}'")))
    }

    fn coordinate(&mut self) -> Result<f64, MeshReadError> {
        let word = self.word("a coordinate")?;
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.malformed(format!("a finite number expected, found '{word:.20}'"))),
        }
    }

    /// Passes over what follows a face on its line: colours.
    fn skip_line(&mut self) {
        self.rest = "".split_whitespace();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle_mesh::tests::cube;

    #[test]
    fn a_written_mesh_reads_back_to_the_same_bits() {
        let mesh = cube([0.1, 1e-300, -1.0 / 3.0]);
        let mut bytes = Vec::new();
        write(&mesh, &mut bytes).expect("a vector takes all bytes");
        assert_eq!(read(&bytes), Ok(mesh));
    }

    #[test]
    fn polygons_comments_and_colours_are_understood() {
        let text = b"OFF # a square\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 0.5 0.5 0.5\n";
        let mesh = read(text).expect("good text");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn damage_is_named_with_its_line() {
        let line_of = |text: &[u8]| match read(text) {
            Err(MeshReadError::Malformed { place, .. }) => place,
            other => panic!("{other:?}"),
        };
        assert_eq!(line_of(b"FFO\n"), 1);
        assert_eq!(line_of(b"OFF\n1 1 0\n0 0 nan\n"), 3);
        assert_eq!(line_of(b"OFF\n1 1 0\n0 0 0\n3 0 0 1\n"), 4);
        assert_eq!(line_of(b"OFF\n4000000000 1 0\n0 0 0\n"), 3);
        assert_eq!(line_of(b"\xff"), 1);
    }
}
