//! Pasting onto a surface that closes on itself: the surface is cut open elsewhere, so that the place lies in its
//! middle, and put together again afterwards with the cut where it was.
//!
//! Control points off the feature are those of the target over the new knots, to the bit; those on the seam are written
//! at both ends, so that the surface stays closed.

use super::base::with_net;
use super::settings::{Feature, Ground, Method, Pasted, Settings};
use super::{PasteError, paste};
use crate::geometry::nurbs::{KnotVector, NurbsSurface};
use crate::ops::net::Mask;

/// What came of a place: the result, and the parameters that it acts on, which may reach past the domain.
#[derive(Debug, Clone)]
pub(super) struct Crossed {
    pub pasted: Pasted,
    pub region: [(f64, f64); 2],
}

/// Part of a period by which a cut may miss the place opposite.
const NEARLY: f64 = 0.05;
/// Part of a period within which two knots are one.
const SAME_KNOT: f64 = 1e-10;

/// Pastes onto a surface that closes on itself in the given directions, across its seam where that is needed.
///
/// # Errors
/// As [`paste`]; those of the attempt that leaves the seam alone, when none succeeds.
pub(super) fn paste_across(
    feature: &Feature<'_>,
    ground: &Ground<'_>,
    settings: &Settings,
    round: [bool; 2],
) -> Result<Crossed, PasteError> {
    let plain = paste(feature, ground, settings);
    let cut_off = match &plain {
        Ok(pasted) => pasted.lost > 0 && pasted.lost_detail > 0.0,
        Err(error) => matches!(error, PasteError::OutsideTarget { .. } | PasteError::RegionTooSmall { .. }),
    };
    if cut_off && round != [false; 2] {
        let target = raised(feature.source, ground.target, settings)?;
        let directions: Vec<usize> = (0..2).filter(|&k| round[k]).collect();
        let turned = turned(feature, &Ground { target: &target, at: ground.at }, settings, &directions);
        match (&plain, turned) {
            (Ok(plain), Ok(turned)) if turned.pasted.lost_detail < plain.lost_detail => return Ok(turned),
            (Err(_), Ok(turned)) => return Ok(turned),
            _ => {}
        }
    }
    plain.map(|pasted| Crossed { region: region_of(&pasted), pasted })
}

/// Parameters that the changed control points act on; where none has changed, a corner, which overlaps nothing.
pub(super) fn region_of(pasted: &Pasted) -> [(f64, f64); 2] {
    let knots = [pasted.surface.knots_u(), pasted.surface.knots_v()];
    let corner = || knots.map(|along| (along.domain().0, along.domain().0));
    pasted.changed.support(knots).unwrap_or_else(corner)
}

/// The target in the degrees that the result will have.
fn raised(
    source: &NurbsSurface,
    target: &NurbsSurface,
    settings: &Settings,
) -> Result<NurbsSurface, PasteError> {
    let least = |s: &KnotVector| match settings.chosen_method() {
        Ok(Method::Fit) => s.degree().min(super::fit::DEGREE),
        _ => s.degree(),
    };
    let (u, v) = (target.knots_u(), target.knots_v());
    let degrees = (least(source.knots_u()).max(u.degree()), least(source.knots_v()).max(v.degree()));
    Ok(target.clamped().elevated(degrees.0, degrees.1)?)
}

fn turned(
    feature: &Feature<'_>,
    ground: &Ground<'_>,
    settings: &Settings,
    directions: &[usize],
) -> Result<Crossed, PasteError> {
    let Some((&k, rest)) = directions.split_first() else {
        let pasted = paste(feature, ground, settings)?;
        return Ok(Crossed { region: region_of(&pasted), pasted });
    };
    // All turning is done along `u`.
    let swap = |s: &NurbsSurface| if k == 0 { s.clone() } else { s.swapped() };
    let upright = swap(ground.target);
    let Some(cut) = Cut::opposite(&upright, ground.at[k])? else {
        return turned(feature, ground, settings, rest);
    };
    let mut at = ground.at;
    at[k] = cut.home(at[k]);
    let inner = turned(feature, &Ground { target: &swap(&cut.surface), at }, settings, rest)?;
    let Crossed { pasted, region } = inner;
    let (surface, refined, changed) = cut.closed(
        &upright,
        &swap(&pasted.surface),
        &swap(&pasted.refined),
        &if k == 0 { pasted.changed.clone() } else { pasted.changed.transposed() },
    )?;
    let changed = if k == 0 { changed } else { changed.transposed() };
    let (surface, refined) = (swap(&surface), swap(&refined));
    Ok(Crossed { pasted: Pasted { surface, refined, changed, offset: None, ..pasted }, region })
}

/// A surface that closed along `u`, cut open at another parameter.
struct Cut {
    /// Over the domain from the cut to a period behind it.
    surface: NurbsSurface,
    /// The old domain.
    domain: (f64, f64),
    /// Where it is cut now.
    cut: f64,
}

impl Cut {
    /// Cuts half a period away from `middle`; `None` where it is cut already.
    fn opposite(surface: &NurbsSurface, middle: f64) -> Result<Option<Self>, PasteError> {
        let (start, end) = surface.knots_u().domain();
        let period = end - start;
        let wanted = start + (middle + 0.5 * period - start).rem_euclid(period);
        // A knot that is there already is cut at no cost.
        let knots = surface.knots_u();
        let near = knots.distinct().0.into_iter().filter(|k| *k > start && *k < end);
        let slack = NEARLY * period;
        if wanted - start <= slack || end - wanted <= slack {
            return Ok(None);
        }
        let known = near.filter(|k| (k - wanted).abs() <= slack);
        let cut = known.min_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs())).unwrap_or(wanted);
        let p = knots.degree();
        let lacking = p.saturating_sub(knots.multiplicity(cut));
        let opened = surface.refined_u(&vec![cut; lacking])?;
        let all = opened.knots_u().knots();
        let columns = opened.shape().1;
        let first = all.partition_point(|k| *k < cut);
        // The row whose function is 1 at the cut.
        let row = first - 1;
        let net = opened.net();
        // The seam's points stand once, so that both ends must say the same.
        let agree = |j: usize| {
            let (a, b) = (net[j][3], net[net.len() - columns + j][3]);
            (a - b).abs() <= SAME_KNOT * a
        };
        if !(0..columns).all(agree) {
            let reach = (start, end);
            return Err(PasteError::OutsideTarget { direction: "u", reach, domain: reach });
        }
        let mut points = net[row * columns..].to_vec();
        // The seam's row stands once.
        points.extend_from_slice(&net[columns..(row + 1) * columns]);
        let mut values = vec![cut; p + 1];
        values.extend(all[first + p..].iter().take_while(|k| **k < end));
        values.extend(std::iter::repeat_n(end, p));
        let moved = all.iter().filter(|k| **k > start && **k < cut).map(|k| k + period);
        values.extend(moved);
        values.extend(std::iter::repeat_n(cut + period, p + 1));
        let knots = KnotVector::new(p, values)?;
        let surface = NurbsSurface::new(knots, opened.knots_v().clone(), points)
            .map_err(|_| PasteError::SingularSystem { unknowns: opened.net().len() })?;
        Ok(Some(Self { surface, domain: (start, end), cut }))
    }

    fn home(&self, x: f64) -> f64 {
        if x < self.cut { x + (self.domain.1 - self.domain.0) } else { x }
    }

    /// The original with the knots of the result, and with its changed control points.
    fn closed(
        &self,
        original: &NurbsSurface,
        surface: &NurbsSurface,
        refined: &NurbsSurface,
        changed: &Mask,
    ) -> Result<(NurbsSurface, NurbsSurface, Mask), PasteError> {
        let (start, end) = self.domain;
        let period = end - start;
        let back = |x: f64| if x > end { start.max(x - period) } else { x };
        let more_u: Vec<f64> =
            added(self.surface.knots_u(), refined.knots_u()).into_iter().map(back).collect();
        let more_v = added(original.knots_v(), refined.knots_v());
        let whole = original.refined_u(&more_u)?.refined_v(&more_v)?;
        let (rows, columns) = whole.shape();
        let p = refined.knots_u().degree();
        let n_turned = refined.shape().0;
        // The row of the turned net whose function is 1 at the old seam.
        let slack = SAME_KNOT * period;
        let seam = refined.knots_u().knots().partition_point(|k| *k < end - slack) - 1;
        let mut net = whole.net().to_vec();
        let mut mask = Mask::empty(rows, columns);
        let all_round =
            PasteError::OutsideTarget { direction: "u", reach: (start, end), domain: (start, end) };
        for at in changed.indices() {
            let (i, j) = (at / columns, at % columns);
            // Rows at the cut are not those of the original.
            if i < p || i + p >= n_turned {
                return Err(all_round);
            }
            let before = (i <= seam).then(|| (rows - 1 + i).checked_sub(seam)).flatten();
            let behind = (i >= seam).then(|| i - seam);
            for row in [before, behind].into_iter().flatten().filter(|row| *row < rows) {
                net[row * columns + j] = surface.net()[at];
                mask.insert(row, j);
            }
        }
        let surface = with_net(&whole, net)?;
        Ok((surface, whole, mask))
    }
}

/// Knots that the second has and the first lacks, with multiplicity.
fn added(before: &KnotVector, after: &KnotVector) -> Vec<f64> {
    let (start, end) = after.domain();
    let slack = SAME_KNOT * (end - start);
    let mut old = before.knots().iter().peekable();
    let mut more = Vec::new();
    for &knot in after.knots() {
        match old.peek() {
            Some(&&known) if (known - knot).abs() <= slack => {
                old.next();
            }
            _ => more.push(knot),
        }
    }
    more
}
