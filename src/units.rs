//! Length, angle and tolerance as distinct types, and the units that they are counted in.
//!
//! Nothing is scaled on read: a model keeps the numbers of its file and carries the units. A job's
//! lengths are converted to file units when the job is planned.

use std::f64::consts::PI;

/// A unit of length: how many metres one unit is.
#[derive(Debug, Clone, PartialEq)]
pub struct LengthUnit {
    /// Name as people read it: `mm`, `m`, `inch`.
    pub name: String,
    /// Metres per unit, finite and positive.
    pub metres: f64,
}

/// A unit of plane angle: how many radians one unit is.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleUnit {
    /// Name as people read it: `rad`, `deg`.
    pub name: String,
    /// Radians per unit, finite and positive.
    pub radians: f64,
}

impl LengthUnit {
    /// The millimetre.
    #[must_use]
    pub fn millimetre() -> Self {
        Self { name: "mm".to_owned(), metres: 1e-3 }
    }
}

impl AngleUnit {
    /// The radian.
    #[must_use]
    pub fn radian() -> Self {
        Self { name: "rad".to_owned(), radians: 1.0 }
    }
}

/// A length as somebody wrote it: with a unit, or in the units of the file that it will be used on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// A number in file units.
    FileUnits(f64),
    /// A number of metres.
    Metres(f64),
}

/// An angle as somebody wrote it, in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle(pub f64);

/// Upper bound on a distance, in file units: finite and positive.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Tolerance(pub f64);

/// The text is not a number with a known unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a {quantity}: expected a number, or a number with one of the units {units}")]
pub struct ParseUnitError {
    text: String,
    quantity: &'static str,
    units: &'static str,
}

const LENGTH_UNITS: [(&str, f64); 9] = [
    ("um", 1e-6),
    ("µm", 1e-6),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("dm", 1e-1),
    ("m", 1.0),
    ("inch", 0.0254),
    ("in", 0.0254),
    ("ft", 0.3048),
];

const ANGLE_UNITS: [(&str, f64); 3] = [("deg", PI / 180.0), ("°", PI / 180.0), ("rad", 1.0)];

fn split_number(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let unit_start = text
        .char_indices()
        .find(|&(at, c)| c.is_alphabetic() && !is_exponent(text, at) || c == '°' || c == 'µ')
        .map_or(text.len(), |(at, _)| at);
    let number: f64 = text[..unit_start].trim().parse().ok()?;
    number.is_finite().then(|| (number, text[unit_start..].trim()))
}

fn is_exponent(text: &str, at: usize) -> bool {
    let rest = &text[at..];
    let mut chars = rest.chars();
    matches!(chars.next(), Some('e' | 'E'))
        && chars.next().is_some_and(|c| c.is_ascii_digit() || c == '-' || c == '+')
        && at > 0
}

impl std::str::FromStr for Length {
    type Err = ParseUnitError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error = || ParseUnitError {
            text: text.to_owned(),
            quantity: "length",
            units: "um, mm, cm, dm, m, in, inch, ft",
        };
        let (number, unit) = split_number(text).ok_or_else(error)?;
        if unit.is_empty() {
            return Ok(Self::FileUnits(number));
        }
        let metres = LENGTH_UNITS.iter().find(|(name, _)| *name == unit).ok_or_else(error)?.1;
        Ok(Self::Metres(number * metres))
    }
}

impl std::str::FromStr for Angle {
    type Err = ParseUnitError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error = || ParseUnitError { text: text.to_owned(), quantity: "angle", units: "deg, rad" };
        let (number, unit) = split_number(text).ok_or_else(error)?;
        let radians = match unit {
            "" => 1.0,
            unit => ANGLE_UNITS.iter().find(|(name, _)| *name == unit).ok_or_else(error)?.1,
        };
        Ok(Self(number * radians))
    }
}

impl Length {
    /// The length counted in `unit`.
    #[must_use]
    pub fn in_unit(self, unit: &LengthUnit) -> f64 {
        match self {
            Self::FileUnits(number) => number,
            Self::Metres(metres) => metres / unit.metres,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_with_and_without_units() {
        let inch = LengthUnit { name: "inch".into(), metres: 0.0254 };
        let read = |text: &str| text.parse::<Length>().map(|l| l.in_unit(&inch));
        assert_eq!(read("2"), Ok(2.0));
        assert_eq!(read("25.4 mm").map(|l| (l - 1.0).abs() < 1e-15), Ok(true));
        assert_eq!(read("1e-3 m").map(|l| (l - 0.001 / 0.0254).abs() < 1e-15), Ok(true));
        assert!(read("3 parsec").is_err());
        assert!(read("nan").is_err());
        assert!(read("").is_err());
    }

    #[test]
    fn angles_in_degrees_become_radians() {
        assert_eq!("180 deg".parse::<Angle>(), Ok(Angle(PI)));
        assert_eq!("1.5".parse::<Angle>(), Ok(Angle(1.5)));
    }
}
