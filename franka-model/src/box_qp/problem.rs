//! The function that the search minimises.

use crate::{Jacobian, JointVector, Twist};

/// The function to minimise; see [`box_qp`](crate::box_qp).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Problem<'a> {
    /// Matrix `A`: the Jacobian of the task.
    pub(crate) rows: &'a Jacobian,
    /// Vector `t`: the task.
    pub(crate) task: &'a Twist,
    /// Vector `x0`: the preferred solution.
    pub(crate) posture: &'a JointVector,
    /// Damping `d`, positive.
    pub(crate) damping: f64,
    /// Matrix `AᵀA + d` of the normal equations.
    pub(crate) normal: [[f64; 7]; 7],
}

impl<'a> Problem<'a> {
    #[inline(always)]
    pub(crate) fn new(
        rows: &'a Jacobian,
        task: &'a Twist,
        posture: &'a JointVector,
        damping: f64,
    ) -> Self {
        let columns = &rows.data.0;
        let mut normal = [[0.0; 7]; 7];
        for i in 0..7 {
            for j in 0..=i {
                let mut sum = 0.0;
                for (a, b) in columns[i].iter().zip(&columns[j]) {
                    sum += a * b;
                }
                normal[i][j] = sum;
                normal[j][i] = sum;
            }
            normal[i][i] += damping;
        }
        Self {
            rows,
            task,
            posture,
            damping,
            normal,
        }
    }

    /// Returns `Aᵀt + d x0`, the right-hand side of the normal equations.
    #[inline(always)]
    pub(super) fn linear(&self) -> [f64; 7] {
        let columns = &self.rows.data.0;
        core::array::from_fn(|i| {
            let mut sum = self.damping * self.posture[i];
            for (a, t) in columns[i].iter().zip(self.task.iter()) {
                sum += a * t;
            }
            sum
        })
    }

    /// Returns the gradient `Aᵀ(A x − t) + d (x − x0)`.
    #[inline(always)]
    pub(super) fn gradient(&self, x: &JointVector) -> [f64; 7] {
        let columns = &self.rows.data.0;
        let mut residual = self.task.data.0[0].map(|t| -t);
        for (column, x) in columns.iter().zip(x.iter()) {
            for (r, a) in residual.iter_mut().zip(column) {
                *r += a * x;
            }
        }
        core::array::from_fn(|i| {
            let mut sum = self.damping * (x[i] - self.posture[i]);
            for (a, r) in columns[i].iter().zip(&residual) {
                sum += a * r;
            }
            sum
        })
    }
}
