//! The operational-space law: the springs and dampers of the hybrid law, coupled by the inertia at
//! the end effector.
//!
//! ```text
//! tau = J' (Sk Lambda Sk J (q_ref - q) + Sd Lambda Sd J (g dq_ref - dq)) + N' (Kq (q_ref - q) + Kqd (g dq_ref - dq))
//!       + coriolis
//! Sk  = sqrt(Kx / m)        Sd = sqrt(Kxd / m)        m = diagonal of Lambda
//! N'  = 1 - J' Lambda6 J M^-1
//! ```
//!
//! The idea is Khatib's (IEEE Journal on Robotics and Automation 3(1), 1987): the inertia `Lambda`
//! turns desired accelerations into wrenches. Therefore an error along one axis moves the arm along
//! that axis, although the arm's inertia differs between directions. In Khatib's law an
//! acceleration is `(Kx e + Kxd de) / m`, with one mass for all axes. Here each axis has the arm's
//! own mass along that axis, and the roots of stiffness and damping multiply `Lambda` from both
//! sides:
//!
//! - gains keep their units and their meaning: a displacement along an axis causes exactly `Kx`
//!   along that axis. If the axis is coupled with other axes, forces along the other axes are
//!   added;
//! - the matrices are symmetric and positive semidefinite at every pose, so springs store energy
//!   and dampers dissipate it;
//! - the wrench is bounded near singularities: for every `Lambda`, the entries of `Sk Lambda Sk`
//!   are at most `sqrt(Kx_i Kx_j)`.
//!
//! With equal gains and masses along all axes, the law is exactly Khatib's. `Lambda` is computed
//! separately for the position, with free rotation, and for the rotation, with free position. If
//! both were computed together, the arm would have five times the mass at the ready pose, because
//! position and rotation of the hand are coupled. The null-space projection of the joints' springs
//! uses the full matrix, `Lambda6`, which is damped near singularities. Near a singularity, the
//! joints' springs also act in the directions in which the end effector cannot move.
//!
//! At a wall without friction, forces along the wall also occur, and the arm slides along the wall
//! until they are balanced. If the goal lies behind the wall, the arm slides about two thirds of
//! the goal's depth (simulated at the ready pose, downward).
//!
//! The law has no feedforward of the reference's acceleration. The inertia includes the links, and
//! nominal values for the rotors.

use nalgebra::{Matrix3, Matrix6};

use crate::law::task_space::TaskSpace;

/// Returns `S Lambda S` of the springs or dampers at the end effector, in base axes. This matrix
/// turns an error at the end effector into a wrench.
pub(crate) fn coupled(gains: &[f64; 6], space: &TaskSpace) -> Matrix6<f64> {
    let mut coupled = Matrix6::zeros();
    for (at, inertia) in [(0, space.translational()), (3, space.rotational())] {
        let root = |i: usize| (gains[at + i] / inertia[(i, i)]).sqrt();
        let block = Matrix3::from_fn(|i, j| root(i) * inertia[(i, j)] * root(j));
        coupled.fixed_view_mut::<3, 3>(at, at).copy_from(&block);
    }
    coupled
}
