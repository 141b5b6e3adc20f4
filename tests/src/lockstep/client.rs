//! The client's half of a connection: driver, command session and motion state machine, on virtual
//! time.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::time::Duration;

use franka_model::Model;
use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message;
use franka_proto::{CommandId, MoveRequest, Reply, Request, RobotState, Version, Violation};
use franka_rt::driver::{Driver, MotionId, Program, Record};
use franka_rt::lifecycle::{CloseReason, Lifecycle, MotionError, Output};
use franka_rt::session::GoalId;
use franka_rt::stats::{Arrival, CycleTimes};

use super::Outcome;

/// All of the driver but its sockets and its clock: bytes and time go in, bytes come out.
pub struct Client {
    /// The pure core of the control thread.
    pub driver: Driver,
    /// The motion state machine.
    pub lifecycle: Lifecycle,
    /// What the driver did in its last cycle.
    pub record: Record,
    /// The newest state that arrived.
    pub state: RobotState,
    /// From the state before it to that one, `[ms]` of the robot's clock.
    step: u64,
    /// The time, from any fixed moment.
    pub now: Duration,
    /// How long it takes from a state to its answer, and to being ready for the next state.
    pub turnaround: Duration,
    /// Whether the lifecycle hears nothing of the driver for now, as if its task did not get to
    /// run.
    pub is_deaf: bool,
    /// When it has answered the newest state.
    pub(super) free: Duration,
    session: Session,
    motions: HashMap<CommandId, MotionId>,
    to_robot: VecDeque<Vec<u8>>,
    from_robot: Vec<u8>,
    outcomes: BTreeMap<GoalId, Outcome>,
    goals: u64,
    /// Whether the command connection has ended.
    closed: bool,
}

impl Client {
    /// A client that has not connected, for a robot of this model that speaks `version`.
    pub fn new(model: &Model, version: Version) -> Self {
        Self {
            driver: Driver::new(version),
            lifecycle: Lifecycle::new(model.clone().into(), version),
            record: Record::default(),
            state: RobotState::default(),
            step: 0,
            now: Duration::ZERO,
            turnaround: Duration::ZERO,
            is_deaf: false,
            free: Duration::ZERO,
            session: Session::new(version),
            motions: HashMap::new(),
            to_robot: VecDeque::new(),
            from_robot: Vec::new(),
            outcomes: BTreeMap::new(),
            goals: 0,
            closed: false,
        }
    }

    /// Replaces the number of cycles that the log of a motion holds.
    #[must_use]
    pub fn with_log_size(mut self, cycles: usize) -> Self {
        self.lifecycle = self.lifecycle.with_log_size(cycles);
        self
    }

    /// The version that it speaks.
    pub fn version(&self) -> Version {
        self.session.version()
    }

    /// Whether the handshake is done.
    pub fn is_connected(&self) -> bool {
        self.session.is_connected()
    }

    /// Requests whose answers have not all come.
    pub fn pending(&self) -> usize {
        self.session.pending()
    }

    /// Begins the handshake; states are expected at `udp_port`.
    pub fn connect(&mut self, udp_port: u16) {
        let hello = self.session.connect(udp_port);
        self.to_robot.push_back(hello.as_bytes().to_vec());
    }

    /// Sends a request that is not a motion; what the answer says is not kept.
    ///
    /// # Panics
    /// If the session refuses it.
    pub fn request(&mut self, request: &Request) {
        let outgoing = self.session.request(request).expect("the session takes it");
        self.to_robot.push_back(outgoing.as_bytes().to_vec());
    }

    /// The next message for the robot.
    pub fn take_message(&mut self) -> Option<Vec<u8>> {
        self.to_robot.pop_front()
    }

    /// Takes bytes of the robot's stream, cut anywhere. What leaves the protocol ends the motion
    /// that it answers, or else the connection, after which nothing is taken any more.
    pub fn on_bytes(&mut self, bytes: &[u8]) {
        let mut received = std::mem::take(&mut self.from_robot);
        received.extend_from_slice(bytes);
        let mut rest = &received[..];
        while !self.closed {
            let message = match next_message(rest) {
                Ok(Some(message)) => message,
                Ok(None) => break,
                Err(error) => return self.close(violated(&error)),
            };
            rest = &rest[message.header.size as usize..];
            match self.session.on_message(message) {
                Ok(Event::Reply {
                    id,
                    reply: Reply::Move(status),
                    ..
                }) => {
                    let motion = self.motions[&id];
                    self.lifecycle.on_move_reply(motion, status, self.now);
                }
                Ok(_) => {}
                Err(violation) if violation.is_fatal() => {
                    return self.close(violated(&violation));
                }
                Err(violation) => self.on_violation(violation),
            }
        }
        self.from_robot = rest.to_vec();
    }

    /// Tells the lifecycle, if it is a motion's reply that cannot be read.
    fn on_violation(&mut self, violation: Violation) {
        let (Violation::Reply { id, .. } | Violation::SecondMotionStarted { id }) = &violation
        else {
            return;
        };
        if let Some(&motion) = self.motions.get(id) {
            self.lifecycle
                .on_move_violation(motion, violation, self.now);
        }
    }

    /// What the control thread does between a state and its command: takes the datagram, and
    /// returns the size of the command that answers it, if one does.
    ///
    /// A function of its own in every profile: instructions are counted by its name.
    ///
    /// # Panics
    /// If the datagram is no state.
    #[inline(never)]
    pub fn answer(&mut self, datagram: &[u8], command: &mut [u8]) -> Option<usize> {
        let version = self.session.version();
        let previous = self.state.message_id;
        self.state = RobotState::decode(version, datagram).expect("a state of this version");
        self.step = self.state.message_id.saturating_sub(previous);
        let answer = self.driver.on_state(&self.state);
        answer.map(|answer| answer.encode(version, command).expect("it fits"))
    }

    /// What the control thread does after that: in a world where states come when they are due, and
    /// answers take no time.
    pub fn conclude(&mut self, answered: bool) {
        let state = &self.state;
        let arrival = Arrival {
            interval: Some(Duration::from_millis(self.step)),
            late: Duration::ZERO,
        };
        let sent = CycleTimes::new(state.message_id, arrival.late, Duration::ZERO);
        let sent = answered.then_some(&sent);
        self.driver.after_send(state, &arrival, sent);
        self.record = *self.driver.record();
        if let Some(sent) = sent {
            self.driver.note_cycle(sent);
        }
    }

    /// Passes on what the driver has to tell, watches deadlines, and carries out what follows from
    /// both. Returns whether anything did: the driver may have more to tell then.
    pub fn settle(&mut self) -> bool {
        while !self.is_deaf
            && let Some(event) = self.driver.take_event()
        {
            self.lifecycle.on_event(event, self.now);
        }
        self.lifecycle.on_time(self.now);
        self.carry_out()
    }

    /// A name for a goal that no other has.
    pub fn next_goal(&mut self) -> GoalId {
        self.goals += 1;
        GoalId(self.goals)
    }

    /// Starts a motion under a program of the test's own.
    ///
    /// # Errors
    /// As the lifecycle.
    pub fn control(
        &mut self,
        program: Program,
        request: MoveRequest,
    ) -> Result<GoalId, MotionError> {
        let id = self.next_goal();
        let begun = self.lifecycle.control(id, program, request, self.now);
        self.carry_out();
        begun.map(|()| id)
    }

    /// Brakes; `None` if nothing moves.
    pub fn stop(&mut self) -> Option<GoalId> {
        let id = self.next_goal();
        let stopping = self.lifecycle.stop(id, self.now);
        self.carry_out();
        stopping.then_some(id)
    }

    /// Takes work back, as dropping its future does.
    pub fn cancel(&mut self, id: GoalId) {
        self.lifecycle.cancel(id, self.now);
        self.carry_out();
    }

    /// The newest motion, and the request that began it.
    ///
    /// # Panics
    /// If there was no motion yet.
    pub fn newest_motion(&self) -> (CommandId, MotionId) {
        let newest = self.motions.iter().max_by_key(|(_, motion)| **motion);
        let (&id, &motion) = newest.expect("a motion has begun");
        (id, motion)
    }

    /// Has the newest motion's command connection bring a reply that cannot be read.
    ///
    /// # Panics
    /// If there was no motion yet.
    pub fn violate(&mut self) {
        let (id, motion) = self.newest_motion();
        let violation = Violation::SecondMotionStarted { id };
        self.lifecycle
            .on_move_violation(motion, violation, self.now);
        self.carry_out();
    }

    /// The command connection has ended.
    pub fn close(&mut self, reason: CloseReason) {
        self.closed = true;
        self.lifecycle.on_connection_closed(reason);
        self.carry_out();
    }

    /// Goals and programs that have been resolved so far.
    pub fn resolved(&self) -> usize {
        self.outcomes.len()
    }

    /// How a goal or a program turned out, if it has.
    pub fn outcome(&self, id: GoalId) -> Option<&Outcome> {
        self.outcomes.get(&id)
    }

    /// Gives up waiting for replies to the motions so far: the lifecycle begins one after the
    /// other.
    fn forget_motions(&mut self) {
        for (id, _) in self.motions.drain() {
            self.session.abandon(id);
        }
    }

    /// Carries out what the lifecycle has decided, in its order. Returns whether that was anything.
    pub(super) fn carry_out(&mut self) -> bool {
        let mut any = false;
        while let Some(output) = self.lifecycle.poll() {
            any = true;
            match output {
                Output::Order(order) => self.driver.on_order(order),
                Output::Send { motion, request } => {
                    let begins = matches!(request, Request::Move(_));
                    if begins {
                        self.forget_motions();
                    }
                    let outgoing = self
                        .session
                        .request(&request)
                        .expect("the session takes it");
                    if begins {
                        self.motions.insert(outgoing.id(), motion);
                    }
                    self.to_robot.push_back(outgoing.as_bytes().to_vec());
                }
                Output::Began { .. } => {}
                Output::Resolve { goal, result } => {
                    let twice = self.outcomes.insert(goal, result);
                    assert!(twice.is_none(), "goal {goal:?} is resolved once");
                }
            }
        }
        any
    }
}

/// A peer that has left the protocol for good.
fn violated(violation: &impl ToString) -> CloseReason {
    CloseReason::Protocol {
        text: violation.to_string(),
    }
}
