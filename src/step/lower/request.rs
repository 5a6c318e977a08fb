//! Requests for new content of records, gathered before any of them is decided.

use super::super::exchange_structure::InstanceName;
use crate::geometry::{Curve, Curve2d};
use crate::math::Frame;
use crate::source::Span;

/// A reference token in the file, and the content that whatever stands behind it shall have.
#[derive(Debug, Clone)]
pub(super) struct Request<T> {
    /// The reference `#n` as it stands in the user's record.
    pub(super) token: Span,
    /// What it shall refer to.
    pub(super) content: T,
}

/// Requests of one level, each with the record that its token names now.
#[derive(Debug, Clone)]
pub(super) struct Requests<T>(Vec<(InstanceName, Request<T>)>);

impl<T> Default for Requests<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: PartialEq> Requests<T> {
    /// Adds a request.
    pub(super) fn add(&mut self, target: InstanceName, token: Span, content: T) {
        self.0.push((target, Request { token, content }));
    }

    /// Takes all requests in order of record and token, each token once.
    ///
    /// # Errors
    /// The record whose token asks for two different things.
    pub(super) fn take(&mut self) -> Result<Vec<(InstanceName, Request<T>)>, InstanceName> {
        let mut all = std::mem::take(&mut self.0);
        all.sort_by_key(|(target, request)| (*target, request.token));
        let contested = all
            .windows(2)
            .find(|pair| pair[0].1.token == pair[1].1.token && pair[0].1.content != pair[1].1.content);
        if let Some(pair) = contested {
            return Err(pair[0].0);
        }
        all.dedup_by(|later, earlier| later.1.token == earlier.1.token);
        Ok(all)
    }
}

/// Requests for one record grouped by equal content, in order of their first token.
pub(super) fn group_equal<T: PartialEq>(requests: &[(InstanceName, Request<T>)]) -> Vec<(&T, Vec<Span>)> {
    let mut groups: Vec<(&T, Vec<Span>)> = Vec::new();
    for (_, request) in requests {
        match groups.iter_mut().find(|(content, _)| **content == request.content) {
            Some((_, tokens)) => tokens.push(request.token),
            None => groups.push((&request.content, vec![request.token])),
        }
    }
    groups
}

/// New content of a curve, with what the model read before: equal parts keep their bytes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum NewCurve {
    /// In space.
    Space {
        /// As read.
        old: Option<Curve>,
        /// As wanted.
        new: Curve,
    },
    /// In the parameters of a surface.
    Plane {
        /// As read.
        old: Option<Curve2d>,
        /// As wanted, in the angles of the model.
        new: Curve2d,
    },
}

/// New content of a placement.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum NewPlacement {
    /// `AXIS2_PLACEMENT_3D`.
    Space {
        /// As read.
        old: Option<Frame>,
        /// As wanted.
        new: Frame,
    },
    /// `AXIS1_PLACEMENT`: origin and axis of the frame.
    Axis {
        /// As read.
        old: Option<Frame>,
        /// As wanted.
        new: Frame,
    },
}

/// Two or three coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Coordinates {
    /// In the plane.
    Two([f64; 2]),
    /// In space.
    Three([f64; 3]),
}

impl Coordinates {
    pub(super) fn as_slice(&self) -> &[f64] {
        match self {
            Self::Two(values) => values,
            Self::Three(values) => values,
        }
    }
}

/// New content of a `VECTOR`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NewVector {
    /// Unit direction.
    pub(super) direction: Coordinates,
    /// Length, positive.
    pub(super) magnitude: f64,
}
