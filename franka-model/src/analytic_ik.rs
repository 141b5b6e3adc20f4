//! All joint positions for a pose of the flange and one redundancy parameter.
//!
//! The arm has seven joints, and a pose has six coordinates. With one more number given, a
//! [`Redundancy`], finitely many postures reach the pose. This module finds all of them:
//!
//! ```text
//! joint 7 ──────────────┐
//! joint 4 ─> joint 7 (2)├─> wrist ─> elbow: q4 (2) ─> wrist: q6, q5 (2) ─> shoulder: q1, q2, q3 (2)
//! swivel ──> joint 7 ───┘
//! ```
//!
//! If joint 7 is given, the flange's pose determines the wrist W, where axes 5 and 6 meet. The
//! shoulder S, the elbow E and the wrist form a triangle, and its sides determine joint 4. In the
//! hand's axes, the direction of the forearm determines joints 6 and 5. The remaining rotation
//! determines joints 1 to 3. Every step finds all of its at most two answers, so no solution is
//! lost. The method for a given joint 7 comes from He and Liu (2021). The enumeration and the
//! methods for joint 4 and the swivel angle come from López-Custodio, Gong and Figueredo (GeoFIK,
//! 2025).
//!
//! | given | method | solutions, at most |
//! |---|---|---|
//! | [`Joint7`](Redundancy::Joint7) | closed form | 8 |
//! | [`Joint4`](Redundancy::Joint4) | closed form: the distance of W from S gives two angles of joint 7 | 8 |
//! | [`Swivel`](Redundancy::Swivel) | one equation in joint 7, whose roots are bracketed and refined | 32 in the list; 12 within the limits were seen |
//!
//! | module | content |
//! |---|---|
//! | [`solutions`] | the solutions: branch, distance to limits and singularities, the nearest |
//! | [`reach`] | reachability of a pose or a point, and its distance from the boundary |
//!
//! The driver's own cycle does not call this module: it follows poses with
//! [`differential_ik`](crate::differential_ik) and starts from
//! [`inverse_kinematics`](crate::inverse_kinematics). Use this module before a motion, to choose a
//! posture or to refuse a target.
//!
//! # Singularities
//!
//! For a solver, a singularity is a posture where solutions meet. If joint 7 is locked, the
//! Jacobian of the other six joints has the determinant `L1 L2 sin(q4 − flip) · sin(q2) · f(q4)
//! cos(q5)`, which is zero there. The solver handles each singularity in its own way:
//!
//! - **Stretched elbow** (joint 4 at its [flip angle](Lengths::flip_angle)) and **wrist** (joint 5
//!   a quarter turn off): two solutions approach each other, like the roots of `x² = ε`, and
//!   coincide. The list then contains the same solution twice. A pose whose cosine exceeds the
//!   boundary by less than 1e-12 counts as a pose on the boundary. Both solutions are continuous up
//!   to the boundary; beyond it no solution exists.
//! - **Shoulder** (joint 2 at zero): axes 1 and 3 coincide, and the pose fixes only the sum of
//!   their angles. Each of the two joints then gets half of the sum. [`Solution::slide`] is the
//!   range in which joint 1 may turn while joint 3 turns back. [`Solutions::nearest`] slides to the
//!   posture nearest to a reference posture. A path through the singularity is therefore
//!   continuous: joint 2 changes sign, and joints 1 and 3 do not move. A path that passes *beside*
//!   the singularity must turn joint 1 by up to half a turn. The closer the path is, the shorter is
//!   the part of the path in which joint 1 turns. This large turn is a property of the arm, not of
//!   the solver; [`differential_ik`](crate::differential_ik) passes it with bounded velocities.
//! - If joint 4 is given, the two angles of joint 7 may coincide. If the shoulder is on axis 7, the
//!   angle of joint 7 is free, and zero represents all angles.
//! - If the swivel angle is given: the angle is undefined if the wrist is straight above or below
//!   the shoulder. The solver therefore ignores solutions whose wrist is within a nanometre of the
//!   vertical line through the shoulder.

use core::f64::consts::PI;

use nalgebra::Isometry3;

use crate::frame::EndEffector;
use crate::geometry::Lengths;
use crate::inverse_kinematics::IkError;
use crate::model::Model;
use crate::transform;

mod bracket;
mod joint_4;
mod joint_7;
mod nearest;
pub mod reach;
pub mod solutions;
mod swivel;

pub use nearest::nearest;
pub use solutions::{Branch, Singularity, Solution, Solutions};

/// Parameter that leaves finitely many of the postures that reach a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Redundancy {
    /// The angle of joint 7, `[rad]`.
    Joint7(f64),
    /// The angle of joint 4, `[rad]`. It determines the distance between shoulder and wrist.
    Joint4(f64),
    /// The [swivel angle](crate::elbow::swivel), `[rad]`: the position of the elbow on its circle
    /// about the line from shoulder to wrist. The angle is zero if the elbow is on top.
    Swivel(f64),
}

impl Redundancy {
    fn is_finite(self) -> bool {
        let (Self::Joint7(angle) | Self::Joint4(angle) | Self::Swivel(angle)) = self;
        angle.is_finite()
    }
}

/// Returns the solutions within the joint limits that bring the end effector to `target`. The list
/// may be empty.
///
/// If the end-effector frame is slightly non-rigid, the solver uses the nearest rigid frame. The
/// benchmarks measure the cost (`model.ik_all_ns`, `model.ik_joint_4_ns`, `model.ik_swivel_ns`).
///
/// # Errors
/// Returns [`IkError`] if an argument is not finite or the end-effector frame is not rigid.
pub fn solve(
    model: &Model,
    target: &Isometry3<f64>,
    ee: &EndEffector,
    given: Redundancy,
) -> Result<Solutions, IkError> {
    let flange = flange_of(target, ee)?;
    if !given.is_finite() {
        return Err(IkError::NotFinite);
    }
    let limits = model.joint_limits();
    let (lower, upper) = (&limits.lower, &limits.upper);
    let found = find(model.lengths(), &flange, given, [lower[3], upper[3]]);
    Ok(found.within(lower, upper))
}

/// Returns all solutions for a pose of the flange in the base frame, regardless of the limits.
///
/// Angles are in `(−π, π]`, and a given angle is returned unchanged. The result depends on the
/// lengths, not on the kind of robot. The list is empty if an argument is not finite.
pub fn all(lengths: &Lengths, flange: &Isometry3<f64>, given: Redundancy) -> Solutions {
    let flip = lengths.flip_angle();
    find(lengths, flange, given, [flip - PI, flip + PI])
}

/// Returns the solutions; solutions with joint 4 outside `q4_range` may be omitted.
fn find(
    lengths: &Lengths,
    flange: &Isometry3<f64>,
    given: Redundancy,
    q4_range: [f64; 2],
) -> Solutions {
    match given {
        Redundancy::Joint7(q7) => joint_7::all(lengths, flange, q7),
        Redundancy::Joint4(q4) => joint_4::all(lengths, flange, q4),
        Redundancy::Swivel(angle) => swivel::all(lengths, flange, angle, q4_range),
    }
}

/// Returns the pose of the flange that brings the end effector to `target`.
fn flange_of(target: &Isometry3<f64>, ee: &EndEffector) -> Result<Isometry3<f64>, IkError> {
    let tool = transform::isometry(&ee.f_t_ee).ok_or(IkError::EndEffectorNotRigid)?;
    let flange = target * tool.inverse();
    let numbers = flange.translation.vector.iter();
    let finite = numbers
        .chain(flange.rotation.coords.iter())
        .all(|x| x.is_finite());
    finite.then_some(flange).ok_or(IkError::NotFinite)
}

/// Sweeps joint 7 through its range and returns all postures within the limits.
fn sweep(model: &Model, flange: &Isometry3<f64>, steps: u32) -> impl Iterator<Item = Solution> {
    let limits = model.joint_limits();
    let (lower, upper) = (&limits.lower, &limits.upper);
    let angle = move |step: u32| {
        let share = f64::from(step) / f64::from(steps);
        lower[6] + (upper[6] - lower[6]) * share
    };
    (0..=steps).flat_map(move |step| {
        let found = joint_7::all(model.lengths(), flange, angle(step)).within(lower, upper);
        (0..found.len()).map(move |index| found[index])
    })
}

/// Returns the angle, shifted by whole turns into `(−π, π]`.
fn wrapped(angle: f64) -> f64 {
    let (sin, cos) = crate::scalar::sin_cos(angle);
    crate::scalar::atan2(sin, cos)
}

#[cfg(test)]
mod tests;
