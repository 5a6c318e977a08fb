//! Recognises and reads clouds of points.

use crate::cloud::{CloudError, LabelColumn, PointCloud, e57, obj, pcd, ply, xyz};
use crate::mesh::{MeshReadError, stl};

/// A cloud as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudFile {
    /// The points, in the file's unit.
    pub cloud: PointCloud,
    /// Metres of the unit, when the format states it.
    pub metres: Option<f64>,
}

/// Why a file is no cloud.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CloudFileError {
    /// The points cannot be read.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// The triangles whose corners are the points cannot be read.
    #[error(transparent)]
    Mesh(#[from] MeshReadError),
    /// Labels were asked for, and the format has none.
    #[error(
        "{format} files have no labels; give the points in PLY, PCD or a table, or in files of their own"
    )]
    NoLabels {
        /// Name of the format.
        format: &'static str,
    },
    /// Neither the content nor the extension is known.
    #[error(
        "neither the content nor the extension `{extension}` is that of a cloud; known are ply, pcd, e57, stl, obj, xyz, \
         asc, csv, txt and pts"
    )]
    Unknown {
        /// The extension.
        extension: String,
    },
}

impl CloudFileError {
    /// The stable code.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Cloud(error) => error.code(),
            Self::Mesh(_) => "cloud.mesh",
            Self::NoLabels { .. } => "cloud.no-label-column",
            Self::Unknown { .. } => "cloud.unknown-format",
        }
    }
}

/// Reads a cloud by its content, or else by its extension; `label` names the column of labels, when they are wanted.
///
/// # Errors
/// [`CloudFileError`].
pub fn read(bytes: &[u8], extension: &str, label: Option<&LabelColumn>) -> Result<CloudFile, CloudFileError> {
    let plain = |cloud| CloudFile { cloud, metres: None };
    let unlabelled = |format| label.map_or(Ok(()), |_| Err(CloudFileError::NoLabels { format }));
    if bytes.is_empty() {
        return Err(CloudError::Empty.into());
    }
    if ply::is_ply(bytes) {
        return Ok(plain(ply::read(bytes, label)?));
    }
    if pcd::is_pcd(bytes) {
        return Ok(plain(pcd::read(bytes, label)?));
    }
    if e57::is_e57(bytes) {
        unlabelled("E57")?;
        return Ok(CloudFile { cloud: e57::read(bytes)?, metres: Some(1.0) });
    }
    match extension.to_ascii_lowercase().as_str() {
        "stl" => {
            unlabelled("STL")?;
            Ok(plain(PointCloud::new("STL", stl::read(bytes)?.vertices)?))
        }
        "obj" => {
            unlabelled("OBJ")?;
            Ok(plain(obj::read(bytes)?))
        }
        "xyz" | "asc" | "csv" | "txt" | "pts" => Ok(plain(xyz::read(bytes, label)?)),
        // What these promise and is not there is an error of the file, not of its name.
        "ply" => Ok(plain(ply::read(bytes, label)?)),
        "pcd" => Ok(plain(pcd::read(bytes, label)?)),
        "e57" => Ok(CloudFile { cloud: e57::read(bytes)?, metres: Some(1.0) }),
        _ => Err(CloudFileError::Unknown { extension: extension.to_owned() }),
    }
}
