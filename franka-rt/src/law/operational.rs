//! The operational-space law: the hybrid law's springs and dampers, coupled by the inertia at the end effector.
//!
//! ```text
//! tau = J' (Sk Lambda Sk J (q_ref - q) + Sd Lambda Sd J (g dq_ref - dq)) + N' (Kq (q_ref - q) + Kqd (g dq_ref - dq))
//!       + coriolis
//! Sk  = sqrt(Kx / m)        Sd = sqrt(Kxd / m)        m = diagonal of Lambda
//! N'  = 1 - J' Lambda6 J M^-1
//! ```
//!
//! The idea is that of Khatib (IEEE Journal on Robotics and Automation 3(1), 1987): wrenches are made of wished
//! accelerations through the inertia `Lambda`, so that an error along one axis moves the arm along that axis, although
//! its inertia is not the same in all directions. There an acceleration is `(Kx e + Kxd de) / m`, with one mass for all
//! axes. Here each axis has the mass that the arm itself shows along it, and stiffness and damping enter from both
//! sides of `Lambda`:
//!
//! - gains keep their units and their meaning: a displacement along an axis meets exactly `Kx` along it. Where an axis is
//!   coupled with others, forces across come on top;
//! - the matrices are symmetric and not negative at every pose, so springs store energy and dampers take it;
//! - the wrench is bounded near singularities, for whatever becomes of `Lambda`, the entries of `Sk Lambda Sk` are at most
//!   `sqrt(Kx_i Kx_j)`.
//!
//! With equal gains and masses along the axes it is Khatib's law to the letter. `Lambda` is taken for position and for
//! rotation by themselves, each with the other left free; for both together the arm weighs five times as much at the
//! ready pose, since position and rotation of a hand hang together. In the null-space projection of the joints' springs,
//! `Lambda6` is the full one, damped near singularities: there the springs of the joints act also on what the end
//! effector has lost.
//!
//! There is no feedforward of the reference's acceleration. The inertia is that of the links, without rotors, as the
//! robot's model has it.

use franka_model::Wrench;
use nalgebra::{Matrix3, Vector3};

use crate::law::interaction::Errors;
use crate::law::task_space::TaskSpace;
use crate::law::tuning::Tuning;

/// Of springs and dampers at the end effector, base axes.
pub(crate) fn wrench(tuning: &Tuning, errors: &Errors, space: &TaskSpace) -> Wrench {
    let mut wrench = Wrench::zeros();
    for (at, inertia) in [(0, space.translational()), (3, space.rotational())] {
        let coupled = |gains: &[f64; 6], error: &Wrench| {
            let root = Vector3::from_fn(|i, _| (gains[at + i] / inertia[(i, i)]).sqrt());
            between(&inertia, &root, &error.fixed_rows::<3>(at).into_owned())
        };
        let block = coupled(&tuning.cartesian_stiffness, &errors.pose)
            + coupled(&tuning.cartesian_damping, &errors.twist);
        wrench.fixed_rows_mut::<3>(at).copy_from(&block);
    }
    wrench
}

/// `S Lambda S e`.
fn between(inertia: &Matrix3<f64>, root: &Vector3<f64>, error: &Vector3<f64>) -> Vector3<f64> {
    (inertia * error.component_mul(root)).component_mul(root)
}
