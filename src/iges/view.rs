//! Access by name to the parameters of any entity of the [schema].
//!
//! One view instead of a reader per entity: it knows the order of the fields, not their meaning. One pass over the text
//! finds where each field begins; values are decoded when asked. It reports nothing: whoever asks says what is wrong.

use super::directory_entry::EntryNumber;
use super::exchange_structure::Instance;
use super::parameter::{Parameter, ParameterKind, Parameters};
use super::schema::{self, EntityRow, FieldKind, FieldRow};

/// A field is not what the schema says.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{field} is {found}, expected {expected}")]
pub struct FieldError {
    /// Name of the field.
    pub field: &'static str,
    /// What stands there instead.
    pub found: String,
    /// What the schema asks for.
    pub expected: String,
}

/// What [`FieldError::found`] says of a number whose value is not finite.
pub const OUT_OF_RANGE: &str = "a number out of range";

/// An entity whose parameters the schema table knows.
#[derive(Debug, Clone)]
pub struct EntityView<'a> {
    instance: Instance<'a>,
    row: &'static EntityRow,
    fields: Fields<'a>,
    /// Behind the last field.
    behind: Parameters<'a>,
}

/// Pointers behind the fields of any entity (IGES 5.3 section 2.2.4.5.2).
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Trailing {
    /// Associativities, notes and templates.
    pub associativities: Vec<EntryNumber>,
    /// Properties.
    pub properties: Vec<EntryNumber>,
}

impl<'a> EntityView<'a> {
    /// The view of an entity, unless the table does not know its parameters.
    #[must_use]
    pub fn of(instance: Instance<'a>) -> Option<Self> {
        let entry = instance.entry();
        let row = schema::row(entry.entity_type, entry.form).filter(|row| row.is_read)?;
        let mut cursor = instance.parameters();
        let fields = Fields::locate(&row.fields, &mut cursor);
        Some(Self { instance, row, fields, behind: cursor })
    }

    /// The entity.
    #[must_use]
    pub fn instance(&self) -> Instance<'a> {
        self.instance
    }

    /// Its name.
    #[must_use]
    pub fn number(&self) -> EntryNumber {
        self.instance.number()
    }

    /// Its row of the schema.
    #[must_use]
    pub fn row(&self) -> &'static EntityRow {
        self.row
    }

    /// Its fields.
    #[must_use]
    pub fn fields(&self) -> &Fields<'a> {
        &self.fields
    }

    /// The parameters behind its fields.
    #[must_use]
    pub fn behind(&self) -> Parameters<'a> {
        self.behind.clone()
    }

    /// Pointers to associativities and properties. What is no such pointer ends the list.
    #[must_use]
    pub fn trailing(&self) -> Trailing {
        let mut cursor = self.behind.clone();
        let associativities = pointer_list(&mut cursor);
        Trailing { associativities, properties: pointer_list(&mut cursor) }
    }

    /// Every pointer among the fields, with its place: what the entity is made of.
    #[must_use]
    pub fn parts(&self) -> Vec<(EntryNumber, Parameter<'a>)> {
        let mut found = Vec::new();
        self.fields.pointers(&mut found);
        found
    }

    /// Every pointer among the parameters, with its place: those of the fields, then those behind them.
    #[must_use]
    pub fn pointers(&self) -> Vec<(EntryNumber, Parameter<'a>)> {
        let mut found = self.parts();
        let mut cursor = self.behind.clone();
        for _ in 0..2 {
            let count = cursor.next().and_then(|count| count.as_i64()).unwrap_or(0);
            let members = cursor.by_ref().take(usize::try_from(count).unwrap_or(0));
            found.extend(members.filter_map(|member| Some((member.as_pointer()?, member))));
        }
        found
    }
}

fn pointer_list(cursor: &mut Parameters<'_>) -> Vec<EntryNumber> {
    let count = cursor.next().and_then(|count| count.as_i64()).unwrap_or(0);
    cursor
        .by_ref()
        .take(usize::try_from(count).unwrap_or(0))
        .map_while(|member| member.as_pointer())
        .collect()
}

/// Where a field begins, and how many members its list has in the file.
#[derive(Debug, Clone)]
struct Place<'a> {
    cursor: Parameters<'a>,
    /// By the counts before it: one for a single value.
    expected: usize,
    /// What stands in the file of these.
    found: usize,
}

/// Fields of an entity, or of one member of a group.
#[derive(Debug, Clone)]
pub struct Fields<'a> {
    rows: &'static [FieldRow],
    places: Vec<Place<'a>>,
}

impl<'a> Fields<'a> {
    fn locate(rows: &'static [FieldRow], cursor: &mut Parameters<'a>) -> Self {
        let mut places = Vec::with_capacity(rows.len());
        walk(rows, cursor, &mut |place| places.push(place));
        Self { rows, places }
    }

    fn place(&self, field: &str) -> Option<(usize, &FieldRow, &Place<'a>)> {
        let at = self.rows.iter().position(|row| row.name == field);
        debug_assert!(at.is_some(), "no field {field}");
        at.map(|at| (at, &self.rows[at], &self.places[at]))
    }

    /// The parameter of a field that is no list, or the first of a list.
    #[must_use]
    pub fn get(&self, field: &str) -> Option<Parameter<'a>> {
        let (_, _, place) = self.place(field)?;
        place.cursor.clone().next().filter(|_| place.found > 0)
    }

    /// The parameters of a list, those that are there.
    pub fn list(&self, field: &str) -> impl Iterator<Item = Parameter<'a>> + use<'a> {
        let place = self.place(field).map(|(_, _, place)| place.clone());
        place.into_iter().flat_map(|place| place.cursor.take(place.found))
    }

    fn required(&self, field: &'static str, expected: &str) -> Result<Parameter<'a>, FieldError> {
        let missing = || FieldError { field, found: "missing".to_owned(), expected: expected.to_owned() };
        self.get(field).ok_or_else(missing)
    }

    /// An integer; a default counts as zero.
    ///
    /// # Errors
    /// [`FieldError`] when the field is missing or something else.
    pub fn integer(&self, field: &'static str) -> Result<i64, FieldError> {
        let parameter = self.required(field, "an integer")?;
        if parameter.is_default() {
            return Ok(0);
        }
        parameter.as_i64().ok_or_else(|| wrong(field, &parameter, "an integer"))
    }

    /// A count: an integer that is not negative.
    ///
    /// # Errors
    /// [`FieldError`] when the field is missing, negative or something else.
    pub fn count(&self, field: &'static str) -> Result<usize, FieldError> {
        let number = self.integer(field)?;
        let negative = |_| FieldError { field, found: number.to_string(), expected: "a count".to_owned() };
        usize::try_from(number).map_err(negative)
    }

    /// A number; a default counts as zero.
    ///
    /// # Errors
    /// [`FieldError`] when the field is missing or no finite number.
    pub fn real(&self, field: &'static str) -> Result<f64, FieldError> {
        self.real_or(field, 0.0)
    }

    /// A number, or its default.
    ///
    /// # Errors
    /// [`FieldError`] when the field is missing or no finite number.
    pub fn real_or(&self, field: &'static str, default: f64) -> Result<f64, FieldError> {
        let parameter = self.required(field, "a number")?;
        if parameter.is_default() {
            return Ok(default);
        }
        parameter.as_f64().ok_or_else(|| wrong(field, &parameter, "a number"))
    }

    /// A list of numbers; defaults count as zeros.
    ///
    /// # Errors
    /// [`FieldError`] when members are missing or no finite numbers.
    pub fn reals(&self, field: &'static str) -> Result<Vec<f64>, FieldError> {
        let (_, _, place) = self.place(field).ok_or_else(|| missing(field))?;
        if place.found < place.expected {
            return Err(too_few(field, place));
        }
        let mut cursor = place.cursor.clone();
        let mut values = Vec::with_capacity(place.found);
        for _ in 0..place.found {
            match cursor.next_real() {
                Some(Ok(value)) => values.push(value),
                Some(Err(parameter)) => return Err(wrong(field, &parameter, "a number")),
                None => return Err(too_few(field, place)),
            }
        }
        Ok(values)
    }

    /// As many numbers of a list as asked for; those that the list has not count as zeros.
    ///
    /// # Errors
    /// [`FieldError`] when members are no finite numbers, or none is there.
    pub fn array<const N: usize>(&self, field: &'static str) -> Result<[f64; N], FieldError> {
        let mut values = [0.0; N];
        self.required(field, "numbers")?;
        for (value, parameter) in values.iter_mut().zip(self.list(field)) {
            if !parameter.is_default() {
                *value = parameter.as_f64().ok_or_else(|| wrong(field, &parameter, "a number"))?;
            }
        }
        Ok(values)
    }

    /// A pointer that must lead somewhere.
    ///
    /// # Errors
    /// [`FieldError`] when the field is missing, zero or something else.
    pub fn pointer(&self, field: &'static str) -> Result<EntryNumber, FieldError> {
        let parameter = self.required(field, "a pointer")?;
        parameter.as_pointer().ok_or_else(|| wrong(field, &parameter, "a pointer"))
    }

    /// A pointer that may lead nowhere.
    #[must_use]
    pub fn optional_pointer(&self, field: &str) -> Option<EntryNumber> {
        self.get(field)?.as_pointer()
    }

    /// A list of pointers.
    ///
    /// # Errors
    /// [`FieldError`] when members are missing or no pointers.
    pub fn pointers_of(&self, field: &'static str) -> Result<Vec<EntryNumber>, FieldError> {
        let (_, _, place) = self.place(field).ok_or_else(|| missing(field))?;
        if place.found < place.expected {
            return Err(too_few(field, place));
        }
        self.list(field)
            .map(|parameter| parameter.as_pointer().ok_or_else(|| wrong(field, &parameter, "a pointer")))
            .collect()
    }

    /// A text; empty when it is left out or something else.
    #[must_use]
    pub fn text(&self, field: &str) -> String {
        let text = self.get(field).and_then(|parameter| parameter.as_str());
        text.map(|text| text.trim().to_owned()).unwrap_or_default()
    }

    /// The members of a group, those that are there whole.
    ///
    /// # Errors
    /// [`FieldError`] when members are missing.
    pub fn group(&self, field: &'static str) -> Result<Vec<Fields<'a>>, FieldError> {
        let (at, _, place) = self.place(field).ok_or_else(|| missing(field))?;
        let FieldKind::Group(rows) = &self.rows[at].kind else { return Err(missing(field)) };
        if place.found < place.expected {
            return Err(too_few(field, place));
        }
        let mut cursor = place.cursor.clone();
        Ok((0..place.found).map(|_| Fields::locate(rows, &mut cursor)).collect())
    }

    fn pointers(&self, found: &mut Vec<(EntryNumber, Parameter<'a>)>) {
        for (row, place) in self.rows.iter().zip(&self.places) {
            match &row.kind {
                FieldKind::Pointer => found.extend(
                    place.cursor.clone().take(place.found).filter_map(|p| Some((p.as_pointer()?, p))),
                ),
                FieldKind::Group(rows) => {
                    let mut cursor = place.cursor.clone();
                    for _ in 0..place.found {
                        Fields::locate(rows, &mut cursor).pointers(found);
                    }
                }
                FieldKind::Integer | FieldKind::Real | FieldKind::Text => {}
            }
        }
    }
}

/// Passes over the fields of a row and tells where each begins. A list ends early when the record does.
fn walk<'a>(rows: &'static [FieldRow], cursor: &mut Parameters<'a>, see: &mut dyn FnMut(Place<'a>)) {
    let mut values = Vec::with_capacity(rows.len());
    for row in rows {
        let start = cursor.clone();
        let expected = row.count.as_ref().map_or(1, |count| count.evaluate(&values));
        let mut value = 0;
        let found = match &row.kind {
            FieldKind::Group(members) => {
                let whole = |cursor: &mut Parameters<'a>| {
                    walk(members, cursor, &mut |_| {});
                    !cursor.is_unterminated()
                };
                // An empty record has no member, though a member may have no parameter.
                (0..expected).take_while(|_| !cursor.is_through() && whole(cursor)).count()
            }
            FieldKind::Integer if row.count.is_none() => {
                let parameter = cursor.next();
                value = parameter.and_then(|parameter| parameter.as_i64()).unwrap_or(0);
                usize::from(parameter.is_some())
            }
            _ => cursor.skip_over(expected),
        };
        values.push(value);
        see(Place { cursor: start, expected, found });
    }
}

fn missing(field: &'static str) -> FieldError {
    FieldError { field, found: "missing".to_owned(), expected: "it".to_owned() }
}

fn too_few(field: &'static str, place: &Place<'_>) -> FieldError {
    FieldError {
        field,
        found: format!("a list of {}", place.found),
        expected: format!("{} members", place.expected),
    }
}

fn wrong(field: &'static str, parameter: &Parameter<'_>, expected: &str) -> FieldError {
    let text = String::from_utf8_lossy(&parameter.text()).into_owned();
    let found = match parameter.kind() {
        ParameterKind::Default => "left out".to_owned(),
        ParameterKind::String => "a text".to_owned(),
        ParameterKind::Malformed if looks_like_number(&text) => OUT_OF_RANGE.to_owned(),
        ParameterKind::Integer | ParameterKind::Real | ParameterKind::Malformed => format!("`{text}`"),
    };
    FieldError { field, found, expected: expected.to_owned() }
}

/// Whether a text is spelled as a number, whatever its value.
fn looks_like_number(text: &str) -> bool {
    let digits = text.trim_start_matches(['+', '-', '.']);
    digits.starts_with(|c: char| c.is_ascii_digit())
        && text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.EeDd".contains(&byte))
}

#[cfg(test)]
mod tests {
    use super::super::exchange_structure::ExchangeStructure;
    use super::*;
    use crate::source::Source;

    /// A file with one entity of a type, form and parameters.
    fn file(entity_type: i32, form: i32, parameters: &str) -> ExchangeStructure {
        let data: Vec<&str> =
            parameters.as_bytes().chunks(64).map(|c| std::str::from_utf8(c).expect("ASCII")).collect();
        let mut text = format!("{:72}S      1\n{:72}G      1\n", "", "1H,,1H;;");
        text += &format!("{entity_type:8}{:8}{:56}D      1\n", 1, "");
        text += &format!("{entity_type:8}{:16}{:8}{form:8}{:32}D      2\n", "", data.len(), "");
        for (at, line) in data.iter().enumerate() {
            text += &format!("{line:64}{:8}P{:7}\n", 1, at + 1);
        }
        text += &format!("S      1G      1D      2P{:7}{:40}T      1\n", data.len(), "");
        let mut sink = Vec::new();
        let structure = ExchangeStructure::parse(Source::new(text.into_bytes()).expect("small"), &mut sink);
        assert_eq!(sink, []);
        structure
    }

    fn check(entity_type: i32, form: i32, parameters: &str, see: impl FnOnce(EntityView<'_>)) {
        let structure = file(entity_type, form, parameters);
        see(EntityView::of(structure.instance_at(0).expect("one entity")).expect("a known type"));
    }

    #[test]
    fn lists_and_groups_are_found_by_their_counts() {
        let text = "508,2,0,11,3,1,1,0,21,0,13,4,0,2,0,23,1,25,1,31,1,33;";
        check(508, 1, text, |view| {
            let edges = view.fields().group("edges").expect("two edges");
            let lists: Vec<_> = edges.iter().map(|edge| edge.pointer("list")).collect();
            assert_eq!(lists, [Ok(EntryNumber(11)), Ok(EntryNumber(13))]);
            let pcurves = edges[1].group("pcurves").expect("two");
            assert_eq!(pcurves[1].pointer("curve"), Ok(EntryNumber(25)));
            let trailing =
                Trailing { associativities: vec![EntryNumber(31)], properties: vec![EntryNumber(33)] };
            assert_eq!(view.trailing(), trailing);
            let pointers: Vec<u32> = view.pointers().iter().map(|(number, _)| number.0).collect();
            assert_eq!(pointers, [11, 21, 13, 23, 25, 31, 33]);
        });
    }

    #[test]
    fn values_are_read_by_name_and_defaults_are_zero() {
        check(100, 0, "100,2.,,1.,3.,1.,3.,1.;", |view| {
            let fields = view.fields();
            assert_eq!((fields.real("z"), fields.array("center")), (Ok(2.0), Ok([0.0, 1.0])));
            assert_eq!(fields.reals("end"), Ok(vec![3.0, 1.0]));
        });
        check(314, 0, "314,10.,20.,30.,4HBlue;", |view| assert_eq!(view.fields().text("name"), "Blue"));
    }

    #[test]
    fn hostile_counts_end_in_errors() {
        check(502, 1, "502,999999999999,1.,2.,3.;", |view| {
            let error = view.fields().reals("vertices").expect_err("too few");
            assert_eq!(error.to_string(), "vertices is a list of 3, expected 2999999999997 members");
        });
        check(514, 1, "514,-3,1,1;", |view| {
            assert!(view.fields().count("count").is_err());
            assert_eq!(view.fields().group("faces").map(|faces| faces.len()), Ok(0));
        });
        check(508, 1, "508,9223372036854775807;", |view| assert!(view.fields().group("edges").is_err()));
        check(116, 0, "116,1.E999,x,3Habc;", |view| {
            let error = view.fields().array::<3>("coordinates").expect_err("not finite");
            assert_eq!(error.found, OUT_OF_RANGE);
        });
    }
}
