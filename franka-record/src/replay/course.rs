//! The timing of a replay on the robot's clock.

use core::time::Duration;

use franka_model::Model;
use franka_rt::session::Chunk;

use super::error::ReplayError;
use super::plan::{PERIOD, ReplayPlan};

/// Number of targets from the beginning of a chunk to the beginning of the next chunk: 1 s. The
/// replay sends the next chunk when this chunk begins.
const WINDOW: usize = 100;

/// Number of targets at the beginning of a chunk that repeat targets of the previous chunk: 0.2 s.
/// Because of these targets, both chunks agree when the next chunk takes over.
const BEFORE: usize = 20;

/// Number of additional targets at the end of a chunk: 0.5 s. They bridge the time until the next
/// chunk if the host is late. If no chunk follows, the arm stops at the last target.
const AFTER: usize = 50;

/// Time from the departure of the first chunk to its first target.
const LEAD_IN: Duration = Duration::from_millis(100);

/// A replay in progress. It provides each chunk of targets when the chunk is due on the robot's
/// clock.
#[derive(Clone, Copy, Debug)]
pub struct ReplayCourse {
    /// Time of the first target, as the `message_id` of a state.
    begin: u64,
    next: usize,
}

impl ReplayCourse {
    /// Creates a replay that begins 0.1 s after the state whose `message_id` is `now`.
    pub fn new(now: u64) -> Self {
        Self {
            begin: now + milliseconds(LEAD_IN),
            next: 0,
        }
    }

    /// Returns the time of the first target, as the `message_id` of a state.
    pub fn begin(&self) -> u64 {
        self.begin
    }

    /// Returns the time of the last target, as the `message_id` of a state.
    pub fn end(&self, plan: &ReplayPlan) -> u64 {
        self.begin + milliseconds(plan.duration())
    }

    /// Returns the chunk that the caller must send after the state whose `message_id` is `now`;
    /// `None` if no chunk is due. The first chunk is due immediately. Every later chunk is due when
    /// the previous chunk begins.
    ///
    /// # Errors
    /// Returns [`ReplayError::Chunk`] if the targets do not form a motion.
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

    /// Returns the time of a target, as the `message_id` of a state.
    fn time_of(&self, target: usize) -> u64 {
        self.begin + milliseconds(PERIOD) * target as u64
    }
}

fn milliseconds(duration: Duration) -> u64 {
    duration.as_millis() as u64
}
