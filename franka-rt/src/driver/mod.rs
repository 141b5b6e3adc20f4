//! State machine that returns the command for each robot state. The real-time thread runs it.
//!
//! Late states are answered like other states ([`stats`](crate::stats) defines lateness), but
//! `exchange` drops a state if a newer state has overtaken it. [`Driver::on_state`] counts lost
//! states. [`Driver::on_silence`] ends the motion of a silent robot.
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
//! If a motion is part of a common start of several robots (see [`together`](crate::together)), the
//! driver first holds the arm until all robots are ready. If one robot withdraws, the motion
//! finishes, and its program never runs.
//!
//! The diagram omits two phases. In `Silent`, the driver sends no command until the robot leaves
//! the motion's modes. A motion is in this phase if its program failed, if a command was not
//! finite, or if it was abandoned (`Order::Abandon`) and its program cannot brake. In `Unwanted`,
//! the motion was abandoned while it was armed. It ends when the states show that the robot did not
//! begin it.
//!
//! Inputs are [`Driver::on_order`], [`Driver::on_state`] and [`Driver::on_silence`]. Outputs are
//! the command that `on_state` returns, [`Driver::record`] and [`Driver::take_event`].
//! [`Driver::after_send`] and [`Driver::note_cycle`] do the work that can wait until the command
//! has left. [`Driver::prepare`] does the work that needs no new state. The driver has no clock and
//! no socket, and it neither allocates nor logs. The thread or a lockstep test supplies the time
//! and carries out the effects. When a program has ended, an [`Event`] passes it to the receiver,
//! which frees its memory.

mod aftermath;
mod columns;
mod commander;
mod event;
mod link_timeout;
mod log;
mod motion;
mod newest_reference;
mod observer;
mod order;
mod program;
mod record;
#[cfg(test)]
mod tests;

use core::time::Duration;

use franka_proto::{RobotCommand, RobotState, Version};

use crate::control::{Command, Failure, WriteError};
use crate::stats::MotionStatistics;
use crate::team::MemberFault;
use crate::together::Gate;

pub use columns::{Column, ColumnKind, ColumnSource};
pub use commander::Commander;
pub use event::{Ended, Ending, Event};
pub use link_timeout::{LINK_TIMEOUT, LinkTimeout, LinkTimeoutError};
pub use log::{ControlLog, LogEntry};
use newest_reference::ReferenceWriter;
pub use newest_reference::{ReferenceReader, ReferenceState};
pub use observer::Observer;
pub use order::{MotionId, Order};
pub use program::Program;
pub use record::{Activity, Record};

use event::EventQueue;
use motion::{Execution, Phase, UNWANTED_STATES};

/// State machine of one robot's control thread, without I/O.
#[derive(Debug)]
pub struct Driver {
    version: Version,
    /// The motion under way, and its phase; `None` while the driver watches.
    motion: Option<Execution>,
    /// `message_id` of the newest state; `None` before the first state.
    newest: Option<u64>,
    /// Length of the silence when the link was given up; `None` again after the next state.
    lost: Option<Duration>,
    link_timeout: LinkTimeout,
    /// Number of older states that were skipped in favour of the next state.
    skipped: u64,
    /// Counts of the current motion since it was armed.
    statistics: MotionStatistics,
    record: Record,
    references: ReferenceWriter,
    reference_reader: ReferenceReader,
    events: EventQueue,
}

impl Driver {
    /// Returns a driver that watches the states of a robot with protocol `version`.
    pub fn new(version: Version) -> Self {
        let (references, reference_reader) = ReferenceWriter::new();
        Self {
            version,
            motion: None,
            newest: None,
            lost: None,
            link_timeout: LinkTimeout::default(),
            skipped: 0,
            statistics: MotionStatistics::default(),
            record: Record::default(),
            references,
            reference_reader,
            events: EventQueue::default(),
        }
    }

    /// Replaces the time without states after which the link counts as lost. The default is
    /// [`LINK_TIMEOUT`].
    #[must_use]
    pub fn with_link_timeout(mut self, timeout: LinkTimeout) -> Self {
        self.link_timeout = timeout;
        self
    }

    /// Returns the time without states after which the link counts as lost.
    pub fn link_timeout(&self) -> LinkTimeout {
        self.link_timeout
    }

    /// True if no motion is armed, running or finishing.
    pub fn is_watching(&self) -> bool {
        self.motion.is_none()
    }

    /// Returns the record of the last cycle.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Returns a reader for the newest reference, for another thread.
    pub fn references(&self) -> ReferenceReader {
        self.reference_reader.clone()
    }

    /// Removes and returns the oldest event.
    pub fn take_event(&mut self) -> Option<Event> {
        self.events.pop()
    }

    /// Carries out an order. If an order does not fit the phase, the driver answers it with an
    /// event instead of ignoring it.
    pub fn on_order(&mut self, order: Order) {
        match order {
            Order::Arm {
                motion,
                modes,
                program,
                log,
                ticket,
                times,
                observer,
            } => {
                let armed = Execution {
                    id: motion,
                    modes,
                    program,
                    log,
                    ticket,
                    times,
                    observer,
                    sent: RobotCommand::default(),
                    phase: Phase::Armed,
                };
                let unseen = MotionStatistics::default();
                match (self.lost, self.is_watching()) {
                    (None, true) => {
                        self.statistics = unseen;
                        self.motion = Some(armed);
                    }
                    (None, false) => self.give_back(armed, Ending::Refused, unseen),
                    (Some(silence), _) => {
                        self.give_back(armed, Ending::LinkLost { silence }, unseen);
                    }
                }
            }
            // In other cases the motion has ended and has reported its end, or another motion is
            // under way.
            Order::Disarm { motion } => {
                let armed = |it: &mut Execution| it.id == motion && it.phase == Phase::Armed;
                if let Some(armed) = self.motion.take_if(armed) {
                    self.give_back(armed, Ending::Disarmed, self.statistics);
                }
            }
            Order::Abandon { motion } => {
                if let Some(abandoned) = self.motion.as_mut().filter(|it| it.id == motion) {
                    abandoned.abandon();
                }
            }
        }
    }

    /// Notes how many states were skipped because a newer state, the next one for
    /// [`Self::on_state`], had also arrived.
    pub fn on_skipped(&mut self, states: u64) {
        self.skipped = states;
    }

    /// Processes a new state and returns the command that answers it, if one is due.
    ///
    /// The work is bounded by one step of the program. A state that is not newer than the newest
    /// state is ignored, because the robot numbers its cycles in increasing order. If a value that
    /// the program needs is not finite, no command answers the state. The robot bridges such a gap;
    /// it stops on its own if more such states follow.
    pub fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        let missing = match self.newest {
            Some(newest) if state.message_id <= newest => return None,
            Some(newest) => state.message_id - newest - 1,
            None => 0,
        };
        let skipped = core::mem::take(&mut self.skipped).min(missing);
        self.newest = Some(state.message_id);
        self.lost = None;
        self.record = Record::watching(state, missing);
        if self.statistics().is_some() {
            self.statistics
                .note_state(state, missing - skipped, skipped);
        }
        let motion = self.motion.as_mut()?;
        match motion.phase {
            Phase::Armed if motion.modes.shown_by(state) && motion.program.can_read(state) => {
                self.events.push(Event::Started {
                    motion: motion.id,
                    time: state.message_id,
                });
                // Do not count states that were lost before the motion's first state.
                self.statistics.note_state(state, 0, 0);
                self.run(state)
            }
            Phase::Armed => {
                self.record.activity = Activity::Armed;
                None
            }
            Phase::Unwanted(quiet) => {
                let quiet = if motion.is_left_by(state) {
                    quiet + 1
                } else {
                    0
                };
                if quiet == UNWANTED_STATES {
                    return self.end_at(state, Ending::Disarmed);
                }
                self.record.activity = Activity::Silent;
                motion.phase = Phase::Unwanted(quiet);
                None
            }
            Phase::Running => {
                if motion.is_left_by(state) {
                    self.end_at(state, Ending::Aborted)
                } else if motion.program.can_read(state) {
                    self.run(state)
                } else {
                    self.record.activity = Activity::Running;
                    None
                }
            }
            Phase::Finishing => {
                if motion.is_left_by(state) {
                    return self.end_at(state, Ending::Finished);
                }
                motion.sent.message_id = state.message_id;
                self.record.activity = Activity::Finishing;
                self.record.tau_c = motion.sent.tau_J_d;
                Some(motion.sent)
            }
            Phase::Silent => {
                if motion.is_left_by(state) {
                    return self.end_at(state, Ending::Aborted);
                }
                self.record.activity = Activity::Silent;
                None
            }
        }
    }

    /// Returns the datagram that answers the newest state with `command`, in a motion under
    /// [`Program::Active`]. Send it at once. Set `finished` for the last command: the driver then
    /// repeats this command for every state until the robot has left the motion's modes.
    ///
    /// # Errors
    /// Returns [`WriteError`] if the motion refuses the command. In this case, send nothing; the
    /// motion continues.
    pub fn write(&mut self, command: &Command, finished: bool) -> Result<RobotCommand, WriteError> {
        let (Some(motion), Some(newest)) = (self.motion.as_mut(), self.newest) else {
            return Err(WriteError::NotRunning);
        };
        let (Program::Active(active), Phase::Running) = (&motion.program, motion.phase) else {
            return Err(WriteError::NotRunning);
        };
        active.check(command, motion.modes, finished)?;
        let sent = command.datagram(newest, finished)?;
        motion.sent = sent;
        motion.log.note_command(&sent);
        self.record.tau_c = sent.tau_J_d;
        if finished {
            self.events.push(Event::Finishing { motion: motion.id });
            motion.phase = Phase::Finishing;
        }
        Ok(sent)
    }

    /// Notes that no state has arrived for `silence`. If this is longer than the robot's team
    /// tolerates (by default [`team::SILENCE`](crate::team::SILENCE)), the other robots of the team
    /// brake. After the link timeout, the motion ends with [`Ending::LinkLost`].
    pub fn on_silence(&mut self, silence: Duration) {
        if let Some(begun) = self.motion.as_mut().filter(|motion| motion.has_begun()) {
            begun.program.on_silence(silence);
        }
        if silence < self.link_timeout.get() || self.lost.is_some() {
            return;
        }
        self.lost = Some(silence);
        self.end(Ending::LinkLost { silence });
        self.events.push(Event::LinkLost { silence });
    }

    /// Answers a state with the program of the motion under way.
    fn run(&mut self, state: &RobotState) -> Option<RobotCommand> {
        let motion = self.motion.as_mut()?;
        let gate = motion.gate(state);
        let mut event = None;
        let outcome = motion
            .program
            .step(gate, self.version, state, &mut self.record, &mut event);
        if let Some(event) = event {
            self.events.push(Event::Program {
                motion: motion.id,
                event,
                statistics: self.statistics,
            });
        }
        (motion.phase, self.record.activity) = (Phase::Running, Activity::Running);
        match outcome {
            Ok(Some((command, finished))) => {
                match command.datagram(state.message_id, finished) {
                    Ok(sent) => motion.sent = sent,
                    Err(invalid) => return self.fail(Failure::Invalid(invalid)),
                }
                self.record.tau_c = motion.sent.tau_J_d;
                if finished {
                    (motion.phase, self.record.activity) = (Phase::Finishing, Activity::Finishing);
                    self.events.push(Event::Finishing { motion: motion.id });
                } else if matches!(gate, Gate::Closed) {
                    self.record.activity = Activity::Waiting;
                }
                Some(motion.sent)
            }
            Ok(None) => None,
            Err(failure) => self.fail(failure),
        }
    }

    /// Stops sending commands to the motion, because its program cannot continue.
    fn fail(&mut self, failure: Failure) -> Option<RobotCommand> {
        let motion = self.motion.as_mut()?;
        motion.program.fail_team(MemberFault::Failed);
        (motion.phase, self.record.activity) = (Phase::Silent, Activity::Silent);
        self.events.push(Event::Failed {
            motion: motion.id,
            failure,
        });
        None
    }

    /// Ends the motion with the state that shows the end. This state needs no answer, so the log
    /// notes it at once.
    fn end_at(&mut self, state: &RobotState, ending: Ending) -> Option<RobotCommand> {
        self.motion.as_mut()?.log.note_state(state);
        self.end(ending);
        None
    }

    /// Ends the motion, if one is under way.
    fn end(&mut self, ending: Ending) {
        if let Some(motion) = self.motion.take() {
            self.give_back(motion, ending, self.statistics);
        }
    }

    fn give_back(&mut self, mut motion: Execution, ending: Ending, statistics: MotionStatistics) {
        motion.leave();
        motion.tell_team(ending);
        let Execution {
            id,
            program,
            log,
            ticket,
            times,
            observer,
            ..
        } = motion;
        self.events.push(Event::Ended(Ended {
            motion: id,
            ending,
            robot_mode: self.record.robot_mode,
            errors: self.record.errors,
            reflex_reason: self.record.reflex_reason,
            statistics,
            times,
            program,
            log,
            ticket,
            observer,
        }));
    }
}
