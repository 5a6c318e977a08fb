//! From the words of `detail_transfer` to the operation: curves are selected, the source's file is read, lengths
//! get their units.

use super::{select, select_curve};
use crate::job::file::detail::{
    CurveSelector, DetailScale, DetailTransfer, DirectionWord, EndsWord, FrameWord, LevelsSetting,
    OwnDetailWord,
};
use crate::job::file::selector::Selector;
use crate::job::library::detail::DetailFile;
use crate::job::operate::{OperateError, other_file};
use crate::model::Model;
use crate::ops::detail_transfer::{
    Direction, Existing, FaceTarget, Frame, LevelChoice, Params, Plan, Scale, Settings, Source, Spline,
    Target, plan,
};
use crate::units::LengthUnit;

/// Plans a transfer onto a model.
pub(in crate::job) fn planned(model: &Model, words: &DetailTransfer) -> Result<Plan, OperateError> {
    let select = |model: &Model, selector: Option<&CurveSelector>| select_curve::one(model, selector);
    let target = match &words.target.face {
        Some(face) => Target::Face(face_target(model, face, words)?),
        None => Target::Curve(select(model, words.target.curve.as_ref()).map_err(OperateError::TargetCurve)?),
    };
    let kept = words.source.detail.as_deref().map(saved).transpose()?;
    let other = words.source.file.as_deref().map(other_file).transpose()?;
    let from = other.as_ref().unwrap_or(model);
    let source = match &kept {
        Some((_, spline)) => Source::Spline(spline, words.source.detail.as_deref().unwrap_or_default()),
        None => {
            let curve = select(from, words.source.curve.as_ref()).map_err(OperateError::SourceCurve)?;
            Source::Curve(from, curve)
        }
    };
    let unit = match &target {
        Target::Face(target) => Some(&model.context_of(target.face).length),
        Target::Curve(_) => unit_of(model),
    };
    let metres = kept.as_ref().map(|(file, _)| file.metres_per_unit);
    let source_unit = match (unit, metres.or_else(|| unit_of(from).map(|unit| unit.metres))) {
        (Some(target), Some(metres)) => metres / target.metres,
        _ => 1.0,
    };
    let tolerance = match (words.tolerance, unit) {
        (Some(length), Some(unit)) => Some(length.0.in_unit(unit)),
        _ => None,
    };
    let params = Params {
        source,
        source_unit,
        target,
        part: words.interval.map(|part| part.0),
        tolerance,
        ends: words.ends.map(|ends| match ends {
            EndsWord::Free => 0,
            EndsWord::Position => 1,
            EndsWord::Tangent => 2,
            EndsWord::Curvature => 3,
        }),
        settings: settings(words),
    };
    Ok(plan(model, &params)?)
}

/// Detail of a library.
fn saved(file: &str) -> Result<(DetailFile, Spline), OperateError> {
    let fault = |reason: String| OperateError::DetailFile { file: file.to_owned(), reason };
    let text = std::fs::read_to_string(file).map_err(|error| fault(error.to_string()))?;
    let kept = DetailFile::read(&text).map_err(fault)?;
    let spline = kept.spline().map_err(fault)?;
    Ok((kept, spline))
}

fn face_target(model: &Model, face: &Selector, words: &DetailTransfer) -> Result<FaceTarget, OperateError> {
    Ok(FaceTarget {
        face: select::one_face(model, Some(face)).map_err(OperateError::TargetFace)?,
        direction: match words.target.direction.unwrap_or_default() {
            DirectionWord::U => Direction::U,
            DirectionWord::V => Direction::V,
        },
        across: words.target.across.map_or([0.0, 1.0], |part| part.0),
    })
}

/// Free curves are in the units of the file's first context, the only one that nearly all files have.
fn unit_of(model: &Model) -> Option<&LengthUnit> {
    model.contexts.first().map(|context| &context.length)
}

fn settings(words: &DetailTransfer) -> Settings {
    let local = words.frame == FrameWord::Local;
    Settings {
        levels: match &words.levels {
            LevelsSetting::All => LevelChoice::All,
            LevelsSetting::These(levels) => LevelChoice::These(levels.clone()),
        },
        gains: words.gain.0.clone(),
        frame: if local { Frame::Local } else { Frame::Global },
        scale: match words.scale {
            Some(DetailScale::Factor(factor)) => Scale::Factor(factor),
            Some(DetailScale::ArcLength) => Scale::ArcLength,
            None if local => Scale::ArcLength,
            None => Scale::Factor(1.0),
        },
        existing: match words.existing {
            OwnDetailWord::Keep => Existing::Keep,
            OwnDetailWord::Replace => Existing::Replace,
        },
        reverse: words.reverse,
        roll: words.roll.to_radians(),
        ..Settings::default()
    }
}
