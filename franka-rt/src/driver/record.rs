//! Record of one cycle, as plain numbers for recording and telemetry.

use core::time::Duration;

use franka_proto::{Errors, RobotMode, RobotState};
use nalgebra::Isometry3;

use crate::session::Bindings;
use crate::stats::Slack;

/// One cycle of the driver. All joint quantities are in joint order and in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Record {
    /// `message_id` of the state, `[ms]` of the robot's clock.
    pub time: u64,
    /// Number of states that were lost or skipped just before this state.
    pub skipped: u64,
    /// Activity of the driver in this cycle.
    pub activity: Activity,
    /// The robot's mode.
    pub robot_mode: RobotMode,
    /// Errors that are active in this cycle.
    pub errors: Errors,
    /// Errors that aborted the previous motion.
    pub reflex_reason: Errors,
    /// The robot's `control_command_success_rate`, in `[0, 1]`.
    pub success_rate: f64,
    /// Number of the current goal; 0 if there is no goal.
    pub goal: u64,
    /// Measured joint positions, `[rad]`.
    pub q: [f64; 7],
    /// Measured joint velocities, `[rad/s]`.
    pub dq: [f64; 7],
    /// Reference joint positions, `[rad]`. They also determine the reference pose of the end
    /// effector. This field and the next two are zero outside target control.
    pub q_ref: [f64; 7],
    /// Reference joint velocities, `[rad/s]`.
    pub dq_ref: [f64; 7],
    /// Reference joint accelerations, `[rad/s^2]`.
    pub ddq_ref: [f64; 7],
    /// Joint positions that the reference moves to, `[rad]`. For a moving target, its current
    /// position. `None` outside target control, and if the reference moves to a pose, stops, or
    /// follows a guiding hand.
    pub q_target: Option<[f64; 7]>,
    /// Pose of the end effector that the reference moves to, in the base frame, `[m]`. If the
    /// goal has a grasp, it is the pose of the held object. `None` outside target control, and if
    /// the reference moves to joint positions, stops, or follows a guiding hand.
    pub pose_target: Option<Isometry3<f64>>,
    /// Time since the program received the goal.
    pub elapsed: Duration,
    /// Time until the reference reaches the goal's target or the last point of its chunk. If the
    /// reference brakes or is paused, time until it rests. Zero at the target and during hand
    /// guiding.
    pub remaining: Duration,
    /// Commanded joint torques without gravity and friction, `[N m]`. Zero under active control,
    /// because its commands are sent after the cycle.
    pub tau_c: [f64; 7],
    /// Torque that compensates friction and bias, before the guards change it, `[N m]`; zero
    /// outside target control.
    pub compensation: [f64; 7],
    /// Guards that limited the command.
    pub bindings: Bindings,
    /// Time by which the state was late: see [`CycleTimes::late`](crate::stats::CycleTimes::late).
    pub late: Duration,
    /// Time from the receipt of the state to the departure of its command; zero without a command.
    /// Also zero under active control, because its command is sent after the record is made.
    pub turnaround: Duration,
    /// Time from the departure of the command until the next state was due; `None` if
    /// [`turnaround`](Self::turnaround) is zero.
    pub slack: Option<Slack>,
}

/// Activity of the driver in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Activity {
    /// No motion is armed or running.
    #[default]
    Watching,
    /// A motion is armed, and the robot does not show the motion's modes yet.
    Armed,
    /// The robot is ready for a common start. The driver holds the arm until all robots are ready.
    Waiting,
    /// A motion is running.
    Running,
    /// The driver repeats the finishing command.
    Finishing,
    /// The motion's program failed or was given up, and the robot has not left the motion's modes
    /// yet.
    Silent,
}

impl Record {
    pub(super) fn watching(state: &RobotState, skipped: u64) -> Self {
        Self {
            time: state.message_id,
            skipped,
            robot_mode: state.robot_mode,
            errors: state.errors,
            reflex_reason: state.reflex_reason,
            success_rate: state.control_command_success_rate,
            q: state.q,
            dq: state.dq,
            ..Self::default()
        }
    }
}
