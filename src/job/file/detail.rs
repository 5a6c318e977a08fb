//! The words of `detail_transfer`.

use schemars::JsonSchema;
use serde::{Deserialize, de};

use crate::job::file::LengthSetting;
use crate::job::file::selector::{NamePattern, RECORD, Selector, typed};
use crate::model::Origin;
use crate::model::origin::ParseOriginError;
use crate::units::Length;

/// Carry the detail of one curve onto another.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DetailTransfer {
    /// The curve that gives detail.
    pub source: DetailSource,
    /// What is changed: a curve that belongs to no face, or a face.
    #[serde(default)]
    pub target: DetailTarget,
    /// Levels of detail, counted from the finest, which is 1: `"all"` or a list.
    #[serde(default)]
    pub levels: LevelsSetting,
    /// Gain: one number, or one for each level, finest first or in the order of `levels`.
    #[serde(default)]
    pub gain: GainSetting,
    /// Directions of the detail.
    #[serde(default)]
    pub frame: FrameWord,
    /// Factor on all detail, or `"arc_length"`: the ratio of the curves' lengths. Left out: `"arc_length"` in the
    /// local frame, 1 in the global one.
    #[serde(default)]
    pub scale: Option<DetailScale>,
    /// Part of the target, by its length from 0 to 1. Left out: all of it.
    #[serde(default)]
    pub interval: Option<Interval>,
    /// What stays at both ends of the part. Left out: the position where an open curve is changed as a whole, else
    /// the curvature.
    #[serde(default)]
    pub ends: Option<EndsWord>,
    /// What becomes of the target's own detail.
    #[serde(default)]
    pub existing: OwnDetailWord,
    /// Run the source the other way.
    #[serde(default)]
    pub reverse: bool,
    /// Angle in degrees about the target by which detail is turned, in the local frame.
    #[serde(default)]
    pub roll: f64,
    /// Greatest distance where a curve has to be approximated. Left out: a millionth of its size.
    #[serde(default)]
    pub tolerance: Option<LengthSetting>,
}

impl DetailTransfer {
    /// Refuses keys that contradict each other.
    pub(in crate::job) fn check(&self) -> Result<(), String> {
        if let (LevelsSetting::These(levels), GainSetting(gains)) = (&self.levels, &self.gain)
            && gains.len() != 1
            && gains.len() != levels.len()
        {
            return Err(format!("{} gains for {} levels", gains.len(), levels.len()));
        }
        if self.frame == FrameWord::Global && self.roll != 0.0 {
            return Err("`roll` turns about the target, which needs `frame = \"local\"`".to_owned());
        }
        if self.source.detail.is_some() && (self.source.file.is_some() || self.source.curve.is_some()) {
            return Err(
                "`detail` in `source` stands for a curve; `file` and `curve` do not go with it".to_owned()
            );
        }
        let target = &self.target;
        if target.curve.is_some() && target.face.is_some() {
            return Err("`target` has both a `curve` and a `face`; expected one of them".to_owned());
        }
        if target.face.is_none() && (target.direction.is_some() || target.across.is_some()) {
            return Err("`direction` and `across` are of a face; expected `face` in `target`".to_owned());
        }
        if target.face.is_some() && self.ends == Some(EndsWord::Free) {
            return Err("free ends would move the edges of the face; expected `position`, `tangent` or \
                        `curvature`"
                .to_owned());
        }
        if !self.roll.is_finite() {
            return Err(format!("`roll` is {}; expected degrees", self.roll));
        }
        if self.interval.is_some_and(|part| part.0 != [0.0, 1.0]) && self.ends == Some(EndsWord::Free) {
            return Err("a part of the target needs ends that are held; expected `position`, `tangent` or \
                        `curvature`"
                .to_owned());
        }
        if let Some(LengthSetting(Length::FileUnits(value) | Length::Metres(value))) = self.tolerance
            && !(value.is_finite() && value > 0.0)
        {
            return Err(format!("`tolerance` is {value}; expected a positive length"));
        }
        Ok(())
    }
}

/// Where detail comes from.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DetailSource {
    /// File of the source curve, relative to the job file. Left out: the part itself.
    pub file: Option<String>,
    /// The source curve, free or an edge's. Left out: the only free curve.
    pub curve: Option<CurveSelector>,
    /// Detail of a library, relative to the job file: written by `resurf feature detail`, it needs no part. No other
    /// key goes with it.
    pub detail: Option<String>,
}

/// Where detail goes.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DetailTarget {
    /// The target curve. Left out, and `face` too: the only free curve.
    pub curve: Option<CurveSelector>,
    /// A face that detail is laid over, instead of a curve; its edges stay.
    pub face: Option<Selector>,
    /// Direction of the face in which the source runs.
    pub direction: Option<DirectionWord>,
    /// Part of the face's other parameter that gets detail, from 0 to 1. Left out: all of it.
    pub across: Option<Interval>,
}

/// A direction of a surface's parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum DirectionWord {
    /// The first.
    #[default]
    U,
    /// The second.
    V,
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub enum CurveSelector {
    /// The curve of a record.
    Record(Origin),
    /// The free curve of a name, as a glob.
    Name(NamePattern),
}

/// Conditions on a curve.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct CurveConditions {
    /// Name of the free curve, or else of the set that holds it, as a glob: `"RIM*"`.
    name: NamePattern,
}

impl std::str::FromStr for CurveSelector {
    type Err = String;

    /// A selector as typed on a command line: `#1042` or `D57`, or a table as in a job file.
    fn from_str(text: &str) -> Result<Self, String> {
        typed(text, Self::Record)
    }
}

impl<'de> Deserialize<'de> for CurveSelector {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CurveVisitor;
        impl<'de> de::Visitor<'de> for CurveVisitor {
            type Value = CurveSelector;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a curve: \"#1042\", or a table such as { name = \"RIM\" }")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<CurveSelector, E> {
                text.parse().map(CurveSelector::Record).map_err(|error: ParseOriginError| E::custom(error))
            }
            fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<CurveSelector, A::Error> {
                let conditions = CurveConditions::deserialize(de::value::MapAccessDeserializer::new(map))?;
                Ok(CurveSelector::Name(conditions.name))
            }
        }
        deserializer.deserialize_any(CurveVisitor)
    }
}

impl JsonSchema for CurveSelector {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "CurveSelector".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let conditions = generator.subschema_for::<CurveConditions>();
        schemars::json_schema!({
            "description": "One curve: the name of a record, or a name.",
            "anyOf": [{ "type": "string", "pattern": RECORD }, conditions],
        })
    }
}

/// Levels of detail.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum LevelsSetting {
    /// All that the source has.
    #[default]
    All,
    /// These, from 1, the finest.
    These(Vec<usize>),
}

impl<'de> Deserialize<'de> for LevelsSetting {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LevelsVisitor;
        impl<'de> de::Visitor<'de> for LevelsVisitor {
            type Value = LevelsSetting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"all\", or a list of levels from 1, the finest")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<LevelsSetting, E> {
                if text == "all" {
                    return Ok(LevelsSetting::All);
                }
                Err(E::custom(format!(
                    "`{text}` are no levels; expected \"all\" or a list of numbers from 1"
                )))
            }
            fn visit_seq<A: de::SeqAccess<'de>>(self, items: A) -> Result<LevelsSetting, A::Error> {
                let levels = Vec::<usize>::deserialize(de::value::SeqAccessDeserializer::new(items))?;
                let distinct: std::collections::BTreeSet<usize> = levels.iter().copied().collect();
                if levels.is_empty() || distinct.len() != levels.len() || distinct.contains(&0) {
                    return Err(de::Error::custom(format!(
                        "{levels:?} are no levels; expected different numbers from 1, the finest"
                    )));
                }
                Ok(LevelsSetting::These(levels))
            }
        }
        deserializer.deserialize_any(LevelsVisitor)
    }
}

impl JsonSchema for LevelsSetting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Levels".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "All levels, or some, counted from the finest, which is 1.",
            "anyOf": [
                { "const": "all" },
                { "type": "array", "items": { "type": "integer", "minimum": 1 }, "minItems": 1, "uniqueItems": true },
            ],
        })
    }
}

/// Greatest gain and scale: beyond it detail has lost its digits.
const GREATEST_FACTOR: f64 = 1e6;

/// Gains: one for all levels, or one for each.
#[derive(Debug, Clone, PartialEq)]
pub struct GainSetting(pub Vec<f64>);

impl Default for GainSetting {
    fn default() -> Self {
        Self(vec![1.0])
    }
}

impl<'de> Deserialize<'de> for GainSetting {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct GainVisitor;
        impl<'de> de::Visitor<'de> for GainVisitor {
            type Value = GainSetting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a gain, or a list with one for each level")
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<GainSetting, E> {
                self.visit_f64(value as f64)
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<GainSetting, E> {
                checked(vec![value]).map_err(E::custom)
            }
            fn visit_seq<A: de::SeqAccess<'de>>(self, items: A) -> Result<GainSetting, A::Error> {
                let gains = Vec::<f64>::deserialize(de::value::SeqAccessDeserializer::new(items))?;
                checked(gains).map_err(de::Error::custom)
            }
        }
        fn checked(gains: Vec<f64>) -> Result<GainSetting, String> {
            if !gains.is_empty() && gains.iter().all(|gain| gain.abs() <= GREATEST_FACTOR) {
                return Ok(GainSetting(gains));
            }
            let gains: Vec<String> = gains.iter().map(|gain| format!("{gain:e}")).collect();
            Err(format!("[{}] are no gains; expected numbers up to {GREATEST_FACTOR}", gains.join(", ")))
        }
        deserializer.deserialize_any(GainVisitor)
    }
}

impl JsonSchema for GainSetting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Gain".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "A gain for all levels, or one for each.",
            "anyOf": [
                { "type": "number" },
                { "type": "array", "items": { "type": "number" }, "minItems": 1 },
            ],
        })
    }
}

/// Factor on all detail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DetailScale {
    /// The ratio of the lengths.
    ArcLength,
    /// A factor.
    Factor(f64),
}

impl<'de> Deserialize<'de> for DetailScale {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ScaleVisitor;
        impl de::Visitor<'_> for ScaleVisitor {
            type Value = DetailScale;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a factor, or \"arc_length\"")
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<DetailScale, E> {
                self.visit_f64(value as f64)
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<DetailScale, E> {
                if value.abs() <= GREATEST_FACTOR {
                    return Ok(DetailScale::Factor(value));
                }
                Err(E::custom(format!(
                    "{value:e} is not a factor; expected a number up to {GREATEST_FACTOR}"
                )))
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<DetailScale, E> {
                if text == "arc_length" {
                    return Ok(DetailScale::ArcLength);
                }
                Err(E::custom(format!("`{text}` is no scale; expected a factor or \"arc_length\"")))
            }
        }
        deserializer.deserialize_any(ScaleVisitor)
    }
}

impl JsonSchema for DetailScale {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "DetailScale".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "A factor, or the ratio of the lengths.",
            "anyOf": [{ "type": "number" }, { "const": "arc_length" }],
        })
    }
}

/// Part of a curve by its length.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "[f64; 2]")]
#[schemars(with = "[f64; 2]")]
pub struct Interval(pub [f64; 2]);

impl TryFrom<[f64; 2]> for Interval {
    type Error = String;
    fn try_from([from, to]: [f64; 2]) -> Result<Self, String> {
        if 0.0 <= from && from < to && to <= 1.0 {
            return Ok(Self([from, to]));
        }
        Err(format!(
            "[{from}, {to}] is no part of a curve; expected two numbers from 0 to 1, the lesser first"
        ))
    }
}

/// Directions of detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrameWord {
    /// Along the coarse curves.
    #[default]
    Local,
    /// As it stands.
    Global,
}

/// What stays at the ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EndsWord {
    /// Nothing.
    Free,
    /// The position.
    Position,
    /// Position and tangent.
    Tangent,
    /// Position, tangent and curvature.
    Curvature,
}

/// What becomes of the target's own detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OwnDetailWord {
    /// The new detail is added to it.
    #[default]
    Keep,
    /// It gives way.
    Replace,
}
