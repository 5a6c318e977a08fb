//! A page that shows a part: one self-contained HTML text with triangles, edges, the product tree and what the
//! file says of each face and edge.
//!
//! Knows no files and fetches nothing: the page works offline. The script in it is `page.js`, ours.

pub mod base64;
mod scene;

use std::collections::BTreeMap;

use crate::brep::FaceId;
use crate::math::Point3;
use crate::model::Model;
use scene::Scene;

const HTML: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A page, and what it does not show.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// The HTML text.
    pub html: String,
    /// Faces that could not be tessellated, by record, each with the reason.
    pub missing: Vec<String>,
    /// Whether the assembly has more bodies than are shown.
    pub cut: bool,
}

/// Placed bodies of one page at most: beyond that no browser follows.
pub const MOST_BODIES: usize = 20_000;

/// Numbers at points of a face in its body's coordinates; `None` for a face that is shown as new.
pub type ValuesOf<'a> = dyn Fn(FaceId, &[Point3<f64>]) -> Option<Vec<f64>> + 'a;

/// Numbers over the faces of a page, and words about them.
pub struct Overlay<'a> {
    /// What the numbers are, with their unit.
    pub label: String,
    /// The number that gets the full colour, positive.
    pub most: f64,
    /// The numbers.
    pub values: &'a ValuesOf<'a>,
    /// What is told of a face when it is picked.
    pub notes: BTreeMap<String, Vec<String>>,
    /// Lines about the whole.
    pub lines: Vec<String>,
}

/// The page of a model. `chord` is the greatest distance of triangles from their surfaces, in the unit of each
/// body; `None` for a thousandth of the body's size.
#[must_use]
pub fn page(model: &Model, title: &str, chord: Option<f64>) -> Page {
    page_of(Scene::of(model, title, chord, None), title)
}

/// As [`page`], with numbers over the faces.
#[must_use]
pub fn page_with(model: &Model, title: &str, overlay: &Overlay<'_>) -> Page {
    page_of(Scene::of(model, title, None, Some(overlay)), title)
}

fn page_of(scene: Scene, title: &str) -> Page {
    let data = serde_json::to_string(&scene).expect("a scene is a tree of texts and numbers");
    // No text of the file may end the script that holds it.
    let data = data.replace('<', "\\u003c");
    let mut html = String::new();
    // Each mark stands once in the page; what is put in is not searched again.
    let mut rest = HTML;
    for (mark, text) in [
        ("{{title}}", escaped(title)),
        ("{{style}}", STYLE.to_owned()),
        ("{{data}}", data),
        ("{{script}}", SCRIPT.to_owned()),
    ] {
        let (before, after) = rest.split_once(mark).expect("the page has each mark once, in this order");
        html.push_str(before);
        html.push_str(&text);
        rest = after;
    }
    html.push_str(rest);
    Page { html, missing: scene.missing, cut: scene.cut }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_in_the_file_cannot_end_the_script() {
        let context = crate::model::Context {
            length: crate::units::LengthUnit::millimetre(),
            angle: crate::units::AngleUnit::radian(),
            uncertainty: None,
        };
        let model = Model {
            schema: Vec::new(),
            brep: crate::brep::Brep::default(),
            contexts: vec![context],
            body_context: Default::default(),
            faces: Default::default(),
            bodies: Default::default(),
            free_curves: Vec::new(),
            free_curve_names: Vec::new(),
            products: Vec::new(),
            occurrences: Vec::new(),
            annotations: Vec::new(),
            origins: Default::default(),
        };
        let hostile = page(&model, "</script><script>alert(1)//{{data}}", None);
        assert_eq!(hostile.html.matches("</script>").count(), 2);
        assert!(hostile.html.contains("\\u003c/script>"));
        assert_eq!(hostile.missing, [""; 0]);
    }
}
