//! The robot's mode: motion, reflex, user stop and recovery. Reflexes begin in `reflex`.
//!
//! ```text
//!            Move                    finish, StopMove
//!   Idle ───────────> Move ──────────────────────────────> Idle
//!    ^                 │ violation, collision
//!    │ at rest         v
//!    └── Recovery <── Reflex      user stop: from anywhere to User stopped, and back on release
//! ```

use franka_model::Frame;
use franka_proto::{
    CommandId, ControllerMode, Errors, MotionGeneratorMode, MoveGeneratorMode, MoveRequest,
    MoveStatus, Reply, RobotError, RobotMode, StopStatus,
};

use super::motion::{ActiveMotion, Rules, Verdict};
use super::{Activity, Robot};
use crate::brake::Brake;
use crate::generator::{ArmModel, Desired};

impl Robot {
    pub(super) fn robot_mode(&self) -> RobotMode {
        if matches!(self.activity, Activity::Guided(_)) {
            RobotMode::Guiding
        } else if self.lock.brakes_closed {
            RobotMode::Other
        } else if self.lock.user_stop || self.lock.safety_function {
            RobotMode::UserStopped
        } else if self.recovery.is_some() {
            RobotMode::AutomaticErrorRecovery
        } else if !self.errors.is_empty() {
            RobotMode::Reflex
        } else if self.is_moving() {
            RobotMode::Move
        } else {
            RobotMode::Idle
        }
    }

    pub(super) fn modes(&self) -> (MotionGeneratorMode, ControllerMode) {
        match &self.activity {
            Activity::Moving(motion) => (motion.generator_mode(), motion.controller_mode()),
            _ => (MotionGeneratorMode::Idle, ControllerMode::Other),
        }
    }

    /// Answers a `Move`.
    pub(super) fn request_move(&mut self, id: CommandId, request: MoveRequest) {
        let refusal = match self.robot_mode() {
            _ if self.lock.safety_function => Some(self.kind.safety.rejected),
            RobotMode::Idle | RobotMode::Move if !self.is_possible(&request) => {
                Some(MoveStatus::InvalidArgumentRejected)
            }
            RobotMode::Idle | RobotMode::Move => None,
            _ => Some(MoveStatus::CommandNotPossibleRejected),
        };
        if let Some(status) = refusal {
            return self.reply(id, Reply::Move(status));
        }
        // A second motion replaces the first.
        self.end_motion(MoveStatus::Preempted);
        if let Some((id, _)) = self.waiting.replace((id, request)) {
            self.reply(id, Reply::Move(MoveStatus::Preempted));
        }
        // The state of this millisecond has been sent.
        self.start_waiting(self.clock + 1);
    }

    fn is_possible(&self, request: &MoveRequest) -> bool {
        let deviations = [
            &request.maximum_path_deviation,
            &request.maximum_goal_pose_deviation,
        ];
        let positive = deviations
            .into_iter()
            .flat_map(|d| [d.translation, d.rotation, d.elbow])
            .all(|bound| bound.is_finite() && bound > 0.0);
        let external = request.controller == franka_proto::MoveControllerMode::ExternalController;
        let combination = external || request.generator != MoveGeneratorMode::None;
        let limits = &self.model.joint_limits().velocity;
        let asynchronous = request.asynchronous.is_none_or(|velocity| {
            request.generator == MoveGeneratorMode::JointPosition
                && !external
                && (0..7).all(|i| velocity[i] > 0.0 && velocity[i] <= limits[i])
        });
        positive && combination && asynchronous
    }

    /// Begins the waiting motion, if the arm is at rest. The state `first_state` is the first that
    /// shows the motion.
    fn start_waiting(&mut self, first_state: u64) {
        if !matches!(self.activity, Activity::Holding) {
            return;
        }
        let Some((id, request)) = self.waiting.take() else {
            return;
        };
        if self.robot_mode() != RobotMode::Idle {
            return self.reply(id, Reply::Move(MoveStatus::CommandNotPossibleRejected));
        }
        self.reply(id, Reply::Move(MoveStatus::MotionStarted));
        let cartesian = matches!(
            request.generator,
            MoveGeneratorMode::CartesianPosition | MoveGeneratorMode::CartesianVelocity
        );
        if cartesian && self.is_singular() {
            return self.reply(id, Reply::Move(MoveStatus::StartAtSingularPoseRejected));
        }
        if self.config.unpublished.move_clears_reason {
            self.reflex_reason = Errors::NONE;
        }
        self.watch.begin();
        self.command = None;
        self.desired = self.desired.as_published(self.kind.precision);
        let limits = self.model.joint_limits();
        self.activity = Activity::Moving(ActiveMotion::new(id, request, first_state, limits));
    }

    fn is_singular(&self) -> bool {
        let jacobian = self.model.zero_jacobian(
            Frame::EndEffector,
            &self.desired.joints.q,
            &self.settings.frames,
        );
        let gram = jacobian * jacobian.transpose();
        let bound = self.config.unpublished.singular;
        gram.symmetric_eigenvalues().min() <= bound * bound
    }

    /// Answers a `StopMove`, once the arm is at rest.
    pub(super) fn request_stop(&mut self, id: CommandId) {
        self.end_motion(MoveStatus::Preempted);
        if let Some((waiting, _)) = self.waiting.take() {
            self.reply(waiting, Reply::Move(MoveStatus::Preempted));
        }
        self.stops.push(id);
    }

    /// Forgets the requests that wait for an answer, and stops the motion.
    pub(super) fn forget_client(&mut self) {
        self.waiting = None;
        self.stops.clear();
        if let Some(recovery) = &mut self.recovery {
            recovery.forget_client();
        }
        self.end_motion(MoveStatus::Aborted);
    }

    /// Ends the current motion, if any: sends the final reply and brakes the arm.
    pub(super) fn end_motion(&mut self, status: MoveStatus) {
        let Activity::Moving(motion) = &self.activity else {
            return;
        };
        let (id, external) = (motion.id(), motion.is_external());
        let limits = self.model.joint_limits();
        let start = self.brake_start(!external);
        let brake = Brake::from(&start, &limits.acceleration, &limits.jerk);
        self.desired.joints = start;
        self.desired.follow_joints(&ArmModel::new(
            self.kind,
            &self.model,
            &self.settings.frames,
            &self.config,
        ));
        self.activity = Activity::Braking(brake);
        self.command = None;
        self.reply(id, Reply::Move(status));
    }

    /// Runs the current motion for one cycle.
    pub(super) fn run_motion(&mut self) {
        let command = self.command.take();
        let takes_none = self.takes_no_commands();
        let Activity::Moving(motion) = &mut self.activity else {
            return;
        };
        let arm = ArmModel::new(self.kind, &self.model, &self.settings.frames, &self.config);
        let rules = Rules {
            limits: self.config.enforce_limits,
            communication: self.config.enforce_communication,
            filters: self.settings.filters,
            finish_velocity: self.config.unpublished.finish_velocity,
        };
        let dq = &self.measurement.dq;
        if takes_none {
            // The command counts as received, but has no effect.
            let mut desired = self.desired;
            let verdict = motion.cycle(command.as_ref(), &mut desired, dq, &arm, rules);
            self.desired = Desired::resting(&arm, self.desired.joints.q);
            if verdict == Verdict::Finished {
                self.end_motion(MoveStatus::Success);
            }
            return;
        }
        match motion.cycle(command.as_ref(), &mut self.desired, dq, &arm, rules) {
            Verdict::Continues => {}
            Verdict::Finished if self.misses_goal() => {
                self.reflex(RobotError::MaxGoalPoseDeviationViolation.into());
            }
            Verdict::Finished => self.end_motion(MoveStatus::Success),
            Verdict::Broken(errors) => self.reflex(errors),
            Verdict::Invalid => self.end_motion(MoveStatus::InputErrorAborted),
        }
    }

    /// True if the arm deviates from a generated motion by more than the client allowed.
    pub(super) fn leaves_path(&self) -> bool {
        match &self.activity {
            Activity::Moving(motion) if !motion.is_external() => {
                self.deviates(&motion.request().maximum_path_deviation)
            }
            _ => false,
        }
    }

    fn misses_goal(&self) -> bool {
        match &self.activity {
            Activity::Moving(motion) if !motion.is_external() && self.config.enforce_limits => {
                self.deviates(&motion.request().maximum_goal_pose_deviation)
            }
            _ => false,
        }
    }

    fn deviates(&self, bound: &franka_proto::Deviation) -> bool {
        let arm = self.arm();
        let actual = arm.pose(&self.measurement.q);
        let desired = arm.pose(&self.desired.joints.q);
        let shift = (actual.translation.vector - desired.translation.vector).norm();
        let turn = franka_model::rotation::error(&actual.rotation, &desired.rotation).norm();
        let elbow = (self.measurement.q[2] - self.desired.joints.q[2]).abs();
        shift > bound.translation || turn > bound.rotation || elbow > bound.elbow
    }

    /// Continues the requests that wait for the arm to be at rest.
    pub(super) fn settle(&mut self) {
        if !matches!(self.activity, Activity::Holding | Activity::Guided(_)) {
            return;
        }
        for id in core::mem::take(&mut self.stops) {
            self.reply(id, Reply::StopMove(StopStatus::Success));
        }
        self.end_recovery();
        // The state of this millisecond has not been published yet, so it already shows the
        // motion.
        self.start_waiting(self.clock);
    }
}
