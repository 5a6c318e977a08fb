//! Symmetric matrices over the nodes of a rectangular grid, in which only near nodes are coupled.
//!
//! Normal equations of tensor-product splines and of bar networks have this form. Entries stand in a block for each node,
//! so that adding one is an index computation; the factor is the sparse one, by nested dissection. Knows no splines.

use super::nested_dissection::nested_dissection;
use super::sparse::{SingularSystem, SymmetricFactor};
use sprs::CsMat;

/// A symmetric matrix over `rows x columns` nodes, node `(i, j)` at index `i * columns + j`; nodes more than `reach`
/// rows or columns apart are not coupled.
#[derive(Debug, Clone)]
pub struct GridMatrix {
    rows: usize,
    columns: usize,
    reach: [usize; 2],
    /// Of each node, the entries with the nodes around it, row by row.
    entries: Vec<f64>,
}

/// A vector over the nodes that is zero outside a rectangular block of them.
#[derive(Debug, Clone, Default)]
pub struct GridRow {
    /// Row and column of the block's first node.
    pub first: [usize; 2],
    /// Rows and columns of the block.
    pub shape: [usize; 2],
    /// Values, row by row.
    pub values: Vec<f64>,
}

impl GridRow {
    /// Indices of the block's nodes in a grid of so many columns, in the order of the values.
    pub fn nodes(&self, columns: usize) -> impl Iterator<Item = usize> + use<> {
        let ([i, j], [rows, width]) = (self.first, self.shape);
        (i..i + rows).flat_map(move |i| (j..j + width).map(move |j| i * columns + j))
    }

    /// Product with a vector of `D` columns over all nodes.
    #[must_use]
    pub fn dot<const D: usize>(&self, columns: usize, x: &[[f64; D]]) -> [f64; D] {
        let mut sum = [0.0; D];
        for (node, value) in self.nodes(columns).zip(&self.values) {
            (0..D).for_each(|k| sum[k] += value * x[node][k]);
        }
        sum
    }

    /// Adds `factor` times the row to each column of a vector over all nodes.
    pub fn add_to<const D: usize>(&self, columns: usize, factor: &[f64; D], x: &mut [[f64; D]]) {
        for (node, value) in self.nodes(columns).zip(&self.values) {
            (0..D).for_each(|k| x[node][k] += factor[k] * value);
        }
    }
}

/// Factor of a [`GridMatrix`] over some of its nodes, with the others held at zero.
#[derive(Debug, Clone)]
pub struct GridFactor {
    factor: SymmetricFactor,
    /// Nodes of the unknowns.
    nodes: Vec<usize>,
    size: usize,
}

impl GridMatrix {
    /// The zero matrix.
    #[must_use]
    pub fn zeros(rows: usize, columns: usize, reach: [usize; 2]) -> Self {
        let block = (2 * reach[0] + 1) * (2 * reach[1] + 1);
        Self { rows, columns, reach, entries: vec![0.0; rows * columns * block] }
    }

    /// Count of nodes.
    #[must_use]
    pub fn size(&self) -> usize {
        self.rows * self.columns
    }

    /// Place of an entry, which must lie within reach.
    fn place(&self, a: usize, b: usize) -> usize {
        let (ia, ja) = (a / self.columns, a % self.columns);
        let (ib, jb) = (b / self.columns, b % self.columns);
        let (di, dj) = (ib + self.reach[0] - ia, jb + self.reach[1] - ja);
        let width = 2 * self.reach[1] + 1;
        debug_assert!(di <= 2 * self.reach[0] && dj < width, "entry ({a}, {b}) is out of reach");
        (a * (2 * self.reach[0] + 1) + di) * width + dj
    }

    /// An entry within reach.
    ///
    /// # Panics
    /// For nodes out of reach of each other.
    #[must_use]
    pub fn entry(&self, a: usize, b: usize) -> f64 {
        self.entries[self.place(a, b)]
    }

    /// Adds to an entry within reach, and to no other: its mirror image is another entry.
    ///
    /// # Panics
    /// For nodes out of reach of each other.
    pub fn add(&mut self, a: usize, b: usize, value: f64) {
        let at = self.place(a, b);
        self.entries[at] += value;
    }

    /// Adds to the diagonal entry of a node.
    pub fn add_diagonal(&mut self, a: usize, value: f64) {
        self.add(a, a, value);
    }

    /// Adds `factor * v vᵀ` of a row.
    ///
    /// # Panics
    /// For a block that is larger than the reach or goes beyond the grid.
    pub fn add_outer(&mut self, row: &GridRow, factor: f64) {
        let [rows, columns] = row.shape;
        assert!(rows <= self.reach[0] + 1 && columns <= self.reach[1] + 1, "a row larger than the reach");
        let width = 2 * self.reach[1] + 1;
        let block = (2 * self.reach[0] + 1) * width;
        for (x, (i, j)) in row.values.iter().zip((0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)))) {
            let scaled = factor * x;
            if scaled == 0.0 {
                continue;
            }
            let node = (row.first[0] + i) * self.columns + row.first[1] + j;
            for k in 0..rows {
                let at = node * block + (k + self.reach[0] - i) * width + self.reach[1] - j;
                let values = &row.values[k * columns..(k + 1) * columns];
                for (entry, y) in self.entries[at..at + columns].iter_mut().zip(values) {
                    *entry += scaled * y;
                }
            }
        }
    }

    /// Adds `factor` times another matrix of the same shape and reach.
    ///
    /// # Panics
    /// For another shape or reach.
    pub fn add_scaled(&mut self, other: &Self, factor: f64) {
        assert_eq!((self.rows, self.columns, self.reach), (other.rows, other.columns, other.reach));
        for (entry, more) in self.entries.iter_mut().zip(&other.entries) {
            *entry += factor * more;
        }
    }

    /// Mean of the positive diagonal entries of some nodes; 0 when there are none.
    #[must_use]
    pub fn mean_diagonal(&self, nodes: &[usize]) -> f64 {
        let positive = nodes.iter().map(|&a| self.entry(a, a)).filter(|d| *d > 0.0);
        let (sum, count) = positive.fold((0.0, 0.0), |(s, n), d| (s + d, n + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Nodes within reach of a node, itself too, ascending.
    fn around(&self, a: usize) -> impl Iterator<Item = usize> + '_ {
        let (i, j) = (a / self.columns, a % self.columns);
        let rows = i.saturating_sub(self.reach[0])..(i + self.reach[0] + 1).min(self.rows);
        let columns = j.saturating_sub(self.reach[1])..(j + self.reach[1] + 1).min(self.columns);
        rows.flat_map(move |i| columns.clone().map(move |j| i * self.columns + j))
    }

    /// Product with a vector of `D` columns.
    ///
    /// # Panics
    /// When there are not as many rows as nodes.
    #[must_use]
    pub fn times<const D: usize>(&self, x: &[[f64; D]]) -> Vec<[f64; D]> {
        assert_eq!(x.len(), self.size(), "as many rows as nodes");
        let row = |a: usize| {
            let mut sum = [0.0; D];
            for b in self.around(a) {
                let entry = self.entry(a, b);
                (0..D).for_each(|k| sum[k] += entry * x[b][k]);
            }
            sum
        };
        (0..self.size()).map(row).collect()
    }

    /// The lower triangle of the rows and columns of some nodes, ascending, as compressed rows.
    #[must_use]
    pub fn lower(&self, nodes: &[usize]) -> CsMat<f64> {
        let mut number = vec![usize::MAX; self.size()];
        for (k, &a) in nodes.iter().enumerate() {
            number[a] = k;
        }
        let (mut starts, mut indices, mut data) = (vec![0], Vec::new(), Vec::new());
        for &a in nodes {
            for b in self.around(a).take_while(|b| *b <= a).filter(|&b| number[b] != usize::MAX) {
                let entry = self.entry(a, b);
                // Not all nodes within reach are coupled: of a Laplacian only the four next.
                if entry != 0.0 || a == b {
                    indices.push(number[b]);
                    data.push(entry);
                }
            }
            starts.push(indices.len());
        }
        CsMat::new((nodes.len(), nodes.len()), starts, indices, data)
    }

    /// Factors the rows and columns of some nodes, ascending, of which the entries at and before the diagonal are read;
    /// the other nodes are held at zero.
    ///
    /// # Errors
    /// [`SingularSystem`].
    pub fn factored(&self, nodes: &[usize]) -> Result<GridFactor, SingularSystem> {
        let places: Vec<[usize; 2]> = nodes.iter().map(|a| [a / self.columns, a % self.columns]).collect();
        let order = nested_dissection(&places, self.reach);
        let factor = SymmetricFactor::ordered(&self.lower(nodes), &order)?;
        Ok(GridFactor { factor, nodes: nodes.to_vec(), size: self.size() })
    }
}

impl GridFactor {
    /// The factor, over the unknowns alone.
    #[must_use]
    pub fn unknowns(&self) -> &SymmetricFactor {
        &self.factor
    }

    /// Solves for right sides of one row of `D` numbers for each node of the grid; held nodes get zeros.
    ///
    /// # Panics
    /// When there are not as many rows as nodes.
    #[must_use]
    pub fn solve<const D: usize>(&self, right: &[[f64; D]]) -> Vec<[f64; D]> {
        assert_eq!(right.len(), self.size, "as many right sides as nodes");
        let n = self.nodes.len();
        let mut columns = vec![0.0; n * D];
        for (k, &a) in self.nodes.iter().enumerate() {
            (0..D).for_each(|d| columns[d * n + k] = right[a][d]);
        }
        self.factor.solve(&mut columns);
        let mut out = vec![[0.0; D]; self.size];
        for (k, &a) in self.nodes.iter().enumerate() {
            out[a] = std::array::from_fn(|d| columns[d * n + k]);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_is_solved_with_nodes_held() {
        // A A' of scattered local vectors plus the identity is positive definite.
        let mut matrix = GridMatrix::zeros(4, 5, [1, 2]);
        (0..20).for_each(|a| matrix.add_diagonal(a, 1.0));
        let mut dense = vec![[0.0; 20]; 20];
        (0..20).for_each(|a| dense[a][a] = 1.0);
        for (first, shape, values) in [
            ([0, 0], [2, 3], vec![1.0, -0.5, 0.25, 2.0, 0.0, 1.5]),
            ([2, 2], [2, 3], vec![-1.0, 0.5, 0.75, 0.0, 3.0, 1.0]),
            ([1, 3], [2, 2], vec![0.3, 0.1, -2.0, 1.0]),
            ([3, 0], [1, 1], vec![4.0]),
        ] {
            let row = GridRow { first, shape, values };
            matrix.add_outer(&row, 3.0);
            for (a, x) in row.nodes(5).zip(&row.values) {
                row.nodes(5).zip(&row.values).for_each(|(b, y)| dense[a][b] += 3.0 * x * y);
            }
        }
        let free: Vec<usize> = (0..20).filter(|a| ![2, 8].contains(a)).collect();
        let exact: Vec<[f64; 2]> = (0..20)
            .map(|a| if free.contains(&a) { [a as f64, 1.0 - 0.3 * (a * a) as f64] } else { [0.0; 2] })
            .collect();
        let product = |a: usize| [0, 1].map(|d| (0..20).map(|b| dense[a][b] * exact[b][d]).sum());
        let right: Vec<[f64; 2]> = (0..20).map(product).collect();
        for (f, e) in matrix.times(&exact).iter().flatten().zip(right.iter().flatten()) {
            assert!((f - e).abs() < 1e-11, "{f} against {e}");
        }
        let found = matrix.factored(&free).unwrap().solve(&right);
        for (f, e) in found.iter().flatten().zip(exact.iter().flatten()) {
            assert!((f - e).abs() < 1e-11, "{f} against {e}");
        }
    }
}
