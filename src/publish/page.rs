//! The page of a run: a table of parts, each with why it failed, what changed, pictures, who validated it with which
//! numbers, and a link to its own page in three dimensions.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::escaped;
use crate::job::report::measure::Figures;
use crate::job::report::{DiagnosticReport, PartReport, Report, Status, WritePath};
use crate::job::side::illustrate::Illustration;
use crate::validate::Verdict;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A picture page of each part by its input's path; the link is relative to the page.
pub type Illustrations = BTreeMap<String, (Illustration, String)>;

/// The page of a run as HTML.
#[must_use]
pub fn of_run(report: &Report, illustrations: &Illustrations) -> String {
    let rows: String = report.parts.iter().map(|part| rows(part, illustrations.get(&part.input))).collect();
    let name = escaped(if report.job.is_empty() { "resurf" } else { &report.job });
    let summary = summary(report);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{name}</title>\n<style>{STYLE}</style>\n<h1>{name}</h1>\n{summary}\n<nav id=\"filters\"></nav>\n<table>\n\
         <thead><tr><th>part<th>result<th>how<th>seconds<th>memory<th>validated by<th>losses<th>found in the file</tr></thead>\n\
         {rows}</table>\n<script>{SCRIPT}</script>\n</html>\n"
    )
}

fn summary(report: &Report) -> String {
    let count = |wanted: fn(&PartReport) -> bool| report.parts.iter().filter(|part| wanted(part)).count();
    let failed = count(|part| part.status == Status::Failed);
    let share =
        report.shard.map(|shard| format!(", share {} of {}", shard.index, shard.count)).unwrap_or_default();
    format!(
        "<p class=\"{}\"><b>{} parts{share}: {} done, {failed} failed</b>, {} unchanged since the last run; exit code {}. {:.1} s, {}.</p>",
        if report.code == 0 { "good" } else { "bad" },
        report.parts.len(),
        report.parts.len() - failed,
        count(|part| part.unchanged),
        report.code,
        report.seconds,
        escaped(&report.program)
    )
}

/// A line of the table and what unfolds below it.
fn rows(part: &PartReport, illustration: Option<&(Illustration, String)>) -> String {
    let failed = part.status == Status::Failed;
    let word = if failed { "failed" } else { "done" };
    let result = match &part.failure {
        Some(failure) => format!("failed ({}) <code>{}</code>", part.code, escaped(&failure.code)),
        None if part.unchanged => "done before".to_owned(),
        None => "done".to_owned(),
    };
    let how = match part.write_path {
        _ if failed => "",
        Some(WritePath::Patched) => "patched",
        Some(WritePath::Verbatim) => "verbatim",
        None => "",
    };
    let memory = part.peak_bytes.map(|bytes| format!("{} MB", bytes / 1_000_000)).unwrap_or_default();
    let validators: Vec<&str> =
        part.validators.iter().filter(|v| v.accepted).map(|v| v.validator.as_str()).collect();
    let codes = |facts: &[DiagnosticReport]| {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        facts.iter().for_each(|fact| *counts.entry(fact.code.as_str()).or_insert(0) += 1);
        listed(counts)
    };
    let found = part.diagnostic_counts.iter().map(|(code, &count)| (code.as_str(), count)).collect();
    format!(
        "<tbody class=\"{word}\" data-how=\"{how}\">\n<tr class=\"part\"><td>{}<td>{result}<td>{how}<td>{:.2}<td>{memory}<td>{}<td>{}<td>{}</tr>\n\
         <tr class=\"more\"><td colspan=\"8\">{}</tr>\n</tbody>\n",
        escaped(&part.input),
        part.seconds,
        validators.join(", "),
        codes(&part.losses),
        listed(found),
        details(part, illustration)
    )
}

fn listed(counts: BTreeMap<&str, usize>) -> String {
    let one = |(code, count): (&str, usize)| format!("<code>{}</code> {count}", escaped(code));
    counts.into_iter().map(one).collect::<Vec<_>>().join("<br>")
}

fn details(part: &PartReport, illustration: Option<&(Illustration, String)>) -> String {
    let mut text = String::new();
    if let Some(failure) = &part.failure {
        let _ = write!(text, "<p class=\"why\">{}</p>", escaped(&failure.message));
    }
    if let Some((illustration, link)) = illustration {
        for picture in &illustration.pictures {
            let caption = escaped(&picture.caption);
            let _ = write!(
                text,
                "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\"><figcaption>{caption}</figcaption></figure>",
                picture.png
            );
        }
        let _ = write!(text, "<p><a href=\"{}\">Show in three dimensions</a></p>", escaped(link));
        list(&mut text, "Compared with the input", illustration.lines.iter().cloned());
    }
    let output = if part.status == Status::Done { part.output.as_str() } else { "" };
    let files = std::iter::once(output.to_owned()).filter(|name| !name.is_empty());
    list(&mut text, "Written", files.chain(part.side_files.iter().cloned()));
    list(&mut text, "Losses", part.losses.iter().map(fact));
    for operation in &part.operations {
        list(&mut text, &format!("Notes of {}", operation.kind), operation.notes.iter().map(fact));
        let measures = serde_json::to_string_pretty(&operation.measures).unwrap_or_default();
        let kind = escaped(&operation.kind);
        let _ = write!(
            text,
            "<details><summary>Measures of {kind}</summary><pre>{}</pre></details>",
            escaped(&measures)
        );
    }
    list(&mut text, "Validated", part.validators.iter().map(verdict));
    list(&mut text, "Violated as in the input", part.findings.iter().map(ToString::to_string));
    list(&mut text, "Found in the file", part.diagnostics.iter().map(fact));
    let figures = [("before", &part.before), ("after", &part.after)];
    let figures = figures.into_iter().filter_map(|(when, figures)| Some(counts(when, figures.as_ref()?)));
    list(&mut text, "Counts", figures);
    text
}

/// Lines of a list at most: what is beyond is in the report.
const LINES: usize = 40;

fn list(text: &mut String, title: &str, lines: impl Iterator<Item = String>) {
    let lines: Vec<String> = lines.collect();
    if lines.is_empty() {
        return;
    }
    let _ = write!(text, "<h2>{}</h2><ul>", escaped(title));
    for line in lines.iter().take(LINES) {
        let _ = write!(text, "<li>{}", escaped(line));
    }
    if lines.len() > LINES {
        let _ = write!(text, "<li>{} more in the report", lines.len() - LINES);
    }
    text.push_str("</ul>");
}

fn fact(fact: &DiagnosticReport) -> String {
    let entity = fact.entity.as_ref().map(|entity| format!("{entity} ")).unwrap_or_default();
    let line = fact.line.map(|line| format!(" (line {line})")).unwrap_or_default();
    format!("{} {}: {entity}{}{line}", fact.severity, fact.code, fact.message)
}

fn verdict(verdict: &Verdict) -> String {
    let figures = &verdict.figures;
    let whole = |name: &str, value: Option<u64>| value.map(|value| format!("{name} {value}"));
    let real = |name: &str, value: Option<f64>| value.map(|value| format!("{name} {value}"));
    let numbers: Vec<String> = [
        whole("solids", figures.solids),
        whole("shells", figures.shells),
        whole("faces", figures.faces),
        whole("edges", figures.edges),
        whole("triangles", figures.triangles),
        real("volume", figures.volume),
        real("area", figures.area),
        real("tolerance", figures.tolerance),
    ]
    .into_iter()
    .flatten()
    .collect();
    let version = figures.version.as_ref().map(|version| format!(" {version}")).unwrap_or_default();
    let word = if verdict.accepted { "accepts it" } else { "refuses it" };
    let messages = verdict.messages.join("; ");
    format!(
        "{}{version} {word} in {:.1} s: {}{}{messages}",
        verdict.validator.as_str(),
        verdict.seconds,
        numbers.join(", "),
        if messages.is_empty() { "" } else { "; " }
    )
}

fn counts(when: &str, figures: &Figures) -> String {
    let counts: Vec<String> = figures.counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
    let extents = figures
        .vertex_extents
        .map(|[a, b]| format!("; vertices within {a:?} to {b:?} {}", figures.units.join(", ")));
    format!("{when}: {}{}", counts.join(", "), extents.unwrap_or_default())
}
