//! Curves: requested from edges, surface curves, parameter curves and swept surfaces, then edited in
//! place or appended.

use super::super::exchange_structure::InstanceName;
use super::super::to_model::parameter_scale;
use super::compose::{self, Body, Inherited, Value};
use super::request::{Coordinates, NewCurve, NewPlacement, NewVector, group_equal};
use super::{LowerError, Lowering};
use crate::brep::{CoedgeId, CurveId, EdgeId, FaceId};
use crate::geometry::nurbs::NurbsCurve;
use crate::geometry::transform::ParameterMap;
use crate::geometry::{Curve, Curve2d, Surface};
use crate::math::{Vector2, Vector3};
use crate::model::ChangeSet;

impl Lowering<'_> {
    /// Requests the new curves of edges, behind a surface curve where the file has one.
    pub(super) fn request_edge_curves(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        for (&edge, curve) in &changes.curves {
            self.request_edge_curve(edge, curve)?;
        }
        Ok(())
    }

    fn request_edge_curve(&mut self, edge: EdgeId, new: &Curve) -> Result<(), LowerError> {
        let user = super::instance_name(self.model.origins.edges[edge])?;
        let curve = self.model.brep.edges[edge].curve;
        let curve_name = super::instance_name(self.model.origins.curves[curve])?;
        let (token, target) = self.reference(user, "edge_geometry")?;
        let old = self.old_curve(curve);
        if target == curve_name {
            self.curves.add(target, token, NewCurve::Space { old, new: new.clone() });
            return Ok(());
        }
        match self.reference(target, "curve_3d") {
            Ok((inner, behind)) if behind == curve_name => {
                self.curves.add(behind, inner, NewCurve::Space { old, new: new.clone() });
            }
            // A trimmed curve or the like: its bounds are those of the edge, which has vertices, so the
            // new curve stands for all of it.
            _ => self.curves.add(target, token, NewCurve::Space { old: None, new: new.clone() }),
        }
        Ok(())
    }

    fn old_curve(&self, curve: CurveId) -> Option<Curve> {
        self.model.brep.curves[curve].read().cloned()
    }

    /// Requests the new curves of coedges in the parameters of their surfaces.
    pub(super) fn request_pcurves(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        for (&coedge, new) in &changes.pcurves {
            let Some(origin) = self.model.origins.pcurves[coedge] else { continue };
            let pcurve = super::instance_name(origin)?;
            let (_, representation) = self.reference(pcurve, "reference_to_curve")?;
            let (token, target) = self.first_reference(representation, "items")?;
            let unit = self.file_parameters(coedge, changes);
            // What the file says now counts in the unit of the surface that it lies on now.
            let same_unit = unit == self.file_parameters(coedge, &ChangeSet::default());
            let old = self.model.brep.coedges[coedge].pcurve.as_ref().filter(|_| same_unit);
            let old = old.map(|old| in_file(old, &unit, target)).transpose()?;
            self.curves.add(target, token, NewCurve::Plane { old, new: in_file(new, &unit, target)? });
        }
        Ok(())
    }

    /// File parameters of a coedge's (new) surface from those of the model, which counts angles in radians.
    fn file_parameters(&self, coedge: CoedgeId, changes: &ChangeSet) -> ParameterMap {
        let brep = &self.model.brep;
        let face = brep.loops[brep.coedges[coedge].in_loop].face;
        let surface = changes.surfaces.get(&face).or_else(|| brep.surface_of(face).read());
        self.parameters_in_file(face, surface)
    }

    /// Radians of one unit of angle where a face is written.
    pub(super) fn radians_of(&self, face: FaceId) -> f64 {
        self.model.context_of(face).angle.radians
    }

    /// File parameters of a surface, written in the context of a face, from those of the model.
    pub(super) fn parameters_in_file(&self, face: FaceId, surface: Option<&Surface>) -> ParameterMap {
        let radians = self.radians_of(face);
        let [u, v] = surface.map_or([1.0, 1.0], |surface| parameter_scale(surface, radians));
        ParameterMap::stretch(1.0 / u, 1.0 / v, Vector2::zeros())
    }

    /// Replaces curves that belong to no edge. All users follow: they asked for this curve by name.
    pub(super) fn request_free_curves(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        for (&curve, new) in &changes.free_curves {
            let name = super::instance_name(self.model.origins.curves[curve])?;
            let content = NewCurve::Space { old: self.old_curve(curve), new: new.clone() };
            self.edit_curve(name, &content)?;
        }
        Ok(())
    }

    /// Decides all curves.
    pub(super) fn curves(&mut self) -> Result<(), LowerError> {
        let all = self.curves.take().map_err(|name| LowerError::Conflict { name })?;
        for of_one in all.chunk_by(|a, b| a.0 == b.0) {
            let target = of_one[0].0;
            let groups = group_equal(of_one);
            if groups.len() == 1 && self.is_covered(target, of_one.len()) {
                self.edit_curve(target, groups[0].0)?;
                continue;
            }
            for (content, tokens) in groups {
                let inherited = self.inherited_by_curve(target);
                let new = match content {
                    NewCurve::Space { new, .. } => self.append_curve(target, new, &inherited)?,
                    NewCurve::Plane { new, .. } => self.append_curve2d(target, new, &inherited)?,
                };
                for token in tokens {
                    self.repoint(token, target, new);
                }
            }
        }
        Ok(())
    }

    fn edit_curve(&mut self, target: InstanceName, content: &NewCurve) -> Result<(), LowerError> {
        match content {
            NewCurve::Space { old, new } => self.edit_space_curve(target, old.as_ref(), new),
            NewCurve::Plane { old, new } => self.edit_plane_curve(target, old.as_ref(), new),
        }
    }

    fn edit_space_curve(
        &mut self,
        target: InstanceName,
        old: Option<&Curve>,
        new: &Curve,
    ) -> Result<(), LowerError> {
        match (old, new) {
            (Some(Curve::Line { .. }), Curve::Line { origin, direction }) => {
                self.request_line(target, Coordinates::Three(origin.coords.into()), vector3(direction))
            }
            (Some(Curve::Circle { frame: old, .. }), Curve::Circle { frame, radius }) => {
                self.request_position(target, NewPlacement::Space { old: Some(*old), new: *frame })?;
                self.edit_real(target, "radius", *radius)
            }
            (Some(Curve::Ellipse { frame: old, .. }), Curve::Ellipse { frame, semi_axis_1, semi_axis_2 }) => {
                self.request_position(target, NewPlacement::Space { old: Some(*old), new: *frame })?;
                self.edit_real(target, "semi_axis_1", *semi_axis_1)?;
                self.edit_real(target, "semi_axis_2", *semi_axis_2)
            }
            (Some(Curve::Nurbs(old)), Curve::Nurbs(new)) if self.keeps_net(target, old, new) => {
                self.request_net(target, &compose::euclidean(old.points()), &compose::euclidean(new.points()))
            }
            _ => {
                let inherited = self.inherited_by_curve(target);
                let body = self.curve_body(target, new, &inherited)?;
                self.rewrite(target, &body)
            }
        }
    }

    fn edit_plane_curve(
        &mut self,
        target: InstanceName,
        old: Option<&Curve2d>,
        new: &Curve2d,
    ) -> Result<(), LowerError> {
        match (old, new) {
            (Some(Curve2d::Line { .. }), Curve2d::Line { origin, direction }) => {
                self.request_line(target, Coordinates::Two([origin.x, origin.y]), vector2(direction))
            }
            (Some(Curve2d::Nurbs(old)), Curve2d::Nurbs(new)) if self.keeps_net(target, old, new) => {
                self.request_net(target, &compose::euclidean(old.points()), &compose::euclidean(new.points()))
            }
            _ => {
                let inherited = self.inherited_by_curve(target);
                let body = self.curve2d_body(target, new, &inherited)?;
                self.rewrite(target, &body)
            }
        }
    }

    fn request_line(
        &mut self,
        target: InstanceName,
        origin: Coordinates,
        vector: NewVector,
    ) -> Result<(), LowerError> {
        let (token, point) = self.reference(target, "pnt")?;
        self.points.add(point, token, origin);
        let (token, direction) = self.reference(target, "dir")?;
        self.vectors.add(direction, token, vector);
        Ok(())
    }

    pub(super) fn request_position(
        &mut self,
        target: InstanceName,
        content: NewPlacement,
    ) -> Result<(), LowerError> {
        let (token, placement) = self.reference(target, "position")?;
        self.placements.add(placement, token, content);
        Ok(())
    }

    /// Whether only the points of a spline differ, from a net that the file itself writes: the model's is
    /// another one where the file's knots were not clamped.
    fn keeps_net<const H: usize>(
        &self,
        target: InstanceName,
        old: &NurbsCurve<H>,
        new: &NurbsCurve<H>,
    ) -> bool {
        old.knots() == new.knots()
            && self.writes_knots(target, "knot_multiplicities", "knots", new.knots())
            && old.points().iter().zip(new.points()).all(|(a, b)| a[H - 1].to_bits() == b[H - 1].to_bits())
            && self
                .references(target, "control_points_list")
                .is_some_and(|list| list.len() == new.points().len())
    }

    /// Requests new points for a net whose record stays; points that keep their bits are not asked for.
    pub(super) fn request_net(
        &mut self,
        target: InstanceName,
        old: &[Coordinates],
        new: &[Coordinates],
    ) -> Result<(), LowerError> {
        let listed = self
            .references(target, "control_points_list")
            .ok_or(LowerError::Attribute { name: target, attribute: "control_points_list" })?;
        for ((token, point), (old, new)) in listed.into_iter().zip(old.iter().zip(new)) {
            if old != new {
                self.points.add(point, token, *new);
            }
        }
        Ok(())
    }

    /// Appends a curve in space with everything it refers to; it stands for the record `old`, or is a part of
    /// what does.
    pub(in crate::step) fn append_curve(
        &mut self,
        old: InstanceName,
        curve: &Curve,
        inherited: &Inherited,
    ) -> Result<InstanceName, LowerError> {
        let body = self.curve_body(old, curve, inherited)?;
        self.append(&body)
    }

    pub(in crate::step) fn append_curve2d(
        &mut self,
        old: InstanceName,
        curve: &Curve2d,
        inherited: &Inherited,
    ) -> Result<InstanceName, LowerError> {
        let body = self.curve2d_body(old, curve, inherited)?;
        self.append(&body)
    }

    fn curve_body(
        &mut self,
        old: InstanceName,
        curve: &Curve,
        inherited: &Inherited,
    ) -> Result<Body, LowerError> {
        Ok(match curve {
            Curve::Line { origin, direction } => {
                let point = self.append_point(origin.coords.as_slice())?;
                let vector = self.append_vector(&vector3(direction))?;
                let [point, vector] = [point, vector].map(Value::Reference);
                Body::simple("LINE", vec![inherited.name(), point, vector])
            }
            Curve::Circle { frame, radius } => {
                let position = Value::Reference(self.append_frame(frame)?);
                Body::simple("CIRCLE", vec![inherited.name(), position, Value::Real(*radius)])
            }
            Curve::Ellipse { frame, semi_axis_1, semi_axis_2 } => {
                let position = Value::Reference(self.append_frame(frame)?);
                let semi_axes = [semi_axis_1, semi_axis_2].map(|&length| Value::Real(length));
                Body::simple("ELLIPSE", [vec![inherited.name(), position], semi_axes.to_vec()].concat())
            }
            Curve::Nurbs(spline) => {
                let points = self.append_net(&compose::euclidean(spline.points()))?;
                compose::spline_curve(spline, points, inherited)
            }
            Curve::Parabola { frame, focal_distance } => {
                let position = Value::Reference(self.append_frame(frame)?);
                Body::simple("PARABOLA", vec![inherited.name(), position, Value::Real(*focal_distance)])
            }
            Curve::Hyperbola { frame, semi_axis, semi_imaginary_axis } => {
                let position = Value::Reference(self.append_frame(frame)?);
                let semi_axes = [semi_axis, semi_imaginary_axis].map(|&length| Value::Real(length));
                Body::simple("HYPERBOLA", [vec![inherited.name(), position], semi_axes.to_vec()].concat())
            }
            Curve::Polyline(spline) => {
                let points = self.append_net(&compose::euclidean(spline.points()))?;
                let points = Value::List(points.into_iter().map(Value::Reference).collect());
                Body::simple("POLYLINE", vec![inherited.name(), points])
            }
            Curve::Trimmed(piece) => self.trimmed_body(old, piece, inherited)?,
            Curve::Composite(whole) => self.composite_body(old, whole, inherited)?,
            Curve::Offset { basis, distance, direction } => {
                self.offset_body(old, (basis, *distance, direction), inherited)?
            }
        })
    }

    fn curve2d_body(
        &mut self,
        old: InstanceName,
        curve: &Curve2d,
        inherited: &Inherited,
    ) -> Result<Body, LowerError> {
        Ok(match curve {
            Curve2d::Line { origin, direction } => {
                let point = self.append_point(origin.coords.as_slice())?;
                let vector = self.append_vector(&vector2(direction))?;
                let [point, vector] = [point, vector].map(Value::Reference);
                Body::simple("LINE", vec![inherited.name(), point, vector])
            }
            Curve2d::Ellipse { center, x, semi_axis_1, semi_axis_2, .. } => {
                let position = Value::Reference(self.append_frame2(center, x)?);
                let placed = vec![inherited.name(), position, Value::Real(*semi_axis_1)];
                if semi_axis_1.to_bits() == semi_axis_2.to_bits() {
                    return Ok(Body::simple("CIRCLE", placed));
                }
                Body::simple("ELLIPSE", [placed, vec![Value::Real(*semi_axis_2)]].concat())
            }
            Curve2d::Nurbs(spline) => {
                let points = self.append_net(&compose::euclidean(spline.points()))?;
                compose::spline_curve(spline, points, inherited)
            }
            _ => return Err(LowerError::Unwritable { name: old, kind: curve.kind() }),
        })
    }

    /// Appends the points of a net.
    pub(super) fn append_net(&mut self, points: &[Coordinates]) -> Result<Vec<InstanceName>, LowerError> {
        points.iter().map(|point| self.append_point(point.as_slice())).collect()
    }
}

/// A curve in parameters in those of the file; it stands for the record `name`, or beside it.
pub(super) fn in_file(
    curve: &Curve2d,
    unit: &ParameterMap,
    name: InstanceName,
) -> Result<Curve2d, LowerError> {
    if unit.is_identity() {
        return Ok(curve.clone());
    }
    curve.transformed(unit).map_err(|_| LowerError::Unwritable { name, kind: "parameter curve" })
}

pub(super) fn vector3(direction: &Vector3<f64>) -> NewVector {
    let magnitude = direction.norm();
    NewVector { direction: Coordinates::Three((direction / magnitude).into()), magnitude }
}

fn vector2(direction: &Vector2<f64>) -> NewVector {
    let magnitude = direction.norm();
    NewVector { direction: Coordinates::Two((direction / magnitude).into()), magnitude }
}
