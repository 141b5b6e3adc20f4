//! `L D Lᵀ` factorisation of small symmetric matrices, with a size known at compile time.
//!
//! It takes half the time of a general factorisation, because it has no square roots, and its loops
//! unroll.

/// A factorisation of a positive definite matrix.
#[derive(Debug)]
pub(crate) struct Ldl<const N: usize> {
    lower: [[f64; N]; N],
    reciprocals: [f64; N],
    pivots: [f64; N],
}

#[allow(clippy::needless_range_loop)] // indices are those of the textbook
impl<const N: usize> Ldl<N> {
    /// Factorises the matrix with this lower triangle, stored by rows. Returns `None` if the matrix
    /// is not positive definite.
    #[inline(always)]
    pub(crate) fn of(matrix: &[[f64; N]; N]) -> Option<Self> {
        let (factor, positive) = Self::regardless(matrix);
        positive.then_some(factor)
    }

    /// Returns the determinants of the leading blocks of size 1 to N. The first non-positive
    /// determinant and all later ones are zero.
    #[inline(always)]
    pub(crate) fn leading_minors(matrix: &[[f64; N]; N]) -> [f64; N] {
        let (factor, _) = Self::regardless(matrix);
        let mut minor = 1.0;
        factor.pivots.map(|pivot| {
            minor *= if pivot > 0.0 { pivot } else { 0.0 };
            minor
        })
    }

    /// Returns the factorisation up to the first failure, and true if the factorisation is
    /// complete.
    #[inline(always)]
    fn regardless(matrix: &[[f64; N]; N]) -> (Self, bool) {
        let mut factor = Self {
            lower: [[0.0; N]; N],
            reciprocals: [0.0; N],
            pivots: [0.0; N],
        };
        let mut positive = true;
        for j in 0..N {
            // Computes row j of L D, then its pivot.
            let mut row = [0.0; N];
            let mut pivot = matrix[j][j];
            for k in 0..j {
                row[k] = factor.lower[j][k] * factor.pivots[k];
                pivot -= row[k] * factor.lower[j][k];
            }
            positive &= pivot > 0.0;
            factor.pivots[j] = pivot;
            factor.reciprocals[j] = 1.0 / pivot;
            for i in j + 1..N {
                let mut sum = matrix[i][j];
                for k in 0..j {
                    sum -= factor.lower[i][k] * row[k];
                }
                factor.lower[i][j] = sum * factor.reciprocals[j];
            }
        }
        (factor, positive)
    }

    #[inline(always)]
    pub(crate) fn solve(&self, right: &[f64; N]) -> [f64; N] {
        let mut x = *right;
        for i in 0..N {
            for k in 0..i {
                x[i] -= self.lower[i][k] * x[k];
            }
        }
        for i in (0..N).rev() {
            x[i] *= self.reciprocals[i];
            for k in i + 1..N {
                x[i] -= self.lower[k][i] * x[k];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use nalgebra::SMatrix;

    #[test]
    fn solutions_solve_and_minors_are_determinants() {
        let mut random = Random::new(12);
        for _ in 0..1000 {
            let root = SMatrix::<f64, 7, 7>::from_fn(|_, _| random.uniform(-1.0, 1.0));
            let matrix = root * root.transpose() + SMatrix::identity() * 0.1;
            let rows = core::array::from_fn(|i| core::array::from_fn(|j| matrix[(i, j)]));
            let factor = Ldl::of(&rows).expect("positive definite");
            let right = random.joints(1.0);
            let x = factor.solve(&right.data.0[0]);
            let back = matrix * crate::joint_vector(x) - right;
            assert!(back.amax() < 1e-12);
            let minor = matrix.fixed_view::<3, 3>(0, 0).determinant();
            let found = Ldl::leading_minors(&rows)[2];
            assert!((found - minor).abs() < 1e-12 * minor.abs().max(1.0));
        }
    }

    #[test]
    fn matrix_not_positive_definite_has_no_factorisation() {
        assert!(Ldl::of(&[[1.0, 0.0], [2.0, 1.0]]).is_none());
        assert!(Ldl::of(&[[0.0, 0.0], [0.0, 1.0]]).is_none());
        assert!(Ldl::of(&[[1.0, 0.0], [0.0, f64::NAN]]).is_none());
        let singular = [[2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
        assert_eq!(Ldl::leading_minors(&singular), [2.0, 0.0, 0.0]);
    }
}
