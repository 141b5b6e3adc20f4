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
//! The idea is that of Khatib (IEEE Journal on Robotics and Automation 3(1), 1987): wrenches are
//! made of wished accelerations through the inertia `Lambda`, so that an error along one axis moves
//! the arm along that axis, although its inertia is not the same in all directions. There an
//! acceleration is `(Kx e + Kxd de) / m`, with one mass for all axes. Here each axis has the mass
//! that the arm itself shows along it, and stiffness and damping enter from both sides of `Lambda`:
//!
//! - gains keep their units and their meaning: a displacement along an axis meets exactly `Kx`
//!   along it. Where an axis is coupled with others, forces across come on top;
//! - the matrices are symmetric and not negative at every pose, so springs store energy and dampers
//!   take it;
//! - the wrench is bounded near singularities, for whatever becomes of `Lambda`, the entries of
//!   `Sk Lambda Sk` are at most `sqrt(Kx_i Kx_j)`.
//!
//! With equal gains and masses along the axes it is Khatib's law to the letter. `Lambda` is taken
//! for position and for rotation by themselves, each with the other left free; for both together
//! the arm weighs five times as much at the ready pose, since position and rotation of a hand hang
//! together. In the null-space projection of the joints' springs, `Lambda6` is the full one, damped
//! near singularities: there the springs of the joints act also in the directions that the end
//! effector has lost.
//!
//! A wall on which nothing holds the arm by friction is met with forces across as well: the arm
//! slides along it until they are balanced, about two thirds as far as its goal is deep behind the
//! wall (simulated, ready pose, downwards).
//!
//! There is no feedforward of the reference's acceleration. The inertia is that of the links and,
//! nominally, of the rotors.

use nalgebra::{Matrix3, Matrix6};

use crate::law::task_space::TaskSpace;

/// `S Lambda S` of springs or dampers at the end effector, base axes: what an error there is met
/// with.
pub(crate) fn coupled(gains: &[f64; 6], space: &TaskSpace) -> Matrix6<f64> {
    let mut coupled = Matrix6::zeros();
    for (at, inertia) in [(0, space.translational()), (3, space.rotational())] {
        let root = |i: usize| (gains[at + i] / inertia[(i, i)]).sqrt();
        let block = Matrix3::from_fn(|i, j| root(i) * inertia[(i, j)] * root(j));
        coupled.fixed_view_mut::<3, 3>(at, at).copy_from(&block);
    }
    coupled
}
