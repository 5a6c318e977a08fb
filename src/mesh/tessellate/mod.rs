//! Triangles for bodies and faces.

mod lattice;
mod region;

/// How far triangles may be from the surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerances {
    /// Greatest distance of a side's or a triangle's middle from its curve or surface, in file units.
    pub chord: f64,
    /// Greatest turn of the tangent along a side, in radians.
    pub angle: f64,
}
