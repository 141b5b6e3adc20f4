//! One arm, its driver, and a person who sets targets and pushes.

use franka_lockstep::Lockstep;
use franka_model::{EndEffector, JointVector, RobotKind, transform};
use franka_proto::{Request, RobotMode};
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{Bindings, GoalId, OnArrival, Target};
use franka_sim::arm::{Arm, Family};
use franka_sim::{Config, Touch, TouchId};
use nalgebra::{Isometry3, Vector3};

/// Speed limit of the operating mode "manual reduced speed", `[m/s]`.
const SPEED_CAP: f64 = 0.25;

/// Largest force with which a person pushes, `[N]`.
const PUSH_MAX: f64 = 200.0;

/// An arm that moves to a target, and that can be pushed, stopped and recovered.
pub struct Playground {
    lockstep: Lockstep,
    seconds: f64,
    phase: Phase,
    target: Isometry3<f64>,
    /// True if the session has not received the target yet.
    is_new: bool,
    goal: Option<GoalId>,
    push: Option<TouchId>,
    obstacle: Option<TouchId>,
    message: String,
}

/// Activity of the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// The arm moves to its target, or holds it.
    Following,
    /// The session begins, or the robot recovers.
    Starting,
    /// The arm has stopped. Call [`Playground::recover`] to continue.
    Stopped,
}

#[derive(Clone, Copy)]
enum Phase {
    Starting(GoalId),
    Following(GoalId),
    Stopped,
    Recovering,
}

/// Current state of an arm, in the base frame and SI units.
pub struct View {
    /// Time since the start.
    pub seconds: f64,
    /// Activity of the arm.
    pub state: State,
    /// Measured joint positions.
    pub q: [f64; 7],
    /// Joint positions of the reference, or of the arm if nothing controls it.
    pub q_ref: [f64; 7],
    /// Target pose of the end effector.
    pub target: Isometry3<f64>,
    /// Measured pose of the end effector.
    pub end_effector: Isometry3<f64>,
    /// Estimated force on the end effector, positive in the direction of the push.
    pub force: Vector3<f64>,
    /// Speed of the fastest point of the arm.
    pub speed: f64,
    /// The guards that bound the newest command.
    pub guards: Bindings,
}

impl Playground {
    /// Returns an arm at rest in the ready pose with a running session. The arm is realistic and
    /// drawn from `seed`, or ideal if `seed` is `None`.
    pub fn new(kind: RobotKind, seed: Option<u64>) -> Self {
        let mut lockstep = Lockstep::new(Config {
            arm: Some(match seed {
                Some(seed) => Arm::sample(kind, seed, &Family::realistic()),
                None => Arm::ideal(kind),
            }),
            seed: seed.unwrap_or_default(),
            ..Lockstep::config_of(kind)
        });
        let mut this = Self {
            target: lockstep.arm_pose(),
            phase: begin(&mut lockstep),
            lockstep,
            seconds: 0.0,
            is_new: false,
            goal: None,
            push: None,
            obstacle: None,
            message: String::new(),
        };
        if matches!(this.phase, Phase::Stopped) {
            this.message = "the robot takes no motion".into();
        }
        this
    }

    /// Advances time by `milliseconds`.
    pub fn advance(&mut self, milliseconds: u32) {
        for _ in 0..milliseconds {
            self.lockstep.tick();
            self.seconds += 0.001;
            self.proceed();
        }
    }

    /// Sets the target pose of the end effector.
    pub fn target(&mut self, pose: Isometry3<f64>) {
        (self.target, self.is_new) = (pose, true);
    }

    /// Pushes the end effector with this force in the base frame, `[N]`, until the next call.
    pub fn push(&mut self, force: Vector3<f64>) {
        self.push
            .take()
            .map(|push| self.lockstep.robot.release(push));
        let size = force.norm();
        if size > 0.0 && size.is_finite() {
            let force = force * (PUSH_MAX / size).min(1.0);
            self.push = Some(self.lockstep.robot.touch(Touch::force(force)));
        }
    }

    /// Grips the end effector in its position, or releases it.
    pub fn block(&mut self, on: bool) {
        let robot = &mut self.lockstep.robot;
        self.obstacle.take().map(|obstacle| robot.release(obstacle));
        if on {
            self.obstacle = Some(robot.touch(Touch::hold()));
        }
    }

    /// Makes the robot recover, and begins a session that holds the arm in its position. Has no
    /// effect unless the arm has stopped.
    pub fn recover(&mut self) {
        if matches!(self.phase, Phase::Stopped) {
            self.lockstep.request(&Request::AutomaticErrorRecovery);
            self.phase = Phase::Recovering;
            self.message.clear();
            self.target = self.lockstep.arm_pose();
            (self.is_new, self.goal) = (false, None);
        }
    }

    /// The newest message: the reason why the arm stopped, or why a target is invalid.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Current state of the arm.
    pub fn view(&self) -> View {
        let (state, record) = (&self.lockstep.client.state, &self.lockstep.client.record);
        let [q, dq] = [state.q, state.dq].map(JointVector::from);
        let end_effector = transform::isometry_from_array(&state.F_T_EE).unwrap_or_default();
        let end_effector = EndEffector {
            f_t_ee: transform::matrix(&end_effector),
            ..EndEffector::default()
        };
        let state_now = match self.phase {
            Phase::Following(_) => State::Following,
            Phase::Starting(_) | Phase::Recovering => State::Starting,
            Phase::Stopped => State::Stopped,
        };
        let model = self.lockstep.robot.model();
        let [x, y, z, ..] = state.O_F_ext_hat_K;
        View {
            seconds: self.seconds,
            state: state_now,
            q: state.q,
            q_ref: match state_now {
                State::Following => record.q_ref,
                _ => state.q,
            },
            target: self.target,
            end_effector: self.lockstep.pose_at(&q),
            // The robot estimates the force that the arm exerts, so the sign changes.
            force: -Vector3::new(x, y, z),
            speed: model.fastest_point(&q, &dq, &end_effector),
            guards: record.bindings,
        }
    }

    /// Handles the results of the last millisecond.
    fn proceed(&mut self) {
        match self.phase {
            Phase::Starting(session) | Phase::Following(session) => {
                if let Some(outcome) = self.lockstep.client.outcome(session) {
                    self.message = match outcome {
                        Ok(_) => "the session has ended".into(),
                        Err(error) => error.to_string(),
                    };
                    self.phase = Phase::Stopped;
                } else if matches!(self.phase, Phase::Starting(_)) {
                    if self.lockstep.client.record.goal == session.0 {
                        self.phase = Phase::Following(session);
                    }
                } else {
                    self.follow(session);
                }
            }
            Phase::Recovering => match self.lockstep.client.state.robot_mode {
                RobotMode::Idle => self.phase = begin(&mut self.lockstep),
                RobotMode::UserStopped => self.phase = Phase::Stopped,
                _ => {}
            },
            Phase::Stopped => {}
        }
    }

    /// Sends a new target to the session, and reports a target that the session has abandoned.
    fn follow(&mut self, session: GoalId) {
        let ended = self
            .goal
            .and_then(|goal| self.lockstep.client.outcome(goal));
        if let Some(ended) = ended {
            match ended {
                Err(MotionError::Superseded) | Ok(_) => {}
                Err(error) => self.message = error.to_string(),
            }
            self.goal = None;
        }
        if std::mem::take(&mut self.is_new) {
            let goal = Target::Pose(self.target);
            match self.lockstep.within(session, goal, OnArrival::Hold) {
                Ok(goal) => {
                    self.goal = Some(goal);
                    self.message.clear();
                }
                Err(error) => self.message = error.to_string(),
            }
        }
    }
}

/// Begins a session with the speed limit.
fn begin(lockstep: &mut Lockstep) -> Phase {
    let engagement = Engagement {
        speed_cap: Some(SPEED_CAP),
        ..Engagement::default()
    };
    lockstep
        .try_engage(engagement)
        .map_or(Phase::Stopped, Phase::Starting)
}
