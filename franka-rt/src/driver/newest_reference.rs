//! The newest reference of target control, for any number of readers.

use core::time::Duration;

use super::Record;
use crate::session::{Bindings, GoalId};
use crate::slot::{Read, SlotReader, SlotWriter, Words, slot};

/// Reference of [target control](crate::session) and progress of its goal, in one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceState {
    /// `message_id` of the state that the reference answers, `[ms]` of the robot's clock.
    pub time: u64,
    /// The goal that the reference follows.
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
    /// Guards that limited the command of this cycle or of a recent cycle. The set covers at least
    /// the last [`Self::GUARDS_MS`], and at most twice that time.
    pub guards: Bindings,
}

impl ReferenceState {
    /// Time for which a guard remains in [`guards`](Self::guards) after it has limited a command,
    /// `[ms]` of the robot's clock. It is long enough for readers that poll a few dozen times per
    /// second.
    pub const GUARDS_MS: u64 = 100;

    fn of(record: &Record, guards: Bindings) -> Self {
        Self {
            time: record.time,
            goal: GoalId(record.goal),
            q: record.q_ref,
            dq: record.dq_ref,
            ddq: record.ddq_ref,
            elapsed: record.elapsed,
            remaining: record.remaining,
            guards,
        }
    }
}

/// Writes the newest reference.
#[derive(Debug)]
pub(super) struct ReferenceWriter {
    newest: SlotWriter<ReferenceState>,
    /// The guards that limited a command since `begin`, and in the period before `begin`.
    guards: [Bindings; 2],
    begin: u64,
}

impl ReferenceWriter {
    pub(super) fn new() -> (Self, ReferenceReader) {
        let (newest, reader) = slot();
        let writer = Self {
            newest,
            guards: Default::default(),
            begin: 0,
        };
        (writer, ReferenceReader(reader))
    }

    pub(super) fn write(&mut self, record: &Record) {
        let [now, before] = &mut self.guards;
        let age = record.time.saturating_sub(self.begin);
        if age >= ReferenceState::GUARDS_MS {
            let gap = age >= 2 * ReferenceState::GUARDS_MS;
            *before = if gap { Bindings::default() } else { *now };
            *now = Bindings::default();
            self.begin = record.time;
        }
        *now = now.union(record.bindings);
        let guards = now.union(*before);
        self.newest.write(&ReferenceState::of(record, guards));
    }
}

impl Words for ReferenceState {
    const WORDS: usize = 2 + 3 * 7 + 2 + 1;

    fn store(&self, words: &mut [u64]) {
        let micros = |time: Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        let joints = [self.q, self.dq, self.ddq].into_iter().flatten();
        let all = [self.time, self.goal.0]
            .into_iter()
            .chain(joints.map(f64::to_bits))
            .chain([self.elapsed, self.remaining].map(micros))
            .chain([u64::from(self.guards.to_bits())]);
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
            guards: Bindings::from_bits(next() as u32),
        }
    }
}

/// Number of attempts to read. An attempt fails if the value is replaced twice while it reads.
const ATTEMPTS: usize = 16;

/// Reads the newest reference. Clones read independently of each other.
#[derive(Clone, Debug)]
pub struct ReferenceReader(SlotReader<ReferenceState>);

impl ReferenceReader {
    /// Returns the reference of the newest cycle; `None` if target control did not answer that
    /// cycle.
    pub fn newest(&self) -> Option<ReferenceState> {
        // A clone has not returned any value yet, so it finds the current value even if that is not
        // new.
        match self.0.clone().read_retry(ATTEMPTS) {
            Read::Newer(newest) => Some(newest).filter(|newest| newest.goal != GoalId::default()),
            Read::Same | Read::Torn => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Guard;

    #[test]
    fn every_field_survives_its_words_and_no_goal_is_no_reference() {
        let (mut writer, reader) = ReferenceWriter::new();
        assert_eq!(reader.newest(), None, "before the first cycle");
        let state = ReferenceState {
            time: 17,
            goal: GoalId(3),
            q: [0.1; 7],
            dq: [0.2; 7],
            ddq: [0.3; 7],
            elapsed: Duration::from_millis(40),
            remaining: Duration::from_micros(1_234_567),
            guards: Bindings::of(&[Guard::Leash, Guard::Team]),
        };
        writer.newest.write(&state);
        assert_eq!(reader.newest(), Some(state));
        assert_eq!(reader.newest(), Some(state), "it may be read again");
        writer.write(&Record::default());
        assert_eq!(reader.newest(), None);
    }

    #[test]
    fn guard_counts_as_bound_for_a_tenth_of_a_second() {
        let (mut writer, reader) = ReferenceWriter::new();
        let mut at = |time: u64, bindings: &[Guard]| {
            writer.write(&Record {
                time,
                goal: 1,
                bindings: Bindings::of(bindings),
                ..Record::default()
            });
            reader.newest().expect("a reference").guards
        };
        let begin = 5_000;
        assert!(at(begin, &[]).is_empty());
        let both = Bindings::of(&[Guard::ForceCap, Guard::Clearance]);
        let one = Bindings::of(&[Guard::ForceCap]);
        assert_eq!(at(begin + 99, &[Guard::ForceCap]), one);
        assert_eq!(at(begin + 100, &[]), one);
        assert_eq!(at(begin + 150, &[Guard::Clearance]), both);
        assert_eq!(at(begin + 199, &[]), both);
        assert_eq!(at(begin + 200, &[]), Bindings::of(&[Guard::Clearance]));
        assert!(at(begin + 300, &[]).is_empty());
        // A guard that limited a command before a gap in the states no longer counts.
        at(begin + 399, &[Guard::Leash]);
        assert!(at(begin + 700, &[]).is_empty());
    }
}
