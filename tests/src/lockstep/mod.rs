//! Driver, command session and simulated robot in one thread on virtual time: exact, instant, replayable.
//!
//! ```text
//!   Lifecycle --requests--> client::Session ~~bytes~~> Robot (simulated)
//!       ^  |                      |                      |
//!       |  +--orders--> Driver <~~~~~~~datagrams~~~~~~~~~+
//!       +------events------+ ~~~~~~~~~commands~~~~~~~~~~~^
//! ```
//!
//! Everything that crosses `~~` is encoded to the wire and decoded again, and passes a [`Link`] that loses what its seed
//! says. One call of [`Lockstep::tick`] is one millisecond. Whatever a test does, every command that leaves the driver is
//! held against the robot's limits.

mod guard;
mod link;
mod wander;

use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::time::Duration;

use franka_model::{EndEffector, Frame, JointVector, Model, RobotKind, transform};
use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message;
use franka_proto::{CommandId, Reply, Request, RobotCommand, RobotState, Version, Violation};
use franka_rt::driver::{Driver, MotionId, Record};
use franka_rt::law::Gains;
use franka_rt::lifecycle::{Lifecycle, MotionError, MotionReport, Output};
use franka_rt::session::{Budget, Goal, GoalError, GoalId, Target, Then, Tolerance};
use franka_sim::{Config, Robot};
use nalgebra::Isometry3;

pub use link::Link;
pub use wander::Wander;

use guard::CommandGuard;

/// How a goal turned out.
pub type Outcome = Result<MotionReport, MotionError>;

/// The whole system, one millisecond at a time.
pub struct Lockstep {
    /// The simulated robot, for pushing and tripping.
    pub robot: Robot,
    /// The network between.
    pub link: Link,
    /// The pure core of the control thread.
    pub driver: Driver,
    /// The motion state machine.
    pub lifecycle: Lifecycle,
    /// What the driver did in the last millisecond.
    pub record: Record,
    /// The newest state that reached the client.
    pub state: RobotState,
    model: &'static Model,
    session: Session,
    motions: HashMap<CommandId, MotionId>,
    to_robot: VecDeque<Vec<u8>>,
    from_robot: Vec<u8>,
    outcomes: BTreeMap<GoalId, Outcome>,
    guard: CommandGuard,
    /// Goals whose way is planned over the joints.
    joint_goals: HashSet<GoalId>,
    goals: u64,
    milliseconds: u64,
    heard: u64,
}

impl Lockstep {
    /// A robot as configured, connected over a perfect link.
    ///
    /// # Panics
    /// If the handshake fails or no state comes.
    pub fn new(config: Config) -> Self {
        let model = Model::of(config.kind);
        let robot = Robot::new(config);
        let version = robot.version();
        let mut this = Self {
            robot,
            link: Link::perfect(),
            driver: Driver::new(version),
            lifecycle: Lifecycle::new(model, version),
            record: Record::default(),
            state: RobotState::default(),
            model,
            session: Session::new(version),
            motions: HashMap::new(),
            to_robot: VecDeque::new(),
            from_robot: Vec::new(),
            outcomes: BTreeMap::new(),
            guard: CommandGuard::new(model.joint_limits()),
            joint_goals: HashSet::new(),
            goals: 0,
            milliseconds: 0,
            heard: 0,
        };
        assert!(this.robot.connect(), "a fresh robot takes a client");
        let hello = this.session.connect(40_000);
        this.to_robot.push_back(hello.as_bytes().to_vec());
        this.run(5);
        assert!(this.session.is_connected(), "the handshake is done");
        assert!(this.state.message_id > 0, "states come");
        this
    }

    /// A Franka Research 3 in the ready pose with its hand, strict about limits.
    pub fn ready() -> Self {
        Self::ready_of(RobotKind::Fr3)
    }

    /// A robot of this kind in the ready pose with its hand, strict about limits.
    pub fn ready_of(kind: RobotKind) -> Self {
        Self::new(Config {
            kind,
            tool: franka_sim::Tool::hand(),
            ..Config::default()
        })
    }

    /// Time since the beginning, `[ms]`.
    pub fn now(&self) -> u64 {
        self.milliseconds
    }

    /// One millisecond of everything.
    ///
    /// # Panics
    /// If a command violates a limit of the robot, or the client's session meets a message it cannot read.
    pub fn tick(&mut self) {
        self.tick_around(|cycle| cycle());
    }

    /// Like [`Self::tick`], with the control cycle, datagram in to datagram out, run by `around`: to time it, or to count
    /// what it allocates.
    ///
    /// # Panics
    /// See [`Self::tick`]; and if `around` does not run the cycle.
    pub fn tick_around(&mut self, mut around: impl FnMut(&mut dyn FnMut())) {
        self.milliseconds += 1;
        while let Some(bytes) = self.to_robot.pop_front() {
            self.robot
                .receive(&bytes)
                .expect("the client's messages are well-formed");
        }
        let state = self.robot.tick().map(|datagram| datagram.bytes.to_vec());
        while let Some(reply) = self.robot.take_reply() {
            self.from_robot.extend_from_slice(&reply);
        }
        match state.filter(|_| self.link.passes_state()) {
            Some(datagram) => {
                self.heard = self.milliseconds;
                let version = self.session.version();
                let mut answer = None;
                let mut command = [0; RobotCommand::MAX_SIZE];
                around(&mut || {
                    answer = Some(cycle(&mut self.driver, version, &datagram, &mut command))
                });
                let (state, size) = answer.expect("the cycle has run");
                self.state = state;
                self.record = *self.driver.record();
                if let Some(size) = size {
                    let command = &command[..size];
                    let decoded =
                        RobotCommand::decode(version, command).expect("a command of this version");
                    let over_joints = self.joint_goals.contains(&GoalId(self.record.goal));
                    self.guard
                        .check(&decoded, &state, &self.record, over_joints);
                    if self.link.passes_command() {
                        self.robot.command(command);
                    }
                }
            }
            None => self
                .driver
                .on_silence(Duration::from_millis(self.milliseconds - self.heard)),
        }
        self.take_replies();
        while let Some(event) = self.driver.take_event() {
            self.lifecycle.on_event(event, self.time());
        }
        self.lifecycle.on_time(self.time());
        self.carry_out();
    }

    /// So many milliseconds.
    pub fn run(&mut self, milliseconds: u64) {
        for _ in 0..milliseconds {
            self.tick();
        }
    }

    /// A goal with the defaults of the async face: see `franka_async::Motion`.
    pub fn goal(&mut self, target: Target, then: Then) -> Goal {
        self.goals += 1;
        Goal {
            id: GoalId(self.goals),
            target,
            then,
            budget: Budget::of(self.model.joint_limits()),
            gains: match target {
                Target::Joints(_) => Gains::joint(),
                Target::Pose(_) | Target::Rest => Gains::cartesian(),
            },
            tolerance: Tolerance::default(),
        }
    }

    /// Submits a goal.
    ///
    /// # Errors
    /// As the lifecycle.
    pub fn submit(&mut self, goal: Goal) -> Result<GoalId, MotionError> {
        let state = self.state;
        if !matches!(goal.target, Target::Pose(_)) {
            self.joint_goals.insert(goal.id);
        }
        let submitted = self.lifecycle.submit(goal, &state, self.time());
        self.carry_out();
        submitted.map(|()| goal.id)
    }

    /// Submits a motion that ends at `target`.
    ///
    /// # Panics
    /// If the goal is not accepted.
    pub fn begin(&mut self, target: Target) -> GoalId {
        let goal = self.goal(target, Then::Finish);
        self.submit(goal).expect("the goal is accepted")
    }

    /// Brakes; `None` if nothing moves.
    pub fn stop(&mut self) -> Option<GoalId> {
        self.goals += 1;
        let id = GoalId(self.goals);
        self.joint_goals.insert(id);
        let stopping = self.lifecycle.stop(id, self.time());
        self.carry_out();
        stopping.then_some(id)
    }

    /// Takes a goal back, as dropping its future does.
    pub fn cancel(&mut self, goal: GoalId) {
        self.joint_goals.insert(goal);
        self.lifecycle.cancel(goal);
        self.carry_out();
    }

    /// Moves the target of a goal that is held; returns whether it still is.
    ///
    /// # Errors
    /// As the lifecycle.
    pub fn update(&mut self, goal: GoalId, target: Target) -> Result<bool, GoalError> {
        if matches!(target, Target::Pose(_)) {
            self.joint_goals.remove(&goal);
        }
        let state = self.state;
        self.lifecycle.update(goal, target, &state)
    }

    /// Has the newest motion's command connection bring a reply that cannot be read.
    ///
    /// # Panics
    /// If there was no motion yet.
    pub fn violate(&mut self) {
        let (&id, &motion) = self
            .motions
            .iter()
            .max_by_key(|(_, motion)| **motion)
            .expect("a motion has begun");
        let violation = Violation::SecondMotionStarted { id };
        self.lifecycle
            .on_move_violation(motion, violation, self.time());
        self.carry_out();
    }

    /// Goals that have been resolved so far.
    pub fn resolved(&self) -> usize {
        self.outcomes.len()
    }

    /// How a goal turned out, if it has.
    pub fn outcome(&self, goal: GoalId) -> Option<&Outcome> {
        self.outcomes.get(&goal)
    }

    /// Runs until the goal is resolved.
    ///
    /// # Panics
    /// If that takes longer than `most` milliseconds.
    pub fn until_resolved(&mut self, goal: GoalId, most: u64) -> Outcome {
        for _ in 0..most {
            if let Some(outcome) = self.outcomes.get(&goal) {
                return outcome.clone();
            }
            self.tick();
        }
        panic!(
            "goal {goal:?} is unresolved after {most} ms: {:?}",
            self.lifecycle
        );
    }

    /// Runs until nothing moves any more.
    ///
    /// # Panics
    /// If that takes longer than `most` milliseconds.
    pub fn until_idle(&mut self, most: u64) {
        for _ in 0..most {
            if self.lifecycle.is_idle() {
                return;
            }
            self.tick();
        }
        panic!("not idle after {most} ms: {:?}", self.lifecycle);
    }

    /// Sends a request that is not a motion; its answer is not awaited.
    ///
    /// # Panics
    /// If the session refuses it.
    pub fn request(&mut self, request: &Request) {
        let outgoing = self.session.request(request).expect("the session takes it");
        self.to_robot.push_back(outgoing.as_bytes().to_vec());
    }

    /// The true pose of the end effector, not rounded by the wire.
    pub fn true_pose(&self) -> Isometry3<f64> {
        let rigid =
            |column_major| transform::isometry_from_array(column_major).expect("a rigid frame");
        let ee = EndEffector {
            f_t_ee: transform::matrix(&rigid(&self.robot.state().F_T_EE)),
            ..EndEffector::default()
        };
        pose_of(self.robot.q(), &ee)
    }

    fn time(&self) -> Duration {
        Duration::from_millis(self.milliseconds)
    }

    fn take_replies(&mut self) {
        let received = std::mem::take(&mut self.from_robot);
        let mut rest = &received[..];
        while let Some(message) = next_message(rest).expect("the robot's messages are well-formed")
        {
            rest = &rest[message.header.size as usize..];
            let event = self
                .session
                .on_message(message)
                .expect("the robot keeps to the protocol");
            if let Event::Reply {
                id,
                reply: Reply::Move(status),
                ..
            } = event
            {
                let motion = self.motions[&id];
                self.lifecycle.on_move_reply(motion, status, self.time());
            }
        }
        self.from_robot = rest.to_vec();
    }

    fn carry_out(&mut self) {
        while let Some(output) = self.lifecycle.poll() {
            match output {
                Output::Order(order) => self.driver.on_order(order),
                Output::Send { motion, request } => {
                    let outgoing = self
                        .session
                        .request(&request)
                        .expect("the session takes it");
                    self.motions.insert(outgoing.id(), motion);
                    self.to_robot.push_back(outgoing.as_bytes().to_vec());
                }
                Output::Resolve { goal, result } => {
                    let twice = self.outcomes.insert(goal, result);
                    assert!(twice.is_none(), "goal {goal:?} is resolved once");
                }
            }
        }
    }
}

/// What the control thread does between a state and its command: returns the state, and the size of the command if there
/// is one.
fn cycle(
    driver: &mut Driver,
    version: Version,
    datagram: &[u8],
    command: &mut [u8],
) -> (RobotState, Option<usize>) {
    let state = RobotState::decode(version, datagram).expect("a state of this version");
    let answer = driver.on_state(&state);
    let size = answer.map(|answer| answer.encode(version, command).expect("it fits"));
    (state, size)
}

/// Runs `test` for every kind of robot, each time with what makes one: see [`Lockstep::ready_of`].
pub fn for_each_robot(test: impl Fn(&dyn Fn() -> Lockstep)) {
    for kind in RobotKind::ALL {
        println!("{kind:?}");
        test(&|| Lockstep::ready_of(kind));
    }
}

/// Pose of the end effector at `q`, of any kind of robot: their geometry is the same.
pub fn pose_of(q: &JointVector, ee: &EndEffector) -> Isometry3<f64> {
    let pose = Model::fr3().pose(Frame::EndEffector, q, ee);
    transform::isometry(&pose).expect("a rigid end effector")
}
