//! The job file's types: what may stand in one, key by key.
//!
//! Only keys of things that exist are here: an unknown key is refused, so a job never believes that
//! something happened which did not. The JSON Schema under `schemas/` is generated from these types.

pub mod deform;
pub mod detail;
pub mod paste;
pub mod reconstruct;
pub mod scale;
pub mod selector;
pub mod simplify;

use schemars::JsonSchema;
use serde::de;
use serde::{Deserialize, Serialize};

pub use crate::job::file::deform::Deform;
pub use crate::job::file::detail::DetailTransfer;
pub use crate::job::file::paste::FeaturePaste;
pub use crate::job::file::reconstruct::FeatureReconstruction;
pub use crate::job::file::scale::ConstrainedScale;
pub use crate::job::file::simplify::Simplify;
use crate::units::Length;

/// A job: parts, an operation or several, and where the results go.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "resurf job")]
pub struct Job {
    /// Version of the job format: 1.
    pub version: Version,
    /// Name of the job, for reports.
    #[serde(default)]
    pub name: String,
    /// Parts: paths or globs (`*`, `?`, `[a-z]`, `{a,b}`, `**`), relative to the job file. Each match is one part.
    #[serde(deserialize_with = "at_least_one")]
    #[schemars(length(min = 1))]
    pub inputs: Vec<String>,
    /// Where each result goes, relative to the job file; `{dir}`, `{stem}` and `{ext}` are those of the input.
    pub output: String,
    /// Side files beside the output: meshes for viewing and for OpenSCAD, and a sheet that proves what was held.
    #[serde(default)]
    pub also: Vec<SideFile>,
    /// Pictures beside the output, as PNG, of the faces that the operations changed.
    #[serde(default)]
    pub pictures: Vec<PictureKind>,
    /// Bounds on whatever must be approximated.
    #[serde(default)]
    pub tolerance: ToleranceSettings,
    /// Other programs that must accept the result.
    #[serde(default)]
    pub validate: ValidateSettings,
    /// Operations, each on what the ones before it made; none passes the parts through.
    #[serde(default)]
    pub operation: Vec<Operation>,
}

fn at_least_one<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    let inputs = Vec::<String>::deserialize(deserializer)?;
    if inputs.is_empty() { Err(de::Error::custom("a job needs an input")) } else { Ok(inputs) }
}

/// Version of the job format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(try_from = "u64")]
#[schemars(with = "u64", extend("const" = 1))]
pub struct Version;

impl TryFrom<u64> for Version {
    type Error = String;
    fn try_from(version: u64) -> Result<Self, String> {
        if version == 1 {
            Ok(Self)
        } else {
            Err(format!("version {version} is not known; this program reads version 1"))
        }
    }
}

/// A file beside the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SideFile {
    /// Binary STL.
    Stl,
    /// OFF with shared vertices.
    Off,
    /// 3MF with names and colours.
    #[serde(rename = "3mf")]
    ThreeMf,
    /// Binary glTF with names and colours.
    Glb,
    /// A sheet of what was held, which `resurf verify` checks.
    Proof,
}

impl SideFile {
    /// What stands behind the stem of its name.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::Off => "off",
            Self::ThreeMf => "3mf",
            Self::Glb => "glb",
            Self::Proof => "proof.json",
        }
    }

    /// The format of a mesh; `None` for what is none.
    #[must_use]
    pub fn mesh(self) -> Option<SideFormat> {
        match self {
            Self::Stl => Some(SideFormat::Stl),
            Self::Off => Some(SideFormat::Off),
            Self::ThreeMf => Some(SideFormat::ThreeMf),
            Self::Glb => Some(SideFormat::Glb),
            Self::Proof => None,
        }
    }
}

/// A format of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SideFormat {
    /// Binary STL.
    Stl,
    /// STL as text.
    StlText,
    /// OFF with shared vertices.
    Off,
    /// 3MF with names and colours.
    ThreeMf,
    /// Binary glTF with names and colours.
    Glb,
}

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize, serde::Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PictureKind {
    /// Highlight lines before and after.
    Highlight,
    /// Mean curvature before and after: red where the face bulges outwards.
    Curvature,
    /// Deviation of the new faces from the old: red outwards.
    Deviation,
}

impl PictureKind {
    /// The word of the job file, and of the file's name.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Highlight => "highlight",
            Self::Curvature => "curvature",
            Self::Deviation => "deviation",
        }
    }
}

/// Bounds on approximation.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ToleranceSettings {
    /// Greatest distance between a side mesh and its part: positive, and at most the part's diagonal. Left out:
    /// a thousandth of it.
    #[serde(deserialize_with = "positive_length")]
    pub length: Option<LengthSetting>,
}

pub(in crate::job) fn positive_length<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<LengthSetting>, D::Error> {
    let length = Option::<LengthSetting>::deserialize(deserializer)?;
    match length.map(|length| length.0) {
        Some(Length::FileUnits(value) | Length::Metres(value)) if !(value.is_finite() && value > 0.0) => {
            Err(de::Error::custom(format!("{value} is not a tolerance; expected a positive length")))
        }
        _ => Ok(length),
    }
}

/// A length: a number in file units, or a text with a unit such as `"0.5 mm"`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthSetting(pub Length);

impl<'de> Deserialize<'de> for LengthSetting {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LengthVisitor;
        impl de::Visitor<'_> for LengthVisitor {
            type Value = LengthSetting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number in file units, or a text with a unit such as \"0.5 mm\"")
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<LengthSetting, E> {
                self.visit_f64(value as f64)
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<LengthSetting, E> {
                if value.is_finite() {
                    return Ok(LengthSetting(Length::FileUnits(value)));
                }
                Err(E::custom(format!("{value} is not a length")))
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<LengthSetting, E> {
                text.parse().map(LengthSetting).map_err(E::custom)
            }
        }
        deserializer.deserialize_any(LengthVisitor)
    }
}

impl JsonSchema for LengthSetting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Length".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "A number in file units, or a text with a unit: um, mm, cm, dm, m, in, inch, ft.",
            "type": ["number", "string"],
        })
    }
}

/// Other programs that are asked about the written files.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ValidateSettings {
    /// Programs that are asked.
    pub with: Vec<ValidatorName>,
    /// Whether a missing program fails the part. Left out: false, and the report says that nobody was asked.
    pub require: bool,
    /// Seconds after which a program is stopped. Left out: 300.
    pub timeout: Option<Seconds>,
}

/// A positive number of seconds.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "f64")]
#[schemars(with = "f64")]
pub struct Seconds(pub f64);

/// A day: nobody waits longer for a verdict.
const GREATEST_SECONDS: f64 = 86_400.0;

impl TryFrom<f64> for Seconds {
    type Error = String;
    fn try_from(seconds: f64) -> Result<Self, String> {
        if seconds > 0.0 && seconds <= GREATEST_SECONDS {
            return Ok(Self(seconds));
        }
        Err(format!("{seconds} is not a time between 0 and {GREATEST_SECONDS} seconds"))
    }
}

/// A program that can be asked.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema, clap::ValueEnum,
)]
#[serde(rename_all = "lowercase")]
#[value(rename_all = "lowercase")]
pub enum ValidatorName {
    /// FreeCAD opens the STEP file.
    FreeCad,
    /// OpenSCAD does a Boolean operation on the side mesh of a solid.
    OpenScad,
}

/// One operation.
#[derive(Debug, Clone, PartialEq, JsonSchema)]
#[schemars(tag = "kind", rename_all = "snake_case")]
pub enum Operation {
    /// Scale a part, while chosen features keep their shape and size.
    ConstrainedScale(Box<ConstrainedScale>),
    /// Pull lines on a face to given curves.
    Deform(Box<Deform>),
    /// Carry the detail of one curve onto another.
    DetailTransfer(Box<DetailTransfer>),
    /// Carry a freeform feature from one face onto another.
    FeaturePaste(Box<FeaturePaste>),
    /// Rebuild a feature from scanned points.
    FeatureReconstruction(Box<FeatureReconstruction>),
    /// Remove knots of a face that it can do without.
    Simplify(Simplify),
}

impl Operation {
    /// The word of the job file.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::ConstrainedScale(_) => "constrained_scale",
            Self::Deform(_) => "deform",
            Self::DetailTransfer(_) => "detail_transfer",
            Self::FeaturePaste(_) => "feature_paste",
            Self::FeatureReconstruction(_) => "feature_reconstruction",
            Self::Simplify(_) => "simplify",
        }
    }

    /// By how much the operation stretches a distance at most; at least 1, since what it leaves alone stays.
    #[must_use]
    pub fn growth(&self) -> f64 {
        match self {
            Self::ConstrainedScale(scale) => scale.factors.0.into_iter().fold(1.0, f64::max),
            Self::Deform(_)
            | Self::FeaturePaste(_)
            | Self::FeatureReconstruction(_)
            | Self::DetailTransfer(_)
            | Self::Simplify(_) => 1.0,
        }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum OperationKind {
    ConstrainedScale,
    Deform,
    DetailTransfer,
    FeaturePaste,
    FeatureReconstruction,
    Simplify,
}

impl<'de> Deserialize<'de> for Operation {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OperationVisitor;
        impl<'de> de::Visitor<'de> for OperationVisitor {
            type Value = Operation;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a table with the key `kind`")
            }
            fn visit_map<A: de::MapAccess<'de>>(self, mut map: A) -> Result<Operation, A::Error> {
                // Tables give `kind` first, see `node`.
                match map.next_key::<String>()?.as_deref() {
                    Some("kind") => {}
                    _ => return Err(de::Error::missing_field("kind")),
                }
                let kind: OperationKind = map.next_value()?;
                let rest = de::value::MapAccessDeserializer::new(map);
                match kind {
                    OperationKind::ConstrainedScale => {
                        let scale = ConstrainedScale::deserialize(rest)?;
                        scale.check().map_err(de::Error::custom)?;
                        Ok(Operation::ConstrainedScale(Box::new(scale)))
                    }
                    OperationKind::Deform => {
                        let deform = Deform::deserialize(rest)?;
                        deform.check().map_err(de::Error::custom)?;
                        Ok(Operation::Deform(Box::new(deform)))
                    }
                    OperationKind::DetailTransfer => {
                        let transfer = DetailTransfer::deserialize(rest)?;
                        transfer.check().map_err(de::Error::custom)?;
                        Ok(Operation::DetailTransfer(Box::new(transfer)))
                    }
                    OperationKind::FeaturePaste => {
                        let paste = FeaturePaste::deserialize(rest)?;
                        paste.check().map_err(de::Error::custom)?;
                        Ok(Operation::FeaturePaste(Box::new(paste)))
                    }
                    OperationKind::FeatureReconstruction => {
                        let words = FeatureReconstruction::deserialize(rest)?;
                        words.check().map_err(de::Error::custom)?;
                        Ok(Operation::FeatureReconstruction(Box::new(words)))
                    }
                    OperationKind::Simplify => {
                        Simplify::deserialize(rest)?.operation().map_err(de::Error::custom)
                    }
                }
            }
        }
        deserializer.deserialize_map(OperationVisitor)
    }
}
