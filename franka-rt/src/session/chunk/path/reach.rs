//! Whether the arm can follow a path of poses, all along it.
//!
//! The joints go along the whole way, rounded corners included, in small steps from where they are,
//! by the inverse kinematics that the control cycle uses: with its damping, its rule for the arm's
//! free direction, and the ends of the joints' ranges that it keeps. What the cycle has besides
//! does not decide where an arm gets: velocities and accelerations of joints that a pose asks too
//! much of hold the path up, and it waits.
//!
//! Joint positions need no such check: where two of them are in range, all between them are.

use core::ops::ControlFlow;

use franka_model::differential_ik::{DifferentialIk, JointBox, Side};
use franka_model::{EndEffector, Frame, JointVector, Model, Twist, rotation};
use nalgebra::Isometry3;

use super::PathError;
use super::fastest::Timed;
use crate::session::Budget;
use crate::session::chunk::curve_state::stacked;
use crate::session::guard::joint_bounds;
use crate::session::kinematics::Posture;
use crate::session::pose::PoseState;
use crate::session::rigid;

/// How far off the way the end effector may stay, `[m]`: as far as a goal counts as arrived.
pub(super) const OFF_TRANSLATION: f64 = 1e-3;

/// The same of its orientation, `[rad]`.
pub(super) const OFF_ROTATION: f64 = 5e-3;

/// Longest step along the way, `[m]`.
const STEP_TRANSLATION: f64 = 5e-3;

/// The same of the orientation, `[rad]`.
const STEP_ROTATION: f64 = 0.02;

/// Distance, in units of what it may be off, that counts as none.
const THERE: f64 = 0.02;

/// Attempts to come nearer to one place of the way, as long as the last ones may get there.
const ATTEMPTS: usize = 60;

/// Most steps between two states of a way: it has no more at the steps above, unless its numbers
/// make no sense.
const STEPS_MAX: f64 = 1e4;

/// The most that a joint turns in one attempt, `[rad]`.
const TURN: f64 = 0.1;

/// A step of the joints along a way.
#[derive(Debug)]
pub(super) struct Step {
    /// Since the begin of the way, `[s]`.
    pub(super) time: f64,
    /// The leg that it lies on.
    pub(super) leg: usize,
    /// Where the end effector is to be.
    pub(super) pose: Isometry3<f64>,
    /// Where the joints then are, `[rad]`.
    pub(super) q: JointVector,
    /// How far off the end effector stays.
    pub(super) off: Off,
}

/// Checks that the arm follows `way` from the joint positions `q` on. `pass` is called with the
/// time and the joint positions of each step.
pub(super) fn check(
    way: &Timed<PoseState>,
    q: JointVector,
    arm: &Arm<'_>,
    pass: &mut impl FnMut(f64, &JointVector),
) -> Result<(), PathError> {
    let way = arm.along(way, q, |step| {
        pass(step.time, &step.q);
        if step.off.size() <= 1.0 {
            return ControlFlow::Continue(());
        }
        let p = step.pose.translation.vector;
        ControlFlow::Break(PathError::Way {
            from: step.leg,
            to: step.leg + 1,
            x: p.x,
            y: p.y,
            z: p.z,
            translation: step.off.translation,
            rotation: step.off.rotation,
            joint: joint_bounds::at_end(arm.model.joint_limits(), &step.q),
        })
    });
    way.break_value().map_or(Ok(()), Err)
}

/// How far the end effector is off the way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Off {
    twist: Twist,
    translation: f64,
    rotation: f64,
}

impl Off {
    pub(super) fn between(pose: &Isometry3<f64>, now: &Isometry3<f64>) -> Self {
        let way = pose.translation.vector - now.translation.vector;
        let turn = rotation::error(&pose.rotation, &now.rotation);
        Self {
            twist: stacked(&way, &turn),
            translation: way.norm(),
            rotation: turn.norm(),
        }
    }

    /// In units of what it may be.
    pub(super) fn size(&self) -> f64 {
        (self.translation / OFF_TRANSLATION).max(self.rotation / OFF_ROTATION)
    }
}

/// The arm that is to follow a way.
pub(super) struct Arm<'a> {
    /// Where its free direction goes.
    pub(super) posture: &'a Posture,
    /// How fast that may be.
    pub(super) budget: &'a Budget,
    pub(super) model: &'a Model,
    pub(super) ee: &'a EndEffector,
    /// How many of the steps below are taken at once: 1 for a check, more for a first look.
    pub(super) stride: f64,
}

impl Arm<'_> {
    /// Moves the joints from `q` along `way`, until `each` breaks off.
    pub(super) fn along<B>(
        &self,
        way: &Timed<PoseState>,
        q: JointVector,
        mut each: impl FnMut(&Step) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let mut q = q;
        for (k, times) in way.times.windows(2).enumerate() {
            let duration = times[1] - times[0];
            let [v, omega] = [0.0, 0.5, 1.0]
                .map(|u| way.between(k, u).twist)
                .map(|twist| {
                    [
                        twist.fixed_rows::<3>(0).norm(),
                        twist.fixed_rows::<3>(3).norm(),
                    ]
                })
                .into_iter()
                .fold([0.0_f64; 2], |[v, omega], [a, b]| [v.max(a), omega.max(b)]);
            let steps = duration * (v / STEP_TRANSLATION).max(omega / STEP_ROTATION) / self.stride;
            let steps = steps.ceil().clamp(1.0, STEPS_MAX);
            for step in 1..=steps as usize {
                let at = way.between(k, step as f64 / steps);
                let (reached, off) = self.step(q, &at, duration / steps);
                q = reached;
                each(&Step {
                    time: times[0] + duration * step as f64 / steps,
                    leg: way.legs[k],
                    pose: at.pose,
                    q,
                    off,
                })?;
            }
        }
        ControlFlow::Continue(())
    }

    /// The joints that follow those at `q` to the state `at` within `duration`, and how far off
    /// they stay.
    fn step(&self, q: JointVector, at: &PoseState, duration: f64) -> (JointVector, Off) {
        let speed = at.twist.fixed_rows::<3>(0).norm();
        let mut q = q;
        let mut attempt = 0;
        let mut last = f64::INFINITY;
        loop {
            let (now, jacobian) = self
                .model
                .pose_and_jacobian(Frame::EndEffector, &q, self.ee);
            let off = Off::between(&at.pose, &rigid(&now));
            let left = ATTEMPTS - attempt;
            let gain = off.size() / core::mem::replace(&mut last, off.size());
            let stuck = attempt > 3 && off.size() * gain.powi(left as i32) > 1.0;
            if attempt > 0 && off.size() < THERE || left == 0 || stuck {
                return (q, off);
            }
            let free = if attempt == 0 {
                self.posture.velocity(&q, speed, &jacobian, self.budget) * duration
            } else {
                JointVector::zeros()
            };
            let (lower, upper) = joint_bounds::room(self.model.joint_limits(), &q);
            let bounds = JointBox::new(
                &lower.map(|lower| lower.max(-TURN)),
                &upper.map(|upper| upper.min(TURN)),
            );
            let solution = DifferentialIk::smooth().solve(
                &jacobian,
                &off.twist,
                &free,
                &bounds,
                [Side::Free; 7],
            );
            q += solution.velocity;
            attempt += 1;
        }
    }
}
