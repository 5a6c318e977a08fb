//! What an entity is to say: its type, form and parameters, before they are text.

use super::super::write::{ParameterText, RecordWriter};
use super::super::{EntryNumber, Parameter};
use crate::math::Affine;

/// A parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::iges) enum Value {
    Integer(i64),
    Real(f64),
    Pointer(Option<EntryNumber>),
}

impl Value {
    /// An upper index or a count.
    pub(in crate::iges) fn count(count: usize) -> Self {
        Self::Integer(i64::try_from(count).unwrap_or(i64::MAX))
    }

    pub(in crate::iges) fn flag(flag: bool) -> Self {
        Self::Integer(i64::from(flag))
    }

    pub(in crate::iges) fn to(number: EntryNumber) -> Self {
        Self::Pointer(Some(number))
    }

    /// The entity that it points to.
    pub(in crate::iges) fn target(self) -> Option<EntryNumber> {
        match self {
            Self::Pointer(target) => target,
            Self::Integer(_) | Self::Real(_) => None,
        }
    }

    pub(in crate::iges) fn text(self) -> ParameterText {
        let mut writer = RecordWriter::part();
        match self {
            Self::Integer(value) => writer.integer(value),
            Self::Real(value) => writer.real(value),
            Self::Pointer(number) => writer.pointer(number),
        };
        writer.finish().pop().unwrap_or_default()
    }

    /// Whether a parameter of the file says this already.
    pub(in crate::iges) fn stands(self, parameter: &Parameter<'_>) -> bool {
        match self {
            Self::Integer(value) => parameter.as_i64() == Some(value),
            Self::Real(value) => parameter.as_f64().is_some_and(|old| old.to_bits() == value.to_bits()),
            Self::Pointer(number) => parameter.as_pointer() == number,
        }
    }
}

/// What becomes of the matrix of an entity's directory entry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::iges) enum Matrix {
    /// It stays; a new entity has none.
    Same,
    /// Another one, from the entity's space to that of its user.
    New(Affine),
}

/// An entity without its look.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::iges) struct Record {
    pub(in crate::iges) entity_type: i32,
    pub(in crate::iges) form: i32,
    pub(in crate::iges) matrix: Matrix,
    pub(in crate::iges) values: Vec<Value>,
}

impl Record {
    pub(in crate::iges) fn new(entity_type: i32, form: i32) -> Self {
        Self { entity_type, form, matrix: Matrix::Same, values: Vec::new() }
    }

    pub(in crate::iges) fn reals(mut self, values: impl IntoIterator<Item = f64>) -> Self {
        self.values.extend(values.into_iter().map(Value::Real));
        self
    }

    pub(in crate::iges) fn values(mut self, values: impl IntoIterator<Item = Value>) -> Self {
        self.values.extend(values);
        self
    }

    pub(in crate::iges) fn pointer(self, number: EntryNumber) -> Self {
        self.values([Value::to(number)])
    }

    /// Whether every number in it has a text.
    pub(in crate::iges) fn is_finite(&self) -> bool {
        self.values.iter().all(|value| !matches!(value, Value::Real(value) if !value.is_finite()))
    }

    /// The parameters as text, the type first.
    pub(in crate::iges) fn texts(&self) -> Vec<ParameterText> {
        let kind = RecordWriter::of_type(self.entity_type).finish();
        kind.into_iter().chain(self.values.iter().map(|value| value.text())).collect()
    }
}
