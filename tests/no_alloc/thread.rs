//! The running thread, with all kinds of input on its socket and queues. The core runs on the
//! real-time thread and reads the count of that thread. A thread that has borrowed the cycle reads
//! its own count.

use std::hint::black_box;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_proto::{
    ControllerMode, MotionGeneratorMode, RobotCommand, RobotMode, RobotState, Version,
};
use franka_rt::control::{ActiveControl, Command, Modes, Torques};
use franka_rt::driver::{ControlLog, Driver, Event, LinkTimeout, MotionId, Order, Program, Record};
use franka_rt::exchange;
use franka_rt::sched::{Realtime, Scheduling};
use franka_rt::stats::{Arrival, CycleTimes, MotionStatistics};
use franka_rt::thread::{self, Core, Handle, Notice, ThreadConfig};

const VERSION: Version = Version::V10;

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

    fn note_cycle(&mut self, cycle: &CycleTimes) {
        self.driver.note_cycle(cycle);
    }

    /// Present in every cycle, so that they are published.
    fn statistics(&self) -> Option<&MotionStatistics> {
        Some(&self.statistics)
    }

    fn record(&self) -> Record {
        *self.driver.record()
    }

    fn take_event(&mut self) -> Option<Event> {
        self.driver.take_event()
    }
}

/// A thread, and the port where it expects states.
fn start<C: Core>(core: C) -> (Handle<C>, u16) {
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
    let handle = thread::spawn(config, core, socket, robot, VERSION);
    (handle.expect("nothing is enforced"), port)
}

/// A socket at 127.0.0.`last` that sends to `port`.
fn peer(last: u8, port: u16) -> UdpSocket {
    let socket = UdpSocket::bind((Ipv4Addr::new(127, 0, 0, last), 0)).expect("a free port");
    let connected = socket.connect((Ipv4Addr::LOCALHOST, port));
    connected.expect("an address");
    socket
}

/// Runs a thread for about two seconds with all kinds of input, among them one order `order`.
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
    let (handle, port) = start(core);
    let Handle {
        mut orders,
        mut notices,
        mut records,
        stats,
        thread,
        ..
    } = handle;
    let (robot, stranger) = (peer(1, port), peer(2, port));
    let mut bytes = vec![0; RobotState::MAX_SIZE];
    let mut losses = 0;
    for message_id in 1..=2_000u64 {
        let state = RobotState {
            message_id,
            ..RobotState::default()
        };
        let size = state.encode(VERSION, &mut bytes).expect("there is room");
        robot.send(&bytes[..size]).expect("loopback");
        match message_id % 500 {
            100 => drop(orders.push(order)),
            200 => drop(stranger.send(&bytes[..size])),
            300 => drop(robot.send(&bytes[..100])),
            400 => std::thread::sleep(Duration::from_millis(120)), // longer than the link timeout
            450..480 => continue,                                  // a burst
            _ => {}
        }
        while let Some(notice) = notices.pop() {
            losses += u32::from(matches!(notice, Notice::Core(Event::LinkLost { .. })));
        }
        while records.pop().is_some() {}
        std::thread::sleep(Duration::from_millis(1));
    }
    thread.join().map(drop).expect("nothing panics");
    assert!(losses >= 4, "each pause was reported: {losses}");
    assert!(
        stats.commands.get() > 500 && stats.foreign.get() == 4 && stats.malformed.get() == 4,
        "{stats:?}"
    );
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
fn turns_and_writes_on_a_borrowing_thread_neither_allocate_nor_free() {
    const TURNS: u64 = 100_000;
    let modes = Modes {
        generator: MotionGeneratorMode::None,
        controller: ControllerMode::ExternalController,
    };
    let (mut handle, port) = start(Driver::new(VERSION));
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
    drop(lease);
    handle.thread.join().map(drop).expect("nothing panics");
    assert_eq!((read, written), (TURNS, TURNS));
    assert_eq!(calls, 0, "calls of the allocator");
}
