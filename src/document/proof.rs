//! Digests and rigid copies of records, for the formats that have them: STEP alone.

use super::{Document, Structure};
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
    /// No STEP file.
    #[error("records of an {0} file cannot be proved, only those of STEP files")]
    Format(&'static str),
}

/// Digests of the records of one file.
pub struct Digests<'a>(proof::Digests<'a>);

/// Records of two files under comparison.
pub struct RigidCopy<'a>(proof::RigidCopy<'a>);

impl Document {
    /// Digests of the records of this file.
    ///
    /// # Errors
    /// [`ProofError::Format`] for a file that is not STEP.
    pub fn digests(&self) -> Result<Digests<'_>, ProofError> {
        Ok(Digests(proof::Digests::new(self.provable()?)))
    }

    /// A comparison of records of this file with such of another.
    ///
    /// # Errors
    /// [`ProofError::Format`] unless both files are STEP.
    pub fn rigid_copy<'a>(&'a self, after: &'a Self) -> Result<RigidCopy<'a>, ProofError> {
        Ok(RigidCopy(proof::RigidCopy::new(self.provable()?, after.provable()?)))
    }

    fn provable(&self) -> Result<&crate::step::ExchangeStructure, ProofError> {
        match &self.structure {
            Structure::Step(structure) => Ok(structure),
            Structure::Iges(_) => Err(ProofError::Format(self.format().as_str())),
        }
    }
}

fn name(origin: Origin) -> Result<InstanceName, ProofError> {
    match origin {
        Origin::Instance(name) => Ok(InstanceName(name)),
        Origin::DirectoryEntry(_) | Origin::Member { .. } | Origin::File => Err(ProofError::Foreign(origin)),
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
