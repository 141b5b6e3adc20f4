//! The operational-space law: the hybrid law's springs and dampers, coupled by the inertia at the
//! end effector.
//!
//! ```text
//! tau = J' (Sk Lambda Sk J (q_ref - q) + Sd Lambda Sd J (g dq_ref - dq)) + N' (Kq (q_ref - q) + Kqd (g dq_ref - dq))
//!       + coriolis
//! Sk  = sqrt(Kx / m)        Sd = sqrt(Kxd / m)        m = diagonal of Lambda
//! N'  = 1 - J' Lambda6 J M^-1
//! ```
//!
//! The idea is Khatib's (IEEE Journal on Robotics and Automation 3(1), 1987): wrenches follow from
//! desired accelerations through the inertia `Lambda`. An error along one axis therefore moves the
//! arm along that axis, although its inertia differs between directions. In Khatib's law an
//! acceleration is `(Kx e + Kxd de) / m`, with one mass for all axes. Here each axis has the arm's
//! own mass along this axis, and stiffness and damping enter from both sides of `Lambda`:
//!
//! - gains keep their units and their meaning: a displacement along an axis causes exactly `Kx`
//!   along it. If an axis is coupled with others, forces across are added;
//! - the matrices are symmetric and not negative at every pose, so springs store energy and dampers
//!   dissipate it;
//! - the wrench is bounded near singularities: for every `Lambda`, the entries of `Sk Lambda Sk`
//!   are at most `sqrt(Kx_i Kx_j)`.
//!
//! With equal gains and masses along the axes the law is exactly Khatib's. `Lambda` is computed for
//! position and rotation separately, each with the other left free. For both together the arm has
//! five times the mass at the ready pose, because position and rotation of a hand are coupled. The
//! null-space projection of the joints' springs uses the full matrix, `Lambda6`, damped near
//! singularities. There the springs of the joints also act in the directions that the end effector
//! has lost.
//!
//! At a wall where no friction holds the arm, forces across also occur: the arm slides along the
//! wall until these forces are balanced. It slides about two thirds of its goal's depth behind the
//! wall (simulated, ready pose, downwards).
//!
//! The law has no feedforward of the reference's acceleration. The inertia includes the links and,
//! nominally, the rotors.

use nalgebra::{Matrix3, Matrix6};

use crate::law::task_space::TaskSpace;

/// Returns `S Lambda S` of springs or dampers at the end effector, base axes: the response to an
/// error at the end effector.
pub(crate) fn coupled(gains: &[f64; 6], space: &TaskSpace) -> Matrix6<f64> {
    let mut coupled = Matrix6::zeros();
    for (at, inertia) in [(0, space.translational()), (3, space.rotational())] {
        let root = |i: usize| (gains[at + i] / inertia[(i, i)]).sqrt();
        let block = Matrix3::from_fn(|i, j| root(i) * inertia[(i, j)] * root(j));
        coupled.fixed_view_mut::<3, 3>(at, at).copy_from(&block);
    }
    coupled
}
