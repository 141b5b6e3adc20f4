//! Motions that begin and end in every way, with and without a reader of their events.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use franka_model::{Model, READY};
use franka_proto::{
    ControllerMode, MotionGeneratorMode, RobotError, RobotMode, RobotState, Version,
};
use franka_rt::control::{ActiveControl, Callback, Command, Finish, Modes, Next, Torques};
use franka_rt::driver::{
    Activity, ControlLog, Driver, Event, LINK_TIMEOUT, MotionId, Order, Program,
};
use franka_rt::session::{Goal, GoalId, OnArrival, Target, TargetSession};
use franka_rt::stats::{Arrival, CycleTimes};
use franka_rt::together::{StartBarrier, StartTicket};
use franka_rt::triple_buffer::triple_buffer;

use crate::calls_during;

const VERSION: Version = Version::V10;

const MODES: Modes = Modes {
    generator: MotionGeneratorMode::None,
    controller: ControllerMode::ExternalController,
};

/// End of a motion.
#[derive(Clone, Copy, Debug)]
enum End {
    /// Its `Move` is refused.
    Disarmed,
    /// The program finishes, and the robot stops.
    Finished,
    Reflex,
    /// Its program returns a non-finite value.
    Failed,
    /// Its owner has dropped it.
    Abandoned,
    /// Its owner has dropped it before it ran.
    Unwanted,
    LinkLost,
}

const ENDS: [End; 7] = [
    End::Disarmed,
    End::Finished,
    End::Reflex,
    End::Failed,
    End::Abandoned,
    End::Unwanted,
    End::LinkLost,
];

/// The events and endings of all motions, in alphabetical order.
const ALL_EVENTS: [&str; 8] = [
    "Aborted",
    "Disarmed",
    "Failed",
    "Finished",
    "Finishing",
    "LinkLost",
    "Refused",
    "Started",
];

/// Cycles of a motion before its end: more than the log holds.
const RUNNING: u64 = 60;

/// A program of each kind that has an end if possible.
fn programs(end: End) -> [Program; 3] {
    let mut calls = 0;
    let callback = Callback::torques(VERSION, move |_: &RobotState, _| -> Next<Torques> {
        calls += 1;
        match end {
            End::Failed if calls > RUNNING => Torques([f64::NAN; 7]).into(),
            End::Finished if calls > RUNNING => Torques([0.0; 7]).finish(),
            _ => Torques([0.0; 7]).into(),
        }
    });
    let (mut goals, reader) = triple_buffer();
    let target = Target::Joints(READY.into());
    let limits = Model::fr3().joint_limits();
    goals.write(Goal::new(
        GoalId(1),
        target,
        OnArrival::ReportAndFinish,
        limits,
    ));
    [
        Program::Callback(Box::new(callback)),
        Program::Target(Box::new(TargetSession::new(
            Model::fr3().clone().into(),
            VERSION,
            reader,
        ))),
        Program::Active(ActiveControl),
    ]
}

/// A driver, and the number of calls of the allocator in the thread's work.
struct Counted {
    driver: Driver,
    motion: u64,
    /// The id of the next motion.
    ticket: Option<StartTicket>,
    time: u64,
    calls: u64,
    /// The names of the events so far.
    told: BTreeSet<String>,
    reads_events: bool,
}

impl Counted {
    fn new(reads_events: bool) -> Self {
        Self {
            driver: Driver::new(VERSION),
            motion: 0,
            ticket: None,
            time: 0,
            calls: 0,
            told: BTreeSet::new(),
            reads_events,
        }
    }

    fn order(&mut self, order: Order) {
        self.calls += calls_during(|| self.driver.on_order(order));
    }

    fn arm(&mut self, program: Program) {
        let order = Order::Arm {
            motion: MotionId(self.motion),
            modes: MODES,
            program,
            log: ControlLog::with_capacity(50),
            ticket: self.ticket.take(),
            times: Arc::default(),
            observer: None,
        };
        self.order(order);
    }

    /// One cycle with a state of this mode.
    fn state(&mut self, robot_mode: RobotMode) {
        let moves = robot_mode == RobotMode::Move;
        self.time += 1;
        let mut state = RobotState {
            message_id: self.time,
            q: READY.into(),
            robot_mode,
            ..RobotState::default()
        };
        if moves {
            state.motion_generator_mode = MODES.generator;
            state.controller_mode = MODES.controller;
        } else if robot_mode == RobotMode::Reflex {
            state.reflex_reason = RobotError::CartesianReflex.into();
        } else {
            state.controller_mode = ControllerMode::JointImpedance;
        }
        let command = Command {
            motion: None,
            torques: Some(Torques([0.0; 7])),
        };
        let times = CycleTimes::new(self.time, Duration::ZERO, Duration::ZERO);
        self.calls += calls_during(|| {
            let sent = self.driver.on_state(&state).map(|_| &times);
            self.driver.after_send(&state, &Arrival::default(), sent);
            self.driver.prepare();
            self.driver.note_cycle(&times);
            // Only one kind of program accepts this order.
            let _ = self.driver.write(&command, false);
        });
        self.hear();
    }

    fn hear(&mut self) {
        while self.reads_events {
            let mut event = None;
            self.calls += calls_during(|| event = self.driver.take_event());
            // The event's content is freed here, outside the cycle.
            let Some(event) = event else { return };
            let name = match event {
                Event::Ended(ended) => format!("{:?}", ended.ending),
                other => format!("{other:?}"),
            };
            let name = name.split(' ').next().expect("the first word");
            self.told.insert(name.to_owned());
        }
    }

    /// One motion from arming to its end.
    fn motion(&mut self, program: Program, end: End) {
        self.motion += 1;
        let motion = MotionId(self.motion);
        self.state(RobotMode::Idle);
        self.arm(program);
        self.state(RobotMode::Idle);
        if matches!(end, End::Disarmed) {
            self.order(Order::Disarm { motion });
            return self.hear();
        }
        if matches!(end, End::Unwanted) {
            self.order(Order::Abandon { motion });
            for _ in 0..20 {
                assert!(!self.driver.is_watching(), "the robot may begin it");
                self.state(RobotMode::Idle);
            }
            return assert!(self.driver.is_watching());
        }
        for _ in 0..=RUNNING {
            self.state(RobotMode::Move);
        }
        // A program that arrives while another runs is returned.
        self.arm(Program::Active(ActiveControl));
        if let End::Abandoned = end {
            self.order(Order::Abandon { motion });
        }
        for _ in 0..10 {
            self.state(RobotMode::Move);
        }
        match end {
            End::LinkLost => {
                for tick in 1..10 {
                    let silence = LINK_TIMEOUT / 5 * tick;
                    self.calls += calls_during(|| self.driver.on_silence(silence));
                    self.hear();
                }
            }
            End::Reflex => self.state(RobotMode::Reflex),
            _ => self.state(RobotMode::Idle),
        }
        self.state(RobotMode::Idle);
        assert!(self.driver.is_watching(), "{end:?} ends it");
    }
}

fn calls_of_motions(reads_events: bool, cycles: u64) -> u64 {
    let mut counted = Counted::new(reads_events);
    while counted.time < cycles {
        for end in ENDS {
            for program in programs(end) {
                counted.motion(program, end);
            }
        }
    }
    let told = counted.told.iter().map(String::as_str);
    let expected: &[_] = if reads_events { &ALL_EVENTS } else { &[] };
    assert_eq!(told.collect::<Vec<_>>(), expected);
    counted.calls
}

#[test]
fn motions_that_end_in_every_way_allocate_and_free_nothing() {
    assert_eq!(calls_of_motions(true, 100_000), 0);
}

#[test]
fn motions_that_wait_for_others_allocate_and_free_nothing() {
    let mut counted = Counted::new(true);
    for comes in [true, false] {
        let [callback, target, _] = programs(End::Reflex);
        for program in [callback, target] {
            let [own, mut other] = StartBarrier::new().tickets();
            counted.motion += 1;
            counted.ticket = Some(own);
            counted.arm(program);
            for _ in 0..RUNNING {
                counted.state(RobotMode::Move);
                assert_eq!(counted.driver.record().activity, Activity::Waiting);
            }
            if comes {
                other.pass(0);
            }
            drop(other);
            for _ in 0..10 * RUNNING {
                counted.state(RobotMode::Move);
                assert_ne!(counted.driver.record().activity, Activity::Waiting);
            }
            counted.state(RobotMode::Idle);
            assert!(counted.driver.is_watching());
        }
    }
    assert_eq!(counted.calls, 0);
}

#[test]
fn motions_with_unread_events_allocate_and_free_nothing() {
    assert_eq!(calls_of_motions(false, 20_000), 0);
}
