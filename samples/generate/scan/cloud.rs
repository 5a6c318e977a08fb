//! Points on a part as a scanner gives them: a jittered grid over primary and secondary, and the blend between them as
//! dense. The generator of random numbers is our own, so that a seed means the same points for ever.

use std::f64::consts::TAU;

use super::{Contacts, Kind, Part, RING, SECTORS};

/// Labels of points.
pub const PRIMARY: u8 = 0;
pub const OBJECTIVE: u8 = 1;
pub const BLEND: u8 = 2;

/// Points with their labels.
#[derive(Debug, Clone, Default)]
pub struct Cloud {
    pub points: Vec<[f64; 3]>,
    pub labels: Vec<u8>,
    /// Root of the area of one point, roughly.
    pub spacing: f64,
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Even over [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with mean 0 and deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (a, b) = (1.0 - self.unit(), self.unit());
        (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
    }
}

/// Part of the step by which a grid point is moved at most.
const JITTER: f64 = 0.35;
/// The grid is a little wider than the area asks for, since the blend comes on top.
const WIDER: f64 = 1.03;

impl Part {
    /// Distance of neighbouring points of a cloud of so many.
    pub fn spacing(&self, count: usize) -> f64 {
        let [x0, x1, y0, y1] = self.extent;
        let area = match self.kind {
            Kind::Diaphragm => 0.5 * TAU * (RING[1] * RING[1] - RING[0] * RING[0]),
            _ => (x1 - x0) * (y1 - y0),
        };
        WIDER * (area / count as f64).sqrt()
    }

    /// About `count` points with normal noise in all coordinates.
    pub fn cloud(&self, count: usize, noise: f64, seed: u64) -> Cloud {
        let spacing = self.spacing(count);
        let mut random = Random::new(seed);
        let mut cloud = Cloud { spacing, ..Cloud::default() };
        if self.kind == Kind::Diaphragm {
            let sector = Self::new(Kind::Sector);
            let half = 0.5 * TAU / SECTORS as f64;
            for k in 0..SECTORS {
                let (sine, cosine) = (2.0 * half * k as f64).sin_cos();
                let mut one = Cloud { spacing, ..Cloud::default() };
                sector.sample(&mut one, &mut random);
                for ([x, y, z], label) in one.points.into_iter().zip(one.labels) {
                    let inside = y.atan2(x).abs() <= half && (RING[0]..=RING[1]).contains(&x.hypot(y));
                    if inside {
                        cloud.points.push([cosine * x - sine * y, sine * x + cosine * y, z]);
                        cloud.labels.push(label);
                    }
                }
            }
        } else {
            self.sample(&mut cloud, &mut random);
        }
        if noise > 0.0 {
            cloud.points.as_flattened_mut().iter_mut().for_each(|c| *c += noise * random.normal());
        }
        cloud
    }

    fn sample(&self, cloud: &mut Cloud, random: &mut Random) {
        let [x0, x1, y0, y1] = self.extent;
        let count = |low: f64, high: f64| ((high - low) / cloud.spacing) as usize;
        let (nx, ny) = (count(x0, x1), count(y0, y1));
        let regions = Regions::of(self);
        for i in 0..nx {
            for j in 0..ny {
                let mut at = |k: usize, n: usize, low: f64, high: f64| {
                    let even = low + (k as f64 + 0.5) / n as f64 * (high - low);
                    (even + JITTER * cloud.spacing * (2.0 * random.unit() - 1.0)).clamp(low, high)
                };
                let (x, y) = (at(i, nx, x0, x1), at(j, ny, y0, y1));
                if regions.on_primary([x, y]) {
                    cloud.push([x, y, self.primary(x, y)], PRIMARY);
                } else if regions.on_secondary([x, y]) {
                    cloud.push([x, y, self.secondary(x, y)], OBJECTIVE);
                }
            }
        }
        for contacts in &self.truth {
            self.blend(contacts, cloud, random);
        }
    }

    /// Points on the arcs between the contacts, as many as their area asks for.
    fn blend(&self, contacts: &Contacts, cloud: &mut Cloud, random: &mut Random) {
        let n = contacts.centre.len();
        let next = |k: usize| if self.closed { (k + 1) % n } else { (k + 1).min(n - 1) };
        let middle = |k: usize| mixed(contacts.primary[k], contacts.secondary[k], 0.5);
        let area = |k: usize| {
            let (a, b) = (arm(contacts, k, 0), arm(contacts, k, 1));
            let angle = (dot(a, b) / (norm(a) * norm(b))).clamp(-1.0, 1.0).acos();
            norm(minus(middle(next(k)), middle(k))) * self.radius * angle
        };
        let mut sums = Vec::with_capacity(n);
        let mut total = 0.0;
        for k in 0..n {
            total += area(k);
            sums.push(total);
        }
        let [x0, x1, y0, y1] = self.extent;
        for _ in 0..(total / (cloud.spacing * cloud.spacing)) as usize {
            let wanted = random.unit() * total;
            let k = sums.partition_point(|s| *s < wanted).min(n - 1);
            let (along, around) = (random.unit(), random.unit());
            let centre = mixed(contacts.centre[k], contacts.centre[next(k)], along);
            let unit = |which| {
                let a = mixed(arm(contacts, k, which), arm(contacts, next(k), which), along);
                a.map(|c| c / norm(a))
            };
            let (a, b) = (unit(0), unit(1));
            let angle = dot(a, b).clamp(-1.0, 1.0).acos();
            let (from, to) =
                (((1.0 - around) * angle).sin() / angle.sin(), (around * angle).sin() / angle.sin());
            let p = [0, 1, 2].map(|c| centre[c] + self.radius * (from * a[c] + to * b[c]));
            if (x0..=x1).contains(&p[0]) && (y0..=y1).contains(&p[1]) {
                cloud.push(p, BLEND);
            }
        }
    }
}

impl Cloud {
    fn push(&mut self, point: [f64; 3], label: u8) {
        self.points.push(point);
        self.labels.push(label);
    }

    /// The points with a label.
    pub fn labelled(&self, label: u8) -> Vec<[f64; 3]> {
        self.points.iter().zip(&self.labels).filter(|(_, l)| **l == label).map(|(p, _)| *p).collect()
    }
}

/// Seen from above: what lies outside the contacts on the primary, and inside those on the secondary.
struct Regions {
    primary: Outline,
    secondary: Outline,
}

impl Regions {
    fn of(part: &Part) -> Self {
        let outline = |of: fn(&Contacts) -> &Vec<[f64; 3]>| {
            // The second line of a channel runs back, so that both make one outline.
            Outline::new(part.truth.iter().flat_map(of).map(|p| [p[0], p[1]]).collect(), part)
        };
        Self { primary: outline(|c| &c.primary), secondary: outline(|c| &c.secondary) }
    }

    fn on_primary(&self, at: [f64; 2]) -> bool {
        !self.primary.contains(at)
    }

    fn on_secondary(&self, at: [f64; 2]) -> bool {
        self.secondary.contains(at)
    }
}

/// A closed polygon with its sides sorted into strips of equal y.
struct Outline {
    points: Vec<[f64; 2]>,
    strips: Vec<Vec<usize>>,
    low: f64,
    width: f64,
}

const STRIPS: usize = 256;

impl Outline {
    fn new(mut points: Vec<[f64; 2]>, part: &Part) -> Self {
        if part.kind == Kind::Groove {
            // Contacts at the ends lean over the border or short of it: the channel goes on.
            let n = points.len() / 2;
            for (k, y) in [(0, -50.0), (n - 1, 850.0), (n, 850.0), (2 * n - 1, -50.0)] {
                points[k][1] = y;
            }
        }
        let (low, high) =
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p[1]), b.max(p[1])));
        let width = (high - low) / STRIPS as f64;
        let mut strips = vec![Vec::new(); STRIPS];
        for k in 0..points.len() {
            let (a, b) = (points[k][1], points[(k + 1) % points.len()][1]);
            let strip = |y: f64| (((y - low) / width) as usize).min(STRIPS - 1);
            (strip(a.min(b))..=strip(a.max(b))).for_each(|s| strips[s].push(k));
        }
        Self { points, strips, low, width }
    }

    fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let strip = (y - self.low) / self.width;
        if !(0.0..=STRIPS as f64).contains(&strip) {
            return false;
        }
        let mut inside = false;
        for &k in &self.strips[(strip as usize).min(STRIPS - 1)] {
            let ([xa, ya], [xb, yb]) = (self.points[k], self.points[(k + 1) % self.points.len()]);
            if (ya > y) != (yb > y) && x < xa + (y - ya) / (yb - ya) * (xb - xa) {
                inside = !inside;
            }
        }
        inside
    }
}

fn arm(contacts: &Contacts, k: usize, which: usize) -> [f64; 3] {
    minus(if which == 0 { contacts.primary[k] } else { contacts.secondary[k] }, contacts.centre[k])
}

fn mixed(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| (1.0 - share) * a[k] + share * b[k])
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
