//! The words of `feature_reconstruction`.

use schemars::JsonSchema;
use serde::{Deserialize, de};

use crate::job::file::deform::Minimise;
use crate::job::file::detail::CurveSelector;
use crate::job::file::paste::Pattern;
use crate::job::file::selector::Selector;
use crate::job::file::{LengthSetting, positive_length};
use crate::units::Length;

/// Rebuild a feature from scanned points: a surface that replaced a region of a face, and the rolling-ball blend about it.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeatureReconstruction {
    /// The face that the feature stands on.
    #[serde(default)]
    pub primary: PrimarySetting,
    /// The scanned points.
    pub cloud: CloudSetting,
    /// The lines through the feature.
    #[serde(default)]
    pub lines: LinesSetting,
    /// What is made least where the surface follows the lines.
    #[serde(default)]
    pub minimise: Minimise,
    /// What the surface is drawn to.
    #[serde(default)]
    pub follow: FollowWord,
    /// The radius of the blend.
    #[serde(default)]
    pub blend: BlendSetting,
    /// Further places of the feature, the scanned one included. Points of a full ring are folded onto one feature.
    #[serde(default)]
    pub pattern: Option<Pattern>,
    /// Greatest distance of the points from the new surface. Left out: what their scatter lets expect.
    #[serde(default)]
    pub limits: Option<LimitsSetting>,
}

/// The primary.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrimarySetting {
    /// The face. Left out: the only one.
    #[serde(default)]
    pub face: Option<Selector>,
}

/// Where the points are: `objective` and `blend` as files of their own, or one `file`, sorted by labels or by curvature.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CloudSetting {
    /// File of the points on the new surface, relative to the job file.
    #[serde(default)]
    pub objective: Option<String>,
    /// File of the points on the blend.
    #[serde(default)]
    pub blend: Option<String>,
    /// File of all points.
    #[serde(default)]
    pub file: Option<String>,
    /// Where `file` has labels. Left out: points are sorted by their distance from the primary and by curvature.
    #[serde(default)]
    pub labels: Option<LabelsSetting>,
    /// Length of one unit of the files, such as `"1 mm"`. Left out: the unit of the part, or what the format states.
    #[serde(default, deserialize_with = "positive_length")]
    pub unit: Option<LengthSetting>,
}

/// Labels of points.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LabelsSetting {
    /// Name of the column, or its number from 1.
    pub column: ColumnSetting,
    /// Labels of points on the new surface.
    pub objective: Vec<i64>,
    /// Labels of points on the blend.
    pub blend: Vec<i64>,
}

/// A column.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ColumnSetting {
    /// By its name.
    Named(String),
    /// By its number, from 1.
    Numbered(usize),
}

/// The lines through a feature: a backbone along it, and ribs across.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LinesSetting {
    /// How the backbone is found.
    pub backbone: BackboneSetting,
    /// Lines along the backbone. Left out: 3 in a feature inside the face, 1 in others.
    pub along: Option<usize>,
    /// Ribs at first; more are added where `follow = "lines"` leaves too great an error. Left out: 11.
    pub ribs: Option<usize>,
    /// Spans of the net along `u` and `v`. Left out: a twentieth of the feature, at least three distances of points.
    pub spans: Option<[usize; 2]>,
}

/// The backbone: a word, or a curve near the feature.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum BackboneSetting {
    /// Straight, along the longest axis.
    #[default]
    Fit,
    /// Through the middles of slices.
    Slices,
    /// Through the places of slices that bend most.
    Crest,
    /// A curve.
    Curve(BackboneCurve),
}

/// A curve near the feature.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BackboneCurve {
    /// The curve. Left out: the only free curve of the file.
    #[serde(default)]
    pub curve: Option<CurveSelector>,
    /// Its file, relative to the job file. Left out: the part itself.
    #[serde(default)]
    pub file: Option<String>,
}

/// A word for a backbone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum BackboneWord {
    /// Straight, along the longest axis.
    Fit,
    /// Through the middles of slices.
    Slices,
    /// Through the places of slices that bend most.
    Crest,
}

impl<'de> Deserialize<'de> for BackboneSetting {
    fn deserialize<D: de::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct BackboneVisitor;
        impl<'de> de::Visitor<'de> for BackboneVisitor {
            type Value = BackboneSetting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"fit\", \"slices\", \"crest\", or a curve such as { file = \"lines.step\" }")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<BackboneSetting, E> {
                let word = BackboneWord::deserialize(de::value::StrDeserializer::<E>::new(text))?;
                Ok(match word {
                    BackboneWord::Fit => BackboneSetting::Fit,
                    BackboneWord::Slices => BackboneSetting::Slices,
                    BackboneWord::Crest => BackboneSetting::Crest,
                })
            }
            fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<BackboneSetting, A::Error> {
                let map = de::value::MapAccessDeserializer::new(map);
                BackboneCurve::deserialize(map).map(BackboneSetting::Curve)
            }
        }
        deserializer.deserialize_any(BackboneVisitor)
    }
}

impl JsonSchema for BackboneSetting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Backbone".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let word = generator.subschema_for::<BackboneWord>();
        let curve = generator.subschema_for::<BackboneCurve>();
        schemars::json_schema!({
            "description": "The backbone of a feature: a word, or a curve near it.",
            "anyOf": [word, curve],
        })
    }
}

/// What the surface is drawn to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FollowWord {
    /// Each point of the cloud, the lines beside.
    #[default]
    Cloud,
    /// The lines alone.
    Lines,
}

/// The radius of the blend.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum BlendSetting {
    /// Constant, or linear where the points leave no doubt.
    #[default]
    Tested,
    /// Constant along the line.
    Constant,
    /// Linear along the line.
    Linear,
    /// This.
    Radius(LengthSetting),
}

impl<'de> Deserialize<'de> for BlendSetting {
    fn deserialize<D: de::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct BlendVisitor;
        impl de::Visitor<'_> for BlendVisitor {
            type Value = BlendSetting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"tested\", \"constant\", \"linear\", or a radius such as \"5 mm\"")
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<BlendSetting, E> {
                self.visit_f64(value as f64)
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<BlendSetting, E> {
                radius(LengthSetting(Length::FileUnits(value))).map_err(E::custom)
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<BlendSetting, E> {
                match text {
                    "tested" => Ok(BlendSetting::Tested),
                    "constant" => Ok(BlendSetting::Constant),
                    "linear" => Ok(BlendSetting::Linear),
                    _ if text.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                        Err(E::invalid_value(de::Unexpected::Str(text), &self))
                    }
                    _ => text
                        .parse()
                        .map(LengthSetting)
                        .map_err(E::custom)
                        .and_then(|length| radius(length).map_err(E::custom)),
                }
            }
        }
        deserializer.deserialize_any(BlendVisitor)
    }
}

fn radius(length: LengthSetting) -> Result<BlendSetting, String> {
    let (Length::FileUnits(value) | Length::Metres(value)) = length.0;
    if value.is_finite() && value > 0.0 {
        Ok(BlendSetting::Radius(length))
    } else {
        Err(format!("{value} is not a radius; expected a positive length"))
    }
}

impl JsonSchema for BlendSetting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Blend".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let length = generator.subschema_for::<LengthSetting>();
        schemars::json_schema!({
            "description": "The radius of a blend: found and tested, found as constant or as linear, or given.",
            "anyOf": [{ "enum": ["tested", "constant", "linear"] }, length],
        })
    }
}

/// Distances that points may have from the new surface.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitsSetting {
    /// In the mean.
    pub mean: LengthSetting,
    /// At most.
    pub greatest: LengthSetting,
}

/// Most lines or spans that a job may ask for.
const MOST: usize = 1000;

impl FeatureReconstruction {
    /// Refuses keys that contradict each other and values that mean nothing.
    pub(in crate::job) fn check(&self) -> Result<(), String> {
        self.cloud.check().map_err(|fault| format!("cloud: {fault}"))?;
        let counts = [("lines.along", self.lines.along), ("lines.ribs", self.lines.ribs)];
        for (key, count) in counts {
            if count.is_some_and(|n| n > MOST) {
                return Err(format!("`{key}` is more than {MOST}"));
            }
        }
        if self.lines.spans.is_some_and(|spans| spans.iter().any(|n| !(1..=MOST).contains(n))) {
            return Err(format!("`lines.spans`: expected counts from 1 to {MOST}"));
        }
        if let Some(Pattern::Circular(ring)) = &self.pattern
            && !ring.direction.iter().any(|c| c.is_finite() && *c != 0.0)
        {
            return Err("`pattern.circular.direction` is no direction".to_owned());
        }
        Ok(())
    }

    /// Files that are read.
    pub(in crate::job) fn files(&mut self) -> impl Iterator<Item = &mut String> {
        let cloud = &mut self.cloud;
        let backbone = match &mut self.lines.backbone {
            BackboneSetting::Curve(curve) => curve.file.as_mut(),
            _ => None,
        };
        [cloud.objective.as_mut(), cloud.blend.as_mut(), cloud.file.as_mut(), backbone].into_iter().flatten()
    }
}

impl CloudSetting {
    fn check(&self) -> Result<(), String> {
        match (&self.file, &self.objective, &self.blend, &self.labels) {
            (Some(_), None, None, _) | (None, Some(_), Some(_), None) => {}
            _ => {
                return Err(
                    "expected `objective` and `blend`, or `file`, with `labels` or without".to_owned()
                );
            }
        }
        match &self.labels {
            Some(labels) if labels.objective.is_empty() || labels.blend.is_empty() => {
                Err("`labels.objective` and `labels.blend` need a label".to_owned())
            }
            Some(LabelsSetting { column: ColumnSetting::Numbered(0), .. }) => {
                Err("`labels.column` is counted from 1".to_owned())
            }
            _ => Ok(()),
        }
    }
}
