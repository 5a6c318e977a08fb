//! The baseline: what each part measures, in a form that reads well in a difference of versions.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Deserialize;

use crate::job::report::measured::{Measure, Measures};

/// What was measured once, and how near later measures must be.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// Version of the form: 1.
    pub version: Version,
    /// How near later measures must be.
    #[serde(default)]
    pub tolerance: Tolerances,
    /// Measures by part: its path in the folder, or that of a job with that of its part.
    #[serde(default)]
    pub part: BTreeMap<String, Measures>,
}

/// The only version.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(try_from = "i64")]
pub struct Version;

impl TryFrom<i64> for Version {
    type Error = String;
    fn try_from(version: i64) -> Result<Self, String> {
        if version == 1 {
            Ok(Self)
        } else {
            Err(format!("version {version} of the baseline is not known; expected 1"))
        }
    }
}

/// How near measures must be to those of the baseline. What has no tolerance must be equal.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tolerances {
    /// Part of a volume.
    pub volume: f64,
    /// Part of an area.
    pub area: f64,
    /// Part of the size of the part that its centroid may be away.
    pub centroid: f64,
    /// Part of its size that its extents may be away.
    pub extents: f64,
    /// Times that a part may take longer, or less; what takes less than [`Self::AT_ONCE`] is not compared.
    pub seconds: f64,
}

impl Tolerances {
    /// Seconds below which a time says more of the machine than of the part.
    pub const AT_ONCE: f64 = 2.0;
}

impl Default for Tolerances {
    fn default() -> Self {
        Self { volume: 1e-6, area: 1e-6, centroid: 1e-6, extents: 1e-12, seconds: 5.0 }
    }
}

/// A baseline that cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct BaselineError {
    /// What is wrong.
    pub message: String,
    /// Where, as bytes of the text.
    pub span: std::ops::Range<usize>,
}

impl Baseline {
    /// Reads the text of a baseline.
    ///
    /// # Errors
    /// [`BaselineError`] with the place.
    pub fn read(text: &str) -> Result<Self, BaselineError> {
        let baseline: Self = toml::from_str(text).map_err(|error| BaselineError {
            message: error.message().to_owned(),
            span: error.span().unwrap_or(0..0),
        })?;
        let Tolerances { volume, area, centroid, extents, seconds } = baseline.tolerance;
        let named = [
            ("volume", volume),
            ("area", area),
            ("centroid", centroid),
            ("extents", extents),
            ("seconds", seconds),
        ];
        match named.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            Some((name, value)) => Err(BaselineError {
                message: format!("the tolerance `{name}` is {value}; it must be a finite number from 0"),
                span: text.find(&format!("{name} ")).map_or(0..0, |at| at..at + name.len()),
            }),
            None => Ok(baseline),
        }
    }

    /// Its text: parts and measures in order, a line each, numbers as short as they read back.
    #[must_use]
    pub fn text(&self) -> String {
        let Tolerances { volume, area, centroid, extents, seconds } = self.tolerance;
        let mut text = format!(
            "# Written by `resurf regress --update`. The tolerances are yours to set: parts of the volume, the area and the size, and\n\
             # times that a part may take.\nversion = 1\n\n[tolerance]\nvolume = {volume:?}\narea = {area:?}\ncentroid = {centroid:?}\n\
             extents = {extents:?}\nseconds = {seconds:?}\n"
        );
        for (name, measures) in &self.part {
            let _ = write!(text, "\n[part.{}]\n", quoted(name));
            for (key, measure) in measures {
                let _ = writeln!(text, "{} = {}", key_text(key), value(measure));
            }
        }
        text
    }
}

fn key_text(key: &str) -> String {
    let bare = key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if bare { key.to_owned() } else { quoted(key) }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn value(measure: &Measure) -> String {
    // A number that is none has no place in a baseline that is compared: as a word it differs from all numbers.
    let number = |x: f64| if x.is_finite() { format!("{x:?}") } else { format!("\"{x}\"") };
    match measure {
        Measure::Truth(truth) => truth.to_string(),
        Measure::Count(count) => count.to_string(),
        Measure::Number(x) => number(*x),
        Measure::Point(p) => format!("[{}]", p.map(number).join(", ")),
        Measure::Word(word) => quoted(word),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let mut baseline =
            Baseline { version: Version, tolerance: Tolerances::default(), part: BTreeMap::new() };
        let measures = [
            ("volume", Measure::Number(1.0)),
            ("area", Measure::Number(1e-300)),
            ("faces", Measure::Count(3)),
            ("centroid", Measure::Point([0.1, -2.0, 3e20])),
            ("check.open-loop", Measure::Count(1)),
            ("schema", Measure::Word("A \"B\" \\ é\n".to_owned())),
            ("valid.freecad", Measure::Truth(false)),
        ];
        let measures: Measures = measures.into_iter().map(|(name, m)| (name.to_owned(), m)).collect();
        for name in ["a.step", "sub folder/#1 \"x\".stp", "job.toml: a.step"] {
            baseline.part.insert(name.to_owned(), measures.clone());
        }
        assert_eq!(Baseline::read(&baseline.text()), Ok(baseline));
    }

    #[test]
    fn another_version_and_unknown_words_are_refused_with_their_place() {
        let error = Baseline::read("version = 2\n").expect_err("unknown");
        assert!(error.message.contains("version 2") && error.span.start == 10, "{error:?}");
        assert!(Baseline::read("version = 1\n[tolerance]\nvolum = 1\n").is_err());
        for value in ["inf", "-1.0", "nan"] {
            let error = Baseline::read(&format!("version = 1\n[tolerance]\nvolume = {value}\n")).unwrap_err();
            assert!(error.message.contains("`volume`"), "{}", error.message);
        }
    }
}
