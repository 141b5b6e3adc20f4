//! The running thread, whatever comes over its socket and queues.
//!
//! The core, which runs on the real-time thread, reads the count of that thread.

use std::hint::black_box;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_proto::{RobotCommand, RobotState, Version};
use franka_rt::driver::{Driver, Event, Record};
use franka_rt::exchange;
use franka_rt::sched::{Realtime, Scheduling};
use franka_rt::thread::{self, Core, Handle, Notice, ThreadConfig};

const VERSION: Version = Version::V10;

/// A driver whose every state is answered, and that tells how often its thread has called the allocator.
struct Watched {
    driver: Driver,
    first: Option<u64>,
    calls: Arc<AtomicU64>,
    /// The order that makes it allocate, to show that this would be seen.
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

    fn note_turnaround(&mut self, turnaround: Duration) {
        self.driver.note_turnaround(turnaround);
    }

    fn record(&self) -> Record {
        *self.driver.record()
    }

    fn take_event(&mut self) -> Option<Event> {
        self.driver.take_event()
    }
}

/// Runs a thread for about two seconds of everything that can come, with one order `order` among it, and returns the
/// thread's calls of the allocator and the number of its cycles.
fn calls_of_a_busy_thread(order: u64) -> (u64, u64) {
    let calls = Arc::new(AtomicU64::new(0));
    let driver = Driver::new(VERSION).with_link_timeout(Duration::from_millis(50));
    let core = Watched {
        driver,
        first: None,
        calls: calls.clone(),
        allocates_on: 7,
    };
    let scheduling = Scheduling {
        realtime: Realtime::Ignore,
        ..Scheduling::default()
    };
    let config = ThreadConfig {
        scheduling,
        ..ThreadConfig::default()
    };
    let socket = exchange::bind().expect("a free port");
    let port = socket.local_addr().expect("bound").port();
    let robot = IpAddr::V4(Ipv4Addr::LOCALHOST);
    let Handle {
        mut orders,
        mut notices,
        mut records,
        stats,
        thread,
        ..
    } = thread::spawn(config, core, socket, robot, VERSION).expect("nothing is enforced");

    let peer = |last| {
        let socket = UdpSocket::bind((Ipv4Addr::new(127, 0, 0, last), 0)).expect("a free port");
        socket
            .connect((Ipv4Addr::LOCALHOST, port))
            .expect("an address");
        socket
    };
    let (robot, stranger) = (peer(1), peer(2));
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
        while let Ok(notice) = notices.pop() {
            losses += u32::from(matches!(notice, Notice::Core(Event::LinkLost { .. })));
        }
        while records.pop().is_ok() {}
        std::thread::sleep(Duration::from_millis(1));
    }
    thread.join().map(drop).expect("nothing panics");
    assert!(losses >= 4, "each pause was told: {losses}");
    assert!(
        stats.commands.get() > 500 && stats.foreign.get() == 4 && stats.malformed.get() == 4,
        "{stats:?}"
    );
    (calls.load(Ordering::Relaxed), stats.states.get())
}

#[test]
fn the_running_thread_neither_allocates_nor_frees() {
    let (calls, states) = calls_of_a_busy_thread(1);
    assert_eq!(calls, 0, "calls of the allocator in {states} cycles");
    let (calls, _) = calls_of_a_busy_thread(7);
    assert_eq!(calls, 8, "four boxes made and freed on purpose are seen");
}
