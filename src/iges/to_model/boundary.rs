//! Boundaries of loose faces (IGES 5.3 sections 4.31 and 4.32): their curves in space, in order, each with its
//! counterpart in the parameter plane.

use super::builder::Builder;
use super::code::ModelCode;
use super::curve::{self, Piece, in_entity};
use super::curve2d::Piece2d;
use super::error::ReadError;
use super::image;
use super::scope::{Scope, kind};
use super::surface::SurfaceRead;
use crate::iges::{Entity, EntryNumber, Fields};
use crate::math::{Affine, Point3};

/// One curve of a boundary.
#[derive(Debug, Clone)]
pub(super) struct Bit {
    /// Entity of the curve in space; that of the parameter-space curve where the file has no other.
    pub(super) number: EntryNumber,
    pub(super) piece: Piece,
    /// Whether the boundary runs as the curve does.
    pub(super) forward: bool,
    /// The counterpart in the file's parameters.
    pub(super) flat: Option<(EntryNumber, Piece2d)>,
}

impl Bit {
    /// Where the boundary comes to this curve.
    pub(super) fn start(&self) -> Point3<f64> {
        if self.forward { self.piece.start() } else { self.piece.end() }
    }

    /// Where it leaves it.
    pub(super) fn end(&self) -> Point3<f64> {
        if self.forward { self.piece.end() } else { self.piece.start() }
    }
}

/// The surface of the face that is bounded, and the space that it is in.
pub(super) struct Ground<'g> {
    pub(super) within: &'g Affine,
    pub(super) surface: Option<&'g SurfaceRead>,
}

impl Builder<'_, '_> {
    /// The curves of a boundary entity, head to tail.
    pub(super) fn boundary(&mut self, number: EntryNumber, on: &Ground<'_>) -> Result<Vec<Bit>, ReadError> {
        let instance = self.scope.instance(number)?;
        let within = self.scope.placed(instance, on.within)?;
        let ground = Ground { within: &within, surface: on.surface };
        let mut bits = match kind(instance) {
            Some(Entity::CurveOnSurface) => self.curve_on_surface(number, &ground)?,
            Some(Entity::Boundary) => self.boundary_curves(number, &ground)?,
            // A plane is bounded by a curve alone.
            Some(entity) if entity.is_curve() => in_space(&self.scope, number, &within)?,
            _ => {
                let found = self.scope.name(number);
                return Err(ReadError::WrongEntity { number, found, expected: "a boundary" });
            }
        };
        if chained(&mut bits) {
            let message =
                "pieces of the boundary do not run head to tail; they are taken the other way round";
            self.report(ModelCode::TurnedPiece, number, message.to_owned());
        }
        Ok(bits)
    }

    fn curve_on_surface(&mut self, number: EntryNumber, on: &Ground<'_>) -> Result<Vec<Bit>, ReadError> {
        let view = self.scope.view(number)?;
        let [flat, space] = ["pcurve", "curve"].map(|field| view.fields().optional_pointer(field));
        self.paired(number, space, &flat.into_iter().collect::<Vec<_>>(), on)
    }

    fn boundary_curves(&mut self, number: EntryNumber, on: &Ground<'_>) -> Result<Vec<Bit>, ReadError> {
        let view = self.scope.view(number)?;
        let mut bits = Vec::new();
        for curve in view.fields().group("curves")? {
            let space = curve.optional_pointer("curve");
            let mut run = self.paired(number, space, &pointers(&curve), on)?;
            if curve.integer("sense")? == REVERSED {
                run.reverse();
                run.iter_mut().for_each(|bit| bit.forward = !bit.forward);
            }
            bits.append(&mut run);
        }
        if bits.is_empty() { Err(ReadError::Empty("curves")) } else { Ok(bits) }
    }

    /// Curves in space with their counterparts; made of the counterparts where there is none in space.
    fn paired(
        &mut self,
        user: EntryNumber,
        space: Option<EntryNumber>,
        flat: &[EntryNumber],
        on: &Ground<'_>,
    ) -> Result<Vec<Bit>, ReadError> {
        let counterparts = self.in_plane(user, flat, on);
        let Some(space) = space else {
            let surface = on.surface.ok_or(ReadError::Empty("curve"))?;
            return self.images(user, counterparts, surface);
        };
        let mut bits = in_space(&self.scope, space, on.within)?;
        if let Some(surface) = on.surface.filter(|surface| !surface.parameters.is_empty()) {
            let missed = pair(&mut bits, counterparts, surface, self.scope.resolution);
            if missed > 0 {
                let message = format!("{missed} of its curves have no counterpart among those in parameters");
                self.report(ModelCode::UnpairedPcurve, user, message);
            }
        }
        Ok(bits)
    }

    /// The pieces of parameter-space curves. What cannot be read is reported and left out.
    fn in_plane(
        &mut self,
        user: EntryNumber,
        flat: &[EntryNumber],
        on: &Ground<'_>,
    ) -> Vec<(EntryNumber, Piece2d)> {
        if on.surface.is_some_and(|surface| surface.parameters.is_empty()) {
            return Vec::new();
        }
        let mut found = Vec::new();
        for &number in flat {
            let pieces = curve::pieces(&self.scope, number, &Affine::identity());
            let pieces = pieces.and_then(|pieces| {
                pieces
                    .into_iter()
                    .map(|(n, piece)| Ok((n, Piece2d::flat(&piece)?)))
                    .collect::<Result<Vec<_>, _>>()
            });
            match pieces {
                Ok(pieces) => found.extend(pieces),
                Err(error) => {
                    let at = if self.scope.file.instance(number).is_some() { number } else { user };
                    self.report(ModelCode::BadPcurve, at, format!("{}: {error}", self.scope.name(number)));
                }
            }
        }
        found
    }

    /// The images of parameter-space curves on a surface.
    fn images(
        &mut self,
        user: EntryNumber,
        flat: Vec<(EntryNumber, Piece2d)>,
        surface: &SurfaceRead,
    ) -> Result<Vec<Bit>, ReadError> {
        let map = surface.parameters.first().ok_or(ReadError::Empty("curve"))?;
        let mut bits = Vec::new();
        for (number, piece) in flat {
            let own = piece.mapped(map)?;
            let image = image::of(&surface.surface, &own, self.scope.resolution)?;
            if let Some(off) = image.off {
                let message = format!(
                    "has no counterpart in space; one is taken that lies within {off:.1e} of its image"
                );
                self.report(ModelCode::ApproximatedCurve, number, message);
            }
            bits.push(Bit { number, piece: image.piece, forward: true, flat: Some((number, piece)) });
        }
        if bits.is_empty() {
            self.report(ModelCode::BadTopology, user, "its curves cannot be read".to_owned());
            return Err(ReadError::Empty("curve"));
        }
        Ok(bits)
    }
}

/// Sense of a boundary's curve that is run against.
const REVERSED: i64 = 2;

fn pointers(curve: &Fields<'_>) -> Vec<EntryNumber> {
    curve.list("pcurves").filter_map(|pcurve| pcurve.as_pointer()).collect()
}

fn in_space(scope: &Scope<'_>, number: EntryNumber, within: &Affine) -> Result<Vec<Bit>, ReadError> {
    let pieces = curve::pieces(scope, number, within).map_err(|e| in_entity(scope, "curve", number, e))?;
    let bit = |(number, piece): (EntryNumber, Piece)| {
        let bounded = piece.range.0.is_finite() && piece.range.1.is_finite();
        bounded.then_some(Bit { number, piece, forward: true, flat: None }).ok_or(ReadError::NoExtent)
    };
    pieces.into_iter().map(bit).collect()
}

/// Gives each curve in space its counterpart; how many have none, though there are counterparts.
fn pair(
    bits: &mut [Bit],
    flat: Vec<(EntryNumber, Piece2d)>,
    surface: &SurfaceRead,
    resolution: f64,
) -> usize {
    if flat.is_empty() {
        return 0;
    }
    if flat.len() == bits.len() {
        for (bit, own) in bits.iter_mut().zip(flat) {
            bit.flat = Some(own);
        }
        return 0;
    }
    // Other counts: each takes the one that lies on it, from where the last was found.
    let mut next = 0;
    let mut missed = 0;
    for bit in bits.iter_mut() {
        let order = (0..flat.len()).map(|step| (next + step) % flat.len());
        let found = order
            .into_iter()
            .find(|at| super::pcurve::fit(surface, &flat[*at].1, &bit.piece, resolution).is_some());
        match found {
            Some(at) => {
                bit.flat = Some(flat[at].clone());
                next = at + 1;
            }
            None => missed += 1,
        }
    }
    missed
}

/// Turns pieces that are written the wrong way round; whether any was.
fn chained(bits: &mut [Bit]) -> bool {
    if bits.len() < 2 {
        return false;
    }
    let as_they_are = gaps(bits, bits[0].forward, false);
    let size: f64 = bits.iter().map(|bit| (bit.start() - bit.end()).norm()).sum();
    if as_they_are.0 <= LOOSE * size {
        return false;
    }
    let turned = [bits[0].forward, !bits[0].forward].map(|first| gaps(bits, first, true));
    let best = if turned[0].0 <= turned[1].0 { &turned[0] } else { &turned[1] };
    // Only what then really meets was written the wrong way round.
    if best.0 > 0.1 * as_they_are.0 {
        return false;
    }
    for (bit, &forward) in bits.iter_mut().zip(&best.1) {
        bit.forward = forward;
    }
    true
}

/// Part of its length by which a boundary may be open and still be meant to run so.
const LOOSE: f64 = 1e-3;

/// Sum of the gaps of a closed walk and the directions of its pieces: as they are, or each to where it is nearer.
fn gaps(bits: &[Bit], first: bool, free: bool) -> (f64, Vec<bool>) {
    let ends = |bit: &Bit, forward: bool| {
        let (a, b) = (bit.piece.start(), bit.piece.end());
        if forward { (a, b) } else { (b, a) }
    };
    let (begin, mut at) = ends(&bits[0], first);
    let (mut sum, mut directions) = (0.0, vec![first]);
    for bit in &bits[1..] {
        let [with, against] = [bit.forward, !bit.forward].map(|forward| (ends(bit, forward).0 - at).norm());
        let forward = if free && against < with { !bit.forward } else { bit.forward };
        let (start, end) = ends(bit, forward);
        sum += (start - at).norm();
        at = end;
        directions.push(forward);
    }
    (sum + (begin - at).norm(), directions)
}
