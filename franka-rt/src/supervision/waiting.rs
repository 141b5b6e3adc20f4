//! The motion that waits for the robot to be ready.

use core::time::Duration;

use crate::lifecycle::{MotionError, NewMotion, Unready};
use crate::session::GoalId;

/// Decision on a motion that a caller requests.
#[derive(Debug)]
pub enum Admission {
    /// Begin the motion now. If the robot accepts no motions, it refuses the motion itself.
    Begin,
    /// Keep the motion until [`Output::Begin`](super::Output::Begin) or
    /// [`Output::Refuse`](super::Output::Refuse) contains its id.
    Wait,
    /// The motion does not begin, for this reason.
    Refuse(MotionError),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) goal: GoalId,
    /// True if a newer goal may supersede the motion.
    gives_way: bool,
    since: Duration,
    pub(super) until: Duration,
}

impl Waiting {
    /// Decides on `motion`, which may wait for `most`. If it waits, it becomes the new `waiting`.
    /// Returns the earlier waiting motion, if `motion` supersedes it.
    pub(super) fn admit(
        waiting: &mut Option<Self>,
        motion: &NewMotion,
        (why, most): (Unready, Option<Duration>),
        now: Duration,
    ) -> (Admission, Option<GoalId>) {
        let refusal = MotionError::NotReady {
            why,
            waited: Duration::ZERO,
        };
        // The other members of a common start would also have to wait.
        let Some(most) = most.filter(|_| !motion.has_ticket()) else {
            return (Admission::Refuse(refusal), None);
        };
        if let Some(waiting) = waiting
            && !(waiting.gives_way && motion.supersedes_goals())
        {
            return (Admission::Refuse(MotionError::Busy), None);
        }
        let before = waiting.replace(Self {
            goal: motion.id(),
            gives_way: motion.is_superseded_by_goals(),
            since: now,
            until: now.saturating_add(most),
        });
        (Admission::Wait, before.map(|before| before.goal))
    }

    /// Returns the error for a motion that does not begin because the robot is not ready at `now`.
    pub(super) fn refusal(&self, why: Unready, now: Duration) -> MotionError {
        let waited = now - self.since;
        MotionError::NotReady { why, waited }
    }
}
