//! Columns of a cloud's records: which are the coordinates, which is the label, and how wide each is in binary.

use super::point_cloud::LabelColumn;
use super::{CloudError, words::shown};

/// Type of a binary number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

impl Scalar {
    /// Bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number in the first bytes, of which there must be enough.
    pub fn read(self, bytes: &[u8], endian: Endian) -> f64 {
        macro_rules! number {
            ($kind:ty) => {{
                let mut raw = [0; size_of::<$kind>()];
                raw.copy_from_slice(&bytes[..size_of::<$kind>()]);
                match endian {
                    Endian::Little => <$kind>::from_le_bytes(raw),
                    Endian::Big => <$kind>::from_be_bytes(raw),
                }
            }};
        }
        match self {
            Self::I8 => f64::from(number!(i8)),
            Self::U8 => f64::from(number!(u8)),
            Self::I16 => f64::from(number!(i16)),
            Self::U16 => f64::from(number!(u16)),
            Self::I32 => f64::from(number!(i32)),
            Self::U32 => f64::from(number!(u32)),
            Self::I64 => number!(i64) as f64,
            Self::U64 => number!(u64) as f64,
            Self::F32 => f64::from(number!(f32)),
            Self::F64 => number!(f64),
        }
    }
}

/// Positions of the columns that are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Columns {
    pub coordinates: [usize; 3],
    pub label: Option<usize>,
}

impl Columns {
    /// Finds the columns among names.
    ///
    /// # Errors
    /// [`CloudError::Header`] without coordinates, [`CloudError::NoColumn`].
    pub fn of(
        format: &'static str,
        line: usize,
        names: &[String],
        wanted: Option<&LabelColumn>,
    ) -> Result<Self, CloudError> {
        let position = |name: &str| names.iter().position(|n| n.eq_ignore_ascii_case(name));
        let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(position) else {
            let reason = format!("no columns x, y and z among {}", shown(names.join(", ").as_bytes()));
            return Err(CloudError::Header { format, line, reason });
        };
        let label = wanted.map(|wanted| label(format, names, wanted)).transpose()?;
        Ok(Self { coordinates: [x, y, z], label })
    }

    /// The last column that is wanted.
    pub fn last(&self) -> usize {
        let [x, y, z] = self.coordinates;
        x.max(y).max(z).max(self.label.unwrap_or(0))
    }
}

/// Position of the label among named columns.
pub(super) fn label(
    format: &'static str,
    names: &[String],
    wanted: &LabelColumn,
) -> Result<usize, CloudError> {
    let plain = |name: &str| {
        let lower = name.to_ascii_lowercase();
        lower.strip_prefix("scalar_").map_or(lower.clone(), str::to_owned)
    };
    let found = match wanted {
        LabelColumn::Named(name) => names.iter().position(|n| plain(n) == plain(name)),
        LabelColumn::Numbered(number) => number.checked_sub(1).filter(|k| *k < names.len()),
    };
    found.ok_or_else(|| {
        let name = match wanted {
            LabelColumn::Named(name) => name.clone(),
            LabelColumn::Numbered(number) => number.to_string(),
        };
        CloudError::NoColumn { format, name, known: names.to_vec() }
    })
}
