//! Two rings that pass chunks into the thread and back. Chunks must come back because the thread
//! may not free the heap memory of their points.
//!
//! ```text
//! ChunkWriter -> ring of chunks  -> ChunkReader: drained in each cycle, the newest counts
//!             <- ring of returns <-              what is done with, and what became of it
//! ```
//!
//! Every chunk that was sent comes back, so the writer knows how many chunks the thread still has.
//! The writer sends only as many as the return ring holds, so that ring is never full when the
//! thread returns a chunk.

use super::value::Chunk;
use crate::queue::{self, Receiver, Sender};
use crate::session::GoalId;
use crate::shaping::CYCLE;

/// Start time of a chunk that waits. Another chunk may have superseded that chunk since then.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    goal: GoalId,
    /// Time at which the chunk should begin, by the robot's clock, `[ms]`.
    begin: u64,
    /// Time for which the chunk was to wait, `[s]`.
    wait: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sent {
    pub(super) goal: GoalId,
    pub(super) chunk: Chunk,
}

/// Fate of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fate {
    /// The arm followed the chunk until a newer chunk or another goal replaced it.
    Replaced,
    /// The arm followed the chunk to its end.
    Ended,
    /// A newer chunk of the same goal arrived before the session began this one.
    Superseded,
    /// All points of the chunk had passed before the session could begin it.
    Late,
    /// Before the session began this chunk, its goal stopped following chunks, or a chunk of
    /// another goal arrived.
    Obsolete,
}

/// A chunk that the thread no longer needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Returned {
    /// Goal of the chunk.
    pub goal: GoalId,
    /// Fate of the chunk.
    pub fate: Fate,
    /// The chunk.
    pub chunk: Chunk,
}

/// The ring has no room for another chunk, because the thread has neither begun nor returned the
/// earlier chunks.
#[derive(Debug, thiserror::Error)]
#[error(
    "got more chunks at once than the control thread accepts, expected {} at most: send fewer",
    Chunk::UNDER_WAY_MAX
)]
pub struct Full(
    /// The chunk that was not sent.
    pub Chunk,
);

/// The end of the channel that sends chunks, outside the thread.
#[derive(Debug)]
pub struct ChunkWriter {
    chunks: Sender<Sent>,
    returns: Receiver<Returned>,
    under_way: usize,
}

/// The end of the channel that receives chunks, in the session.
#[derive(Debug)]
pub struct ChunkReader {
    chunks: Receiver<Sent>,
    returns: Sender<Returned>,
    /// The newest chunk, until the session begins it.
    newest: Option<Sent>,
    /// Among the chunks that have waited since a chunk last began, the start time of the chunk that
    /// was due first.
    due: Option<Waiting>,
}

/// Creates the two ends of a channel for chunks.
pub fn chunk_ring() -> (ChunkWriter, ChunkReader) {
    let (sender, receiver) = queue::queue(Chunk::UNDER_WAY_MAX);
    let (back, collector) = queue::queue(Chunk::UNDER_WAY_MAX);
    let writer = ChunkWriter {
        chunks: sender,
        returns: collector,
        under_way: 0,
    };
    let reader = ChunkReader {
        chunks: receiver,
        returns: back,
        newest: None,
        due: None,
    };
    (writer, reader)
}

impl ChunkWriter {
    /// Sends `chunk` for `goal`. It replaces the previous chunk.
    ///
    /// Send the first chunk of a goal before you write that goal to the slot. The session keeps the
    /// chunk until that goal becomes the current goal, or another chunk arrives.
    ///
    /// # Errors
    /// Returns [`Full`] with the chunk if [`Chunk::UNDER_WAY_MAX`] chunks have not been
    /// [collected](Self::collect).
    #[expect(
        clippy::result_large_err,
        reason = "once per chunk, outside the thread; the chunk goes back to its owner"
    )]
    pub fn send(&mut self, goal: GoalId, chunk: Chunk) -> Result<(), Full> {
        if !self.has_room() {
            return Err(Full(chunk));
        }
        match self.chunks.push(Sent { goal, chunk }) {
            Ok(()) => {
                self.under_way += 1;
                Ok(())
            }
            Err(queue::Full(sent)) => Err(Full(sent.chunk)),
        }
    }

    /// True if another chunk may be sent.
    pub fn has_room(&self) -> bool {
        self.under_way < Chunk::UNDER_WAY_MAX
    }

    /// Returns the next chunk that the thread no longer needs, if any.
    pub fn collect(&mut self) -> Option<Returned> {
        let returned = self.returns.pop()?;
        self.under_way -= 1;
        Some(returned)
    }

    /// True if the session no longer exists, so that no chunk can begin.
    pub fn is_abandoned(&self) -> bool {
        self.chunks.is_abandoned()
    }
}

impl ChunkReader {
    /// Returns the newest chunk for `goal`, the current goal at the robot's time `now`, if the
    /// chunk is new and may begin. It may begin when its first point is due. With `idle`, no other
    /// chunk runs, and the chunk may begin at once.
    ///
    /// If the chunk has superseded a waiting chunk, it may begin when that chunk was due. It is
    /// then early by at most that chunk's waiting time. Without this rule, the arm would never
    /// follow a policy whose first point is always further ahead than its next prediction.
    ///
    /// Gives chunks that are no longer needed back to the writer. A chunk of another goal is kept,
    /// because that goal may still arrive. The ids of goals have no order: an id may be created
    /// long before its goal is written.
    pub(in crate::session) fn poll(&mut self, goal: GoalId, now: u64, idle: bool) -> Option<Chunk> {
        self.receive();
        let chunk = self.take_newest(goal)?;
        let t = chunk.since_origin(now);
        if t > chunk.end() {
            self.due = None;
            self.give_back(goal, chunk, Fate::Late);
            return None;
        }
        let ahead = chunk.begin() - t;
        let due = self.due.filter(|due| due.goal == goal);
        let is_due = due.is_some_and(|due| due.begin <= now && ahead <= due.wait);
        if idle || chunk.begins_at_take_up() || ahead <= 0.0 || is_due {
            self.due = None;
            return Some(chunk);
        }
        let begin = now.saturating_add((ahead / CYCLE).ceil() as u64);
        let waiting = Waiting {
            goal,
            begin,
            wait: ahead,
        };
        self.due = due.filter(|due| due.begin <= begin).or(Some(waiting));
        self.newest = Some(Sent { goal, chunk });
        None
    }

    /// Gives the chunks that have arrived for `goal` back to the writer, because that goal will
    /// begin no more chunks.
    pub(in crate::session) fn discard(&mut self, goal: GoalId) {
        self.receive();
        self.due = None;
        if let Some(chunk) = self.take_newest(goal) {
            self.give_back(goal, chunk, Fate::Obsolete);
        }
    }

    /// Removes the chunk of `goal` that has not begun. For sessions that have ended.
    pub(in crate::session) fn take(&mut self, goal: GoalId) -> Option<Chunk> {
        self.receive();
        self.take_newest(goal)
    }

    fn take_newest(&mut self, goal: GoalId) -> Option<Chunk> {
        let newest = self.newest.take_if(|newest| newest.goal == goal)?;
        Some(newest.chunk)
    }

    fn receive(&mut self) {
        // At most this many chunks are under way, because the writer cannot send more without
        // collecting returned chunks.
        for _ in 0..Chunk::UNDER_WAY_MAX {
            let Some(sent) = self.chunks.pop() else { break };
            let goal = sent.goal;
            if let Some(before) = self.newest.replace(sent) {
                let fate = match before.goal == goal {
                    true => Fate::Superseded,
                    false => Fate::Obsolete,
                };
                self.give_back(before.goal, before.chunk, fate);
            }
        }
    }

    pub(super) fn give_back(&mut self, goal: GoalId, chunk: Chunk, fate: Fate) {
        let returned = Returned { goal, fate, chunk };
        if let Err(queue::Full(returned)) = self.returns.push(returned) {
            // The writer sends only as many chunks as fit. If the ring is full in spite of that,
            // memory is leaked, because this thread must not free it.
            core::mem::forget(returned);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::time::Duration;

    const GOAL: GoalId = GoalId(5);

    /// Returns points at 10 and 60 ms after the origin.
    fn chunk() -> Chunk {
        let at = |ms| (Duration::from_millis(ms), [0.0; 7]);
        Chunk::joints([at(10), at(60)]).unwrap()
    }

    fn fates(writer: &mut ChunkWriter) -> Vec<Fate> {
        core::iter::from_fn(|| writer.collect())
            .map(|returned| returned.fate)
            .collect()
    }

    #[test]
    fn the_newest_chunk_counts_and_the_others_come_back() {
        let (mut writer, mut reader) = chunk_ring();
        for origin in [100, 101, 102] {
            writer.send(GOAL, chunk().observed_at(origin)).unwrap();
        }
        let taken = reader.poll(GOAL, 120, false);
        assert_eq!(taken, Some(chunk().observed_at(102)));
        assert_eq!(reader.poll(GOAL, 121, false), None);
        assert_eq!(fates(&mut writer), [Fate::Superseded; 2]);
    }

    #[test]
    fn past_chunk_is_late_and_another_goals_chunk_obsolete() {
        let (mut writer, mut reader) = chunk_ring();
        writer.send(GOAL, chunk().observed_at(100)).unwrap();
        assert_eq!(reader.poll(GOAL, 161, true), None);
        writer.send(GoalId(4), chunk()).unwrap();
        assert_eq!(reader.poll(GOAL, 162, true), None);
        writer.send(GOAL, chunk().observed_at(100)).unwrap();
        assert!(
            reader.poll(GOAL, 160, true).is_some(),
            "the last millisecond"
        );
        assert_eq!(fates(&mut writer), [Fate::Late, Fate::Obsolete]);
    }

    #[test]
    fn a_chunk_that_is_there_before_its_goal_is_kept_for_it() {
        let (mut writer, mut reader) = chunk_ring();
        // The id of a future goal may be older than the id of the current goal.
        for in_force in [GoalId(4), GoalId(6)] {
            writer.send(GOAL, chunk()).unwrap();
            assert_eq!(reader.poll(in_force, 1, true), None);
            reader.discard(in_force);
            assert_eq!(reader.poll(GOAL, 2, true), Some(chunk()), "{in_force:?}");
            writer.send(GOAL, chunk()).unwrap();
            assert_eq!(reader.poll(in_force, 3, true), None);
            assert_eq!(reader.take(GOAL), Some(chunk()), "{in_force:?}");
        }
        assert_eq!(fates(&mut writer), []);
    }

    #[test]
    fn future_chunk_waits_while_another_runs() {
        let (mut writer, mut reader) = chunk_ring();
        writer.send(GOAL, chunk().observed_at(100)).unwrap();
        assert_eq!(reader.poll(GOAL, 109, false), None);
        assert!(reader.poll(GOAL, 110, false).is_some());
        writer.send(GOAL, chunk().observed_at(200)).unwrap();
        assert!(reader.poll(GOAL, 111, true).is_some(), "nothing else runs");
        writer.send(GOAL, chunk()).unwrap();
        assert!(reader.poll(GOAL, 112, false).is_some(), "its origin is now");
    }

    #[test]
    fn a_chunk_begins_when_the_first_that_it_superseded_was_to() {
        let (mut writer, mut reader) = chunk_ring();
        for now in [100, 103, 106, 109] {
            writer.send(GOAL, chunk().observed_at(now)).unwrap();
            assert_eq!(reader.poll(GOAL, now, false), None, "{now}");
        }
        writer.send(GOAL, chunk().observed_at(110)).unwrap();
        assert!(reader.poll(GOAL, 110, false).is_some());
        // A chunk that begins much later is early by no more than the waiting time of the first
        // chunk.
        for origin in [120, 3120] {
            writer.send(GOAL, chunk().observed_at(origin)).unwrap();
            assert_eq!(reader.poll(GOAL, 121, false), None);
        }
        assert_eq!(reader.poll(GOAL, 3120, false), None);
        assert!(reader.poll(GOAL, 3121, false).is_some());
        fates(&mut writer);
        // A chunk that is due earlier counts. A late chunk no longer counts.
        for origin in [9000, 3130] {
            writer.send(GOAL, chunk().observed_at(origin)).unwrap();
            assert_eq!(reader.poll(GOAL, 3130, false), None);
        }
        writer.send(GOAL, chunk().observed_at(3135)).unwrap();
        assert!(reader.poll(GOAL, 3140, false).is_some());
        writer.send(GOAL, chunk().observed_at(3140)).unwrap();
        assert_eq!(reader.poll(GOAL, 3141, false), None);
        writer.send(GOAL, chunk().observed_at(100)).unwrap();
        assert_eq!(reader.poll(GOAL, 3142, false), None, "late");
        fates(&mut writer);
        writer.send(GOAL, chunk().observed_at(3990)).unwrap();
        assert_eq!(reader.poll(GOAL, 3992, false), None);
        assert!(reader.poll(GOAL, 4000, false).is_some());
        writer.send(GOAL, chunk().observed_at(u64::MAX)).unwrap();
        assert_eq!(reader.poll(GOAL, 4001, false), None, "at the end of time");
    }

    #[test]
    fn no_more_chunks_go_in_than_may_come_back() {
        let (mut writer, mut reader) = chunk_ring();
        for _ in 0..3 * Chunk::UNDER_WAY_MAX {
            if writer.send(GOAL, chunk()).is_err() {
                break;
            }
            // Superseded chunks that wait for the writer count as under way.
            reader.poll(GoalId(0), 0, false);
        }
        let Full(refused) = writer.send(GOAL, chunk().observed_at(7)).unwrap_err();
        assert_eq!(refused, chunk().observed_at(7));
        assert_eq!(fates(&mut writer).len(), Chunk::UNDER_WAY_MAX - 1);
        writer.send(GOAL, refused).unwrap();
        drop(reader);
        assert!(writer.is_abandoned());
    }
}
