//! A running motion: which commands the robot accepts, the effect of a lost command, and the end of
//! the motion.

use franka_model::limits::JointLimits;
use franka_model::{CYCLE, JointVector};
use franka_proto::{
    CommandId, ControllerMode, Errors, Filters, MotionGeneratorMode, MoveControllerMode,
    MoveGeneratorMode, MoveRequest, RobotCommand, RobotError,
};

use crate::config::FirstCycles;
use crate::filter::filtered;
use crate::generator::{ArmModel, Desired, Input, PointToPoint, advance};
use crate::signal::JointSignal;
use crate::success_rate::{LOST_LIMIT, SuccessRate};

/// A motion between `kMotionStarted` and the final reply to a `Move`.
#[derive(Debug, Clone)]
pub(super) struct ActiveMotion {
    id: CommandId,
    request: MoveRequest,
    /// `message_id` of the first state that shows the motion. Commands that answer earlier states
    /// belong to the previous motion.
    first_state: u64,
    success_rate: SuccessRate,
    /// True if a command has arrived, in time or late.
    is_answered: bool,
    /// True if a command has arrived in time.
    is_begun: bool,
    /// `tau_J_d`: the last accepted torques, `[N·m]`; zero before the first command.
    torque: JointVector,
    /// True if the last cycle had no command, so that the generator did not advance.
    paused: bool,
    /// The generator of an asynchronous motion, which replaces the commands of each cycle.
    asynchronous: Option<PointToPoint>,
}

/// Kind of command that the newest state requires of the client.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Awaited {
    /// No command, or the command has already arrived.
    Nothing,
    /// The first command of a motion. A client may read several states before it sends this
    /// command; no command counts as lost.
    First,
    /// A later command. If it does not arrive, the cycle counts as lost.
    Next,
}

/// Rules whose violation ends a motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rules {
    pub(super) limits: bool,
    pub(super) communication: bool,
    pub(super) filters: Option<Filters>,
    /// Measured joint velocity above which no external controller may finish, `[rad/s]`.
    pub(super) finish_velocity: f64,
}

/// Result of one cycle of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Continues,
    Finished,
    /// A command violated the rules and had no effect. The value names the errors.
    Broken(Errors),
    /// A command contains non-finite numbers.
    Invalid,
}

impl ActiveMotion {
    pub(super) fn new(
        id: CommandId,
        request: MoveRequest,
        first_state: u64,
        limits: &JointLimits,
    ) -> Self {
        Self {
            id,
            request,
            first_state,
            success_rate: SuccessRate::default(),
            is_answered: false,
            is_begun: false,
            torque: JointVector::zeros(),
            paused: false,
            asynchronous: request
                .asynchronous
                .map(|velocity| PointToPoint::new(&JointVector::from(velocity), limits)),
        }
    }

    /// Id of the `Move` request to answer.
    pub(super) fn id(&self) -> CommandId {
        self.id
    }

    pub(super) fn request(&self) -> &MoveRequest {
        &self.request
    }

    pub(super) fn generator_mode(&self) -> MotionGeneratorMode {
        self.request.generator.in_state()
    }

    pub(super) fn controller_mode(&self) -> ControllerMode {
        self.request.controller.in_state()
    }

    /// True if the client's torques drive the arm.
    pub(super) fn is_external(&self) -> bool {
        self.request.controller == MoveControllerMode::ExternalController
    }

    /// True if the robot itself plans the motion to targets that arrive at irregular times.
    pub(super) fn is_asynchronous(&self) -> bool {
        self.asynchronous.is_some()
    }

    pub(super) fn is_torque_only(&self) -> bool {
        self.request.generator == MoveGeneratorMode::None
    }

    /// The client's torques, `[N·m]`.
    pub(super) fn torque(&self) -> &JointVector {
        &self.torque
    }

    /// True if the motion continues, but its setpoint does not move because no command came.
    pub(super) fn is_paused(&self) -> bool {
        self.paused
    }

    pub(super) fn success_rate(&self, first: FirstCycles) -> f64 {
        self.success_rate.rate(first)
    }

    /// True if the robot accepts a command that answers the state `answers`. `newest` is the last
    /// published state. The robot accepts no late command, because the robot has already
    /// extrapolated its cycle.
    pub(super) fn accepts(&self, answers: u64, newest: u64) -> bool {
        answers >= self.first_state
            && (answers == newest || (self.asynchronous.is_some() && answers < newest))
    }

    /// Kind of command that the states of this motion require.
    pub(super) fn awaits(&self) -> Awaited {
        match &self.asynchronous {
            Some(_) => Awaited::Nothing,
            None if self.is_answered => Awaited::Next,
            None => Awaited::First,
        }
    }

    /// Records a refused command that answers the state `answers`; `newest` is the last state.
    /// After a late command, lost commands count, because the client has begun.
    pub(super) fn refuse(&mut self, answers: u64, newest: u64) {
        self.is_answered |= (self.first_state..newest).contains(&answers);
    }

    /// Processes the input of one cycle, and advances `desired`. `dq` are the measured joint
    /// velocities, `[rad/s]`.
    ///
    /// If the command of a cycle is lost, the torques of the previous cycle apply again (FCI
    /// documentation), with or without [`Rules::communication`].
    pub(super) fn cycle(
        &mut self,
        command: Option<&RobotCommand>,
        desired: &mut Desired,
        dq: &JointVector,
        arm: &ArmModel<'_>,
        rules: Rules,
    ) -> Verdict {
        if self.asynchronous.is_some() {
            return self.plan(command, desired, arm, rules);
        }
        let mut errors = Errors::NONE;
        self.paused = false;
        // The comparison of the first command with the start must not include a filter.
        let filters = rules.filters.filter(|_| self.is_begun);
        let smooth = command
            .zip(filters)
            .map(|(command, filters)| filtered(command, desired, &self.torque, &filters));
        let command = smooth.as_ref().or(command);
        let input = match command {
            Some(command) => {
                // Without limits, every start is valid.
                let first = !self.is_begun && rules.limits;
                (self.is_answered, self.is_begun) = (true, true);
                self.success_rate.hit();
                if first {
                    Input::First(command)
                } else {
                    Input::Next(command)
                }
            }
            None if !self.is_answered => return Verdict::Continues,
            None => {
                let lost = self.success_rate.miss();
                if !rules.communication {
                    self.paused = true;
                    return Verdict::Continues;
                }
                if lost >= LOST_LIMIT {
                    errors.insert(RobotError::CommunicationConstraintsViolation);
                }
                Input::Lost
            }
        };

        let Ok((next, broken)) = advance(self.request.generator, input, desired, arm) else {
            return Verdict::Invalid;
        };
        errors = errors.union(enforced(broken, rules));
        if let Some(command) = command.filter(|_| self.is_external()) {
            let torque = JointVector::from(command.tau_J_d);
            if !torque.iter().all(|value| value.is_finite()) {
                return Verdict::Invalid;
            }
            if rules.limits && self.is_discontinuous(&torque, arm.model.joint_limits()) {
                errors.insert(RobotError::ControllerTorqueDiscontinuity);
            }
            if errors.is_empty() {
                self.torque = torque;
            }
        }
        if !errors.is_empty() {
            return Verdict::Broken(errors);
        }
        *desired = next;
        if command.is_some_and(|command| self.is_last(command)) {
            self.finish(desired, dq, arm, rules)
        } else {
            Verdict::Continues
        }
    }

    /// Processes a cycle of an asynchronous motion, in which the robot itself plans the path to the
    /// last target.
    fn plan(
        &mut self,
        command: Option<&RobotCommand>,
        desired: &mut Desired,
        arm: &ArmModel<'_>,
        rules: Rules,
    ) -> Verdict {
        let Some(generator) = &mut self.asynchronous else {
            return Verdict::Continues;
        };
        if let Some(command) = command {
            if command.motion_generation_finished {
                // The last command of libfranka contains zeros instead of a position.
                return Verdict::Finished;
            }
            let target = JointVector::from(command.q_c);
            if !target.iter().all(|value| value.is_finite()) {
                return Verdict::Invalid;
            }
            if rules.limits && arm.model.joint_limits().outside_hard(&target).is_some() {
                return Verdict::Broken(RobotError::JointPositionLimitsViolation.into());
            }
            generator.go_to(&target, &desired.joints);
        }
        desired.joints = generator.advance(&desired.joints);
        desired.follow_joints(arm);
        Verdict::Continues
    }

    fn is_last(&self, command: &RobotCommand) -> bool {
        if self.is_torque_only() {
            command.torque_command_finished
        } else {
            command.motion_generation_finished
        }
    }

    /// Checks that a motion finishes at rest. The last command then applies unchanged, and is
    /// checked like any other command. Under an external controller, the measured joints must also
    /// be at rest.
    fn finish(
        &self,
        desired: &mut Desired,
        dq: &JointVector,
        arm: &ArmModel<'_>,
        rules: Rules,
    ) -> Verdict {
        match advance(self.request.generator, Input::Rest, desired, arm) {
            Err(_) => Verdict::Invalid,
            Ok((_, mut broken)) => {
                if self.is_external() && dq.amax() > rules.finish_velocity {
                    broken.insert(RobotError::JointMotionGeneratorVelocityDiscontinuity);
                }
                let errors = enforced(broken, rules);
                if errors.is_empty() {
                    desired.joints = JointSignal::resting(desired.joints.q);
                    Verdict::Finished
                } else {
                    Verdict::Broken(errors)
                }
            }
        }
    }

    fn is_discontinuous(&self, torque: &JointVector, limits: &JointLimits) -> bool {
        let rate = (torque - self.torque) / CYCLE;
        (0..7).any(|i| rate[i].abs() > limits.torque_rate[i] + ROUNDING)
    }
}

/// Returns the errors that the rules enforce. An invalid pose is always an error.
fn enforced(errors: Errors, rules: Rules) -> Errors {
    if rules.limits {
        return errors;
    }
    errors
        .iter()
        .filter(|&error| error == RobotError::CartesianPositionMotionGeneratorInvalidFrameFlag)
        .collect()
}

/// A step of exactly 1 N·m per cycle is allowed, even if the sum rounds, `[N·m/s]`.
const ROUNDING: f64 = 1e-9;
