//! The path of an external controller's torques to the drives.

use std::collections::VecDeque;

use franka_model::JointVector;

use crate::arm::Drive;

/// Delay and lag of the torque interface. The robot's own controllers close their loops around the
/// motors and have neither delay nor lag.
#[derive(Debug, Clone)]
pub(super) struct TorqueInterface {
    /// Commands that do not act yet, the oldest first. Their number is the additional delay in
    /// cycles. The protocol itself has a delay of one cycle.
    pending: VecDeque<JointVector>,
    /// Time constant of the lag, `[s]`.
    lag: f64,
    /// Torque that the drives follow now, `[N·m]`.
    torque: JointVector,
}

impl TorqueInterface {
    pub(super) fn new(drive: &Drive) -> Self {
        let delay = drive.command_delay.saturating_sub(1) as usize;
        Self {
            pending: std::iter::repeat_n(JointVector::zeros(), delay).collect(),
            lag: drive.torque_lag,
            torque: JointVector::zeros(),
        }
    }

    /// Discards all torques, because no command is active.
    pub(super) fn clear(&mut self) {
        self.pending.iter_mut().for_each(|torque| torque.fill(0.0));
        self.torque = JointVector::zeros();
    }

    /// Accepts the command of a cycle. Returns the command that acts in this cycle, `[N·m]`.
    pub(super) fn delayed(&mut self, command: JointVector) -> JointVector {
        self.pending.push_back(command);
        self.pending.pop_front().unwrap_or(command)
    }

    /// Returns the torque that the drives follow over the next `dt` seconds under this command,
    /// `[N·m]`.
    pub(super) fn lagged(&mut self, command: &JointVector, dt: f64) -> JointVector {
        if self.lag > 0.0 {
            self.torque += (command - self.torque) * -(-dt / self.lag).exp_m1();
        } else {
            self.torque = *command;
        }
        self.torque
    }
}
