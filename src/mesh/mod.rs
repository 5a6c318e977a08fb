//! Triangles: tessellation of bodies, OFF, STL, 3MF and GLB, and what may be wrong with a mesh.
//!
//! A [`Mesh`] is made from a B-rep or read from bytes; it never becomes a B-rep again. Knows formats of
//! triangles only, and no file system: writers fill byte vectors, readers take slices.

pub mod divide;
pub mod glb;
mod integrity;
mod nearest;
pub mod off;
mod scene;
pub mod stl;
pub mod tessellate;
pub mod three_mf;
mod triangle_mesh;

pub use integrity::Integrity;
pub use nearest::{NearestTriangle, to_segment, to_triangle};
pub use scene::{Part, Rgb, Scene};
pub use tessellate::{TessellateError, Tolerances, tessellate_bodies, tessellate_faces};
pub use triangle_mesh::{Extents, Mesh};

/// Why bytes are not a mesh.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeshReadError {
    /// The text or the record layout is not that of the format.
    #[error("{format} line or record {place}: {found}")]
    Malformed {
        /// `OFF` or `STL`.
        format: &'static str,
        /// Line of a text, facet of a binary file; both from 1.
        place: usize,
        /// Lower-case fragment: what was found there.
        found: String,
    },
    /// More vertices or triangles than 32-bit indices can name.
    #[error("{count} vertices or triangles are over the limit of {}", u32::MAX)]
    TooLarge {
        /// Count found.
        count: usize,
    },
}
