//! Solids as manifold solid B-rep objects (IGES 5.3 sections 4.49 and 4.143 to 4.147).

use std::collections::HashMap;

use super::super::lower::record::{Record, Value};
use super::super::{Entity, EntryNumber};
use super::{FromModelError, Rank, Writer};
use crate::brep::{BodyId, EdgeId, FaceId, LoopId, ShellId, VertexId};
use crate::geometry::{ParameterMap, Surface};

/// Form of lists, of loops, of faces and of closed shells.
const FORM: i32 = 1;
/// Kinds of a loop's members.
const EDGE: i64 = 0;
const VERTEX: i64 = 1;

/// Lists of the edges and vertices of one body, and the place of each in them.
struct Lists {
    vertex_list: EntryNumber,
    vertices: HashMap<VertexId, usize>,
    edge_list: Option<EntryNumber>,
    edges: HashMap<EdgeId, usize>,
}

impl Writer<'_, '_> {
    /// Writes a solid whose shells are closed.
    pub(super) fn solid(&mut self, body: BodyId, rank: Rank) -> Result<EntryNumber, FromModelError> {
        let lists = self.lists(body)?;
        let shells = self.model.brep.bodies[body].shells.clone();
        let mut members = Vec::with_capacity(shells.len());
        for shell in shells {
            let forward = self.model.brep.shells[shell].forward;
            members.push((self.shell(shell, &lists)?, forward));
        }
        let voids = members.len().saturating_sub(1);
        let mut record = Record::new(Entity::ManifoldSolid.number(), 0);
        for (at, (shell, forward)) in members.into_iter().enumerate() {
            record = record.pointer(shell).values([Value::flag(forward)]);
            if at == 0 {
                record = record.values([Value::count(voids)]);
            }
        }
        let (entry, behind) = self.look_of_body(body)?;
        self.add_as(&record, &entry, rank, &behind)
    }

    fn lists(&mut self, body: BodyId) -> Result<Lists, FromModelError> {
        let brep = &self.model.brep;
        let (mut vertices, mut edges) = (Vec::new(), Vec::new());
        for face in brep.bodies[body].shells.iter().flat_map(|&shell| &brep.shells[shell].faces) {
            edges.extend(brep.coedges_of(*face).map(|coedge| brep.coedges[coedge].edge));
            vertices.extend(brep.faces[*face].loops.iter().filter_map(|&bound| brep.loops[bound].vertex));
        }
        edges.sort_unstable();
        edges.dedup();
        vertices.extend(edges.iter().flat_map(|&edge| [brep.edges[edge].start, brep.edges[edge].end]));
        vertices.sort_unstable();
        vertices.dedup();
        let points = vertices.iter().map(|&vertex| brep.vertices[vertex].point);
        let record = Record::new(Entity::VertexList.number(), FORM).values([Value::count(vertices.len())]);
        let vertex_list = self.add(&record.reals(points.flat_map(|p| [p.x, p.y, p.z])), Rank::Part)?;
        let vertices: HashMap<VertexId, usize> =
            vertices.into_iter().enumerate().map(|(at, vertex)| (vertex, at + 1)).collect();
        let mut values = vec![Value::count(edges.len())];
        for &edge in &edges {
            let piece = self.piece(edge)?;
            let curve = self.curve(&piece, self.model.origins.edges[edge])?;
            let of = &self.model.brep.edges[edge];
            // Edges of the format run as their curves do.
            let (start, end) = if of.same_sense { (of.start, of.end) } else { (of.end, of.start) };
            values.push(Value::to(curve));
            for vertex in [start, end] {
                values.extend([Value::to(vertex_list), Value::count(vertices[&vertex])]);
            }
        }
        let record = Record::new(Entity::EdgeList.number(), FORM).values(values);
        let edge_list = if edges.is_empty() { None } else { Some(self.add(&record, Rank::Part)?) };
        let edges = edges.into_iter().enumerate().map(|(at, edge)| (edge, at + 1)).collect();
        Ok(Lists { vertex_list, vertices, edge_list, edges })
    }

    fn shell(&mut self, shell: ShellId, lists: &Lists) -> Result<EntryNumber, FromModelError> {
        let faces = self.model.brep.shells[shell].faces.clone();
        let mut values = vec![Value::count(faces.len())];
        for face in faces {
            let (number, sense) = self.face(face, lists)?;
            values.extend([Value::to(number), Value::flag(sense)]);
        }
        self.add(&Record::new(Entity::Shell.number(), FORM).values(values), Rank::Part)
    }

    /// A face, and whether its normal in the shell is that of its surface by the file's parameters.
    fn face(&mut self, face: FaceId, lists: &Lists) -> Result<(EntryNumber, bool), FromModelError> {
        let of = &self.model.brep.faces[face];
        let (surface, map) = match self.surfaces.get(&of.surface) {
            Some(&known) => known,
            None => {
                let origin = self.model.origins.faces[face];
                let read = self.model.brep.surface_of(face).read();
                let written = self.surface_of(face, read.ok_or(FromModelError::Unread { origin })?)?;
                if is_shared_safely(read) {
                    self.surfaces.insert(of.surface, written);
                }
                written
            }
        };
        let sense = of.same_sense != (map.linear.determinant() < 0.0);
        let mut loops = Vec::with_capacity(of.loops.len());
        let mut outer = false;
        for &bound in &of.loops {
            let number = self.bound(bound, sense, &map, lists)?;
            let first = self.model.brep.loops[bound].outer && !outer;
            outer |= first;
            loops.insert(if first { 0 } else { loops.len() }, Value::to(number));
        }
        let record = Record::new(Entity::Face.number(), FORM).pointer(surface);
        let record = record.values([Value::count(loops.len()), Value::flag(outer)]).values(loops);
        let (entry, behind) = self.look_of_face(face)?;
        Ok((self.add_as(&record, &entry, Rank::Part, &behind)?, sense))
    }

    /// A loop, run with the face to its left as seen against the normal of the surface in the file.
    fn bound(
        &mut self,
        bound: LoopId,
        sense: bool,
        map: &ParameterMap,
        lists: &Lists,
    ) -> Result<EntryNumber, FromModelError> {
        let brep = &self.model.brep;
        let of = &brep.loops[bound];
        let mut values = Vec::new();
        let pole = of.vertex.filter(|_| of.coedges.is_empty());
        if let Some(vertex) = pole {
            let place = [Value::to(lists.vertex_list), Value::count(lists.vertices[&vertex])];
            values.extend([Value::count(1), Value::Integer(VERTEX)]);
            values.extend(place);
            values.extend([Value::flag(true), Value::Integer(0)]);
        } else if let Some(list) = lists.edge_list {
            let along = of.forward == sense;
            let mut coedges = of.coedges.clone();
            if !along {
                coedges.reverse();
            }
            values.push(Value::count(coedges.len()));
            for coedge in coedges {
                let edge = self.model.brep.coedges[coedge].edge;
                let runs = self.model.brep.coedges[coedge].forward == self.model.brep.edges[edge].same_sense;
                let piece = self.piece(edge)?;
                let pcurve = self.pcurve(coedge, &piece, map)?;
                let place = Value::count(lists.edges[&edge]);
                values.extend([Value::Integer(EDGE), Value::to(list), place, Value::flag(runs == along)]);
                values.push(Value::Integer(i64::from(pcurve.is_some())));
                values.extend(pcurve.into_iter().flat_map(|pcurve| [Value::Integer(0), Value::to(pcurve)]));
            }
        }
        self.add(&Record::new(Entity::Loop.number(), FORM).values(values), Rank::Part)
    }
}

/// Whether a surface is the same entity for every face: one that has ends has those of its face, and one that closes has
/// its seam away from its face.
fn is_shared_safely(surface: Option<&Surface>) -> bool {
    matches!(surface, Some(Surface::Plane(_) | Surface::Nurbs(_)))
}
