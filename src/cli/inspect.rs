//! `resurf inspect`: what is inside a part.

use std::fmt::Write;

use super::arguments::InspectArguments;
use super::exit_code;
use super::print::Printer;
use super::show;
use crate::job::failure::PartError;
use crate::job::operate::OperateError;
use crate::job::operate::select;
use crate::job::part::Read;
use crate::job::report::contents::{Contents, TreeEntry, contents};
use crate::job::report::measure::{BodyMeasures, measure_bodies, measure_face};

/// Inspects a part and gives the exit code.
pub fn inspect(arguments: &InspectArguments, printer: &mut Printer) -> u8 {
    match seen(arguments, printer) {
        Ok((contents, whole)) => {
            let text = if arguments.json { json(&contents) } else { plain(&contents) };
            printer.data(&text);
            if whole { exit_code::DONE } else { exit_code::GATE }
        }
        Err(error) => {
            show::part_error(printer, &arguments.part, &error);
            error.exit_code()
        }
    }
}

/// What the part holds, and whether all of it was understood.
fn seen(arguments: &InspectArguments, printer: &mut Printer) -> Result<(Contents, bool), PartError> {
    let mut read = Read::file(&arguments.part)?;
    let model = read.model();
    show::diagnostics(printer, &arguments.part, &read);
    read.refuse_damage()?;
    let faces = match &arguments.face {
        Some(selector) => select::faces(&model, selector).map_err(OperateError::Face)?,
        None if arguments.faces => model.brep.faces.ids().collect(),
        None => Vec::new(),
    };
    let mut contents = contents(&model, &faces);
    if arguments.measure {
        contents.bodies = measure_bodies(&model);
        for (entry, &face) in contents.faces.iter_mut().zip(&faces) {
            entry.measured = measure_face(&model, face);
        }
    }
    Ok((contents, !read.has_errors()))
}

fn json(contents: &Contents) -> String {
    let mut text =
        serde_json::to_string_pretty(contents).expect("what a part holds is a tree of texts and numbers");
    text.push('\n');
    text
}

/// Lines of the tree that are shown.
const TREE_LINES: usize = 200;

fn tree_line(node: &TreeEntry) -> String {
    let indent = "  ".repeat(node.depth.min(TREE_LINES));
    let place = node.placement.map(|[.., [x, y, z]]| {
        let short = |number: f64| (number * 1e6).round() / 1e6 + 0.0;
        format!(" at ({}, {}, {})", short(x), short(y), short(z))
    });
    let used = node.occurrence.as_ref().filter(|name| !name.is_empty()).map(|name| format!(" as {name:?}"));
    let bodies = if node.bodies.is_empty() { String::new() } else { format!(": {}", node.bodies.join(" ")) };
    format!("{indent}{:?}{}{}{bodies}", node.product, used.unwrap_or_default(), place.unwrap_or_default())
}

fn body_line(body: &BodyMeasures) -> String {
    let mut text = body.id.clone();
    let mut add = |word: &str, value: Option<f64>| {
        text += &value.map(|value| format!(" {word} {value}")).unwrap_or_default();
    };
    add("volume", body.volume);
    add("area", body.area);
    if let Some([x, y, z]) = body.centroid {
        text += &format!(" centroid ({}, {}, {})", number(x), number(y), number(z));
    }
    text + &body.unknown.as_ref().map(|reason| format!(" not measured: {reason}")).unwrap_or_default()
}

/// A number that people read; one next to nothing would be a long row of zeros.
fn number(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-6 { format!("{value:e}") } else { value.to_string() }
}

fn plain(contents: &Contents) -> String {
    let figures = &contents.figures;
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<15} {value}");
    };
    line("schema", figures.schema.join(", "));
    line("units", figures.units.join(", "));
    for (name, count) in &figures.counts {
        line(name, count.to_string());
    }
    let surfaces: Vec<String> =
        figures.surfaces.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
    line("surfaces", surfaces.join(", "));
    if let Some([least, greatest]) = figures.vertex_extents {
        let point = |[x, y, z]: [f64; 3]| format!("({}, {}, {})", number(x), number(y), number(z));
        line("vertices", format!("within {} to {}", point(least), point(greatest)));
    }
    for product in &contents.products {
        let used = product.used_in.join(", ");
        let used = if used.is_empty() { String::new() } else { format!(" in {used}") };
        let times = if product.instances > 1 { format!(" x{}", product.instances) } else { String::new() };
        let external = product.external.join(", ");
        let external = if external.is_empty() { external } else { format!(", shape in {external}") };
        line("product", format!("{} {:?}{times}{used}{external}", product.id, product.name));
    }
    let trunk = if contents.tree.len() > 1 { contents.tree.as_slice() } else { &[] };
    for node in trunk.iter().take(TREE_LINES) {
        line("tree", tree_line(node));
    }
    if contents.tree_cut || trunk.len() > TREE_LINES {
        line("tree", "… more of it with --json".to_owned());
    }
    for group in &contents.groups {
        line("selector", format!("{} finds {}", group.selector, group.faces));
    }
    for (kind, count) in &contents.annotations {
        line(kind, count.to_string());
    }
    for body in &contents.bodies {
        line("body", body_line(body));
    }
    for face in &contents.faces {
        let colour = face.colour.as_deref().unwrap_or("no colour");
        let neighbours = match face.neighbours.as_slice() {
            [] => "without neighbours".to_owned(),
            neighbours => format!("next to {}", neighbours.join(" ")),
        };
        line("face", format!("{} {:?} {} {colour}, {neighbours}", face.id, face.name, face.surface));
    }
    text
}
