//! The job file's words for `kind = "feature_paste"`.

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::{self, Deserializer};

use crate::job::file::LengthSetting;
use crate::job::file::selector::Selector;
use crate::model::Origin;
use crate::model::origin::ParseOriginError;
use crate::units::{Angle, Length};

/// Carry a freeform feature from one face onto another, changing nothing outside the feature.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeaturePaste {
    /// Where the feature comes from.
    pub source: PasteSource,
    /// Where it goes.
    pub target: PasteTarget,
    /// How it is carried. Left out: `displacement`, or `fit` where the feature is turned or mirrored.
    #[serde(default)]
    pub method: Option<PasteMethod>,
    /// Factor, or factors along `u`, along `v` and along the normal. A negative last one turns a bump into a dent.
    #[serde(default)]
    pub scale: Scale,
    /// Angle in the surface, about its normal.
    #[serde(default)]
    pub rotate: AngleSetting,
    /// Mirror before turning.
    #[serde(default)]
    pub mirror: MirrorWord,
    /// What becomes of detail that the target has there already.
    #[serde(default)]
    pub existing: ExistingWord,
    /// Which control points count as the feature's.
    #[serde(default)]
    pub rule: RuleWord,
    /// How gradients turn from source to target.
    #[serde(default)]
    pub turn: TurnWord,
    /// Weights of the Laplacian of `poisson` and `biharmonic`.
    #[serde(default)]
    pub edge_weights: EdgeWeightsWord,
    /// Rows and columns at the border of the target's net that stay: 1 keeps the border, 2 its tangents too.
    #[serde(default)]
    pub margin: Margin,
    /// What to do when the feature meets a loop of the target.
    #[serde(default)]
    pub loops: LoopsWord,
    /// What to do with loops of the source inside the region.
    #[serde(default)]
    pub holes: HolesWord,
    /// Greatest deviation of a fit. Left out: a fifty-thousandth of the feature's size.
    #[serde(default)]
    pub tolerance: Option<LengthSetting>,
}

/// Where a feature comes from.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PasteSource {
    /// File of the source face, relative to the job file. Left out: the part itself.
    #[serde(default)]
    pub file: Option<String>,
    /// Feature of a library, relative to the job file: written by `resurf feature export`, it needs no part. No
    /// other key goes with it.
    #[serde(default)]
    pub feature: Option<String>,
    /// The source face. Left out: the only one.
    #[serde(default)]
    pub face: Option<Selector>,
    /// What holds the feature. Left out: the face's outer loop.
    #[serde(default)]
    pub region: RegionSetting,
    /// Point of the source that goes to `at` of the target. Left out: the middle of the region.
    #[serde(default)]
    pub at: Option<[LengthSetting; 3]>,
}

/// Where a feature goes.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PasteTarget {
    /// The target face. Left out: the only one.
    #[serde(default)]
    pub face: Option<Selector>,
    /// The place, a point on the face.
    #[serde(default)]
    pub at: Option<[LengthSetting; 3]>,
    /// More places, or several instead of `at`.
    #[serde(default)]
    pub places: Vec<PlaceSetting>,
    /// Repeats `at` in a row or a ring.
    #[serde(default)]
    pub pattern: Option<Pattern>,
    /// Direction of the feature's `u` in space. Left out: that of the target's own `u`.
    #[serde(default)]
    pub along: Option<[f64; 3]>,
}

/// One place of a list.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceSetting {
    /// A point on the target face.
    pub at: [LengthSetting; 3],
    /// Further angle there.
    #[serde(default)]
    pub rotate: AngleSetting,
    /// Mirror there, instead of the operation's.
    #[serde(default)]
    pub mirror: Option<MirrorWord>,
    /// Scale there, instead of the operation's.
    #[serde(default)]
    pub scale: Option<Scale>,
}

/// Repetition of one place: exactly one key.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "PatternKeys")]
#[schemars(with = "PatternKeys")]
pub enum Pattern {
    /// In a row.
    Linear(Linear),
    /// In a ring.
    Circular(Circular),
}

/// Places in a row.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Linear {
    /// From one place to the next.
    pub step: [LengthSetting; 3],
    /// Count of places, the first included.
    pub count: Count,
}

/// Places in a ring; the feature turns with them.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Circular {
    /// A point of the axis.
    pub point: [LengthSetting; 3],
    /// Direction of the axis.
    pub direction: [f64; 3],
    /// Count of places, the first included.
    pub count: Count,
    /// Angle over which they are spread. Left out: a full turn.
    #[serde(default = "full_turn")]
    pub angle: AngleSetting,
}

fn full_turn() -> AngleSetting {
    AngleSetting(std::f64::consts::TAU)
}

/// A count of places, 1 to 10,000.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(try_from = "u64")]
#[schemars(with = "u64", extend("minimum" = 1, "maximum" = MOST_PLACES))]
pub struct Count(pub usize);

/// Places of one operation: each refines the net, so that more would not fit into a file.
const MOST_PLACES: u64 = 10_000;

impl TryFrom<u64> for Count {
    type Error = String;
    fn try_from(count: u64) -> Result<Self, String> {
        if (1..=MOST_PLACES).contains(&count) {
            return Ok(Self(count as usize));
        }
        Err(format!("{count} is not a count of places; expected 1 to {MOST_PLACES}"))
    }
}

#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(rename = "Pattern", extend("minProperties" = 1, "maxProperties" = 1))]
struct PatternKeys {
    /// In a row.
    linear: Option<Linear>,
    /// In a ring.
    circular: Option<Circular>,
}

impl TryFrom<PatternKeys> for Pattern {
    type Error = &'static str;
    fn try_from(keys: PatternKeys) -> Result<Self, &'static str> {
        match (keys.linear, keys.circular) {
            (Some(linear), None) => Ok(Self::Linear(linear)),
            (None, Some(circular)) => Ok(Self::Circular(circular)),
            _ => Err("expected exactly one of the keys `linear`, `circular`"),
        }
    }
}

/// What holds the feature on its face: exactly one key, besides `plane`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "RegionKeys")]
#[schemars(with = "RegionKeys")]
pub enum RegionSetting {
    /// The face's outer loop.
    #[default]
    Outer,
    /// An inner loop by its number.
    Inner(usize),
    /// A polygon in the parameters of the surface.
    Polygon(Vec<[f64; 2]>),
    /// A polyline in space.
    Contour(Vec<[LengthSetting; 3]>, Option<PlaneSetting>),
    /// A closed curve of the file.
    Curve(Origin, Option<PlaneSetting>),
}

/// A reference plane.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneSetting {
    /// A point of it.
    pub point: [LengthSetting; 3],
    /// Its normal.
    pub direction: [f64; 3],
}

#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(rename = "Region")]
struct RegionKeys {
    /// A loop of the face: `"outer"`, or the number of an inner one, counted from 0.
    r#loop: Option<LoopWord>,
    /// A closed polygon in the parameters of the surface.
    polygon: Option<Vec<[f64; 2]>>,
    /// A closed polyline in space, which goes onto the surface along the normal of `plane`.
    contour: Option<Vec<[LengthSetting; 3]>>,
    /// A closed curve of the source's file by its record, which goes onto the surface likewise.
    curve: Option<String>,
    /// Reference plane. Left out: that of the contour itself.
    plane: Option<PlaneSetting>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
enum LoopWord {
    /// An inner loop.
    Inner(usize),
    /// The outer loop.
    Outer(OuterWord),
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum OuterWord {
    Outer,
}

impl TryFrom<RegionKeys> for RegionSetting {
    type Error = String;
    fn try_from(keys: RegionKeys) -> Result<Self, String> {
        match keys {
            RegionKeys { r#loop: Some(word), polygon: None, contour: None, curve: None, plane: None } => {
                Ok(match word {
                    LoopWord::Inner(number) => Self::Inner(number),
                    LoopWord::Outer(OuterWord::Outer) => Self::Outer,
                })
            }
            RegionKeys { r#loop: None, polygon: Some(points), contour: None, curve: None, plane: None } => {
                enough(points.len()).map(|()| Self::Polygon(points))
            }
            RegionKeys { r#loop: None, polygon: None, contour: Some(points), curve: None, plane } => {
                enough(points.len()).map(|()| Self::Contour(points, plane))
            }
            RegionKeys { r#loop: None, polygon: None, contour: None, curve: Some(curve), plane } => {
                let record = curve.parse().map_err(|error: ParseOriginError| error.to_string())?;
                Ok(Self::Curve(record, plane))
            }
            _ => Err(
                "expected exactly one of the keys `loop`, `polygon`, `contour`, `curve`; `plane` goes with \
                      `contour` and `curve`"
                    .to_owned(),
            ),
        }
    }
}

impl std::str::FromStr for RegionSetting {
    type Err = String;

    /// A region as typed on a command line: a table as in a job file.
    fn from_str(text: &str) -> Result<Self, String> {
        crate::job::text::read_value(text).map_err(|e| e.to_string())
    }
}

fn enough(points: usize) -> Result<(), String> {
    if points >= 3 { Ok(()) } else { Err(format!("{points} points enclose nothing; expected 3 or more")) }
}

/// Factors along `u`, `v` and the normal; one number for all three.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale(pub [f64; 3]);

impl Default for Scale {
    fn default() -> Self {
        Self([1.0; 3])
    }
}

impl Scale {
    fn checked(factors: [f64; 3]) -> Result<Self, String> {
        let good = factors.iter().all(|f| f.is_finite())
            && factors[0] > 0.0
            && factors[1] > 0.0
            && factors[2] != 0.0;
        if good {
            return Ok(Self(factors));
        }
        Err(format!("{factors:?} are no factors; expected positive ones, the last may be negative, none 0"))
    }
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ScaleVisitor;
        impl<'de> de::Visitor<'de> for ScaleVisitor {
            type Value = Scale;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a factor, or three along u, v and the normal")
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Scale, E> {
                self.visit_f64(value as f64)
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Scale, E> {
                Scale::checked([value; 3]).map_err(E::custom)
            }
            fn visit_seq<A: de::SeqAccess<'de>>(self, items: A) -> Result<Scale, A::Error> {
                let factors = <[f64; 3]>::deserialize(de::value::SeqAccessDeserializer::new(items))?;
                Scale::checked(factors).map_err(de::Error::custom)
            }
        }
        deserializer.deserialize_any(ScaleVisitor)
    }
}

impl JsonSchema for Scale {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Scale".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "A factor, or factors along u, along v and along the normal.",
            "anyOf": [
                { "type": "number", "exclusiveMinimum": 0 },
                { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
            ],
        })
    }
}

/// An angle: a number in radians, or a text with a unit such as `"30 deg"`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AngleSetting(pub f64);

impl<'de> Deserialize<'de> for AngleSetting {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AngleVisitor;
        impl de::Visitor<'_> for AngleVisitor {
            type Value = AngleSetting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number of radians, or a text with a unit such as \"30 deg\"")
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<AngleSetting, E> {
                self.visit_f64(value as f64)
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<AngleSetting, E> {
                if value.is_finite() {
                    return Ok(AngleSetting(value));
                }
                Err(E::custom(format!("{value} is not an angle")))
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<AngleSetting, E> {
                text.parse().map(|Angle(radians)| AngleSetting(radians)).map_err(E::custom)
            }
        }
        deserializer.deserialize_any(AngleVisitor)
    }
}

impl JsonSchema for AngleSetting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Angle".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "A number of radians, or a text with a unit: deg, rad.",
            "type": ["number", "string"],
        })
    }
}

/// Rows that stay: 1 to 8.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(try_from = "u64")]
#[schemars(with = "u64", extend("minimum" = 1, "maximum" = 8))]
pub struct Margin(pub usize);

impl Default for Margin {
    fn default() -> Self {
        Self(2)
    }
}

impl TryFrom<u64> for Margin {
    type Error = String;
    fn try_from(rows: u64) -> Result<Self, String> {
        if (1..=8).contains(&rows) {
            return Ok(Self(rows as usize));
        }
        Err(format!("{rows} is not a margin; expected 1 to 8 rows"))
    }
}

/// How a feature is carried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PasteMethod {
    /// Displacement of control points from a smooth base.
    Displacement,
    /// Gradients of the net, as published.
    Poisson,
    /// Laplacians of the net, with position and slope going over into the target.
    Biharmonic,
    /// The displacement fitted by least squares: any angle, mirror and parametrisation.
    Fit,
}

/// Mirror of a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MirrorWord {
    /// As it is.
    #[default]
    None,
    /// `u` the other way.
    U,
    /// `v` the other way.
    V,
}

/// What becomes of the target's detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExistingWord {
    /// The feature is added to it.
    #[default]
    Keep,
    /// It gives way.
    Replace,
    /// The stronger gradient stays.
    Stronger,
}

/// Which control points count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RuleWord {
    /// Those that act inside the region alone.
    #[default]
    Support,
    /// The published union over rows and columns.
    RowsAndColumns,
}

/// How gradients turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TurnWord {
    /// By frames of tangent and normal.
    #[default]
    Frame,
    /// By the least rotation of the normals.
    Normal,
    /// Not at all.
    None,
}

/// Weights of the Laplacian.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EdgeWeightsWord {
    /// Of finite volumes: exact for planes on uneven knots.
    #[default]
    FiniteVolume,
    /// All 1, as published.
    Uniform,
}

/// Loops of the target in the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LoopsWord {
    /// The paste is refused.
    #[default]
    Refuse,
    /// The loops stay as they are, and the feature is cut off there.
    Protect,
}

/// Loops of the source inside the region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HolesWord {
    /// The surface is pasted across them, and the report says so.
    #[default]
    Close,
    /// The target gets them too, as bounds of its own; a closed shell is refused.
    Carry,
}

impl FeaturePaste {
    /// Refuses keys that contradict each other.
    pub(in crate::job) fn check(&self) -> Result<(), String> {
        let (source, target) = (&self.source, &self.target);
        let others = source.file.is_some()
            || source.face.is_some()
            || source.at.is_some()
            || source.region != RegionSetting::Outer;
        if source.feature.is_some() && others {
            return Err(
                "`source.feature` brings its own face and region; no other key goes with it".to_owned()
            );
        }
        if target.at.is_none() && target.places.is_empty() {
            return Err("`target` names no place; expected `at` or `places`".to_owned());
        }
        if target.pattern.is_some() && target.at.is_none() {
            return Err("`target.pattern` repeats `target.at`, which is missing".to_owned());
        }
        if let Some(direction) = target.along.filter(|d| !is_direction(d)) {
            return Err(format!("`target.along` {direction:?} is no direction"));
        }
        if let Some(Pattern::Circular(ring)) = &target.pattern
            && !is_direction(&ring.direction)
        {
            return Err(format!("`target.pattern.circular.direction` {:?} is no direction", ring.direction));
        }
        if let RegionSetting::Contour(_, Some(plane)) | RegionSetting::Curve(_, Some(plane)) =
            &self.source.region
            && !is_direction(&plane.direction)
        {
            return Err(format!("`source.region.plane.direction` {:?} is no direction", plane.direction));
        }
        if let Some(LengthSetting(Length::FileUnits(value) | Length::Metres(value))) = self.tolerance
            && !(value.is_finite() && value > 0.0)
        {
            return Err(format!("`tolerance` is {value}; expected a positive length"));
        }
        self.check_method()
    }

    fn check_method(&self) -> Result<(), String> {
        let places = &self.target.places;
        let turned = self.rotate.0 != 0.0
            || self.mirror != MirrorWord::None
            || self.target.along.is_some()
            || matches!(self.target.pattern, Some(Pattern::Circular(_)))
            || places.iter().any(|p| p.rotate.0 != 0.0 || p.mirror.is_some_and(|m| m != MirrorWord::None));
        match (self.method, self.existing) {
            (Some(PasteMethod::Displacement | PasteMethod::Poisson | PasteMethod::Biharmonic), _)
                if turned =>
            {
                Err("this `method` keeps the directions of the parameters; only `fit` turns and mirrors"
                    .to_owned())
            }
            (Some(PasteMethod::Displacement | PasteMethod::Fit), ExistingWord::Stronger) => {
                Err("`existing = \"stronger\"` compares gradients; expected `method` poisson or biharmonic"
                    .to_owned())
            }
            (None, ExistingWord::Stronger) if turned => {
                Err("`existing = \"stronger\"` does not go with turning or mirroring".to_owned())
            }
            _ => Ok(()),
        }
    }
}

fn is_direction(d: &[f64; 3]) -> bool {
    d.iter().all(|c| c.is_finite()) && d.iter().any(|c| *c != 0.0)
}
