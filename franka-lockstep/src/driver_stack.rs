//! The client's half of a connection, in virtual time: the driver, the command session and the
//! motion state machine.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::time::Duration;

use franka_model::Model;
use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message;
use franka_proto::{
    CommandId, MoveRequest, RecoveryStatus, Reply, Request, RobotState, SetterStatus, Version,
    Violation,
};
use franka_rt::driver::{Driver, MotionId, Program, Record};
use franka_rt::lifecycle::{CloseReason, Lifecycle, MotionError, NewMotion, Outcome, Output};
use franka_rt::session::{Chunk, GoalId, Waypoint};
use franka_rt::stats::{Arrival, CycleTimes};

/// The driver without its sockets and its clock: bytes and time go in, bytes come out.
pub struct DriverStack {
    /// The state machine that the control thread runs.
    pub driver: Driver,
    /// The motion state machine.
    pub lifecycle: Lifecycle,
    /// Record of the driver's last cycle.
    pub record: Record,
    /// The newest state that arrived.
    pub state: RobotState,
    /// Time from the previous state to the newest state, `[ms]` of the robot's clock.
    step: u64,
    /// Current time, counted from any fixed moment.
    pub now: Duration,
    /// Arrival time of the newest state.
    pub(crate) heard: Duration,
    /// Time between a state and its answer. The client can read the next state after this time.
    pub turnaround: Duration,
    /// True if the driver's events do not reach the lifecycle (the motion state machine), as if the
    /// task of the lifecycle did not run.
    pub lifecycle_is_paused: bool,
    /// Time at which the client answers the newest state.
    pub(super) free: Duration,
    session: Session,
    motions: HashMap<CommandId, MotionId>,
    to_robot: VecDeque<Vec<u8>>,
    from_robot: Vec<u8>,
    outcomes: BTreeMap<GoalId, Outcome>,
    /// Number of goals that have received an id so far.
    pub(super) goals: u64,
    /// Answers to recovery requests, the oldest first.
    pub(super) recoveries: VecDeque<RecoveryStatus>,
    /// The newest answer to a setting, until [`Supervised`](crate::Supervised) takes it.
    pub(super) setting: Option<SetterStatus>,
    /// True if the command connection has ended.
    closed: bool,
}

impl DriverStack {
    /// Returns a client that is not connected, for a robot with this model and protocol version.
    pub fn new(model: &Model, version: Version) -> Self {
        Self {
            driver: Driver::new(version),
            lifecycle: Lifecycle::new(model.clone().into(), version),
            record: Record::default(),
            state: RobotState::default(),
            step: 0,
            now: Duration::ZERO,
            heard: Duration::ZERO,
            turnaround: Duration::ZERO,
            lifecycle_is_paused: false,
            free: Duration::ZERO,
            session: Session::new(version),
            motions: HashMap::new(),
            to_robot: VecDeque::new(),
            from_robot: Vec::new(),
            outcomes: BTreeMap::new(),
            goals: 0,
            recoveries: VecDeque::new(),
            setting: None,
            closed: false,
        }
    }

    /// Replaces the number of cycles in the log of a motion.
    #[must_use]
    pub fn with_log_size(mut self, cycles: usize) -> Self {
        self.lifecycle = self.lifecycle.with_log_size(cycles);
        self
    }

    /// The protocol version of this client.
    pub fn version(&self) -> Version {
        self.session.version()
    }

    /// True if the handshake has succeeded.
    pub fn is_connected(&self) -> bool {
        self.session.is_connected()
    }

    /// Number of requests that wait for an answer.
    pub fn pending(&self) -> usize {
        self.session.pending()
    }

    /// Begins the handshake, which announces `udp_port` as the port for states.
    pub fn connect(&mut self, udp_port: u16) {
        let hello = self.session.connect(udp_port);
        self.to_robot.push_back(hello.as_bytes().to_vec());
    }

    /// Sends a request that is not a motion, and ignores its answer.
    ///
    /// # Panics
    /// Panics if the session refuses the request.
    pub fn request(&mut self, request: &Request) {
        let outgoing = self
            .session
            .request(request)
            .expect("the session accepts the request");
        self.to_robot.push_back(outgoing.as_bytes().to_vec());
    }

    /// Returns the next message for the robot.
    pub fn take_message(&mut self) -> Option<Vec<u8>> {
        self.to_robot.pop_front()
    }

    /// Processes bytes of the robot's stream, in pieces of any size. If a reply to a motion
    /// violates the protocol, this motion ends. Any other violation closes the connection, and the
    /// client ignores later bytes.
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
                Ok(Event::Reply {
                    reply: Reply::Recovery(status),
                    ..
                }) => self.recoveries.push_back(status),
                Ok(Event::Reply {
                    reply: Reply::Setter(status),
                    ..
                }) => self.setting = Some(status),
                Ok(_) => {}
                Err(violation) if violation.is_fatal() => {
                    return self.close(violated(&violation));
                }
                Err(violation) => self.on_violation(violation),
            }
        }
        self.from_robot = rest.to_vec();
    }

    /// Reports a protocol violation to the lifecycle if it is an unreadable reply to a motion.
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

    /// Performs the control thread's work between a state and its command. Decodes the datagram,
    /// and returns the size of the command that answers it, if any. This function is never inlined,
    /// because benchmarks count instructions by its name.
    ///
    /// # Panics
    /// Panics if the datagram is not a state.
    #[inline(never)]
    pub fn answer(&mut self, datagram: &[u8], command: &mut [u8]) -> Option<usize> {
        let version = self.session.version();
        let previous = self.state.message_id;
        self.state = RobotState::decode(version, datagram).expect("a state of this version");
        self.heard = self.now;
        self.step = self.state.message_id.saturating_sub(previous);
        let answer = self.driver.on_state(&self.state);
        answer.map(|answer| answer.encode(version, command).expect("it fits"))
    }

    /// Performs the control thread's work after [`Self::answer`]. In its records, states arrive
    /// when they are due, and answers take no time.
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

    /// Prepares the next state, as the control thread does before the state arrives. This function
    /// is never inlined, for the same reason as [`Self::answer`].
    #[inline(never)]
    pub fn prepare(&mut self) {
        self.driver.prepare();
        // Prevents a tail call, which would not be counted.
        core::hint::black_box(&self.step);
    }

    /// Passes the driver's events to the lifecycle, checks deadlines, and carries out the
    /// lifecycle's outputs. Returns true if there were outputs, because the driver may then have
    /// more events.
    pub fn settle(&mut self) -> bool {
        while !self.lifecycle_is_paused
            && let Some(event) = self.driver.take_event()
        {
            self.lifecycle.on_event(event, self.now);
        }
        let silence = self.now.saturating_sub(self.heard);
        let unseen = Lifecycle::unseen(silence, true);
        self.lifecycle.on_state(&self.state, self.now);
        self.lifecycle.on_time(self.now, unseen);
        self.carry_out()
    }

    /// Returns a new, unique goal id.
    pub fn next_goal(&mut self) -> GoalId {
        self.goals += 1;
        GoalId(self.goals)
    }

    /// Starts a motion that a program of the test controls.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`].
    pub fn control(
        &mut self,
        program: Program,
        request: MoveRequest,
    ) -> Result<GoalId, MotionError> {
        let id = self.next_goal();
        self.begin(NewMotion::Program {
            id,
            program,
            request: Box::new(request),
            ticket: None,
        })
    }

    /// Begins a motion and returns its goal id. If the goal is a pose, its path is planned first.
    ///
    /// # Errors
    /// Returns the errors of [`Goal::plan_line`] and of the lifecycle.
    ///
    /// [`Goal::plan_line`]: franka_rt::session::Goal::plan_line
    pub fn begin(&mut self, mut motion: NewMotion) -> Result<GoalId, MotionError> {
        let id = motion.id();
        if let NewMotion::Goal {
            goal, path: None, ..
        } = &mut motion
        {
            let q = self.reference_q();
            goal.plan_line(&q, &q, self.lifecycle.model(), &self.state)?;
        }
        let begun = self.lifecycle.begin(motion, &self.state, self.now);
        self.carry_out();
        begun.map(|()| id)
    }

    /// Begins a motion along `waypoints` to the last waypoint, and returns its goal id. If target
    /// control runs, the motion starts at its reference.
    ///
    /// # Errors
    /// Returns the errors of [`Chunk::through`] and [`Lifecycle::begin`].
    pub fn begin_along(
        &mut self,
        waypoints: &[Waypoint],
        mut motion: NewMotion,
    ) -> Result<GoalId, MotionError> {
        let NewMotion::Goal { goal, path, .. } = &mut motion else {
            panic!("a goal goes along a path");
        };
        let model = self.lifecycle.model();
        let chunk = Chunk::through(waypoints, &self.reference_q(), goal, model, &self.state)?;
        *path = Some(Box::new(chunk));
        self.begin(motion)
    }

    /// Joint positions of the reference if target control runs, otherwise of the arm, `[rad]`.
    fn reference_q(&self) -> [f64; 7] {
        if self.record.goal == GoalId::default().0 {
            self.state.q
        } else {
            self.record.q_ref
        }
    }

    /// Brakes the arm. Returns the id of the stop, or `None` if nothing moves.
    pub fn stop(&mut self) -> Option<GoalId> {
        let id = self.next_goal();
        let stopping = self.lifecycle.stop(id, &self.state, self.now);
        self.carry_out();
        stopping.then_some(id)
    }

    /// Cancels a goal or a program, like dropping its future.
    pub fn cancel(&mut self, id: GoalId) {
        self.lifecycle.cancel(id, self.now);
        self.carry_out();
    }

    /// Returns the newest motion and the request that began it.
    ///
    /// # Panics
    /// Panics if no motion has begun yet.
    pub fn newest_motion(&self) -> (CommandId, MotionId) {
        let newest = self.motions.iter().max_by_key(|(_, motion)| **motion);
        let (&id, &motion) = newest.expect("a motion has begun");
        (id, motion)
    }

    /// Simulates an unreadable reply to the newest motion.
    ///
    /// # Panics
    /// Panics if no motion has begun yet.
    pub fn violate(&mut self) {
        let (id, motion) = self.newest_motion();
        let violation = Violation::SecondMotionStarted { id };
        self.lifecycle
            .on_move_violation(motion, violation, self.now);
        self.carry_out();
    }

    /// Ends the command connection for this reason.
    pub fn close(&mut self, reason: CloseReason) {
        self.closed = true;
        self.lifecycle.on_connection_closed(reason);
        self.carry_out();
    }

    /// Number of goals and programs that have an outcome.
    pub fn resolved(&self) -> usize {
        self.outcomes.len()
    }

    /// The outcome of a goal or a program; `None` before the outcome.
    pub fn outcome(&self, id: GoalId) -> Option<&Outcome> {
        self.outcomes.get(&id)
    }

    /// Discards the pending replies of earlier motions, because the lifecycle runs one motion at a
    /// time.
    fn forget_motions(&mut self) {
        for (id, _) in self.motions.drain() {
            self.session.abandon(id);
        }
    }

    /// Carries out the lifecycle's outputs in their order. Returns true if there were any.
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
                        .expect("the session accepts the request");
                    if begins {
                        self.motions.insert(outgoing.id(), motion);
                    }
                    self.to_robot.push_back(outgoing.as_bytes().to_vec());
                }
                Output::Began { .. } => {}
                Output::Resolve { goal, result } => {
                    let twice = self.outcomes.insert(goal, result);
                    assert!(twice.is_none(), "goal {goal:?} is resolved twice");
                }
            }
        }
        any
    }
}

/// Returns the reason for closing the connection to a peer that has violated the protocol.
fn violated(violation: &impl ToString) -> CloseReason {
    CloseReason::Protocol {
        text: violation.to_string(),
    }
}
