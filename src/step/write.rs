//! The text of new records.
//!
//! [`RecordWriter`] sets commas, wraps long lines as other writers do, and encodes values. It knows no
//! schema: which attribute comes when is the caller's business, and a wrong nesting is a bug of the caller.

use super::exchange_structure::InstanceName;
use super::string;
use crate::number::format_real;
use crate::source::LineEnding;

/// Column behind which no token begins, as most writers have it (ISO 10303-21 itself sets no limit).
const LINE_LENGTH: usize = 80;

/// An open parenthesis.
#[derive(Debug, Clone, Copy)]
struct Level {
    /// Something stands in it.
    filled: bool,
    /// Its members are records without commas between them: a complex instance.
    complex: bool,
}

/// Builds the text of one record, or of one parameter.
///
/// ```
/// use resurf::source::LineEnding;
/// use resurf::step::{InstanceName, write::RecordWriter};
/// let mut record = RecordWriter::instance(InstanceName(7), LineEnding::Lf);
/// record.open("CARTESIAN_POINT").string("").open_list().real(0.5).real(-1.0).real(0.0).close().close();
/// assert_eq!(record.finish(), "#7=CARTESIAN_POINT('',(0.5,-1.,0.));");
/// ```
#[derive(Debug, Clone)]
pub struct RecordWriter {
    text: String,
    /// Columns that are taken on the first line before the text begins.
    margin: usize,
    line_start: usize,
    ending: LineEnding,
    levels: Vec<Level>,
    terminator: &'static str,
}

impl RecordWriter {
    /// Begins the record `#n=…;`.
    #[must_use]
    pub fn instance(name: InstanceName, ending: LineEnding) -> Self {
        Self {
            text: format!("{name}="),
            margin: 0,
            line_start: 0,
            ending,
            levels: Vec::new(),
            terminator: ";",
        }
    }

    /// Begins the text of a single parameter, to stand in an existing record; `column` is where it will stand,
    /// counted from 0.
    #[must_use]
    pub fn parameter(column: usize, ending: LineEnding) -> Self {
        Self {
            text: String::new(),
            margin: column,
            line_start: 0,
            ending,
            levels: Vec::new(),
            terminator: "",
        }
    }

    /// Places a token, with the comma before it where one belongs, on a new line when it would not fit.
    fn token(&mut self, token: &str) -> &mut Self {
        if let Some(level) = self.levels.last_mut() {
            if level.filled && !level.complex {
                self.text.push(',');
            }
            level.filled = true;
        }
        self.piece(token)
    }

    fn piece(&mut self, token: &str) -> &mut Self {
        let column = self.margin + self.text.len() - self.line_start;
        // One more for the comma or parenthesis that follows.
        if self.ending != LineEnding::None && column > 0 && column + token.len() + 1 > LINE_LENGTH {
            self.text.push_str(self.ending.as_str());
            self.line_start = self.text.len();
            self.margin = 0;
        }
        self.text.push_str(token);
        self
    }

    fn descend(&mut self, complex: bool) -> &mut Self {
        self.levels.push(Level { filled: false, complex });
        self
    }

    /// `KEYWORD(`: a record, a partial entity, or a typed parameter.
    pub fn open(&mut self, keyword: &str) -> &mut Self {
        self.token(&format!("{keyword}(")).descend(false)
    }

    /// `(` of a complex instance, whose members are partial entities.
    pub fn open_complex(&mut self) -> &mut Self {
        self.token("(").descend(true)
    }

    /// `(` of a list.
    pub fn open_list(&mut self) -> &mut Self {
        self.token("(").descend(false)
    }

    /// `)` of whatever was opened last.
    ///
    /// # Panics
    /// When nothing is open.
    pub fn close(&mut self) -> &mut Self {
        assert!(self.levels.pop().is_some(), "nothing is open");
        self.text.push(')');
        self
    }

    /// A real (see [`format_real`]).
    ///
    /// # Panics
    /// When the value is not finite.
    pub fn real(&mut self, value: f64) -> &mut Self {
        self.token(&format_real(value))
    }

    /// A list of reals.
    ///
    /// # Panics
    /// When a value is not finite.
    pub fn reals(&mut self, values: impl IntoIterator<Item = f64>) -> &mut Self {
        self.open_list();
        for value in values {
            self.real(value);
        }
        self.close()
    }

    /// An integer.
    pub fn integer(&mut self, value: i64) -> &mut Self {
        self.token(&value.to_string())
    }

    /// A list of integers.
    pub fn integers(&mut self, values: impl IntoIterator<Item = i64>) -> &mut Self {
        self.open_list();
        for value in values {
            self.integer(value);
        }
        self.close()
    }

    /// A string, encoded.
    pub fn string(&mut self, value: &str) -> &mut Self {
        self.token(&string::encode(value))
    }

    /// An enumeration item by its name without points.
    pub fn enumeration(&mut self, name: &str) -> &mut Self {
        self.token(&format!(".{name}."))
    }

    /// `.T.` or `.F.`: the value is data, not an option.
    pub fn boolean(&mut self, value: bool) -> &mut Self {
        self.enumeration(if value { "T" } else { "F" })
    }

    /// A reference.
    pub fn reference(&mut self, name: InstanceName) -> &mut Self {
        self.token(&name.to_string())
    }

    /// A list of references.
    pub fn references(&mut self, names: impl IntoIterator<Item = InstanceName>) -> &mut Self {
        self.open_list();
        for name in names {
            self.reference(name);
        }
        self.close()
    }

    /// `$`
    pub fn omitted(&mut self) -> &mut Self {
        self.token("$")
    }

    /// `*`
    pub fn derived(&mut self) -> &mut Self {
        self.token("*")
    }

    /// A parameter as it stands in a file.
    pub fn verbatim(&mut self, parameter: &str) -> &mut Self {
        self.token(parameter)
    }

    /// The whole text, without a line end.
    ///
    /// # Panics
    /// When something is still open.
    #[must_use]
    pub fn finish(mut self) -> String {
        assert!(self.levels.is_empty(), "{} parentheses are open", self.levels.len());
        self.text.push_str(self.terminator);
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn complex_records_have_no_commas_between_partial_entities() {
        let mut record = RecordWriter::instance(InstanceName(3), LineEnding::Lf);
        record.open_complex().open("A").integers([1, 2]).derived().close().open("B").close().close();
        assert_eq!(record.finish(), "#3=(A((1,2),*)B());");
    }

    #[test]
    fn long_records_wrap_at_80_columns_and_one_line_files_do_not() {
        let text = |ending| {
            let mut record = RecordWriter::instance(InstanceName(1), ending);
            record.open("X").reals((0..100).map(f64::from)).boolean(true).close();
            record.finish()
        };
        let wrapped = text(LineEnding::CrLf);
        assert!(wrapped.split("\r\n").count() > 3);
        assert!(wrapped.split("\r\n").all(|line| line.len() <= LINE_LENGTH + 1), "{wrapped}");
        assert_eq!(wrapped.replace("\r\n", ""), text(LineEnding::None));
        let mut late = RecordWriter::parameter(78, LineEnding::Lf);
        late.open_list().real(1.5).close();
        assert_eq!(late.finish(), "(\n1.5)");
    }
}
