//! Writes files whole or not at all: beside their place, synced, renamed.

use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}", .path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// What the system says.
    pub source: std::io::Error,
}

/// A file that is written but does not stand in its place yet. Dropped, it vanishes.
#[derive(Debug)]
pub struct Staged {
    temporary: NamedTempFile,
    place: PathBuf,
}

impl Staged {
    /// Writes bytes beside their place and syncs them. The folder is made when it is missing.
    ///
    /// # Errors
    /// [`FileError`] naming the place.
    pub fn write(place: &Path, bytes: &[u8]) -> Result<Self, FileError> {
        let error = |source| FileError { path: place.to_owned(), source };
        let folder = place.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder).map_err(error)?;
        // The extension stays: other programs decide by it how to read the file.
        let extension = place.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
        let mut temporary = tempfile::Builder::new()
            .prefix(".resurf-")
            .suffix(&extension)
            .permissions(permissions())
            .tempfile_in(folder)
            .map_err(error)?;
        temporary.write_all(bytes).map_err(error)?;
        temporary.as_file().sync_all().map_err(error)?;
        Ok(Self { temporary, place: place.to_owned() })
    }

    /// Where the bytes are now.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.temporary.path()
    }

    /// Moves the file into its place, over what stood there.
    ///
    /// # Errors
    /// [`FileError`] naming the place.
    pub fn commit(self) -> Result<(), FileError> {
        let place = self.place;
        self.temporary.persist(&place).map_err(|e| FileError { path: place, source: e.error })?;
        Ok(())
    }
}

/// What a new file gets before the process's mask: a temporary file's own 0600 would stay with the output.
#[cfg(unix)]
fn permissions() -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt;
    std::fs::Permissions::from_mode(0o666)
}

#[cfg(not(unix))]
fn permissions() -> std::fs::Permissions {
    std::fs::Permissions::default()
}
