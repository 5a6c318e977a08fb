//! The numeric core: surfaces and loops in, surfaces and motions out. Knows no topology and no files.
//!
//! Several faces are scaled together so that a feature that passes through several of them gets one motion: the
//! free points are eliminated face by face, and the reduced energies of a group are added before its motion is
//! chosen (spec 3.8, 3.11).

use super::ScaleError;
use super::cells::Mask;
use super::energy::energy_matrix;
use super::envelope::{Prepared, PreparedLoop};
use super::fold::{Compression, strongest_compression};
use super::motion::{LoopFrame, Motion, degenerate};
use super::polygon::{Domain, Polygon, PolygonFault};
use super::refine::{Refined, refine};
use super::scaling::{Energy, Hold, Scaling};
use super::slide::slide_reference;
use super::solve::{Elimination, FaceSystem, Held, choose_amounts};
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::math::{Affine, Point3, Vector3};

/// A closed polygon in the parameters of a face.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contour {
    /// Points in order; the closing side is implied.
    pub points: Vec<[f64; 2]>,
    /// By how much the true curve may miss the polygon, in `u` and in `v`.
    pub margin: [f64; 2],
}

/// A loop whose inside keeps its shape.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldLoop {
    /// Its polygon.
    pub contour: Contour,
    /// Loops with the same number, on whatever face, move as one.
    pub group: usize,
    /// What is held; the first loop of a group decides.
    pub hold: Hold,
}

/// One face with what is held on it.
#[derive(Debug, Clone)]
pub struct FaceTask<'a> {
    /// Name for messages.
    pub name: String,
    /// Its surface.
    pub surface: &'a NurbsSurface,
    /// Held loops; without any the face is scaled plainly.
    pub held: Vec<HeldLoop>,
    /// The outer loop, where it is not the natural border.
    pub outer: Option<Contour>,
    /// Inner loops that follow the scaling.
    pub scaled: Vec<Contour>,
}

/// A scaled face.
#[derive(Debug, Clone)]
pub struct ScaledFace {
    /// The result: same degrees and domain as the input, knots refined.
    pub surface: NurbsSurface,
    /// The plainly scaled surface over the same knots.
    pub plain: NurbsSurface,
    /// Control points that moved rigidly.
    pub held: Mask,
    /// Control points before refinement.
    pub points_before: usize,
    /// Control points that were solved for.
    pub free_points: usize,
    /// How often the spans were bisected.
    pub level: usize,
    /// Strongest compression against the plainly scaled surface.
    pub compression: Compression,
}

/// Held loops with one motion.
#[derive(Debug, Clone)]
pub struct Group {
    /// Face and loop, by the caller's indices.
    pub loops: Vec<(usize, usize)>,
    /// Their motion.
    pub motion: Motion,
    /// Whether loops of different numbers were joined because they lie too near to each other.
    pub merged: bool,
}

/// Faces scaled together.
#[derive(Debug, Clone)]
pub struct Scaled {
    /// One for each task, in order.
    pub faces: Vec<ScaledFace>,
    /// Groups in the order of their first loops.
    pub groups: Vec<Group>,
    /// Greatest relative residual of the stationarity conditions: of the free points, and of the groups' motions.
    pub residual: f64,
}

/// Scales one face; see [`scale_faces`].
///
/// # Errors
/// See [`ScaleError`].
pub fn scale_face(
    surface: &NurbsSurface,
    held: &[HeldLoop],
    outer: Option<Contour>,
    scaling: &Scaling,
) -> Result<Scaled, ScaleError> {
    let held = held.to_vec();
    let task = FaceTask { name: "1".to_owned(), surface, held, outer, scaled: Vec::new() };
    scale_faces(&[task], scaling)
}

/// Scales faces whose held loops keep their shape, with one motion for each group of loops.
///
/// All or nothing: an error leaves no face changed. Deterministic. Time and memory are bounded by
/// [`Scaling::max_control_points`].
///
/// # Errors
/// See [`ScaleError`]; each names the face.
pub fn scale_faces(tasks: &[FaceTask<'_>], scaling: &Scaling) -> Result<Scaled, ScaleError> {
    let plain = scaling.affine()?;
    let faces = tasks.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
    let mut grouping = Grouping::new(tasks);
    let moves = |l: &PreparedLoop| matches!(l.hold, Hold::Pinned(Some(_)));
    if plain.is_identity() && !faces.iter().flat_map(|f| &f.held).any(moves) {
        return unchanged(tasks, &faces, &grouping, scaling, &plain);
    }
    let mut least = vec![0; faces.len()];
    loop {
        let refined = refine_together(&faces, &mut grouping, &mut least, scaling)?;
        let motions = motions(&faces, &grouping, scaling, &plain)?;
        let solved = solve(tasks, &faces, refined, &grouping, motions, scaling, &plain)?;
        let Some(folded) = solved.faces.iter().position(|f| f.compression.is_fold()) else {
            return Ok(solved);
        };
        // One more level gives the stretched part more room, as long as the limit allows.
        let Compression { ratio, near } = solved.faces[folded].compression;
        if solved.faces[folded].level < least[folded] {
            return Err(ScaleError::FoldOver { face: faces[folded].name.clone(), ratio, near });
        }
        least[folded] = solved.faces[folded].level + 1;
    }
}

fn prepare(task: &FaceTask<'_>) -> Result<Prepared, ScaleError> {
    let face = || task.name.clone();
    for (direction, knots) in [("u", task.surface.knots_u()), ("v", task.surface.knots_v())] {
        if let Some(knot) = torn_at(knots) {
            return Err(ScaleError::BadKnots { face: face(), direction, knot, degree: knots.degree() });
        }
    }
    let surface = task.surface.clamped();
    let domain = [surface.knots_u().domain(), surface.knots_v().domain()];
    let held = task.held.iter().enumerate().map(|(k, l)| {
        let polygon = checked(&l.contour, domain, &task.name, k)?;
        Ok(PreparedLoop { polygon, hold: l.hold })
    });
    let held = held.collect::<Result<Vec<_>, _>>()?;
    let more = |k: usize| task.held.len() + k;
    let scaled = task.scaled.iter().enumerate().map(|(k, c)| checked(c, domain, &task.name, more(k)));
    let scaled = scaled.collect::<Result<Vec<_>, _>>()?;
    let last = more(task.scaled.len());
    let outer = task.outer.as_ref().map(|c| checked(c, domain, &task.name, last)).transpose()?;
    for first in 0..held.len() {
        for second in first + 1..held.len() {
            if held[first].polygon.overlaps(&held[second].polygon) {
                return Err(ScaleError::HeldLoopsOverlap { face: face(), first, second });
            }
        }
    }
    Ok(Prepared { name: face(), surface, held, outer, scaled })
}

/// An interior knot that occurs more than degree times.
fn torn_at(knots: &KnotVector) -> Option<f64> {
    let (start, end) = knots.domain();
    let (distinct, multiplicities) = knots.distinct();
    let inner = distinct.iter().zip(multiplicities).filter(|(k, _)| **k > start && **k < end);
    inner.filter(|(_, m)| *m > knots.degree()).map(|(k, _)| *k).next()
}

fn checked(contour: &Contour, domain: Domain, face: &str, held: usize) -> Result<Polygon, ScaleError> {
    let face = || face.to_owned();
    Polygon::new(&contour.points, contour.margin, domain).map_err(|fault| match fault {
        PolygonFault::NotFinite => ScaleError::NonFiniteInput { face: face(), what: "a loop" },
        PolygonFault::Outside(at) => ScaleError::LoopOutsideDomain { face: face(), held, at },
        PolygonFault::Degenerate => ScaleError::LoopDegenerate { face: face(), held },
        PolygonFault::Crosses(at) => ScaleError::LoopSelfIntersects { face: face(), held, at },
    })
}

/// Which loops move together: for each face and loop the index of its group's first loop.
#[derive(Debug, Clone)]
struct Grouping {
    /// By face and loop.
    root: Vec<Vec<usize>>,
    /// Loops joined because they are near.
    merged: Vec<usize>,
}

impl Grouping {
    fn new(tasks: &[FaceTask<'_>]) -> Self {
        let mut first = std::collections::BTreeMap::new();
        let mut count = 0;
        let root = tasks.iter().map(|task| {
            let roots = task.held.iter().map(|l| {
                let root = *first.entry(l.group).or_insert(count);
                count += 1;
                root
            });
            roots.collect()
        });
        Self { root: root.collect(), merged: Vec::new() }
    }

    fn join(&mut self, a: usize, b: usize) {
        let (keep, drop) = (a.min(b), a.max(b));
        for root in self.root.iter_mut().flatten() {
            if *root == drop {
                *root = keep;
            }
        }
        self.merged.retain(|&m| m != drop);
        self.merged.push(keep);
    }

    /// Roots in order.
    fn groups(&self) -> Vec<usize> {
        let mut roots: Vec<usize> = self.root.iter().flatten().copied().collect();
        roots.sort_unstable();
        roots.dedup();
        roots
    }
}

/// Refines all faces; joins loops that stay too near, and starts again from the coarse nets; brings faces that
/// share a group to one level, without which the thinnest place between two skins loses a third.
fn refine_together(
    faces: &[Prepared],
    grouping: &mut Grouping,
    least: &mut [usize],
    scaling: &Scaling,
) -> Result<Vec<Refined>, ScaleError> {
    loop {
        let mut refined = Vec::with_capacity(faces.len());
        for (k, face) in faces.iter().enumerate() {
            refined.push(refine(face, &grouping.root[k], least[k], scaling)?);
        }
        let near: Vec<(usize, usize)> = refined
            .iter()
            .zip(&grouping.root)
            .flat_map(|(r, root)| r.near_pairs.iter().map(|&(a, b)| (root[a], root[b])))
            .collect();
        if let Some(&(a, b)) = near.first() {
            grouping.join(a, b);
            continue;
        }
        if !level_up(&refined, grouping, least) {
            return Ok(refined);
        }
    }
}

/// Raises the least levels to the greatest level of the faces that share a group; whether any rose.
fn level_up(refined: &[Refined], grouping: &Grouping, least: &mut [usize]) -> bool {
    let mut rose = false;
    for group in grouping.groups() {
        let on: Vec<usize> = (0..refined.len()).filter(|&k| grouping.root[k].contains(&group)).collect();
        let level = on.iter().map(|&k| refined[k].level).max().unwrap_or(0);
        for k in on {
            if refined[k].level < level && least[k] < level {
                least[k] = level;
                rose = true;
            }
        }
    }
    rose
}

fn motions(
    faces: &[Prepared],
    grouping: &Grouping,
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Vec<Motion>, ScaleError> {
    let mut motions = Vec::new();
    for group in grouping.groups() {
        let mut frames = Vec::new();
        let mut first: Option<(&Prepared, usize, Hold)> = None;
        for (face, roots) in faces.iter().zip(&grouping.root) {
            for (k, _) in roots.iter().enumerate().filter(|(_, root)| **root == group) {
                let held = &face.held[k];
                first.get_or_insert((face, k, held.hold));
                let frame = LoopFrame::new(&face.surface, &held.polygon, scaling.energy);
                frames.push(frame.map_err(|at| degenerate(&face.name, k, scaling.energy, at))?);
            }
        }
        let (face, k, hold) = first.expect("a group has a loop");
        let motion = Motion::new(&frames, hold, scaling, plain);
        motions.push(motion.ok_or(ScaleError::LoopDegenerate { face: face.name.clone(), held: k })?);
    }
    Ok(motions)
}

/// One face between refinement and back substitution.
struct Stage {
    original: NurbsSurface,
    plain: NurbsSurface,
    level: usize,
    fixed: Mask,
    /// Group and its points.
    held: Vec<(usize, Mask, Vec<usize>)>,
    reference: Vec<[f64; 3]>,
    system: FaceSystem,
    per_area: f64,
    elimination: Elimination,
}

fn solve(
    tasks: &[FaceTask<'_>],
    faces: &[Prepared],
    refined: Vec<Refined>,
    grouping: &Grouping,
    mut motions: Vec<Motion>,
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Scaled, ScaleError> {
    let groups = grouping.groups();
    let mut stages = Vec::with_capacity(faces.len());
    for (k, refined) in refined.into_iter().enumerate() {
        let held = held_sets(&refined, &grouping.root[k], &groups);
        let staged = || stage(&faces[k].name, refined, held, &motions, scaling, plain);
        stages.push((!faces[k].held.is_empty()).then(staged).transpose()?);
    }
    let rows: Vec<_> = stages.iter().flatten().map(|s| (s.per_area, s.elimination.rows.as_slice())).collect();
    choose_amounts(&mut motions, &rows)
        .map_err(|unknowns| ScaleError::SingularSystem { face: faces[0].name.clone(), unknowns })?;
    let mut residual = Residual::new(&motions);
    let mut done = Vec::with_capacity(stages.len());
    for ((stage, face), task) in stages.into_iter().zip(faces).zip(tasks) {
        let points_before = task.surface.net().len();
        done.push(match stage {
            Some(stage) => finish(stage, &face.name, points_before, &motions, &mut residual)?,
            None => whole(task.surface.transformed(plain)),
        });
    }
    let residual = residual.greatest(&motions);
    Ok(Scaled { faces: done, groups: group_list(grouping, motions), residual })
}

fn held_sets(refined: &Refined, roots: &[usize], groups: &[usize]) -> Vec<(usize, Mask, Vec<usize>)> {
    let (rows, columns) = refined.surface.shape();
    let mut sets = Vec::new();
    for (index, group) in groups.iter().enumerate() {
        let mut mask = Mask::empty(rows, columns);
        for (held, _) in refined.envelopes.held.iter().zip(roots).filter(|(_, root)| *root == group) {
            mask.unite(held);
        }
        let points: Vec<usize> = mask.indices().collect();
        if !points.is_empty() {
            sets.push((index, mask, points));
        }
    }
    sets
}

fn stage(
    name: &str,
    refined: Refined,
    held: Vec<(usize, Mask, Vec<usize>)>,
    motions: &[Motion],
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Stage, ScaleError> {
    let Refined { surface: original, envelopes, level, .. } = refined;
    let scaled = original.transformed(plain);
    let mut known = envelopes.fixed.clone();
    for (_, mask, _) in &held {
        known.unite(mask);
    }
    let free: Vec<usize> = known.complement().indices().collect();
    let unknowns = free.len();
    let energy = energy_matrix(&scaled, scaling.energy);
    let singular = || ScaleError::SingularSystem { face: name.to_owned(), unknowns };
    let system = FaceSystem::new(energy.matrix, free).map_err(|_| singular())?;
    let sets: Vec<Held<'_>> = held
        .iter()
        .map(|(group, _, points)| Held { group: *group, points, motion: &motions[*group] })
        .collect();
    let reference = match scaling.energy {
        Energy::Slide => slide_reference(&original, &scaled, &sets, &system).map_err(|_| singular())?,
        Energy::Published => scaled.net().iter().map(|h| [h[0], h[1], h[2]]).collect(),
    };
    let elimination = eliminate(&original, &scaled, &envelopes.fixed, &sets, &reference, &system);
    let per_area = energy.per_area;
    let fixed = envelopes.fixed;
    Ok(Stage { original, plain: scaled, level, fixed, held, reference, system, per_area, elimination })
}

/// The known displacements from the reference, and the reduced energy.
fn eliminate(
    original: &NurbsSurface,
    plain: &NurbsSurface,
    fixed: &Mask,
    held: &[Held<'_>],
    reference: &[[f64; 3]],
    system: &FaceSystem,
) -> Elimination {
    let n = original.net().len();
    let mut known = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    for index in fixed.indices() {
        for c in 0..3 {
            known[c][index] = plain.net()[index][c] - reference[index][c];
        }
    }
    let mut columns = Vec::with_capacity(held.len());
    for group in held {
        let mut weights = vec![0.0; n];
        for &index in group.points {
            let image = moved(&original.net()[index], group.motion);
            weights[index] = image[3];
            for c in 0..3 {
                known[c][index] = image[c] - reference[index][c];
            }
        }
        columns.push((group.group, weights));
    }
    system.eliminate(known, &columns)
}

/// A homogeneous point moved by a group's motion, its weight kept.
fn moved(point: &[f64; 4], motion: &Motion) -> [f64; 4] {
    let weight = point[3];
    let image = motion.apply(&Point3::new(point[0] / weight, point[1] / weight, point[2] / weight));
    [image.x * weight, image.y * weight, image.z * weight, weight]
}

/// Back substitution: free points from the solve, held and fixed ones written directly, without cancellation.
fn finish(
    stage: Stage,
    name: &str,
    points_before: usize,
    motions: &[Motion],
    residual: &mut Residual,
) -> Result<ScaledFace, ScaleError> {
    let displacement = stage.elimination.displacement(&stage.system, |group| motions[group].shift());
    residual.add(&stage, &displacement);
    let mut net = stage.plain.net().to_vec();
    for &index in stage.system.free() {
        for c in 0..3 {
            net[index][c] = stage.reference[index][c] + displacement[c][index];
        }
    }
    let (rows, columns) = stage.plain.shape();
    let mut held = Mask::empty(rows, columns);
    for (group, mask, points) in &stage.held {
        held.unite(mask);
        for &index in points {
            net[index] = moved(&stage.original.net()[index], &motions[*group]);
        }
    }
    debug_assert!(!held.meets(&stage.fixed), "gaps keep held and fixed points apart");
    let knots = (stage.plain.knots_u().clone(), stage.plain.knots_v().clone());
    let surface = NurbsSurface::new(knots.0, knots.1, net)
        .map_err(|_| ScaleError::NonFiniteInput { face: name.to_owned(), what: "the result" })?;
    let compression = strongest_compression(&surface, &stage.plain);
    let free_points = stage.system.free().len();
    let Stage { plain, level, .. } = stage;
    Ok(ScaledFace { surface, plain, held, points_before, free_points, level, compression })
}

/// Collects how far the solution is from stationary.
struct Residual {
    free: f64,
    /// By group: gradient of the summed energies by its shift, and what it is measured against.
    groups: Vec<(Vector3<f64>, f64)>,
}

impl Residual {
    fn new(motions: &[Motion]) -> Self {
        Self { free: 0.0, groups: vec![(Vector3::zeros(), 0.0); motions.len()] }
    }

    fn add(&mut self, stage: &Stage, displacement: &[Vec<f64>; 3]) {
        let greatest = displacement.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let scale = greatest * stage.system.greatest_entry();
        if scale <= 0.0 {
            return;
        }
        for (c, column) in displacement.iter().enumerate() {
            let product = stage.system.times(column);
            for &index in stage.system.free() {
                self.free = self.free.max(product[index].abs() / scale);
            }
            for (group, _, points) in &stage.held {
                let entry = &mut self.groups[*group];
                let weighted = points.iter().map(|&k| product[k] * stage.original.net()[k][3]);
                entry.0[c] += stage.per_area * weighted.sum::<f64>();
                entry.1 = entry.1.max(stage.per_area * scale);
            }
        }
    }

    fn greatest(&self, motions: &[Motion]) -> f64 {
        let along = self.groups.iter().zip(motions).flat_map(|((gradient, scale), motion)| {
            let scale = if *scale > 0.0 { *scale } else { 1.0 };
            motion.directions.iter().map(move |f| f.dot(gradient).abs() / scale)
        });
        along.fold(self.free, f64::max)
    }
}

fn group_list(grouping: &Grouping, motions: Vec<Motion>) -> Vec<Group> {
    let of = |group: usize| {
        let faces = grouping.root.iter().enumerate();
        let loops = faces.flat_map(move |(f, roots)| {
            roots.iter().enumerate().filter(move |(_, r)| **r == group).map(move |(k, _)| (f, k))
        });
        loops.collect()
    };
    let groups = grouping.groups().into_iter().zip(motions);
    groups
        .map(|(group, motion)| Group { loops: of(group), motion, merged: grouping.merged.contains(&group) })
        .collect()
}

/// The result of the identity: every surface as it came, every motion the identity.
fn unchanged(
    tasks: &[FaceTask<'_>],
    faces: &[Prepared],
    grouping: &Grouping,
    scaling: &Scaling,
    plain: &Affine,
) -> Result<Scaled, ScaleError> {
    let motions = motions(faces, grouping, scaling, plain)?;
    let done = tasks.iter().map(|task| whole(task.surface.clone()));
    Ok(Scaled { faces: done.collect(), groups: group_list(grouping, motions), residual: 0.0 })
}

/// A face of which nothing is held.
fn whole(surface: NurbsSurface) -> ScaledFace {
    let (rows, columns) = surface.shape();
    ScaledFace {
        plain: surface.clone(),
        surface,
        held: Mask::empty(rows, columns),
        points_before: rows * columns,
        free_points: 0,
        level: 0,
        compression: Compression { ratio: 1.0, near: Point3::origin() },
    }
}
