//! Records of surfaces.

use super::super::{DirectoryEntry, Entity, EntryNumber};
use super::compose_curve::{self, flat, is_polynomial};
use super::draft::Look;
use super::record::{Record, Value};
use super::slot::{slot, unreadable};
use super::{Ground, LowerError, Lowering};
use crate::brep::FaceId;
use crate::geometry::nurbs::NurbsSurface;
use crate::geometry::{Curve, ParameterMap, Surface};
use crate::iges::to_model::curve::{self, Piece};
use crate::iges::to_model::scope::kind;
use crate::iges::to_model::spline::Rectangle;
use crate::iges::to_model::surface::{self, SurfaceRead, along, angles, composed, swap};
use crate::math::{Affine, Frame, Point3, Vector2, Vector3};
use crate::model::change_set::NewFace;

/// What a surface's record is made for.
struct Site<'g> {
    ground: &'g Ground,
    face: FaceId,
    /// The surface as its entity has it, in its own space.
    old: Option<SurfaceRead>,
    /// Entity that becomes the new one; `None` for a new entity.
    place: Option<EntryNumber>,
    /// Entity type of the old one.
    entity: Option<Entity>,
    form: i32,
    look: Look<'g>,
}

/// Difference between two parameter maps that is rounding.
const SAME_MAP: f64 = 1e-9;
/// Form of an elementary surface with a reference direction.
const WITH_PARAMETERS: i32 = 1;

impl Lowering<'_> {
    /// The record of a surface in its entity's own space, and how the file counts its parameters then.
    pub(super) fn surface_record(
        &mut self,
        ground: &Ground,
        face: FaceId,
        local: &Surface,
        place: Option<EntryNumber>,
    ) -> Result<(Record, ParameterMap), LowerError> {
        let instance = self.scope.instance(ground.surface).map_err(|e| unreadable(ground.surface, &e))?;
        let entry = instance.entry();
        let site = Site {
            ground,
            face,
            old: surface::definition(&self.scope, ground.surface).ok(),
            place,
            entity: kind(instance),
            form: entry.form,
            look: Look::part(entry),
        };
        if let Surface::Nurbs(spline) = local {
            return self.spline_record(&site, spline);
        }
        let (record, candidates) = self.kind_record(&site, local)?;
        let Some(&first) = candidates.first() else { return Ok((record, ground.map)) };
        let placed = |map: &ParameterMap| {
            let moved = local.parameter_map(&ground.placed()).ok()?;
            Some(composed(&moved, map))
        };
        let unwritable = || LowerError::Unwritable { number: ground.surface, kind: local.kind() };
        if let Some(map) = candidates.iter().filter_map(placed).find(|map| same_map(map, &ground.map)) {
            return Ok((record, map));
        }
        let map = placed(&first).ok_or_else(unwritable)?;
        let turns = |map: &ParameterMap| map.linear.determinant() < 0.0;
        if ground.read.parameters.is_empty() || turns(&map) == turns(&ground.map) {
            return Ok((record, map));
        }
        // The normal by the file's parameters would turn, and with it what shells and loops say of the face.
        let (u, v) = self.extent(face, local, &ground.placed()).ok_or_else(unwritable)?;
        let spline = local.to_nurbs(u, v).map_err(|_| unwritable())?;
        self.spline_record(&site, &spline)
    }

    /// The record of the surface of a new face, in the space of the face beside it, and how the file counts its
    /// parameters. A loose face has its surface's normal: where the new one is against that, the surface is turned.
    pub(super) fn new_surface_record(
        &mut self,
        face: &NewFace,
        beside: &Ground,
    ) -> Result<(Record, ParameterMap), LowerError> {
        let unwritable = || LowerError::Unwritable { number: beside.face, kind: face.surface.kind() };
        let local = match beside.within.inverse() {
            Some(_) if beside.within.is_identity() => face.surface.clone(),
            Some(back) => face.surface.transformed(&back).map_err(|_| unwritable())?,
            None => return Err(unwritable()),
        };
        let turned = !beside.is_solid && !face.same_sense;
        if let Surface::Nurbs(spline) = &local {
            let ((first, last), _) = spline.domain();
            let back = ParameterMap::stretch(-1.0, 1.0, Vector2::new(first + last, 0.0));
            let map = if turned { back } else { ParameterMap::identity() };
            let own = in_file(spline, &map).ok_or_else(unwritable)?;
            let bounds = own.domain();
            return Ok((spline_surface(&own, bounds, 0), map));
        }
        if turned {
            return Err(unwritable());
        }
        let ground = Ground { own: Affine::identity(), map: ParameterMap::identity(), ..beside.clone() };
        let site = Site {
            ground: &ground,
            face: face.beside,
            old: None,
            place: None,
            entity: None,
            form: WITH_PARAMETERS,
            look: Look::part(
                self.scope.instance(beside.face).map_err(|e| unreadable(beside.face, &e))?.entry(),
            ),
        };
        let (record, candidates) = self.kind_record(&site, &local)?;
        let moved = local.parameter_map(&beside.within).map_err(|_| unwritable())?;
        Ok((record, composed(&moved, candidates.first().ok_or_else(unwritable)?)))
    }

    /// The record of a surface in a file that has no other yet, and how it counts the parameters. `face` says how much of
    /// the surface is needed where the format wants ends.
    pub(in crate::iges) fn surface_of_new_file(
        &mut self,
        face: FaceId,
        surface: &Surface,
    ) -> Result<(Record, ParameterMap), LowerError> {
        if let Surface::Nurbs(spline) = surface {
            return Ok((spline_surface(spline, spline.domain(), 0), ParameterMap::identity()));
        }
        let entry = DirectoryEntry::default();
        let ground = Ground::of_new_file(surface);
        let site = Site {
            ground: &ground,
            face,
            old: None,
            place: None,
            entity: None,
            form: WITH_PARAMETERS,
            look: Look::part(&entry),
        };
        let (record, candidates) = self.kind_record(&site, &self.seam_away(face, surface))?;
        Ok((record, candidates.first().copied().unwrap_or_else(ParameterMap::identity)))
    }

    /// How much of a swept surface a new entity takes: all of its curve where that has ends, else what the face needs.
    fn reach(&self, site: &Site<'_>, local: &Surface) -> Option<Rectangle> {
        let seen = self.extent(site.face, local, &site.ground.placed());
        let whole = |curve: &Curve| {
            let (from, to) = curve.domain();
            (from.is_finite() && to.is_finite()).then_some((from, to))
        };
        match local {
            Surface::Revolution { curve, .. } if site.old.is_none() => {
                let along = whole(curve).or(seen.map(|(_, v)| v))?;
                Some(((0.0, std::f64::consts::TAU), along))
            }
            Surface::LinearExtrusion { curve, .. } if site.old.is_none() => {
                let (u, v) = seen?;
                Some((whole(curve).unwrap_or(u), v))
            }
            _ => seen,
        }
    }

    /// What the file says of the surface now, where that needs no other entity.
    pub(super) fn old_surface_record(&self, ground: &Ground) -> Option<Record> {
        let SurfaceRead { surface: Surface::Nurbs(spline), bounds: Some(bounds), .. } =
            surface::definition(&self.scope, ground.surface).ok()?
        else {
            return None;
        };
        let instance = self.scope.instance(ground.surface).ok()?;
        (kind(instance) == Some(Entity::RationalBSplineSurface))
            .then(|| spline_surface(&spline, bounds, instance.entry().form))
    }

    /// A B-spline in the parameters that the file counts in, so that curves in these stay right.
    fn spline_record(
        &self,
        site: &Site<'_>,
        spline: &NurbsSurface,
    ) -> Result<(Record, ParameterMap), LowerError> {
        let map =
            if site.ground.read.parameters.is_empty() { ParameterMap::identity() } else { site.ground.map };
        let unwritable = LowerError::Unwritable { number: site.ground.surface, kind: "b_spline" };
        let own = in_file(spline, &map).ok_or(unwritable)?;
        let whole = own.domain();
        let held = |(low, high): (f64, f64), (first, last): (f64, f64)| {
            let range = (low.clamp(first, last), high.clamp(first, last));
            if range.0 < range.1 { range } else { (first, last) }
        };
        let bounds = match site.old.as_ref() {
            Some(SurfaceRead { bounds: Some(bounds), surface: Surface::Nurbs(old), .. })
                if *bounds != old.domain() =>
            {
                (held(bounds.0, whole.0), held(bounds.1, whole.1))
            }
            _ => whole,
        };
        let form = match site.entity {
            Some(Entity::RationalBSplineSurface) => site.form,
            _ => 0,
        };
        Ok((spline_surface(&own, bounds, form), map))
    }

    /// The record of a surface that is no B-spline, and how its parameters may lead to those of the kind in its own space.
    fn kind_record(
        &mut self,
        site: &Site<'_>,
        local: &Surface,
    ) -> Result<(Record, Vec<ParameterMap>), LowerError> {
        match local {
            Surface::Plane(frame) if site.entity == Some(Entity::Plane) => {
                Ok((self.plane_record(site, frame)?, Vec::new()))
            }
            Surface::LinearExtrusion { curve, direction } => {
                self.cylinder_record(site, local, curve, direction)
            }
            Surface::Revolution { curve, frame } => self.revolution_record(site, local, curve, frame),
            Surface::Offset { basis, distance } => self.offset_record(site, basis, *distance),
            Surface::Plane(_)
            | Surface::Cylinder { .. }
            | Surface::Cone { .. }
            | Surface::Sphere { .. }
            | Surface::Torus { .. } => self.elementary_record(site, local),
            other => Err(LowerError::Unwritable { number: site.ground.surface, kind: other.kind() }),
        }
    }

    /// Coefficients as long as they were; boundary and size of the symbol stay.
    fn plane_record(&mut self, site: &Site<'_>, frame: &Frame) -> Result<Record, LowerError> {
        let number = site.ground.surface;
        let view = self.view(number)?;
        let fields = view.fields();
        let old: [f64; 4] = fields.array("coefficients").map_err(|error| unreadable(number, &error))?;
        let normal = Vector3::new(old[0], old[1], old[2]);
        let same = (normal.normalize() - frame.z).norm() <= 4.0 * f64::EPSILON;
        let normal = if same { normal } else { frame.z * normal.norm() };
        let distance = normal.dot(&frame.origin.coords);
        let boundary = if site.place.is_some() { fields.optional_pointer("boundary") } else { None };
        let symbol = frame.origin.coords.iter().copied();
        let record = Record::new(Entity::Plane.number(), if site.place.is_some() { site.form } else { 0 });
        let record = record.reals(normal.iter().copied()).reals([distance]);
        let record = record.values([Value::Pointer(boundary)]);
        Ok(record.reals(symbol).reals([fields.real("size").unwrap_or(0.0)]))
    }

    fn elementary_record(
        &mut self,
        site: &Site<'_>,
        local: &Surface,
    ) -> Result<(Record, Vec<ParameterMap>), LowerError> {
        let unwritable = LowerError::Unwritable { number: site.ground.surface, kind: local.kind() };
        let (entity, frame, sizes) = elementary(local).ok_or(unwritable)?;
        let old = site.old.as_ref().and_then(|old| elementary(&old.surface));
        let old =
            old.filter(|(old, ..)| *old == entity && site.entity == Some(entity)).map(|(_, frame, _)| frame);
        let place = site.place.filter(|_| old.is_some());
        let form = if old.is_some() { site.form } else { WITH_PARAMETERS };
        let axis_field = if entity == Entity::PlaneSurface { "normal" } else { "axis" };
        let vector = |pick: fn(&Frame) -> Vector3<f64>| (pick(frame), old.map(pick));
        let location = self.child(site, place, Entity::Point, "location", vector(|f| f.origin.coords))?;
        let with_axis = entity != Entity::SphericalSurface || form == WITH_PARAMETERS;
        let axis = match with_axis {
            true => Some(self.child(site, place, Entity::Direction, axis_field, vector(|f| f.z))?),
            false => None,
        };
        let reference = match form {
            WITH_PARAMETERS => {
                Some(self.child(site, place, Entity::Direction, "reference", vector(|f| f.x))?)
            }
            _ => None,
        };
        let record = Record::new(entity.number(), form).pointer(location);
        let pointers = |numbers: Option<EntryNumber>| numbers.map(Value::to);
        // A sphere has its radius before its axis.
        let record = if entity == Entity::SphericalSurface {
            record.reals(sizes).values(pointers(axis))
        } else {
            record.values(pointers(axis)).reals(sizes)
        };
        let candidates = if form == WITH_PARAMETERS { angles(entity) } else { Vec::new() };
        Ok((record.values(pointers(reference)), candidates))
    }

    /// A point or direction of an entity: the old one where it stays, or may change; else a new one.
    fn child(
        &mut self,
        site: &Site<'_>,
        parent: Option<EntryNumber>,
        entity: Entity,
        field: &'static str,
        (new, old): (Vector3<f64>, Option<Vector3<f64>>),
    ) -> Result<EntryNumber, LowerError> {
        let known = parent.and_then(|parent| slot(parent, self.view(parent).ok()?.fields(), field));
        if let Some(known) = known {
            if old == Some(new) {
                return Ok(known.target);
            }
            if self.draft.use_count(known.target) == 1 {
                return self.edit_child(known.target, entity, new);
            }
        }
        let record = Record::new(entity.number(), 0).reals(new.iter().copied());
        let record = if entity == Entity::Point { record.values([Value::Pointer(None)]) } else { record };
        self.draft.add(&record, site.look, &[])
    }

    fn edit_child(
        &mut self,
        number: EntryNumber,
        entity: Entity,
        new: Vector3<f64>,
    ) -> Result<EntryNumber, LowerError> {
        let view = self.view(number)?;
        let own = self.scope.matrix(view.instance()).map_err(|error| unreadable(number, &error))?;
        let back = own.inverse().unwrap_or_else(Affine::identity);
        let (field, local) = match entity {
            Entity::Point => ("coordinates", back.point(&Point3::from(new)).coords),
            _ => ("components", back.vector(&new)),
        };
        let parameters: Vec<_> = view.fields().list(field).collect();
        for (parameter, value) in parameters.iter().zip(local.iter()) {
            self.draft.set(number, parameter, Value::Real(*value));
        }
        Ok(number)
    }

    /// A curve that a surface is made of: the old one where only this surface uses it, else a new one.
    fn child_curve(
        &mut self,
        site: &Site<'_>,
        parent: Option<EntryNumber>,
        field: &'static str,
        piece: &Piece,
    ) -> Result<EntryNumber, LowerError> {
        let known = parent.and_then(|parent| slot(parent, self.view(parent).ok()?.fields(), field));
        let Some(known) = known.filter(|known| self.draft.use_count(known.target) == 1) else {
            return self.add_curve(site.ground.surface, piece, site.look);
        };
        self.put_curve(known.target, piece)?;
        Ok(known.target)
    }

    /// Gives a curve another content, in the space of its user.
    pub(super) fn put_curve(&mut self, number: EntryNumber, piece: &Piece) -> Result<(), LowerError> {
        let instance = self.scope.instance(number).map_err(|error| unreadable(number, &error))?;
        let own = self.scope.matrix(instance).map_err(|error| unreadable(number, &error))?;
        let entry = *instance.entry();
        let record = self.curve_record(number, piece, &own, Look::part(&entry))?;
        let old = curve::definition(&self.scope, number).ok().and_then(|old| flat(&old));
        let old = old.filter(|_| record.matrix == super::record::Matrix::Same);
        self.draft.put(number, record, old.as_ref())
    }

    fn cylinder_record(
        &mut self,
        site: &Site<'_>,
        local: &Surface,
        directrix: &Curve,
        direction: &Vector3<f64>,
    ) -> Result<(Record, Vec<ParameterMap>), LowerError> {
        let unwritable = || LowerError::Unwritable { number: site.ground.surface, kind: local.kind() };
        let old = match site.old.as_ref() {
            Some(SurfaceRead { surface: Surface::LinearExtrusion { curve, .. }, bounds, .. }) => {
                bounds.map(|bounds| (curve.as_ref(), bounds))
            }
            _ => None,
        };
        let extent = self.reach(site, local);
        let (u, v) = match old {
            Some((curve, (u, v))) if keeps_range(curve, directrix) => {
                (u, extent.map_or(v, |(_, seen)| covering(v, seen)))
            }
            _ => extent.ok_or_else(unwritable)?,
        };
        let base = directrix.transformed(&Affine::translation(direction * v.0)).map_err(|_| unwritable())?;
        let piece = Piece { curve: base, range: u };
        let end = piece.start() + direction * (v.1 - v.0);
        let place = site.place.filter(|_| site.entity == Some(Entity::TabulatedCylinder));
        let curve = self.child_curve(site, place, "directrix", &piece)?;
        let record = Record::new(Entity::TabulatedCylinder.number(), 0).pointer(curve);
        Ok((record.reals(end.coords.iter().copied()), along(u, v)))
    }

    fn revolution_record(
        &mut self,
        site: &Site<'_>,
        local: &Surface,
        profile: &Curve,
        frame: &Frame,
    ) -> Result<(Record, Vec<ParameterMap>), LowerError> {
        let unwritable = || LowerError::Unwritable { number: site.ground.surface, kind: local.kind() };
        let old = match site.old.as_ref() {
            Some(SurfaceRead {
                surface: Surface::Revolution { curve, .. }, bounds: Some(bounds), ..
            }) if keeps_range(curve, profile) => Some(*bounds),
            _ => None,
        };
        let bounds = old.or_else(|| self.reach(site, local));
        let (u, v) = bounds.ok_or_else(unwritable)?;
        let place = site.place.filter(|_| site.entity == Some(Entity::SurfaceOfRevolution));
        let axis = Curve::Line { origin: frame.origin, direction: frame.z };
        let axis = self.child_curve(site, place, "axis", &Piece { curve: axis, range: (0.0, 1.0) })?;
        let generatrix = Piece { curve: profile.clone(), range: v };
        let generatrix = self.child_curve(site, place, "generatrix", &generatrix)?;
        let record = Record::new(Entity::SurfaceOfRevolution.number(), 0).pointer(axis).pointer(generatrix);
        Ok((record.reals([u.0, u.1]), vec![swap()]))
    }

    fn offset_record(
        &mut self,
        site: &Site<'_>,
        basis: &Surface,
        distance: f64,
    ) -> Result<(Record, Vec<ParameterMap>), LowerError> {
        let number = site.ground.surface;
        let unwritable = || LowerError::Unwritable { number, kind: "offset" };
        // Only a B-spline can stand below an offset without more entities than its own.
        let Surface::Nurbs(spline) = basis else { return Err(unwritable()) };
        let ((u0, u1), (v0, v1)) = spline.domain();
        let normal = basis.normal(0.5 * (u0 + u1), 0.5 * (v0 + v1)).ok_or_else(unwritable)?;
        let place = site.place.filter(|_| site.entity == Some(Entity::OffsetSurface));
        let known = place.and_then(|place| slot(place, self.view(place).ok()?.fields(), "surface"));
        let record = spline_surface(spline, spline.domain(), 0);
        let on = match known.filter(|known| self.draft.use_count(known.target) == 1) {
            Some(known) => {
                let instance = self.scope.instance(known.target).map_err(|e| unreadable(known.target, &e))?;
                if !self.scope.matrix(instance).is_ok_and(|own| own.is_identity()) {
                    return Err(unwritable());
                }
                self.draft.put(known.target, record, None)?;
                known.target
            }
            None => self.draft.add(&record, site.look, &[])?,
        };
        let record = Record::new(Entity::OffsetSurface.number(), 0).reals(normal.iter().copied());
        Ok((record.reals([distance]).pointer(on), vec![ParameterMap::identity()]))
    }
}

/// Whether a new curve runs over the parameters of the old one: an arc that became another kind may count from elsewhere.
fn keeps_range(old: &Curve, new: &Curve) -> bool {
    let old = compose_curve::resolved(Piece { curve: old.clone(), range: old.domain() });
    let new = compose_curve::resolved(Piece { curve: new.clone(), range: new.domain() });
    old.curve.kind() == new.curve.kind() && old.range == new.range
}

/// A range that holds what is seen, and is the old one where that is all of it.
fn covering(old: (f64, f64), seen: (f64, f64)) -> (f64, f64) {
    let slack = 1e-9 * (old.1 - old.0);
    let same = (seen.0 - old.0).abs() <= slack && (seen.1 - old.1).abs() <= slack;
    if same { old } else { (old.0.min(seen.0), if seen.1 > old.1 { seen.1 } else { old.1 }) }
}

/// Entity, frame and lengths of an elementary surface.
fn elementary(surface: &Surface) -> Option<(Entity, &Frame, Vec<f64>)> {
    Some(match surface {
        Surface::Plane(frame) => (Entity::PlaneSurface, frame, Vec::new()),
        Surface::Cylinder { frame, radius } => (Entity::CylindricalSurface, frame, vec![*radius]),
        Surface::Cone { frame, radius, semi_angle } => {
            (Entity::ConicalSurface, frame, vec![*radius, semi_angle.to_degrees()])
        }
        Surface::Sphere { frame, radius } => (Entity::SphericalSurface, frame, vec![*radius]),
        Surface::Torus { frame, major_radius, minor_radius } => {
            (Entity::ToroidalSurface, frame, vec![*major_radius, *minor_radius])
        }
        _ => return None,
    })
}

fn same_map(a: &ParameterMap, b: &ParameterMap) -> bool {
    let size = 1.0 + b.linear.abs().max() + b.translation.abs().max();
    (a.linear - b.linear).abs().max() <= SAME_MAP * size
        && (a.translation - b.translation).abs().max() <= SAME_MAP * size
}

/// A B-spline by the file's parameters, from which `map` leads to its own; `None` when the map turns lines of constant
/// parameters.
fn in_file(spline: &NurbsSurface, map: &ParameterMap) -> Option<NurbsSurface> {
    if map.is_identity() {
        return Some(spline.clone());
    }
    let m = &map.linear;
    let swapped = m[(0, 0)] == 0.0 && m[(1, 1)] == 0.0;
    if !swapped && (m[(0, 1)] != 0.0 || m[(1, 0)] != 0.0) {
        return None;
    }
    // Model u by the file's first (or, swapped, second) parameter, model v by the other.
    let (u, v) = if swapped { (m[(0, 1)], m[(1, 0)]) } else { (m[(0, 0)], m[(1, 1)]) };
    let mut own = spline.clone();
    if u < 0.0 {
        own = own.reversed_u();
    }
    if v < 0.0 {
        own = own.reversed_v();
    }
    let stretched = |knots: &crate::geometry::nurbs::KnotVector, factor: f64, shift: f64| {
        let (first, last) = knots.domain();
        // A reversed one counts over the same domain as before; its far end is where the file begins.
        let at = if factor < 0.0 { (last - shift) / factor } else { (first - shift) / factor };
        let scale = 1.0 / factor.abs();
        knots.affine(scale, at - first * scale).ok()
    };
    let knots_u = stretched(own.knots_u(), u, map.translation.x)?;
    let knots_v = stretched(own.knots_v(), v, map.translation.y)?;
    let own = NurbsSurface::new(knots_u, knots_v, own.net().to_vec()).ok()?;
    Some(if swapped { own.swapped() } else { own })
}

/// Part of its size by which a surface that counts as closed may be open.
const CLOSED: f64 = 1e-9;

/// A B-spline, of which a rectangle is meant.
pub(super) fn spline_surface(spline: &NurbsSurface, (u, v): Rectangle, form: i32) -> Record {
    let (nu, nv) = spline.shape();
    let tolerance = CLOSED * spline.bounding_box().diagonal();
    let [knots_u, knots_v] = [spline.knots_u(), spline.knots_v()];
    let record = Record::new(Entity::RationalBSplineSurface.number(), form).values([
        Value::count(nu - 1),
        Value::count(nv - 1),
        Value::count(knots_u.degree()),
        Value::count(knots_v.degree()),
        Value::flag(spline.is_closed_u(tolerance)),
        Value::flag(spline.is_closed_v(tolerance)),
        Value::flag(is_polynomial(spline.weights())),
        Value::Integer(0),
        Value::Integer(0),
    ]);
    let record = record.reals(knots_u.knots().iter().copied()).reals(knots_v.knots().iter().copied());
    // The file runs along u first, the net along v.
    let weights: Vec<f64> = spline.weights().collect();
    let points: Vec<Point3<f64>> = spline.control_points().collect();
    let order = || (0..nv).flat_map(move |j| (0..nu).map(move |i| i * nv + j));
    let record = record.reals(order().map(|at| weights[at]));
    let record = record.reals(order().flat_map(|at| [points[at].x, points[at].y, points[at].z]));
    record.reals([u.0, u.1, v.0, v.1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::nurbs::KnotVector;
    use crate::math::{Matrix2, Point2, Vector2};

    #[test]
    fn a_spline_in_the_files_parameters_is_the_same_surface() {
        let knots_u = KnotVector::new(1, vec![0.0, 0.0, 0.3, 1.0, 1.0]).expect("knots");
        let knots_v = KnotVector::new(1, vec![2.0, 2.0, 5.0, 5.0]).expect("knots");
        let net = (0..6).map(|k| [f64::from(k), f64::from(k * k), f64::from(7 - k), 1.0]).collect();
        let spline = NurbsSurface::new(knots_u, knots_v, net).expect("a surface");
        let shift = Vector2::new(0.25, -0.5);
        let maps = [
            ParameterMap::stretch(2.0, 0.5, shift),
            ParameterMap::stretch(-2.0, 0.5, shift),
            ParameterMap::stretch(2.0, -3.0, shift),
            ParameterMap { linear: Matrix2::new(0.0, 1.0, 1.0, 0.0), translation: Vector2::zeros() },
            ParameterMap { linear: Matrix2::new(0.0, -2.0, 4.0, 0.0), translation: shift },
        ];
        for map in maps {
            let own = in_file(&spline, &map).expect("a spline");
            let ((a0, a1), (b0, b1)) = own.domain();
            for (s, t) in [(0.0, 0.0), (0.2, 0.7), (1.0, 0.4), (1.0, 1.0)] {
                let (a, b) = (a0 + (a1 - a0) * s, b0 + (b1 - b0) * t);
                let p = map.point(&Point2::new(a, b));
                assert!((own.point(a, b) - spline.point(p.x, p.y)).norm() < 1e-13, "{map:?}");
            }
        }
        let turned = ParameterMap { linear: Matrix2::new(1.0, 1.0, 0.0, 1.0), translation: shift };
        assert_eq!(in_file(&spline, &turned), None);
    }
}
