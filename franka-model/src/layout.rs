//! Conversions to and from libfranka's arrays, which are column-major.
//!
//! | quantity | array | index of row `r`, column `c` |
//! |---|---|---|
//! | pose | `[f64; 16]` | `4 c + r`: the translation at 12, 13, 14 |
//! | Jacobian | `[f64; 42]` | `6 c + r`: joint by joint |
//! | mass matrix | `[f64; 49]` | `7 c + r` |
//! | inertia of a load | `[f64; 9]` | `3 c + r` |
//!
//! `q.into()` converts vectors. For the model's functions, a state's `O_ddP_O` is the gravitational
//! acceleration: `Vector3::from(state.O_ddP_O)`.
//!
//! ```
//! use franka_model::{EndEffector, Frame, Load, Model, READY, layout};
//!
//! let identity = layout::pose(&nalgebra::Matrix4::identity());
//! let ee = EndEffector::from_arrays(&identity, &identity);
//! let load = Load::from_arrays(0.73, &[-0.01, 0.0, 0.03], &[0.001, 0.0, 0.0, 0.0, 0.0025, 0.0, 0.0, 0.0, 0.0017]);
//! let pose: [f64; 16] = layout::pose(&Model::fr3().pose(Frame::EndEffector, &READY, &ee));
//! let mass: [f64; 49] = layout::mass(&Model::fr3().mass(&READY, &load));
//! let gravity: [f64; 7] = Model::fr3().gravity(&READY, &load, &[0.0, 0.0, -9.81].into()).into();
//! assert!((pose[14] - 0.590_282_052).abs() < 1e-9);
//! assert!((mass[8] - 1.630_502_721).abs() < 1e-9);
//! assert!((gravity[3] - 22.287_714_935).abs() < 1e-9);
//! ```

use nalgebra::{Matrix3, Matrix4, SMatrix, Vector3};

use crate::{EndEffector, Jacobian, Load, MassMatrix};

/// Returns a homogeneous matrix as an array, in the format of `O_T_EE`.
pub fn pose(matrix: &Matrix4<f64>) -> [f64; 16] {
    columns(matrix)
}

/// Returns a Jacobian as an array, in the format of libfranka's `zeroJacobian` and `bodyJacobian`.
pub fn jacobian(jacobian: &Jacobian) -> [f64; 42] {
    columns(jacobian)
}

/// Returns a mass matrix as an array, in the format of libfranka's `mass`.
pub fn mass(mass: &MassMatrix) -> [f64; 49] {
    columns(mass)
}

impl EndEffector {
    /// Creates the frames from `F_T_EE` and `EE_T_K` of a state, without changes to the numbers.
    pub fn from_arrays(f_t_ee: &[f64; 16], ee_t_k: &[f64; 16]) -> Self {
        Self {
            f_t_ee: Matrix4::from_column_slice(f_t_ee),
            ee_t_k: Matrix4::from_column_slice(ee_t_k),
        }
    }
}

impl Load {
    /// Creates a load from its mass `[kg]`, its centre of mass in the flange frame `[m]` and its
    /// inertia about the centre of mass `[kg·m²]`. A state contains these values as `m_total`,
    /// `F_x_Ctotal` and `I_total`.
    pub fn from_arrays(mass: f64, com: &[f64; 3], inertia: &[f64; 9]) -> Self {
        Self {
            mass,
            com: Vector3::from(*com),
            inertia: Matrix3::from_column_slice(inertia),
        }
    }
}

/// Returns all `N` numbers of a matrix.
fn columns<const R: usize, const C: usize, const N: usize>(
    matrix: &SMatrix<f64, R, C>,
) -> [f64; N] {
    const { assert!(R * C == N) };
    let mut numbers = [0.0; N];
    numbers.copy_from_slice(matrix.as_slice());
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Frame, Model, READY};

    #[test]
    fn matrices_are_laid_out_column_by_column() {
        let ee = EndEffector::default();
        let (model, q) = (Model::fr3(), &READY);
        let matrix = model.pose(Frame::Flange, q, &ee);
        let array = pose(&matrix);
        assert_eq!(
            [array[12], array[13], array[14]],
            [matrix.m14, matrix.m24, matrix.m34]
        );
        let matrix = model.zero_jacobian(Frame::Flange, q, &ee);
        assert_eq!(jacobian(&matrix)[6 * 3 + 4], matrix[(4, 3)]);
        let matrix = model.mass(q, &Load::NONE);
        assert_eq!(mass(&matrix)[7 * 2 + 5], matrix[(5, 2)]);
    }

    #[test]
    fn arrays_of_a_state_become_frames_and_loads() {
        let numbers: [f64; 16] = core::array::from_fn(|i| i as f64);
        let other = numbers.map(|x| -x);
        let ee = EndEffector::from_arrays(&numbers, &other);
        assert_eq!((ee.f_t_ee[(1, 2)], ee.ee_t_k[(3, 0)]), (9.0, -3.0));
        assert_eq!(pose(&ee.f_t_ee), numbers);
        let inertia = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        let load = Load::from_arrays(0.5, &[1.0, 2.0, 3.0], &inertia);
        assert_eq!(
            (load.mass, load.com.y, load.inertia[(2, 0)]),
            (0.5, 2.0, 3.0)
        );
    }
}
