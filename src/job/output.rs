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

/// A file that is written but does not stand in its place yet. Dropped, it vanishes, and with it the folders
/// that were made for it.
#[derive(Debug)]
pub struct Staged {
    // The file goes before its folders do: fields are dropped in this order.
    temporary: NamedTempFile,
    made: MadeFolders,
    place: PathBuf,
}

/// Folders that were missing, the innermost first. Dropped, they vanish unless something stands in them.
#[derive(Debug, Default)]
struct MadeFolders(Vec<PathBuf>);

impl MadeFolders {
    /// Makes a folder with all that it stands in.
    fn make(folder: &Path) -> std::io::Result<Self> {
        let missing = folder.ancestors().take_while(|path| !path.as_os_str().is_empty() && !path.exists());
        let missing = missing.map(Path::to_owned).collect();
        std::fs::create_dir_all(folder)?;
        Ok(Self(missing))
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for folder in &self.0 {
            // One that is not empty stays, and those around it: somebody else uses it too.
            if std::fs::remove_dir(folder).is_err() {
                break;
            }
        }
    }
}

impl Staged {
    /// Writes bytes beside their place and syncs them. The folder is made when it is missing.
    ///
    /// # Errors
    /// [`FileError`] naming the place.
    pub fn write(place: &Path, bytes: &[u8]) -> Result<Self, FileError> {
        let error = |source| FileError { path: place.to_owned(), source };
        let folder = place.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let made = MadeFolders::make(folder).map_err(error)?;
        // The extension stays: other programs decide by it how to read the file.
        let extension = place.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
        let mut temporary = locked(folder, &extension).map_err(error)?;
        temporary.write_all(bytes).map_err(error)?;
        temporary.as_file().sync_all().map_err(error)?;
        Ok(Self { temporary, made, place: place.to_owned() })
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
        let Self { temporary, mut made, place } = self;
        temporary.persist(&place).map_err(|e| FileError { path: place, source: e.error })?;
        made.0.clear();
        Ok(())
    }
}

/// Start of the names of files that do not stand in their place yet.
const PREFIX: &str = ".resurf-";

/// A new file with a lock that its process holds for as long as it lives: a file without one was left behind.
fn locked(folder: &Path, extension: &str) -> std::io::Result<NamedTempFile> {
    loop {
        let temporary = tempfile::Builder::new()
            .prefix(PREFIX)
            .suffix(extension)
            .permissions(permissions())
            .tempfile_in(folder)?;
        match temporary.as_file().lock() {
            // Between making and locking it may have passed for one that was left behind.
            Ok(()) if !temporary.path().exists() => {}
            // A file system without locks is no reason not to write.
            Ok(()) | Err(_) => return Ok(temporary),
        }
    }
}

/// Takes away files that processes left behind when they were killed before the files were in their place.
pub fn sweep(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.filter_map(Result::ok) {
        let left = entry.file_name().to_string_lossy().starts_with(PREFIX);
        if !left || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        // The lock is held until the name is gone: its maker sees that and takes another one.
        if let Ok(file) = std::fs::File::open(entry.path())
            && file.try_lock().is_ok()
        {
            // Somebody else may have been faster, which is as good.
            let _ = std::fs::remove_file(entry.path());
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_process_left_is_swept_and_what_a_living_one_writes_is_not() {
        let root = tempfile::tempdir().expect("a folder for the test");
        let place = root.path().join("part.step");
        let staged = Staged::write(&place, b"x").expect("written");
        std::fs::write(root.path().join(".resurf-dead.step"), b"half").expect("written");
        sweep(root.path());
        assert!(staged.path().exists() && !root.path().join(".resurf-dead.step").exists());
        staged.commit().expect("in its place");
        sweep(root.path());
        assert!(place.exists());
    }

    #[test]
    fn folders_made_for_a_file_stay_only_with_it() {
        let root = tempfile::tempdir().expect("a folder for the test");
        let place = root.path().join("a/b/part.step");
        drop(Staged::write(&place, b"x").expect("written"));
        assert!(!root.path().join("a").exists());
        Staged::write(&place, b"x").and_then(Staged::commit).expect("written");
        assert_eq!(std::fs::read(&place).expect("it stands there"), b"x");
        let other = root.path().join("a/c/part.step");
        drop(Staged::write(&other, b"x").expect("written"));
        assert!(!root.path().join("a/c").exists() && place.exists());
    }
}
