//! Where a rolling ball touches primary and secondary: Newton's method on the formulas.

use super::Part;

/// A limiting line with the ball's contacts, station by station.
#[derive(Debug, Clone, Default)]
pub struct Contacts {
    /// Where primary and secondary meet.
    pub limiting: Vec<[f64; 3]>,
    /// Contacts on the primary.
    pub primary: Vec<[f64; 3]>,
    /// Contacts on the secondary.
    pub secondary: Vec<[f64; 3]>,
    /// Centres of the ball.
    pub centre: Vec<[f64; 3]>,
}

const STEPS: usize = 40;

impl Contacts {
    pub(super) fn of(part: &Part, line: usize) -> Self {
        let mut contacts = Self::default();
        for s in part.stations() {
            let (at, tangent) = part.limiting(line, s);
            let ball = Ball { part, at, tangent };
            let [x1, y1, x2, y2] = ball.resting();
            contacts.limiting.push([at[0], at[1], part.primary(at[0], at[1])]);
            contacts.primary.push([x1, y1, part.primary(x1, y1)]);
            contacts.secondary.push([x2, y2, part.secondary(x2, y2)]);
            contacts.centre.push(part.offset(x1, y1, Sheet::Primary));
        }
        contacts
    }
}

#[derive(Clone, Copy)]
enum Sheet {
    Primary,
    Secondary,
}

impl Part {
    fn height(&self, x: f64, y: f64, sheet: Sheet) -> f64 {
        match sheet {
            Sheet::Primary => self.primary(x, y),
            Sheet::Secondary => self.secondary(x, y),
        }
    }

    fn slopes(&self, x: f64, y: f64, sheet: Sheet) -> [f64; 2] {
        let h = self.step;
        let f = |x, y| self.height(x, y, sheet);
        [(f(x + h, y) - f(x - h, y)) / (2.0 * h), (f(x, y + h) - f(x, y - h)) / (2.0 * h)]
    }

    /// Unit normal of the secondary, upwards.
    pub fn secondary_normal(&self, x: f64, y: f64) -> [f64; 3] {
        self.normal(x, y, Sheet::Secondary)
    }

    fn normal(&self, x: f64, y: f64, sheet: Sheet) -> [f64; 3] {
        let [gx, gy] = self.slopes(x, y, sheet);
        let length = (1.0 + gx * gx + gy * gy).sqrt();
        [-gx / length, -gy / length, 1.0 / length]
    }

    /// The centre of a ball that touches a sheet at a place.
    fn offset(&self, x: f64, y: f64, sheet: Sheet) -> [f64; 3] {
        let n = self.normal(x, y, sheet).map(|c| self.side * self.radius * c);
        [x + n[0], y + n[1], self.height(x, y, sheet) + n[2]]
    }
}

/// A ball in the upright plane across the limiting line at one place.
struct Ball<'a> {
    part: &'a Part,
    at: [f64; 2],
    tangent: [f64; 2],
}

impl Ball<'_> {
    /// Feet on both sheets: the centres over them agree and lie in the plane.
    fn resting(&self) -> [f64; 4] {
        let mut feet = self.start();
        let step = 0.1 * self.part.step;
        for _ in 0..STEPS {
            let lack = self.lack(feet);
            let mut matrix = [[0.0; 5]; 4];
            for column in 0..4 {
                let (mut more, mut less) = (feet, feet);
                more[column] += step;
                less[column] -= step;
                let (more, less) = (self.lack(more), self.lack(less));
                (0..4).for_each(|row| matrix[row][column] = (more[row] - less[row]) / (2.0 * step));
            }
            (0..4).for_each(|row| matrix[row][4] = -lack[row]);
            let moves = solved(matrix);
            (0..4).for_each(|k| feet[k] += moves[k]);
            if moves.iter().all(|m| m.abs() < 1e-12) {
                break;
            }
        }
        assert!(self.lack(feet).iter().all(|l| l.abs() < 1e-8), "no ball rests at {:?}", self.at);
        feet
    }

    /// Half the opening times the radius away on either side.
    fn start(&self) -> [f64; 4] {
        let inwards = [-self.tangent[1], self.tangent[0]];
        let [x, y] = self.at;
        let rise = |sheet| {
            let [gx, gy] = self.part.slopes(x, y, sheet);
            (gx * inwards[0] + gy * inwards[1]).atan()
        };
        let (first, second) = (rise(Sheet::Primary), rise(Sheet::Secondary));
        let way = self.part.radius * (0.5 * (second - first).abs()).tan();
        let (out, back) = (way * first.cos(), way * second.cos());
        [x - out * inwards[0], y - out * inwards[1], x + back * inwards[0], y + back * inwards[1]]
    }

    fn lack(&self, [x1, y1, x2, y2]: [f64; 4]) -> [f64; 4] {
        let a = self.part.offset(x1, y1, Sheet::Primary);
        let b = self.part.offset(x2, y2, Sheet::Secondary);
        let along = (a[0] - self.at[0]) * self.tangent[0] + (a[1] - self.at[1]) * self.tangent[1];
        [a[0] - b[0], a[1] - b[1], a[2] - b[2], along]
    }
}

/// Four equations by elimination with row exchanges.
fn solved(mut m: [[f64; 5]; 4]) -> [f64; 4] {
    for k in 0..4 {
        let pivot = (k..4).max_by(|&a, &b| m[a][k].abs().total_cmp(&m[b][k].abs())).unwrap_or(k);
        m.swap(k, pivot);
        let top = m[k];
        for row in m.iter_mut().skip(k + 1) {
            let factor = row[k] / top[k];
            row.iter_mut().zip(top).for_each(|(r, t)| *r -= factor * t);
        }
    }
    let mut x = [0.0; 4];
    for k in (0..4).rev() {
        let known: f64 = (k + 1..4).map(|j| m[k][j] * x[j]).sum();
        x[k] = (m[k][4] - known) / m[k][k];
    }
    x
}
