//! The vector that a small matrix with one column more than rows takes to zero.

/// The vector, 1 in its last place, that all `rows` rows of `rows + 1` numbers are orthogonal to; `None` when the
/// other columns are dependent. The matrix is destroyed.
///
/// Gauss elimination with complete pivoting over all columns but the last. Pivots may be small, since knots may be
/// uneven: the residual is small against the vector all the same.
pub(super) fn null_vector(matrix: &mut [f64], rows: usize) -> Option<Vec<f64>> {
    let columns = rows + 1;
    let mut order: Vec<usize> = (0..columns).collect();
    for row in matrix.chunks_exact_mut(columns) {
        let greatest = row.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if greatest.is_nan() || greatest <= 0.0 {
            return None;
        }
        row.iter_mut().for_each(|v| *v /= greatest);
    }
    for step in 0..rows {
        let (mut best, mut at) = (0.0, (step, step));
        for i in step..rows {
            for j in step..rows {
                let value = matrix[i * columns + j].abs();
                if value > best {
                    (best, at) = (value, (i, j));
                }
            }
        }
        if best <= 0.0 {
            return None;
        }
        for j in 0..columns {
            matrix.swap(step * columns + j, at.0 * columns + j);
        }
        for i in 0..rows {
            matrix.swap(i * columns + step, i * columns + at.1);
        }
        order.swap(step, at.1);
        let (head, tail) = matrix.split_at_mut((step + 1) * columns);
        let pivot = &head[step * columns..];
        for row in tail.chunks_exact_mut(columns) {
            let factor = row[step] / pivot[step];
            if factor != 0.0 {
                for j in step..columns {
                    row[j] -= factor * pivot[j];
                }
            }
        }
    }
    let mut solution = vec![0.0; columns];
    solution[rows] = 1.0;
    for i in (0..rows).rev() {
        let row = &matrix[i * columns..(i + 1) * columns];
        let sum: f64 = row[i + 1..].iter().zip(&solution[i + 1..]).map(|(a, x)| a * x).sum();
        solution[i] = -sum / row[i];
    }
    let mut vector = vec![0.0; columns];
    for (place, value) in order.into_iter().zip(solution) {
        vector[place] = value;
    }
    vector.iter().all(|v| v.is_finite()).then_some(vector)
}
