//! A slow search for the minimum in a box, for tests: it tries every active set.

use std::vec::Vec;

use crate::JointVector;
use crate::box_qp::{JointBox, Problem};

/// Number of rows: the task, and the damping below it.
const ROWS: usize = 6 + 7;
type Column = [f64; ROWS];

/// Returns the minimum. The function tries all 3⁷ ways to hold variables on their bounds. The
/// result is the best point within the box whose gradient does not point into the box.
///
/// For each way, it orthogonalises the columns of `[A; sqrt(d) 1]` to solve the least squares,
/// without normal equations.
pub(crate) fn minimum_by_enumeration(problem: &Problem<'_>, bounds: &JointBox) -> JointVector {
    let root = problem.damping.sqrt();
    let column = |i: usize| -> Column {
        core::array::from_fn(|row| match row.checked_sub(6) {
            None => problem.rows[(row, i)],
            Some(damped) => root * f64::from(u8::from(damped == i)),
        })
    };
    let columns: [Column; 7] = core::array::from_fn(column);
    let target: Column = core::array::from_fn(|row| match row.checked_sub(6) {
        None => problem.task[row],
        Some(damped) => root * problem.posture[damped],
    });
    let mut best = (f64::INFINITY, JointVector::zeros());
    for free in 0..128_u32 {
        let is_free = |i: &usize| free >> i & 1 == 1;
        let (inside, held): (Vec<usize>, Vec<usize>) = (0..7).partition(is_free);
        let basis = Orthogonal::of(&inside.iter().map(|i| columns[*i]).collect::<Vec<_>>());
        for sides in 0..1_u32 << held.len() {
            let mut x = JointVector::zeros();
            let mut right = target;
            for (place, i) in held.iter().enumerate() {
                let upper = sides >> place & 1 == 1;
                x[*i] = if upper {
                    bounds.upper()[*i]
                } else {
                    bounds.lower()[*i]
                };
                add(&mut right, &columns[*i], -x[*i]);
            }
            if !x.iter().all(|x| x.is_finite()) {
                continue;
            }
            for (i, value) in inside.iter().zip(basis.solve(right)) {
                x[*i] = value;
            }
            let fault = fault(&columns, &target, bounds, &x, free);
            if fault < best.0 {
                best = (fault, x);
            }
        }
    }
    best.1
}

/// Returns the violation: the distance of free variables from the box, or the gradient of held
/// variables that points into the box.
fn fault(
    columns: &[Column; 7],
    target: &Column,
    bounds: &JointBox,
    x: &JointVector,
    free: u32,
) -> f64 {
    let mut residual = target.map(|t| -t);
    for i in 0..7 {
        add(&mut residual, &columns[i], x[i]);
    }
    let fault = |i: usize| {
        if free >> i & 1 == 1 {
            return (bounds.lower()[i] - x[i]).max(x[i] - bounds.upper()[i]);
        }
        let gradient = dot(&columns[i], &residual);
        let up = if x[i] < bounds.upper()[i] {
            -gradient
        } else {
            0.0
        };
        let down = if x[i] > bounds.lower()[i] {
            gradient
        } else {
            0.0
        };
        up.max(down)
    };
    (0..7).map(fault).fold(0.0, f64::max)
}

/// Columns as a product of orthonormal columns and a triangle, by the modified Gram-Schmidt method.
struct Orthogonal {
    columns: Vec<Column>,
    /// The triangle, row by row.
    triangle: Vec<Vec<f64>>,
}

impl Orthogonal {
    fn of(columns: &[Column]) -> Self {
        let mut rest = columns.to_vec();
        let mut triangle = Vec::new();
        for k in 0..rest.len() {
            let norm = dot(&rest[k], &rest[k]).sqrt();
            let unit = rest[k].map(|x| x / norm);
            rest[k] = unit;
            let mut row = std::vec![0.0; rest.len()];
            row[k] = norm;
            for j in k + 1..rest.len() {
                row[j] = dot(&unit, &rest[j]);
                add(&mut rest[j], &unit, -row[j]);
            }
            triangle.push(row);
        }
        Self {
            columns: rest,
            triangle,
        }
    }

    /// Returns the least squares solution.
    fn solve(&self, mut right: Column) -> Vec<f64> {
        let count = self.columns.len();
        let mut x = std::vec![0.0; count];
        for (k, unit) in self.columns.iter().enumerate() {
            x[k] = dot(unit, &right);
            add(&mut right, unit, -x[k]);
        }
        for k in (0..count).rev() {
            for j in k + 1..count {
                x[k] -= self.triangle[k][j] * x[j];
            }
            x[k] /= self.triangle[k][k];
        }
        x
    }
}

fn dot(a: &Column, b: &Column) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(sum: &mut Column, column: &Column, factor: f64) {
    for (s, c) in sum.iter_mut().zip(column) {
        *s += c * factor;
    }
}
