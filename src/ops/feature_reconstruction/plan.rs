//! From a scan and a primary face to a change set: all stages in their order.

use super::Closure;
use super::backbone::Backbone;
use super::error::ReconstructionError;
use super::feet::{Foot, Projector};
use super::fishbone::FishboneSettings;
use super::guide::guides;
use super::limiting_line::{LimitingLine, LineSettings, Objective, limiting_line};
use super::line_ends::carried_on;
use super::metric::{Metric, ParameterLine};
use super::path::Path;
use super::radius::{BlendCloud, FoundBy, Radius, RadiusLaw, Wanted, radius};
use super::rolling::{Edge, Rolled, Roller, rolled};
use super::scan::{Scan, Sorted, extension, working_surface};
use super::secondary::{
    CharacterLines, CloudUse, Secondary, SecondaryMeasures, SecondarySettings, Sources, secondary,
};
use super::sewing::chart::Chart;
use super::sewing::rail::Rail;
use super::sewing::{Shape, sewn};
use crate::brep::FaceId;
use crate::diagnostic::{Diagnostic, Severity};
use crate::geometry::Surface;
use crate::geometry::nurbs::{NurbsSurface, Wrap};
use crate::math::{Affine, Point2, Point3};
use crate::model::{ChangeSet, Model};
use crate::ops::OperationError;
use crate::ops::force_density::Criteria;
use crate::ops::net::layout::face_name;
use serde::Serialize;

/// What is to be done.
#[derive(Debug, Clone)]
pub struct Params {
    /// The primary.
    pub face: FaceId,
    /// The points, in the units of the part.
    pub scan: Scan,
    /// Where the backbone comes from.
    pub backbone: BackboneChoice,
    /// Lines along the backbone at first; `None` for three in a closed feature and one in others.
    pub along: Option<usize>,
    /// Ribs at first.
    pub ribs: usize,
    /// What the cloud is for.
    pub cloud: CloudUse,
    /// What the deformation makes least.
    pub criteria: Criteria,
    /// Spans of the secondary; see [`SecondarySettings::spans`].
    pub spans: Option<[usize; 2]>,
    /// Greatest mean and greatest distance of the points; see [`SecondarySettings::limits`].
    pub limits: Option<[f64; 2]>,
    /// The radius.
    pub radius: RadiusChoice,
    /// Further places of the feature.
    pub motions: Vec<Affine>,
}

/// Where the backbone comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum BackboneChoice {
    /// [`Backbone::Fit`].
    Fit,
    /// [`Backbone::Slices`].
    Slices,
    /// [`Backbone::Crest`].
    Crest,
    /// [`Backbone::Curve`].
    Curve(Vec<Point3<f64>>),
}

/// Where the radius comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RadiusChoice {
    /// The points of the blend.
    Found(Wanted),
    /// The caller.
    Given(f64),
}

/// What is to be changed, and what is known about it beforehand.
#[derive(Debug, Clone)]
pub struct Plan {
    /// New geometry and topology.
    pub change_set: ChangeSet,
    /// Figures for the report.
    pub measures: Measures,
    /// Facts worth telling.
    pub notes: Vec<Diagnostic>,
}

/// Figures of one operation. Lengths are in file units, angles in degrees.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Measures {
    /// The primary.
    pub face: String,
    /// Points of the secondary and of the blend.
    pub points: [usize; 2],
    /// Points of the primary, and points that belong to nothing, in a cloud that was not sorted.
    pub left_out: [usize; 2],
    /// Distance of neighbouring points.
    pub spacing: f64,
    /// The limiting lines with their blends.
    pub lines: Vec<LineMeasures>,
    /// The secondary surface.
    pub secondary: SecondaryMeasures,
    /// Features that were built.
    pub features: usize,
}

/// Figures of one limiting line and its blend.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LineMeasures {
    /// Its length.
    pub length: f64,
    /// Whether it is closed.
    pub closed: bool,
    /// Deviation of a single crossing before smoothing.
    pub deviation: f64,
    /// Slices, and those without a crossing.
    pub slices: [usize; 2],
    /// The radius; left out when the job gives it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<Radius>,
    /// The radius in the middle of the line.
    pub ball: f64,
    /// Sections of the blend.
    pub sections: usize,
    /// Greatest distance of the blend's borders from primary and secondary.
    pub contact_deviation: [f64; 2],
    /// Greatest angle between the blend and the two surfaces along the contacts.
    pub angle: f64,
}

/// Part of the file's uncertainty that the blend's borders may be off both surfaces.
const OF_UNCERTAINTY: f64 = 0.9;
/// Uncertainty as a part of the surface's size, where the file states none.
const TOLERANCE: f64 = 1e-6;
/// Lines along the backbone of a closed feature and of others.
const ALONG: [usize; 2] = [3, 1];
/// Points of a limiting line for the secondary.
const RIM: usize = 400;
/// Share of the blend's feet that a band holds.
const BAND: f64 = 0.9;
/// How far an open line is carried on: in widths of its band and in spacings.
const OVER: [f64; 2] = [1.2, 3.0];
/// Stations of the ball that finds the radius.
const STATIONS: usize = 160;

/// Plans a reconstruction.
///
/// # Errors
/// [`ReconstructionError`]; nothing is changed in part.
pub fn plan(model: &Model, params: &Params) -> Result<Plan, OperationError> {
    let points: Vec<Point3<f64>> = params.scan.points().copied().collect();
    let surface = working_surface(model, params.face, &points)?;
    let near = Projector::new(&surface, Wrap::default());
    let sorted = params.scan.clone().sorted(&near)?;
    let longer = match extension(&near, &sorted.objective, sorted.spacing) {
        Some([u, v]) => surface
            .extended((u, u), (v, v))
            .map_err(|error| ReconstructionError::Primary { reason: error.to_string() })?,
        None => surface.clone(),
    };
    let projector = Projector::new(&longer, Wrap::default());
    let work = Work::new(&projector, &sorted)?;
    let own = model.brep.surface_of(params.face).read();
    let chart = match own {
        Some(surface) if !matches!(surface, Surface::Nurbs(_)) => Chart::Other(surface),
        _ => Chart::Same(&longer),
    };
    let uncertainty = model.context_of(params.face).uncertainty.map(|t| t.0);
    let size = longer.bounding_box().diagonal();
    let tolerance = OF_UNCERTAINTY * uncertainty.unwrap_or(TOLERANCE * size);
    let found = work.found(params, tolerance)?;
    let shapes = found.shapes(&params.motions, &chart)?;
    let change_set = sewn(model, params.face, &chart, &shapes, tolerance)?;
    let measures = Measures {
        face: face_name(model, params.face),
        points: [sorted.objective.len(), sorted.blend.len()],
        left_out: sorted.left_out,
        spacing: sorted.spacing,
        lines: found.blends.iter().map(Blended::measures).collect(),
        secondary: found.secondary.measures,
        features: shapes.len(),
    };
    Ok(Plan { change_set, measures, notes: found.notes })
}

/// A feature's points as the primary sees them.
struct Work<'a> {
    projector: &'a Projector<'a>,
    sorted: &'a Sorted,
    objective: Vec<Foot>,
    blend: Vec<Foot>,
    metric: Metric,
    lines: Vec<LimitingLine>,
    /// Blend points of each line.
    bands: Vec<Vec<Point3<f64>>>,
}

/// A feature by itself.
struct Found {
    secondary: Secondary,
    blends: Vec<Blended>,
    notes: Vec<Diagnostic>,
}

/// A line with its blend.
struct Blended {
    line: LimitingLine,
    radius: Option<Radius>,
    law: RadiusLaw,
    rolled: Rolled,
}

impl<'a> Work<'a> {
    /// Finds the limiting lines.
    fn new(projector: &'a Projector<'a>, sorted: &'a Sorted) -> Result<Self, ReconstructionError> {
        let (objective, blend) = (projector.feet(&sorted.objective), projector.feet(&sorted.blend));
        let metric = Metric::around(projector.surface(), &objective);
        let lines = Vec::new();
        let mut work = Self { projector, sorted, objective, blend, metric, lines, bands: Vec::new() };
        let guides = guides(&metric, &work.objective, &work.blend, sorted.spacing)?;
        let bands = work.bands_of(&guides);
        let slices = Objective::new(&work.objective, sorted.spacing);
        for (guide, (width, points)) in guides.iter().zip(bands) {
            let settings = LineSettings { band: width, wavelength: None };
            let line = limiting_line(projector.surface(), &metric, &slices, guide, &settings)?;
            let over = OVER[0] * width + OVER[1] * sorted.spacing;
            work.lines.push(carried_on(&line, projector.surface(), &metric, over));
            work.bands.push(points);
        }
        Ok(work)
    }

    /// The width of the band about each guide, and its points: those that it is the nearest guide to.
    fn bands_of(&self, guides: &[ParameterLine]) -> Vec<(f64, Vec<Point3<f64>>)> {
        let paths: Vec<Option<Path>> = guides.iter().map(|guide| Path::of(guide, &self.metric)).collect();
        let mut bands = vec![(Vec::new(), Vec::new()); guides.len()];
        for (foot, point) in self.blend.iter().zip(&self.sorted.blend) {
            let at = Point2::from(self.metric.lengths(foot.at));
            let beside = |path: &Option<Path>| path.as_ref().map_or(f64::INFINITY, |p| p.located(at).1.abs());
            let distances: Vec<f64> = paths.iter().map(beside).collect();
            let nearest = (0..distances.len()).min_by(|&a, &b| distances[a].total_cmp(&distances[b]));
            if let Some(k) = nearest {
                bands[k].0.push(distances[k]);
                bands[k].1.push(*point);
            }
        }
        let width = |mut distances: Vec<f64>| {
            distances.sort_unstable_by(f64::total_cmp);
            distances.get((BAND * distances.len() as f64) as usize).map_or(0.0, |d| 2.0 * d)
        };
        bands.into_iter().map(|(distances, points)| (width(distances), points)).collect()
    }

    /// Secondary and blends.
    fn found(&self, params: &Params, tolerance: f64) -> Result<Found, ReconstructionError> {
        let secondary = self.secondary(params)?;
        let mean: f64 = self.objective.iter().map(|foot| foot.height).sum();
        let surfaces = [self.projector.surface(), &secondary.surface];
        let mut blends = Vec::with_capacity(self.lines.len());
        let mut notes = Vec::new();
        for (line, points) in self.lines.iter().zip(&self.bands) {
            let (curve, closure) = (&line.curve, line.closure);
            let edge = Edge { surfaces, line: curve, closure, side: mean.signum() };
            let (law, radius) = match params.radius {
                RadiusChoice::Given(radius) => (RadiusLaw::Constant { radius }, None),
                RadiusChoice::Found(wanted) => {
                    let cloud = BlendCloud::new(points, self.sorted.spacing, secondary.measures.noise);
                    let found = radius(&cloud, &Roller::new(edge, STATIONS)?, wanted)?;
                    if found.is_uncertain() {
                        notes.push(uncertain(&found));
                    }
                    (found.law, Some(found))
                }
            };
            let rolled = rolled(edge, &law, tolerance)?;
            blends.push(Blended { line: line.clone(), radius, law, rolled });
        }
        Ok(Found { secondary, blends, notes })
    }

    fn secondary(&self, params: &Params) -> Result<Secondary, ReconstructionError> {
        let rims: Vec<ParameterLine> = self.lines.iter().map(rim).collect();
        let backbone = match &params.backbone {
            BackboneChoice::Fit => Backbone::Fit,
            BackboneChoice::Slices => Backbone::Slices,
            BackboneChoice::Crest => Backbone::Crest,
            BackboneChoice::Curve(points) => Backbone::Curve(points),
        };
        let closed = self.lines.iter().all(|line| line.closure == Closure::Closed);
        let along = params.along.unwrap_or(ALONG[usize::from(!closed)]);
        let settings = FishboneSettings { along, ribs: params.ribs };
        let sources = Sources {
            primary: self.projector,
            points: &self.sorted.objective,
            feet: &self.objective,
            spacing: self.sorted.spacing,
            rims: &rims,
        };
        let settings = SecondarySettings {
            lines: CharacterLines::Fishbone { backbone, settings },
            cloud: params.cloud,
            criteria: params.criteria,
            spans: params.spans,
            limits: params.limits,
        };
        secondary(&sources, &settings)
    }
}

/// A limiting line as places.
fn rim(line: &LimitingLine) -> ParameterLine {
    let steps = match line.closure {
        Closure::Closed => RIM,
        Closure::Open => RIM - 1,
    };
    let at = |k: usize| line.curve.point_at(k as f64 / steps as f64).into();
    ParameterLine { points: (0..RIM).map(at).collect(), closure: line.closure }
}

fn uncertain(radius: &Radius) -> Diagnostic {
    let mean = radius.law.mean();
    let others = [radius.by_slices[0], radius.by_primary[0], radius.by_both_surfaces[0]];
    let [slices, primary, both] = others;
    let by = match radius.found_by {
        FoundBy::Primary => "the ball on the primary",
        FoundBy::BothSurfaces => "the ball between both surfaces",
        FoundBy::Given => "the job",
    };
    Diagnostic {
        code: "reconstruct.radius-uncertain",
        severity: Severity::Warning,
        entity: None,
        span: None,
        message: format!(
            "the radius {mean:.5} of {by} was taken; circles through slices give {slices:.5}, the ball on the primary \
             {primary:.5}, the ball between both surfaces {both:.5}"
        ),
    }
}

impl Found {
    /// The feature in all its places.
    fn shapes(&self, motions: &[Affine], chart: &Chart<'_>) -> Result<Vec<Shape>, ReconstructionError> {
        let place = |motion: Option<&Affine>| {
            let rail =
                |blended: &Blended| Rail::new(&blended.rolled.blend, blended.line.closure, motion, chart);
            let rails = self.blends.iter().map(rail).collect::<Result<_, _>>()?;
            let own = &self.secondary.surface;
            let secondary: NurbsSurface =
                motion.map_or_else(|| own.clone(), |motion| own.transformed(motion));
            Ok(Shape { secondary, rails })
        };
        std::iter::once(None).chain(motions.iter().map(Some)).map(place).collect()
    }
}

impl Blended {
    fn measures(&self) -> LineMeasures {
        LineMeasures {
            length: self.line.length,
            closed: self.line.closure == Closure::Closed,
            deviation: self.line.deviation,
            slices: self.line.slices.into(),
            radius: self.radius,
            ball: self.law.mean(),
            sections: self.rolled.sections,
            contact_deviation: self.rolled.deviation,
            angle: self.rolled.angle.to_degrees(),
        }
    }
}
