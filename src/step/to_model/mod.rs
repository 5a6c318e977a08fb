//! From the exchange structure to the model: what a STEP file means.
//!
//! One file per chapter of the standard. Nothing is repaired and nothing is scaled, but that angles become
//! radians. What cannot be read is carried with the reason, and reported; what stands in the file and
//! is not asked for is not looked at.
//!
//! INVARIANT: chains of references are followed in loops with a cap, or, where geometry is made of geometry, by
//! recursion with a cap on depth and on the count of parts.

mod annotation;
mod assembly;
mod body;
mod bounded_curve;
pub mod code;
mod curve;
mod curve2d;
mod error;
mod header;
mod placement;
mod presentation;
mod product;
mod roots;
mod scope;
mod spline;
mod surface;
#[cfg(test)]
mod tests;
mod topology;
mod transformation;
mod units;

pub use code::ModelCode;
pub use curve2d::parameter_scale;

use super::{ExchangeStructure, InstanceName};
use crate::diagnostic::Sink;
use crate::model::Model;
use assembly::{Assembly, Given};
use body::{Bodies, Holders};
use presentation::Styled;
use product::Products;
use roots::Roots;
use scope::{Habits, Scope};
use topology::Builder;

/// Reads the bodies, free curves, units, products, assembly, looks, layers and annotations of a file.
///
/// Never fails: a damaged element is carried as unread or left out, and a diagnostic says so.
pub fn to_model(file: &ExchangeStructure, sink: &mut dyn Sink) -> Model {
    let roots = Roots::find(file);
    let habits = Habits::default();
    let scope = Scope { file, radians: 1.0, habits: &habits };
    let mut products = Products::read(scope, &roots, sink);
    let holders = Holders::find(scope, &roots, &mut products, sink);
    let mut builder = Builder::new(scope, sink);
    let mut bodies = Bodies::new(&products, holders);
    bodies.build(&mut builder, &roots);
    let Bodies { mut attributes, context, mut contexts, free_curves, free_curve_names, holders, .. } = bodies;
    let bodies = builder.origins.bodies.iter();
    let known = bodies.filter_map(|(body, origin)| Some((InstanceName(origin.instance()?), body)));
    let given = Given { scope, roots: &roots, items: &holders.items, bodies: &known.collect() };
    let Assembly { mut occurrences, placed } =
        assembly::assemble(&given, &mut products, &mut contexts, builder.sink);
    let mut styled = Styled {
        products: &mut products,
        bodies: &mut attributes,
        occurrences: &mut occurrences,
        placed: &placed,
    };
    presentation::apply(&mut builder, &roots, &mut styled);
    let annotations = annotation::annotations(&builder, &roots, &products, &occurrences);
    let Builder { brep, origins, faces, sink, .. } = builder;
    habits.report(file, sink);
    header::check(file, sink);
    let model = Model {
        schema: file.schemas().map(|name| name.into_owned()).collect(),
        brep,
        contexts: contexts.all,
        body_context: context,
        faces,
        bodies: attributes,
        free_curves,
        free_curve_names,
        products: products.all,
        occurrences,
        annotations,
        origins,
    };
    assembly::report_size(&model, scope, sink);
    model
}
