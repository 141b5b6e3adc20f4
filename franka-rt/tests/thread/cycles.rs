//! Readers of every cycle that come and go while the thread runs.

use std::sync::mpsc;

use franka_rt::thread::{AttachError, CycleFeed, CycleReader, READERS_MAX};

use super::*;

const DEPTH: usize = 64;

/// Sends these states one by one, each after the previous one was answered, so that none is
/// skipped.
fn exchange_states(peer: &Peer, message_ids: std::ops::RangeInclusive<u64>) {
    for message_id in message_ids {
        peer.send(message_id);
        assert_eq!(peer.command().message_id, message_id);
    }
}

/// Returns `message_id` of each waiting cycle, and the number of cycles lost just before it.
fn cycles<R>(reader: &mut CycleReader<R>) -> Vec<(u64, u64)> {
    std::iter::from_fn(|| reader.pop())
        .map(|cycle| (cycle.state.message_id, cycle.lost))
        .collect()
}

/// Waits for `count` cycles: a cycle is passed on once its command has left.
fn wait_until_there<R>(reader: &CycleReader<R>, count: usize) {
    wait_for("cycle", || (reader.waiting() >= count).then_some(()));
}

#[test]
fn readers_get_each_cycle_from_attach_to_detach() {
    let (mut handle, peer) = start(config(), Probe::default());
    exchange_states(&peer, 1..=3);
    let mut early = handle.cycles.attach(DEPTH).expect("there is room");
    exchange_states(&peer, 4..=6);
    let begun = Instant::now();
    let mut late = handle.cycles.attach(DEPTH).expect("there is room");
    exchange_states(&peer, 7..=9);
    wait_until_there(&early, 6);
    wait_until_there(&late, 3);
    assert_eq!(cycles(&mut early), [4, 5, 6, 7, 8, 9].map(|id| (id, 0)));
    let seventh = late.pop().expect("it was attached before this one");
    assert_eq!(seventh.state.message_id, 7);
    assert_eq!(seventh.state.q, [7.0; 7], "the whole state");
    assert_eq!(seventh.record, 7, "the record of the same cycle");
    assert!((begun..=Instant::now()).contains(&seventh.received));

    drop(early);
    exchange_states(&peer, 10..=10);
    let memory = wait_for("notice", || handle.notices.pop());
    assert!(matches!(memory, Notice::Detached(_)), "{memory:?}");
    wait_until_there(&late, 3);
    assert_eq!(cycles(&mut late), [8, 9, 10].map(|id| (id, 0)));
    assert!(!late.has_ended());
    handle.thread.join().expect("nothing panics");
    assert!(late.has_ended() && late.pop().is_none());
}

#[test]
fn cycles_that_do_not_fit_are_counted_with_the_next_one() {
    let (handle, peer) = start(config(), Probe::default());
    let mut held_up = handle.cycles.attach(2).expect("there is room");
    let mut other = handle.cycles.attach(DEPTH).expect("there is room");
    exchange_states(&peer, 1..=5);
    wait_until_there(&other, 5);
    assert_eq!(held_up.lost(), 3);
    assert_eq!(cycles(&mut held_up), [(1, 0), (2, 0)]);
    exchange_states(&peer, 6..=7);
    wait_until_there(&other, 7);
    assert_eq!(cycles(&mut held_up), [(6, 3), (7, 0)]);
    assert_eq!((held_up.lost(), other.lost()), (3, 0));
    assert_eq!(cycles(&mut other).len(), 7, "others lose nothing by it");
}

#[test]
fn waiting_reader_returns_at_cycle_timeout_or_end() {
    let (handle, peer) = start(config(), Probe::default());
    let mut reader = handle.cycles.attach(DEPTH).expect("there is room");
    assert!(!reader.wait(Duration::from_millis(1)), "no state was sent");
    let (answers, answer) = mpsc::channel();
    let waiting = std::thread::spawn(move || {
        while reader.wait(DEADLINE) {
            let cycle = reader.pop().expect("it said so");
            answers
                .send(cycle.state.message_id)
                .expect("the test waits");
        }
    });
    exchange_states(&peer, 1..=1);
    assert_eq!(answer.recv_timeout(DEADLINE), Ok(1));
    handle.thread.join().expect("nothing panics");
    waiting.join().expect("it sees the end");
}

#[test]
fn excess_readers_are_refused_until_one_leaves() {
    let (handle, peer) = start(config(), Probe::default());
    let attach = || handle.cycles.attach(DEPTH);
    let mut readers: Vec<_> = (0..READERS_MAX)
        .map(|_| attach().expect("there is room"))
        .collect();
    assert_eq!(attach().expect_err("one too many"), AttachError::TooMany);
    exchange_states(&peer, 1..=1);
    readers.pop();
    // The thread has not returned the old ring yet, so the new reader waits for its place.
    readers.push(attach().expect("one has gone"));
    let mut newest = readers.pop().expect("just pushed");
    for message_id in 2.. {
        exchange_states(&peer, message_id..=message_id);
        if newest.waiting() > 0 {
            break;
        }
        assert!(message_id < 100, "it never got its place");
    }
    assert!(newest.pop().is_some());
    for capacity in [0, CycleFeed::<u64>::CAPACITY_MAX + 1] {
        drop(readers.pop());
        let refused = handle.cycles.attach(capacity).expect_err("no such length");
        assert_eq!(refused, AttachError::Capacity { got: capacity });
    }
    let feed = handle.cycles.clone();
    handle.thread.join().expect("nothing panics");
    assert_eq!(
        feed.attach(DEPTH).expect_err("too late"),
        AttachError::Ended
    );
}

/// While a borrower that runs no turn has the cycle, the thread does not look for readers.
#[test]
fn readers_that_the_thread_does_not_take_are_refused_in_the_end() {
    let (handle, _peer) = start(config(), Probe::default());
    let lease = handle.lender.borrow().expect("the cycle is not lent");
    let refused = (0..=READERS_MAX).find_map(|_| handle.cycles.attach(DEPTH).err());
    assert_eq!(refused, Some(AttachError::Busy));
    drop(lease);
    wait_for("place", || handle.cycles.attach(DEPTH).ok());
}
