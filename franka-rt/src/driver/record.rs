//! Record of one cycle, as plain numbers for recording and telemetry.

use core::time::Duration;

use franka_proto::{Errors, RobotMode, RobotState};
use nalgebra::Isometry3;

use crate::session::Bindings;
use crate::stats::Slack;

/// One cycle of the driver. All joint quantities are in joint order, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Record {
    /// `message_id` of the state, `[ms]` of the robot's clock.
    pub time: u64,
    /// Number of states lost or skipped just before this one.
    pub skipped: u64,
    /// Activity of the driver.
    pub activity: Activity,
    /// The robot's mode.
    pub robot_mode: RobotMode,
    /// Errors that are active.
    pub errors: Errors,
    /// Errors that aborted the previous motion.
    pub reflex_reason: Errors,
    /// The robot's success rate.
    pub success_rate: f64,
    /// Number of the current goal; 0 without one.
    pub goal: u64,
    /// Measured joint positions, `[rad]`.
    pub q: [f64; 7],
    /// Measured joint velocities, `[rad/s]`.
    pub dq: [f64; 7],
    /// Reference joint positions, `[rad]`. Like the next two fields, zero outside target control.
    /// The reference pose of the end effector is the pose at these positions.
    pub q_ref: [f64; 7],
    /// Reference joint velocities, `[rad/s]`.
    pub dq_ref: [f64; 7],
    /// Reference joint accelerations, `[rad/s^2]`.
    pub ddq_ref: [f64; 7],
    /// Joint positions that the reference moves to, `[rad]`. For a moving target, its present
    /// position. `None` if the reference moves to a pose, stops, or is guided by a hand, and
    /// outside target control.
    pub q_target: Option<[f64; 7]>,
    /// Pose that the reference moves to; `None` in the same way as [`Self::q_target`]. It is the
    /// pose of the end effector in the base frame, or of the object that the hand holds, `[m]`.
    pub pose_target: Option<Isometry3<f64>>,
    /// Time since the program first saw the goal.
    pub elapsed: Duration,
    /// Time until the reference meets the goal's target or the last point of its chunk. If the
    /// reference brakes or is paused, time until it rests. Zero at the target and under a guiding
    /// hand.
    pub remaining: Duration,
    /// Commanded joint torques without gravity and friction, `[N m]`; zero under active control,
    /// whose commands leave after the cycle.
    pub tau_c: [f64; 7],
    /// Part of the torque that compensates friction and bias, before the guards, `[N m]`; zero
    /// outside target control.
    pub compensation: [f64; 7],
    /// Guards that limited the command.
    pub bindings: Bindings,
    /// Delay between the time when the state was due and the time when the thread had it: see
    /// [`CycleTimes::late`](crate::stats::CycleTimes::late).
    pub late: Duration,
    /// Time from the receipt of the state to the departure of its command; zero without a command.
    /// Also zero under active control, whose command leaves after the record is made.
    pub turnaround: Duration,
    /// Time left until the next state was due when the command left; `None` where
    /// [`turnaround`](Self::turnaround) is zero.
    pub slack: Option<Slack>,
}

/// Activity of the driver in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Activity {
    /// No motion is armed or runs.
    #[default]
    Watching,
    /// A motion is armed, and the robot does not show its modes yet.
    Armed,
    /// The robot is ready for a motion of a common start; the arm is held until all robots are
    /// ready.
    Waiting,
    /// A motion runs.
    Running,
    /// The finishing command is being repeated.
    Finishing,
    /// The motion's program has failed or was given up, and the robot has not left the motion yet.
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
