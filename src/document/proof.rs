//! Digests and rigid copies of records, for the formats that have them: STEP alone.

use super::Document;
use crate::digest::Digest;
use crate::math::Affine;
use crate::model::Origin;
use crate::step::InstanceName;
use crate::step::proof;
pub use crate::step::proof::Residuals as CopyResiduals;

/// Why records cannot be compared, or how they differ.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProofError {
    /// By the reader of STEP records.
    #[error(transparent)]
    Step(#[from] proof::ProofError),
    /// No record of a STEP file.
    #[error("{0} is no record of a STEP file, and others cannot be proved")]
    Foreign(Origin),
}

/// Digests of the records of one file.
pub struct Digests<'a>(proof::Digests<'a>);

/// Records of two files under comparison.
pub struct RigidCopy<'a>(proof::RigidCopy<'a>);

impl Document {
    /// Digests of the records of this file.
    #[must_use]
    pub fn digests(&self) -> Digests<'_> {
        Digests(proof::Digests::new(&self.structure))
    }

    /// A comparison of records of this file with such of another.
    #[must_use]
    pub fn rigid_copy<'a>(&'a self, after: &'a Self) -> RigidCopy<'a> {
        RigidCopy(proof::RigidCopy::new(&self.structure, &after.structure))
    }
}

fn name(origin: Origin) -> Result<InstanceName, ProofError> {
    match origin {
        Origin::Instance(name) => Ok(InstanceName(name)),
        Origin::DirectoryEntry(_) => Err(ProofError::Foreign(origin)),
    }
}

impl Digests<'_> {
    /// The digest of a record with all that it refers to.
    ///
    /// # Errors
    /// [`ProofError`].
    pub fn of(&mut self, origin: Origin) -> Result<Digest, ProofError> {
        Ok(self.0.of(name(origin)?)?)
    }
}

impl RigidCopy<'_> {
    /// Compares two records and what they refer to.
    ///
    /// # Errors
    /// [`ProofError`].
    pub fn add(&mut self, before: Origin, after: Origin) -> Result<(), ProofError> {
        Ok(self.0.add(name(before)?, name(after)?)?)
    }

    /// How far what was compared is from being carried by a motion.
    #[must_use]
    pub fn residuals(&self, motion: &Affine) -> CopyResiduals {
        self.0.residuals(motion)
    }
}
