//! Points with labels, and what a reader collects on the way to them.

use super::CloudError;
use crate::math::{BoundingBox, Point3};

/// Points, perhaps with a label for each.
///
/// INVARIANT: at least one point, all finite; as many labels as points.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCloud {
    points: Vec<Point3<f64>>,
    labels: Option<Vec<i64>>,
    missing: usize,
}

/// Where a file has its labels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LabelColumn {
    /// The column of this name; capitals and a leading `scalar_`, as some programs write it, do not count.
    Named(String),
    /// The column of this number, from 1.
    Numbered(usize),
}

/// Most points of a cloud: their numbers have 32 bits.
pub const MOST_POINTS: u64 = u32::MAX as u64;

impl PointCloud {
    /// Points as they are; none may be infinite or NaN.
    ///
    /// # Errors
    /// [`CloudError::Empty`], [`CloudError::NotFinite`], [`CloudError::TooMany`].
    pub fn new(format: &'static str, points: Vec<Point3<f64>>) -> Result<Self, CloudError> {
        if let Some(at) = points.iter().position(|p| !finite(p)) {
            return Err(CloudError::NotFinite { format, place: format!("point {}", at + 1) });
        }
        check_count(format, points.len() as u64)?;
        Collected { points, ..Collected::default() }.finish()
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Their labels, when a column of them was asked for.
    #[must_use]
    pub fn labels(&self) -> Option<&[i64]> {
        self.labels.as_deref()
    }

    /// Count of points that the file itself marks as not measured; they are left out.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// Smallest box round the points.
    #[must_use]
    pub fn bounds(&self) -> BoundingBox {
        BoundingBox::of(&self.points)
    }

    /// The same cloud in other units.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        if factor.to_bits() != 1.0_f64.to_bits() {
            self.points.iter_mut().for_each(|p| *p *= factor);
        }
        self
    }

    /// The points whose label is one of some.
    ///
    /// # Errors
    /// [`CloudError::Empty`] when there is none, or no labels.
    pub fn with_labels(&self, wanted: &[i64]) -> Result<Self, CloudError> {
        let labels = self.labels.as_deref().unwrap_or_default();
        let kept = self.points.iter().zip(labels).filter(|(_, label)| wanted.contains(label));
        let (points, labels): (Vec<_>, Vec<_>) = kept.map(|(p, l)| (*p, *l)).unzip();
        Collected { points, labels: Some(labels), missing: self.missing }.finish()
    }

    /// Takes the points out.
    #[must_use]
    pub fn into_points(self) -> Vec<Point3<f64>> {
        self.points
    }
}

fn finite(point: &Point3<f64>) -> bool {
    point.iter().all(|c| c.is_finite())
}

/// # Errors
/// [`CloudError::TooMany`].
pub(super) fn check_count(format: &'static str, count: u64) -> Result<(), CloudError> {
    if count > MOST_POINTS {
        let why = "are counted".to_owned();
        return Err(CloudError::TooMany { format, count, limit: MOST_POINTS, why });
    }
    Ok(())
}

/// What to do with points that are not finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Missing {
    /// The format writes points that were not measured so: they are left out and counted.
    Skip,
    /// They are an error.
    Refuse,
}

/// What a reader has so far.
#[derive(Debug, Default)]
pub(super) struct Collected {
    pub points: Vec<Point3<f64>>,
    pub labels: Option<Vec<i64>>,
    pub missing: usize,
}

impl Collected {
    /// Room for a count that was checked against the size of the file.
    pub fn with_room(count: usize, labelled: Option<usize>) -> Self {
        let labels = labelled.map(|_| Vec::with_capacity(count));
        Self { points: Vec::with_capacity(count), labels, missing: 0 }
    }

    /// Takes a point.
    pub fn push(
        &mut self,
        format: &'static str,
        place: impl Fn() -> String,
        values: ([f64; 3], Option<f64>),
        missing: Missing,
    ) -> Result<(), CloudError> {
        let ([x, y, z], label) = values;
        let point = Point3::new(x, y, z);
        if !finite(&point) {
            if missing == Missing::Refuse {
                return Err(CloudError::NotFinite { format, place: place() });
            }
            self.missing += 1;
            return Ok(());
        }
        if let (Some(labels), Some(value)) = (&mut self.labels, label) {
            if value.fract() != 0.0 || value.abs() > GREATEST_LABEL {
                return Err(CloudError::Label { format, place: place(), value });
            }
            #[expect(clippy::cast_possible_truncation, reason = "a whole number in range")]
            labels.push(value as i64);
        }
        self.points.push(point);
        Ok(())
    }

    /// # Errors
    /// [`CloudError::Empty`].
    pub fn finish(self) -> Result<PointCloud, CloudError> {
        if self.points.is_empty() {
            return Err(CloudError::Empty);
        }
        Ok(PointCloud { points: self.points, labels: self.labels, missing: self.missing })
    }
}

/// Whole numbers up to here are exact in double precision.
const GREATEST_LABEL: f64 = 9_007_199_254_740_992.0;
