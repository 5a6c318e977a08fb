//! The words of a constrained scaling in a job file.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::job::file::LengthSetting;
use crate::job::file::selector::Selector;
use crate::model::Origin;
use crate::model::origin::ParseOriginError;

/// Scale faces, while held loops keep their shape and size and move rigidly.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConstrainedScale {
    /// Factors along the three axes, all positive.
    pub factors: Factors,
    /// Fixed point of the scaling. Left out: the origin.
    #[serde(default)]
    pub center: Option<[LengthSetting; 3]>,
    /// Directions of the three axes, orthonormal and right-handed. Left out: the coordinate axes.
    #[serde(default)]
    pub axes: Option<Axes>,
    /// Faces to scale. Left out: the whole part.
    #[serde(default)]
    pub face: Option<Selector>,
    /// Features that keep their shape and size, with all that hangs on them. Left out: none, and the scaling is plain.
    #[serde(default)]
    pub hold: Vec<Hold>,
    /// Faces that must stay scaled: a hold that spreads to one is refused. Left out: none.
    #[serde(default)]
    pub stop: Option<Selector>,
    /// What becomes of the walls between the ends of a held feature.
    #[serde(default)]
    pub wall: Wall,
    /// How the loops are held.
    #[serde(default)]
    pub mode: HoldMode,
    /// With `mode = "axes"`: the axes along which the size is held.
    #[serde(default)]
    pub held_axes: Vec<Axis>,
    /// How a held feature may move to keep the surface fair.
    #[serde(default)]
    pub motion: Motion,
    /// Rows of the natural border that follow the scaling exactly: 0 position, 1 tangent, 2 curvature.
    #[serde(default)]
    pub continuity: Continuity,
    /// The energy that is made small.
    #[serde(default)]
    pub energy: Energy,
}

impl ConstrainedScale {
    /// Refuses keys that contradict each other.
    pub(in crate::job) fn check(&self) -> Result<(), &'static str> {
        match (self.mode, self.held_axes.is_empty()) {
            (HoldMode::Axes, true) => Err("`mode = \"axes\"` needs `held_axes`, such as [\"x\", \"y\"]"),
            (HoldMode::Rigid | HoldMode::Pinned, false) => Err("`held_axes` needs `mode = \"axes\"`"),
            _ => Ok(()),
        }
    }
}

/// Factors beyond this or below its inverse are slips: coordinates would lose the digits that tell points apart.
const GREATEST_FACTOR: f64 = 1e6;

/// Three positive factors, within a million either way.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "[f64; 3]")]
#[schemars(with = "[f64; 3]")]
pub struct Factors(pub [f64; 3]);

impl TryFrom<[f64; 3]> for Factors {
    type Error = String;
    fn try_from(factors: [f64; 3]) -> Result<Self, String> {
        match factors.iter().find(|f| !(1.0 / GREATEST_FACTOR..=GREATEST_FACTOR).contains(*f)) {
            Some(factor) => Err(format!(
                "{factor:e} is not a factor; expected a positive number from {} to {GREATEST_FACTOR}",
                1.0 / GREATEST_FACTOR
            )),
            None => Ok(Self(factors)),
        }
    }
}

/// Three directions of length 1, at right angles to each other, right-handed.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "[[f64; 3]; 3]")]
#[schemars(with = "[[f64; 3]; 3]")]
pub struct Axes(pub [[f64; 3]; 3]);

/// Greatest deviation of a length from 1 and of a cosine from 0: what the operation accepts, directions typed with
/// nine decimals.
const ORTHONORMAL: f64 = 1e-8;

impl TryFrom<[[f64; 3]; 3]> for Axes {
    type Error = String;
    fn try_from(axes: [[f64; 3]; 3]) -> Result<Self, String> {
        let dot = |a: usize, b: usize| (0..3).map(|k| axes[a][k] * axes[b][k]).sum::<f64>();
        // Comparisons with NaN are false: what is not near is far.
        let near = |value: f64, goal: f64| (value - goal).abs() <= ORTHONORMAL;
        for axis in 0..3 {
            if !near(dot(axis, axis), 1.0) {
                let length = dot(axis, axis).sqrt();
                return Err(format!("axis {axis} (from 0) has the length {length}, expected 1"));
            }
        }
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            if !near(dot(a, b), 0.0) {
                let angle = dot(a, b).clamp(-1.0, 1.0).acos().to_degrees();
                return Err(format!(
                    "axes {a} and {b} (from 0) make an angle of {angle} degrees, expected 90"
                ));
            }
        }
        let [x, y, z] = axes;
        let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
        if cross.iter().zip(z).map(|(c, z)| c * z).sum::<f64>() < 0.0 {
            return Err("the axes are left-handed; turn the last one round".to_owned());
        }
        Ok(Self(axes))
    }
}

/// An axis of the scaling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// How a loop is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HoldMode {
    /// Shape and size; it turns with the surface and moves with the part.
    #[default]
    Rigid,
    /// Shape, size, direction and place.
    Pinned,
    /// Size along the axes that `held_axes` names; along the others it scales.
    Axes,
}

/// Freedom of a held feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Along its own axis.
    #[default]
    Normal,
    /// In any direction.
    Free,
}

/// Energy and what the surface is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Energy {
    /// Thin plate against the scaled surface under the slip of the held features.
    #[default]
    Slide,
    /// The published formulation, for comparison.
    Published,
}

/// Order of continuity at the natural border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(try_from = "u64")]
#[schemars(with = "u64", extend("enum" = [0, 1, 2]))]
pub enum Continuity {
    /// 0.
    Position,
    /// 1.
    #[default]
    Tangent,
    /// 2.
    Curvature,
}

impl TryFrom<u64> for Continuity {
    type Error = String;
    fn try_from(order: u64) -> Result<Self, String> {
        match order {
            0 => Ok(Self::Position),
            1 => Ok(Self::Tangent),
            2 => Ok(Self::Curvature),
            _ => Err(format!("{order} is not a continuity; expected 0, 1 or 2")),
        }
    }
}

/// What becomes of walls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wall {
    /// They keep their lengths, and with them the thickness of the material at the feature. Between two planes that the
    /// scaling moves apart the longest straight wall is made longer, with a warning.
    #[default]
    Rigid,
    /// As rigid, but two planes that the scaling moves apart are refused.
    Strict,
    /// They keep their cross-section and are made longer: the material is as thick as the scaling makes it.
    Slide,
}

/// A feature to hold.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(try_from = "HoldKeys")]
#[schemars(with = "HoldKeys")]
pub enum Hold {
    /// All inner loops of some faces.
    Inner(InnerLoops),
    /// The inner loop nearest to a point.
    Near([LengthSetting; 3]),
    /// The inner loop of that number on the only face in scope, from 0.
    Index(usize),
    /// The inner loop that uses an edge: `"#1042"`, `"D43/5"`.
    Edge(Origin),
    /// Faces, with what hangs on them.
    Face(Selector),
}

/// Which inner loops.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InnerLoops {
    /// Faces that bear them; all faces in scope when left out.
    pub on: Option<Selector>,
    /// Greatest width.
    pub up_to: Option<LengthSetting>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[derive(Default)]
#[schemars(rename = "Hold", extend("minProperties" = 1, "maxProperties" = 3))]
struct HoldKeys {
    /// A set of loops.
    loops: Option<LoopSet>,
    /// With `loops`: the faces that bear them. Left out: all faces in scope.
    on: Option<Selector>,
    /// With `loops`: only those that fit into a sphere of this diameter round their centre.
    up_to: Option<LengthSetting>,
    /// The inner loop nearest to this point.
    near: Option<[LengthSetting; 3]>,
    /// The inner loop of this number on the only face in scope, counted from 0.
    index: Option<usize>,
    /// The inner loop that uses this edge, by its record: `"#1042"`, `"D43/5"`.
    edge: Option<String>,
    /// Faces that are held, with all that hangs on them up to the inner loops of other faces.
    face: Option<Selector>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum LoopSet {
    /// All inner loops: those that bound holes, bosses and pockets.
    Inner,
}

impl TryFrom<HoldKeys> for Hold {
    type Error = String;
    fn try_from(keys: HoldKeys) -> Result<Self, String> {
        let HoldKeys { loops, on, up_to, near, index, edge, face } = keys;
        if loops.is_none() && (on.is_some() || up_to.is_some()) {
            return Err("`on` and `up_to` need `loops = \"inner\"`".to_owned());
        }
        match (loops, near, index, edge, face) {
            (Some(LoopSet::Inner), None, None, None, None) => Ok(Self::Inner(InnerLoops { on, up_to })),
            (None, Some(point), None, None, None) => Ok(Self::Near(point)),
            (None, None, Some(index), None, None) => Ok(Self::Index(index)),
            (None, None, None, Some(edge), None) => {
                edge.parse().map(Self::Edge).map_err(|error: ParseOriginError| error.to_string())
            }
            (None, None, None, None, Some(face)) => Ok(Self::Face(face)),
            _ => Err("expected exactly one of the keys `loops`, `near`, `index`, `edge`, `face`".to_owned()),
        }
    }
}
