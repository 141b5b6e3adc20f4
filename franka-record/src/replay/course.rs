//! Which part of a replay is due at which time of the robot.

use core::time::Duration;

use franka_model::Model;
use franka_rt::session::Chunk;

use super::error::ReplayError;
use super::plan::{PERIOD, ReplayPlan};

/// Targets of a chunk until the next one takes over: 1 s. That one is sent when this one begins.
const WINDOW: usize = 100;

/// Targets that a chunk begins earlier with, so that it agrees with the one before where it takes
/// its place: 0.2 s.
const BEFORE: usize = 20;

/// Targets that a chunk goes on with: 0.5 s more for a host that is late with the next one. Without
/// one the arm comes to rest there.
const AFTER: usize = 50;

/// Time from the first chunk being sent to its first target.
const LEAD_IN: Duration = Duration::from_millis(100);

/// A replay on its way: gives its chunks in time. It knows no clock but the robot's.
#[derive(Clone, Copy, Debug)]
pub struct ReplayCourse {
    /// The time of the first target, `message_id`.
    begin: u64,
    /// The number of the next chunk.
    next: usize,
}

impl ReplayCourse {
    /// A replay that begins a tenth of a second after the state `now`, `message_id`.
    pub fn new(now: u64) -> Self {
        Self {
            begin: now + milliseconds(LEAD_IN),
            next: 0,
        }
    }

    /// The time of the first target, `message_id`.
    pub fn begin(&self) -> u64 {
        self.begin
    }

    /// When the last target is due, `message_id`.
    pub fn end(&self, plan: &ReplayPlan) -> u64 {
        self.begin + milliseconds(plan.duration())
    }

    /// The chunk that has to be sent by the state `now`, `message_id`: the first one at once, each
    /// other one when the one before it takes over. `None` if none has to.
    ///
    /// # Errors
    /// [`ReplayError::Chunk`] for targets that make no motion.
    pub fn due(
        &mut self,
        plan: &ReplayPlan,
        model: &Model,
        now: u64,
    ) -> Result<Option<Chunk>, ReplayError> {
        let count = plan.points.len();
        let first = (self.next * WINDOW).saturating_sub(BEFORE);
        let is_last = self.next > 0 && self.next * WINDOW >= count;
        if is_last || self.next > 0 && now < self.time_of((self.next - 1) * WINDOW) {
            return Ok(None);
        }
        let last = ((self.next + 1) * WINDOW + AFTER).min(count);
        let chunk = plan.chunk(model, first..last)?;
        self.next += 1;
        Ok(Some(chunk.observed_at(self.time_of(first))))
    }

    /// When a target is due, `message_id`.
    fn time_of(&self, target: usize) -> u64 {
        self.begin + milliseconds(PERIOD) * target as u64
    }
}

fn milliseconds(duration: Duration) -> u64 {
    duration.as_millis() as u64
}
