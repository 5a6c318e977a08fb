//! From the words of a constrained scaling to its plan for a model.

use crate::brep::{EdgeId, FaceId, LoopId};
use crate::job::file::scale as words;
use crate::job::file::scale::ConstrainedScale;
use crate::job::file::selector::Selector;
use crate::job::operate::OperateError;
use crate::job::operate::select::{self, point_in};
use crate::math::{Matrix3, Point3, Vector3};
use crate::model::{Model, Origin};
use crate::ops::constrained_scale::plan::{
    HoldTarget, LoopFilter, Params, Plan, Scope, Wall, inner_loops, plan,
};
use crate::ops::constrained_scale::{Continuity, Energy, Freedom, Hold, Scaling};
use crate::units::LengthUnit;

/// Plans a constrained scaling.
///
/// # Errors
/// [`OperateError`]; the model is as before in every case.
pub(in crate::job) fn planned(model: &Model, settings: &ConstrainedScale) -> Result<Plan, OperateError> {
    Ok(plan(model, &params(model, settings)?)?)
}

fn params(model: &Model, settings: &ConstrainedScale) -> Result<Params, OperateError> {
    let (scope, faces) = match &settings.face {
        Some(selector) => {
            let faces = select::faces(model, selector).map_err(OperateError::Face)?;
            (Scope::Faces(faces.clone()), faces)
        }
        None => (Scope::Part, model.brep.faces.ids().collect()),
    };
    let first = *faces.first().ok_or(OperateError::NoFace)?;
    let unit = &model.context_of(first).length;
    let mut hold = Vec::new();
    for wanted in &settings.hold {
        hold.push(target(model, &faces, wanted, unit)?);
    }
    let stop = settings.stop.as_ref().map(|selector| chosen(model, "stop", selector)).transpose()?;
    let wall = match settings.wall {
        words::Wall::Rigid => Wall::Rigid,
        words::Wall::Strict => Wall::Strict,
        words::Wall::Slide => Wall::Slide,
    };
    Ok(Params {
        scaling: scaling(settings, unit),
        scope,
        hold,
        mode: mode(settings),
        wall,
        stop: stop.unwrap_or_default(),
    })
}

fn scaling(settings: &ConstrainedScale, unit: &LengthUnit) -> Scaling {
    let mut scaling = Scaling::new(settings.factors.0);
    if let Some(center) = &settings.center {
        scaling.center = point_in(center, unit);
    }
    if let Some(axes) = &settings.axes {
        scaling.axes = Matrix3::from_columns(&axes.0.map(Vector3::from));
    }
    scaling.continuity = match settings.continuity {
        words::Continuity::Position => Continuity::Position,
        words::Continuity::Tangent => Continuity::Tangent,
        words::Continuity::Curvature => Continuity::Curvature,
    };
    scaling.energy = match settings.energy {
        words::Energy::Slide => Energy::Slide,
        words::Energy::Published => Energy::Published,
    };
    scaling.freedom = match settings.motion {
        words::Motion::Normal => Freedom::Normal,
        words::Motion::Free => Freedom::Free,
    };
    scaling
}

fn mode(settings: &ConstrainedScale) -> Hold {
    match settings.mode {
        words::HoldMode::Rigid => Hold::Rigid,
        words::HoldMode::Pinned => Hold::Pinned(None),
        words::HoldMode::Axes => Hold::Axes(
            [words::Axis::X, words::Axis::Y, words::Axis::Z].map(|axis| settings.held_axes.contains(&axis)),
        ),
    }
}

fn target(
    model: &Model,
    faces: &[FaceId],
    hold: &words::Hold,
    unit: &LengthUnit,
) -> Result<HoldTarget, OperateError> {
    match hold {
        words::Hold::Inner(wanted) => {
            let on = wanted.on.as_ref().map(|selector| chosen(model, "on", selector)).transpose()?;
            let up_to = wanted.up_to.map(|length| length.0.in_unit(unit));
            Ok(HoldTarget::InnerLoops(LoopFilter { on, up_to }))
        }
        words::Hold::Face(selector) => Ok(HoldTarget::Faces(chosen(model, "face", selector)?)),
        words::Hold::Near(point) => {
            let at = point_in(point, unit);
            let loops = faces.iter().flat_map(|&face| inner_loops(model, face));
            let nearest = loops.min_by(|&a, &b| {
                distance_to_loop(model, a, &at).total_cmp(&distance_to_loop(model, b, &at)).then(a.cmp(&b))
            });
            nearest
                .map(HoldTarget::Loop)
                .ok_or_else(|| OperateError::Hold("the faces have no inner loop".to_owned()))
        }
        words::Hold::Index(index) => by_index(model, faces, *index),
        words::Hold::Edge(name) => by_edge(model, faces, *name),
    }
}

fn chosen(model: &Model, key: &str, selector: &Selector) -> Result<Vec<FaceId>, OperateError> {
    select::faces(model, selector).map_err(|error| OperateError::Hold(format!("{key}: {error}")))
}

fn by_index(model: &Model, faces: &[FaceId], index: usize) -> Result<HoldTarget, OperateError> {
    let [face] = faces else {
        return Err(OperateError::Hold(format!(
            "`index` needs one face in scope, and there are {}",
            faces.len()
        )));
    };
    let loops = inner_loops(model, *face);
    let Some(&found) = loops.get(index) else {
        let count = loops.len();
        return Err(OperateError::Hold(format!(
            "the face has {count} inner loops, counted from 0; found {index}"
        )));
    };
    Ok(HoldTarget::Loop(found))
}

fn by_edge(model: &Model, faces: &[FaceId], origin: Origin) -> Result<HoldTarget, OperateError> {
    let edges = |face: FaceId| model.brep.coedges_of(face).map(|c| (c, model.brep.coedges[c].edge));
    let names = |(coedge, edge)| {
        let oriented = model.origins.coedges[coedge] == origin;
        let found: Option<EdgeId> = (oriented || model.origins.edges[edge] == origin).then_some(edge);
        found
    };
    let found = faces.iter().flat_map(|&face| edges(face)).find_map(names);
    found
        .map(HoldTarget::Edge)
        .ok_or_else(|| OperateError::Hold(format!("no edge of the faces in scope is `{origin}`")))
}

/// Distance of a point from the middle of a loop's vertices and curve points: of two loops, the one
/// around the point is the nearer.
fn distance_to_loop(model: &Model, of: LoopId, at: &Point3<f64>) -> f64 {
    let brep = &model.brep;
    let mut sum = Vector3::zeros();
    let mut count = 0.0;
    for &coedge in &brep.loops[of].coedges {
        let edge = brep.coedges[coedge].edge;
        for point in crate::brep::sample_edge(brep, edge, &EDGE_SAMPLING).unwrap_or_default() {
            sum += point.point.coords;
            count += 1.0;
        }
    }
    if count > 0.0 { (Point3::from(sum / count) - at).norm() } else { f64::INFINITY }
}

/// Enough to tell loops apart.
const EDGE_SAMPLING: crate::brep::EdgeSampling =
    crate::brep::EdgeSampling { chord: f64::INFINITY, per_span: 8 };
