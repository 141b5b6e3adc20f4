//! The newest reference of target control, for any number of readers.

use core::time::Duration;

use super::Record;
use crate::session::GoalId;
use crate::slot::{Read, SlotReader, Words};

/// Where target control has the joints go, and how far its goal has come, in one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceState {
    /// `message_id` of the state that it answers, `[ms]` of the robot's clock.
    pub time: u64,
    /// The goal that is followed.
    pub goal: GoalId,
    /// Reference joint positions, `[rad]`.
    pub q: [f64; 7],
    /// Reference joint velocities, `[rad/s]`.
    pub dq: [f64; 7],
    /// Reference joint accelerations, `[rad/s^2]`.
    pub ddq: [f64; 7],
    /// See [`Record::elapsed`].
    pub elapsed: Duration,
    /// See [`Record::remaining`].
    pub remaining: Duration,
}

impl ReferenceState {
    pub(super) fn of(record: &Record) -> Self {
        Self {
            time: record.time,
            goal: GoalId(record.goal),
            q: record.q_ref,
            dq: record.dq_ref,
            ddq: record.ddq_ref,
            elapsed: record.elapsed,
            remaining: record.remaining,
        }
    }
}

impl Words for ReferenceState {
    const WORDS: usize = 2 + 3 * 7 + 2;

    fn store(&self, words: &mut [u64]) {
        let micros = |time: Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        let joints = [self.q, self.dq, self.ddq].into_iter().flatten();
        let all = [self.time, self.goal.0]
            .into_iter()
            .chain(joints.map(f64::to_bits))
            .chain([self.elapsed, self.remaining].map(micros));
        for (word, value) in words.iter_mut().zip(all) {
            *word = value;
        }
    }

    fn load(words: &[u64]) -> Self {
        let mut words = words.iter().copied();
        let mut next = || words.next().unwrap_or_default();
        let (time, goal) = (next(), GoalId(next()));
        let mut joints = || core::array::from_fn(|_| f64::from_bits(next()));
        let (q, dq, ddq) = (joints(), joints(), joints());
        Self {
            time,
            goal,
            q,
            dq,
            ddq,
            elapsed: Duration::from_micros(next()),
            remaining: Duration::from_micros(next()),
        }
    }
}

/// Attempts to read. One fails if this thread is held up until the value has been replaced twice.
const ATTEMPTS: usize = 16;

/// Reads the newest reference. Clones read independently of each other.
#[derive(Clone, Debug)]
pub struct ReferenceReader(pub(super) SlotReader<ReferenceState>);

impl ReferenceReader {
    /// The reference of the newest cycle; `None` where target control did not answer it.
    pub fn newest(&self) -> Option<ReferenceState> {
        // A clone has read nothing yet, and so finds what is there whether or not it is new.
        match self.0.clone().read_retry(ATTEMPTS) {
            Read::Newer(newest) => Some(newest).filter(|newest| newest.goal != GoalId::default()),
            Read::Same | Read::Torn => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slot::slot;

    #[test]
    fn every_field_survives_its_words_and_no_goal_is_no_reference() {
        let (mut writer, reader) = slot();
        let reader = ReferenceReader(reader);
        assert_eq!(reader.newest(), None, "before the first cycle");
        let state = ReferenceState {
            time: 17,
            goal: GoalId(3),
            q: [0.1; 7],
            dq: [0.2; 7],
            ddq: [0.3; 7],
            elapsed: Duration::from_millis(40),
            remaining: Duration::from_micros(1_234_567),
        };
        writer.write(&state);
        assert_eq!(reader.newest(), Some(state));
        assert_eq!(reader.newest(), Some(state), "it may be read again");
        writer.write(&ReferenceState::of(&Record::default()));
        assert_eq!(reader.newest(), None);
    }
}
