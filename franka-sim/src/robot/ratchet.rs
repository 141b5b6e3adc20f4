//! Check of a distance (clearance) that may start below its bound. The clearance may then grow, but
//! it must not shrink further.

/// Checks a clearance. Below `bound`, the clearance must not shrink by more than `allowed` from its
/// largest value since it fell below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ratchet {
    best: f64,
}

impl Ratchet {
    /// Returns a check whose clearance may already be below the bound; it may then keep its value.
    pub(super) fn new() -> Self {
        Self {
            best: f64::NEG_INFINITY,
        }
    }

    /// Returns a check whose clearance was last above `bound`.
    pub(super) fn outside(bound: f64) -> Self {
        Self { best: bound }
    }

    /// Updates the clearance to its current value. Returns true if it has shrunk too far.
    pub(super) fn is_passed(&mut self, clearance: f64, bound: f64, allowed: f64) -> bool {
        self.best = self.best.max(clearance).min(bound);
        clearance < self.best - allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clearance_from_afar_may_pass_bound_by_the_allowance() {
        let mut ratchet = Ratchet::new();
        for (clearance, passed) in [(3.0, false), (1.0, false), (0.95, false), (0.85, true)] {
            assert_eq!(
                ratchet.is_passed(clearance, 1.0, 0.1),
                passed,
                "{clearance}"
            );
        }
    }

    #[test]
    fn start_beyond_the_bound_may_leave_but_not_return() {
        let mut ratchet = Ratchet::new();
        for (clearance, passed) in [
            (0.3, false),
            (0.25, false),
            (0.5, false),
            (0.45, false),
            (0.35, true),
            (2.0, false),
            (0.95, false),
        ] {
            assert_eq!(
                ratchet.is_passed(clearance, 1.0, 0.1),
                passed,
                "{clearance}"
            );
        }
    }
}
