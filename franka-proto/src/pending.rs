//! The requests that wait for a reply, by command id.

use crate::command::CommandId;

/// Largest number of requests of one session that may wait for replies at the same time.
///
/// A client that waits for each reply has at most two pending requests: a motion and one other
/// request. An asynchronous client may also have a few setters pending. The limit keeps the table
/// inline and lookups short.
pub(crate) const LIMIT: usize = 32;

/// A request that waits for a reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry<C> {
    pub(crate) id: CommandId,
    pub(crate) command: C,
    /// True if the first of two answers has been sent or received.
    pub(crate) started: bool,
}

/// The requests that wait for a reply, without an order.
#[derive(Clone, Debug)]
pub(crate) struct Pending<C> {
    entries: [Option<Entry<C>>; LIMIT],
}

impl<C: Copy> Pending<C> {
    pub(crate) const fn new() -> Self {
        Self {
            entries: [None; LIMIT],
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.entries.iter().flatten().count()
    }

    pub(crate) fn is_full(&self) -> bool {
        self.entries.iter().all(Option::is_some)
    }

    /// Adds a request. Returns false and changes nothing if the table is full.
    pub(crate) fn insert(&mut self, id: CommandId, command: C) -> bool {
        let free = self.entries.iter_mut().find(|entry| entry.is_none());
        let Some(free) = free else { return false };
        *free = Some(Entry {
            id,
            command,
            started: false,
        });
        true
    }

    pub(crate) fn get(&self, id: CommandId) -> Option<Entry<C>> {
        self.entries.iter().flatten().find(|e| e.id == id).copied()
    }

    /// Records that the first of two answers has been sent or received.
    pub(crate) fn start(&mut self, id: CommandId) {
        if let Some(entry) = self.entries.iter_mut().flatten().find(|e| e.id == id) {
            entry.started = true;
        }
    }

    /// Removes a request. Returns true if a request with this id existed.
    pub(crate) fn remove(&mut self, id: CommandId) -> bool {
        let entry = self
            .entries
            .iter_mut()
            .find(|entry| entry.is_some_and(|entry| entry.id == id));
        entry.is_some_and(|entry| entry.take().is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Command;

    #[test]
    fn the_table_is_bounded_and_places_are_used_again() {
        let mut pending = Pending::new();
        for id in 0..LIMIT as u32 {
            assert!(pending.insert(CommandId(id), Command::Move));
        }
        assert!(pending.is_full());
        assert!(!pending.insert(CommandId(99), Command::Move));
        assert!(pending.remove(CommandId(7)));
        assert!(!pending.remove(CommandId(7)));
        assert!(pending.insert(CommandId(99), Command::StopMove));
        assert_eq!(
            pending.get(CommandId(99)).unwrap().command,
            Command::StopMove
        );
        assert_eq!(pending.len(), LIMIT);
    }
}
