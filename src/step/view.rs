//! Attribute access by name for any entity of the [schema], simple or complex.
//!
//! One view instead of a reader per entity: it knows the order of the attributes, not their meaning, and
//! decodes nothing before it is asked. It reports nothing: whoever asks says what is wrong.

use std::borrow::Cow;

use super::entity::Entity;
use super::schema::{self, Attribute};
use super::{Instance, InstanceName, Parameter, ParameterKind, Parameters};
use crate::source::Span;

/// An instance whose entity type, or one of whose partial types, the schema table knows.
#[derive(Clone, Copy)]
pub struct EntityView<'a> {
    instance: Instance<'a>,
    entity: Entity,
    /// What stands between the parentheses of a simple instance; `None` for a complex one.
    simple: Option<Span>,
}

/// An attribute is not what the schema says.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{attribute} is {found}, expected {expected}")]
pub struct AttributeError {
    /// Name of the attribute.
    pub attribute: &'static str,
    /// What stands there instead: `missing`, `$`, `*` or the beginning of the text's kind.
    pub found: &'static str,
    /// What the schema asks for.
    pub expected: &'static str,
}

/// What [`AttributeError::found`] says of a real whose value is not finite.
pub const OUT_OF_RANGE: &str = "a real out of range";

impl<'a> EntityView<'a> {
    /// The view of an instance, unless its type is unknown.
    ///
    /// A complex instance counts as the deepest of its partial types: the first of several.
    #[must_use]
    pub fn of(instance: Instance<'a>) -> Option<Self> {
        if let Some((keyword, inside)) = simple_parts(instance) {
            return Some(Self { instance, entity: schema::classify(keyword)?, simple: Some(inside) });
        }
        let mut deepest: Option<Entity> = None;
        for record in instance.records() {
            let Some(entity) = schema::classify(record.keyword()) else { continue };
            let depth = |entity: Entity| schema::row(entity).ancestors.len();
            if deepest.is_none_or(|found| depth(entity) > depth(found)) {
                deepest = Some(entity);
            }
        }
        Some(Self { instance, entity: deepest?, simple: None })
    }

    /// The instance.
    #[must_use]
    pub fn instance(&self) -> Instance<'a> {
        self.instance
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> InstanceName {
        self.instance.name()
    }

    /// The entity of a simple instance, or the deepest of a complex one.
    #[must_use]
    pub fn entity(&self) -> Entity {
        self.entity
    }

    /// Whether the instance is of a type, by a subtype or a partial record.
    #[must_use]
    pub fn is(&self, entity: Entity) -> bool {
        schema::is_a(self.entity, entity)
            || self.simple.is_none()
                && self
                    .instance
                    .records()
                    .filter_map(|record| schema::classify(record.keyword()))
                    .any(|partial| schema::is_a(partial, entity))
    }

    /// Several attributes in one pass over the text; `None` for one that is not there.
    #[must_use]
    pub fn fields<const N: usize>(&self, names: [&str; N]) -> [Option<Parameter<'a>>; N] {
        let mut found = [None; N];
        let mut missing = N;
        let mut take = |attributes: &[Attribute], mut parameters: Parameters<'a>| {
            for attribute in attributes {
                if missing == 0 {
                    return;
                }
                let Some(field) = parameters.next() else { return };
                if let Some(at) = names.iter().position(|name| *name == attribute.name) {
                    missing -= usize::from(found[at].is_none());
                    found[at].get_or_insert(field);
                }
            }
        };
        if let Some(inside) = self.simple {
            take(schema::attributes(self.entity), self.instance.parameters_in(inside));
            return found;
        }
        for record in self.instance.records() {
            if let Some(partial) = schema::classify(record.keyword()) {
                take(&schema::row(partial).own, record.parameters());
            }
        }
        found
    }

    /// One attribute.
    #[must_use]
    pub fn get(&self, attribute: &str) -> Option<Parameter<'a>> {
        let [found] = self.fields([attribute]);
        found
    }

    /// Where the value of an attribute stands in the file.
    #[must_use]
    pub fn attribute_span(&self, attribute: &str) -> Option<Span> {
        self.get(attribute).map(|parameter| parameter.span())
    }

    /// A required reference.
    ///
    /// # Errors
    /// [`AttributeError`] when the attribute is missing or something else.
    pub fn reference(&self, attribute: &'static str) -> Result<InstanceName, AttributeError> {
        reference(self.get(attribute), attribute)
    }

    /// A reference that may be omitted.
    #[must_use]
    pub fn optional_reference(&self, attribute: &str) -> Option<InstanceName> {
        self.get(attribute)?.as_reference()
    }

    /// A required number; an integer counts as one.
    ///
    /// # Errors
    /// [`AttributeError`] when the attribute is missing or no finite number.
    pub fn real(&self, attribute: &'static str) -> Result<f64, AttributeError> {
        real(self.get(attribute), attribute)
    }

    /// A required boolean.
    ///
    /// # Errors
    /// [`AttributeError`] when the attribute is missing or neither `.T.` nor `.F.`.
    pub fn boolean(&self, attribute: &'static str) -> Result<bool, AttributeError> {
        boolean(self.get(attribute), attribute)
    }

    /// A required list.
    ///
    /// # Errors
    /// [`AttributeError`] when the attribute is missing or no list.
    pub fn list(&self, attribute: &'static str) -> Result<Parameters<'a>, AttributeError> {
        list(self.get(attribute), attribute)
    }

    /// The references of a list; members that are none are passed over.
    ///
    /// # Errors
    /// [`AttributeError`] when the attribute is missing or no list.
    pub fn references(
        &self,
        attribute: &'static str,
    ) -> Result<impl Iterator<Item = InstanceName> + use<'a>, AttributeError> {
        Ok(self.list(attribute)?.filter_map(|member| member.as_reference()))
    }

    /// A decoded text; empty when omitted.
    #[must_use]
    pub fn text(&self, attribute: &str) -> Cow<'a, str> {
        self.get(attribute).and_then(|parameter| parameter.as_str()).unwrap_or_default()
    }
}

/// A field as a reference.
///
/// # Errors
/// [`AttributeError`] when it is missing or something else.
pub fn reference(
    field: Option<Parameter<'_>>,
    attribute: &'static str,
) -> Result<InstanceName, AttributeError> {
    field.as_ref().and_then(Parameter::as_reference).ok_or_else(|| wrong(field, attribute, "a reference"))
}

/// A field as a boolean.
///
/// # Errors
/// [`AttributeError`] when it is missing or neither `.T.` nor `.F.`.
pub fn boolean(field: Option<Parameter<'_>>, attribute: &'static str) -> Result<bool, AttributeError> {
    field.as_ref().and_then(Parameter::as_bool).ok_or_else(|| wrong(field, attribute, "`.T.` or `.F.`"))
}

/// A field as a finite number.
///
/// # Errors
/// [`AttributeError`] when it is missing or something else.
pub fn real(field: Option<Parameter<'_>>, attribute: &'static str) -> Result<f64, AttributeError> {
    let number = field.as_ref().and_then(Parameter::as_f64).filter(|number| number.is_finite());
    number.ok_or_else(|| wrong(field, attribute, "a finite number"))
}

/// A field as a count or degree.
///
/// # Errors
/// [`AttributeError`] when it is missing, negative or something else.
pub fn count(field: Option<Parameter<'_>>, attribute: &'static str) -> Result<usize, AttributeError> {
    let number = field.as_ref().and_then(Parameter::as_i64).and_then(|number| usize::try_from(number).ok());
    number.ok_or_else(|| wrong(field, attribute, "an integer of at least 0"))
}

/// A field as a list.
///
/// # Errors
/// [`AttributeError`] when it is missing or something else.
pub fn list<'a>(
    field: Option<Parameter<'a>>,
    attribute: &'static str,
) -> Result<Parameters<'a>, AttributeError> {
    field.as_ref().and_then(Parameter::as_list).ok_or_else(|| wrong(field, attribute, "a list"))
}

fn wrong(field: Option<Parameter<'_>>, attribute: &'static str, expected: &'static str) -> AttributeError {
    let found = match field.map(|field| field.untyped().kind()) {
        None => "missing",
        Some(ParameterKind::Omitted) => "`$`",
        Some(ParameterKind::Derived) => "`*`",
        Some(ParameterKind::Integer) => "an integer",
        Some(ParameterKind::Real) => OUT_OF_RANGE,
        Some(ParameterKind::String) => "a string",
        Some(ParameterKind::Enumeration) => "an enumeration value",
        Some(ParameterKind::Binary) => "a binary value",
        Some(ParameterKind::Reference) => "a reference",
        Some(ParameterKind::List) => "a list",
        Some(_) => "something else",
    };
    AttributeError { attribute, found, expected }
}

/// Keyword of a simple instance and what stands between its parentheses.
///
/// Looks for no closing parenthesis but the last one, so that a long record is not read only to find its
/// end: what stands between is for the cursor to judge.
pub(super) fn simple_parts(instance: Instance<'_>) -> Option<(&[u8], Span)> {
    let bytes = instance.bytes();
    let (start, end) = instance.body();
    let body = bytes.get(start..end)?;
    let length = body.iter().position(|&byte| !(byte.is_ascii_alphanumeric() || byte == b'_'))?;
    let open = length + usize::from(body[length] != b'(') * trivia(&body[length..]);
    let close = body.len().checked_sub(1)?;
    if length == 0 || body.get(open) != Some(&b'(') || body[close] != b')' || open >= close {
        // Complex, user-defined, or damaged: the careful way.
        return careful_parts(instance);
    }
    let inside = Span::new(to_offset(start + open + 1)?, to_offset(start + close)?);
    Some((&body[..length], inside))
}

fn trivia(bytes: &[u8]) -> usize {
    super::syntax::trivia_end(bytes, 0)
}

fn to_offset(at: usize) -> Option<u32> {
    u32::try_from(at).ok()
}

fn careful_parts(instance: Instance<'_>) -> Option<(&[u8], Span)> {
    if instance.is_complex() {
        return None;
    }
    let record = instance.records().next()?;
    Some((record.keyword(), record.parameters_span()))
}
