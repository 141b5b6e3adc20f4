//! Asynchronous joint positions: sparse targets. The robot itself plans the motion between them.

use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, RobotMode, RobotState};

use super::{Command, JointPositions};
use crate::triple_buffer::{Reader, Writer, triple_buffer};

/// The program of a motion between sparse joint targets. It sends one command for each new target,
/// not one for each state. Only protocol 10 supports this program.
#[derive(Debug)]
pub struct AsynchronousPositions {
    targets: Reader<AsynchronousTarget>,
}

/// A joint target that a [`slot`](crate::slot) passes to the control thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AsynchronousTarget {
    /// Joint positions to move to and hold, `[rad]`.
    pub q: [f64; 7],
    /// True if this target ends the motion.
    pub finished: bool,
}

impl AsynchronousPositions {
    /// Returns a program without a target, and the writer for its targets.
    pub fn new() -> (Self, Writer<AsynchronousTarget>) {
        let (writer, targets) = triple_buffer();
        (Self { targets }, writer)
    }

    /// Returns the request that starts a motion between sparse joint targets. The robot keeps each
    /// joint below `maximum_velocities`, `[rad/s]`.
    pub fn request(maximum_velocities: [f64; 7]) -> MoveRequest {
        MoveRequest {
            asynchronous: Some(maximum_velocities),
            ..MoveRequest::new(
                MoveControllerMode::JointImpedance,
                MoveGeneratorMode::JointPosition,
            )
        }
    }

    /// Returns the command for a target that has not been sent yet, and true if it is the last
    /// command.
    pub(crate) fn step(&mut self) -> Option<(Command, bool)> {
        let AsynchronousTarget { q, finished } = self.targets.read_newer()?;
        let command = Command {
            motion: Some(JointPositions(q).into()),
            torques: None,
        };
        Some((command, finished))
    }
}

/// Progress towards the newest target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum TargetStatus {
    /// There is no target, or the robot does something else.
    Idle,
    /// The arm moves to the target.
    Executing,
    /// The arm rests at the target.
    TargetReached,
    /// The motion has ended.
    Aborted(AbortReason),
}

/// Reason why the robot no longer follows targets. The texts are taken from libfranka 0.21,
/// `async_position_control_handler.cpp`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum AbortReason {
    /// The robot stopped itself.
    #[error("Control aborted due to reflex.")]
    Reflex,
    /// The user stop was pressed.
    #[error("Control aborted due to user stop.")]
    UserStop,
    /// The motion had ended before the target was set.
    #[error("Control interface is in aborted state.")]
    Ended,
}

impl TargetStatus {
    /// Default of the goal tolerance, `[rad]`. A target counts as reached if the desired joint
    /// positions differ from the target by less than this value (Euclidean norm). Source: libfranka
    /// 0.21, `async_position_control_handler.hpp`.
    pub const GOAL_TOLERANCE: f64 = 1e-3;

    /// Norm of the desired joint velocities below which the arm counts as resting, `[rad/s]`.
    /// Source: libfranka 0.21, `async_position_control_handler.hpp`.
    pub const REST: f64 = 0.01;

    /// Returns the progress towards `target`, the newest target, as `state` shows it.
    pub fn of(state: &RobotState, target: Option<&[f64; 7]>, goal_tolerance: f64) -> Self {
        let Some(target) = target else {
            return Self::Idle;
        };
        match state.robot_mode {
            RobotMode::Move | RobotMode::Idle => {
                let left = core::array::from_fn(|joint| state.q_d[joint] - target[joint]);
                if norm(&left) < goal_tolerance && norm(&state.dq_d) < Self::REST {
                    Self::TargetReached
                } else {
                    Self::Executing
                }
            }
            RobotMode::Reflex => Self::Aborted(AbortReason::Reflex),
            RobotMode::UserStopped => Self::Aborted(AbortReason::UserStop),
            _ => Self::Idle,
        }
    }
}

fn norm(values: &[f64; 7]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_status_follows_state_and_target() {
        let state = |robot_mode, q_d, dq_d| RobotState {
            robot_mode,
            q_d: [q_d; 7],
            dq_d: [dq_d; 7],
            ..RobotState::default()
        };
        let target = [0.5; 7];
        let reach = TargetStatus::GOAL_TOLERANCE / 7_f64.sqrt();
        for (state, target, expected) in [
            (state(RobotMode::Move, 0.5, 0.0), None, TargetStatus::Idle),
            (
                state(RobotMode::Move, 0.5, 0.0),
                Some(&target),
                TargetStatus::TargetReached,
            ),
            (
                state(RobotMode::Idle, 0.5 + 0.99 * reach, 0.0037),
                Some(&target),
                TargetStatus::TargetReached,
            ),
            (
                state(RobotMode::Move, 0.5 + 1.01 * reach, 0.0),
                Some(&target),
                TargetStatus::Executing,
            ),
            (
                state(RobotMode::Move, 0.5, 0.0038),
                Some(&target),
                TargetStatus::Executing,
            ),
            (
                state(RobotMode::Reflex, 0.5, 0.0),
                Some(&target),
                TargetStatus::Aborted(AbortReason::Reflex),
            ),
            (
                state(RobotMode::UserStopped, 0.5, 0.0),
                Some(&target),
                TargetStatus::Aborted(AbortReason::UserStop),
            ),
            (
                state(RobotMode::Guiding, 0.5, 0.0),
                Some(&target),
                TargetStatus::Idle,
            ),
        ] {
            let status = TargetStatus::of(&state, target, TargetStatus::GOAL_TOLERANCE);
            assert_eq!(status, expected, "{state:?}");
        }
        assert_eq!(
            AbortReason::Ended.to_string(),
            "Control interface is in aborted state."
        );
    }

    #[test]
    fn a_target_is_sent_once() {
        let (mut program, mut targets) = AsynchronousPositions::new();
        assert!(program.step().is_none());
        targets.write(AsynchronousTarget {
            q: [0.1; 7],
            finished: false,
        });
        let (command, finished) = program.step().expect("a new target");
        assert_eq!(command.motion, Some(JointPositions([0.1; 7]).into()));
        assert!(!finished && program.step().is_none());
        targets.write(AsynchronousTarget {
            q: [0.1; 7],
            finished: true,
        });
        assert!(program.step().expect("the end").1);
    }
}
