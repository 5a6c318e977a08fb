//! From the exchange structure to the model: what an IGES file means.
//!
//! One file per chapter of the standard. Nothing is repaired and nothing is scaled. What cannot be read is carried with
//! the reason, and reported; what stands in the file and is not asked for is not looked at.
//!
//! INVARIANT: chains of pointers are followed in loops with a cap, or, where geometry is made of geometry, by recursion
//! with a cap on depth and on the count of parts.

mod approximate;
mod body;
mod boundary;
mod builder;
pub mod code;
mod conic;
pub(super) mod curve;
pub(super) mod curve2d;
mod error;
mod image;
mod natural;
mod orient;
pub(super) mod pcurve;
mod presentation;
mod product;
mod roots;
mod ruled;
pub(super) mod scope;
pub(super) mod spline;
pub(super) mod surface;
mod topology;
mod transformation;
mod trimmed;
pub(super) mod units;

pub use code::ModelCode;

use super::ExchangeStructure;
use crate::diagnostic::Sink;
use crate::iges::EntryNumber;
use crate::model::{Instances, Model};
use body::Bodies;
use builder::Builder;
use product::Assembly;
use roots::Roots;
use scope::Scope;

/// Reads the bodies, free curves, units, subfigures, names, colours and levels of a file.
///
/// Never fails: a damaged element is carried as unread or left out, and a diagnostic says so.
pub fn to_model(file: &ExchangeStructure, sink: &mut dyn Sink) -> Model {
    let context = units::context(file, sink);
    let resolution = context.uncertainty.map_or(UNSTATED, |uncertainty| uncertainty.0);
    let roots = Roots::find(file);
    report_matrices(file, sink);
    let mut builder = Builder::new(Scope::new(file, resolution), sink);
    let mut bodies = Bodies::default();
    bodies.build(&mut builder, &roots);
    let Assembly { products, occurrences, .. } =
        Assembly::read(&mut builder, &roots, &mut bodies, &context.length);
    let Builder { brep, origins, faces, sink, .. } = builder;
    let body_context = bodies.attributes.iter().map(|_| 0).collect();
    let model = Model {
        schema: vec![file.global().version_name().to_owned()],
        brep,
        contexts: vec![context],
        body_context,
        faces,
        bodies: bodies.attributes,
        free_curves: bodies.free_curves,
        free_curve_names: bodies.free_curve_names,
        products,
        occurrences,
        annotations: Vec::new(),
        origins,
    };
    report_size(&model, file, sink);
    model
}

/// Resolution of a file that states none, in its units.
const UNSTATED: f64 = 1e-6;

/// Reports matrices that neither turn nor mirror alone.
fn report_matrices(file: &ExchangeStructure, sink: &mut dyn Sink) {
    for instance in file.instances().filter(|instance| instance.entry().entity_type == 124) {
        let Some(view) = super::EntityView::of(instance) else { continue };
        let Ok(m) = view.fields().array::<12>("matrix") else { continue };
        let linear = crate::math::Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
        let off = transformation::off_rigid(&linear);
        if off > transformation::ROUNDED {
            let message =
                format!("the axes are {off:.1e} off perpendicular ones of length one; it is taken as it is");
            sink.report(ModelCode::NotRigid.at(file, instance.number(), message));
        }
    }
}

/// Reports an assembly that is not walked to its end.
fn report_size(model: &Model, file: &ExchangeStructure, sink: &mut dyn Sink) {
    if model.occurrences.is_empty() {
        return;
    }
    let walked = Instances::of(model, &model.contexts[0].length, Instances::LIMIT);
    if walked.cut {
        let first = file.instance_at(0).map_or(EntryNumber(1), |instance| instance.number());
        let message = format!("more than {} instances; the rest is not walked", Instances::LIMIT);
        sink.report(ModelCode::TooManyInstances.at(file, first, message));
    }
}
