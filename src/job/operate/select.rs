//! Selectors against a model: which faces a job means, or what comes nearest to it.
//!
//! Distances and areas are those of a coarse triangulation of the face within its bounds; where a face
//! cannot be triangulated, those of its vertices, and the face never wins by area.

use std::collections::{BTreeMap, BTreeSet};

use crate::brep::FaceId;
use crate::job::file::LengthSetting;
use crate::job::file::selector::{ColourSetting, Conditions, Extreme, NamePattern, Selector};
use crate::job::report::measure::kind;
use crate::math::Point3;
use crate::mesh::{Tolerances, tessellate_faces, to_triangle};
use crate::model::{Colour, Model, Origin};
use crate::units::LengthUnit;

/// A selector does not select what is needed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SelectError {
    /// Nothing matches.
    #[error("{what} matches no face{}", candidates(.nearest))]
    NoMatch {
        /// The selector in words.
        what: String,
        /// What comes nearest.
        nearest: Vec<String>,
    },
    /// One face is needed.
    #[error("{what} matches {} faces, and one is needed{}", .found.len(), candidates(.found))]
    Several {
        /// The selector in words.
        what: String,
        /// What matches.
        found: Vec<String>,
    },
    /// No curve matches.
    #[error("{what} matches no curve{}", candidates(.nearest))]
    NoCurve {
        /// The selector in words.
        what: String,
        /// What comes nearest.
        nearest: Vec<String>,
    },
    /// One curve is needed.
    #[error("{what} matches {} free curves, and one is needed{}", .found.len(), candidates(.found))]
    SeveralCurves {
        /// The selector in words.
        what: String,
        /// What matches.
        found: Vec<String>,
    },
}

/// Candidates that a message names.
const NAMED: usize = 5;

fn candidates(faces: &[String]) -> String {
    if faces.is_empty() {
        return String::new();
    }
    let more = if faces.len() > NAMED { format!(" and {} more", faces.len() - NAMED) } else { String::new() };
    format!("; candidates are {}{more}", faces[..faces.len().min(NAMED)].join(", "))
}

/// Faces of a selector, ascending and never empty.
///
/// # Errors
/// [`SelectError`] with the nearest candidates.
pub fn faces(model: &Model, selector: &Selector) -> Result<Vec<FaceId>, SelectError> {
    match selector {
        Selector::Record(record) => of_record(model, *record),
        Selector::All(conditions) => all(model, conditions),
        Selector::Any(selectors) => {
            let mut found = BTreeSet::new();
            for selector in selectors {
                found.extend(faces(model, selector)?);
            }
            Ok(found.into_iter().collect())
        }
    }
}

/// The one face of a selector; the only face of the model when there is none.
///
/// # Errors
/// [`SelectError`].
pub fn one_face(model: &Model, selector: Option<&Selector>) -> Result<FaceId, SelectError> {
    let (found, what) = match selector {
        Some(selector) => (faces(model, selector)?, "the selector"),
        None => (model.brep.faces.ids().collect(), "a selector that is left out"),
    };
    match found.as_slice() {
        [face] => Ok(*face),
        [] => Err(SelectError::NoMatch { what: what.to_owned(), nearest: Vec::new() }),
        _ => Err(SelectError::Several {
            what: what.to_owned(),
            found: found.iter().map(|&face| describe(model, face)).collect(),
        }),
    }
}

/// A face in words: `#1042 "HOOD" b_spline`.
#[must_use]
pub fn describe(model: &Model, face: FaceId) -> String {
    let name = &model.faces[face].name;
    let quoted = if name.is_empty() { String::new() } else { format!(" \"{name}\"") };
    format!("{}{quoted} {}", model.origins.faces[face], kind(model.brep.surface_of(face)))
}

fn of_record(model: &Model, record: Origin) -> Result<Vec<FaceId>, SelectError> {
    let origins = &model.origins.faces;
    if let Some((face, _)) = origins.iter().find(|(_, origin)| **origin == record) {
        return Ok(vec![face]);
    }
    let mut near: Vec<(u64, FaceId)> =
        origins.iter().map(|(face, origin)| (origin.distance(record), face)).collect();
    near.sort();
    let nearest = near.into_iter().take(NAMED).map(|(_, face)| describe(model, face)).collect();
    Err(SelectError::NoMatch { what: format!("`{record}`"), nearest })
}

/// One condition on a face: its key, what it wants, and what each face has.
struct Condition<'a> {
    what: String,
    holds: Box<dyn Fn(FaceId) -> bool + 'a>,
    /// What each face offers for this key.
    offers: Box<dyn Fn(FaceId) -> Vec<String> + 'a>,
}

fn all(model: &Model, conditions: &Conditions) -> Result<Vec<FaceId>, SelectError> {
    let mut found: Vec<FaceId> = model.brep.faces.ids().collect();
    for condition in list(model, conditions)? {
        let matching: Vec<FaceId> = found.iter().copied().filter(|&face| (condition.holds)(face)).collect();
        if matching.is_empty() {
            return Err(no_match(&condition, &found));
        }
        found = matching;
    }
    if let Some(extreme) = conditions.area {
        found = by_area(model, &found, extreme);
    }
    if let Some(near) = &conditions.near {
        found = nearest_to(model, &found, near).into_iter().take(1).collect();
    }
    if found.is_empty() {
        let what = "the selector".to_owned();
        return Err(SelectError::NoMatch { what, nearest: Vec::new() });
    }
    Ok(found)
}

/// What the faces offer for a key that none satisfies: the nearest word, or else the commonest.
fn no_match(condition: &Condition<'_>, faces: &[FaceId]) -> SelectError {
    let mut offers: BTreeMap<String, usize> = BTreeMap::new();
    for offer in faces.iter().flat_map(|&face| (condition.offers)(face)).filter(|offer| !offer.is_empty()) {
        *offers.entry(offer).or_insert(0) += 1;
    }
    let wanted = condition.what.split('`').nth(1).unwrap_or_default();
    let near =
        crate::job::text::nearest::nearest(wanted, offers.keys().map(String::as_str)).map(str::to_owned);
    let mut common: Vec<(usize, String)> = offers.into_iter().map(|(offer, count)| (count, offer)).collect();
    common.sort_by(|a, b| b.0.cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    let rest = common.into_iter().map(|(_, offer)| offer).filter(|offer| Some(offer) != near.as_ref());
    let nearest = near.clone().into_iter().chain(rest).map(|offer| format!("`{offer}`")).collect();
    SelectError::NoMatch { what: condition.what.clone(), nearest }
}

/// The words that a face offers for one key.
type NamesOf = fn(&Model, FaceId) -> Vec<String>;

fn list<'a>(model: &'a Model, conditions: &Conditions) -> Result<Vec<Condition<'a>>, SelectError> {
    let mut list = Vec::new();
    if let Some(wanted) = conditions.surface {
        let of = |face| kind(model.brep.surface_of(face));
        list.push(Condition {
            what: format!("surface `{}`", wanted.as_str()),
            holds: Box::new(move |face| of(face) == wanted.as_str()),
            offers: Box::new(move |face| vec![of(face)]),
        });
    }
    if let Some(wanted) = conditions.colour {
        list.push(Condition {
            what: format!("colour `{}`", hex(wanted.0)),
            holds: Box::new(move |face| model.colour_of(face).is_some_and(|c| same_colour(c, wanted))),
            offers: Box::new(move |face| model.colour_of(face).map(|c| hex(bytes(c))).into_iter().collect()),
        });
    }
    let names: [(&str, &Option<NamePattern>, NamesOf); 3] = [
        ("product", &conditions.product, product_names),
        ("layer", &conditions.layer, layers),
        ("name", &conditions.name, face_names),
    ];
    for (key, pattern, of) in names {
        let Some(pattern) = pattern else { continue };
        let glob = pattern.matcher();
        list.push(Condition {
            what: format!("{key} `{pattern}`"),
            holds: Box::new(move |face| of(model, face).iter().any(|name| glob.is_match(name))),
            offers: Box::new(move |face| of(model, face)),
        });
    }
    Ok(list)
}

fn face_names(model: &Model, face: FaceId) -> Vec<String> {
    let own = &model.faces[face].name;
    let body = &model.bodies[model.body_of(face)].own.name;
    vec![if own.is_empty() { body.clone() } else { own.clone() }]
}

fn product_names(model: &Model, face: FaceId) -> Vec<String> {
    model.product_of(face).map(|p| vec![p.name.clone(), p.id.clone()]).unwrap_or_default()
}

pub(in crate::job) fn layers(model: &Model, face: FaceId) -> Vec<String> {
    let body = &model.bodies[model.body_of(face)].own.layers;
    model.faces[face].layers.iter().chain(body).cloned().collect()
}

pub(in crate::job) fn bytes(colour: Colour) -> [u8; 3] {
    // The cast is of a number between 0 and 255.
    [colour.red, colour.green, colour.blue].map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
}

pub(in crate::job) fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Files write colours with as few as two decimals, which is two steps of 255 or so.
const COLOUR_STEPS: u8 = 2;

fn same_colour(colour: Colour, wanted: ColourSetting) -> bool {
    bytes(colour).iter().zip(wanted.0).all(|(a, b)| a.abs_diff(b) <= COLOUR_STEPS)
}

/// The faces, nearest first.
fn nearest_to(model: &Model, faces: &[FaceId], point: &[LengthSetting; 3]) -> Vec<FaceId> {
    let mut distances: Vec<(f64, FaceId)> = Vec::new();
    for &face in faces {
        let at = point_in(point, &model.context_of(face).length);
        distances.push((distance(model, face, &at), face));
    }
    distances.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    distances.into_iter().map(|(_, face)| face).collect()
}

/// A point of the job in the units of a file.
#[must_use]
pub fn point_in(point: &[LengthSetting; 3], unit: &LengthUnit) -> Point3<f64> {
    let [x, y, z] = point.map(|length| length.0.in_unit(unit));
    Point3::new(x, y, z)
}

fn triangles(model: &Model, face: FaceId) -> Vec<[Point3<f64>; 3]> {
    let points: Vec<Point3<f64>> = vertices(model, face);
    let mut size: f64 = 0.0;
    for point in &points {
        size = size.max((point - points[0]).norm());
    }
    // A closed face may have one vertex: any positive size will do, since the tolerance only orders faces.
    let tolerances = Tolerances::for_size(if size > 0.0 { size } else { 1.0 });
    match tessellate_faces(&model.brep, &[face], &tolerances) {
        Ok(mesh) => mesh.corners().collect(),
        Err(_) => Vec::new(),
    }
}

fn vertices(model: &Model, face: FaceId) -> Vec<Point3<f64>> {
    let brep = &model.brep;
    let ends = brep.coedges_of(face).flat_map(|c| {
        let edge = &brep.edges[brep.coedges[c].edge];
        [edge.start, edge.end]
    });
    ends.map(|v| brep.vertices[v].point).collect()
}

fn distance(model: &Model, face: FaceId, at: &Point3<f64>) -> f64 {
    let to_triangles =
        triangles(model, face).iter().map(|t| to_triangle(at, t)).fold(f64::INFINITY, f64::min);
    let to_vertices = vertices(model, face).iter().map(|p| (p - at).norm()).fold(f64::INFINITY, f64::min);
    to_triangles.min(to_vertices)
}

fn area(model: &Model, face: FaceId) -> Option<f64> {
    let triangles = triangles(model, face);
    let one = |[a, b, c]: &[Point3<f64>; 3]| 0.5 * (b - a).cross(&(c - a)).norm();
    (!triangles.is_empty()).then(|| triangles.iter().map(one).sum())
}

/// Size and place of a face by its triangulation.
pub(in crate::job) struct Shape {
    pub area: f64,
    pub bounds: [[f64; 3]; 2],
}

/// Size and place of a face; `None` when it cannot be triangulated.
pub(in crate::job) fn shape(model: &Model, face: FaceId) -> Option<Shape> {
    let area = area(model, face)?;
    let (mut least, mut greatest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in triangles(model, face).iter().flatten() {
        for k in 0..3 {
            least[k] = least[k].min(point[k]);
            greatest[k] = greatest[k].max(point[k]);
        }
    }
    Some(Shape { area, bounds: [least, greatest] })
}

fn by_area(model: &Model, faces: &[FaceId], extreme: Extreme) -> Vec<FaceId> {
    let measured = faces.iter().filter_map(|&face| Some((area(model, face)?, face)));
    let best = match extreme {
        Extreme::Largest => measured.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))),
        Extreme::Smallest => measured.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))),
    };
    best.map(|(_, face)| face).into_iter().collect()
}
