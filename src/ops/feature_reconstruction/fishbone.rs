//! Character lines of a feature: a backbone along it and ribs across, as heights of the cloud above the primary.

use super::backbone::Backbone;
use super::chord_sampling::sampled_by_chord;
use super::error::ReconstructionError;
use super::feet::Projector;
use super::path::Path;
use super::profile::{Pin, Profile};
use super::relief::Relief;
use crate::geometry::nurbs::NurbsSurface;
use crate::math::{Point3, Vector3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What lines are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FishboneSettings {
    /// Lines along the backbone, itself among them.
    pub along: usize,
    /// Ribs.
    pub ribs: usize,
}

/// A line over the metric plane with the heights of the cloud along it.
#[derive(Debug, Clone, PartialEq)]
pub struct CharacterLine {
    path: Path,
    profile: Profile,
}

/// A point of a character line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePoint {
    /// Parameters of its foot on the primary.
    pub at: [f64; 2],
    /// The point.
    pub to: Point3<f64>,
}

/// How well lines agree where they cross.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Crossings.
    pub crossings: usize,
    /// Greatest difference of the heights, each line by itself.
    pub before: f64,
    /// The same after the lines were made to agree.
    pub after: f64,
}

/// Lines along and across a feature.
#[derive(Debug, Clone)]
pub struct Fishbone {
    spine: Path,
    /// Part of the spine under the feature.
    range: [f64; 2],
    /// Length to both sides of the spine that the feature takes.
    width: [f64; 2],
    along: Vec<CharacterLine>,
    ribs: Vec<(f64, CharacterLine)>,
    /// Lines that had too few points.
    pub skipped: usize,
    /// Where lines cross.
    pub agreement: Agreement,
}

/// Places of the outer lines along the backbone, as a part of the half width.
const OUTER: f64 = 0.8;
/// Weight at a crossing, as a number of points.
const AT_CROSSING: f64 = 1000.0;
/// Half length in spacings over which the direction of the backbone is taken.
const HEADING: f64 = 10.0;
/// Share of the places at each end of the feature that is not counted.
const CUT: f64 = 0.005;
/// Steps of a dense line in spacings.
const DENSE: f64 = 0.25;
/// How much farther than the feature ribs go.
const OVER: f64 = 1.2;
/// Steps of a line beside the spine.
const STEPS: usize = 100;

impl Fishbone {
    /// Lines by the settings.
    ///
    /// # Errors
    /// [`ReconstructionError::NoCharacterLine`] when no line has points enough or the backbone has no length,
    /// [`ReconstructionError::LinesCross`] when two of them cross more than once.
    pub fn new(
        relief: &Relief,
        primary: &Projector,
        backbone: Backbone<'_>,
        settings: &FishboneSettings,
    ) -> Result<Self, ReconstructionError> {
        let none = || ReconstructionError::NoCharacterLine { least: super::profile::LEAST };
        let spine = backbone.path(relief, primary).ok_or_else(none)?;
        let located: Vec<(f64, f64)> = relief.places().par_iter().map(|p| spine.located(*p)).collect();
        let range = extent(located.iter().map(|place| place.0)).ok_or_else(none)?;
        let width = extent(located.iter().map(|place| place.1)).ok_or_else(none)?;
        let (along, ribs, agreement) = (Vec::new(), Vec::new(), Agreement::default());
        let mut fishbone = Self { spine, range, width, along, ribs, skipped: 0, agreement };
        for k in 0..settings.along {
            let path = fishbone.beside(fishbone.place_beside(k, settings.along)).ok_or_else(none)?;
            match relief.profile(&path, &[]) {
                Some(profile) => fishbone.along.push(CharacterLine { path, profile }),
                None => fishbone.skipped += 1,
            }
        }
        let stations = (0..settings.ribs).map(|k| graded(range, (k as f64 + 0.5) / settings.ribs as f64));
        fishbone.add_ribs(relief, &stations.collect::<Vec<_>>());
        if fishbone.along.is_empty() && fishbone.ribs.is_empty() {
            return Err(none());
        }
        fishbone.agree(relief)?;
        Ok(fishbone)
    }

    /// Offset of a line along the backbone.
    fn place_beside(&self, k: usize, count: usize) -> f64 {
        if count < 2 {
            return 0.0;
        }
        let share = 2.0 * k as f64 / (count - 1) as f64 - 1.0;
        let side = if share < 0.0 { -self.width[0] } else { self.width[1] };
        OUTER * share * side.max(0.0)
    }

    /// The line at a distance to the left of the spine.
    fn beside(&self, offset: f64) -> Option<Path> {
        let [low, high] = self.range;
        let at = |k: usize| {
            let s = low + (high - low) * k as f64 / STEPS as f64;
            let heading = self.spine.direction(s, 0.01 * (high - low));
            self.spine.at(s) + crate::math::Vector2::new(-heading.y, heading.x) * offset
        };
        Path::new((0..=STEPS).map(at))
    }

    /// The line across the spine at a place.
    fn across(&self, station: f64, spacing: f64) -> Option<Path> {
        let heading = self.spine.direction(station, HEADING * spacing);
        let left = crate::math::Vector2::new(-heading.y, heading.x);
        Path::new(self.width.map(|y| self.spine.at(station) + left * (OVER * y)))
    }

    fn add_ribs(&mut self, relief: &Relief, stations: &[f64]) {
        let rib = |station: &f64| {
            let path = self.across(*station, relief.spacing())?;
            let profile = relief.profile(&path, &[])?;
            Some((*station, CharacterLine { path, profile }))
        };
        let found: Vec<_> = stations.par_iter().map(rib).collect();
        self.skipped += found.iter().filter(|rib| rib.is_none()).count();
        self.ribs.extend(found.into_iter().flatten());
        self.ribs.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// Makes lines agree where they cross: both take the mean height.
    fn agree(&mut self, relief: &Relief) -> Result<(), ReconstructionError> {
        let mut pins = vec![Vec::new(); self.along.len() + self.ribs.len()];
        let met = self.crossings()?;
        let difference = |c: &Crossing| (c.heights[0] - c.heights[1]).abs();
        self.agreement = Agreement {
            crossings: met.len(),
            before: met.iter().map(difference).fold(0.0, f64::max),
            after: 0.0,
        };
        for crossing in &met {
            let height = 0.5 * (crossing.heights[0] + crossing.heights[1]);
            for k in 0..2 {
                let pin = Pin { along: crossing.places[k], height, weight: AT_CROSSING };
                pins[crossing.lines[k]].push(pin);
            }
        }
        let lines = self.along.iter_mut().chain(self.ribs.iter_mut().map(|rib| &mut rib.1));
        for (line, pins) in lines.zip(&pins).filter(|(_, pins)| !pins.is_empty()) {
            if let Some(profile) = relief.profile(&line.path, pins) {
                line.profile = profile;
            }
        }
        self.agreement.after = self.crossings()?.iter().map(difference).fold(0.0, f64::max);
        Ok(())
    }

    /// Where lines along and across meet.
    fn crossings(&self) -> Result<Vec<Crossing>, ReconstructionError> {
        let mut all = Vec::new();
        for (i, line) in self.along.iter().enumerate() {
            for (j, (_, rib)) in self.ribs.iter().enumerate() {
                let inside = |m: &super::path::Meeting| line.knows(m.here) && rib.knows(m.there);
                let met: Vec<_> = line.path.crossings(&rib.path).into_iter().filter(inside).collect();
                if met.len() > 1 {
                    let names = [format!("backbone line {}", i + 1), format!("rib {}", j + 1)];
                    return Err(ReconstructionError::LinesCross { names, times: met.len() });
                }
                all.extend(met.into_iter().map(|meeting| Crossing {
                    lines: [i, self.along.len() + j],
                    places: [meeting.here, meeting.there],
                    heights: [line.profile.value(meeting.here, 0), rib.profile.value(meeting.there, 0)],
                }));
            }
        }
        Ok(all)
    }

    /// All lines, those along the backbone first.
    pub fn lines(&self) -> impl Iterator<Item = &CharacterLine> {
        self.along.iter().chain(self.ribs.iter().map(|rib| &rib.1))
    }

    /// Lines along the backbone and ribs.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        [self.along.len(), self.ribs.len()]
    }

    /// Deviation of the points from the lines.
    #[must_use]
    pub fn scatter(&self) -> f64 {
        super::smoothing::median(self.lines().map(|line| line.profile.scatter).collect())
    }

    /// The fishbone with a rib more in the middle between two where the errors of the relief's points are over a limit;
    /// `None` when there is no such place or it is narrower than a slab.
    ///
    /// # Errors
    /// As [`Fishbone::new`].
    pub fn with_ribs_where(
        &self,
        relief: &Relief,
        errors: &[f64],
        limit: f64,
    ) -> Result<Option<Self>, ReconstructionError> {
        let located: Vec<f64> = relief.places().par_iter().map(|p| self.spine.located(*p).0).collect();
        let mut ends: Vec<f64> = self.ribs.iter().map(|rib| rib.0).collect();
        ends.insert(0, self.range[0]);
        ends.push(self.range[1]);
        let mut sums = vec![(0.0, 0.0); ends.len() - 1];
        for (place, error) in located.iter().zip(errors) {
            let k = ends.partition_point(|end| end <= place);
            if let Some(sum) = k.checked_sub(1).and_then(|k| sums.get_mut(k)) {
                *sum = (sum.0 + error, sum.1 + 1.0);
            }
        }
        let narrow = super::profile::LEAST as f64 * 0.25 * relief.spacing();
        let stations: Vec<f64> = ends
            .windows(2)
            .zip(sums)
            .filter(|(ends, (sum, count))| *sum > limit * count && ends[1] - ends[0] > narrow)
            .map(|(ends, _)| 0.5 * (ends[0] + ends[1]))
            .collect();
        let mut more = self.clone();
        more.add_ribs(relief, &stations);
        if more.ribs.len() == self.ribs.len() {
            return Ok(None);
        }
        more.agree(relief)?;
        Ok(Some(more))
    }
}

/// Two lines at one place.
struct Crossing {
    lines: [usize; 2],
    places: [f64; 2],
    heights: [f64; 2],
}

impl CharacterLine {
    fn knows(&self, along: f64) -> bool {
        let [low, high] = self.profile.range();
        (low..=high).contains(&along)
    }

    /// Points along the line that are enough: within `height` of their chords, which are no longer than `length`.
    #[must_use]
    pub fn sampled(
        &self,
        relief: &Relief,
        primary: &NurbsSurface,
        height: f64,
        length: f64,
    ) -> Vec<LinePoint> {
        let [low, high] = self.profile.range();
        let steps = (((high - low) / (DENSE * relief.spacing())).ceil() as usize).max(1);
        let point = |k: usize| {
            let along = low + (high - low) * k as f64 / steps as f64;
            let at = relief.metric().parameters(self.path.at(along).into());
            let normal = primary.normal(at[0], at[1]).unwrap_or_else(Vector3::zeros);
            LinePoint { at, to: primary.point(at[0], at[1]) + normal * self.profile.value(along, 0) }
        };
        let dense: Vec<LinePoint> = (0..=steps).map(point).collect();
        let places: Vec<Point3<f64>> = dense.iter().map(|p| p.to).collect();
        sampled_by_chord(&places, height, length).into_iter().map(|k| dense[k]).collect()
    }
}

/// Least and greatest value but for a few at each end; `None` without extent.
fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let mut all: Vec<f64> = values.collect();
    all.sort_unstable_by(f64::total_cmp);
    let cut = (CUT * all.len() as f64) as usize;
    let (low, high) = (*all.get(cut)?, *all.get((all.len() - 1).checked_sub(cut)?)?);
    (high > low).then_some([low, high])
}

/// A station at a share of a range, nearer to each other towards the ends.
fn graded([low, high]: [f64; 2], share: f64) -> f64 {
    let x = 2.0 * share - 1.0;
    0.5 * (low + high) + 0.5 * (high - low) * (0.55 * x + 0.45 * (0.5 * std::f64::consts::PI * x).sin())
}
