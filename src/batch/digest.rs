//! SHA-256 of what a result depends on: equal digests, equal bytes.

use std::io::{Read, Result};
use std::path::Path;

use sha2::{Digest as _, Sha256};

/// Digest of a sequence of named things; the names and lengths keep neighbours apart.
pub(super) struct Digest(Sha256);

impl Digest {
    pub(super) fn new() -> Self {
        Self(Sha256::new())
    }

    pub(super) fn add(&mut self, name: &str, bytes: &[u8]) {
        for part in [name.as_bytes(), bytes] {
            self.0.update((part.len() as u64).to_le_bytes());
            self.0.update(part);
        }
    }

    /// Hexadecimal, lower case.
    pub(super) fn text(self) -> String {
        hexadecimal(&self.0.finalize())
    }
}

/// SHA-256 of a file, as `sha256sum` prints it.
///
/// # Errors
/// When it cannot be read.
pub(super) fn of_file(path: &Path) -> Result<String> {
    let mut file = std::fs::File::open(path)?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            count => hash.update(&buffer[..count]),
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_the_digest_of_fips_180_4() {
        let file = tempfile::NamedTempFile::new().expect("a file");
        std::fs::write(file.path(), "abc").expect("written");
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(of_file(file.path()).expect("read"), expected);
    }

    #[test]
    fn neighbours_are_kept_apart() {
        let of = |parts: [(&str, &str); 2]| {
            let mut digest = Digest::new();
            parts.iter().for_each(|(name, bytes)| digest.add(name, bytes.as_bytes()));
            digest.text()
        };
        assert_ne!(of([("a", "bc"), ("d", "")]), of([("a", "b"), ("cd", "")]));
    }
}
