//! The job file's words for `kind = "simplify"`.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::job::file::paste::Margin;
use crate::job::file::selector::Selector;
use crate::job::file::{LengthSetting, Operation};
use crate::job::operate::OperateError;
use crate::job::operate::select;
use crate::model::Model;
use crate::ops::simplify::plan::{Params, Plan, plan};
use crate::units::Length;

/// Remove knots of a B-spline face that it can do without, within a certified distance.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Simplify {
    /// The face. Left out: the only one.
    #[serde(default)]
    pub face: Option<Selector>,
    /// Greatest distance from the old surface.
    pub tolerance: LengthSetting,
    /// Rows and columns at the border of the net that stay: 1 keeps the border, 2 its tangents too.
    #[serde(default)]
    pub margin: Margin,
}

impl Simplify {
    /// The words as an operation.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(in crate::job) fn operation(self) -> Result<Operation, String> {
        match self.tolerance.0 {
            Length::FileUnits(value) | Length::Metres(value) if value.is_finite() && value > 0.0 => {
                Ok(Operation::Simplify(self))
            }
            Length::FileUnits(value) | Length::Metres(value) => {
                Err(format!("`tolerance` is {value}; expected a positive length"))
            }
        }
    }

    /// Plans it on a model.
    pub(in crate::job) fn planned(&self, model: &Model) -> Result<Plan, OperateError> {
        let face = select::one_face(model, self.face.as_ref()).map_err(OperateError::Face)?;
        let tolerance = self.tolerance.0.in_unit(&model.context_of(face).length);
        Ok(plan(model, &Params { face, tolerance, margin: self.margin.0 })?)
    }
}
