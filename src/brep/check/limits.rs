//! What distances count: the file's uncertainty, and how far modellers let an edge go before they refuse it.

use crate::diagnostic::Severity;

/// Distances for one body, in file units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    /// Beyond it a fact is violated: the file's uncertainty.
    pub(super) tolerance: f64,
    /// Up to it other programs take a gap for the edge's own tolerance.
    pub(super) slight: f64,
}

/// Part of a body's size that its numbers resolve: the digits that exporters print. An uncertainty below says
/// nothing.
const DIGITS: f64 = 1e-10;
/// Part of a body's size up to which a gap is slight. Exported solids that Open CASCADE calls valid, and that others
/// made, have gaps of some millionths of their size, whatever uncertainty they state.
const SLIGHT: f64 = 1e-4;
/// Uncertainties up to which a gap is slight.
const SLIGHT_TOLERANCES: f64 = 2.0;

impl Limits {
    /// For a body of an extent in a file of an uncertainty.
    pub(super) fn new(uncertainty: f64, extent: f64) -> Self {
        let tolerance = uncertainty.max(DIGITS * extent);
        Self { tolerance, slight: (SLIGHT_TOLERANCES * tolerance).max(SLIGHT * extent) }
    }

    /// How grave a gap is.
    pub(super) fn severity(&self, distance: f64) -> Severity {
        if distance <= self.slight { Severity::Warning } else { Severity::Error }
    }
}
