//! Whether records of one file are rigid copies of records of another: the same kinds with the same numbers, but for
//! places and directions, which one motion carries from one to the other.

use std::collections::HashSet;

use super::super::exchange_structure::{ExchangeStructure, Instance, InstanceName, SimpleRecord};
use super::super::parameter::{Parameter, ParameterKind, Parameters};
use super::frame::placed;
use super::{MAX_DEPTH, ProofError, bits, curve_in_space};
use crate::math::{Affine, Matrix3, Point3, Vector3};

/// Records of two files under comparison.
pub struct RigidCopy<'a> {
    before: &'a ExchangeStructure,
    after: &'a ExchangeStructure,
    seen: HashSet<(InstanceName, InstanceName)>,
    points: Vec<[Point3<f64>; 2]>,
    directions: Vec<[Vector3<f64>; 2]>,
    lengths: Vec<[f64; 2]>,
}

/// How far records are from being rigid copies. Lengths are relative to the extent of the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// Points that were compared.
    pub points: usize,
    /// Greatest deviation of a moved point's coordinate.
    pub motion: f64,
    /// Greatest deviation of the distance of two points.
    pub distances: f64,
    /// Pairs of points behind that.
    pub pairs: usize,
    /// Greatest deviation of a moved unit direction's coordinate, and of a length of a vector relative to itself.
    pub directions: f64,
    /// Greatest deviation of `MᵀM` from the identity; infinite for a motion that mirrors.
    pub orthogonality: f64,
    /// What rounding of the coordinates themselves explains.
    pub rounding: f64,
}

impl Residuals {
    /// Greatest deviation accepted beside rounding.
    pub const ACCEPTED: f64 = 1e-12;

    /// Whether all are within what is accepted; what is not a number is not.
    #[must_use]
    pub fn are_accepted(&self) -> bool {
        let within = |x: f64, allowed: f64| x <= allowed;
        within(self.motion, Self::ACCEPTED + self.rounding)
            && within(self.distances, Self::ACCEPTED + self.rounding)
            && within(self.directions, Self::ACCEPTED)
            && within(self.orthogonality, Self::ACCEPTED)
    }
}

/// Points of which all pairs are compared; of more, an even choice.
const PAIRED: usize = 1500;
/// Roundings of a coordinate between the two files.
const ROUNDINGS: f64 = 8.0;

impl<'a> RigidCopy<'a> {
    /// Of records of two files; none yet.
    #[must_use]
    pub fn new(before: &'a ExchangeStructure, after: &'a ExchangeStructure) -> Self {
        let (points, directions, lengths) = (Vec::new(), Vec::new(), Vec::new());
        Self { before, after, seen: HashSet::new(), points, directions, lengths }
    }

    /// Compares two records and what they refer to, but for places and directions, which are gathered.
    ///
    /// # Errors
    /// [`ProofError`].
    pub fn add(&mut self, before: InstanceName, after: InstanceName) -> Result<(), ProofError> {
        self.records(before, after, 0)
    }

    fn records(&mut self, before: InstanceName, after: InstanceName, depth: usize) -> Result<(), ProofError> {
        if depth > MAX_DEPTH {
            return Err(ProofError::Endless(before));
        }
        let a = self.before.instance(before).ok_or(ProofError::Undefined(before))?;
        let b = self.after.instance(after).ok_or(ProofError::Undefined(after))?;
        // A curve on surfaces may stand on one side only: its curves in parameters are not the subject.
        match (curve_in_space(&a), curve_in_space(&b)) {
            (None, None) => {}
            (on_a, on_b) => return self.records(on_a.unwrap_or(before), on_b.unwrap_or(after), depth + 1),
        }
        if !self.seen.insert((before, after)) {
            return Ok(());
        }
        let different = |what| ProofError::Different { before, after, what };
        match (placed(self.before, &a)?, placed(self.after, &b)?) {
            (Some(old), Some(new)) => {
                let counts = |p: &super::frame::Placed| (p.points.len(), p.directions.len(), p.lengths.len());
                if counts(&old) != counts(&new) {
                    return Err(different("their kinds"));
                }
                self.points.extend(old.points.into_iter().zip(new.points).map(<[_; 2]>::from));
                self.directions.extend(old.directions.into_iter().zip(new.directions).map(<[_; 2]>::from));
                self.lengths.extend(old.lengths.into_iter().zip(new.lengths).map(<[_; 2]>::from));
                Ok(())
            }
            (None, None) => self.fields(&a, &b, depth),
            _ => Err(different("their kinds")),
        }
    }

    fn fields(&mut self, a: &Instance<'_>, b: &Instance<'_>, depth: usize) -> Result<(), ProofError> {
        let different = |what| ProofError::Different { before: a.name(), after: b.name(), what };
        let records: [Vec<SimpleRecord<'_>>; 2] = [a.records().collect(), b.records().collect()];
        if records[0].is_empty() {
            return Err(ProofError::Malformed(a.name()));
        }
        if records[0].len() != records[1].len() {
            return Err(different("their kinds"));
        }
        for (old, new) in records[0].iter().zip(&records[1]) {
            if !old.keyword().eq_ignore_ascii_case(new.keyword()) {
                return Err(different("their kinds"));
            }
            // What a spline says of its form and closedness is advice, and writers may leave it out.
            let advice = old.keyword().to_ascii_uppercase().windows(8).any(|w| w == b"B_SPLINE");
            self.lists(old.parameters(), new.parameters(), &Fields { a, b, advice }, depth)?;
        }
        Ok(())
    }

    fn lists(
        &mut self,
        mut old: Parameters<'_>,
        mut new: Parameters<'_>,
        of: &Fields<'_, '_>,
        depth: usize,
    ) -> Result<(), ProofError> {
        loop {
            match (old.next(), new.next()) {
                (Some(old), Some(new)) => self.parameters(&old, &new, of, depth)?,
                (None, None) => return Ok(()),
                _ => return Err(of.different("the length of a list")),
            }
        }
    }

    fn parameters(
        &mut self,
        old: &Parameter<'_>,
        new: &Parameter<'_>,
        of: &Fields<'_, '_>,
        depth: usize,
    ) -> Result<(), ProofError> {
        if depth > MAX_DEPTH {
            return Err(ProofError::Endless(of.a.name()));
        }
        match (old.kind(), new.kind()) {
            (ParameterKind::Reference, ParameterKind::Reference) => {
                let (Some(old), Some(new)) = (old.as_reference(), new.as_reference()) else {
                    return Err(ProofError::Malformed(of.a.name()));
                };
                self.records(old, new, depth + 1)
            }
            (ParameterKind::List, ParameterKind::List) | (ParameterKind::Typed, ParameterKind::Typed) => {
                let keyword = |p: &Parameter<'_>| p.keyword().unwrap_or_default().to_ascii_uppercase();
                let (Some(members), Some(others)) = (old.members(), new.members()) else {
                    return Err(ProofError::Malformed(of.a.name()));
                };
                if keyword(old) != keyword(new) {
                    return Err(of.different("the type of a value"));
                }
                self.lists(members, others, of, depth + 1)
            }
            // Names are not geometry.
            (ParameterKind::String, ParameterKind::String) => Ok(()),
            (ParameterKind::Enumeration, ParameterKind::Enumeration) => {
                let same = old.text().eq_ignore_ascii_case(new.text());
                if same || of.advice { Ok(()) } else { Err(of.different("a choice")) }
            }
            _ => match (bits(old), bits(new)) {
                (Some(x), Some(y)) if x == y => Ok(()),
                (Some(_), Some(_)) => Err(of.different("a number that a motion must not change")),
                _ if old.text() == new.text() && old.kind() != ParameterKind::Malformed => Ok(()),
                _ => Err(of.different("the kind of a value")),
            },
        }
    }

    /// How far what was gathered is from being carried by a motion.
    #[must_use]
    pub fn residuals(&self, motion: &Affine) -> Residuals {
        let extent = self.extent();
        let magnitude = self.points.iter().flatten().map(|p| p.coords.amax()).fold(0.0, f64::max);
        let scale = if extent > 0.0 { extent } else { 1.0 };
        let off = |[p, q]: &[Point3<f64>; 2]| (motion.point(p) - q).amax() / scale;
        let turned = |[d, e]: &[Vector3<f64>; 2]| (motion.vector(d) - e).amax();
        let longer = |[a, b]: &[f64; 2]| (b - a).abs() / a.abs().max(f64::MIN_POSITIVE);
        let gram = motion.linear.transpose() * motion.linear - Matrix3::identity();
        let (distances, pairs) = self.distances(scale);
        Residuals {
            points: self.points.len(),
            motion: self.points.iter().map(off).fold(0.0, greater),
            distances,
            pairs,
            directions: self
                .directions
                .iter()
                .map(turned)
                .chain(self.lengths.iter().map(longer))
                .fold(0.0, greater),
            orthogonality: if motion.keeps_orientation() { gram.amax() } else { f64::INFINITY },
            rounding: ROUNDINGS * f64::EPSILON * magnitude / scale,
        }
    }

    fn extent(&self) -> f64 {
        crate::math::BoundingBox::of(self.points.iter().map(|[p, _]| p)).diagonal()
    }

    /// Greatest relative deviation in the matrix of distances, and how many of its entries were looked at.
    fn distances(&self, scale: f64) -> (f64, usize) {
        let stride = self.points.len().div_ceil(PAIRED).max(1);
        let chosen: Vec<&[Point3<f64>; 2]> = self.points.iter().step_by(stride).collect();
        let (mut worst, mut pairs) = (0.0, 0);
        for (k, [p, q]) in chosen.iter().enumerate() {
            for [r, s] in &chosen[..k] {
                worst = greater(worst, ((p - r).norm() - (q - s).norm()).abs() / scale);
                pairs += 1;
            }
        }
        (worst, pairs)
    }
}

/// Two records whose parameters are compared.
struct Fields<'a, 'b> {
    a: &'a Instance<'b>,
    b: &'a Instance<'b>,
    /// Whether choices are advice.
    advice: bool,
}

impl Fields<'_, '_> {
    fn different(&self, what: &'static str) -> ProofError {
        ProofError::Different { before: self.a.name(), after: self.b.name(), what }
    }
}

/// The greater of two numbers; not a number is greatest of all.
fn greater(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
