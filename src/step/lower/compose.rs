//! New records as keyword and values, and their text. Knows the order of attributes of the few entities
//! that are written, and nothing of what they replace but the raw text that they inherit.

use super::super::exchange_structure::InstanceName;
use super::super::write::RecordWriter;
use super::request::Coordinates;
use crate::geometry::nurbs::{KnotVector, NurbsCurve, NurbsSurface};

/// A value of a new record.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::step) enum Value {
    /// As it stands, or would stand, in a file.
    Verbatim(String),
    Integer(usize),
    Real(f64),
    Reference(InstanceName),
    List(Vec<Value>),
    /// A value of a select type, with the keyword of its type.
    Typed(&'static str, Box<Value>),
}

impl Value {
    /// The name of a record that nobody named.
    pub(super) fn empty_name() -> Self {
        verbatim("''")
    }

    /// Whether every number in it has a text.
    fn is_finite(&self) -> bool {
        match self {
            Self::Real(value) => value.is_finite(),
            Self::List(values) => values.iter().all(Self::is_finite),
            Self::Typed(_, value) => value.is_finite(),
            Self::Verbatim(_) | Self::Integer(_) | Self::Reference(_) => true,
        }
    }

    fn list<T>(values: impl IntoIterator<Item = T>, one: impl Fn(T) -> Self) -> Self {
        Self::List(values.into_iter().map(one).collect())
    }

    fn write(&self, writer: &mut RecordWriter) {
        match self {
            Self::Verbatim(text) => writer.verbatim(text),
            // A count of control points fits, since each takes bytes of a file below 4 GiB.
            Self::Integer(value) => writer.integer(*value as i64),
            Self::Real(value) => writer.real(*value),
            Self::Reference(name) => writer.reference(*name),
            Self::List(values) => {
                writer.open_list();
                values.iter().for_each(|value| value.write(writer));
                writer.close()
            }
            Self::Typed(keyword, value) => {
                writer.open(keyword);
                value.write(writer);
                writer.close()
            }
        };
    }
}

/// Text as a value.
pub(in crate::step) fn verbatim(text: &str) -> Value {
    Value::Verbatim(text.to_owned())
}

/// What stands between `=` and `;`: one record, or the partial records of a complex instance.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::step) struct Body(Vec<(&'static str, Vec<Value>)>);

impl Body {
    /// A simple instance.
    pub(in crate::step) fn simple(keyword: &'static str, values: Vec<Value>) -> Self {
        Self(vec![(keyword, values)])
    }

    /// A complex instance, its partial records in the order of the alphabet.
    pub(in crate::step) fn complex(parts: Vec<(&'static str, Vec<Value>)>) -> Self {
        Self(parts)
    }

    /// Whether every number in it has a text.
    pub(super) fn is_finite(&self) -> bool {
        self.0.iter().flat_map(|(_, values)| values).all(Value::is_finite)
    }

    /// Writes the text.
    pub(super) fn write(&self, writer: &mut RecordWriter) {
        let complex = self.0.len() > 1;
        if complex {
            writer.open_complex();
        }
        for (keyword, values) in &self.0 {
            writer.open(keyword);
            values.iter().for_each(|value| value.write(writer));
            writer.close();
        }
        if complex {
            writer.close();
        }
    }
}

/// Raw text that a new curve or surface takes over from the record that it replaces.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::step) struct Inherited {
    /// `name`, with its quotes.
    pub(in crate::step) name: String,
    /// `closed_curve`, or `u_closed` and `v_closed`.
    pub(in crate::step) closed: [String; 2],
    /// `self_intersect`.
    pub(in crate::step) self_intersect: String,
}

impl Inherited {
    /// What a record without predecessor says.
    pub(in crate::step) fn nothing() -> Self {
        let unknown = || ".U.".to_owned();
        Self { name: "''".to_owned(), closed: [unknown(), unknown()], self_intersect: unknown() }
    }

    /// The name as a value.
    pub(super) fn name(&self) -> Value {
        verbatim(&self.name)
    }
}

/// `CARTESIAN_POINT` or `DIRECTION`.
pub(super) fn coordinates(keyword: &'static str, values: &[f64]) -> Body {
    Body::simple(keyword, vec![Value::empty_name(), Value::list(values, |&value| Value::Real(value))])
}

/// Points of a homogeneous net without their weights.
pub(super) fn euclidean<const H: usize>(net: &[[f64; H]]) -> Vec<Coordinates> {
    let one = |point: &[f64; H]| {
        let at = |index: usize| point[index] / point[H - 1];
        if H == 3 { Coordinates::Two([at(0), at(1)]) } else { Coordinates::Three([at(0), at(1), at(2)]) }
    };
    net.iter().map(one).collect()
}

/// Multiplicities and distinct knots.
fn multiplicities(knots: &KnotVector) -> (Value, Value) {
    let (values, counts) = knots.to_multiplicities();
    (Value::list(counts, Value::Integer), Value::list(values, Value::Real))
}

/// The context of a curve in parameters.
pub(in crate::step) fn parametric_context() -> Body {
    Body(vec![
        ("GEOMETRIC_REPRESENTATION_CONTEXT", vec![Value::Integer(2)]),
        ("PARAMETRIC_REPRESENTATION_CONTEXT", vec![]),
        ("REPRESENTATION_CONTEXT", vec![verbatim("'2D SPACE'"), Value::empty_name()]),
    ])
}

fn unspecified() -> Value {
    verbatim(".UNSPECIFIED.")
}

/// `B_SPLINE_CURVE_WITH_KNOTS`, as a complex instance when rational.
pub(super) fn spline_curve<const H: usize>(
    spline: &NurbsCurve<H>,
    points: Vec<InstanceName>,
    inherited: &Inherited,
) -> Body {
    let (counts, knots) = multiplicities(spline.knots());
    let spline_part = vec![
        Value::Integer(spline.knots().degree()),
        Value::list(points, Value::Reference),
        unspecified(),
        verbatim(&inherited.closed[0]),
        verbatim(&inherited.self_intersect),
    ];
    let knots_part = vec![counts, knots, unspecified()];
    if !spline.is_rational() {
        let all = [vec![inherited.name()], spline_part, knots_part].concat();
        return Body::simple("B_SPLINE_CURVE_WITH_KNOTS", all);
    }
    let weights = Value::list(spline.points(), |point| Value::Real(point[H - 1]));
    Body(vec![
        ("BOUNDED_CURVE", vec![]),
        ("B_SPLINE_CURVE", spline_part),
        ("B_SPLINE_CURVE_WITH_KNOTS", knots_part),
        ("CURVE", vec![]),
        ("GEOMETRIC_REPRESENTATION_ITEM", vec![]),
        ("RATIONAL_B_SPLINE_CURVE", vec![weights]),
        ("REPRESENTATION_ITEM", vec![inherited.name()]),
    ])
}

/// `B_SPLINE_SURFACE_WITH_KNOTS`, as a complex instance when rational.
pub(super) fn spline_surface(spline: &NurbsSurface, points: &[InstanceName], inherited: &Inherited) -> Body {
    let (_, n_columns) = spline.shape();
    let ((u_counts, u_knots), (v_counts, v_knots)) =
        (multiplicities(spline.knots_u()), multiplicities(spline.knots_v()));
    let rows = points.chunks(n_columns);
    let spline_part = vec![
        Value::Integer(spline.knots_u().degree()),
        Value::Integer(spline.knots_v().degree()),
        Value::list(rows, |row| Value::list(row, |&name| Value::Reference(name))),
        unspecified(),
        verbatim(&inherited.closed[0]),
        verbatim(&inherited.closed[1]),
        verbatim(&inherited.self_intersect),
    ];
    let knots_part = vec![u_counts, v_counts, u_knots, v_knots, unspecified()];
    if !spline.is_rational() {
        let all = [vec![inherited.name()], spline_part, knots_part].concat();
        return Body::simple("B_SPLINE_SURFACE_WITH_KNOTS", all);
    }
    let rows = spline.net().chunks(n_columns);
    let weights = Value::list(rows, |row| Value::list(row, |point| Value::Real(point[3])));
    Body(vec![
        ("BOUNDED_SURFACE", vec![]),
        ("B_SPLINE_SURFACE", spline_part),
        ("B_SPLINE_SURFACE_WITH_KNOTS", knots_part),
        ("GEOMETRIC_REPRESENTATION_ITEM", vec![]),
        ("RATIONAL_B_SPLINE_SURFACE", vec![weights]),
        ("REPRESENTATION_ITEM", vec![inherited.name()]),
        ("SURFACE", vec![]),
    ])
}
