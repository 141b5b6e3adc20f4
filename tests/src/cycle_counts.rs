//! Counts of the cycles of a control function, as in libfranka's example `communication_test`.

use core::time::Duration;

use franka_proto::RobotState;

/// Cycles, calls and success rates, counted by a control function.
#[derive(Clone, Copy, Debug, Default)]
pub struct CycleCounts {
    /// Cycles of the robot, from the time steps of the calls.
    pub cycles: u64,
    /// Calls with a time step above zero.
    pub calls: u64,
    /// The largest number of consecutive cycles without a call.
    pub row: u64,
    /// Sum of the success rates.
    rates: f64,
}

impl CycleCounts {
    /// Counts a call.
    pub fn note(&mut self, state: &RobotState, step: Duration) {
        let passed = step.as_millis() as u64;
        // The time step of the first call is zero.
        if passed > 0 {
            self.cycles += passed;
            self.calls += 1;
            self.row = self.row.max(passed - 1);
            self.rates += state.control_command_success_rate;
        }
    }

    /// The number of cycles without a call.
    pub fn lost(&self) -> u64 {
        self.cycles - self.calls
    }

    /// The mean of the success rates.
    pub fn rate(&self) -> f64 {
        self.rates / self.calls as f64
    }
}
