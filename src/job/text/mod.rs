//! Text of a job file to `Node`s to a [`Job`], with every error placed in the text.

pub(in crate::job) mod json;
pub mod nearest;
pub(in crate::job) mod node;

use std::ops::Range;

use crate::job::file::Job;
use crate::job::text::node::{Entry, Node, NodeError, Value, decode};

/// The two spellings of a job file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Syntax {
    /// TOML 1.0.
    Toml,
    /// RFC 8259.
    Json,
}

/// A job file that is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message}{}", in_path(path))]
pub struct JobFileError {
    /// Byte range in the text.
    pub span: Range<usize>,
    /// The key on the way, `operation[0].factors`; empty at the top.
    pub path: String,
    /// Lower-case fragment: what was found, and what would have been right.
    pub message: String,
}

fn in_path(path: &str) -> String {
    if path.is_empty() { String::new() } else { format!(" (in `{path}`)") }
}

impl JobFileError {
    fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { span, path: String::new(), message: message.into() }
    }
}

/// Reads and checks a job file. No file is touched.
///
/// # Errors
/// The first thing that is wrong, at its place.
pub fn read(text: &str, syntax: Syntax) -> Result<Job, JobFileError> {
    if text.trim().is_empty() {
        let message = "the job file is empty; it needs at least `version`, `inputs` and `output`";
        return Err(JobFileError::new(0..0, message));
    }
    let node = match syntax {
        Syntax::Toml => toml_node(text)?,
        Syntax::Json => {
            crate::job::text::json::parse(text).map_err(|e| JobFileError::new(e.at..e.at + 1, e.message))?
        }
    };
    decode(&node).map_err(placed)
}

/// Reads one value in TOML's words, such as a selector or a region.
///
/// # Errors
/// As [`read`]; places count from the value's start.
pub fn read_value<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, JobFileError> {
    let text = format!("{KEY}{text}");
    let Value::Table(entries) = toml_node(&text)?.value else {
        return Err(JobFileError::new(0..0, "expected a value"));
    };
    let [entry] = entries.as_slice() else {
        return Err(JobFileError::new(0..0, "expected one value"));
    };
    decode(&entry.value).map_err(placed)
}

/// Makes a document of a value.
const KEY: &str = "value=";

fn placed(error: NodeError) -> JobFileError {
    let mut path = String::new();
    for step in error.path.iter().rev() {
        if !path.is_empty() && !step.starts_with('[') {
            path.push('.');
        }
        path.push_str(step);
    }
    JobFileError { span: error.span.unwrap_or(0..0), path, message: error.message }
}

fn toml_node(text: &str) -> Result<Node, JobFileError> {
    let table = toml::de::DeTable::parse(text)
        .map_err(|e| JobFileError::new(e.span().unwrap_or(0..0), e.message().replace('\n', ", ")))?;
    let span = table.span();
    Ok(Node { span, value: toml_table(table.get_ref())? })
}

fn toml_table(table: &toml::de::DeTable<'_>) -> Result<Value, JobFileError> {
    let mut entries = Vec::with_capacity(table.len());
    for (key, value) in table {
        let value = toml_value(value)?;
        entries.push(Entry { key: key.get_ref().to_string(), key_span: key.span(), value });
    }
    entries.sort_by_key(|entry| entry.key_span.start);
    Ok(Value::Table(entries))
}

// The TOML parser limits the nesting, and with it this recursion.
fn toml_value(value: &toml::Spanned<toml::de::DeValue<'_>>) -> Result<Node, JobFileError> {
    use toml::de::DeValue;
    let span = value.span();
    let number = |text: String| text.replace('_', "");
    let value = match value.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(integer) => {
            let parsed = i64::from_str_radix(&number(integer.as_str().to_owned()), integer.radix());
            Value::Integer(parsed.map_err(|_| JobFileError::new(span.clone(), "integer out of range"))?)
        }
        DeValue::Float(float) => {
            let parsed = number(float.as_str().to_owned()).parse();
            Value::Float(parsed.map_err(|_| JobFileError::new(span.clone(), "not a number"))?)
        }
        DeValue::Boolean(boolean) => Value::Boolean(*boolean),
        DeValue::Datetime(_) => return Err(JobFileError::new(span, "no key of a job takes a date")),
        DeValue::Array(items) => Value::List(items.iter().map(toml_value).collect::<Result<_, _>>()?),
        DeValue::Table(table) => toml_table(table)?,
    };
    Ok(Node { span, value })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::file::scale::Hold;
    use crate::job::file::{LengthSetting, Operation};
    use crate::model::Origin;
    use crate::units::Length;

    const HEAD: &str = "version = 1\ninputs = [\"a.step\"]\noutput = \"b.step\"\n";

    fn refused(rest: &str) -> (String, String) {
        let text = format!("{HEAD}{rest}");
        let error = read(&text, Syntax::Toml).expect_err("a job that is refused");
        (text[error.span.clone()].to_owned(), error.to_string())
    }

    #[test]
    fn errors_stand_at_the_innermost_place() {
        let scale = "[[operation]]\nkind = \"constrained_scale\"\n";
        let cases = [
            (
                "also = [\"stl\", \"obj\"]",
                "\"obj\"",
                "unknown value `obj`; known are `stl`, `off`, `3mf`, `glb`",
            ),
            ("[validate]\nwiht = []", "wiht", "unknown key `wiht`; did you mean `with`?"),
            ("[validate]\ntimeout = 0", "0", "0 is not a time"),
            (&format!("{scale}factors = [1, 2]"), "[1, 2]", "invalid length 2"),
            (&format!("{scale}factors = [1, 0, 2]"), "[1, 0, 2]", "0 is not a factor"),
            (
                &format!("{scale}factors = [1,1,1]\nhold = [{{ loops = \"outer\" }}]"),
                "\"outer\"",
                "unknown value",
            ),
            (&format!("{scale}factors = [1,1,1]\nhold = [{{}}]"), "{}", "exactly one of the keys"),
            (&format!("{scale}factors = [1,1,1]\nface = \"1042\""), "\"1042\"", "not the name of a record"),
            (&format!("{scale}factors = [1,1,1]\nface = {{ colour = \"red\" }}"), "\"red\"", "not a colour"),
            (&format!("{scale}factors = [1,1,1]\nface = {{}}"), "{}", "an empty selector"),
            (&format!("{scale}factors = [1,1,1]\ncontinuity = 3"), "3", "expected 0, 1 or 2"),
            ("a = \u{1}", "\u{1}", ""),
        ];
        for (rest, marked, message) in cases {
            let (found, said) = refused(rest);
            assert_eq!(found, marked, "{rest}: {said}");
            assert!(said.contains(message), "{rest}: {said}");
        }
    }

    #[test]
    fn both_syntaxes_give_the_same_job() {
        let toml = format!(
            "{HEAD}[[operation]]\nfactors = [1, 2.5, 3]\ncenter = [\"1 mm\", 2, 0]\nhold = [{{ edge = \"#7\" }}]\n\
             kind = \"constrained_scale\"\nface = [\"#1\", {{ near = [0, 0, 1] }}]\n"
        );
        let json = "{\"version\": 1, \"inputs\": [\"a.step\"], \"output\": \"b.step\", \"operation\": [{\
             \"factors\": [1, 2.5, 3], \"center\": [\"1 mm\", 2, 0], \"hold\": [{\"edge\": \"#7\"}],\
             \"kind\": \"constrained_scale\", \"face\": [\"#1\", {\"near\": [0, 0, 1]}]}]}";
        let job = read(&toml, Syntax::Toml).expect("TOML");
        assert_eq!(job, read(json, Syntax::Json).expect("JSON"));
        let Operation::ConstrainedScale(scale) = &job.operation[0] else { panic!("a scaling") };
        assert_eq!(scale.factors.0, [1.0, 2.5, 3.0]);
        assert_eq!(scale.hold, [Hold::Edge(Origin::Instance(7))]);
        assert_eq!(scale.center.expect("a centre")[0], LengthSetting(Length::Metres(1e-3)));
    }
}
