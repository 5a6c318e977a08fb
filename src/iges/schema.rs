//! One table for reading and writing: forms, names and parameters of the entity types.
//!
//! The table is `schemas/iges/entities.tsv`, read once. It says how many parameters a list has by those before it, so that
//! what follows a list can be found. It checks no value and knows no rule beyond order and kind.
//!
//! INVARIANT: every [`Entity`](super::Entity) has a row; a test holds that.

use std::sync::OnceLock;

const TABLE: &str = include_str!("../../schemas/iges/entities.tsv");

/// What the value of a field is, or the members of its list are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FieldKind {
    /// An integer, a count or a logical value.
    Integer,
    /// A number.
    Real,
    /// A Hollerith text.
    Text,
    /// A pointer to an entry; zero for none.
    Pointer,
    /// Several fields that repeat together.
    Group(Vec<FieldRow>),
}

/// One field of an entity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldRow {
    /// Name in lower case.
    pub name: &'static str,
    /// What it is.
    pub kind: FieldKind,
    /// How many members its list has; `None` for a single value.
    pub count: Option<Count>,
}

/// A count by other fields: sums and products of integers and of fields of the same level before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Count {
    /// A number.
    Number(i64),
    /// The value of a field: its place among its siblings.
    Field(usize),
    /// A sum.
    Sum(Box<Count>, Box<Count>),
    /// A product.
    Product(Box<Count>, Box<Count>),
}

impl Count {
    /// The count for the values of the fields before it; negative ones count as none, greater ones than
    /// [`usize`] holds as many.
    #[must_use]
    pub fn evaluate(&self, values: &[i64]) -> usize {
        usize::try_from(self.value(values).max(0)).unwrap_or(usize::MAX)
    }

    fn value(&self, values: &[i64]) -> i64 {
        match self {
            Self::Number(number) => *number,
            Self::Field(place) => values.get(*place).copied().unwrap_or(0),
            Self::Sum(a, b) => a.value(values).saturating_add(b.value(values)),
            Self::Product(a, b) => a.value(values).saturating_mul(b.value(values)),
        }
    }
}

/// The row of an entity type in some of its forms.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntityRow {
    /// Type number.
    pub entity_type: i32,
    /// Forms, each from and to; empty for any.
    pub forms: Vec<(i32, i32)>,
    /// Name in upper case.
    pub name: &'static str,
    /// Parameters behind the type, without the pointers to associativities and properties. Empty where they are not read.
    pub fields: Vec<FieldRow>,
    /// Whether the parameters are those of the standard: where they are not read, nothing is known of them.
    pub is_read: bool,
    /// Clause of IGES 5.3 where it is known.
    pub clause: &'static str,
}

/// The row of a type and form; where the form is unknown, the first row of the type.
#[must_use]
pub fn row(entity_type: i32, form: i32) -> Option<&'static EntityRow> {
    let table = table();
    let first = table.partition_point(|row| row.entity_type < entity_type);
    let of_type = table[first..].iter().take_while(|row| row.entity_type == entity_type);
    let fits = |row: &&EntityRow| {
        row.forms.is_empty() || row.forms.iter().any(|&(from, to)| (from..=to).contains(&form))
    };
    of_type.clone().find(fits).or_else(|| of_type.clone().next())
}

/// All rows, by type number.
#[must_use]
pub fn table() -> &'static [EntityRow] {
    static ROWS: OnceLock<Vec<EntityRow>> = OnceLock::new();
    ROWS.get_or_init(|| {
        TABLE
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(|line| entity_row(line).expect("a row of the table"))
            .collect()
    })
}

fn entity_row(line: &'static str) -> Option<EntityRow> {
    let mut cells = line.split('\t');
    let entity_type: i32 = cells.next()?.parse().ok()?;
    let forms = forms(cells.next()?)?;
    let name = cells.next()?;
    let mut parser = Parser { text: cells.next()?, names: Vec::new() };
    let fields = parser.fields()?;
    let is_read = !fields.is_empty() || entity_type == 0;
    Some(EntityRow { entity_type, forms, name, fields, is_read, clause: cells.next()? })
}

fn forms(text: &str) -> Option<Vec<(i32, i32)>> {
    if text == "*" {
        return Some(Vec::new());
    }
    let range = |part: &str| match part.get(1..).and_then(|rest| rest.find('-')) {
        Some(dash) => Some((part[..=dash].parse().ok()?, part[dash + 2..].parse().ok()?)),
        None => part.parse().ok().map(|form| (form, form)),
    };
    text.split(',').map(range).collect()
}

/// Reads the fourth column.
struct Parser {
    text: &'static str,
    /// Names of the fields that are read, level by level.
    names: Vec<Vec<&'static str>>,
}

impl Parser {
    fn fields(&mut self) -> Option<Vec<FieldRow>> {
        self.names.push(Vec::new());
        let mut fields = Vec::new();
        loop {
            self.text = self.text.trim_start();
            if self.text.is_empty() || self.text.starts_with(')') {
                self.names.pop();
                return Some(fields);
            }
            let field = self.field()?;
            self.names.last_mut()?.push(field.name);
            fields.push(field);
        }
    }

    fn field(&mut self) -> Option<FieldRow> {
        let (name, rest) = self.text.split_once(':')?;
        self.text = rest;
        let kind = if self.eat("(") {
            let fields = self.fields()?;
            self.eat(")").then_some(FieldKind::Group(fields))?
        } else {
            let end = self.text.find([' ', '[', ')']).unwrap_or(self.text.len());
            let (word, rest) = self.text.split_at(end);
            self.text = rest;
            match word {
                "int" => FieldKind::Integer,
                "real" => FieldKind::Real,
                "text" => FieldKind::Text,
                "ptr" => FieldKind::Pointer,
                _ => return None,
            }
        };
        let count = if self.eat("[") { Some(self.sum()?) } else { None };
        (count.is_none() || self.eat("]")).then_some(FieldRow { name, kind, count })
    }

    fn eat(&mut self, token: &str) -> bool {
        let rest = self.text.strip_prefix(token);
        self.text = rest.unwrap_or(self.text);
        rest.is_some()
    }

    fn sum(&mut self) -> Option<Count> {
        let mut sum = self.product()?;
        while self.eat("+") {
            sum = Count::Sum(Box::new(sum), Box::new(self.product()?));
        }
        Some(sum)
    }

    fn product(&mut self) -> Option<Count> {
        let mut product = self.factor()?;
        while self.eat("*") {
            product = Count::Product(Box::new(product), Box::new(self.factor()?));
        }
        Some(product)
    }

    fn factor(&mut self) -> Option<Count> {
        if self.eat("(") {
            let inner = self.sum()?;
            return self.eat(")").then_some(inner);
        }
        let end = self.text.find(['+', '*', ')', ']'])?;
        let (word, rest) = self.text.split_at(end);
        self.text = rest;
        let place = self.names.last()?.iter().position(|name| *name == word);
        place.map(Count::Field).or_else(|| word.parse().ok().map(Count::Number))
    }
}

#[cfg(test)]
mod tests {
    use super::super::entity::Entity;
    use super::*;

    #[test]
    fn every_entity_has_a_row_and_rows_ascend() {
        assert!(table().windows(2).all(|pair| pair[0].entity_type <= pair[1].entity_type));
        for entity in Entity::ALL {
            assert!(row(entity.number(), 0).is_some(), "{entity:?}");
        }
        assert!(row(7, 0).is_none());
    }

    #[test]
    fn forms_choose_the_row() {
        assert_eq!(row(192, 1).map(|row| row.fields.len()), Some(4));
        assert_eq!(row(192, 0).map(|row| row.fields.len()), Some(3));
        assert_eq!(row(108, -1).map(|row| row.name), Some("PLANE"));
        assert_eq!(row(406, 27).map(|row| (row.name, row.is_read)), Some(("PROPERTY", false)));
        // A form that the standard does not know is read as the first that it knows.
        assert_eq!(row(510, 0).map(|row| row.name), Some("FACE"));
    }

    #[test]
    fn counts_follow_from_the_fields_before() {
        let surface = row(128, 0).expect("a row");
        let count = |name: &str| {
            let field = surface.fields.iter().find(|field| field.name == name).expect("a field");
            field.count.clone().expect("a list").evaluate(&[3, 4, 2, 1])
        };
        assert_eq!([count("knots_u"), count("knots_v"), count("weights")], [7, 7, 20]);
        assert_eq!(count("control_points"), 60);
        let huge = Count::Product(Box::new(Count::Field(0)), Box::new(Count::Field(0)));
        assert_eq!(huge.evaluate(&[i64::MAX]), i64::MAX as usize);
        assert_eq!(huge.evaluate(&[-5]), 25);
        assert_eq!(Count::Field(0).evaluate(&[-5]), 0);
    }
}
