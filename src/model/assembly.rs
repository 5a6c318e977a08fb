//! Where an assembly puts its components: products, their uses in each other, and the walk over all of them.
//!
//! Nothing is flattened: a component that is used a thousand times is held once. The [`Instances`] walk
//! unfolds the uses on demand, up to a limit.

use std::collections::BTreeSet;

use super::{Appearance, Colour, Model, Origin};
use crate::brep::{BodyId, FaceId};
use crate::math::Affine;
use crate::units::LengthUnit;

/// A product definition.
#[derive(Debug, Clone, PartialEq)]
pub struct Product {
    /// Decoded `PRODUCT.id`.
    pub id: String,
    /// Decoded `PRODUCT.name`.
    pub name: String,
    /// The product definition's record.
    pub origin: Origin,
    /// Unit of the product's own coordinates; `None` when the file gives it no shape.
    pub unit: Option<LengthUnit>,
    /// Bodies of its shape, each where the shape has it. Components' bodies are not among them.
    pub shapes: Vec<PlacedShape>,
    /// Look of its whole shape, for bodies that have none of their own.
    pub appearance: Appearance,
    /// Names of other files that its shape stands in, as this file writes them. They are not opened.
    pub external: Vec<String>,
}

/// A body in the coordinates of a product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedShape {
    /// The body.
    pub body: BodyId,
    /// From the body's coordinates, in its own unit, to the product's.
    pub transform: Affine,
}

/// The use of one product in another.
#[derive(Debug, Clone, PartialEq)]
pub struct Occurrence {
    /// Index of the assembly into [`Model::products`].
    pub parent: usize,
    /// Index of the component into [`Model::products`].
    pub child: usize,
    /// Decoded identifier of the usage.
    pub id: String,
    /// Decoded name of the usage.
    pub name: String,
    /// From the component's coordinates, in its unit, to the assembly's. `None` when the file does not say
    /// where the component is; the walk leaves it where its own coordinates are.
    pub placement: Option<Affine>,
    /// Looks that hold in this use only.
    pub overrides: Vec<Override>,
    /// Record of the usage.
    pub origin: Origin,
}

/// A colour that holds in one use of a product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Override {
    /// What is coloured.
    pub target: OverrideTarget,
    /// Its colour.
    pub colour: Colour,
}

/// What an override is put on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OverrideTarget {
    /// Whatever has no colour of its own within the component.
    Component,
    /// A body of the component.
    Body(BodyId),
    /// A face of the component.
    Face(FaceId),
}

/// A product where the assembly has it, or a root.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The product: an index into [`Model::products`].
    pub product: usize,
    /// The use that put it here: an index into [`Model::occurrences`]; `None` for a root.
    pub occurrence: Option<usize>,
    /// The assembly above: an index into [`Instances::nodes`], less than this node's.
    pub parent: Option<usize>,
    /// Uses between this node and its root.
    pub depth: usize,
    /// From the product's coordinates to the walk's.
    pub transform: Affine,
}

/// A body where the assembly has it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedBody {
    /// The body.
    pub body: BodyId,
    /// The product instance that it is a shape of: an index into [`Instances::nodes`]; `None` for a body
    /// that no product has.
    pub node: Option<usize>,
    /// From the body's coordinates to the walk's.
    pub transform: Affine,
}

/// Every product instance and every placed body, in one unit: roots in file order, each before its
/// components.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Instances {
    /// Product instances; a node's index is greater than that of the node above it.
    pub nodes: Vec<Node>,
    /// Bodies, in the order of their nodes; those without a product last.
    pub bodies: Vec<PlacedBody>,
    /// Whether the walk ended before it was through: the limit was met.
    pub cut: bool,
}

impl Instances {
    /// Product instances and placed bodies of one walk at most. The greatest assemblies of real files have
    /// some ten thousand; a hostile one has 2^n after n levels.
    pub const LIMIT: usize = 200_000;

    /// Unfolds the assembly in the given unit, up to `limit` product instances and as many bodies.
    #[must_use]
    pub fn of(model: &Model, unit: &LengthUnit, limit: usize) -> Self {
        let components = Components::of(model);
        let roots = components.roots().rev().map(|product| root(model, product, unit)).collect();
        let mut instances = Self::unfolded(model, &components, roots, limit);
        if !instances.cut {
            instances.add_loose(model, unit);
        }
        instances
    }

    /// Unfolds what is below one product, in the product's own coordinates; it is the first node.
    #[must_use]
    pub fn below(model: &Model, product: usize, limit: usize) -> Self {
        let top = Node { product, occurrence: None, parent: None, depth: 0, transform: Affine::identity() };
        Self::unfolded(model, &Components::of(model), vec![top], limit)
    }

    /// Unfolds some products; `ahead` are those still to visit, the next one last.
    fn unfolded(model: &Model, components: &Components, mut ahead: Vec<Node>, limit: usize) -> Self {
        let mut instances = Self::default();
        while let Some(node) = ahead.pop() {
            if instances.nodes.len() >= limit || instances.bodies.len() >= limit {
                instances.cut = true;
                return instances;
            }
            let at = instances.nodes.len();
            for &occurrence in components.of[node.product].iter().rev() {
                ahead.push(below(model, &node, at, occurrence));
            }
            for shape in &model.products[node.product].shapes {
                let transform = node.transform.after(&shape.transform);
                instances.bodies.push(PlacedBody { body: shape.body, node: Some(at), transform });
            }
            instances.nodes.push(node);
        }
        instances
    }

    /// Bodies that are the shape of no product stand where they are.
    fn add_loose(&mut self, model: &Model, unit: &LengthUnit) {
        let held: BTreeSet<BodyId> =
            model.products.iter().flat_map(|product| &product.shapes).map(|shape| shape.body).collect();
        for body in model.brep.bodies.ids().filter(|body| !held.contains(body)) {
            let own = &model.contexts[model.body_context[body]].length;
            let transform = Affine::scale(own.metres / unit.metres);
            self.bodies.push(PlacedBody { body, node: None, transform });
        }
    }

    /// The nodes from a root down to this one.
    #[must_use]
    pub fn path(&self, node: usize) -> Vec<usize> {
        let mut path = vec![node];
        let mut at = node;
        while let Some(parent) = self.nodes[at].parent {
            path.push(parent);
            at = parent;
        }
        path.reverse();
        path
    }

    /// Colour of a face of a placed body: its own or its body's, unless a use on the way says otherwise; the
    /// outermost use has the last word.
    #[must_use]
    pub fn colour(&self, model: &Model, placed: &PlacedBody, face: FaceId) -> Option<Colour> {
        let mut of_face = model.faces[face].appearance.colour;
        let mut of_body = model.bodies[placed.body].own.appearance.colour;
        let mut inherited = None;
        let mut at = placed.node;
        while let Some(node) = at {
            let node = &self.nodes[node];
            inherited = inherited.or(model.products[node.product].appearance.colour);
            let uses = node.occurrence.map(|occurrence| model.occurrences[occurrence].overrides.as_slice());
            for change in uses.unwrap_or_default() {
                let colour = Some(change.colour);
                match change.target {
                    OverrideTarget::Component => inherited = colour,
                    OverrideTarget::Body(body) if body == placed.body => of_body = colour,
                    OverrideTarget::Face(changed) if changed == face => of_face = colour,
                    OverrideTarget::Body(_) | OverrideTarget::Face(_) => {}
                }
            }
            at = node.parent;
        }
        of_face.or(of_body).or(inherited)
    }
}

fn root(model: &Model, product: usize, unit: &LengthUnit) -> Node {
    let factor = model.products[product].unit.as_ref().map_or(1.0, |own| own.metres / unit.metres);
    Node { product, occurrence: None, parent: None, depth: 0, transform: Affine::scale(factor) }
}

fn below(model: &Model, above: &Node, parent: usize, occurrence: usize) -> Node {
    let used = &model.occurrences[occurrence];
    let placement = used.placement.unwrap_or_else(|| {
        let metres = |product: usize| model.products[product].unit.as_ref().map(|unit| unit.metres);
        let factor = metres(used.child).zip(metres(used.parent)).map_or(1.0, |(child, own)| child / own);
        Affine::scale(factor)
    });
    Node {
        product: used.child,
        occurrence: Some(occurrence),
        parent: Some(parent),
        depth: above.depth + 1,
        transform: above.transform.after(&placement),
    }
}

/// Uses of each product's components.
struct Components {
    of: Vec<Vec<usize>>,
    used: Vec<bool>,
}

impl Components {
    fn of(model: &Model) -> Self {
        let mut components =
            Self { of: vec![Vec::new(); model.products.len()], used: vec![false; model.products.len()] };
        for (at, occurrence) in model.occurrences.iter().enumerate() {
            components.of[occurrence.parent].push(at);
            components.used[occurrence.child] = true;
        }
        components
    }

    /// Products that no other uses.
    fn roots(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        (0..self.used.len()).filter(|&product| !self.used[product])
    }
}

/// How often each product stands in the unfolded assembly: a root once. Saturates, and needs no unfolding.
#[must_use]
pub fn instance_counts(model: &Model) -> Vec<u64> {
    let components = Components::of(model);
    let mut missing = vec![0usize; model.products.len()];
    for occurrence in &model.occurrences {
        missing[occurrence.child] += 1;
    }
    let mut counts = vec![0u64; model.products.len()];
    let mut ready: Vec<usize> = components.roots().collect();
    ready.iter().for_each(|&root| counts[root] = 1);
    while let Some(product) = ready.pop() {
        for &occurrence in &components.of[product] {
            let child = model.occurrences[occurrence].child;
            counts[child] = counts[child].saturating_add(counts[product]);
            missing[child] -= 1;
            if missing[child] == 0 {
                ready.push(child);
            }
        }
    }
    counts
}

/// Indices of the occurrences that close a circle: a product within itself. The others make a tree or a
/// lattice. Depth-first in file order, without recursion.
///
/// `occurrences` are pairs of parent and child below `products`.
#[must_use]
pub fn circular_occurrences(products: usize, occurrences: &[(usize, usize)]) -> Vec<usize> {
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); products];
    for (at, &(parent, _)) in occurrences.iter().enumerate() {
        below[parent].push(at);
    }
    let (mut circular, mut open, mut done) = (Vec::new(), vec![false; products], vec![false; products]);
    for start in 0..products {
        // Products on the way down, each with how many of its uses are passed.
        let mut way: Vec<(usize, usize)> = if done[start] { Vec::new() } else { vec![(start, 0)] };
        while let Some((product, passed)) = way.last_mut() {
            open[*product] = true;
            let Some(&occurrence) = below[*product].get(*passed) else {
                open[*product] = false;
                done[*product] = true;
                way.pop();
                continue;
            };
            *passed += 1;
            let child = occurrences[occurrence].1;
            if open[child] {
                circular.push(occurrence);
            } else if !done[child] {
                way.push((child, 0));
            }
        }
    }
    circular.sort_unstable();
    circular
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_within_itself_is_found_and_a_lattice_is_not() {
        // 0 uses 1 and 2, both use 3: a lattice.
        assert_eq!(circular_occurrences(4, &[(0, 1), (0, 2), (1, 3), (2, 3)]), [0usize; 0]);
        assert_eq!(circular_occurrences(3, &[(0, 1), (1, 2), (2, 0)]), [2]);
        assert_eq!(circular_occurrences(1, &[(0, 0)]), [0]);
    }
}
