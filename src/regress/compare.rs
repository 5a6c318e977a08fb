//! What was measured against the baseline: same, changed, new, missing, renamed.

use std::collections::BTreeMap;

use serde::Serialize;

use super::baseline::{Baseline, Tolerances, Version};
use super::survey::Surveyed;
use crate::job::report::measured::{Measure, Measures};

/// One part against the baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Its name.
    pub part: String,
    /// How it stands.
    pub outcome: Outcome,
    /// Measures that differ.
    pub changes: Vec<MeasureChange>,
    /// Whether the bytes of the part are others than those that were measured.
    pub edited: bool,
    /// Seconds that it took now.
    pub seconds: f64,
}

/// How a part stands to the baseline.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Every measure is within its tolerance.
    Same,
    /// Some are not.
    Changed,
    /// The baseline does not have it.
    New,
    /// Only the baseline has it.
    Missing,
    /// The baseline has it under another name, with the same bytes.
    Renamed {
        /// That name.
        from: String,
    },
}

/// One measure that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasureChange {
    /// Its name.
    pub measure: String,
    /// In the baseline.
    pub was: Option<Measure>,
    /// Now.
    pub is: Option<Measure>,
}

impl std::fmt::Display for MeasureChange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = |measure: &Option<Measure>| match measure {
            None => "nothing".to_owned(),
            Some(Measure::Truth(truth)) => truth.to_string(),
            Some(Measure::Count(count)) => count.to_string(),
            Some(Measure::Number(x)) => x.to_string(),
            Some(Measure::Point(p)) => format!("{p:?}"),
            Some(Measure::Word(word)) => format!("\"{word}\""),
        };
        write!(f, "{}: {} before, {} now", self.measure, text(&self.was), text(&self.is))?;
        if let (Some(Measure::Number(was)), Some(Measure::Number(is))) = (&self.was, &self.is)
            && *was != 0.0
        {
            write!(f, " ({:+.3e} of it)", (is - was) / was)?;
        }
        Ok(())
    }
}

/// Measures that are told apart from the rest: they say which part it is, and how long it took.
const DIGEST: &str = "sha256";
const SECONDS: &str = "seconds";

/// Compares what was measured with a baseline, by name.
#[must_use]
pub fn compare(baseline: &Baseline, surveyed: &[Surveyed]) -> Vec<Comparison> {
    let mut missing: BTreeMap<&str, &Measures> = baseline.part.iter().map(|(n, m)| (n.as_str(), m)).collect();
    missing.retain(|name, _| !surveyed.iter().any(|part| part.name == *name));
    let mut all = Vec::new();
    for part in surveyed {
        let known = baseline.part.get(&part.name).map(|known| (Outcome::Same, known));
        let digest = part.measures.get(DIGEST);
        let former =
            missing.iter().find(|(_, m)| digest.is_some() && m.get(DIGEST) == digest).map(|(name, _)| *name);
        let renamed = || {
            let name = former?;
            Some((Outcome::Renamed { from: name.to_owned() }, missing.remove(name)?))
        };
        all.push(match known.or_else(renamed) {
            Some((outcome, known)) => against(part, known, outcome, &baseline.tolerance),
            None => Comparison { outcome: Outcome::New, ..blank(&part.name, part.seconds) },
        });
    }
    all.extend(missing.keys().map(|name| Comparison { outcome: Outcome::Missing, ..blank(name, 0.0) }));
    all.sort_by(|a, b| a.part.cmp(&b.part));
    all
}

fn blank(name: &str, seconds: f64) -> Comparison {
    Comparison { part: name.to_owned(), outcome: Outcome::Same, changes: Vec::new(), edited: false, seconds }
}

fn against(part: &Surveyed, known: &Measures, outcome: Outcome, tolerances: &Tolerances) -> Comparison {
    let size = size(known).max(size(&part.measures));
    let mut changes = Vec::new();
    let names: std::collections::BTreeSet<&String> = known.keys().chain(part.measures.keys()).collect();
    for name in names.into_iter().filter(|name| *name != DIGEST) {
        let (was, is) = (known.get(name), part.measures.get(name));
        // A baseline without a time asks for none.
        if (name == SECONDS && was.is_none()) || agree(name, was, is, size, tolerances) {
            continue;
        }
        changes.push(MeasureChange { measure: name.clone(), was: was.cloned(), is: is.cloned() });
    }
    let outcome = if outcome == Outcome::Same && !changes.is_empty() { Outcome::Changed } else { outcome };
    let edited = known.get(DIGEST) != part.measures.get(DIGEST);
    Comparison { outcome, changes, edited, ..blank(&part.name, part.seconds) }
}

/// Diagonal of the extents.
fn size(measures: &Measures) -> f64 {
    match (measures.get("extents.min"), measures.get("extents.max")) {
        (Some(Measure::Point(a)), Some(Measure::Point(b))) => {
            a.iter().zip(b).map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt()
        }
        _ => 0.0,
    }
}

fn agree(
    name: &str,
    was: Option<&Measure>,
    is: Option<&Measure>,
    size: f64,
    tolerances: &Tolerances,
) -> bool {
    let relative = |a: f64, b: f64, part: f64| (a - b).abs() <= part * a.abs().max(b.abs());
    // In TOML a number without a point is a whole one.
    let number = |measure: &Measure| match measure {
        Measure::Number(x) => Some(*x),
        Measure::Count(n) => Some(*n as f64),
        _ => None,
    };
    let (Some(was), Some(is)) = (was, is) else { return was == is };
    match (name, number(was), number(is)) {
        ("volume", Some(a), Some(b)) => relative(a, b, tolerances.volume),
        ("area", Some(a), Some(b)) => relative(a, b, tolerances.area),
        (SECONDS, Some(a), Some(b)) => {
            let (a, b) = (a.max(Tolerances::AT_ONCE), b.max(Tolerances::AT_ONCE));
            a <= tolerances.seconds * b && b <= tolerances.seconds * a
        }
        _ => match (was, is) {
            (Measure::Point(a), Measure::Point(b)) => {
                let part = if name == "centroid" { tolerances.centroid } else { tolerances.extents };
                a.iter().zip(b).all(|(a, b)| (a - b).abs() <= part * size)
            }
            _ => was == is,
        },
    }
}

/// The baseline with what was measured now. Measures within their tolerance keep their old spelling, so that a
/// difference of versions shows what changed and nothing else.
#[must_use]
pub fn updated(baseline: &Baseline, surveyed: &[Surveyed]) -> Baseline {
    let mut part = BTreeMap::new();
    for now in surveyed {
        let known = baseline.part.get(&now.name);
        let size = size(&now.measures);
        let kept = now.measures.iter().map(|(name, is)| {
            let was = known.and_then(|known| known.get(name));
            let same =
                name != DIGEST && was.is_some() && agree(name, was, Some(is), size, &baseline.tolerance);
            (name.clone(), was.filter(|_| same).unwrap_or(is).clone())
        });
        part.insert(now.name.clone(), kept.collect());
    }
    Baseline { version: Version, tolerance: baseline.tolerance, part }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(name: &str, measures: &[(&str, Measure)]) -> Surveyed {
        let measures = measures.iter().map(|(name, m)| ((*name).to_owned(), m.clone())).collect();
        Surveyed { name: name.to_owned(), measures, seconds: 0.1 }
    }

    fn baseline(parts: &[Surveyed]) -> Baseline {
        let empty = Baseline { version: Version, tolerance: Tolerances::default(), part: BTreeMap::new() };
        updated(&empty, parts)
    }

    #[test]
    fn each_outcome() {
        let digest = |text: &str| ("sha256", Measure::Word(text.to_owned()));
        let volume = |x: f64| ("volume", Measure::Number(x));
        let before = [
            part("a", &[digest("1"), volume(2.0)]),
            part("b", &[digest("2"), volume(3.0)]),
            part("c", &[digest("3"), volume(4.0)]),
            part("d", &[digest("4"), volume(5.0)]),
        ];
        let now = [
            part("a", &[digest("9"), volume(2.0 + 1e-7)]),
            part("b", &[digest("2"), volume(3.1)]),
            part("e", &[digest("3"), volume(4.0)]),
            part("f", &[digest("7"), volume(4.0)]),
        ];
        let found = compare(&baseline(&before), &now);
        let outcomes: Vec<(&str, Outcome)> =
            found.iter().map(|c| (c.part.as_str(), c.outcome.clone())).collect();
        let expected = [
            ("a", Outcome::Same),
            ("b", Outcome::Changed),
            ("d", Outcome::Missing),
            ("e", Outcome::Renamed { from: "c".to_owned() }),
            ("f", Outcome::New),
        ];
        assert_eq!(outcomes, expected);
        assert!(found[0].edited && !found[1].edited);
        assert_eq!(found[1].changes[0].to_string(), "volume: 3 before, 3.1 now (+3.333e-2 of it)");
        let kept = updated(&baseline(&before), &now);
        assert_eq!(kept.part["a"]["volume"], Measure::Number(2.0));
        assert_eq!(kept.part["b"]["volume"], Measure::Number(3.1));
    }
}
