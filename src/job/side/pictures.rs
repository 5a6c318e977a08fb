//! Pictures of what a job did to the faces that it changed: highlight lines and mean curvature before and after, and the
//! deviation of the one from the other.
//!
//! Draws the faces alone, seen against the place where they changed most. Curves and points are not drawn.

use std::collections::{BTreeMap, VecDeque};

use crate::brep::FaceId;
use crate::geometry::Surface;
use crate::geometry::nurbs::{NurbsSurface, SurfaceLocator, Wrap};
use crate::job::failure::PartError;
use crate::job::file::PictureKind;
use crate::math::{BoundingBox, Point3, Vector3};
use crate::mesh::divide::divided;
use crate::mesh::{Mesh, Tolerances, tessellate_faces};
use crate::model::{Model, Origin};
use crate::picture::{FieldView, PictureOptions, View, field, highlight_lines};

/// A picture in memory.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::job) struct Picture {
    pub kind: PictureKind,
    pub png: Vec<u8>,
    /// Number that gets the full colour, in file units; absent for highlight lines.
    pub full_colour: Option<f64>,
}

/// Sides of the drawn triangles at most, and chord of the mesh, as parts of what is drawn.
const SIDE: f64 = 1.0 / 160.0;
const CHORD: f64 = 1e-4;
/// Part of the vertices whose curvature may be beyond the full colour: peaks would leave the rest pale.
const BEYOND: f64 = 0.01;
/// Deviation, as a part of the greatest, from which a place counts as changed.
const CHANGED: f64 = 0.01;
/// How far around the changed place is drawn, in diagonals of its box.
const AROUND: f64 = 0.4;
/// Tilt of the eye from the normal of the changed place: relief is not seen from above.
const TILT: f64 = 0.45;
/// Part of a normal along `z` from which `y` is up in the picture.
const UPRIGHT: f64 = 0.85;
/// Length of the mean normal above which a change is on one side of the part.
const ONE_SIDE: f64 = 0.6;
/// Bands across a view, fewer than for a flat one: a curved face shows each many times.
const BANDS: f64 = 8.0;
/// A foot farther from its point than this part of the mesh is sought anew.
const LOST: f64 = 1e-3;

/// Draws pictures of the faces whose surfaces differ; none when there is no such face.
///
/// # Errors
/// [`PartError::Picture`].
pub(in crate::job) fn draw(
    before: &Model,
    after: &Model,
    kinds: &[PictureKind],
) -> Result<Vec<Picture>, PartError> {
    let changed = changed_faces(before, after);
    if changed.is_empty() || kinds.is_empty() {
        return Ok(Vec::new());
    }
    let (mut old, mut new) = (Drawn::default(), Drawn::default());
    for (was, is) in changed {
        old.add(before, was, None)?;
        new.add(after, is, Some((before, was)))?;
    }
    let options = options(new.eye(), new.place());
    kinds.iter().map(|&kind| picture(kind, &old, &new, &options)).collect()
}

/// Faces with another surface, before and after.
fn changed_faces(before: &Model, after: &Model) -> Vec<(FaceId, FaceId)> {
    let known: BTreeMap<Origin, FaceId> =
        after.origins.faces.iter().map(|(id, origin)| (*origin, id)).collect();
    let pairs =
        before.brep.faces.ids().filter_map(|was| Some((was, *known.get(&before.origins.faces[was])?)));
    pairs.filter(|(was, is)| before.brep.surface_of(*was) != after.brep.surface_of(*is)).collect()
}

/// Seen from a little above the normal of the changed place.
fn options(normal: Vector3<f64>, focus: Option<BoundingBox>) -> PictureOptions {
    let up = if normal.z.abs() > UPRIGHT { Vector3::y() } else { Vector3::z() };
    let across = up.cross(&normal).try_normalize(0.0).unwrap_or_else(Vector3::x);
    let above = normal.cross(&across);
    PictureOptions {
        eye: normal + above * TILT,
        up,
        lights_above: normal,
        lights_along: above,
        bands: BANDS,
        focus,
        ..PictureOptions::default()
    }
}

fn picture(
    kind: PictureKind,
    old: &Drawn,
    new: &Drawn,
    options: &PictureOptions,
) -> Result<Picture, PartError> {
    let (drawn, full_colour) = match kind {
        PictureKind::Highlight => {
            (highlight_lines(&[View { mesh: &old.mesh }, View { mesh: &new.mesh }], options), None)
        }
        PictureKind::Curvature => {
            let full = full_colour(&[&old.curvature, &new.curvature], BEYOND);
            let views = [old, new].map(|d| FieldView { mesh: &d.mesh, values: &d.curvature, full });
            (field(&views, options), Some(full))
        }
        PictureKind::Deviation => {
            let full = full_colour(&[&new.deviation], 0.0);
            let view = FieldView { mesh: &new.mesh, values: &new.deviation, full };
            // One view instead of two.
            let options = PictureOptions { width: options.width / 2, ..options.clone() };
            (field(&[view], &options), Some(full))
        }
    };
    let png = drawn.map_err(|error| PartError::Picture(error.to_string()))?;
    Ok(Picture { kind, png, full_colour })
}

/// The number that all but a part of the values stay below.
fn full_colour(values: &[&[f64]], beyond: f64) -> f64 {
    let mut all: Vec<f64> = values.iter().flat_map(|v| v.iter()).map(|x| x.abs()).collect();
    all.sort_by(f64::total_cmp);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of the list")]
    let at = (all.len() as f64 * (1.0 - beyond)) as usize;
    all.get(at.min(all.len().saturating_sub(1))).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE)
}

/// Faces as triangles with numbers at the vertices.
#[derive(Debug, Default)]
struct Drawn {
    mesh: Mesh,
    /// Mean curvature, positive where the face bulges outwards.
    curvature: Vec<f64>,
    /// Distance from the face as it was, positive outwards.
    deviation: Vec<f64>,
}

impl Drawn {
    fn add(&mut self, model: &Model, face: FaceId, old: Option<(&Model, FaceId)>) -> Result<(), PartError> {
        let Some(surface) = model.brep.surface_of(face).read() else { return Ok(()) };
        let mut mesh = face_mesh(model, face)?;
        let outward = if outward(model, face) { 1.0 } else { -1.0 };
        let feet = feet(surface, &mesh, None);
        for (vertex, at) in mesh.vertices.iter_mut().zip(&feet) {
            let d = surface.derivatives(at.0, at.1);
            *vertex = d.point;
            // Curvature counts towards the normal; a bulge bends away from it.
            self.curvature.push(d.curvatures().map_or(0.0, |(_, mean)| -outward * mean));
        }
        for (corners, normals) in mesh.triangles.iter().zip(&mut mesh.normals) {
            for (corner, normal) in corners.iter().zip(normals) {
                let at = feet[*corner as usize];
                *normal = surface.derivatives(at.0, at.1).normal().map_or(*normal, |n| n * outward);
            }
        }
        let was = old.and_then(|(model, face)| model.brep.surface_of(face).read());
        match was {
            Some(was) => {
                let feet = self::feet(was, &mesh, Some(&feet));
                self.deviation.extend(mesh.vertices.iter().zip(feet).map(|(point, at)| {
                    let d = was.derivatives(at.0, at.1);
                    d.normal().map_or(0.0, |normal| outward * normal.dot(&(point - d.point)))
                }));
            }
            None => self.deviation.resize(self.curvature.len(), 0.0),
        }
        self.mesh.append(&mesh);
        Ok(())
    }

    /// Mean normal of what changed, weighted by how far it went; where it looks to all sides, that of the place that
    /// went farthest.
    fn eye(&self) -> Vector3<f64> {
        let (mut sum, mut total) = (Vector3::zeros(), 0.0);
        let mut farthest = (0.0, Vector3::z());
        for (([a, b, c], at), normals) in
            self.mesh.corners().zip(&self.mesh.triangles).zip(&self.mesh.normals)
        {
            let area = (b - a).cross(&(c - a)).norm();
            for (k, normal) in at.iter().zip(normals) {
                let moved = self.deviation[*k as usize].abs();
                sum += normal * (area * moved);
                total += area * moved;
                if moved > farthest.0 {
                    farthest = (moved, *normal);
                }
            }
        }
        if sum.norm() > ONE_SIDE * total { sum.normalize() } else { farthest.1 }
    }

    /// The box to draw: that of what changed and its neighbourhood; `None` where most of the face changed.
    fn place(&self) -> Option<BoundingBox> {
        let greatest = self.deviation.iter().fold(0.0_f64, |a, d| a.max(d.abs()));
        let moved = self.mesh.vertices.iter().zip(&self.deviation);
        let moved: Vec<_> = moved.filter(|(_, d)| d.abs() > CHANGED * greatest).map(|(p, _)| *p).collect();
        let (place, whole) = (BoundingBox::of(&moved), BoundingBox::of(&self.mesh.vertices));
        if moved.is_empty() || place.diagonal() * (1.0 + 2.0 * AROUND) > whole.diagonal() {
            return None;
        }
        let around = Vector3::repeat(AROUND * place.diagonal());
        Some(BoundingBox { min: place.min - around, max: place.max + around })
    }
}

/// Whether the surface's own normal points out of the face.
fn outward(model: &Model, face: FaceId) -> bool {
    let face = &model.brep.faces[face];
    face.same_sense == model.brep.shells[face.shell].forward
}

/// Triangles of a face, short enough for numbers at their corners to say what lies between.
fn face_mesh(model: &Model, face: FaceId) -> Result<Mesh, PartError> {
    let mesh = |tolerances: &Tolerances| {
        tessellate_faces(&model.brep, &[face], tolerances)
            .map_err(|error| PartError::Picture(error.to_string()))
    };
    let ends = model.brep.vertices.iter().map(|(_, vertex)| &vertex.point);
    let rough = mesh(&Tolerances::for_size(BoundingBox::of(ends).diagonal().max(f64::MIN_POSITIVE)))?;
    let size = BoundingBox::of(&rough.vertices).diagonal();
    let fine = mesh(&Tolerances { chord: CHORD * size, ..Tolerances::for_size(size) })?;
    Ok(divided(&fine, SIDE * size))
}

/// Parameters of the surface nearest to each vertex: from those of neighbours, or from the given ones.
fn feet(surface: &Surface, mesh: &Mesh, seeds: Option<&[(f64, f64)]>) -> Vec<(f64, f64)> {
    let feet = Feet::on(surface);
    let far = LOST * BoundingBox::of(&mesh.vertices).diagonal();
    let from = |point: &Point3<f64>, seed: (f64, f64)| {
        let found = feet.near(point, seed);
        let away = (surface.point(found.0, found.1) - point).norm();
        // What was moved is away from the old surface, and still has its foot near the seed.
        if away > far && seeds.is_none() { feet.anywhere(point) } else { found }
    };
    if let Some(seeds) = seeds {
        return mesh.vertices.iter().zip(seeds).map(|(point, seed)| from(point, *seed)).collect();
    }
    let mut known: Vec<Option<(f64, f64)>> = vec![None; mesh.vertices.len()];
    let neighbours = neighbours(mesh);
    let mut open = VecDeque::new();
    for start in 0..mesh.vertices.len() {
        if known[start].is_none() {
            known[start] = Some(feet.anywhere(&mesh.vertices[start]));
            open.push_back(start);
        }
        while let Some(at) = open.pop_front() {
            let Some(seed) = known[at] else { continue };
            for &next in &neighbours[at] {
                if known[next].is_none() {
                    known[next] = Some(from(&mesh.vertices[next], seed));
                    open.push_back(next);
                }
            }
        }
    }
    known.into_iter().map(Option::unwrap_or_default).collect()
}

/// Feet of points on a surface; whether it closes on itself is asked once.
enum Feet<'a> {
    Spline(&'a NurbsSurface, SurfaceLocator<'a>, Wrap),
    Other(&'a Surface),
}

impl<'a> Feet<'a> {
    fn on(surface: &'a Surface) -> Self {
        match surface {
            Surface::Nurbs(spline) => {
                let wrap = surface.wrap();
                Self::Spline(spline, SurfaceLocator::new(spline, wrap), wrap)
            }
            other => Self::Other(other),
        }
    }

    fn anywhere(&self, point: &Point3<f64>) -> (f64, f64) {
        match self {
            Self::Spline(_, locator, _) => {
                let found = locator.closest(point);
                (found.u, found.v)
            }
            Self::Other(surface) => surface.parameters_of(point, None),
        }
    }

    fn near(&self, point: &Point3<f64>, seed: (f64, f64)) -> (f64, f64) {
        match self {
            Self::Spline(spline, _, wrap) => {
                let found = spline.closest_from(point, seed, *wrap);
                (found.u, found.v)
            }
            Self::Other(surface) => surface.parameters_of(point, Some(seed)),
        }
    }
}

fn neighbours(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut found = vec![Vec::new(); mesh.vertices.len()];
    for corners in &mesh.triangles {
        for k in 0..3 {
            found[corners[k] as usize].push(corners[(k + 1) % 3] as usize);
        }
    }
    found
}
