//! The proof sheet: what a run claims of the entities that it held, so that others can check it against the two files.
//!
//! `docs/proof-sheet.md` lays down the format. A sheet is written from what the operations planned, and checked by reading
//! the two files as text: [`verify`] asks neither the reader of models nor any operation.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::digest::{Digest, sha256};
use crate::document::{CopyResiduals, Document, ProofError};
use crate::job::failure::PartError;
use crate::job::part::Read;
use crate::math::{Affine, Matrix3, Vector3};
use crate::model::Origin;

/// What a run claims of one part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "resurf proof sheet")]
pub struct ProofSheet {
    /// Version of the format: 1.
    pub version: u32,
    /// Program that wrote the sheet.
    pub program: String,
    /// The file before.
    pub before: FileClaim,
    /// The file after.
    pub after: FileClaim,
    /// Entities that were held, by their common motion.
    pub groups: Vec<GroupClaim>,
}

/// Which file a sheet is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FileClaim {
    /// Its name, for people.
    pub name: String,
    /// SHA-256 of its bytes, of those inside where it is compressed.
    pub sha256: String,
}

/// Entities with one rigid motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroupClaim {
    /// The motion `x -> M x + t`.
    pub motion: MotionClaim,
    /// The entities.
    pub entities: Vec<EntityClaim>,
}

/// A rigid motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MotionClaim {
    /// The rows of `M`.
    pub matrix: [[f64; 3]; 3],
    /// `t`, in file units.
    pub translation: [f64; 3],
}

/// A held entity.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EntityClaim {
    /// Its record, which has the same name in both files: `#12`.
    pub record: String,
    /// Digest of the record before.
    pub before: String,
    /// Digest of the record after; the same where nothing moved.
    pub after: String,
}

/// Entities that an operation held.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// Their motion.
    pub motion: Affine,
    /// Their records.
    pub records: Vec<Origin>,
}

impl From<&Affine> for MotionClaim {
    fn from(map: &Affine) -> Self {
        let row = |k: usize| [0, 1, 2].map(|j| map.linear[(k, j)]);
        Self { matrix: [row(0), row(1), row(2)], translation: map.translation.into() }
    }
}

impl From<MotionClaim> for Affine {
    fn from(claim: MotionClaim) -> Self {
        let linear = Matrix3::from_fn(|i, j| claim.matrix[i][j]);
        Self { linear, translation: Vector3::from(claim.translation) }
    }
}

/// Writes the sheet of a part.
///
/// # Errors
/// A record that has no digest.
pub fn sheet(
    program: &str,
    before: (&Path, &Document),
    after: (&Path, &Document),
    held: &[Held],
) -> Result<ProofSheet, ProofError> {
    let claim = |(path, document): (&Path, &Document)| FileClaim {
        name: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        sha256: sha256(document.source().bytes()).to_string(),
    };
    let (mut old, mut new) = (before.1.digests()?, after.1.digests()?);
    let mut groups = Vec::with_capacity(held.len());
    for group in held {
        let mut entities = Vec::with_capacity(group.records.len());
        for &record in &group.records {
            let (before, after) = (old.of(record)?.to_string(), new.of(record)?.to_string());
            entities.push(EntityClaim { record: record.to_string(), before, after });
        }
        groups.push(GroupClaim { motion: (&group.motion).into(), entities });
    }
    Ok(ProofSheet {
        version: 1,
        program: program.to_owned(),
        before: claim(before),
        after: claim(after),
        groups,
    })
}

/// What the check of a sheet found.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Verification {
    /// What does not hold; empty when the sheet is proved.
    pub faults: Vec<String>,
    /// Entities that were looked at.
    pub entities: usize,
    /// Of these, those that are the same to the bit.
    pub unmoved: usize,
    /// How far each group is from being a rigid copy, in the order of the sheet.
    pub groups: Vec<GroupVerification>,
}

/// How far a group is from being a rigid copy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GroupVerification {
    /// Points that were compared.
    pub points: usize,
    /// Greatest deviation of a point from its moved place, relative to the extent of the points.
    pub motion: f64,
    /// Greatest deviation of a distance between two points, relative to the extent.
    pub distances: f64,
    /// Pairs of points behind that.
    pub pairs: usize,
    /// Greatest deviation of an axis or direction.
    pub directions: f64,
}

impl Verification {
    /// Whether all claims hold, and there is one.
    #[must_use]
    pub fn is_proved(&self) -> bool {
        self.faults.is_empty() && self.entities > 0
    }

    fn fault(&mut self, text: String) {
        // Whatever is wrong with a thousand entities is said of the first hundred.
        if self.faults.len() < FAULTS {
            self.faults.push(text);
        }
    }
}

/// Faults that are listed at most.
const FAULTS: usize = 100;

/// Checks a sheet against the two files.
#[must_use]
pub fn verify(sheet: &ProofSheet, before: &Document, after: &Document) -> Verification {
    let mut found = Verification::default();
    if sheet.version != 1 {
        found.fault(format!("version {} of the sheet is not known", sheet.version));
        return found;
    }
    for (claim, document) in [(&sheet.before, before), (&sheet.after, after)] {
        let digest = sha256(document.source().bytes()).to_string();
        if digest != claim.sha256 {
            found.fault(format!("{}: SHA-256 is {digest}, the sheet says {}", claim.name, claim.sha256));
        }
    }
    for group in &sheet.groups {
        verify_group(group, before, after, &mut found);
    }
    if found.entities == 0 {
        found.fault("the sheet claims nothing".to_owned());
    }
    found
}

fn verify_group(group: &GroupClaim, before: &Document, after: &Document, found: &mut Verification) {
    let compared = || Ok::<_, ProofError>((before.digests()?, after.digests()?, before.rigid_copy(after)?));
    let (mut old, mut new, mut copy) = match compared() {
        Ok(compared) => compared,
        Err(error) => return found.fault(error.to_string()),
    };
    let motion = Affine::from(group.motion);
    for entity in &group.entities {
        found.entities += 1;
        let Ok(record) = entity.record.parse::<Origin>() else {
            found.fault(format!("{}: is no name of a record", entity.record));
            continue;
        };
        let mut check = |file: &str, claimed: &str, digest: Result<Digest, ProofError>| match digest {
            Ok(digest) if digest.to_string() == claimed => {}
            Ok(digest) => {
                found
                    .fault(format!("{}: digest {file} is {digest}, the sheet says {claimed}", entity.record));
            }
            Err(error) => found.fault(format!("{}: {file}: {error}", entity.record)),
        };
        check("before", &entity.before, old.of(record));
        check("after", &entity.after, new.of(record));
        if entity.before == entity.after {
            found.unmoved += 1;
        } else if motion.is_identity() {
            found.fault(format!("{}: is claimed to stay, and its digests differ", entity.record));
        }
        if let Err(error) = copy.add(record, record) {
            found.fault(format!("{}: {error}", entity.record));
        }
    }
    let residuals = copy.residuals(&motion);
    if !residuals.are_accepted() {
        found.fault(format!("a group is no rigid copy by the stated motion: {residuals:?}"));
    }
    let CopyResiduals { points, motion, distances, pairs, directions, .. } = residuals;
    found.groups.push(GroupVerification { points, motion, distances, pairs, directions });
}

/// Reads a sheet.
///
/// # Errors
/// What is wrong with it, with line and column.
pub fn read(text: &str) -> Result<ProofSheet, String> {
    serde_json::from_str(text).map_err(|error| error.to_string())
}

/// Reads a file of a sheet; what it means is not asked.
///
/// # Errors
/// [`PartError`] of a file that cannot be read.
pub fn document(path: &Path) -> Result<Document, PartError> {
    let read = Read::file(path)?;
    read.refuse_damage()?;
    Ok(read.document)
}
