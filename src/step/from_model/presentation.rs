//! Colours and layers (ISO 10303-46).

use std::collections::BTreeMap;

use super::super::exchange_structure::InstanceName;
use super::super::lower::compose::{Value, verbatim};
use super::{FromModelError, Writer, list, text, to};
use crate::brep::{BodyId, FaceId};
use crate::model::Colour;

/// Styles by the bits of their colours: one for each.
type Styles = BTreeMap<[u64; 3], InstanceName>;

impl Writer<'_, '_> {
    /// Styles every body and face that has a colour of its own.
    pub(super) fn styles(&mut self) -> Result<(), FromModelError> {
        let mut styles = Styles::new();
        let mut items = Vec::new();
        let mut of_bodies: BTreeMap<BodyId, InstanceName> = BTreeMap::new();
        let bodies: Vec<(BodyId, InstanceName)> = self.bodies.iter().map(|(&id, &name)| (id, name)).collect();
        for (body, name) in bodies {
            let own = self.model.bodies[body].own.appearance.colour;
            let product = self.model.bodies[body].product.map(|at| &self.model.products[at]);
            let colour = own.or_else(|| product.and_then(|product| product.appearance.colour));
            if let Some(colour) = colour {
                let style = self.style(&mut styles, colour)?;
                let values = vec![text("color"), list([style]), to(name)];
                let item = self.add("STYLED_ITEM", values)?;
                of_bodies.insert(body, item);
                items.push(item);
            }
        }
        let faces: Vec<(FaceId, InstanceName)> = self.faces.iter().map(|(&id, &name)| (id, name)).collect();
        for (face, name) in faces {
            let Some(colour) = self.model.faces[face].appearance.colour else { continue };
            let style = self.style(&mut styles, colour)?;
            let mut values = vec![text("color"), list([style]), to(name)];
            let keyword = match of_bodies.get(&self.model.body_of(face)) {
                Some(&below) => {
                    values.push(to(below));
                    "OVER_RIDING_STYLED_ITEM"
                }
                None => "STYLED_ITEM",
            };
            items.push(self.add(keyword, values)?);
        }
        if !items.is_empty() {
            let values = vec![text(""), list(items), to(self.space)];
            self.add("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION", values)?;
        }
        Ok(())
    }

    fn style(&mut self, styles: &mut Styles, colour: Colour) -> Result<InstanceName, FromModelError> {
        let parts = [colour.red, colour.green, colour.blue];
        let key = parts.map(f64::to_bits);
        if let Some(&known) = styles.get(&key) {
            return Ok(known);
        }
        let [red, green, blue] = parts.map(Value::Real);
        let colour = self.add("COLOUR_RGB", vec![text(""), red, green, blue])?;
        let of_colour = self.add("FILL_AREA_STYLE_COLOUR", vec![text(""), to(colour)])?;
        let fill = self.add("FILL_AREA_STYLE", vec![text(""), list([of_colour])])?;
        let area = self.add("SURFACE_STYLE_FILL_AREA", vec![to(fill)])?;
        let side = self.add("SURFACE_SIDE_STYLE", vec![text(""), list([area])])?;
        let usage = self.add("SURFACE_STYLE_USAGE", vec![verbatim(".BOTH."), to(side)])?;
        let style = self.add("PRESENTATION_STYLE_ASSIGNMENT", vec![list([usage])])?;
        styles.insert(key, style);
        Ok(style)
    }

    /// Writes each layer with the bodies and faces that lie on it.
    pub(super) fn layers(&mut self) -> Result<(), FromModelError> {
        let mut layers: BTreeMap<&str, Vec<InstanceName>> = BTreeMap::new();
        let model = self.model;
        for (body, name) in &self.bodies {
            for layer in &model.bodies[*body].own.layers {
                layers.entry(layer).or_default().push(*name);
            }
        }
        for (face, name) in &self.faces {
            for layer in &model.faces[*face].layers {
                layers.entry(layer).or_default().push(*name);
            }
        }
        for (layer, items) in layers {
            self.add("PRESENTATION_LAYER_ASSIGNMENT", vec![text(layer), text(""), list(items)])?;
        }
        Ok(())
    }
}
