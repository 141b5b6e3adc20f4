//! The thread over real sockets, beside a robot that is a plain UDP socket in this process.
//!
//! Waits have generous deadlines and end as soon as what they wait for is there: the margins are for a loaded machine
//! with two processors, not for the code.

mod audience;
mod lease;

use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::time::{Duration, Instant};

use franka_proto::{DecodeError, RobotCommand, RobotState, Version};
use franka_rt::driver::{Driver, Event, LinkTimeout};
use franka_rt::exchange;
use franka_rt::sched::{Realtime, SchedError, Scheduling, kernel_is_realtime};
use franka_rt::stats::{Arrival, CycleTimes};
use franka_rt::thread::{
    self, Capacity, Core, Handle, LinkFault, Lost, Notice, StartError, ThreadConfig,
};

const VERSION: Version = Version::V10;

/// Longer than any wait of a working thread, on any machine.
const DEADLINE: Duration = Duration::from_secs(10);

const ROBOT: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

/// A peer on 127.0.0.0/8 that sends states to the thread.
struct Peer(UdpSocket);

impl Peer {
    fn new(address: [u8; 4], port: u16) -> Self {
        let socket = UdpSocket::bind((Ipv4Addr::from(address), 0)).expect("a free port");
        socket
            .connect((Ipv4Addr::LOCALHOST, port))
            .expect("an address");
        socket.set_read_timeout(Some(DEADLINE)).expect("an option");
        Self(socket)
    }

    fn send(&self, message_id: u64) {
        self.0.send(&state(message_id)).expect("loopback");
    }

    fn command(&self) -> RobotCommand {
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let size = self.0.recv(&mut bytes).expect("a command comes");
        RobotCommand::decode(VERSION, &bytes[..size]).expect("it is one")
    }
}

fn state(message_id: u64) -> Vec<u8> {
    let mut bytes = vec![0; RobotState::MAX_SIZE];
    let state = RobotState {
        message_id,
        q: [message_id as f64; 7],
        ..RobotState::default()
    };
    let size = state.encode(VERSION, &mut bytes).expect("there is room");
    bytes.truncate(size);
    bytes
}

/// Real-time scheduling where this process may have it.
fn config() -> ThreadConfig {
    let scheduling = Scheduling {
        realtime: Realtime::Ignore,
        ..Scheduling::default()
    };
    ThreadConfig {
        scheduling,
        ..ThreadConfig::default()
    }
}

fn socket() -> (UdpSocket, u16) {
    let socket = exchange::bind(ROBOT).expect("a free port");
    let port = socket.local_addr().expect("bound").port();
    (socket, port)
}

fn start<C: Core>(config: ThreadConfig, core: C) -> (Handle<C>, Peer) {
    let (socket, port) = socket();
    let handle = thread::spawn(config, core, socket, ROBOT, VERSION).expect("nothing is enforced");
    (handle, Peer::new([127, 0, 0, 1], port))
}

/// Asks again and again until there is an answer.
fn wait_for<T>(what: &str, mut poll: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(answer) = poll() {
            return answer;
        }
        assert!(start.elapsed() < DEADLINE, "no {what} after {DEADLINE:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn states_are_published_as_they_come() {
    let (mut handle, robot) = start(config(), Driver::new(VERSION));
    let mut late_reader = handle.states.clone();
    let mut newest = 0;
    let mut sent = 0;
    // At least 300, and then until the last one has been seen: a host that stands still for long loses states.
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
    wait_for("ring", || (handle.wake.clear() > 0).then_some(()));

    handle.thread.join().expect("nothing panics");
    let stats = &handle.stats;
    assert_eq!(
        stats.states.get() + stats.skipped.get() + stats.lost.get(),
        sent
    );
    assert_eq!(stats.interval.count(), stats.states.get() - 1);
    let times: Vec<u64> = std::iter::from_fn(|| handle.records.pop().ok())
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
    // All of them wait in the kernel before there is a thread; 37 is prime to 50, so each id comes once.
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
    assert!(handle.notices.pop().is_err(), "there is nothing to report");
}

#[test]
fn short_datagrams_are_reported_once_and_the_next_state_is_taken() {
    let (mut handle, robot) = start(config(), Driver::new(VERSION));
    let expected = state(1).len();
    for _ in 0..20 {
        robot.0.send(&state(1)[..expected - 1]).expect("loopback");
        std::thread::sleep(Duration::from_millis(2));
    }
    let notice = wait_for("notice", || handle.notices.pop().ok());
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
    wait_for("ring", || (handle.wake.clear() > 0).then_some(()));
    robot.send(2);
    assert_eq!(wait_for("state", || handle.states.newest()).message_id, 2);
    handle.thread.join().expect("nothing panics");
    assert_eq!(handle.stats.malformed.get(), 20);
    assert!(
        handle.notices.pop().is_err(),
        "nineteen more of the same are no news"
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
    handle.wake.clear();
    let notice = wait_for("notice", || handle.notices.pop().ok());
    let Notice::Core(Event::LinkLost { silence }) = notice else {
        panic!("{notice:?}")
    };
    // It was received a little before `heard`; the latest tick after the timeout tells.
    assert!(silence >= Duration::from_millis(100), "{silence:?}");
    assert!(
        silence <= heard.elapsed() + Duration::from_secs(1),
        "{silence:?}"
    );
    wait_for("ring", || (handle.wake.clear() > 0).then_some(()));
    robot.send(2_000);
    assert_eq!(
        wait_for("state", || handle.states.newest()).message_id,
        2_000
    );
}

/// The median of five, as any one of them may meet a machine that is busy with something else.
#[test]
fn the_shortest_link_timeout_is_noticed_before_another_has_passed() {
    let timeout = LinkTimeout::new(LinkTimeout::MIN).expect("in range");
    let mut noticed: Vec<Duration> = (0..5)
        .map(|_| {
            let driver = Driver::new(VERSION).with_link_timeout(timeout);
            let (mut handle, robot) = start(config(), driver);
            robot.send(1);
            wait_for("loss", || match handle.notices.pop() {
                Ok(Notice::Core(Event::LinkLost { silence })) if handle.stats.states.get() > 0 => {
                    Some(silence)
                }
                _ => None,
            })
        })
        .collect();
    noticed.sort_unstable();
    assert!(noticed[0] >= LinkTimeout::MIN, "{noticed:?}");
    assert!(noticed[2] < 2 * LinkTimeout::MIN, "{noticed:?}");
}

/// Two states in each timeout, whatever a busy machine makes of the pauses: without a busy one in between, none is lost.
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
    let losses = std::iter::from_fn(|| handle.notices.pop().ok()).count();
    assert!(
        losses == 0 || longest.max(worst) >= LinkTimeout::MIN,
        "{losses} losses with pauses of {longest:?} at most"
    );
}

/// The median of five, as any one of them may meet a machine that is busy with something else.
#[test]
fn stopping_takes_less_than_a_tenth_of_a_second() {
    for silent in [true, false] {
        let mut durations: Vec<Duration> = (0..5)
            .map(|_| {
                let (mut handle, robot) = start(config(), Driver::new(VERSION));
                robot.send(1);
                wait_for("state", || handle.states.newest());
                let sender = (!silent).then(|| {
                    std::thread::spawn(move || {
                        for message_id in 2..100 {
                            // The port closes under it.
                            let _ = robot.0.send(&state(message_id));
                            std::thread::sleep(Duration::from_millis(1));
                        }
                    })
                });
                assert!(!handle.thread.has_ended());
                let start = Instant::now();
                handle.thread.join().expect("nothing panics");
                let duration = start.elapsed();
                if let Some(sender) = sender {
                    sender.join().expect("sending does not panic");
                }
                duration
            })
            .collect();
        durations.sort_unstable();
        assert!(
            durations[2] < Duration::from_millis(100),
            "silent {silent}: {durations:?}"
        );
    }
}

#[test]
fn dropping_the_owner_stops_the_thread_without_waiting() {
    let (handle, _robot) = start(config(), Driver::new(VERSION));
    let stats = handle.stats.clone();
    drop(handle);
    // The thread's own clone of the counters goes with it.
    wait_for("end", || {
        (std::sync::Arc::strong_count(&stats) == 1).then_some(())
    });
}

#[test]
fn what_is_enforced_and_refused_starts_nothing() {
    let (socket, _) = socket();
    let scheduling = Scheduling {
        priority: Some(1_000),
        ..Scheduling::default()
    };
    let config = ThreadConfig {
        scheduling,
        ..ThreadConfig::default()
    };
    let error = thread::spawn(config, Driver::new(VERSION), socket, ROBOT, VERSION)
        .expect_err("no such priority");
    assert_eq!(
        error.to_string(),
        "libfranka: unable to set realtime scheduling: Invalid argument"
    );

    if !kernel_is_realtime() {
        let (socket, _) = self::socket();
        let outcome = thread::spawn(
            ThreadConfig::default(),
            Driver::new(VERSION),
            socket,
            ROBOT,
            VERSION,
        );
        let Err(StartError::Scheduling(error)) = outcome else {
            panic!("this kernel is no real-time one")
        };
        assert!(
            matches!(
                error,
                SchedError::KernelNotRealtime | SchedError::SetScheduling(_)
            ),
            "{error}"
        );
    }
}

/// A core that does what a test needs: answers states, counts, says much at once, panics on demand.
#[derive(Debug, Default)]
struct Probe {
    orders: Vec<u32>,
    panics_at: Option<u64>,
    to_say: std::ops::Range<u32>,
    /// Commands whose times it was told before the record of their cycle was made.
    turnarounds: u64,
    /// Cycles that it was told of when all was over.
    cycles: Vec<CycleTimes>,
    skipped: u64,
}

impl Core for Probe {
    type Order = u32;
    type Event = u32;
    type Record = u64;

    fn on_order(&mut self, order: u32) {
        self.orders.push(order);
    }

    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        assert_ne!(Some(state.message_id), self.panics_at, "the core fails");
        Some(RobotCommand {
            message_id: state.message_id,
            ..RobotCommand::default()
        })
    }

    fn on_silence(&mut self, _: Duration) {}

    fn on_skipped(&mut self, states: u64) {
        self.skipped += states;
    }

    fn after_send(&mut self, state: &RobotState, _: &Arrival, sent: Option<&CycleTimes>) {
        assert_eq!(sent.map(|sent| sent.time), Some(state.message_id));
        self.turnarounds += 1;
    }

    fn record(&self) -> u64 {
        self.turnarounds
    }

    fn note_cycle(&mut self, cycle: &CycleTimes) {
        self.cycles.push(*cycle);
    }

    fn take_event(&mut self) -> Option<u32> {
        self.to_say.next()
    }
}

#[test]
fn every_state_is_answered_to_its_sender_before_its_record_is_made() {
    let (mut handle, robot) = start(config(), Probe::default());
    for message_id in 1..=100 {
        robot.send(message_id);
        assert_eq!(robot.command().message_id, message_id);
    }
    let core = handle.thread.join().expect("nothing panics");
    assert_eq!(core.turnarounds, 100);
    assert_eq!(handle.stats.commands.get(), 100);
    let stats = &handle.stats;
    assert_eq!((stats.turnaround.count(), stats.slack.count()), (100, 100));
    let records: Vec<u64> = std::iter::from_fn(|| handle.records.pop().ok()).collect();
    assert_eq!(
        records,
        (1..=100).collect::<Vec<_>>(),
        "the core has heard of the turnaround before"
    );
    let times: Vec<_> = core.cycles.iter().map(|cycle| cycle.time).collect();
    assert_eq!(times, records, "and of the whole cycle after");
    let worst = core.cycles.iter().max_by_key(|cycle| cycle.total());
    assert_eq!(stats.worst_cycle().as_ref(), worst);
    let overruns = core.cycles.iter().filter(|c| c.slack.overrun().is_some());
    assert_eq!(stats.overrun.count(), overruns.count() as u64);
    for cycle in &core.cycles {
        let gone = cycle.late + cycle.turnaround;
        assert_eq!(
            i128::from(cycle.slack.as_nanos()),
            1_000_000 - gone.as_nanos() as i128
        );
        assert_eq!(cycle.phases.is_some(), cfg!(feature = "cycle-phases"));
        if let Some(phases) = cycle.phases {
            let before = phases.orders + phases.decode + phases.program + phases.send;
            assert_eq!(before, cycle.turnaround, "the phases leave no gap");
            assert!(phases.program > Duration::ZERO && phases.publish > Duration::ZERO);
        }
    }
}

#[test]
fn every_state_comes_once_and_in_order_and_the_rest_is_counted() {
    let mut config = config();
    config.capacity.states = 50;
    let (mut handle, robot) = start(config, Probe::default());
    let exchange = |message_ids: std::ops::RangeInclusive<u64>| {
        for message_id in message_ids {
            robot.send(message_id);
            assert_eq!(robot.command().message_id, message_id);
        }
    };
    let mut take = || -> Vec<u64> {
        std::iter::from_fn(|| handle.sequence.pop())
            .map(|state| {
                assert_eq!(state.q, [state.message_id as f64; 7]);
                state.message_id
            })
            .collect()
    };
    exchange(1..=30);
    // The last command has left before its state is in the ring: it is left for the next time.
    let mut taken = take();
    exchange(31..=40);
    taken.extend(take());
    exchange(41..=140);
    let core = handle.thread.join().expect("nothing panics");
    taken.extend(take());
    let lost = handle.stats.states_lost.get();
    assert!((50..=51).contains(&lost), "{lost} of 100 found 50 places");
    assert!(taken.iter().copied().eq(1..=140 - lost), "{taken:?}");
    assert_eq!((core.turnarounds, core.skipped), (140, 0));
}

#[test]
fn orders_arrive_in_their_order_while_the_robot_is_silent() {
    let (mut handle, _robot) = start(config(), Probe::default());
    for order in 0..40 {
        wait_for("room", || handle.orders.push(order).ok());
    }
    wait_for("empty queue", || {
        (handle.orders.slots() == Capacity::default().orders).then_some(())
    });
    let core = handle.thread.join().expect("nothing panics");
    assert_eq!(core.orders, (0..40).collect::<Vec<_>>());
}

#[test]
fn events_wait_for_room_and_none_is_lost() {
    let capacity = Capacity {
        notices: 1,
        records: 4,
        ..Capacity::default()
    };
    let (mut handle, robot) = start(
        ThreadConfig {
            capacity,
            ..config()
        },
        Probe {
            to_say: 0..30,
            ..Probe::default()
        },
    );
    for expected in 0..30 {
        let notice = wait_for("event", || handle.notices.pop().ok());
        assert!(
            matches!(notice, Notice::Core(event) if event == expected),
            "{notice:?}"
        );
        robot.send(u64::from(expected) + 1);
        robot.command();
    }
    handle.thread.join().expect("nothing panics");
    assert_eq!(
        handle.stats.records_lost.get(),
        26,
        "the ring holds 4 of 30 records"
    );
}

#[test]
fn a_panic_of_the_core_ends_the_thread_and_nothing_else() {
    let (mut handle, robot) = start(
        config(),
        Probe {
            panics_at: Some(2),
            ..Probe::default()
        },
    );
    robot.send(1);
    assert_eq!(wait_for("state", || handle.states.newest()).message_id, 1);
    handle.wake.clear();
    robot.send(2);
    wait_for("end", || handle.thread.has_ended().then_some(()));
    wait_for("ring", || (handle.wake.clear() > 0).then_some(()));
    let lost = handle.thread.join().expect_err("it panicked");
    let Lost::Panicked { message } = lost else {
        panic!("{lost}")
    };
    assert!(message.contains("the core fails"), "{message}");

    let (mut handle, robot) = start(config(), Probe::default());
    robot.send(1);
    assert_eq!(
        wait_for("state of a new thread", || handle.states.newest()).message_id,
        1
    );
    handle.thread.join().expect("nothing panics");
}
