//! The real program in a fresh folder: what it prints, what it leaves, and how it ends.

mod accepted;
mod batch;
mod cluster;
mod deform;
mod detail;
mod diff;
mod iges;
mod jobs;
mod locality;
#[path = "../support/occ.rs"]
#[allow(dead_code, reason = "shared with other test binaries")]
mod occ;
mod parts;
mod paste;
mod paste_golden;
mod paste_targets;
mod paste_words;
mod patho;
mod pictures;
mod proof;
mod regress;
mod solids;
mod stated;
#[path = "../support/mod.rs"]
#[allow(dead_code, reason = "shared with other test binaries")]
mod support;

use std::path::{Path, PathBuf};
use std::process::Command;

/// A fresh folder with the program to run in it.
pub struct Fixture {
    folder: tempfile::TempDir,
    variables: Vec<(String, String)>,
}

impl Default for Fixture {
    fn default() -> Self {
        Self::new()
    }
}

impl Fixture {
    /// An empty folder.
    pub fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let variables = vec![("SOURCE_DATE_EPOCH".to_owned(), "0".to_owned())];
        Self { folder, variables }
    }

    /// Sets a variable of the program's environment.
    pub fn variable(mut self, name: &str, value: &str) -> Self {
        self.variables.push((name.to_owned(), value.to_owned()));
        self
    }

    /// Puts a file into the folder.
    pub fn file(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("below the folder")).expect("a folder");
        std::fs::write(path, content).expect("a file");
        self
    }

    /// Puts a sample into the folder, under its file name.
    pub fn sample(self, name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(name);
        let bytes = std::fs::read(&path).expect("a sample");
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        self.file(&name, bytes)
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the program: exit code, standard output, standard error, one after the other.
    pub fn run(&self, arguments: &[&str]) -> String {
        let output = Command::new(assert_cmd::cargo::cargo_bin!("resurf"))
            .args(arguments)
            .current_dir(self.folder.path())
            .env("NO_COLOR", "1")
            // Programs that somebody set up must not decide a test.
            .env_remove("RESURF_FREECADCMD")
            .env_remove("RESURF_OPENSCAD")
            .envs(self.variables.iter().map(|(name, value)| (name.as_str(), value.as_str())))
            .output()
            .expect("the program starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let code = output.status.code().map_or_else(|| "none".to_owned(), |code| code.to_string());
        format!("exit code: {code}\n--- stdout\n{}--- stderr\n{}", text(&output.stdout), text(&output.stderr))
    }

    /// Names of all files in the folder, sorted: what a run left behind.
    pub fn left(&self) -> Vec<String> {
        let walk = walkdir::WalkDir::new(self.folder.path()).sort_by_file_name();
        let files = walk.into_iter().filter_map(Result::ok).filter(|entry| entry.file_type().is_file());
        let name = |entry: walkdir::DirEntry| {
            let path = entry.path().strip_prefix(self.folder.path()).expect("below the folder");
            path.to_string_lossy().into_owned()
        };
        files.map(name).collect()
    }
}

/// A job of the door with the given lines in its operation.
pub fn door_job(operation: &str) -> String {
    format!(
        "version = 1\ninputs = [\"door.step\"]\noutput = \"out/{{stem}}.{{ext}}\"\n\n\
         [[operation]]\nkind = \"constrained_scale\"\n{operation}\n"
    )
}
