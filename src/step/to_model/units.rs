//! Contexts of representations: units of length and plane angle, and uncertainty (ISO 10303-41, -43).
//!
//! Nothing is scaled here. A context that says no unit counts in millimetres and radians, with a warning.

use std::collections::HashMap;

use super::code::ModelCode;
use super::error::ReadError;
use super::scope::Scope;
use crate::diagnostic::Sink;
use crate::model::Context;
use crate::step::InstanceName;
use crate::step::entity::Entity;
use crate::step::view::EntityView;
use crate::units::{AngleUnit, LengthUnit, Tolerance};

/// Units defined by units that are followed before the chain counts as a cycle: an inch is defined by a
/// millimetre, nobody needs three steps.
const MAX_NESTED_UNITS: usize = 8;

/// The contexts that were asked for, each once.
#[derive(Default)]
pub(super) struct Contexts {
    pub(super) all: Vec<Context>,
    index: HashMap<InstanceName, usize>,
    assumed: Option<usize>,
}

impl Contexts {
    /// Index of the context of a record.
    pub(super) fn of(&mut self, scope: Scope<'_>, name: InstanceName, sink: &mut dyn Sink) -> usize {
        if let Some(&known) = self.index.get(&name) {
            return known;
        }
        self.all.push(read(scope, name, sink));
        self.index.insert(name, self.all.len() - 1);
        self.all.len() - 1
    }

    /// Index of the context of what no representation holds: the file's first, or else millimetre and
    /// radian.
    pub(super) fn assumed(&mut self) -> usize {
        if self.all.is_empty() {
            self.all.push(Context {
                length: LengthUnit::millimetre(),
                angle: AngleUnit::radian(),
                uncertainty: None,
            });
        }
        *self.assumed.get_or_insert(0)
    }
}

/// What a unit measures, in metres or radians.
enum Unit {
    Length(LengthUnit),
    Angle(AngleUnit),
    Other,
}

fn read(scope: Scope<'_>, name: InstanceName, sink: &mut dyn Sink) -> Context {
    let mut length = None;
    let mut angle = None;
    let view = scope.view(name).ok();
    let units = view.and_then(|view| view.references("units").ok());
    for unit in units.into_iter().flatten() {
        match unit_of(scope, unit) {
            Ok(Unit::Length(unit)) => length = length.or(Some(unit)),
            Ok(Unit::Angle(unit)) => angle = angle.or(Some(unit)),
            Ok(Unit::Other) => {}
            Err(error) => {
                // A unit that is not in the file has no line: its context has one.
                let at = if scope.instance(unit).is_ok() { unit } else { name };
                sink.report(ModelCode::UnknownUnit.at(scope.file, at, format!("unit: {error}")));
            }
        }
    }
    let mut missing = |what: &str| {
        sink.report(ModelCode::MissingUnit.at(
            scope.file,
            name,
            format!("the context has no unit of {what}"),
        ));
    };
    let length = length.unwrap_or_else(|| {
        missing("length: millimetre is assumed");
        LengthUnit::millimetre()
    });
    let angle = angle.unwrap_or_else(|| {
        missing("plane angle: radian is assumed");
        AngleUnit::radian()
    });
    let uncertainty = view.and_then(|view| uncertainty(scope, &view, &length, sink));
    Context { length, angle, uncertainty }
}

/// The first uncertainty that is a positive length, counted in the context's own unit. Every other one that
/// should be a length is reported.
fn uncertainty(
    scope: Scope<'_>,
    context: &EntityView<'_>,
    length: &LengthUnit,
    sink: &mut dyn Sink,
) -> Option<Tolerance> {
    let mut found = None;
    for name in context.references("uncertainty").ok()? {
        match one_uncertainty(scope, name, length) {
            Ok(tolerance) => found = found.or(tolerance),
            Err(error) => {
                let at = if scope.instance(name).is_ok() { name } else { context.name() };
                let message = format!("uncertainty: {error}; distances are judged as if it were not there");
                sink.report(ModelCode::BadUncertainty.at(scope.file, at, message));
            }
        }
    }
    found
}

/// An uncertainty of length; `None` for one of another quantity.
fn one_uncertainty(
    scope: Scope<'_>,
    name: InstanceName,
    length: &LengthUnit,
) -> Result<Option<Tolerance>, ReadError> {
    let view = scope.view_of(name, Entity::MeasureWithUnit)?;
    let unit = match unit_of(scope, view.reference("unit_component")?)? {
        Unit::Length(unit) => unit,
        Unit::Angle(_) | Unit::Other => return Ok(None),
    };
    let value = view.real("value_component")?;
    // Equal units must not round: most files count the uncertainty as they count lengths.
    let factor =
        if unit.metres.to_bits() == length.metres.to_bits() { 1.0 } else { unit.metres / length.metres };
    let counted = value * factor;
    if counted.is_finite() && counted > 0.0 {
        return Ok(Some(Tolerance(counted)));
    }
    Err(ReadError::NotPositive { attribute: "value_component", value })
}

/// Name of a unit of length or angle; empty for any other.
pub(super) fn name_of(scope: Scope<'_>, unit: InstanceName) -> String {
    match unit_of(scope, unit) {
        Ok(Unit::Length(unit)) => unit.name,
        Ok(Unit::Angle(unit)) => unit.name,
        Ok(Unit::Other) | Err(_) => String::new(),
    }
}

/// Metres, or square or cubic metres, of a unit of length or one derived from such a unit alone; `None` for any other.
pub(super) fn metres_of(scope: Scope<'_>, unit: InstanceName) -> Option<f64> {
    if let Ok(Unit::Length(length)) = unit_of(scope, unit) {
        return Some(length.metres);
    }
    let record = |name: InstanceName, keyword: &'static [u8]| {
        scope.instance(name).ok()?.records().find(|record| record.is(keyword))
    };
    let elements = record(unit, b"DERIVED_UNIT")?.parameters().next()?;
    let mut metres = 1.0;
    for element in elements.as_list()?.take(MAX_NESTED_UNITS) {
        let mut parts = record(element.as_reference()?, b"DERIVED_UNIT_ELEMENT")?.parameters();
        let base = parts.next()?.as_reference()?;
        let power = parts.next()?.as_f64()?;
        let Ok(Unit::Length(length)) = unit_of(scope, base) else { return None };
        metres *= length.metres.powf(power);
    }
    Some(metres)
}

fn unit_of(scope: Scope<'_>, name: InstanceName) -> Result<Unit, ReadError> {
    let view = scope.view_of(name, Entity::NamedUnit)?;
    let is_length = view.is(Entity::LengthUnit);
    if !is_length && !view.is(Entity::PlaneAngleUnit) {
        return Ok(Unit::Other);
    }
    let (factor, written) = size(scope, name, if is_length { b"METRE" } else { b"RADIAN" })?;
    Ok(if is_length {
        Unit::Length(LengthUnit { name: length_name(factor, &written), metres: factor })
    } else {
        Unit::Angle(AngleUnit { name: angle_name(factor, &written), radians: factor })
    })
}

/// How many `base` units, metres or radians, a unit is, and the name that the file gives it.
fn size(scope: Scope<'_>, name: InstanceName, base: &'static [u8]) -> Result<(f64, String), ReadError> {
    let mut factor = 1.0;
    let mut written = String::new();
    let mut current = name;
    for _ in 0..MAX_NESTED_UNITS {
        let view = scope.view_of(current, Entity::NamedUnit)?;
        if view.is(Entity::SiUnit) {
            check_name(&view, base)?;
            return Ok((checked(factor * si_prefix(&view)?)?, written));
        }
        if !view.is(Entity::ConversionBasedUnit) {
            return Err(ReadError::NotReadYet);
        }
        if written.is_empty() {
            written = view.text("name").trim().to_lowercase();
        }
        let Ok(measure) = scope.view_of(view.reference("conversion_factor")?, Entity::MeasureWithUnit) else {
            return by_name(&written).map(|f| (f * factor, written.clone())).ok_or(ReadError::NotReadYet);
        };
        factor *= measure.real("value_component")?;
        current = measure.reference("unit_component")?;
    }
    Err(ReadError::Cycle(name))
}

/// Refuses an SI unit of another name: one that is misspelt, or that measures something else.
fn check_name(unit: &EntityView<'_>, base: &'static [u8]) -> Result<(), ReadError> {
    // A complex unit has a `name` in several of its parts: only that of the SI unit counts.
    let record = unit.instance().records().find(|record| record.is(b"SI_UNIT"));
    let name = record.and_then(|record| record.parameters().last());
    let name = name.as_ref().and_then(|name| name.as_enum()).unwrap_or_default();
    if name.eq_ignore_ascii_case(base) {
        return Ok(());
    }
    let text = |word: &[u8]| String::from_utf8_lossy(word).into_owned();
    Err(ReadError::UnitName { found: text(name), expected: text(base) })
}

fn checked(factor: f64) -> Result<f64, ReadError> {
    if factor.is_finite() && factor > 0.0 {
        Ok(factor)
    } else {
        Err(ReadError::NotPositive { attribute: "conversion_factor", value: factor })
    }
}

/// Units of well-known names whose measure cannot be read.
fn by_name(name: &str) -> Option<f64> {
    match name {
        "inch" | "inches" | "in" => Some(0.0254),
        "foot" | "feet" | "ft" => Some(0.3048),
        "millimetre" | "millimeter" | "mm" => Some(1e-3),
        "degree" | "degrees" | "deg" => Some(std::f64::consts::PI / 180.0),
        _ => None,
    }
}

/// SI prefixes and their powers of ten.
const PREFIXES: [(&[u8], f64); 16] = [
    (b"EXA", 1e18),
    (b"PETA", 1e15),
    (b"TERA", 1e12),
    (b"GIGA", 1e9),
    (b"MEGA", 1e6),
    (b"KILO", 1e3),
    (b"HECTO", 1e2),
    (b"DECA", 1e1),
    (b"DECI", 1e-1),
    (b"CENTI", 1e-2),
    (b"MILLI", 1e-3),
    (b"MICRO", 1e-6),
    (b"NANO", 1e-9),
    (b"PICO", 1e-12),
    (b"FEMTO", 1e-15),
    (b"ATTO", 1e-18),
];

fn si_prefix(unit: &EntityView<'_>) -> Result<f64, ReadError> {
    let Some(prefix) = unit.get("prefix").as_ref().and_then(|p| p.as_enum()) else { return Ok(1.0) };
    let known = PREFIXES.iter().find(|(name, _)| name.eq_ignore_ascii_case(prefix));
    known.map(|(_, factor)| *factor).ok_or_else(|| ReadError::UnitName {
        found: String::from_utf8_lossy(prefix).into_owned(),
        expected: "a prefix from ATTO to EXA".to_owned(),
    })
}

/// Relative difference below which a unit counts as the one of a common name: files write the inch with
/// six digits and more.
const SAME_UNIT: f64 = 1e-6;

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_UNIT * b
}

fn length_name(metres: f64, written: &str) -> String {
    let common = [
        ("um", 1e-6),
        ("mm", 1e-3),
        ("cm", 1e-2),
        ("dm", 1e-1),
        ("m", 1.0),
        ("km", 1e3),
        ("inch", 0.0254),
        ("ft", 0.3048),
    ];
    let name = common.iter().find(|(_, size)| same(metres, *size)).map(|(name, _)| *name);
    match name {
        Some(name) => name.to_owned(),
        None if written.is_empty() => format!("{metres:e} m"),
        None => written.to_owned(),
    }
}

fn angle_name(radians: f64, written: &str) -> String {
    if same(radians, 1.0) {
        "rad".to_owned()
    } else if same(radians, std::f64::consts::PI / 180.0) {
        "deg".to_owned()
    } else if written.is_empty() {
        format!("{radians:e} rad")
    } else {
        written.to_owned()
    }
}
