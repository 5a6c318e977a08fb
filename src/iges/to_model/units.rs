//! The unit of length and the resolution of the global section. Nothing is scaled here.

use super::code::ModelCode;
use crate::diagnostic::{Diagnostic, Sink};
use crate::iges::{ExchangeStructure, Global};
use crate::model::Context;
use crate::source::Span;
use crate::units::{AngleUnit, LengthUnit, Tolerance};

/// Flags, names as files have them, names as people read them, and metres (IGES 5.3 section 2.2.4.3.14). Flag 3 refers
/// to the name.
pub(in crate::iges) const UNITS: [(i64, &[&str], &str, f64); 10] = [
    (1, &["IN", "INCH"], "inch", 0.0254),
    (2, &["MM"], "mm", 1e-3),
    (4, &["FT"], "ft", 0.3048),
    (5, &["MI"], "mi", 1609.344),
    (6, &["M"], "m", 1.0),
    (7, &["KM"], "km", 1e3),
    (8, &["MIL"], "mil", 2.54e-5),
    (9, &["UM"], "um", 1e-6),
    (10, &["CM"], "cm", 1e-2),
    (11, &["UIN"], "uin", 2.54e-8),
];

/// Flag that leaves the unit to its name.
const BY_NAME: i64 = 3;

/// Units and resolution of a file.
pub(super) fn context(file: &ExchangeStructure, sink: &mut dyn Sink) -> Context {
    let global = file.global();
    let resolution = global.resolution.filter(|resolution| resolution.is_finite() && *resolution > 0.0);
    Context {
        length: length(file, global, sink),
        angle: AngleUnit::radian(),
        uncertainty: resolution.map(Tolerance),
    }
}

fn length(file: &ExchangeStructure, global: &Global, sink: &mut dyn Sink) -> LengthUnit {
    let name = global.unit_name.trim().to_ascii_uppercase();
    let by_name = UNITS.iter().find(|unit| unit.1.contains(&name.as_str()));
    let flag = global.unit_flag.unwrap_or(1);
    let by_flag = UNITS.iter().find(|unit| unit.0 == flag);
    let mut report = |message: String| sink.report(at_global(file, ModelCode::BadUnit, message));
    let unit = match (by_flag, by_name) {
        (Some(flagged), Some(named)) if flagged.0 != named.0 => {
            report(format!("the unit flag {flag} is {}, its name {name}; the flag is taken", flagged.2));
            flagged
        }
        (Some(flagged), _) => flagged,
        (None, Some(named)) => {
            if flag != BY_NAME {
                report(format!("the unit flag is {flag}; the unit's name {name} is taken"));
            }
            named
        }
        (None, None) => {
            report(format!("neither the unit flag {flag} nor the name `{name}` is a unit; inches are taken"));
            &UNITS[0]
        }
    };
    scaled(unit.2, unit.3, global.scale)
}

/// A unit in a model that is drawn so many times as large as the thing.
fn scaled(name: &str, metres: f64, scale: Option<f64>) -> LengthUnit {
    match scale.filter(|scale| scale.is_finite() && *scale > 0.0 && *scale != 1.0) {
        Some(scale) => LengthUnit { name: format!("{name}/{scale}"), metres: metres / scale },
        None => LengthUnit { name: name.to_owned(), metres },
    }
}

fn at_global(file: &ExchangeStructure, code: ModelCode, message: String) -> Diagnostic {
    let start = file.sections().global.first().copied();
    let span = start.map(|start| Span::new(start, start + 72));
    Diagnostic { code: code.text(), severity: code.severity(), entity: None, span, message }
}
