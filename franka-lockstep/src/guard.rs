//! Check of every command against the robot's limits, independent of the code under test.

use franka_model::CYCLE;
use franka_model::limits::JointLimits;
use franka_proto::{RobotCommand, RobotState};
use franka_rt::driver::Record;
use franka_rt::session::Guard;

/// A check of commands, which keeps the previous command to compute rates.
#[derive(Clone, Copy, Debug)]
pub(super) struct CommandGuard {
    limits: JointLimits,
    last: Option<Last>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    time: u64,
    goal: u64,
    leashed: bool,
    tau: [f64; 7],
    q: [f64; 7],
    q_ref: [f64; 7],
    dq_ref: [f64; 7],
    ddq_ref: [f64; 7],
}

impl CommandGuard {
    /// Returns a check for a robot with these limits.
    pub(super) fn new(limits: JointLimits) -> Self {
        Self { limits, last: None }
    }

    /// Checks a command, and the reference from which it was computed.
    ///
    /// # Panics
    /// Panics if the command violates a limit of the robot, or the reference is not continuous.
    pub(super) fn check(&mut self, command: &RobotCommand, state: &RobotState, record: &Record) {
        let leashed = record.bindings.contains(Guard::Leash);
        assert_eq!(
            command.message_id, state.message_id,
            "a command answers the state it was made for"
        );
        let limits = &self.limits;
        let at = state.message_id;
        for i in 0..7 {
            let joint = i + 1;
            let tau = command.tau_J_d[i];
            assert!(
                tau.is_finite() && tau.abs() <= limits.torque[i],
                "{at}: joint {joint} gets {tau} N m"
            );
            // The robot compares a command with the last command that it received, which an FR3
            // reports as `f32`.
            let rate = (tau - state.tau_J_d[i]).abs() / CYCLE;
            assert!(
                rate <= limits.torque_rate[i] + 0.01,
                "{at}: joint {joint} at {rate} N m/s"
            );
            let dq = record.dq_ref[i];
            assert!(
                dq.abs() <= limits.velocity[i],
                "{at}: reference of joint {joint} at {dq} rad/s"
            );
            let ddq = record.ddq_ref[i];
            let most = limits.acceleration[i] + 1e-6;
            assert!(
                ddq.abs() <= most,
                "{at}: reference of joint {joint} at {ddq} rad/s^2"
            );
        }
        if let Some(last) = self
            .last
            .filter(|last| last.time + 1 == at && last.goal > 0)
        {
            for i in 0..7 {
                let joint = i + 1;
                // If no command was lost in between, compares with the unrounded command.
                let sent = last.tau[i];
                if [sent, f64::from(sent as f32)].contains(&state.tau_J_d[i]) {
                    let rate = (command.tau_J_d[i] - sent).abs() / CYCLE;
                    assert!(
                        rate <= limits.torque_rate[i],
                        "{at}: joint {joint} at {rate} N m/s"
                    );
                }
                if record.goal == 0 {
                    continue; // No reference belongs to a repeated finishing command.
                }
                let step = (record.dq_ref[i] - last.dq_ref[i]).abs() / CYCLE;
                let most = limits.acceleration[i] * 1.001;
                assert!(
                    step <= most,
                    "{at}: reference of joint {joint} steps by {step} rad/s^2"
                );
                // The leash (the limit on the distance between reference and arm) moves the
                // reference with the arm when a push moves the arm.
                let step = record.q_ref[i] - last.q_ref[i];
                let with_arm = step - (state.q[i] - last.q[i]);
                let step = if leashed || last.leashed {
                    step.abs().min(with_arm.abs())
                } else {
                    step.abs()
                };
                let most = limits.velocity[i] * CYCLE * 1.001;
                assert!(
                    step <= most,
                    "{at}: reference of joint {joint} steps by {step} rad"
                );
                let jerk = (record.ddq_ref[i] - last.ddq_ref[i]).abs() / CYCLE;
                let most = limits.jerk[i] * 1.001;
                assert!(
                    jerk <= most,
                    "{at}: reference of joint {joint} at {jerk} rad/s^3"
                );
            }
        }
        let Record {
            goal,
            q_ref,
            dq_ref,
            ddq_ref,
            ..
        } = *record;
        self.last = Some(Last {
            time: at,
            goal,
            leashed,
            tau: command.tau_J_d,
            q: state.q,
            q_ref,
            dq_ref,
            ddq_ref,
        });
    }
}
