//! Newton steps for functions whose Hessian has few diagonals.

use nalgebra::{Matrix3, Vector3};

/// A gradient and a symmetric Hessian. Apart from its diagonal, only the next two diagonals on each
/// side are not zero.
pub(super) struct Banded {
    gradient: Vec<f64>,
    /// For each row, the diagonal entry and the two entries to its right.
    rows: Vec<[f64; 3]>,
}

impl Banded {
    pub(super) fn new(n: usize) -> Self {
        Self {
            gradient: vec![0.0; n],
            rows: vec![[0.0; 3]; n],
        }
    }

    pub(super) fn clear(&mut self) {
        self.gradient.fill(0.0);
        self.rows.fill([0.0; 3]);
    }

    pub(super) fn add(&mut self, k: usize, slope: &Vector3<f64>, curve: &Matrix3<f64>) {
        for i in 0..3 {
            self.gradient[k + i] += slope[i];
            for j in i..3 {
                self.rows[k + i][j - i] += curve[(i, j)];
            }
        }
    }

    /// Returns the step of Newton's method and the square of its length. Overwrites the Hessian.
    pub(super) fn step(&mut self) -> (Vec<f64>, f64) {
        let n = self.rows.len();
        // LDL' factorisation, starting at the first row.
        for i in 0..n {
            let [d, first, second] = self.rows[i];
            let d = d.max(f64::MIN_POSITIVE);
            let (l1, l2) = (first / d, second / d);
            if i + 1 < n {
                self.rows[i + 1][0] -= l1 * first;
                self.rows[i + 1][1] -= l1 * second;
            }
            if i + 2 < n {
                self.rows[i + 2][0] -= l2 * second;
            }
            self.rows[i] = [d, l1, l2];
        }
        let mut step: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        for i in 0..n {
            let [_, l1, l2] = self.rows[i];
            if i + 1 < n {
                step[i + 1] -= l1 * step[i];
            }
            if i + 2 < n {
                step[i + 2] -= l2 * step[i];
            }
        }
        for i in (0..n).rev() {
            let [d, l1, l2] = self.rows[i];
            let mut value = step[i] / d;
            if i + 1 < n {
                value -= l1 * step[i + 1];
            }
            if i + 2 < n {
                value -= l2 * step[i + 2];
            }
            step[i] = value;
        }
        let length = step.iter().zip(&self.gradient).map(|(s, g)| -s * g).sum();
        (step, length)
    }
}
