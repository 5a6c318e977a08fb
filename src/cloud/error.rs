//! Why a file is no cloud that can be used.

/// A cloud could not be read, or is of no use.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CloudError {
    /// The header does not say what the format wants said.
    #[error("{format} header, line {line}: {reason}")]
    Header {
        /// Name of the format.
        format: &'static str,
        /// Line, from 1.
        line: usize,
        /// Lower-case fragment.
        reason: String,
    },
    /// A line of text or a binary record that is no point.
    #[error("{format}, {place}: {reason}")]
    Row {
        /// Name of the format.
        format: &'static str,
        /// `line 12`, `point 12`.
        place: String,
        /// Lower-case fragment.
        reason: String,
    },
    /// The file ends before the points that its header promises.
    #[error("{format}: the header promises {expected} points, and the file ends after {found}")]
    Truncated {
        /// Name of the format.
        format: &'static str,
        /// Count that the header gives.
        expected: u64,
        /// Whole points in the file.
        found: u64,
    },
    /// A coordinate is NaN or infinite where the format has no such points.
    #[error("{format}, {place}: a coordinate is not a finite number")]
    NotFinite {
        /// Name of the format.
        format: &'static str,
        /// `line 12`, `point 12`.
        place: String,
    },
    /// More points than can be counted or than the file can hold.
    #[error("{format}: {count} points are more than {limit}, the most that {why}")]
    TooMany {
        /// Name of the format.
        format: &'static str,
        /// Count found.
        count: u64,
        /// Greatest count.
        limit: u64,
        /// Lower-case fragment: `a file of 120 bytes can hold`.
        why: String,
    },
    /// The column of labels is not there.
    #[error("{format}: no column `{name}` for labels; there are {}", list(.known))]
    NoColumn {
        /// Name of the format.
        format: &'static str,
        /// Name or number asked for.
        name: String,
        /// Names of the columns.
        known: Vec<String>,
    },
    /// A label that is no whole number.
    #[error("{format}, {place}: the label {value} is not a whole number")]
    Label {
        /// Name of the format.
        format: &'static str,
        /// `line 12`, `point 12`.
        place: String,
        /// Value found.
        value: f64,
    },
    /// No point is in the file.
    #[error("the cloud is empty")]
    Empty,
}

impl CloudError {
    /// The stable code, `area.what-is-wrong`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Header { .. } => "cloud.header",
            Self::Row { .. } => "cloud.row",
            Self::Truncated { .. } => "cloud.truncated",
            Self::NotFinite { .. } => "cloud.not-finite",
            Self::TooMany { .. } => "cloud.too-many-points",
            Self::NoColumn { .. } => "cloud.no-label-column",
            Self::Label { .. } => "cloud.label",
            Self::Empty => "cloud.empty",
        }
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
