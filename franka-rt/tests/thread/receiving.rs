//! Received datagrams: states, invalid datagrams, and silence.

use std::os::unix::thread::JoinHandleExt;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use super::*;

#[test]
fn states_are_published_as_they_come() {
    let (mut handle, robot) = start(config(), Driver::new(VERSION));
    let mut late_reader = handle.states.clone();
    let mut newest = 0;
    let mut sent = 0;
    // Sends at least 300 states, and continues until the last one was seen: a host that stands
    // still for long loses states.
    wait_for("state that is the last one sent", || {
        if let Some(state) = handle.states.newest() {
            assert!(
                state.message_id > newest,
                "{} after {newest}",
                state.message_id
            );
            assert_eq!(state.q, [state.message_id as f64; 7]);
            newest = state.message_id;
        }
        if newest >= 300 && newest == sent {
            return Some(());
        }
        sent += 1;
        robot.send(sent);
        None
    });
    assert_eq!(
        late_reader.newest().map(|state| state.message_id),
        Some(sent)
    );
    wait_for("ring", || (handle.event_fd.drain() > 0).then_some(()));

    handle.thread.join().expect("nothing panics");
    let stats = &handle.stats;
    assert_eq!(
        stats.states.get() + stats.skipped.get() + stats.lost.get(),
        sent
    );
    assert_eq!(stats.interval.count(), stats.states.get() - 1);
    let times: Vec<u64> = std::iter::from_fn(|| handle.records.pop())
        .map(|record| record.time)
        .collect();
    assert!(
        times.is_sorted() && times.last() == Some(&sent),
        "{times:?}"
    );
    assert_eq!(
        (times.len() as u64, stats.records_lost.get()),
        (stats.states.get(), 0)
    );
}

#[test]
fn the_newest_of_a_burst_wins() {
    let (socket, port) = socket();
    let robot = Peer::new([127, 0, 0, 1], port);
    // All states wait in the kernel before the thread starts. 37 is prime to 50, so each id occurs
    // once.
    for i in 0..50 {
        robot.send(100 + i * 37 % 50);
    }
    let mut handle =
        thread::spawn(config(), Driver::new(VERSION), socket, ROBOT, VERSION).expect("it starts");
    let state = wait_for("state", || handle.states.newest());
    assert_eq!(state.message_id, 149);
    robot.send(153);
    assert_eq!(wait_for("state", || handle.states.newest()).message_id, 153);
    handle.thread.join().expect("nothing panics");
    assert_eq!(handle.stats.states.get(), 2);
    assert_eq!(handle.stats.skipped.get() + handle.stats.stale.get(), 49);
    assert_eq!(handle.stats.lost.get(), 3);
}

#[test]
fn datagrams_from_elsewhere_change_nothing() {
    let (socket, port) = socket();
    let robot = Peer::new([127, 0, 0, 1], port);
    let stranger = Peer::new([127, 0, 0, 2], port);
    stranger.send(9_000);
    robot.send(5);
    stranger.0.send(&[0xff; 3000]).expect("loopback");
    let mut handle =
        thread::spawn(config(), Driver::new(VERSION), socket, ROBOT, VERSION).expect("it starts");
    assert_eq!(wait_for("state", || handle.states.newest()).message_id, 5);
    stranger.send(9_001);
    robot.send(6);
    assert_eq!(wait_for("state", || handle.states.newest()).message_id, 6);
    handle.thread.join().expect("nothing panics");
    assert_eq!(handle.stats.foreign.get(), 3);
    assert!(handle.notices.pop().is_none(), "there is nothing to report");
}

#[test]
fn short_datagrams_are_reported_once_and_end_nothing() {
    let (mut handle, robot) = start(config(), Driver::new(VERSION));
    let expected = state(1).len();
    for _ in 0..20 {
        robot.0.send(&state(1)[..expected - 1]).expect("loopback");
        std::thread::sleep(Duration::from_millis(2));
    }
    let notice = wait_for("notice", || handle.notices.pop());
    let Notice::Link(fault) = notice else {
        panic!("{notice:?}")
    };
    assert_eq!(
        fault,
        LinkFault::Datagram(DecodeError::DatagramSize {
            got: expected - 1,
            expected
        })
    );
    assert_eq!(fault.to_string(), "libfranka: incorrect object size");
    wait_for("ring", || (handle.event_fd.drain() > 0).then_some(()));
    robot.send(2);
    assert_eq!(wait_for("state", || handle.states.newest()).message_id, 2);
    handle.thread.join().expect("nothing panics");
    assert_eq!(handle.stats.malformed.get(), 20);
    assert!(
        handle.notices.pop().is_none(),
        "nineteen more of the same are not reported"
    );
}

#[test]
fn silence_is_reported_and_a_later_state_taken() {
    let timeout = LinkTimeout::new(Duration::from_millis(100)).expect("in range");
    let driver = Driver::new(VERSION).with_link_timeout(timeout);
    let (mut handle, robot) = start(config(), driver);
    robot.send(1);
    wait_for("state", || handle.states.newest());
    let heard = Instant::now();
    handle.event_fd.drain();
    let notice = wait_for("notice", || handle.notices.pop());
    let Notice::Core(Event::LinkLost { silence }) = notice else {
        panic!("{notice:?}")
    };
    // The state was received a little before `heard`; the latest tick after the timeout notices.
    assert!(silence >= Duration::from_millis(100), "{silence:?}");
    assert!(
        silence <= heard.elapsed() + Duration::from_secs(1),
        "{silence:?}"
    );
    wait_for("ring", || (handle.event_fd.drain() > 0).then_some(()));
    robot.send(2_000);
    assert_eq!(
        wait_for("state", || handle.states.newest()).message_id,
        2_000
    );
}

/// A busy machine may delay single attempts, so only one of them must be in time.
#[test]
fn shortest_link_timeout_is_noticed_within_two_periods() {
    let timeout = LinkTimeout::new(LinkTimeout::MIN).expect("in range");
    wait_for("timely notice", || {
        let driver = Driver::new(VERSION).with_link_timeout(timeout);
        let (mut handle, robot) = start(config(), driver);
        robot.send(1);
        let silence = wait_for("loss", || match handle.notices.pop() {
            Some(Notice::Core(Event::LinkLost { silence })) if handle.stats.states.get() > 0 => {
                Some(silence)
            }
            _ => None,
        });
        assert!(silence >= LinkTimeout::MIN, "{silence:?}");
        (silence < 2 * LinkTimeout::MIN).then_some(())
    });
}

/// The robot sends two states per timeout. The link is not lost, unless a busy machine lengthens a
/// pause to the timeout.
#[test]
fn a_link_within_the_shortest_timeout_is_not_lost() {
    let timeout = LinkTimeout::new(LinkTimeout::MIN).expect("in range");
    let driver = Driver::new(VERSION).with_link_timeout(timeout);
    let (mut handle, robot) = start(config(), driver);
    robot.send(1);
    wait_for("state", || handle.states.newest());
    let mut longest = Duration::ZERO;
    let mut sent = Instant::now();
    for message_id in 2..=100 {
        std::thread::sleep(LinkTimeout::MIN / 2);
        longest = longest.max(sent.elapsed());
        sent = Instant::now();
        robot.send(message_id);
    }
    let worst = handle.stats.interval.max().unwrap_or_default();
    let losses = std::iter::from_fn(|| handle.notices.pop()).count();
    assert!(
        losses == 0 || longest.max(worst) >= LinkTimeout::MIN,
        "{losses} losses with pauses of {longest:?} at most"
    );
}

/// A robot, and a state for it to send while the thread of the cycle is held up.
static MEANWHILE: OnceLock<(UdpSocket, Vec<u8>)> = OnceLock::new();
static HELD_UP: AtomicBool = AtomicBool::new(false);

/// Simulates a host that does not run the interrupted thread for the link timeout.
extern "C" fn hold_up(_: libc::c_int) {
    std::thread::sleep(franka_rt::driver::LINK_TIMEOUT);
    let (robot, state) = MEANWHILE.get().expect("it is set before the signal");
    robot.send(state).expect("loopback");
    HELD_UP.store(true, Ordering::SeqCst);
}

/// Uses a borrower's thread, because the driver's own thread blocks signals.
#[test]
fn state_received_during_a_hold_up_averts_a_lost_link() {
    const LATE: u64 = 1_000_000;
    let (mut handle, robot) = start(config(), Driver::new(VERSION));
    let other = robot.0.try_clone().expect("a descriptor");
    MEANWHILE.set((other, state(LATE))).expect("set here only");
    // SAFETY: the handler sleeps, reads a value that is there, sends and stores: system calls and
    // atomics, which are async-signal-safe. Nothing else in this process uses the signal.
    unsafe { libc::signal(libc::SIGUSR1, hold_up as *const () as libc::sighandler_t) };
    let mut lease = handle.lender.borrow().expect("no other borrower has it");
    let borrower = std::thread::spawn(move || {
        for message_id in 1.. {
            robot.send(message_id);
            let taken = lease.turn().expect("the thread lives").expect("a state");
            // The signal almost always comes in this turn, which takes nearly all of the time.
            let next = lease.turn().expect("the thread lives");
            if HELD_UP.load(Ordering::SeqCst) {
                let late = [Some(taken), next, lease.turn().expect("the thread lives")];
                let late = late
                    .into_iter()
                    .flatten()
                    .any(|state| state.message_id == LATE);
                return late;
            }
        }
        unreachable!("the signal comes")
    });
    wait_for("loop of turns", || {
        (handle.stats.states.get() > 2).then_some(())
    });
    // SAFETY: the thread has not been joined, so its identifier is valid.
    let sent = unsafe { libc::pthread_kill(borrower.as_pthread_t(), libc::SIGUSR1) };
    assert_eq!(sent, 0);
    assert!(borrower.join().expect("no panic"), "the state is taken");
    while let Some(notice) = handle.notices.pop() {
        assert!(
            !matches!(notice, Notice::Core(Event::LinkLost { .. })),
            "{notice:?}"
        );
    }
}
