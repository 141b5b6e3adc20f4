//! What one robot state calls for: the core that the real-time thread drives.
//!
//! ```text
//!              Order::Arm            first state in the motion's modes
//!  Watching ---------------> Armed ------------------------------------> Running
//!     ^                        |                                            |
//!     |      Order::Disarm     |                     the program finishes   v
//!     +------------------------+                                        Finishing
//!     +---------------------------------------------------------------------+
//!              the state leaves the motion's modes, or the link falls silent
//! ```
//!
//! Inputs are [`Driver::on_order`], [`Driver::on_state`] and [`Driver::on_silence`]; outputs are the command that
//! `on_state` returns, [`Driver::record`] and [`Driver::take_event`]. No clock, socket, allocation or log: the thread,
//! and the lockstep tests, supply time and carry the effects out. A program that has ended leaves inside an [`Event`],
//! so that its memory is freed elsewhere.

mod event;
mod order;
mod record;
#[cfg(test)]
mod tests;

use core::time::Duration;

use franka_proto::{RobotCommand, RobotMode, RobotState, Version};

pub use event::{Ended, Ending, Event, MotionStatistics};
pub(crate) use order::{Command, Step};
pub use order::{Modes, MotionId, Order, Program};
pub use record::{Activity, Record};

use event::EventQueue;

/// Silence of the robot after which the link counts as lost.
///
/// Source: the UDP receive timeout of libfranka, `network.h`.
pub const LINK_TIMEOUT: Duration = Duration::from_secs(1);

/// The pure core of one robot's control thread.
#[derive(Debug)]
pub struct Driver {
    version: Version,
    phase: Phase,
    /// `message_id` of the newest state, once there was one.
    newest: Option<u64>,
    /// The silence at which the link was given up, until a state revives it.
    lost: Option<Duration>,
    link_timeout: Duration,
    record: Record,
    events: EventQueue,
}

#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per driver, and a box would allocate on the thread"
)]
enum Phase {
    Watching,
    Armed(Motion),
    Running(Motion),
    /// The finishing command is repeated until the robot leaves the motion's modes.
    Finishing(Motion, RobotCommand),
}

/// What a motion owns from arming to its end.
#[derive(Debug)]
struct Motion {
    id: MotionId,
    modes: Modes,
    program: Program,
    statistics: MotionStatistics,
}

impl Driver {
    /// A driver that watches the states of a robot speaking `version`.
    pub fn new(version: Version) -> Self {
        Self {
            version,
            phase: Phase::Watching,
            newest: None,
            lost: None,
            link_timeout: LINK_TIMEOUT,
            record: Record::default(),
            events: EventQueue::default(),
        }
    }

    /// Replaces the silence after which the link counts as lost, [`LINK_TIMEOUT`] by default.
    #[must_use]
    pub fn with_link_timeout(mut self, timeout: Duration) -> Self {
        self.link_timeout = timeout;
        self
    }

    /// Whether no motion is armed, running or finishing.
    pub fn is_watching(&self) -> bool {
        matches!(self.phase, Phase::Watching)
    }

    /// What the last cycle saw and did.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The next thing that the world outside has to hear, oldest first.
    pub fn take_event(&mut self) -> Option<Event> {
        self.events.pop()
    }

    /// Tells how long the command of this cycle took to leave, from the receipt of its state.
    pub fn note_turnaround(&mut self, turnaround: Duration) {
        self.record.turnaround = turnaround;
        if let Phase::Running(motion) | Phase::Finishing(motion, _) = &mut self.phase {
            motion.statistics.worst_turnaround = motion.statistics.worst_turnaround.max(turnaround);
        }
    }

    /// Takes an order. One that does not fit the phase is answered with an event, never ignored.
    pub fn on_order(&mut self, order: Order) {
        match order {
            Order::Arm {
                motion,
                modes,
                program,
            } => {
                let armed = Motion {
                    id: motion,
                    modes,
                    program,
                    statistics: MotionStatistics::default(),
                };
                match (self.lost, self.is_watching()) {
                    (None, true) => self.phase = Phase::Armed(armed),
                    (None, false) => self.give_back(armed, Ending::Refused),
                    (Some(silence), _) => self.give_back(armed, Ending::LinkLost { silence }),
                }
            }
            Order::Disarm { motion } => {
                match core::mem::replace(&mut self.phase, Phase::Watching) {
                    Phase::Armed(armed) if armed.id == motion => self.end(armed, Ending::Disarmed),
                    // The motion has ended by itself, and has said so; or another one is under way.
                    other => self.phase = other,
                }
            }
        }
    }

    /// Takes a newly received state and returns the command that answers it, if one is due.
    ///
    /// Bounded work: at most one step of the program. A state that is not newer than the newest so far is ignored,
    /// as the robot numbers its cycles strictly upwards. A motion does not answer a state whose joint positions,
    /// velocities or torques are not finite: the robot bridges the gap, or stops by itself if more of them follow.
    pub fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        let skipped = match self.newest {
            Some(newest) if state.message_id <= newest => return None,
            Some(newest) => state.message_id - newest - 1,
            None => 0,
        };
        self.newest = Some(state.message_id);
        self.lost = None;
        self.record = Record::watching(state, skipped);
        match core::mem::replace(&mut self.phase, Phase::Watching) {
            Phase::Watching => None,
            Phase::Armed(motion) if motion.modes.shown_by(state) && is_sound(state) => {
                self.events.push(Event::Started {
                    motion: motion.id,
                    time: state.message_id,
                });
                self.run(motion, state)
            }
            Phase::Armed(motion) => {
                self.record.activity = Activity::Armed;
                self.phase = Phase::Armed(motion);
                None
            }
            Phase::Running(mut motion) if has_left(&motion, state) => {
                motion.statistics.note(state, skipped);
                self.end(motion, Ending::Aborted);
                None
            }
            Phase::Finishing(mut motion, _) if has_left(&motion, state) => {
                motion.statistics.note(state, skipped);
                self.end(motion, Ending::Finished);
                None
            }
            Phase::Running(mut motion) if !is_sound(state) => {
                motion.statistics.note(state, skipped);
                self.record.activity = Activity::Running;
                self.phase = Phase::Running(motion);
                None
            }
            Phase::Running(mut motion) => {
                motion.statistics.note(state, skipped);
                self.run(motion, state)
            }
            Phase::Finishing(mut motion, mut command) => {
                motion.statistics.note(state, skipped);
                command.message_id = state.message_id;
                self.record.activity = Activity::Finishing;
                self.record.tau_c = command.tau_J_d;
                self.phase = Phase::Finishing(motion, command);
                Some(command)
            }
        }
    }

    /// Tells that no state has come for `silence`. At the link timeout a motion ends with [`Ending::LinkLost`].
    pub fn on_silence(&mut self, silence: Duration) {
        if silence < self.link_timeout || self.lost.is_some() {
            return;
        }
        self.lost = Some(silence);
        match core::mem::replace(&mut self.phase, Phase::Watching) {
            Phase::Watching => {}
            Phase::Armed(motion) | Phase::Running(motion) | Phase::Finishing(motion, _) => {
                self.end(motion, Ending::LinkLost { silence });
            }
        }
        self.events.push(Event::LinkLost { silence });
    }

    fn run(&mut self, mut motion: Motion, state: &RobotState) -> Option<RobotCommand> {
        let step = motion.program.step(state, &mut self.record);
        let command = step
            .command
            .on_wire(self.version, state.message_id, step.finished);
        self.record.tau_c = command.tau_J_d;
        if let Some(event) = step.event {
            self.events.push(Event::Program {
                motion: motion.id,
                event,
                statistics: motion.statistics,
            });
        }
        self.phase = if step.finished {
            self.record.activity = Activity::Finishing;
            self.events.push(Event::Finishing { motion: motion.id });
            Phase::Finishing(motion, command)
        } else {
            self.record.activity = Activity::Running;
            Phase::Running(motion)
        };
        Some(command)
    }

    fn end(&mut self, motion: Motion, ending: Ending) {
        self.phase = Phase::Watching;
        self.give_back(motion, ending);
    }

    fn give_back(&mut self, motion: Motion, ending: Ending) {
        let Motion {
            id,
            program,
            statistics,
            ..
        } = motion;
        self.events.push(Event::Ended(Ended {
            motion: id,
            ending,
            robot_mode: self.record.robot_mode,
            errors: self.record.errors,
            reflex_reason: self.record.reflex_reason,
            statistics,
            program,
        }));
    }
}

/// Whether the robot no longer runs the motion.
fn has_left(motion: &Motion, state: &RobotState) -> bool {
    !motion.modes.shown_by(state) || state.robot_mode != RobotMode::Move
}

/// Whether what every program computes with is finite. Anything a program made of other numbers would go to the motors.
fn is_sound(state: &RobotState) -> bool {
    let numbers = state.q.iter().chain(&state.dq).chain(&state.tau_J_d);
    numbers.copied().all(f64::is_finite)
}
