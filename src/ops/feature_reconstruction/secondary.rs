//! The secondary surface: a piece of the primary larger than the feature, deformed until it passes through the character
//! lines, the limiting lines and, unless only lines are wanted, the cloud itself.

use super::backbone::Backbone;
use super::deviation::Deviation;
use super::error::ReconstructionError;
use super::feet::{Foot, Projector};
use super::fishbone::{Agreement, Fishbone, FishboneSettings, LinePoint};
use super::metric::{Metric, ParameterLine};
use super::relief::Relief;
use super::smoothing::{MEDIAN_TO_DEVIATION, median};
use crate::geometry::nurbs::{NurbsSurface, Wrap};
use crate::math::Point3;
use crate::ops::force_density::{Constraint, Criteria, Ghosts, Network, System};
use serde::{Deserialize, Serialize};

/// What the surface is made from.
#[derive(Debug, Clone, Copy)]
pub struct Sources<'a> {
    /// The primary, extended where the feature runs out over its border.
    pub primary: &'a Projector<'a>,
    /// The objective's points.
    pub points: &'a [Point3<f64>],
    /// Their feet on the primary.
    pub feet: &'a [Foot],
    /// Distance of neighbouring points.
    pub spacing: f64,
    /// The limiting lines.
    pub rims: &'a [ParameterLine],
}

/// The lines within the feature.
#[derive(Debug, Clone, Copy)]
pub enum CharacterLines<'a> {
    /// Found in the cloud.
    Fishbone {
        /// How the backbone is found.
        backbone: Backbone<'a>,
        /// How many lines there are at first.
        settings: FishboneSettings,
    },
    /// Given, with their feet on the primary.
    Given(&'a [Vec<LinePoint>]),
}

/// What part the cloud's points have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CloudUse {
    /// The surface is drawn to each of them.
    #[default]
    Fitted,
    /// They tell only how good the lines' surface is.
    Compared,
}

/// How the surface is made.
#[derive(Debug, Clone, Copy)]
pub struct SecondarySettings<'a> {
    /// The lines.
    pub lines: CharacterLines<'a>,
    /// What the cloud is for.
    pub cloud: CloudUse,
    /// What the deformation makes least.
    pub criteria: Criteria,
    /// Spans of the net; `None` for a twentieth of the feature, at least three spacings.
    pub spans: Option<[usize; 2]>,
    /// Greatest mean and greatest distance of the points; `None` for what their scatter lets expect.
    pub limits: Option<[f64; 2]>,
}

/// A secondary surface with what is known of it.
#[derive(Debug, Clone)]
pub struct Secondary {
    /// The surface, over parameters of the primary; it goes beyond the limiting lines.
    pub surface: NurbsSurface,
    /// Figures for the report.
    pub measures: SecondaryMeasures,
}

/// Figures of a secondary surface. Lengths are in file units.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SecondaryMeasures {
    /// Lines along the backbone and ribs; both 0 when the lines were given.
    pub lines: [usize; 2],
    /// Lines that had too few points.
    pub skipped: usize,
    /// Points of the lines that count.
    pub line_points: usize,
    /// Where lines cross.
    pub agreement: Agreement,
    /// Rows and columns of the net.
    pub net: [usize; 2],
    /// Times that lines were added or the net was refined.
    pub rounds: usize,
    /// Deviation of the cloud's points as they scatter about smooth lines.
    pub noise: f64,
    /// Distances of the cloud's points from the surface.
    pub deviation: Deviation,
}

/// How far the surface goes beyond the limiting lines, as a part of their extent.
const MARGIN: f64 = 0.15;
/// Length of a span as a part of the extent, and least length in spacings, at first and at last.
const SPAN: f64 = 1.0 / 20.0;
const SPAN_SPACINGS: [f64; 2] = [3.0, 1.5];
/// Strength of the constraints with lines alone.
const STRENGTH: f64 = 10.0;
/// Strengths with the cloud. The weakest one is taken that leaves the points no farther away than the last does, but for
/// what a net of so many control points wins by following their noise.
const STRENGTHS: [f64; 4] = [1.0, 10.0, 1e2, 1e3];
/// Points by which strengths are compared.
const COMPARED: usize = 20_000;
/// Weight of the lines beside the cloud.
const BESIDE_CLOUD: f64 = 0.2;
/// Part of the domain that constraints must fill, and their least count, before the border is let free.
const WELL_HELD: (f64, usize) = (0.6, 20);
/// Rounds of improvement.
const ROUNDS: usize = 6;
/// Expected mean and 95 % distance in deviations of the noise, and what is added as a part of the height.
const EXPECTED: [(f64, f64); 2] = [(0.96, 1e-3), (2.5, 5e-3)];
/// Chords of a line: distance as a part of the height and in deviations of the noise, length in distances and spacings.
const CHORD: [f64; 2] = [1e-3, 0.5];
const CHORD_LENGTH: [f64; 2] = [20.0, 2.0];
/// Deviations beyond which a point of the cloud counts less.
const OUTLYING: f64 = 4.0;
/// Points of a limiting line: distance in spacings, least and greatest count.
const RIM: (f64, usize, usize) = (1.5, 50, 400);
/// Degree of the net.
const DEGREE: usize = 3;
/// Height times curvature of the primary beyond which a foot is not to be trusted, and the share of such feet.
const UNCLEAR: (f64, f64) = (0.8, 0.01);

/// Makes the secondary surface.
///
/// # Errors
/// [`ReconstructionError::HeightExceedsCurvature`], [`ReconstructionError::NoCharacterLine`],
/// [`ReconstructionError::LinesCross`], [`ReconstructionError::SecondaryDeviates`], [`ReconstructionError::Deform`].
pub fn secondary(
    sources: &Sources<'_>,
    settings: &SecondarySettings<'_>,
) -> Result<Secondary, ReconstructionError> {
    let share = sources.primary.share_beyond(sources.feet, UNCLEAR.0);
    if share > UNCLEAR.1 {
        return Err(ReconstructionError::HeightExceedsCurvature { share: 100.0 * share });
    }
    let surface = sources.primary.surface();
    let metric = Metric::around(surface, sources.feet);
    let rims: Vec<ParameterLine> =
        sources.rims.iter().map(|rim| even(rim, surface, sources.spacing)).collect();
    let relief = Relief::new(metric, sources.feet, sources.spacing, &rims);
    let bone = match settings.lines {
        CharacterLines::Fishbone { backbone, settings } => {
            Some(Fishbone::new(&relief, sources.primary, backbone, &settings)?)
        }
        CharacterLines::Given(_) => None,
    };
    let net = initial(surface, &metric, &rims, sources, settings.spans)?;
    let coarsest = net.net().len() as f64;
    Work { sources, settings, rims: &rims, relief: &relief, coarsest }.carried_out(bone, net)
}

/// A limiting line by even steps.
fn even(rim: &ParameterLine, primary: &NurbsSurface, spacing: f64) -> ParameterLine {
    let (_, length) = rim.resampled(primary, 2);
    let count = ((length / (RIM.0 * spacing)) as usize).clamp(RIM.1, RIM.2);
    rim.resampled(primary, count).0
}

/// The piece of the primary round the limiting lines, with a net to deform.
fn initial(
    primary: &NurbsSurface,
    metric: &Metric,
    rims: &[ParameterLine],
    sources: &Sources<'_>,
    spans: Option<[usize; 2]>,
) -> Result<NurbsSurface, ReconstructionError> {
    let places = || rims.iter().flat_map(|rim| rim.points.iter()).chain(sources.feet.iter().map(|f| &f.at));
    let (u, v) = primary.domain();
    let range = |k: usize, (first, last): (f64, f64)| {
        let (low, high) = places()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at[k]), high.max(at[k])));
        let more = MARGIN * (high - low);
        let length = metric.lengths([high - low; 2])[k];
        let span = (SPAN * length).max(SPAN_SPACINGS[0] * sources.spacing);
        let (from, to) = ((low - more).max(first), (high + more).min(last));
        let count = (metric.lengths([to - from; 2])[k] / span).ceil().max(1.0) as usize;
        ((from, to), count)
    };
    let ((u, rows), (v, columns)) = (range(0, u), range(1, v));
    let [rows, columns] = spans.unwrap_or([rows, columns]);
    let piece = primary.piece(u, v).and_then(|piece| piece.elevated(DEGREE, DEGREE));
    let net = piece.and_then(|piece| piece.with_spans(rows, columns));
    net.map_err(|_| ReconstructionError::CloudDegenerate { which: "objective" })
}

/// One feature at work.
struct Work<'a> {
    sources: &'a Sources<'a>,
    settings: &'a SecondarySettings<'a>,
    rims: &'a [ParameterLine],
    relief: &'a Relief,
    /// Control points of the first net.
    coarsest: f64,
}

impl Work<'_> {
    /// Deforms, and improves lines and net until the points are near enough.
    fn carried_out(
        &self,
        mut bone: Option<Fishbone>,
        mut net: NurbsSurface,
    ) -> Result<Secondary, ReconstructionError> {
        let height = self.relief.greatest_height();
        let mut rounds = 0;
        loop {
            let noise = bone.as_ref().map(Fishbone::scatter);
            let lines = self.lines(bone.as_ref(), (CHORD[0] * height).max(CHORD[1] * noise.unwrap_or(0.0)));
            let surface = self.deformed(&net, &lines, (noise, height))?;
            let signed = self.heights_above(&surface);
            let noise = noise.unwrap_or_else(|| MEDIAN_TO_DEVIATION * median(absolute(&signed)));
            let deviation = Deviation::of(&signed);
            if self.is_near(&deviation, noise, height) {
                let line_points = lines.iter().map(Vec::len).sum();
                return Ok(self.finished(surface, bone, (line_points, rounds, noise), deviation));
            }
            if rounds == ROUNDS {
                return Err(self.missed(&deviation, noise, height));
            }
            rounds += 1;
            let limit = self.limits(noise, height)[0];
            let more = match &bone {
                Some(bone) if self.settings.cloud == CloudUse::Compared => {
                    bone.with_ribs_where(self.relief, &absolute(&signed), limit)?
                }
                _ => None,
            };
            match (more, self.finer(&net)) {
                (Some(more), _) => bone = Some(more),
                (None, Some(finer)) => net = finer,
                (None, None) => return Err(self.missed(&deviation, noise, height)),
            }
        }
    }

    /// Points of the lines.
    fn lines(&self, bone: Option<&Fishbone>, chord: f64) -> Vec<Vec<LinePoint>> {
        let length = (CHORD_LENGTH[0] * chord).max(CHORD_LENGTH[1] * self.sources.spacing);
        match (bone, self.settings.lines) {
            (Some(bone), _) => {
                let surface = self.sources.primary.surface();
                bone.lines().map(|line| line.sampled(self.relief, surface, chord, length)).collect()
            }
            (None, CharacterLines::Given(lines)) => lines.to_vec(),
            (None, CharacterLines::Fishbone { .. }) => Vec::new(),
        }
    }

    fn deformed(
        &self,
        net: &NurbsSurface,
        lines: &[Vec<LinePoint>],
        (noise, height): (Option<f64>, f64),
    ) -> Result<NurbsSurface, ReconstructionError> {
        let fitted = self.settings.cloud == CloudUse::Fitted;
        let weight = if fitted { BESIDE_CLOUD } else { 1.0 };
        let drawn = self.drawn(net, lines, weight);
        let ghosts = if is_well_held(net, &drawn) { Ghosts::Floating } else { Ghosts::Fixed };
        let network = Network::unsupported(net, Network::even_densities(net), ghosts);
        let share = (self.coarsest / net.net().len() as f64).sqrt();
        let mut system = System::new(net, &network, &self.settings.criteria.refined(share))?;
        system.add(drawn.iter().copied())?;
        if !fitted {
            return Ok(system.balanced(STRENGTH)?.surface);
        }
        let mut all = system.clone();
        all.add(self.through_points(net, |_| 1.0))?;
        let surface = self.balanced(&all)?;
        let signed = self.heights_above(&surface);
        let noise = noise.unwrap_or_else(|| MEDIAN_TO_DEVIATION * median(absolute(&signed)));
        let bound = OUTLYING * noise.max(CHORD[0] * height);
        if signed.iter().all(|d| d.abs() <= bound) {
            return Ok(surface);
        }
        system.add(self.through_points(net, |k| (bound / signed[k].abs()).powi(2).min(1.0)))?;
        self.balanced(&system)
    }

    /// The surface that follows the points, and their noise as little as it can.
    fn balanced(&self, system: &System<'_>) -> Result<NurbsSurface, ReconstructionError> {
        let [weaker @ .., last] = STRENGTHS;
        let closest = system.balanced(last)?.surface;
        let count = self.sources.points.len().max(1) as f64;
        let most = self.missed_at_feet(&closest) * (1.0 + closest.net().len() as f64 / count);
        for strength in weaker {
            let surface = system.balanced(strength)?.surface;
            if self.missed_at_feet(&surface) <= most {
                return Ok(surface);
            }
        }
        Ok(closest)
    }

    /// Mean square of the distances of some points from the places of their feet.
    fn missed_at_feet(&self, surface: &NurbsSurface) -> f64 {
        let step = (self.sources.points.len() / COMPARED).max(1);
        let places = self.sources.feet.iter().zip(self.sources.points).step_by(step);
        let within = places.filter(|(foot, _)| is_within(surface, foot.at));
        let square = |(foot, point): (&Foot, &Point3<f64>)| {
            (surface.point(foot.at[0], foot.at[1]) - point).norm_squared()
        };
        let (sum, count) = within.map(square).fold((0.0, 0.0), |(sum, n), x| (sum + x, n + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// What lines and limiting lines ask for.
    fn drawn(&self, net: &NurbsSurface, lines: &[Vec<LinePoint>], weight: f64) -> Vec<Constraint> {
        let primary = self.sources.primary.surface();
        let on_rims = self.rims.iter().flat_map(|rim| &rim.points);
        let rims = on_rims.map(|at| Constraint::through(*at, &primary.point(at[0], at[1]), weight));
        let lines = lines.iter().flatten().map(|p| Constraint::through(p.at, &p.to, weight));
        rims.chain(lines).filter(|c| is_within(net, c.at)).collect()
    }

    /// What the points ask for; `weight` is by the number of the point.
    fn through_points(
        &self,
        net: &NurbsSurface,
        weight: impl Fn(usize) -> f64,
    ) -> impl Iterator<Item = Constraint> {
        let places = self.sources.feet.iter().zip(self.sources.points).enumerate();
        places
            .filter(|(_, (foot, _))| is_within(net, foot.at))
            .map(move |(k, (foot, point))| Constraint::through(foot.at, point, weight(k)))
    }

    /// Signed distances of the points.
    fn heights_above(&self, surface: &NurbsSurface) -> Vec<f64> {
        let projector = Projector::new(surface, Wrap::default());
        projector.feet(self.sources.points).iter().map(|foot| foot.height).collect()
    }

    /// Limits of the mean and of the 95 % or, where the caller has named it, the greatest distance.
    fn limits(&self, noise: f64, height: f64) -> [f64; 2] {
        self.settings.limits.unwrap_or_else(|| EXPECTED.map(|(n, h)| n * noise + h * height))
    }

    /// The figure that the second limit is for.
    fn upper(&self, deviation: &Deviation) -> f64 {
        if self.settings.limits.is_some() { deviation.greatest } else { deviation.most }
    }

    fn is_near(&self, deviation: &Deviation, noise: f64, height: f64) -> bool {
        let limits = self.limits(noise, height);
        deviation.mean <= limits[0] && self.upper(deviation) <= limits[1]
    }

    fn missed(&self, deviation: &Deviation, noise: f64, height: f64) -> ReconstructionError {
        let limits = self.limits(noise, height);
        ReconstructionError::SecondaryDeviates { found: [deviation.mean, self.upper(deviation)], limits }
    }

    /// The net with all spans halved, unless they are short already.
    fn finer(&self, net: &NurbsSurface) -> Option<NurbsSurface> {
        let (u, v) = net.domain();
        let counts = [net.knots_u(), net.knots_v()].map(|knots| knots.spans().count());
        let lengths = self.relief.metric().lengths([u.1 - u.0, v.1 - v.0]);
        let least = SPAN_SPACINGS[1] * self.sources.spacing;
        let short = |k: usize| 0.5 * lengths[k] / (counts[k] as f64) < least;
        if self.settings.spans.is_some() || (short(0) && short(1)) {
            return None;
        }
        let halved = |k: usize| if short(k) { counts[k] } else { 2 * counts[k] };
        net.with_spans(halved(0), halved(1)).ok()
    }

    fn finished(
        &self,
        surface: NurbsSurface,
        bone: Option<Fishbone>,
        (line_points, rounds, noise): (usize, usize, f64),
        deviation: Deviation,
    ) -> Secondary {
        let (rows, columns) = surface.shape();
        let bone = bone.as_ref();
        let measures = SecondaryMeasures {
            lines: bone.map_or([0; 2], Fishbone::counts),
            skipped: bone.map_or(0, |bone| bone.skipped),
            line_points,
            agreement: bone.map_or_else(Agreement::default, |bone| bone.agreement),
            net: [rows, columns],
            rounds,
            noise,
            deviation,
        };
        Secondary { surface, measures }
    }
}

fn absolute(signed: &[f64]) -> Vec<f64> {
    signed.iter().map(|d| d.abs()).collect()
}

fn is_within(net: &NurbsSurface, at: [f64; 2]) -> bool {
    let (u, v) = net.domain();
    (u.0..=u.1).contains(&at[0]) && (v.0..=v.1).contains(&at[1])
}

/// Whether constraints hold a net so well that its border may be free.
fn is_well_held(net: &NurbsSurface, constraints: &[Constraint]) -> bool {
    let filled = |k: usize, (first, last): (f64, f64)| {
        let places = || constraints.iter().map(|c| c.at[k]);
        let extent = places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min);
        extent >= WELL_HELD.0 * (last - first)
    };
    let (u, v) = net.domain();
    constraints.len() >= WELL_HELD.1 && filled(0, u) && filled(1, v)
}
