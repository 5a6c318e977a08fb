//! JUnit XML, as continuous integration shows it: a case for each part and each verdict about it.

use super::escaped;
use crate::job::failure::code;
use crate::job::report::{PartReport, Report};

/// One case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// What it is about.
    pub name: String,
    /// Seconds.
    pub seconds: f64,
    /// Why it did not pass: a stable word, a text, and whether it is an error of the surroundings rather than of the
    /// part.
    pub failure: Option<(String, String, Blame)>,
}

/// Who is to blame for a case that did not pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blame {
    /// The part or the job: a failure.
    Part,
    /// The program or the machine: an error.
    Surroundings,
}

/// The XML of a run.
#[must_use]
pub fn of_run(report: &Report) -> String {
    let cases: Vec<Case> = report.parts.iter().flat_map(cases).collect();
    let name = if report.job.is_empty() { "resurf" } else { &report.job };
    suite(name, &cases)
}

fn cases(part: &PartReport) -> Vec<Case> {
    let failure = part.failure.as_ref().map(|failure| {
        let surroundings =
            [code::VALIDATOR_MISSING, code::RESOURCE, code::IO, code::INTERNAL, code::INTERRUPTED];
        let blame = if surroundings.contains(&part.code) { Blame::Surroundings } else { Blame::Part };
        (failure.code.clone(), failure.message.clone(), blame)
    });
    let own = Case { name: part.input.clone(), seconds: part.seconds, failure };
    let verdicts = part.validators.iter().map(|verdict| {
        let refused = || ("validate.refused".to_owned(), verdict.messages.join("\n"), Blame::Part);
        Case {
            name: format!("{} by {}", part.input, verdict.validator.as_str()),
            seconds: verdict.seconds,
            failure: (!verdict.accepted).then(refused),
        }
    });
    std::iter::once(own).chain(verdicts).collect()
}

/// The XML of some cases under one name.
#[must_use]
pub fn suite(name: &str, cases: &[Case]) -> String {
    let blamed = |blame: Blame| {
        cases.iter().filter(|case| case.failure.as_ref().is_some_and(|(.., of)| *of == blame)).count()
    };
    let seconds: f64 = cases.iter().map(|case| case.seconds).sum();
    let name = escaped(name);
    let head = format!(
        "name=\"{name}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{seconds:.3}\"",
        cases.len(),
        blamed(Blame::Part),
        blamed(Blame::Surroundings)
    );
    let cases: String = cases.iter().map(|case| element(case, &name)).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {head}>\n<testsuite {head}>\n{cases}</testsuite>\n</testsuites>\n"
    )
}

fn element(case: &Case, class: &str) -> String {
    let head = format!(
        "<testcase classname=\"{class}\" name=\"{}\" time=\"{:.3}\"",
        escaped(&case.name),
        case.seconds
    );
    match &case.failure {
        None => format!("{head}/>\n"),
        Some((word, text, blame)) => {
            let tag = if *blame == Blame::Part { "failure" } else { "error" };
            let (word, text) = (escaped(word), escaped(text));
            format!("{head}>\n<{tag} type=\"{word}\" message=\"{text}\">{text}</{tag}>\n</testcase>\n")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_names_stay_text() {
        let case = |failure| Case { name: "<a & \"b\"\u{1}>".to_owned(), seconds: 0.5, failure };
        let failed = Some(("x.y".to_owned(), "]]></failure>".to_owned(), Blame::Part));
        let text = suite("s", &[case(None), case(failed)]);
        assert!(text.contains("tests=\"2\" failures=\"1\" errors=\"0\" time=\"1.000\""), "{text}");
        assert!(text.contains("name=\"&lt;a &amp; &quot;b&quot;\u{fffd}&gt;\""), "{text}");
        assert_eq!(text.matches("</failure>").count(), 1);
    }
}
