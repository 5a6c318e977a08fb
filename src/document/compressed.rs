//! Compressed exchange files: gzip streams and zip archives with one STEP file (`.stpZ`).
//!
//! Gives the bytes inside, within limits that a hostile file cannot pass. Writes nothing compressed: what is
//! written of such a file is plain text.

use std::io::{Cursor, ErrorKind, Read};

use super::Format;

/// Bytes that a file may unfold to. STEP of this size is far beyond what a part needs.
pub const MOST_BYTES: u64 = 2 << 30;

/// Times that a file may grow. STEP text shrinks to a fifth or a tenth, a bomb to less than a thousandth.
pub const MOST_GROWTH: u64 = 200;

/// Bytes that may be unfolded whatever the growth: nobody is harmed by that much.
pub const ALWAYS_ALLOWED: u64 = 16 << 20;

/// Members of an archive that are looked at: an exchange file comes with a few others at most.
const MOST_MEMBERS: usize = 1000;

/// Why a compressed file gives no exchange file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompressedError {
    /// The stream is damaged or cut.
    #[error("the {} data are damaged: {reason}", .format.as_str())]
    Damaged {
        /// Gzip or zip.
        format: Format,
        /// What the decoder says.
        reason: String,
    },
    /// More comes out than a file of this size may hold.
    #[error(
        "unfolds to more than {limit} bytes, {MOST_GROWTH} times its size or the greatest size that is read"
    )]
    TooLarge {
        /// The limit that was met.
        limit: u64,
    },
    /// There is not enough memory for what comes out.
    #[error("there is not enough memory to unfold it")]
    OutOfMemory,
    /// The archive has no STEP file.
    #[error("the archive holds no file with the extension step, stp or p21")]
    NoMember,
    /// The archive has several.
    #[error("the archive holds {count} STEP files, expected one: {names}")]
    SeveralMembers {
        /// How many.
        count: usize,
        /// The first of their names.
        names: String,
    },
}

/// The exchange file inside a gzip stream.
///
/// # Errors
/// [`CompressedError`] when it is damaged or too large.
pub fn gunzip(bytes: &[u8]) -> Result<Vec<u8>, CompressedError> {
    limited(flate2::read::MultiGzDecoder::new(bytes), bytes.len(), Format::Gzip)
}

/// The one STEP file inside a zip archive.
///
/// # Errors
/// [`CompressedError`] when it is damaged, too large, or does not hold exactly one.
pub fn unzip(bytes: &[u8]) -> Result<Vec<u8>, CompressedError> {
    let damaged = |reason: String| CompressedError::Damaged { format: Format::Zip, reason };
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(error.to_string()))?;
    let is_step = |name: &str| {
        let name = name.rsplit(['/', '\\']).next().unwrap_or_default();
        let extension = name.rsplit_once('.').map(|(_, extension)| extension).unwrap_or_default();
        Format::of_extension(extension) == Some(Format::Step)
    };
    let count = archive.len().min(MOST_MEMBERS);
    let names = archive.file_names().take(count).enumerate();
    let members: Vec<(usize, String)> = names
        .filter_map(|(at, name)| Some((at, name.ok()?.into_owned())))
        .filter(|(_, name)| is_step(name))
        .collect();
    let [(at, _)] = members.as_slice() else {
        let names: Vec<&str> = members.iter().take(3).map(|(_, name)| name.as_str()).collect();
        return Err(match members.len() {
            0 => CompressedError::NoMember,
            count => CompressedError::SeveralMembers { count, names: names.join(", ") },
        });
    };
    let member = archive.by_index(*at).map_err(|error| damaged(error.to_string()))?;
    limited(member, bytes.len(), Format::Zip)
}

/// Reads to the end, or to the limit for a compressed size.
fn limited(reader: impl Read, compressed: usize, format: Format) -> Result<Vec<u8>, CompressedError> {
    let grown = (compressed as u64).saturating_mul(MOST_GROWTH);
    let limit = grown.clamp(ALWAYS_ALLOWED, MOST_BYTES);
    let mut bytes = Vec::new();
    match reader.take(limit + 1).read_to_end(&mut bytes) {
        Ok(_) if bytes.len() as u64 > limit => Err(CompressedError::TooLarge { limit }),
        Ok(_) => Ok(bytes),
        Err(error) if error.kind() == ErrorKind::OutOfMemory => Err(CompressedError::OutOfMemory),
        Err(error) => Err(CompressedError::Damaged { format, reason: error.to_string() }),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(bytes).expect("memory");
        encoder.finish().expect("memory")
    }

    fn archive(members: &[(&str, &[u8])]) -> Vec<u8> {
        let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in members {
            writer.start_file(*name, zip::write::SimpleFileOptions::default()).expect("memory");
            writer.write_all(bytes).expect("memory");
        }
        writer.finish().expect("memory").into_inner()
    }

    #[test]
    fn what_was_packed_comes_out() {
        let text = b"ISO-10303-21;".repeat(1000);
        assert_eq!(gunzip(&gzip(&text)), Ok(text.clone()));
        assert_eq!(unzip(&archive(&[("readme.txt", b"x"), ("a/Part.STP", &text)])), Ok(text));
    }

    #[test]
    fn damage_and_other_contents_are_refused() {
        let packed = gzip(b"ISO-10303-21;");
        assert!(matches!(gunzip(&packed[..packed.len() - 6]), Err(CompressedError::Damaged { .. })));
        assert!(matches!(unzip(b"PK\x03\x04 and nothing more"), Err(CompressedError::Damaged { .. })));
        assert_eq!(unzip(&archive(&[("a.txt", b"x")])), Err(CompressedError::NoMember));
        let two = unzip(&archive(&[("a.stp", b"x"), ("b.step", b"y")]));
        assert!(matches!(two, Err(CompressedError::SeveralMembers { count: 2, .. })));
    }

    #[test]
    fn a_bomb_is_not_unfolded() {
        let bomb = vec![b' '; (ALWAYS_ALLOWED + 1) as usize];
        assert_eq!(gunzip(&gzip(&bomb)), Err(CompressedError::TooLarge { limit: ALWAYS_ALLOWED }));
        assert_eq!(
            unzip(&archive(&[("a.stp", &bomb)])),
            Err(CompressedError::TooLarge { limit: ALWAYS_ALLOWED })
        );
    }
}
