//! A STEP file made of a model that came from another format: header, units, products and their uses, bodies, looks.
//!
//! Every value of the model is written as it is: nothing is scaled, approximated or left out without a word. What the
//! format, or this writer, has no place for is reported by [`Loss`]; what would make the part another one is refused.

mod body;
mod presentation;
mod product;

use std::collections::{BTreeMap, HashMap};

use super::exchange_structure::{ExchangeStructure, InstanceName};
use super::lower::compose::{Body, Value, verbatim};
use super::lower::{LowerError, Lowering};
use super::string;
use crate::brep::{Arena, BodyId, CoedgeId, CurveId, EdgeId, FaceId, SurfaceId, VertexId};
use crate::diagnostic::Sink;
use crate::model::{Loss, Model, Origin};
use crate::source::{Source, SourceTooLarge};
use crate::units::LengthUnit;

/// Application protocol of a new file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Schema {
    /// ISO 10303-214.
    #[default]
    Ap214,
    /// ISO 10303-242, edition 4.
    Ap242,
}

impl Schema {
    /// Name in the header.
    fn identifier(self) -> &'static str {
        match self {
            Self::Ap214 => "AUTOMOTIVE_DESIGN { 1 0 10303 214 3 1 1 1 }",
            Self::Ap242 => "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 7 1 4 }",
        }
    }

    /// Name and year of the protocol's definition, and its purpose.
    fn protocol(self) -> (&'static str, usize, &'static str) {
        match self {
            Self::Ap214 => {
                ("automotive_design", 2010, "core data for automotive mechanical design processes")
            }
            Self::Ap242 => {
                ("ap242_managed_model_based_3d_engineering", 2025, "managed model based 3d engineering")
            }
        }
    }
}

/// What the header of a new file says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// Name of the file.
    pub name: String,
    /// ISO 8601 time without zone.
    pub time: String,
    /// Name and version of the program that writes it.
    pub preprocessor: String,
    /// Application protocol.
    pub schema: Schema,
}

/// Why no file is made of a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FromModelError {
    /// Geometry that was not read.
    #[error("{origin}: its geometry was not read: {reason}")]
    Unread {
        /// The element.
        origin: Origin,
        /// Why.
        reason: String,
    },
    /// A face without bounds.
    #[error("{origin}: the face has no bound, and this format wants one")]
    Unbounded {
        /// The face.
        origin: Origin,
    },
    /// Geometry that this writer has no entity for.
    #[error("{origin}: a {kind} cannot be written")]
    Unwritable {
        /// The element.
        origin: Origin,
        /// Kind of its geometry.
        kind: &'static str,
    },
    /// A use of a product that mirrors or stretches it.
    #[error("{origin}: the use of a product that is mirrored or scaled cannot be written")]
    Placement {
        /// The use, or the body.
        origin: Origin,
    },
    /// Bodies in different units.
    #[error("the part has several units of length, which cannot be written together")]
    Units,
    /// A header beyond what a file can have.
    #[error(transparent)]
    Header(#[from] SourceTooLarge),
    /// By the writer of records.
    #[error(transparent)]
    Lower(#[from] LowerError),
}

/// The bytes of a STEP file that says what a model is; each loss goes to the sink.
///
/// # Errors
/// [`FromModelError`].
pub fn from_model(model: &Model, header: &Header, sink: &mut dyn Sink) -> Result<Vec<u8>, FromModelError> {
    let skeleton = skeleton(header);
    let source = Source::new(skeleton.into_bytes())?;
    let structure = ExchangeStructure::parse(source, &mut Vec::new());
    let mut writer = Writer::new(&structure, model, header.schema, sink)?;
    writer.bodies()?;
    writer.products()?;
    writer.styles()?;
    writer.layers()?;
    writer.losses();
    let patch = writer.lowering.finish()?;
    Ok(patch.apply(structure.source().bytes()))
}

/// A file without data.
fn skeleton(header: &Header) -> String {
    let [name, time, preprocessor, schema] =
        [header.name.as_str(), &header.time, &header.preprocessor, header.schema.identifier()]
            .map(string::encode);
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n\
         FILE_NAME({name},{time},(''),(''),{preprocessor},{preprocessor},'');\n\
         FILE_SCHEMA(({schema}));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"
    )
}

/// Everything that grows while a file is made.
struct Writer<'a, 's> {
    model: &'a Model,
    sink: &'s mut dyn Sink,
    lowering: Lowering<'a>,
    application: InstanceName,
    /// Context of all shapes.
    space: InstanceName,
    /// Context of curves in parameters.
    parameters: Option<InstanceName>,
    curves: HashMap<CurveId, InstanceName>,
    surfaces: HashMap<SurfaceId, InstanceName>,
    vertices: HashMap<VertexId, InstanceName>,
    edges: HashMap<EdgeId, InstanceName>,
    /// Uses of each edge.
    uses: Arena<EdgeId, Vec<CoedgeId>>,
    faces: BTreeMap<FaceId, InstanceName>,
    bodies: BTreeMap<BodyId, InstanceName>,
}

impl<'a, 's> Writer<'a, 's> {
    fn new(
        structure: &'a ExchangeStructure,
        model: &'a Model,
        schema: Schema,
        sink: &'s mut dyn Sink,
    ) -> Result<Self, FromModelError> {
        let mut uses: Arena<EdgeId, Vec<CoedgeId>> = model.brep.edges.iter().map(|_| Vec::new()).collect();
        for (coedge, of) in model.brep.coedges.iter() {
            uses[of.edge].push(coedge);
        }
        let mut writer = Self {
            model,
            sink,
            lowering: Lowering::new(structure, model),
            application: InstanceName(0),
            space: InstanceName(0),
            parameters: None,
            curves: HashMap::new(),
            surfaces: HashMap::new(),
            vertices: HashMap::new(),
            edges: HashMap::new(),
            uses,
            faces: BTreeMap::new(),
            bodies: BTreeMap::new(),
        };
        writer.application = writer.protocol(schema)?;
        writer.space = writer.context()?;
        Ok(writer)
    }

    /// A simple record.
    fn add(&mut self, keyword: &'static str, values: Vec<Value>) -> Result<InstanceName, FromModelError> {
        Ok(self.lowering.append(&Body::simple(keyword, values))?)
    }

    /// A complex record; partial entities in the order of the alphabet.
    fn add_complex(
        &mut self,
        parts: Vec<(&'static str, Vec<Value>)>,
    ) -> Result<InstanceName, FromModelError> {
        Ok(self.lowering.append(&Body::complex(parts))?)
    }

    fn protocol(&mut self, schema: Schema) -> Result<InstanceName, FromModelError> {
        let (name, year, purpose) = schema.protocol();
        let application = self.add("APPLICATION_CONTEXT", vec![text(purpose)])?;
        let values = vec![text("international standard"), text(name), Value::Integer(year), to(application)];
        self.add("APPLICATION_PROTOCOL_DEFINITION", values)?;
        Ok(application)
    }

    /// Units and uncertainty.
    fn context(&mut self) -> Result<InstanceName, FromModelError> {
        let contexts = &self.model.contexts;
        let unit = contexts.first().map_or_else(LengthUnit::millimetre, |context| context.length.clone());
        if contexts.iter().any(|context| context.length.metres.to_bits() != unit.metres.to_bits()) {
            return Err(FromModelError::Units);
        }
        let uncertainty = contexts.first().and_then(|context| context.uncertainty);
        let length = self.length_unit(&unit)?;
        let si = |measure: &'static str, name: &'static str| match measure {
            "PLANE_ANGLE_UNIT" => vec![
                ("NAMED_UNIT", vec![verbatim("*")]),
                (measure, vec![]),
                ("SI_UNIT", vec![verbatim("$"), verbatim(name)]),
            ],
            _ => vec![
                ("NAMED_UNIT", vec![verbatim("*")]),
                ("SI_UNIT", vec![verbatim("$"), verbatim(name)]),
                (measure, vec![]),
            ],
        };
        let angle = self.add_complex(si("PLANE_ANGLE_UNIT", ".RADIAN."))?;
        let solid = self.add_complex(si("SOLID_ANGLE_UNIT", ".STERADIAN."))?;
        let units = Value::List([length, angle, solid].map(to).to_vec());
        let mut parts = vec![("GEOMETRIC_REPRESENTATION_CONTEXT", vec![Value::Integer(3)])];
        if let Some(uncertainty) = uncertainty {
            let value = Value::Typed("LENGTH_MEASURE", Box::new(Value::Real(uncertainty.0)));
            let values = vec![value, to(length), text("distance_accuracy_value"), text("")];
            let stated = self.add("UNCERTAINTY_MEASURE_WITH_UNIT", values)?;
            parts.push(("GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT", vec![Value::List(vec![to(stated)])]));
        }
        parts.push(("GLOBAL_UNIT_ASSIGNED_CONTEXT", vec![units]));
        parts.push(("REPRESENTATION_CONTEXT", vec![text(""), text("")]));
        self.add_complex(parts)
    }

    fn length_unit(&mut self, unit: &LengthUnit) -> Result<InstanceName, FromModelError> {
        let si = |prefix: &str| {
            let prefix = verbatim(prefix);
            vec![
                ("LENGTH_UNIT", vec![]),
                ("NAMED_UNIT", vec![verbatim("*")]),
                ("SI_UNIT", vec![prefix, verbatim(".METRE.")]),
            ]
        };
        let known = PREFIXES.iter().find(|(metres, _)| metres.to_bits() == unit.metres.to_bits());
        if let Some((_, prefix)) = known {
            return self.add_complex(si(prefix));
        }
        let base = self.add_complex(si("$"))?;
        let value = Value::Typed("LENGTH_MEASURE", Box::new(Value::Real(unit.metres)));
        let measure = self.add("LENGTH_MEASURE_WITH_UNIT", vec![value, to(base)])?;
        let exponents = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0].map(Value::Real).to_vec();
        let exponents = self.add("DIMENSIONAL_EXPONENTS", exponents)?;
        self.add_complex(vec![
            ("CONVERSION_BASED_UNIT", vec![text(&unit.name), to(measure)]),
            ("LENGTH_UNIT", vec![]),
            ("NAMED_UNIT", vec![to(exponents)]),
        ])
    }

    /// Reports what stays behind.
    fn losses(&mut self) {
        let model = self.model;
        Loss::of_annotations(model, self.sink);
        for (face, attributes) in model.faces.iter() {
            Loss::of_look(&attributes.appearance, model.origins.faces[face], self.sink);
        }
        for (body, attributes) in model.bodies.iter() {
            Loss::of_look(&attributes.own.appearance, model.origins.bodies[body], self.sink);
        }
    }
}

/// Units of the SI that IGES has too, by metres, with their prefixes.
const PREFIXES: [(f64, &str); 5] =
    [(1e-3, ".MILLI."), (1.0, "$"), (1e-2, ".CENTI."), (1e3, ".KILO."), (1e-6, ".MICRO.")];

/// An encoded text.
fn text(value: &str) -> Value {
    Value::Verbatim(string::encode(value))
}

/// A reference.
fn to(name: InstanceName) -> Value {
    Value::Reference(name)
}

fn logical(value: bool) -> Value {
    verbatim(if value { ".T." } else { ".F." })
}

fn list(names: impl IntoIterator<Item = InstanceName>) -> Value {
    Value::List(names.into_iter().map(to).collect())
}
