//! The running thread, with all kinds of input on its socket and queues. The core runs on the
//! real-time thread and reads the count of that thread. A thread that has borrowed the cycle reads
//! its own count.

use std::hint::black_box;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::os::fd::{AsRawFd, RawFd};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use franka_proto::{
    ControllerMode, MotionGeneratorMode, RobotCommand, RobotMode, RobotState, Version,
};
use franka_rt::control::{ActiveControl, Command, Modes, Torques};
use franka_rt::driver::{ControlLog, Driver, Event, LinkTimeout, MotionId, Order, Program, Record};
use franka_rt::exchange;
use franka_rt::sched::{Realtime, Scheduling};
use franka_rt::stats::{Arrival, CycleTimes, MotionStatistics};
use franka_rt::thread::{self, Core, CycleFeed, Handle, Notice, ThreadConfig};
use franka_tests::broken_socket::BrokenSocket;

const VERSION: Version = Version::V10;

const CAPACITY: usize = CycleFeed::<Record>::DEFAULT_CAPACITY;

/// A driver that answers every state, and reports how often its thread has called the allocator.
struct Watched {
    driver: Driver,
    statistics: MotionStatistics,
    first: Option<u64>,
    calls: Arc<AtomicU64>,
    /// The order that makes it allocate, to prove that this is detected.
    allocates_on: u64,
}

impl Watched {
    fn look(&mut self) {
        let now = crate::calls();
        let first = *self.first.get_or_insert(now);
        self.calls.store(now - first, Ordering::Relaxed);
    }
}

impl Core for Watched {
    type Order = u64;
    type Event = Event;
    type Record = Record;

    fn on_order(&mut self, order: u64) {
        if order == self.allocates_on {
            drop(black_box(Box::new(order)));
        }
    }

    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        self.look();
        let idle = self.driver.on_state(state);
        idle.or(Some(RobotCommand {
            message_id: state.message_id,
            ..RobotCommand::default()
        }))
    }

    fn on_silence(&mut self, silence: Duration) {
        self.look();
        self.driver.on_silence(silence);
    }

    fn on_skipped(&mut self, states: u64) {
        self.driver.on_skipped(states);
    }

    fn after_send(&mut self, state: &RobotState, arrival: &Arrival, sent: Option<&CycleTimes>) {
        self.driver.after_send(state, arrival, sent);
    }

    fn prepare(&mut self) {
        self.driver.prepare();
    }

    /// Returns statistics in every cycle, so that they are published.
    fn note_cycle(&mut self, cycle: &CycleTimes) -> Option<&MotionStatistics> {
        self.driver.note_cycle(cycle);
        Some(&self.statistics)
    }

    fn record(&self) -> Record {
        *self.driver.record()
    }

    fn take_event(&mut self) -> Option<Event> {
        self.driver.take_event()
    }
}

/// A thread, the port where it expects states, and the descriptor of its socket.
fn start<C: Core>(core: C) -> (Handle<C>, u16, RawFd) {
    let scheduling = Scheduling {
        realtime: Realtime::Ignore,
        ..Scheduling::default()
    };
    let config = ThreadConfig {
        scheduling,
        ..ThreadConfig::default()
    };
    let robot = IpAddr::V4(Ipv4Addr::LOCALHOST);
    let socket = exchange::bind(robot).expect("a free port");
    let port = socket.local_addr().expect("bound").port();
    let descriptor = socket.as_raw_fd();
    let handle = thread::spawn(config, core, socket, robot, VERSION);
    (handle.expect("nothing is enforced"), port, descriptor)
}

/// Waits until this holds.
fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(300), "no {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// A socket at 127.0.0.`last` that sends to `port`.
fn peer(last: u8, port: u16) -> UdpSocket {
    let socket = UdpSocket::bind((Ipv4Addr::new(127, 0, 0, last), 0)).expect("a free port");
    let connected = socket.connect((Ipv4Addr::LOCALHOST, port));
    connected.expect("an address");
    socket
}

/// Runs a thread for some seconds with all kinds of input, among them one order `order`, failing
/// receives, a borrower that runs no turn, and readers of its cycles that come and go.
/// Returns the thread's calls of the allocator and the number of its cycles.
fn calls_of_a_busy_thread(order: u64) -> (u64, u64) {
    let calls = Arc::new(AtomicU64::new(0));
    let timeout = LinkTimeout::new(Duration::from_millis(50)).expect("in range");
    let driver = Driver::new(VERSION).with_link_timeout(timeout);
    let core = Watched {
        driver,
        statistics: MotionStatistics::default(),
        first: None,
        calls: calls.clone(),
        allocates_on: 7,
    };
    let (handle, port, descriptor) = start(core);
    let Handle {
        mut orders,
        mut notices,
        mut records,
        stats,
        cycles,
        lender,
        thread,
        ..
    } = handle;
    let mut drained = cycles.attach(CAPACITY).expect("there is room");
    let mut changing = cycles.attach(1).expect("there is room");
    let (robot, stranger) = (peer(1, port), peer(2, port));
    let mut bytes = vec![0; RobotState::MAX_SIZE];
    for message_id in 1..=2_000u64 {
        let state = RobotState {
            message_id,
            ..RobotState::default()
        };
        let size = state.encode(VERSION, &mut bytes).expect("there is room");
        robot.send(&bytes[..size]).expect("loopback");
        let round = message_id / 500 + 1;
        if message_id % 100 == 0 {
            assert!(changing.lost() > 0, "it is full for most of the time");
            drop(changing);
            changing = cycles.attach(1).expect("one was dropped");
        }
        match message_id % 500 {
            50 => {
                let lease = lender.borrow().expect("the cycle is not lent");
                until("stall", || thread.stalled().is_some());
                drop(lease);
                until("end of the stall", || thread.stalled().is_none());
            }
            100 => drop(orders.push(order)),
            150 => {
                let _broken = BrokenSocket::new(descriptor).expect("a descriptor");
                let failed = stats.receive_errors.get() + 5;
                until("failed receives", || stats.receive_errors.get() > failed);
            }
            200 => {
                stranger.send(&bytes[..size]).expect("loopback");
                until("foreign datagram", || stats.foreign.get() == round);
            }
            300 => {
                robot.send(&bytes[..100]).expect("loopback");
                until("malformed datagram", || stats.malformed.get() == round);
            }
            400 => until("loss of the link", || {
                std::iter::from_fn(|| notices.pop())
                    .any(|notice| matches!(notice, Notice::Core(Event::LinkLost { .. })))
            }),
            450..480 => continue, // a burst
            _ => {}
        }
        while notices.pop().is_some() {}
        while records.pop().is_some() {}
        while drained.pop().is_some() {}
        std::thread::sleep(Duration::from_millis(1));
    }
    thread.join().map(drop).expect("nothing panics");
    assert_eq!(drained.lost(), 0);
    assert!(stats.commands.get() > 500, "{stats:?}");
    assert!(
        stats.states_lost.get() > 0,
        "unread states are counted as lost"
    );
    assert!(stats.worst_cycle().is_some() && stats.motion().is_some());
    (calls.load(Ordering::Relaxed), stats.states.get())
}

#[test]
fn the_running_thread_neither_allocates_nor_frees() {
    let (calls, states) = calls_of_a_busy_thread(1);
    assert_eq!(calls, 0, "calls of the allocator in {states} cycles");
    let (calls, _) = calls_of_a_busy_thread(7);
    assert_eq!(calls, 8, "four boxes made and freed on purpose are counted");
}

/// The output of the turns is not read: the queues are full for most of the time.
#[test]
fn borrowing_thread_never_calls_the_allocator() {
    const TURNS: u64 = 100_000;
    let modes = Modes {
        generator: MotionGeneratorMode::None,
        controller: ControllerMode::ExternalController,
    };
    let (mut handle, port, _) = start(Driver::new(VERSION));
    let order = Order::Arm {
        motion: MotionId(1),
        modes,
        program: Program::Active(ActiveControl),
        log: ControlLog::with_capacity(50),
        ticket: None,
        times: Arc::default(),
        observer: None,
    };
    handle.orders.push(order).expect("the queue is empty");
    let robot = peer(1, port);
    let mut state = RobotState {
        robot_mode: RobotMode::Move,
        motion_generator_mode: modes.generator,
        controller_mode: modes.controller,
        ..RobotState::default()
    };
    let command = Command {
        motion: None,
        torques: Some(Torques([0.1; 7])),
    };
    let mut bytes = vec![0; RobotState::MAX_SIZE];
    let cycles = handle.cycles.attach(CAPACITY).expect("there is room");
    let mut lease = handle.lender.borrow().expect("the cycle is not lent");
    let (mut calls, mut read, mut written) = (0, 0, 0);
    for message_id in 1..=TURNS {
        state.message_id = message_id;
        let size = state.encode(VERSION, &mut bytes).expect("there is room");
        robot.send(&bytes[..size]).expect("loopback");
        calls += crate::calls_during(|| {
            read += u64::from(matches!(lease.turn(), Ok(Some(_))));
            written += u64::from(lease.write(&command, false).is_ok());
        });
    }
    // The ring is full: each state leaves a record.
    assert!(handle.stats.records_lost.get() > TURNS / 2);
    assert_eq!(cycles.waiting() as u64 + cycles.lost(), TURNS);
    drop(lease);
    handle.thread.join().map(drop).expect("nothing panics");
    assert_eq!((read, written), (TURNS, TURNS));
    assert_eq!(calls, 0, "calls of the allocator");
}
