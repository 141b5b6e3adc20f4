//! What a control function notes of the cycles that it is called in, as libfranka's example
//! `communication_test` does.

use core::time::Duration;

use franka_proto::RobotState;

/// Counts of a control function.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Cycles of the robot, by the time that has passed.
    pub cycles: u64,
    /// Calls in which time had passed.
    pub calls: u64,
    /// Most of the cycles without a call that followed each other.
    pub row: u64,
    /// Sum of the success rates.
    rates: f64,
}

impl Tally {
    /// Notes a call.
    pub fn note(&mut self, state: &RobotState, step: Duration) {
        let passed = step.as_millis() as u64;
        // The first call is told that no time has passed.
        if passed > 0 {
            self.cycles += passed;
            self.calls += 1;
            self.row = self.row.max(passed - 1);
            self.rates += state.control_command_success_rate;
        }
    }

    /// Cycles without a call.
    pub fn lost(&self) -> u64 {
        self.cycles - self.calls
    }

    /// Mean of the success rates.
    pub fn rate(&self) -> f64 {
        self.rates / self.calls as f64
    }
}
