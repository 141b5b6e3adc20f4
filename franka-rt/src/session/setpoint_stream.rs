//! The stream of setpoints to the robot's own controller, and where it goes on after lost commands.

use franka_model::limits::JointLimits;
use franka_model::{EndEffector, Frame, JointVector, Model, transform};
use franka_proto::{RobotState, Version};
use nalgebra::Vector3;

use crate::control::{CartesianPose, JointPositions, MotionCommand, Shaper};
use crate::session::backend::{Setpoints, elbow};
use crate::session::guard::backstop;
use crate::session::reference::Reference;
use crate::session::rigid;
use crate::shaping::{CYCLE, MAX_CUTOFF_FREQUENCY};

/// How far the robot's setpoint may be from the one that it was sent, `[rad]`, for the two to count
/// as the same: more than its echo is rounded by, and less than any cycle of a motion that matters.
const ECHO: f64 = 2e-6;

/// The same of a pose and an elbow, `[m, rad]`. No backstop limits the joints behind a pose: what
/// is overlooked here comes back in them as a jerk, at most a fifth of what the gentlest joint may
/// have.
const POSE_ECHO: f64 = 3e-7;

/// How little the limiter may change a pose and an elbow, `[m, rad]`, for them to count as
/// unchanged: the joints behind them feel some ten times as much, a jerk of 100 rad/s^3.
const SAME: f64 = 1e-8;

/// Share that is kept of what the limiter lets pass when joints are held back: it is found along a
/// straight line.
const EASE: f64 = 0.95;

/// Times that joints are held back anew in a cycle.
const EASINGS: usize = 3;

/// Streams setpoints to the robot's controller.
#[derive(Debug)]
pub(super) struct SetpointStream {
    setpoints: Setpoints,
    shaper: Shaper,
    /// Whether no setpoint has been sent.
    first: bool,
}

impl SetpointStream {
    pub(super) fn new(setpoints: Setpoints, version: Version, limits: &JointLimits) -> Self {
        Self {
            setpoints,
            shaper: Shaper::new(version, true, MAX_CUTOFF_FREQUENCY)
                .with_bounds(backstop::bounds(version))
                .with_limits_of(limits),
            first: true,
        }
    }

    pub(super) fn setpoints(&self) -> Setpoints {
        self.setpoints
    }

    /// Returns the setpoint as the robot has it, if it differs from `reference`. Cartesian
    /// setpoints are compared as commanded, and the robot's own joints are taken over.
    pub(super) fn echo(
        &self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        state: &RobotState,
    ) -> Option<Reference> {
        let differs = match self.setpoints {
            _ if self.first => true,
            Setpoints::Joints => (JointVector::from(state.q_d) - reference.q).amax() > ECHO,
            Setpoints::Poses => {
                let echo = CartesianPose {
                    O_T_EE: state.O_T_EE_c,
                    elbow: Some(state.elbow_c),
                };
                apart(&pose_at(model, ee, &reference.q), &echo).amax() > POSE_ECHO
            }
        };
        let [q, dq, ddq] = [state.q_d, state.dq_d, state.ddq_d].map(JointVector::from);
        // The robot's velocity is the mean of its last cycle, the reference's that at the end of
        // it.
        differs.then(|| Reference {
            q,
            dq: dq + ddq * (0.5 * CYCLE),
            ddq,
        })
    }

    /// The command for `reference`, and whether the backstop changed it. A command that cannot be
    /// shaped, as from a non-finite reference, is the robot's own setpoint.
    pub(super) fn command(
        &mut self,
        model: &Model,
        ee: &EndEffector,
        reference: &Reference,
        state: &RobotState,
    ) -> (MotionCommand, bool) {
        let first = core::mem::take(&mut self.first);
        match self.setpoints {
            Setpoints::Joints => {
                let wish = JointPositions(reference.q.into());
                let shaped = self.shaper.joint_positions(&wish, state, first);
                let shaped = shaped.unwrap_or(JointPositions(state.q_d));
                let changed = (JointVector::from(shaped.0) - reference.q).amax() > ECHO;
                (shaped.into(), changed)
            }
            Setpoints::Poses if first => {
                let start = CartesianPose {
                    O_T_EE: state.O_T_EE_c,
                    elbow: Some(elbow(&reference.q)),
                };
                let shaped = self.shaper.cartesian_pose(&start, state, true);
                (shaped.unwrap_or(start).into(), false)
            }
            Setpoints::Poses => {
                let pose = |q: &JointVector| pose_at(model, ee, q);
                let (command, changed) = self.eased(pose, reference, state);
                (command.into(), changed)
            }
        }
    }

    /// The pose and elbow of `reference` within the limits of both, and whether that took a change.
    ///
    /// A pose changed by the limiter would make the robot find other joints, with no limits
    /// applied. So the joints are held back instead, towards where they get without a jerk, by as
    /// much as the limiter held back their pose.
    fn eased(
        &self,
        pose: impl Fn(&JointVector) -> CartesianPose,
        reference: &Reference,
        state: &RobotState,
    ) -> (CartesianPose, bool) {
        let shape = |asked: &CartesianPose| {
            let shaped = self.shaper.cartesian_pose(asked, state, false);
            shaped.unwrap_or(CartesianPose {
                O_T_EE: state.O_T_EE_c,
                ..*asked
            })
        };
        let mut asked = pose(&reference.q);
        let mut shaped = shape(&asked);
        if apart(&shaped, &asked).amax() <= SAME {
            return (shaped, false);
        }
        let [q, dq, ddq] = [state.q_d, state.dq_d, state.ddq_d].map(JointVector::from);
        let coasting = q + (dq + ddq * CYCLE) * CYCLE;
        let base = pose(&coasting);
        let mut share = 1.0;
        for _ in 0..EASINGS {
            let (left, all) = (apart(&shaped, &base), apart(&asked, &base));
            share *= EASE * left.zip_map(&all, |left, all| (left / all).min(1.0)).min();
            asked = pose(&(coasting + (reference.q - coasting) * share));
            shaped = shape(&asked);
            if apart(&shaped, &asked).amax() <= SAME {
                break;
            }
        }
        (shaped, true)
    }
}

/// The pose and the elbow at these joint positions.
fn pose_at(model: &Model, ee: &EndEffector, q: &JointVector) -> CartesianPose {
    CartesianPose {
        O_T_EE: transform::array(&rigid(&model.pose(Frame::EndEffector, q, ee))),
        elbow: Some(elbow(q)),
    }
}

/// How far two poses are apart: in translation, in the elements of their rotation, in the elbow.
fn apart(a: &CartesianPose, b: &CartesianPose) -> Vector3<f64> {
    let squares = |elements: core::ops::Range<usize>| -> f64 {
        elements.map(|i| (a.O_T_EE[i] - b.O_T_EE[i]).powi(2)).sum()
    };
    let [ours, theirs] = [a, b].map(|pose| pose.elbow.map_or(0.0, |[angle, _]| angle));
    Vector3::new(
        squares(12..15).sqrt(),
        squares(0..11).sqrt(),
        (ours - theirs).abs(),
    )
}
