//! Selectors: which faces of a part a job means. The words, without a model.

use globset::{Glob, GlobMatcher};
use schemars::JsonSchema;
use serde::{Deserialize, de};

use crate::job::file::LengthSetting;
use crate::model::Origin;
use crate::model::origin::ParseOriginError;

/// Faces of a part.
#[derive(Debug, Clone, PartialEq)]
pub enum Selector {
    /// The face of a record.
    Record(Origin),
    /// Faces for which all keys hold.
    All(Box<Conditions>),
    /// Faces that any of these selects.
    Any(Vec<Selector>),
}

/// Conditions on one face. Keys that are left out hold for every face.
#[derive(Debug, Clone, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(extend("minProperties" = 1))]
pub struct Conditions {
    /// Name of the face, or else of its body, as a glob: `"HOOD*"`.
    pub name: Option<NamePattern>,
    /// The one face nearest to this point, among those for which the other keys hold.
    pub near: Option<[LengthSetting; 3]>,
    /// Kind of its surface.
    pub surface: Option<SurfaceKind>,
    /// Colour as `"#rrggbb"`, its own or its body's.
    pub colour: Option<ColourSetting>,
    /// Name or id of its product, as a glob.
    pub product: Option<NamePattern>,
    /// Name of a layer that it or its body lies on, as a glob.
    pub layer: Option<NamePattern>,
    /// The one face of the largest or smallest area, among those for which the other keys hold.
    pub area: Option<Extreme>,
}

/// Kinds of surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "the words are those of ISO 10303-42")]
pub enum SurfaceKind {
    Plane,
    Cylinder,
    Cone,
    Sphere,
    Torus,
    LinearExtrusion,
    Revolution,
    BSpline,
    Offset,
    RectangularTrimmed,
    CurveBounded,
    RectangularComposite,
}

impl SurfaceKind {
    /// The word of the job file, which is [`Surface::kind`](crate::geometry::Surface::kind).
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Cylinder => "cylinder",
            Self::Cone => "cone",
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::LinearExtrusion => "linear_extrusion",
            Self::Revolution => "revolution",
            Self::BSpline => "b_spline",
            Self::Offset => "offset",
            Self::RectangularTrimmed => "rectangular_trimmed",
            Self::CurveBounded => "curve_bounded",
            Self::RectangularComposite => "rectangular_composite",
        }
    }
}

/// The face at one end of a scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Extreme {
    /// The greatest.
    Largest,
    /// The least.
    Smallest,
}

/// A glob that a name has to match.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(try_from = "String")]
#[schemars(with = "String")]
pub struct NamePattern(Glob);

impl TryFrom<String> for NamePattern {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        Glob::new(&text)
            .map(Self)
            .map_err(|error| format!("`{text}` is no pattern of names: {}", error.kind()))
    }
}

impl NamePattern {
    /// What decides whether a name matches.
    #[must_use]
    pub fn matcher(&self) -> GlobMatcher {
        self.0.compile_matcher()
    }
}

impl std::fmt::Display for NamePattern {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.glob())
    }
}

/// A colour written `#rrggbb`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(try_from = "String")]
#[schemars(with = "String", extend("pattern" = "^#[0-9a-fA-F]{6}$"))]
pub struct ColourSetting(pub [u8; 3]);

impl TryFrom<String> for ColourSetting {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        let digits =
            text.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()));
        let number = digits.and_then(|d| u32::from_str_radix(d, 16).ok());
        let [_, red, green, blue] =
            number.ok_or_else(|| format!("`{text}` is not a colour; expected \"#rrggbb\""))?.to_be_bytes();
        Ok(Self([red, green, blue]))
    }
}

/// Names of records in a job file, as a pattern of its schema.
pub(in crate::job) const RECORD: &str = "^(#[0-9]+|D[0-9]+(/[0-9]+)?)$";

/// A selector as typed on a command line: the name of a record, or what a job file may have in its place.
pub(in crate::job) fn typed<T: serde::de::DeserializeOwned>(
    text: &str,
    record: fn(Origin) -> T,
) -> Result<T, String> {
    let text = text.trim();
    if text.starts_with(['#', 'D']) {
        return text.parse().map(record).map_err(|error: ParseOriginError| error.to_string());
    }
    crate::job::text::read_value(text).map_err(|error| error.to_string())
}

impl std::str::FromStr for Selector {
    type Err = String;

    /// A selector as typed on a command line: `#1042` or `D57`, or a table as in a job file.
    fn from_str(text: &str) -> Result<Self, String> {
        typed(text, Self::Record)
    }
}

impl<'de> Deserialize<'de> for Selector {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SelectorVisitor;
        impl<'de> de::Visitor<'de> for SelectorVisitor {
            type Value = Selector;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(
                    "a selector: \"#1042\", a table such as { name = \"HOOD*\" }, or a list of selectors",
                )
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Selector, E> {
                text.parse().map(Selector::Record).map_err(|error: ParseOriginError| E::custom(error))
            }
            fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<Selector, A::Error> {
                let conditions = Conditions::deserialize(de::value::MapAccessDeserializer::new(map))?;
                if conditions == Conditions::default() {
                    return Err(de::Error::custom("an empty selector; leave the key out to mean everything"));
                }
                if conditions.near.is_some() && conditions.area.is_some() {
                    return Err(de::Error::custom(
                        "`near` and `area` each select one face; expected one of them",
                    ));
                }
                Ok(Selector::All(Box::new(conditions)))
            }
            fn visit_seq<A: de::SeqAccess<'de>>(self, mut items: A) -> Result<Selector, A::Error> {
                let mut selectors = Vec::new();
                while let Some(selector) = items.next_element()? {
                    selectors.push(selector);
                }
                if selectors.is_empty() {
                    return Err(de::Error::custom("an empty list of selectors selects nothing"));
                }
                Ok(Selector::Any(selectors))
            }
        }
        deserializer.deserialize_any(SelectorVisitor)
    }
}

impl JsonSchema for Selector {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Selector".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let conditions = generator.subschema_for::<Conditions>();
        schemars::json_schema!({
            "description": "Which faces: the name of a record, conditions that must all hold, or a list of which any may.",
            "anyOf": [
                { "type": "string", "pattern": RECORD },
                conditions,
                { "type": "array", "minItems": 1, "items": { "$ref": "#/$defs/Selector" } },
            ],
        })
    }
}
