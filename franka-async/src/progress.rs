//! Target and reference of target control, and the progress of motions.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use franka_rt::driver::{ReferenceReader, ReferenceState};
use franka_rt::session::{Bindings, GoalId, Target};
use nalgebra::Isometry3;

/// Reference of target control: the commanded motion in the newest cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reference {
    /// `message_id` of the state for which the reference was computed, `[ms]` of the robot's clock.
    pub time: u64,
    /// Joint positions, `[rad]`.
    pub q: [f64; 7],
    /// Joint velocities, `[rad/s]`.
    pub dq: [f64; 7],
    /// Joint accelerations, `[rad/s^2]`.
    pub ddq: [f64; 7],
    /// Pose of the end effector at those positions, in the base frame.
    pub pose: Isometry3<f64>,
    /// Guards that have held back the arm within the last 0.1 s; a guard stays listed for at most
    /// 0.2 s.
    pub guards: Bindings,
}

/// Progress of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Time since the motion began, by the robot's clock, including pauses.
    pub elapsed: Duration,
    /// Time until the reference reaches the target, if nothing delays it. After that, the arm needs
    /// at least a quarter of a second to settle.
    pub remaining: Duration,
}

impl Progress {
    /// Returns the share of the motion's time that has passed, from 0 to 1. A pause reduces the
    /// share a little, because the motion brakes and starts again.
    pub fn fraction(&self) -> f64 {
        let all = self.elapsed + self.remaining;
        if all.is_zero() {
            return 1.0;
        }
        self.elapsed.as_secs_f64() / all.as_secs_f64()
    }
}

/// Target and reference of target control, on one connection.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    references: ReferenceReader,
    /// The last accepted target, and the identifier of its goal. The lock is held only to copy it.
    heading: Arc<Mutex<Option<(GoalId, Target)>>>,
}

impl Course {
    pub(crate) fn new(references: ReferenceReader) -> Self {
        Self {
            references,
            heading: Arc::default(),
        }
    }

    pub(crate) fn head_for(&self, heading: Option<(GoalId, Target)>) {
        let mut noted = self.heading.lock().unwrap_or_else(PoisonError::into_inner);
        *noted = heading;
    }

    /// Returns the present target of target control; `None` if target control moves nothing.
    pub(crate) fn target(&self) -> Option<Target> {
        let noted = self.heading.lock().unwrap_or_else(PoisonError::into_inner);
        noted.map(|(_, target)| target)
    }

    /// Returns the identifier of the present goal of target control; `None` if it moves nothing.
    #[cfg(feature = "record")]
    pub(crate) fn goal(&self) -> Option<GoalId> {
        let noted = self.heading.lock().unwrap_or_else(PoisonError::into_inner);
        noted.map(|(goal, _)| goal)
    }

    /// Returns the newest reference; `None` if target control did not answer the newest state.
    pub(crate) fn reference(&self) -> Option<ReferenceState> {
        self.references.newest()
    }

    /// Returns the progress of the motion `goal`; `None` before it has begun and after its end.
    pub(crate) fn progress(&self, goal: GoalId) -> Option<Progress> {
        // In the first cycle of a session, nothing is planned yet.
        let begun = |newest: &ReferenceState| newest.goal == goal && !newest.elapsed.is_zero();
        let newest = self.reference().filter(begun)?;
        Some(Progress {
            elapsed: newest.elapsed,
            remaining: newest.remaining,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_the_time_is_between_nothing_and_all() {
        let ms = Duration::from_millis;
        for (elapsed, remaining, share) in
            [(0, 800, 0.0), (200, 600, 0.25), (900, 0, 1.0), (0, 0, 1.0)]
        {
            let progress = Progress {
                elapsed: ms(elapsed),
                remaining: ms(remaining),
            };
            assert_eq!(progress.fraction(), share);
        }
    }
}
