//! Checks that the arm can follow a path of poses along its whole length.
//!
//! The joints are moved along the whole path, rounded corners included, in small steps from their
//! present positions. The check uses the inverse kinematics of the control cycle, with its damping,
//! its rule for the arm's free direction, and the ends of the joints' ranges. The cycle's other
//! limits do not change which poses the arm can reach. If a pose requires too much velocity or
//! acceleration from the joints, the path waits.
//!
//! Paths of joint positions need no such check: if two positions are in range, all positions
//! between them are also in range.

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

/// Greatest permitted distance of the end effector from the path, `[m]`. It equals the tolerance of
/// a goal.
pub(super) const OFF_TRANSLATION: f64 = 1e-3;

/// Greatest permitted angle between the end effector and the path's orientation, `[rad]`.
pub(super) const OFF_ROTATION: f64 = 5e-3;

/// Longest step along the path, `[m]`.
const STEP_TRANSLATION: f64 = 5e-3;

/// Greatest rotation in a step along the path, `[rad]`.
const STEP_ROTATION: f64 = 0.02;

/// Distance that counts as zero, as a share of the permitted distance.
const THERE: f64 = 0.02;

/// Maximum number of attempts to get nearer to one place of the path, if the recent attempts made
/// enough progress.
const ATTEMPTS: usize = 60;

/// Maximum number of steps between two states of a path. With steps of the greatest length, a path
/// has more only if its numbers make no sense.
const STEPS_MAX: f64 = 1e4;

/// Greatest rotation of a joint in one attempt, `[rad]`.
const TURN: f64 = 0.1;

#[derive(Debug)]
pub(super) struct Step {
    /// Time since the start of the path, `[s]`.
    pub(super) time: f64,
    pub(super) leg: usize,
    /// Desired pose of the end effector.
    pub(super) pose: Isometry3<f64>,
    /// Joint positions at that time, `[rad]`.
    pub(super) q: JointVector,
    /// Distance that remains between the end effector and the path.
    pub(super) off: Off,
}

/// Checks that the arm can follow `way` from the joint positions `q`. `pass` is called with the
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

/// Distance of the end effector from the path.
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

    /// Returns the distance, divided by the permitted distance.
    pub(super) fn size(&self) -> f64 {
        (self.translation / OFF_TRANSLATION).max(self.rotation / OFF_ROTATION)
    }
}

pub(super) struct Arm<'a> {
    /// Posture that determines the arm's free direction.
    pub(super) posture: &'a Posture,
    pub(super) budget: &'a Budget,
    pub(super) model: &'a Model,
    pub(super) ee: &'a EndEffector,
    /// Number of steps that are combined: 1 for a full check, more for a coarse check.
    pub(super) stride: f64,
}

impl Arm<'_> {
    /// Moves the joints from `q` along `way` until `each` breaks.
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
                let time = times[0] + duration * step as f64 / steps;
                let (reached, off) = self.step(q, &at, (time, duration / steps));
                q = reached;
                each(&Step {
                    time,
                    leg: way.legs[k],
                    pose: at.pose,
                    q,
                    off,
                })?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Returns the joint positions with which the arm follows from `q` to the state `at` within
    /// `duration`, and their distance from that state.
    fn step(
        &self,
        q: JointVector,
        at: &PoseState,
        (time, duration): (f64, f64),
    ) -> (JointVector, Off) {
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
                self.posture.velocity(&q, speed, &jacobian, self.budget)
                    * (duration * self.posture.begun(time))
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
