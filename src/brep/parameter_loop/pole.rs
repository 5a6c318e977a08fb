//! Edges that end at a pole of the surface, pass through it, or turn quickly beside it.
//!
//! At a pole one parameter means nothing. An edge comes to it with the parameter that its points have in the limit; and
//! between the way in and the way out the loop goes along the pole's line, on the side where the face is.

use super::walk::{Place, Track, Walk};
use crate::geometry::parameters::unwrapped;

/// Part of a period by which a parameter may change from one place to the next without a look between.
const QUICK: f64 = 0.2;
/// Halvings between two places that a quick turn is followed over.
const MAX_DEPTH: u32 = 40;
/// Part of the way to the next place at which the limit at a pole is taken.
const NEAR_PART: f64 = 1e-4;
/// Tolerances that a limit is taken away from a pole: an edge may pass it by as much.
const CLEAR: f64 = 16.0;
/// Part of a period within which the way out of a pole is the way in.
const SAME_WAY: f64 = 1e-6;

impl Walk<'_> {
    /// Places with the parameters that poles have in the limit, twice where an edge passes through one, and with places
    /// between those from one of which to the next the parameter turns quickly.
    pub(super) fn settled(&self, track: Track<'_>, places: Vec<Place>) -> Vec<Place> {
        if !places.iter().any(Place::is_singular) && !places.windows(2).any(|pair| self.turns(pair)) {
            return places;
        }
        let followed = self.followed(track, &places);
        self.with_limits(track, &followed)
    }

    /// Whether a parameter changes by much from one place to the next, neither at a pole.
    fn turns(&self, pair: &[Place]) -> bool {
        let [a, b] = pair else { return false };
        let quick = |k: usize| self.periods[k].is_some_and(|p| (b.uv[k] - a.uv[k]).abs() > QUICK * p);
        !a.is_singular() && !b.is_singular() && (quick(0) || quick(1))
    }

    /// Places with others between those that a parameter turns quickly from one to the other, so that the turn is
    /// known; up to a pole, where the edge passes through one.
    fn followed(&self, track: Track<'_>, places: &[Place]) -> Vec<Place> {
        let Some(first) = places.first() else { return Vec::new() };
        let mut out = vec![*first];
        // What later places move by, once a turn has proved to be another.
        let mut moved = [0.0; 2];
        for pair in places.windows(2) {
            let mut next = pair[1];
            next.shift(moved);
            let from = out[out.len() - 1];
            if self.turns(&[from, next]) {
                self.follow(track, from, next, &mut out);
                let last = out[out.len() - 1];
                let before = next.uv;
                next.uv = [0, 1].map(|k| match self.periods[k] {
                    Some(period) if !last.singular[k] => unwrapped(before[k], last.uv[k], period),
                    _ => before[k],
                });
                moved = [0, 1].map(|k| moved[k] + next.uv[k] - before[k]);
            }
            out.push(next);
        }
        out
    }

    /// Appends the places between two, from the first on, that take a turn in small steps.
    fn follow(&self, track: Track<'_>, from: Place, to: Place, out: &mut Vec<Place>) {
        let mut ahead = vec![(to, 0)];
        let mut here = from;
        while let Some((next, depth)) = ahead.pop() {
            let mut next = next;
            if !here.singular[0] && !here.singular[1] {
                next.uv = [0, 1].map(|k| match self.periods[k] {
                    Some(period) if !next.singular[k] => unwrapped(next.uv[k], here.uv[k], period),
                    _ => next.uv[k],
                });
            }
            if depth < MAX_DEPTH && self.turns(&[here, next]) {
                let middle = self.place_on(track, 0.5 * (here.at.t + next.at.t), here.uv);
                ahead.push((next, depth + 1));
                ahead.push((middle, depth + 1));
                continue;
            }
            if !ahead.is_empty() {
                out.push(next);
            }
            here = next;
        }
    }

    /// Places with poles as the edge comes to them and leaves them.
    fn with_limits(&self, track: Track<'_>, places: &[Place]) -> Vec<Place> {
        let mut out: Vec<Place> = Vec::with_capacity(places.len() + 1);
        let mut moved = [0.0; 2];
        let mut at = 0;
        while at < places.len() {
            if !places[at].is_singular() {
                let mut place = places[at];
                place.shift(moved);
                out.push(place);
                at += 1;
                continue;
            }
            let run = places[at..].iter().take_while(|place| place.is_singular()).count();
            let poles = &places[at..at + run];
            let before = at.checked_sub(1).map(|k| &places[k]);
            let after = places.get(at + run);
            // The first half belongs to the way in, the second to the way out; the one between to both.
            let split = match (before, after) {
                (Some(_), Some(_)) => run / 2,
                (Some(_), None) => run,
                _ => 0,
            };
            for (k, pole) in poles.iter().enumerate() {
                if let Some(before) = before.filter(|_| k <= split) {
                    let mut way_in = self.limit(track, pole, before);
                    way_in.shift(moved);
                    out.push(way_in);
                }
                let Some(after) = after.filter(|_| k >= split) else {
                    if before.is_none() {
                        out.push(*pole);
                    }
                    continue;
                };
                let mut way_out = self.limit(track, pole, after);
                way_out.shift(moved);
                if let (Some(_), true, Some(way_in)) = (before, k == split, out.last().copied()) {
                    let more = self.turned(before, &way_in, &way_out, moved);
                    way_out.shift(more);
                    moved = [moved[0] + more[0], moved[1] + more[1]];
                }
                out.push(way_out);
            }
            at += run;
        }
        out
    }

    /// Whole periods that the way out of a pole, within an edge, lies from where it was found.
    fn turned(&self, from: Option<&Place>, way_in: &Place, way_out: &Place, moved: [f64; 2]) -> [f64; 2] {
        let Some(mut from) = from.copied() else { return [0.0; 2] };
        from.shift(moved);
        [0, 1].map(|k| {
            if !way_in.singular[k] || self.periods[k].is_none() {
                return 0.0;
            }
            way_in.uv[k] + self.turn_at_pole(k, &from, way_in, way_out.uv[k], false) - way_out.uv[k]
        })
    }

    /// How far a loop goes along the line of a pole of parameter `k`, from the way in to the way out: on the side where
    /// the face is, by less than a turn; by a whole one where an edge doubles back.
    pub(super) fn turn_at_pole(
        &self,
        k: usize,
        from: &Place,
        pole: &Place,
        out: f64,
        doubles_back: bool,
    ) -> f64 {
        let Some(period) = self.periods[k] else { return 0.0 };
        let heading = (pole.uv[1 - k] - from.uv[1 - k]).signum();
        // Heading up in v, the left is towards smaller u; heading up in u, towards greater v.
        let side = self.left * heading * if k == 0 { -1.0 } else { 1.0 };
        let way = (side * (out - pole.uv[k])).rem_euclid(period);
        let same = way <= SAME_WAY * period || way >= (1.0 - SAME_WAY) * period;
        side * match (same, doubles_back) {
            (true, true) => period,
            (true, false) => 0.0,
            (false, _) => way,
        }
    }

    /// A pole with the lost parameter that an edge has in the limit, coming from a place beside it.
    fn limit(&self, track: Track<'_>, pole: &Place, beside: &Place) -> Place {
        let with = |uv: [f64; 2]| {
            let mut found = *pole;
            found.uv = [0, 1].map(|k| if pole.singular[k] { uv[k] } else { pole.uv[k] });
            found
        };
        if let Some(pcurve) = track.pcurve {
            let p = pcurve.point_at(pole.at.t);
            let next =
                |x: f64, k: usize| self.periods[k].map_or(x, |period| unwrapped(x, beside.uv[k], period));
            return with([next(p.x, 0), next(p.y, 1)]);
        }
        let away = (beside.at.point - pole.at.point).norm();
        let nearest = NEAR_PART.max(CLEAR * self.sampling.tolerance / away);
        let mut share = 1.0;
        let mut steps = vec![(share, beside.uv)];
        while share > 4.0 * nearest {
            share *= 0.25;
            let t = pole.at.t + (beside.at.t - pole.at.t) * share;
            steps.push((share, self.place_on(track, t, steps[steps.len() - 1].1).uv));
        }
        let [.., (s, a), (t, b)] = steps[..] else { return with(beside.uv) };
        with([0, 1].map(|k| b[k] + (b[k] - a[k]) * t / (s - t)))
    }
}
