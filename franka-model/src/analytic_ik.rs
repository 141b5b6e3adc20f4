//! Every joint position for a pose of the flange and one number that picks the self-motion.
//!
//! The arm has a joint more than a pose has coordinates. With the right number given beside the
//! pose ([`Redundancy`]) finitely many postures remain, and all of them are found:
//!
//! ```text
//! joint 7 ──────────────┐
//! joint 4 ─> joint 7 (2)├─> wrist ─> elbow: q4 (2) ─> wrist: q6, q5 (2) ─> shoulder: q1, q2, q3 (2)
//! swivel ──> joint 7 ───┘
//! ```
//!
//! With joint 7 given, the flange's pose fixes the wrist W, where axes 5 and 6 meet. Shoulder S,
//! elbow E and wrist make a triangle, whose sides give joint 4; the direction of the forearm in the
//! hand's axes gives joints 6 and 5; what is left for joints 1, 2 and 3 is a rotation. Every step
//! is an equivalence with two answers at most, so none is lost. Fixing joint 7 is the idea of He
//! and Liu (2021), the enumeration and the other two parameters are those of López-Custodio, Gong
//! and Figueredo (GeoFIK, 2025).
//!
//! | given | how | at most |
//! |---|---|---|
//! | [`Joint7`](Redundancy::Joint7) | closed form | 8 |
//! | [`Joint4`](Redundancy::Joint4) | closed form: the distance of W from S gives two angles of joint 7 | 8 |
//! | [`Swivel`](Redundancy::Swivel) | one equation in joint 7, whose roots are bracketed and refined | 32 listed; 12 within limits seen |
//!
//! | module | content |
//! |---|---|
//! | [`solutions`] | the answers: branch, distance to limits and singularities, the nearest |
//! | [`reach`] | whether a pose or a point is within reach, and how far from the boundary |
//!
//! The driver's own cycle does not call this module: it follows poses with
//! [`differential_ik`](crate::differential_ik) and starts from
//! [`inverse_kinematics`](crate::inverse_kinematics). It is for programs that choose a posture, or
//! refuse a target, before anything moves: planners, paths through waypoints, tools.
//!
//! # Singularities
//!
//! Seen from a solver, a singularity is where solutions meet. With joint 7 locked they are where
//! the determinant `L1 L2 sin(q4 − flip) · sin(q2) · f(q4) cos(q5)` of the other six joints
//! vanishes, and each is answered in its own way:
//!
//! - **Stretched elbow** (joint 4 at its [flip angle](Lengths::flip_angle)) and **wrist** (joint 5
//!   a quarter turn off): two solutions approach each other, like the roots of `x² = ε`, and meet
//!   in one. It is listed twice there, and a pose beyond by less than 1e-12 in the cosine counts
//!   as on it. Both solutions are continuous up to that place; beyond there is none.
//! - **Shoulder** (joint 2 at zero): axes 1 and 3 coincide, and the pose fixes the sum of their
//!   angles only. There each takes half, [`Solution::slide`] tells how far joint 1 may turn while
//!   joint 3 turns back, and [`Solutions::nearest`] slides to the posture nearest to the given one,
//!   which is therefore continued through the singularity: joint 2 changes sign, joints 1 and 3 do
//!   not move. Every answer meets its pose also in the neighbourhood, but a path that passes
//!   *beside* the singularity at a distance has to turn joint 1 by up to half a turn there, as
//!   close as it passes. This is the arm's nature, not the solver's;
//!   [`differential_ik`](crate::differential_ik) goes around it with bounded velocities.
//! - Joint 4 given: the two angles of joint 7 meet where they pass each other. If the shoulder is
//!   on axis 7 the angle of joint 7 is free, and zero stands for all.
//! - Swivel given: it is undefined where the wrist is straight above or below the shoulder, and
//!   no solution is sought within a nanometre of that.

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

/// What picks among the self-motions of a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Redundancy {
    /// The angle of joint 7, `[rad]`.
    Joint7(f64),
    /// The angle of joint 4, `[rad]`: the distance between shoulder and wrist.
    Joint4(f64),
    /// The [swivel angle](crate::elbow::swivel), `[rad]`: where the elbow is on its circle about
    /// the line from shoulder to wrist, zero when it is on top.
    Swivel(f64),
}

impl Redundancy {
    fn is_finite(self) -> bool {
        let (Self::Joint7(angle) | Self::Joint4(angle) | Self::Swivel(angle)) = self;
        angle.is_finite()
    }
}

/// The solutions within the joint limits that bring the end effector to `target`. There may be
/// none.
///
/// An end-effector frame that is not quite rigid counts as its nearest rigid one. What it costs is
/// in the benchmarks (`model.ik_all_ns`, `model.ik_joint_4_ns`, `model.ik_swivel_ns`).
///
/// # Errors
/// [`IkError::NotFinite`] and [`IkError::EndEffectorNotRigid`].
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

/// All solutions for a pose of the flange in the base frame, whatever the limits.
///
/// Angles are in `(−π, π]`, given ones as given. The same for both kinds of robot with the same
/// lengths. Empty if a number is non-finite.
pub fn all(lengths: &Lengths, flange: &Isometry3<f64>, given: Redundancy) -> Solutions {
    let flip = lengths.flip_angle();
    find(lengths, flange, given, [flip - PI, flip + PI])
}

/// Solutions of which those with joint 4 outside `q4_range` may be left out.
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

/// Pose of the flange that brings the end effector to `target`.
fn flange_of(target: &Isometry3<f64>, ee: &EndEffector) -> Result<Isometry3<f64>, IkError> {
    let tool = transform::isometry(&ee.f_t_ee).ok_or(IkError::EndEffectorNotRigid)?;
    let flange = target * tool.inverse();
    let numbers = flange.translation.vector.iter();
    let finite = numbers
        .chain(flange.rotation.coords.iter())
        .all(|x| x.is_finite());
    finite.then_some(flange).ok_or(IkError::NotFinite)
}

/// All postures of a sweep of joint 7 through its range, within the limits.
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

/// Angle moved by whole turns into `(−π, π]`.
fn wrapped(angle: f64) -> f64 {
    let (sin, cos) = crate::scalar::sin_cos(angle);
    crate::scalar::atan2(sin, cos)
}

#[cfg(test)]
mod tests;
