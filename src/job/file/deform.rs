//! The words of `deform`.

use schemars::JsonSchema;
use serde::{Deserialize, de};

use crate::job::file::detail::CurveSelector;
use crate::job::file::scale::Continuity;
use crate::job::file::selector::Selector;
use crate::job::file::{LengthSetting, positive_length};

/// Pull lines on a B-spline face to given curves or points; its border, its loops and its neighbours stay.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Deform {
    /// The face. Left out: the only one.
    #[serde(default)]
    pub face: Option<Selector>,
    /// Lines that the face is pulled to.
    #[serde(deserialize_with = "at_least_one")]
    #[schemars(length(min = 1))]
    pub lines: Vec<DeformLine>,
    /// What is made least between the lines.
    #[serde(default)]
    pub minimise: Minimise,
    /// How lines are met: in balance with what is minimised, or exactly at the points that count.
    #[serde(default)]
    pub form: FormWord,
    /// With `form = "penalty"`: how many times as stiff as the face the lines are. Left out: 10000.
    #[serde(default)]
    pub strength: Option<f64>,
    /// What stays along the natural border: 0 position, 1 tangent, 2 curvature.
    #[serde(default)]
    pub continuity: Continuity,
    /// Greatest distance of the lines from the deformed face; the net is refined until it is kept. Left out: a thousandth
    /// of the greatest pull, at least the file's uncertainty.
    #[serde(default, deserialize_with = "positive_length")]
    pub tolerance: Option<LengthSetting>,
    /// Least count of spans along `u` and `v` of the net. Left out: 8 by 8.
    #[serde(default)]
    pub spans: Option<[usize; 2]>,
}

fn at_least_one<'de, D: de::Deserializer<'de>>(deserializer: D) -> Result<Vec<DeformLine>, D::Error> {
    let lines = Vec::<DeformLine>::deserialize(deserializer)?;
    if lines.is_empty() { Err(de::Error::custom("`lines` needs a line")) } else { Ok(lines) }
}

/// Most spans that a job may ask for: beyond, a net is larger than any that was designed.
const MOST_SPANS: usize = 200;

impl Deform {
    /// Refuses keys that contradict each other and values that mean nothing.
    pub(in crate::job) fn check(&self) -> Result<(), String> {
        for (k, line) in self.lines.iter().enumerate() {
            line.check().map_err(|fault| format!("lines[{k}]: {fault}"))?;
        }
        match (self.form, self.strength) {
            (FormWord::Exact, Some(_)) => return Err("`strength` needs `form = \"penalty\"`".to_owned()),
            (_, Some(strength)) if !(strength.is_finite() && strength > 0.0) => {
                return Err(format!("`strength` is {strength}; expected a positive number"));
            }
            _ => {}
        }
        if let Some(spans) = self.spans.filter(|s| s.iter().any(|n| !(1..=MOST_SPANS).contains(n))) {
            return Err(format!("`spans` is {spans:?}; expected counts from 1 to {MOST_SPANS}"));
        }
        Ok(())
    }

    /// Files that the lines are read from.
    pub(in crate::job) fn files(&mut self) -> impl Iterator<Item = &mut String> {
        self.lines.iter_mut().flat_map(|line| {
            let from = line.from.as_mut().and_then(|path| path.file.as_mut());
            line.file.as_mut().into_iter().chain(from)
        })
    }
}

/// A line that the face is pulled to.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeformLine {
    /// Points that the face goes through, instead of a curve.
    #[serde(default)]
    pub points: Vec<[LengthSetting; 3]>,
    /// The curve that the face goes through. With `file` left out: the only free curve of the file, where neither this nor
    /// `points` is given.
    #[serde(default)]
    pub curve: Option<CurveSelector>,
    /// The file of the curve, relative to the job file. Left out: the part itself.
    #[serde(default)]
    pub file: Option<String>,
    /// The line on the face that goes there, each part of its length to the same part. Left out: the nearest points.
    #[serde(default)]
    pub from: Option<PathSetting>,
    /// Weight against other lines.
    #[serde(default)]
    pub weight: Weight,
    /// The face's normal along the line: `"free"`, `"keep"`, or a direction.
    #[serde(default)]
    pub normal: NormalSetting,
}

/// A line on the face.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PathSetting {
    /// Points of the line, instead of a curve.
    #[serde(default)]
    pub points: Vec<[LengthSetting; 3]>,
    /// The curve.
    #[serde(default)]
    pub curve: Option<CurveSelector>,
    /// The file of the curve, relative to the job file. Left out: the part itself.
    #[serde(default)]
    pub file: Option<String>,
}

impl DeformLine {
    fn check(&self) -> Result<(), String> {
        sources(&self.points, self.curve.as_ref(), self.file.as_ref())?;
        if let Some(from) = &self.from {
            let fault = |reason: String| format!("from: {reason}");
            sources(&from.points, from.curve.as_ref(), from.file.as_ref()).map_err(fault)?;
        }
        if let NormalSetting::Along(direction) = self.normal
            && !(direction.iter().all(|c| c.is_finite()) && direction.iter().any(|c| *c != 0.0))
        {
            return Err("`normal` has no direction".to_owned());
        }
        Ok(())
    }
}

fn sources(
    points: &[[LengthSetting; 3]],
    curve: Option<&CurveSelector>,
    file: Option<&String>,
) -> Result<(), String> {
    match (points.is_empty(), curve, file) {
        (false, None, None) | (true, Some(_), _) | (true, None, Some(_)) => Ok(()),
        (false, _, _) => Err("`points` go with neither `curve` nor `file`".to_owned()),
        (true, None, None) => Err("expected `points`, `curve`, or `file`".to_owned()),
    }
}

/// A positive weight.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "f64")]
#[schemars(with = "f64")]
pub struct Weight(pub f64);

impl Default for Weight {
    fn default() -> Self {
        Self(1.0)
    }
}

impl TryFrom<f64> for Weight {
    type Error = String;
    fn try_from(weight: f64) -> Result<Self, String> {
        if weight.is_finite() && weight > 0.0 {
            return Ok(Self(weight));
        }
        Err(format!("{weight} is not a weight; expected a positive number"))
    }
}

/// How lines are met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FormWord {
    /// In balance with what is minimised.
    #[default]
    Penalty,
    /// Exactly at the points that count.
    Exact,
}

/// What becomes of the normal along a line.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum NormalSetting {
    /// It follows.
    #[default]
    Free,
    /// It stays.
    Keep,
    /// It takes a direction.
    Along([f64; 3]),
}

impl<'de> Deserialize<'de> for NormalSetting {
    fn deserialize<D: de::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NormalVisitor;
        impl<'de> de::Visitor<'de> for NormalVisitor {
            type Value = NormalSetting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"free\", \"keep\", or a direction such as [0, 0, 1]")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<NormalSetting, E> {
                match text {
                    "free" => Ok(NormalSetting::Free),
                    "keep" => Ok(NormalSetting::Keep),
                    _ => Err(E::invalid_value(de::Unexpected::Str(text), &self)),
                }
            }
            fn visit_seq<A: de::SeqAccess<'de>>(self, items: A) -> Result<NormalSetting, A::Error> {
                let items = de::value::SeqAccessDeserializer::new(items);
                <[f64; 3]>::deserialize(items).map(NormalSetting::Along)
            }
        }
        deserializer.deserialize_any(NormalVisitor)
    }
}

impl JsonSchema for NormalSetting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Normal".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "The normal of a face along a line: it follows, it stays, or it takes a direction.",
            "anyOf": [
                { "enum": ["free", "keep"] },
                { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
            ],
        })
    }
}

/// A measure of the network of bars over the control net.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum MeasureWord {
    /// The change of the forces: between the lines the face bends as it did.
    #[default]
    ForceVariation,
    /// The forces: the net is drawn flat, as a membrane is.
    Force,
    /// The lengths of the bars.
    BarLength,
    /// The displacements: only what is near a line moves.
    Displacement,
}

/// What is made least: one measure, or weights of several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Minimise {
    /// Weight of the change of the forces.
    pub force_variation: f64,
    /// Weight of the forces.
    pub force: f64,
    /// Weight of the bars' lengths.
    pub bar_length: f64,
    /// Weight of the displacements.
    pub displacement: f64,
}

/// Weights of several measures.
#[derive(Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
struct MeasureWeights {
    /// The change of the forces.
    force_variation: f64,
    /// The forces.
    force: f64,
    /// The lengths of the bars.
    bar_length: f64,
    /// The displacements.
    displacement: f64,
}

impl From<MeasureWord> for Minimise {
    fn from(word: MeasureWord) -> Self {
        let weight = |of: MeasureWord| f64::from(u8::from(word == of));
        Self {
            force_variation: weight(MeasureWord::ForceVariation),
            force: weight(MeasureWord::Force),
            bar_length: weight(MeasureWord::BarLength),
            displacement: weight(MeasureWord::Displacement),
        }
    }
}

impl Default for Minimise {
    fn default() -> Self {
        MeasureWord::default().into()
    }
}

impl MeasureWeights {
    fn checked(self) -> Result<Minimise, String> {
        let Self { force_variation, force, bar_length, displacement } = self;
        let all = [force_variation, force, bar_length, displacement];
        if let Some(weight) = all.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
            return Err(format!(
                "{weight} is not a weight of what is minimised; expected a number of at least 0"
            ));
        }
        if all.iter().all(|w| *w == 0.0) {
            return Err("`minimise` needs a weight above 0".to_owned());
        }
        Ok(Minimise { force_variation, force, bar_length, displacement })
    }
}

impl<'de> Deserialize<'de> for Minimise {
    fn deserialize<D: de::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct MinimiseVisitor;
        impl<'de> de::Visitor<'de> for MinimiseVisitor {
            type Value = Minimise;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a measure such as \"force_variation\", or a table of weights")
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Minimise, E> {
                MeasureWord::deserialize(de::value::StrDeserializer::<E>::new(text)).map(Minimise::from)
            }
            fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<Minimise, A::Error> {
                let weights = MeasureWeights::deserialize(de::value::MapAccessDeserializer::new(map))?;
                weights.checked().map_err(de::Error::custom)
            }
        }
        deserializer.deserialize_any(MinimiseVisitor)
    }
}

impl JsonSchema for Minimise {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Minimise".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let word = generator.subschema_for::<MeasureWord>();
        let weights = generator.subschema_for::<MeasureWeights>();
        schemars::json_schema!({
            "description": "What is made least between the lines: one measure, or weights of several.",
            "anyOf": [word, weights],
        })
    }
}
