//! Counts of the events of a robot, for its metrics.

use franka_proto::RobotError;
use franka_rt::lifecycle::{MotionError, Outcome};
use franka_rt::supervision::EventKind;

/// Counts since the first connection: motions by outcome, and reflexes by their errors.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    motions: [u64; OUTCOMES.len()],
    reflexes: [u64; RobotError::ALL.len()],
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            motions: [0; OUTCOMES.len()],
            reflexes: [0; RobotError::ALL.len()],
        }
    }
}

impl Tally {
    /// Counts an event if it is the end of a motion or a reflex.
    pub(crate) fn note(&mut self, event: &EventKind) {
        match event {
            EventKind::MotionEnded { outcome, .. } => {
                let name = name_of(outcome);
                count(&mut self.motions, &OUTCOMES, &name);
            }
            EventKind::Reflex(reflex) => {
                for error in reflex.errors.iter() {
                    count(&mut self.reflexes, &RobotError::ALL, &error);
                }
            }
            _ => {}
        }
    }

    /// Returns the number of motions for each outcome.
    pub(crate) fn motions(&self) -> impl Iterator<Item = (&'static str, u64)> + use<> {
        OUTCOMES.into_iter().zip(self.motions)
    }

    /// Returns the number of reflexes for each error. A reflex with several errors counts once for
    /// each error.
    pub(crate) fn reflexes(&self) -> impl Iterator<Item = (RobotError, u64)> + use<> {
        RobotError::ALL.into_iter().zip(self.reflexes)
    }
}

fn count<T: PartialEq>(counts: &mut [u64], all: &[T], this: &T) {
    if let Some(index) = all.iter().position(|one| one == this) {
        counts[index] += 1;
    }
}

fn name_of(outcome: &Outcome) -> &'static str {
    match outcome {
        Ok(_) => "done",
        Err(error) => name_of_error(error),
    }
}

fn name_of_error(error: &MotionError) -> &'static str {
    match error {
        MotionError::Superseded => "superseded",
        MotionError::Stopped => "stopped",
        MotionError::Held(_) => "held",
        MotionError::Braked(_) => "braked",
        MotionError::TargetNotReached(_) => "not_reached",
        MotionError::AfterReaction { error, .. } => name_of_error(error),
        MotionError::Control(error) if error.is_reflex() => "reflex",
        MotionError::Control(_) => "ended_by_robot",
        MotionError::LinkLost { .. } | MotionError::ConnectionClosed { .. } => "lost",
        MotionError::Goal(_)
        | MotionError::Disengaged
        | MotionError::Busy
        | MotionError::Start(_)
        | MotionError::Unsupported(_)
        | MotionError::Rejected(_)
        | MotionError::NotReady { .. } => "refused",
        _ => "failed",
    }
}

const OUTCOMES: [&str; 11] = [
    "done",
    "superseded",
    "stopped",
    "held",
    "braked",
    "not_reached",
    "reflex",
    "ended_by_robot",
    "lost",
    "refused",
    "failed",
];

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use franka_rt::lifecycle::CloseReason;

    use super::*;

    #[test]
    fn every_end_of_a_motion_counts_once() {
        let mut tally = Tally::default();
        let reason = CloseReason::ClosedByPeer;
        for error in [
            MotionError::Stopped,
            MotionError::Stopped,
            MotionError::Busy,
            MotionError::ConnectionClosed { reason },
            MotionError::Protocol { what: "a test" },
        ] {
            let outcome = Arc::new(Err(error));
            tally.note(&EventKind::MotionEnded { goal: 7, outcome });
        }
        tally.note(&EventKind::MotionBegun { goal: 8 });
        let counted: Vec<_> = tally.motions().filter(|(_, count)| *count > 0).collect();
        let expected = [("stopped", 2), ("lost", 1), ("refused", 1), ("failed", 1)];
        assert_eq!(counted, expected);
    }
}
