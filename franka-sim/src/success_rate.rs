//! `control_command_success_rate`: the fraction of a motion's cycles that the client answered, and
//! the number of cycles lost in a row. `robot::motion` defines the effect of a lost command.

use crate::config::FirstCycles;

/// Number of cycles lost in a row that ends a motion (FCI documentation,
/// "communication_constraints_violation").
pub(crate) const LOST_LIMIT: u32 = 20;

/// Number of cycles in the success rate (libfranka 0.21, `robot_state.h`).
const WINDOW: u32 = 100;

/// The last hundred cycles, newest in the lowest bit.
///
/// Counting begins with the client's first command. A late command counts as the first command,
/// which is a choice of the simulator.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SuccessRate {
    received: u128,
    counted: u32,
    lost_in_a_row: u32,
}

impl SuccessRate {
    /// Counts a cycle whose command came in time.
    pub(crate) fn hit(&mut self) {
        self.count(1);
        self.lost_in_a_row = 0;
    }

    /// Counts a cycle without a command. Returns the number of cycles lost in a row.
    pub(crate) fn miss(&mut self) -> u32 {
        self.count(0);
        self.lost_in_a_row += 1;
        self.lost_in_a_row
    }

    /// Fraction of the window's cycles whose command arrived in time. While the window is not full,
    /// `first` selects the divisor. The rate is zero before the first command in time.
    pub(crate) fn rate(&self, first: FirstCycles) -> f64 {
        if self.counted == 0 {
            return 0.0;
        }
        let cycles = match first {
            FirstCycles::SoFar => self.counted,
            FirstCycles::Window => WINDOW,
        };
        f64::from(self.received.count_ones()) / f64::from(cycles)
    }

    fn count(&mut self, bit: u128) {
        self.received = (self.received << 1 | bit) & ((1 << WINDOW) - 1);
        self.counted = (self.counted + 1).min(WINDOW);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_looks_back_a_hundred_cycles() {
        let mut answers = SuccessRate::default();
        let rates = |answers: &SuccessRate| {
            let rate = |first| answers.rate(first);
            (rate(FirstCycles::SoFar), rate(FirstCycles::Window))
        };
        assert_eq!(rates(&answers), (0.0, 0.0));
        answers.hit();
        assert_eq!(rates(&answers), (1.0, 0.01));
        answers.miss();
        assert_eq!(rates(&answers), (0.5, 0.01));
        for _ in 0..98 {
            answers.hit();
        }
        assert_eq!(rates(&answers), (0.99, 0.99));
        answers.hit();
        answers.hit();
        assert_eq!(rates(&answers), (1.0, 1.0));
    }

    #[test]
    fn losses_count_in_a_row_only() {
        let mut answers = SuccessRate::default();
        for _ in 0..LOST_LIMIT - 1 {
            answers.miss();
        }
        answers.hit();
        assert_eq!(answers.miss(), 1);
    }
}
