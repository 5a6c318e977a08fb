//! Mass properties of faces, shells and bodies: area, volume, centroids, inertia, with an error bound.
//!
//! Each is an integral over the parameter region that the loops of a face cut out. Green's theorem makes it one
//! along the loops, of integrals along one parameter ("columns"), so that nothing needs to be triangulated:
//! Gauss rules between knots along the column, an adaptive Gauss-Kronrod rule along the edges between knots of
//! edge and surface. Edges are taken from their curves in space, projected; pcurves only guide the projection.
//! Volume and its moments follow from the divergence theorem.
//!
//! Repairs nothing. Densities are one; the numbers are in file units.

mod adaptive;
mod cells;
mod column;
mod moments;
mod path;
#[cfg(test)]
mod tests;

use super::{
    BodyId, Brep, EdgeId, FaceId, LoopPoint, LoopSampling, ParameterLoop, ParameterLoopError, ShellId,
    parameter_loops,
};
use crate::geometry::Surface;
use crate::math::{BoundingBox, Point3};
use adaptive::{Accuracy, integrate};
use cells::{Cells, Extent};
use column::{Along, Column, between, breaks};
pub use moments::MassProperties;
use moments::Sums;
use path::{Foot, Path, Pick, Place, paths};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Why something has no mass properties.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MassPropertiesError {
    /// The loops of a face are not known in its parameter plane.
    #[error("{source}")]
    Loops {
        /// The face.
        face: FaceId,
        /// Why.
        source: ParameterLoopError,
    },
    /// The loops of a face leave a side open on which its surface never ends.
    #[error("the bounds of a face leave a side open where its surface has no end")]
    Endless {
        /// The face.
        face: FaceId,
    },
    /// The loops of a face run round its surface in both directions.
    #[error("the bounds of a face run round its surface both ways")]
    BothWays {
        /// The face.
        face: FaceId,
    },
}

/// How exactly to measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadrature {
    /// The file's uncertainty, in file units: what the loops are found by.
    pub tolerance: f64,
    /// Error of one interval of an edge, relative to the area or volume that its face could have at most.
    pub target: f64,
    /// Pieces between knots that a column, or an edge, is cut into at most: beyond, knots are passed over.
    pub pieces: usize,
    /// Points of one piece of a column at most.
    pub points: usize,
    /// Where an edge is between the points of its loop.
    pub between: Between,
}

/// Where an edge is in the parameter plane between the points of its loop, whose places are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    /// Where the points of its curve are projected to.
    Feet,
    /// On cubics through the places: no projection, and off by some millionths of a quarter of a turn.
    Cubics,
}

impl Quadrature {
    /// Four orders below what a comparison with another program tells.
    const EXACT: f64 = 1e-11;

    /// As exactly as makes sense, for a file of the given uncertainty.
    #[must_use]
    pub fn exact(tolerance: f64) -> Self {
        Self { target: Self::EXACT, ..Self::good(tolerance) }
    }

    /// Good to a millionth or better, where surfaces are smooth between their knots.
    #[must_use]
    pub fn good(tolerance: f64) -> Self {
        let (pieces, points) = (usize::MAX, usize::MAX);
        Self { tolerance, target: 1e-8, pieces, points, between: Between::Feet }
    }

    /// Good to some hundred-thousandths, without a projection.
    #[must_use]
    pub fn plain(tolerance: f64) -> Self {
        Self { target: 1e-5, between: Between::Cubics, ..Self::good(tolerance) }
    }

    /// Good to some parts in a hundred, at a small part of the cost.
    #[must_use]
    pub fn rough(tolerance: f64) -> Self {
        Self { target: 1e-3, pieces: 6, ..Self::good(tolerance) }
    }

    /// As rough as may be to tell the sign of a volume, without a projection.
    #[must_use]
    pub fn of_sign(tolerance: f64) -> Self {
        Self { points: 4, between: Between::Cubics, ..Self::rough(tolerance) }
    }
}

/// Samples of a surface's domain along each parameter, where no loop tells its size.
const SAMPLES: usize = 4;
/// Part of the width of a face, across the columns, by which a piece of its boundary may be found to move less or more
/// than from its start to its end: what any rule is off by.
const MISSED: f64 = 1e-6;
/// Speed of a parameter line against that at the other end of a piece below which the piece ends beside a pole.
const BESIDE_POLE: f64 = 1e-2;
/// Part of a parameter's range that a straight piece must span to lie at a pole.
const AT_POLE: f64 = 1e-6;

/// Mass properties of a body, or why it has none. About the middle of its vertices.
///
/// # Errors
/// See [`MassPropertiesError`].
pub fn of_body(
    brep: &Brep,
    body: BodyId,
    quadrature: &Quadrature,
) -> Result<MassProperties, MassPropertiesError> {
    let reference = middle(brep, body);
    let mut sum = MassProperties::none(reference);
    for &shell in &brep.bodies[body].shells {
        sum += of_shell(brep, shell, quadrature, reference)?;
    }
    Ok(sum)
}

/// Mass properties of a shell about a point; those of an oriented shell that turns its faces turn too.
///
/// # Errors
/// See [`MassPropertiesError`].
pub fn of_shell(
    brep: &Brep,
    shell: ShellId,
    quadrature: &Quadrature,
    reference: Point3<f64>,
) -> Result<MassProperties, MassPropertiesError> {
    let sampling = LoopSampling::of_tolerance(quadrature.tolerance);
    let loops = |face| parameter_loops(brep, face, &sampling).map(Cow::Owned);
    of_shell_with(brep, shell, quadrature, reference, &loops)
}

/// Loops of a face in its parameter plane, or why there are none.
pub type LoopsOf<'f, 'l> = dyn Fn(FaceId) -> Result<Cow<'l, [ParameterLoop]>, ParameterLoopError> + 'f;

/// As [`of_shell`], with the loops given.
///
/// # Errors
/// See [`MassPropertiesError`].
pub fn of_shell_with(
    brep: &Brep,
    shell: ShellId,
    quadrature: &Quadrature,
    reference: Point3<f64>,
    loops: &LoopsOf<'_, '_>,
) -> Result<MassProperties, MassPropertiesError> {
    let mut sum = MassProperties::none(reference);
    let uses = uses(brep, shell);
    for &face in &brep.shells[shell].faces {
        let loops = loops(face).map_err(|source| MassPropertiesError::Loops { face, source })?;
        let side = side(brep, face, &uses);
        sum += within(brep, face, &loops, quadrature, reference, side)?;
    }
    Ok(if brep.shells[shell].forward { sum } else { sum.reversed() })
}

/// Mass properties of a face about a point.
///
/// A face whose bounds run the wrong way round on a surface that is not closed counts as what they enclose.
///
/// # Errors
/// See [`MassPropertiesError`].
pub fn of_face(
    brep: &Brep,
    face: FaceId,
    quadrature: &Quadrature,
    reference: Point3<f64>,
) -> Result<MassProperties, MassPropertiesError> {
    let loops = parameter_loops(brep, face, &LoopSampling::of_tolerance(quadrature.tolerance))
        .map_err(|source| MassPropertiesError::Loops { face, source })?;
    of_loops(brep, face, &loops, quadrature, reference)
}

/// As [`of_face`], with the loops given.
///
/// # Errors
/// See [`MassPropertiesError`].
pub fn of_loops(
    brep: &Brep,
    face: FaceId,
    loops: &[ParameterLoop],
    quadrature: &Quadrature,
    reference: Point3<f64>,
) -> Result<MassProperties, MassPropertiesError> {
    within(brep, face, loops, quadrature, reference, Side::OfSense)
}

/// Which of the two says where the outside of a face is, when its bounds run the wrong way round for its sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// The sense: the bounds are turned.
    OfSense,
    /// The bounds, which run as its neighbours' do: the sense is wrong.
    OfBounds,
}

/// Directions in which the faces of a shell use each edge: as it runs, and against.
fn uses(brep: &Brep, shell: ShellId) -> BTreeMap<EdgeId, [usize; 2]> {
    let mut uses: BTreeMap<EdgeId, [usize; 2]> = BTreeMap::new();
    for coedge in brep.shells[shell].faces.iter().flat_map(|&face| brep.coedges_of(face)) {
        let of = &brep.coedges[coedge];
        uses.entry(of.edge).or_default()[usize::from(of.forward == brep.loops[of.in_loop].forward)] += 1;
    }
    uses
}

/// Whether every edge of a face has a neighbour, another face, that runs against it.
fn side(brep: &Brep, face: FaceId, uses: &BTreeMap<EdgeId, [usize; 2]>) -> Side {
    let mut edges = brep.coedges_of(face).map(|coedge| brep.coedges[coedge].edge).peekable();
    let outer = edges.peek().is_some() && !brep.bounds_are_seams(face);
    let paired = outer && edges.all(|edge| uses.get(&edge) == Some(&[1, 1]));
    if paired { Side::OfBounds } else { Side::OfSense }
}

fn within(
    brep: &Brep,
    face: FaceId,
    loops: &[ParameterLoop],
    quadrature: &Quadrature,
    reference: Point3<f64>,
    side: Side,
) -> Result<MassProperties, MassPropertiesError> {
    let Some(surface) = brep.surface_of(face).read() else {
        let source = ParameterLoopError::UnreadSurface { entity: String::new() };
        return Err(MassPropertiesError::Loops { face, source });
    };
    let sign = if brep.faces[face].same_sense { 1.0 } else { -1.0 };
    let region = Region::new(surface, face, loops, quadrature, reference)?;
    let bounded = loops.iter().any(|l| !l.points.is_empty());
    let (mut sums, mut errors) = (Sums::ZERO, Sums::ZERO);
    if bounded {
        let foot = Foot::new(surface);
        let boundary: Vec<Path<'_>> = loops.iter().flat_map(|l| paths(brep, &foot, l, quadrature)).collect();
        let base = region.base(loops, &boundary, sign)?;
        (sums, errors) = region.around(&foot, &boundary, base);
        // The paths run with the face to their left against the face's normal.
        sums = sums.turned(sign, 1.0);
    }
    let outside = || sums.0[0] < -errors.0[0] && is_closed(surface) && !brep.bounds_are_seams(face);
    if !bounded || outside() {
        let (whole, error) = region.whole()?;
        sums += whole.turned(1.0, sign);
        errors += error;
    } else if sums.0[0] < 0.0 {
        sums = sums.turned(-1.0, if side == Side::OfBounds { 1.0 } else { -1.0 });
    }
    let gap = loops.iter().map(|l| l.gap).fold(0.0, f64::max);
    Ok(MassProperties { reference, sums, errors, gap })
}

/// The middle of the vertices of a body: moments about it lose least.
#[must_use]
pub fn middle(brep: &Brep, body: BodyId) -> Point3<f64> {
    let faces = brep.bodies[body].shells.iter().flat_map(|&shell| &brep.shells[shell].faces);
    let loops = faces.flat_map(|&face| &brep.faces[face].loops);
    let mut points = loops.flat_map(|&bound| {
        let bound = &brep.loops[bound];
        let of_coedges = bound.coedges.iter().map(|&c| brep.edges[brep.coedges[c].edge].start);
        of_coedges.chain(bound.vertex).map(|vertex| brep.vertices[vertex].point)
    });
    let Some(first) = points.next() else { return Point3::origin() };
    let (low, high) = points.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
    low + (high - low) * 0.5
}

/// Whether a surface has no border, so that a loop has a face on either side.
fn is_closed(surface: &Surface) -> bool {
    let ends = |along: Along| {
        let ((u0, u1), (v0, v1)) = surface.domain();
        [0.0, 1.0].iter().all(|end| {
            shrinks(
                surface,
                along,
                if along == Along::V { v0 + (v1 - v0) * end } else { u0 + (u1 - u0) * end },
            )
        })
    };
    match (surface, surface.periods()) {
        (Surface::Sphere { .. } | Surface::Torus { .. }, _) | (_, (Some(_), Some(_))) => true,
        (_, (Some(_), None)) => ends(Along::V),
        (_, (None, Some(_))) => ends(Along::U),
        _ => false,
    }
}

/// Whether the line where the parameter along a column has a value is a single point.
fn shrinks(surface: &Surface, along: Along, at: f64) -> bool {
    let ((u0, u1), (v0, v1)) = surface.domain();
    let points = |x: f64| -> Vec<Point3<f64>> {
        (0..=SAMPLES)
            .map(|i| {
                let part = i as f64 / SAMPLES as f64;
                if along == Along::V {
                    surface.point(u0 + (u1 - u0) * part, x)
                } else {
                    surface.point(x, v0 + (v1 - v0) * part)
                }
            })
            .collect()
    };
    if !at.is_finite() {
        return false;
    }
    let (line, (low, high)) = (points(at), if along == Along::V { (v0, v1) } else { (u0, u1) });
    let middle = if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { at + 1.0 };
    let size = |points: &[Point3<f64>]| points.iter().map(|p| (p - points[0]).norm()).fold(0.0, f64::max);
    size(&line) <= POLE * size(&points(middle)).max(f64::MIN_POSITIVE)
}

/// Length of a parameter line, relative to that in the middle, at which it counts as a pole.
const POLE: f64 = 1e-6;

/// What is integrated over: a surface, the direction of its columns, and how exactly.
struct Region<'a> {
    surface: &'a Surface,
    face: FaceId,
    column: Column<'a>,
    accuracy: Accuracy,
    pieces: usize,
    /// Extent of the loops across the columns.
    width: f64,
}

impl<'a> Region<'a> {
    fn new(
        surface: &'a Surface,
        face: FaceId,
        loops: &[ParameterLoop],
        quadrature: &Quadrature,
        reference: Point3<f64>,
    ) -> Result<Self, MassPropertiesError> {
        let round = |value: fn(&ParameterLoop) -> f64| loops.iter().any(|l| value(l) != 0.0);
        let along = match (round(|l| l.winding.0), round(|l| l.winding.1)) {
            (true, true) => return Err(MassPropertiesError::BothWays { face }),
            (false, true) => Along::U,
            _ => Along::V,
        };
        let (size, reach) = size_and_reach(surface, loops, &reference);
        let accuracy = Accuracy { size, reach: reach.max(size), target: quadrature.target };
        let mut column = Column::new(surface, along, reference, quadrature);
        let (u, v) = ranges(surface, loops);
        let (across, along) = if along == Along::V { (u, v) } else { (v, u) };
        // A rough measure skips knots: finer pieces are not what it lacks.
        if quadrature.pieces == usize::MAX
            && [across.0, across.1, along.0, along.1].iter().all(|x| x.is_finite())
        {
            column.cut_finely(across, along, &accuracy);
        }
        let width = across.1 - across.0;
        Ok(Self { surface, face, column, accuracy, pieces: quadrature.pieces, width })
    }

    /// Where the columns begin: at a pole where there is one, at the side that the loops leave open, else in the
    /// middle.
    fn base(
        &self,
        loops: &[ParameterLoop],
        boundary: &[Path<'_>],
        sign: f64,
    ) -> Result<f64, MassPropertiesError> {
        let v_columns = self.column.along == Along::V;
        let round: f64 = loops.iter().map(|l| if v_columns { l.winding.0 } else { l.winding.1 }).sum();
        let period = self.surface.periods();
        let period = if v_columns { period.0 } else { period.1 }.unwrap_or(f64::INFINITY);
        if round.abs() > 0.5 * period {
            // Left of a path along u is up, left of one along v is back.
            return self.open_side(if v_columns { round * sign > 0.0 } else { round * sign < 0.0 });
        }
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in loops.iter().flat_map(|l| &l.points) {
            let (along, across) = if v_columns { (point.v, point.u) } else { (point.u, point.v) };
            (low, high) = (low.min(along), high.max(along));
            (least, most) = (least.min(across), most.max(across));
        }
        let pole = boundary.iter().find_map(|path| match path {
            Path::Straight(a, b) => {
                let ((x, y), (z, w)) = if v_columns { (*a, *b) } else { ((a.1, a.0), (b.1, b.0)) };
                ((z - x).abs() > AT_POLE * (most - least) && (w - y).abs() <= AT_POLE * (high - low))
                    .then_some(y)
            }
            Path::Edge(_) => None,
        });
        Ok(pole.unwrap_or(0.5 * (low + high)))
    }

    fn open_side(&self, upper: bool) -> Result<f64, MassPropertiesError> {
        if let Some(apex) = self.surface.apex() {
            return Ok(apex);
        }
        let (us, vs) = self.surface.domain();
        let (low, high) = if self.column.along == Along::V { vs } else { us };
        let side = if upper { high } else { low };
        if shrinks(self.surface, self.column.along, side) {
            Ok(side)
        } else {
            Err(MassPropertiesError::Endless { face: self.face })
        }
    }

    /// The integral over what the paths leave to their left in the parameter plane, and its error.
    fn around(&self, foot: &Foot<'_>, boundary: &[Path<'_>], base: f64) -> (Sums, Sums) {
        let (mut sum, mut errors) = (Sums::ZERO, Sums::ZERO);
        // Lines of analytic surfaces are no breaks, and their columns cost little.
        let mut cells = if is_analytic(self.surface) {
            None
        } else {
            self.extent(boundary).map(|e| self.cells(&e, base))
        };
        for path in boundary {
            let (part, error) = self.along(foot, path, base, cells.as_mut());
            sum += part;
            errors += error;
        }
        if let Some(cells) = cells {
            let (inner, error) = cells.integral(&self.column, &self.accuracy);
            sum += inner * if self.column.along == Along::V { -1.0 } else { 1.0 };
            errors += error;
        }
        (sum, errors)
    }

    fn cells(&self, extent: &Extent, base: f64) -> Cells {
        let across = self.column.along.other();
        let periods = self.surface.periods();
        let period = if across == Along::U { periods.0 } else { periods.1 };
        Cells::new(
            (&self.column.breaks, self.column.period),
            (&breaks(self.surface, across), period),
            extent,
            base,
            self.pieces,
        )
    }

    /// How far the known places of a boundary reach.
    fn extent(&self, boundary: &[Path<'_>]) -> Option<Extent> {
        let none = (f64::INFINITY, f64::NEG_INFINITY);
        let mut extent = Extent { along: none, across: none };
        let grow = |range: &mut (f64, f64), x: f64| *range = (range.0.min(x), range.1.max(x));
        for place in boundary.iter().flat_map(Path::places) {
            let (across, along) = self.turned(place);
            grow(&mut extent.along, along);
            grow(&mut extent.across, across);
        }
        extent.along.0.is_finite().then_some(extent)
    }

    /// A place as (across, along) columns.
    fn turned(&self, (u, v): Place) -> Place {
        if self.column.along == Along::V { (u, v) } else { (v, u) }
    }

    /// The part of one path: all of it without cells, and with cells what lies above those that it books.
    fn along(
        &self,
        foot: &Foot<'_>,
        path: &Path<'_>,
        base: f64,
        mut cells: Option<&mut Cells>,
    ) -> (Sums, Sums) {
        let v_columns = self.column.along == Along::V;
        let stops = self.stops(foot, path, cells.as_deref());
        let place_at = |t: f64| match path {
            Path::Edge(edge) => edge.place_and_speed(foot, t),
            Path::Straight(a, b) => {
                let way = (b.0 - a.0, b.1 - a.1);
                ((a.0 + way.0 * t, a.1 + way.1 * t), way)
            }
        };
        let (mut sum, mut errors) = (Sums::ZERO, Sums::ZERO);
        // What one stop ends at is what the next begins at, to the bit: pieces cancel.
        let ends: Vec<Place> =
            stops.iter().map(|&t| self.turned(self.stop(path, t, place_at(t).0))).collect();
        for (pair, ends) in stops.windows(2).zip(ends.windows(2)) {
            let (place, speed) = place_at(0.5 * (pair[0] + pair[1]));
            let (middle, speed) = (self.turned(place), self.turned(speed));
            let from = cells.as_mut().map_or(base, |cells| cells.book(middle, ends[0].0, ends[1].0));
            // Green: the double integral is that of a column up times -du, or of one to the right times dv.
            let term = |t: f64| {
                let (place, speed) = place_at(t);
                let ((at, to), (factor, _)) = (self.turned(place), self.turned(speed));
                let sums = if factor == 0.0 {
                    Sums::ZERO
                } else {
                    self.column.integral(at, from, to) * if v_columns { -factor } else { factor }
                };
                (sums, factor)
            };
            let found = integrate(&term, pair[0], pair[1], &self.accuracy);
            sum += found.sum;
            errors += found.errors;
            let missed = ends[1].0 - ends[0].0 - found.advance;
            if missed.abs() > self.accuracy.target.max(MISSED) * self.width {
                let (part, error) = self.turn_missed([ends[0], ends[1]], from);
                sum += part * if v_columns { -missed } else { missed };
                errors += error * missed.abs();
            }
            if speed.0 != 0.0 {
                let width = (speed.0 * (pair[1] - pair[0])).abs();
                errors += self.column.error(middle.0, from, middle.1) * width;
            }
        }
        (sum, errors)
    }

    /// The place of a stop: at a pole, where no foot tells it, the one that the loop knows.
    fn stop(&self, path: &Path<'_>, t: f64, foot: Place) -> Place {
        match path {
            Path::Edge(edge) if self.apart(foot) * self.width <= POLE * self.accuracy.size => edge.guess(t),
            _ => foot,
        }
    }

    /// How far columns stand apart at a place, for each unit of the parameter across.
    fn apart(&self, (u, v): Place) -> f64 {
        let (u, v) = self.surface.wrapped(u, v);
        let d = self.surface.derivatives(u, v);
        if self.column.along == Along::V { d.du.norm() } else { d.dv.norm() }
    }

    /// The column of a turn that a path takes too quickly for any rule, and how far it may be from that: such turns are
    /// beside poles, at that end of the path where the columns stand closest.
    fn turn_missed(&self, ends: [Place; 2], from: f64) -> (Sums, Sums) {
        let apart = ends.map(|end| self.apart(self.turned(end)));
        let columns = ends.map(|(across, along)| self.column.integral(across, from, along));
        let (near, far) = if apart[0] <= apart[1] { (0, 1) } else { (1, 0) };
        let is_pole = apart[near] <= BESIDE_POLE * apart[far];
        let error = if is_pole { Sums::ZERO } else { (columns[far] + columns[near] * -1.0).abs() };
        (columns[near], error)
    }

    /// Values of a path's parameter between which nothing changes its form.
    fn stops(&self, foot: &Foot<'_>, path: &Path<'_>, cells: Option<&Cells>) -> Vec<f64> {
        let periods = self.surface.periods();
        let period = if self.column.along == Along::V { periods.0 } else { periods.1 };
        let strips = |low: f64, high: f64| match (cells, path) {
            (Some(cells), _) => cells.strips_between(low, high),
            (None, Path::Straight(..)) => {
                between(&breaks(self.surface, self.column.along.other()), period, low, high)
            }
            (None, Path::Edge(_)) => Vec::new(),
        };
        let rows = |low: f64, high: f64| cells.map(|cells| cells.rows_between(low, high)).unwrap_or_default();
        let (u, v): (Pick, Pick) = (|place| place.0, |place| place.1);
        let (first, second) = if self.column.along == Along::V { (u, v) } else { (v, u) };
        let stops = match path {
            Path::Edge(edge) => edge.breaks(foot, &[(first, &strips), (second, &rows)]),
            Path::Straight(a, b) => {
                let mut all = vec![0.0, 1.0];
                let (x, y) = (first(*a), first(*b));
                all.extend(strips(x.min(y), x.max(y)).iter().map(|line| (line - x) / (y - x)));
                let (x, y) = (second(*a), second(*b));
                all.extend(rows(x.min(y), x.max(y)).iter().map(|line| (line - x) / (y - x)));
                // A path along a line meets all of it or nothing.
                all.retain(|part| (0.0..=1.0).contains(part));
                all.sort_by(f64::total_cmp);
                all.dedup();
                all
            }
        };
        // A piece over several cells is booked in that of its middle: less exact, and no less right.
        thinned(&stops, self.pieces)
    }

    /// The integral over the whole domain.
    fn whole(&self) -> Result<(Sums, Sums), MassPropertiesError> {
        let ((u0, u1), (v0, v1)) = self.surface.domain();
        if ![u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
            return Err(MassPropertiesError::Endless { face: self.face });
        }
        let foot = Foot::new(self.surface);
        let (path, base) = if self.column.along == Along::V {
            (Path::Straight((u1, v1), (u0, v1)), v0)
        } else {
            (Path::Straight((u1, v0), (u1, v1)), u0)
        };
        Ok(self.around(&foot, &[path], base))
    }
}

/// Diagonal of the box of some loops, and their greatest distance from a point; of a few points of the surface where
/// there are no loops.
fn size_and_reach(surface: &Surface, loops: &[ParameterLoop], from: &Point3<f64>) -> (f64, f64) {
    let mut points: Vec<Point3<f64>> = loops.iter().flat_map(|l| &l.points).map(|p| p.point).collect();
    let ((u0, u1), (v0, v1)) = surface.domain();
    if points.is_empty() && [u0, u1, v0, v1].iter().all(|x| x.is_finite()) {
        let part = |k: usize| k as f64 / SAMPLES as f64;
        let at = |i: usize, j: usize| surface.point(u0 + (u1 - u0) * part(i), v0 + (v1 - v0) * part(j));
        points =
            (0..=SAMPLES).flat_map(|i| (0..=SAMPLES).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
    }
    let reach = points.iter().map(|point| (point - from).norm()).fold(0.0, f64::max);
    (BoundingBox::of(&points).diagonal(), reach)
}

/// Least and greatest parameters of some loops; of the surface where there are none.
fn ranges(surface: &Surface, loops: &[ParameterLoop]) -> ((f64, f64), (f64, f64)) {
    let range = |value: fn(&LoopPoint) -> f64, domain: (f64, f64)| {
        let values = || loops.iter().flat_map(|l| &l.points).map(value);
        let low = values().fold(f64::INFINITY, f64::min);
        if low.is_finite() { (low, values().fold(f64::NEG_INFINITY, f64::max)) } else { domain }
    };
    let (us, vs) = surface.domain();
    (range(|p| p.u, us), range(|p| p.v, vs))
}

/// At most so many intervals between some ascending or descending values, the first and last kept.
fn thinned(values: &[f64], pieces: usize) -> Vec<f64> {
    let count = values.len().saturating_sub(1);
    if count <= pieces {
        return values.to_vec();
    }
    (0..=pieces).map(|i| values[i * count / pieces]).collect()
}

fn is_analytic(surface: &Surface) -> bool {
    matches!(
        surface,
        Surface::Plane(_)
            | Surface::Cylinder { .. }
            | Surface::Cone { .. }
            | Surface::Sphere { .. }
            | Surface::Torus { .. }
    )
}
