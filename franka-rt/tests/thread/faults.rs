//! Page faults of the running thread.

use std::sync::Arc;

use franka_proto::{ControllerMode, MotionGeneratorMode, RobotMode};
use franka_rt::control::{Callback, Modes, Shaper, Torques};
use franka_rt::driver::{ControlLog, MotionId, Order, Program, Record};

use super::*;

const MODES: Modes = Modes {
    generator: MotionGeneratorMode::None,
    controller: ControllerMode::ExternalController,
};

/// A driver whose records carry the minor faults of its thread so far.
struct Counted(Driver);

/// Minor faults of the calling thread: field 10 of proc_pid_stat(5).
fn faults() -> u64 {
    let stat = std::fs::read_to_string("/proc/thread-self/stat").expect("Linux has /proc");
    let fields = &stat[stat.rfind(')').expect("a name") + 1..];
    let field = fields.split_whitespace().nth(10 - 3);
    field.and_then(|count| count.parse().ok()).expect("a count")
}

impl Core for Counted {
    type Order = Order;
    type Event = Event;
    type Record = (Record, u64);

    fn on_order(&mut self, order: Order) {
        self.0.on_order(order);
    }

    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        self.0.on_state(state)
    }

    fn on_silence(&mut self, silence: Duration) {
        self.0.on_silence(silence);
    }

    fn after_send(&mut self, state: &RobotState, arrival: &Arrival, sent: Option<&CycleTimes>) {
        self.0.after_send(state, arrival, sent);
    }

    fn prepare(&mut self) {
        self.0.prepare();
    }

    fn record(&self) -> (Record, u64) {
        (*self.0.record(), faults())
    }

    fn take_event(&mut self) -> Option<Event> {
        self.0.take_event()
    }
}

/// Returns the order for a motion that ends after ten cycles.
fn arm(motion: u64) -> Order {
    let torques = |_: &RobotState, _| Torques([0.0; 7]);
    let shaper = Shaper::new(VERSION, false, 1000.0);
    Order::Arm {
        motion: MotionId(motion),
        modes: MODES,
        program: Program::Callback(Box::new(
            Callback::torques(VERSION, torques).with_shaper(shaper),
        )),
        log: ControlLog::with_capacity(5),
        ticket: None,
        times: Arc::default(),
        observer: None,
    }
}

/// The first motion runs new code, which the system may have to load.
#[test]
fn motions_after_the_first_begin_and_end_without_a_page_fault() {
    const MOTIONS: u64 = 15;
    let (mut handle, robot) = start(config(), Counted(Driver::new(VERSION)));
    let mut message_id = 0;
    let mut step = |robot_mode, modes: Modes| {
        message_id += 1;
        let state = RobotState {
            message_id,
            robot_mode,
            motion_generator_mode: modes.generator,
            controller_mode: modes.controller,
            ..RobotState::default()
        };
        let mut bytes = vec![0; RobotState::MAX_SIZE];
        let size = state.encode(VERSION, &mut bytes).expect("there is room");
        robot.0.send(&bytes[..size]).expect("loopback");
        let taken = wait_for("record", || handle.records.pop());
        assert_eq!(taken.0.time, message_id);
        taken.1
    };
    let idle = Modes {
        generator: MotionGeneratorMode::Idle,
        controller: ControllerMode::JointImpedance,
    };
    let mut counts = Vec::new();
    for motion in 1..=MOTIONS {
        handle.orders.push(arm(motion)).expect("there is room");
        step(RobotMode::Idle, idle);
        for _ in 0..10 {
            step(RobotMode::Move, MODES);
        }
        step(RobotMode::Idle, idle);
        counts.push(step(RobotMode::Idle, idle));
    }
    // Each motion has the events started and ended. None has been read, so each has its own place.
    assert!(handle.notices.waiting() as u64 >= 2 * MOTIONS);
    let per_motion: Vec<u64> = counts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert_eq!(per_motion, vec![0; per_motion.len()]);
    handle.thread.join().map(drop).expect("nothing panics");
}
