//! Surfaces of faces: edited in place, or appended with the face and its parameter curves turned to them.

use std::collections::BTreeSet;

use super::super::exchange_structure::InstanceName;
use super::compose::{self, Body, Inherited, Value};
use super::request::{NewCurve, NewPlacement};
use super::{LowerError, Lowering};
use crate::brep::{FaceId, SurfaceId};
use crate::geometry::nurbs::NurbsSurface;
use crate::geometry::{Curve, Surface};
use crate::math::Frame;
use crate::model::ChangeSet;

impl Lowering<'_> {
    /// Decides the surfaces of all changed faces.
    pub(super) fn surfaces(&mut self, changes: &ChangeSet) -> Result<(), LowerError> {
        let mut faces: Vec<(SurfaceId, FaceId)> =
            changes.surfaces.keys().map(|&face| (self.model.brep.faces[face].surface, face)).collect();
        faces.sort_unstable();
        for of_one in faces.chunk_by(|a, b| a.0 == b.0) {
            let faces: Vec<FaceId> = of_one.iter().map(|&(_, face)| face).collect();
            self.decide_surface(of_one[0].0, &faces, changes)?;
        }
        Ok(())
    }

    fn decide_surface(
        &mut self,
        surface: SurfaceId,
        faces: &[FaceId],
        changes: &ChangeSet,
    ) -> Result<(), LowerError> {
        let target = super::instance_name(self.model.origins.surfaces[surface])?;
        let pcurves = self.pcurves_on(faces)?;
        let agree = faces.iter().all(|face| changes.surfaces[face] == changes.surfaces[&faces[0]]);
        if agree && self.is_covered(target, faces.len() + pcurves.len()) {
            let old = self.model.brep.surfaces[surface].read().cloned();
            let radians = self.radians_of(faces[0]);
            return self.edit_surface(target, old.as_ref(), &changes.surfaces[&faces[0]], radians);
        }
        for &face in faces {
            self.give_own_surface(face, target, &changes.surfaces[&face])?;
        }
        Ok(())
    }

    /// Records of the parameter curves that lie on the surface as parts of these faces.
    fn pcurves_on(&self, faces: &[FaceId]) -> Result<BTreeSet<InstanceName>, LowerError> {
        let coedges = faces.iter().flat_map(|&face| self.model.brep.coedges_of(face));
        let origins = coedges.filter_map(|coedge| self.model.origins.pcurves[coedge]);
        origins.map(super::instance_name).collect()
    }

    fn give_own_surface(&mut self, face: FaceId, old: InstanceName, new: &Surface) -> Result<(), LowerError> {
        let inherited = self.inherited_by_surface(old, new);
        let body = self.surface_body(old, new, self.radians_of(face), &inherited)?;
        let name = self.append(&body)?;
        let user = super::instance_name(self.model.origins.faces[face])?;
        let (token, _) = self.reference(user, "face_geometry")?;
        self.repoint(token, old, name);
        self.own_surfaces.insert(face, name);
        for pcurve in self.pcurves_on(&[face])? {
            let (token, _) = self.reference(pcurve, "basis_surface")?;
            self.repoint(token, old, name);
        }
        Ok(())
    }

    fn edit_surface(
        &mut self,
        target: InstanceName,
        old: Option<&Surface>,
        new: &Surface,
        radians: f64,
    ) -> Result<(), LowerError> {
        match (old, new) {
            (Some(Surface::Plane(old)), Surface::Plane(new)) => self.request_surface_frame(target, old, new),
            (Some(Surface::Cylinder { frame: old, .. }), Surface::Cylinder { frame, radius })
            | (Some(Surface::Sphere { frame: old, .. }), Surface::Sphere { frame, radius }) => {
                self.request_surface_frame(target, old, frame)?;
                self.edit_real(target, "radius", *radius)
            }
            (
                Some(Surface::Cone { frame: old, semi_angle: old_angle, .. }),
                Surface::Cone { frame, radius, semi_angle },
            ) => {
                self.request_surface_frame(target, old, frame)?;
                self.edit_real(target, "radius", *radius)?;
                if old_angle.to_bits() != semi_angle.to_bits() {
                    self.edit_real(target, "semi_angle", semi_angle / radians)?;
                }
                Ok(())
            }
            (
                Some(Surface::Torus { frame: old, .. }),
                Surface::Torus { frame, major_radius, minor_radius },
            ) => {
                self.request_surface_frame(target, old, frame)?;
                self.edit_real(target, "major_radius", *major_radius)?;
                self.edit_real(target, "minor_radius", *minor_radius)
            }
            (
                Some(Surface::LinearExtrusion { curve: old, .. }),
                Surface::LinearExtrusion { curve, direction },
            ) => {
                self.request_swept_curve(target, old, curve)?;
                let (token, vector) = self.reference(target, "extrusion_axis")?;
                self.vectors.add(vector, token, super::curve::vector3(direction));
                Ok(())
            }
            (
                Some(Surface::Revolution { curve: old, frame: old_frame }),
                Surface::Revolution { curve, frame },
            ) => {
                self.request_swept_curve(target, old, curve)?;
                let (token, axis) = self.reference(target, "axis_position")?;
                self.placements.add(axis, token, NewPlacement::Axis { old: Some(*old_frame), new: *frame });
                Ok(())
            }
            (Some(Surface::Nurbs(old)), Surface::Nurbs(new)) if self.keeps_surface_net(target, old, new) => {
                self.request_net(target, &compose::euclidean(old.net()), &compose::euclidean(new.net()))
            }
            _ => {
                let inherited = self.inherited_by_surface(target, new);
                let body = self.surface_body(target, new, radians, &inherited)?;
                self.rewrite(target, &body)
            }
        }
    }

    fn request_surface_frame(
        &mut self,
        target: InstanceName,
        old: &Frame,
        new: &Frame,
    ) -> Result<(), LowerError> {
        self.request_position(target, NewPlacement::Space { old: Some(*old), new: *new })
    }

    fn request_swept_curve(
        &mut self,
        target: InstanceName,
        old: &Curve,
        new: &Curve,
    ) -> Result<(), LowerError> {
        let (token, curve) = self.reference(target, "swept_curve")?;
        self.curves.add(curve, token, NewCurve::Space { old: Some(old.clone()), new: new.clone() });
        Ok(())
    }

    fn keeps_surface_net(&self, target: InstanceName, old: &NurbsSurface, new: &NurbsSurface) -> bool {
        old.knots_u() == new.knots_u()
            && old.knots_v() == new.knots_v()
            && self.writes_knots(target, "u_multiplicities", "u_knots", new.knots_u())
            && self.writes_knots(target, "v_multiplicities", "v_knots", new.knots_v())
            && old.net().iter().zip(new.net()).all(|(a, b)| a[3].to_bits() == b[3].to_bits())
            && self
                .references(target, "control_points_list")
                .is_some_and(|list| list.len() == new.net().len())
    }

    fn elementary(
        &mut self,
        keyword: &'static str,
        inherited: &Inherited,
        frame: &Frame,
        reals: &[f64],
    ) -> Result<Body, LowerError> {
        let position = Value::Reference(self.append_frame(frame)?);
        let reals = reals.iter().map(|&value| Value::Real(value));
        Ok(Body::simple(keyword, [inherited.name(), position].into_iter().chain(reals).collect()))
    }

    /// Text of a surface that stands for the record `old`, or beside it.
    pub(in crate::step) fn surface_body(
        &mut self,
        old: InstanceName,
        surface: &Surface,
        radians: f64,
        inherited: &Inherited,
    ) -> Result<Body, LowerError> {
        Ok(match surface {
            Surface::Plane(frame) => self.elementary("PLANE", inherited, frame, &[])?,
            Surface::Cylinder { frame, radius } => {
                self.elementary("CYLINDRICAL_SURFACE", inherited, frame, &[*radius])?
            }
            Surface::Sphere { frame, radius } => {
                self.elementary("SPHERICAL_SURFACE", inherited, frame, &[*radius])?
            }
            Surface::Torus { frame, major_radius, minor_radius } => {
                self.elementary("TOROIDAL_SURFACE", inherited, frame, &[*major_radius, *minor_radius])?
            }
            Surface::Cone { frame, radius, semi_angle } => {
                self.elementary("CONICAL_SURFACE", inherited, frame, &[*radius, semi_angle / radians])?
            }
            Surface::LinearExtrusion { curve, direction } => {
                let curve = self.append_curve(old, curve, &Inherited::nothing())?;
                let vector = self.append_vector(&super::curve::vector3(direction))?;
                let [curve, vector] = [curve, vector].map(Value::Reference);
                Body::simple("SURFACE_OF_LINEAR_EXTRUSION", vec![inherited.name(), curve, vector])
            }
            Surface::Revolution { curve, frame } => {
                let curve = self.append_curve(old, curve, &Inherited::nothing())?;
                let axis = self.append_placement(&NewPlacement::Axis { old: None, new: *frame })?;
                let [curve, axis] = [curve, axis].map(Value::Reference);
                Body::simple("SURFACE_OF_REVOLUTION", vec![inherited.name(), curve, axis])
            }
            Surface::Nurbs(spline) => {
                let points = self.append_net(&compose::euclidean(spline.net()))?;
                compose::spline_surface(spline, &points, inherited)
            }
            Surface::Offset { basis, distance } => {
                let basis = self.surface_body(old, basis, radians, &Inherited::nothing())?;
                let basis = Value::Reference(self.append(&basis)?);
                let values = vec![inherited.name(), basis, Value::Real(*distance), compose::verbatim(".U.")];
                Body::simple("OFFSET_SURFACE", values)
            }
            Surface::Trimmed { .. } | Surface::CurveBounded { .. } | Surface::Composite(_) => {
                return Err(LowerError::Unwritable { name: old, kind: surface.kind() });
            }
        })
    }
}
