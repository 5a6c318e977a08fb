//! JSON with places: RFC 8259 to [`Node`]s.
//!
//! serde_json keeps no places of values, and a job file's errors must show theirs.

use crate::job::text::node::{Entry, Node, Value};

/// Where the text stops being JSON.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JsonError {
    /// Byte offset.
    pub at: usize,
    /// Lower-case fragment.
    pub message: String,
}

/// Nesting beyond this is refused: a job nests six deep.
const DEPTH: usize = 64;

/// Parses one JSON value with white space around it.
///
/// # Errors
/// [`JsonError`] at the first byte that cannot go on.
pub fn parse(text: &str) -> Result<Node, JsonError> {
    let mut parser = Parser { text, at: 0 };
    let node = parser.value(0)?;
    parser.space();
    if parser.at < text.len() { Err(parser.error("expected the end")) } else { Ok(node) }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
}

impl Parser<'_> {
    fn error(&self, message: impl Into<String>) -> JsonError {
        JsonError { at: self.at, message: message.into() }
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    fn take(&mut self, byte: u8) -> Result<(), JsonError> {
        self.space();
        if self.peek() == Some(byte) {
            self.at += 1;
            return Ok(());
        }
        Err(self.error(format!("expected `{}`", char::from(byte))))
    }

    fn value(&mut self, depth: usize) -> Result<Node, JsonError> {
        self.space();
        let start = self.at;
        if depth > DEPTH {
            return Err(self.error("nested too deep"));
        }
        let value = match self.peek() {
            Some(b'{') => self.table(depth)?,
            Some(b'[') => self.list(depth)?,
            Some(b'"') => Value::Text(self.string()?),
            _ => self.word()?,
        };
        Ok(Node { span: start..self.at, value })
    }

    fn table(&mut self, depth: usize) -> Result<Value, JsonError> {
        self.take(b'{')?;
        let mut entries: Vec<Entry> = Vec::new();
        self.space();
        if self.peek() == Some(b'}') {
            self.at += 1;
            return Ok(Value::Table(entries));
        }
        loop {
            self.space();
            let start = self.at;
            let key = self.string()?;
            if entries.iter().any(|entry| entry.key == key) {
                return Err(JsonError { at: start, message: format!("the key `{key}` stands twice") });
            }
            let key_span = start..self.at;
            self.take(b':')?;
            let value = self.value(depth + 1)?;
            entries.push(Entry { key, key_span, value });
            self.space();
            match self.peek() {
                Some(b',') => self.at += 1,
                _ => return self.take(b'}').map(|()| Value::Table(entries)),
            }
        }
    }

    fn list(&mut self, depth: usize) -> Result<Value, JsonError> {
        self.take(b'[')?;
        let mut items = Vec::new();
        self.space();
        if self.peek() == Some(b']') {
            self.at += 1;
            return Ok(Value::List(items));
        }
        loop {
            items.push(self.value(depth + 1)?);
            self.space();
            match self.peek() {
                Some(b',') => self.at += 1,
                _ => return self.take(b']').map(|()| Value::List(items)),
            }
        }
    }

    fn string(&mut self) -> Result<String, JsonError> {
        let start = self.at;
        self.take(b'"')?;
        while let Some(byte) = self.peek() {
            self.at += if byte == b'\\' { 2 } else { 1 };
            if byte == b'"' {
                let quoted = self.text.get(start..self.at).unwrap_or_default();
                return serde_json::from_str(quoted)
                    .map_err(|e| JsonError { at: start, message: e.to_string() });
            }
        }
        Err(JsonError { at: start, message: "the text has no end".to_owned() })
    }

    fn word(&mut self) -> Result<Value, JsonError> {
        let start = self.at;
        while self.peek().is_some_and(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b)) {
            self.at += 1;
        }
        let word = self.text.get(start..self.at).unwrap_or_default();
        let number: Result<serde_json::Number, _> = serde_json::from_str(word);
        match (word, number) {
            ("null", _) => Ok(Value::Null),
            ("true", _) => Ok(Value::Boolean(true)),
            ("false", _) => Ok(Value::Boolean(false)),
            (_, Ok(number)) => Ok(match (number.as_i64(), number.as_f64()) {
                (Some(integer), _) => Value::Integer(integer),
                (None, Some(float)) => Value::Float(float),
                (None, None) => Value::Null,
            }),
            _ => Err(JsonError { at: start, message: "expected a value".to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_serde_json_on_what_is_json() {
        let texts = [
            "{}",
            "[1, 2.5, -3e2, \"a\\n\\u00e9\", true, null]",
            "{\"a\": {\"b\": []}}",
            "{\"a\": 1,}",
            "[1 2]",
            "[01]",
            "nul",
            "\"open",
            "{\"a\" 1}",
            "[] x",
            "\"\\q\"",
            "",
        ];
        for text in texts {
            let other: Result<serde_json::Value, _> = serde_json::from_str(text);
            assert_eq!(parse(text).is_ok(), other.is_ok(), "{text}");
        }
    }

    #[test]
    fn hostile_nesting_is_refused() {
        assert!(parse(&"[".repeat(1_000_000)).is_err());
    }

    #[test]
    fn places_are_byte_ranges() {
        let node = parse(" {\"a\": 12}").expect("valid");
        let Value::Table(entries) = &node.value else { panic!("a table") };
        assert_eq!((node.span.clone(), entries[0].key_span.clone()), (1..10, 2..5));
        assert_eq!(entries[0].value, Node { span: 7..9, value: Value::Integer(12) });
    }
}
