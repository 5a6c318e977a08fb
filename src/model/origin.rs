//! Which record of the file each element came from.

use crate::brep::{Arena, BodyId, CoedgeId, CurveId, EdgeId, FaceId, LoopId, ShellId, SurfaceId, VertexId};

/// The name of a record in its file: a STEP entity instance name (`#12`), an IGES directory entry (`D5`), or a member
/// of one that is a list (`D5/2`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Origin {
    /// STEP: the number behind `#`.
    Instance(u64),
    /// IGES: the sequence number of the directory entry.
    DirectoryEntry(u32),
    /// IGES: the file as a whole, for the product that it is.
    File,
    /// IGES: a member of a list of vertices or edges, or of a loop.
    Member {
        /// The sequence number of the list's directory entry.
        entry: u32,
        /// Its place, from 1.
        index: u32,
    },
}

/// A text that is no name of a record.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not the name of a record; expected \"#1042\" in a STEP file, \"D57\" or \"D57/3\" in an IGES file"
)]
pub struct ParseOriginError(String);

impl std::str::FromStr for Origin {
    type Err = ParseOriginError;

    fn from_str(text: &str) -> Result<Self, ParseOriginError> {
        fn number<T: std::str::FromStr>(digits: &str) -> Option<T> {
            let plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
            digits.parse().ok().filter(|_| plain)
        }
        let name = text.trim();
        let found = match (name.strip_prefix('#'), name.strip_prefix(['D', 'd'])) {
            (Some(digits), _) => number(digits).map(Self::Instance),
            (_, Some(entry)) => match entry.split_once('/') {
                Some((entry, index)) => {
                    number(entry).zip(number(index)).map(|(entry, index)| Self::Member { entry, index })
                }
                None => number(entry).map(Self::DirectoryEntry),
            },
            _ => None,
        };
        found.ok_or_else(|| ParseOriginError(name.to_owned()))
    }
}

impl Origin {
    /// The number of a STEP entity instance name.
    #[must_use]
    pub fn instance(self) -> Option<u64> {
        match self {
            Self::Instance(name) => Some(name),
            Self::DirectoryEntry(_) | Self::Member { .. } | Self::File => None,
        }
    }

    /// How far apart two names of a kind are, for candidates; as far as can be for names of two kinds.
    #[must_use]
    pub fn distance(self, other: Self) -> u64 {
        let entry = |origin: Self| match origin {
            Self::DirectoryEntry(entry) | Self::Member { entry, .. } => Some(entry),
            Self::Instance(_) | Self::File => None,
        };
        match (self, other) {
            (Self::Instance(a), Self::Instance(b)) => a.abs_diff(b),
            _ => entry(self).zip(entry(other)).map_or(u64::MAX, |(a, b)| a.abs_diff(b).into()),
        }
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Instance(name) => write!(f, "#{name}"),
            Self::DirectoryEntry(number) => write!(f, "D{number}"),
            Self::File => f.write_str("file"),
            Self::Member { entry, index } => write!(f, "D{entry}/{index}"),
        }
    }
}

/// The record of each element of a model.
#[derive(Debug, Clone, Default)]
pub struct Origins {
    /// Curves: the curve itself, not a surface curve around it.
    pub curves: Arena<CurveId, Origin>,
    /// Surfaces.
    pub surfaces: Arena<SurfaceId, Origin>,
    /// Vertices: the vertex point.
    pub vertices: Arena<VertexId, Origin>,
    /// Edges: the edge curve.
    pub edges: Arena<EdgeId, Origin>,
    /// Uses of edges: the oriented edge.
    pub coedges: Arena<CoedgeId, Origin>,
    /// Records of the curves in parameter space, beside [`Coedge::pcurve`](crate::brep::Coedge::pcurve).
    pub pcurves: Arena<CoedgeId, Option<Origin>>,
    /// Loops: the bound.
    pub loops: Arena<LoopId, Origin>,
    /// Faces.
    pub faces: Arena<FaceId, Origin>,
    /// Shells.
    pub shells: Arena<ShellId, Origin>,
    /// Bodies.
    pub bodies: Arena<BodyId, Origin>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_shown() {
        let names =
            [Origin::Instance(1042), Origin::DirectoryEntry(57), Origin::Member { entry: 43, index: 5 }];
        for name in names {
            assert_eq!(name.to_string().parse(), Ok(name));
        }
        for text in ["", "1042", "#", "#x", "D", "D5/", "D/3", "#12/3", "D-1", "#99999999999999999999"] {
            assert!(text.parse::<Origin>().is_err(), "{text}");
        }
    }
}
