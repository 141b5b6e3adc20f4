//! Reflexes: the checks of each cycle, and the stop that follows a violation or a contact.
//!
//! Limits of joints, speed, torque and path are checked here, contact in `estimate`, and
//! self-collision, virtual walls, power and stability in `watch`.

use franka_proto::{Errors, MoveStatus, RecoveryStatus, Reply, RobotError};

use super::watch::Sight;
use super::{Activity, Robot};
use crate::config::ErrorBits;
use crate::signal::halves;

impl Robot {
    /// Checks the arm and its contacts, and begins a reflex if they violate a limit.
    pub(super) fn supervise(&mut self) {
        let moving = self.is_moving();
        let ddq = match &self.activity {
            // Accelerations that external forces cause are not phases of the motion.
            Activity::Moving(motion) if !motion.is_external() => self.desired.joints.ddq,
            _ => self.measurement.ddq,
        };
        let accelerating = ddq.amax() > self.config.unpublished.accelerating;
        let thresholds = &self.settings.thresholds;
        let axes = self.config.unpublished.force_axes;
        let mut errors = self
            .estimate
            .compare(thresholds, axes, accelerating, moving);
        if moving && self.config.enforce_limits {
            let sight = Sight {
                q: &self.measurement.q,
                dq: &self.measurement.dq,
                torque: &self.measurement.torque,
                pose: &self.dynamics.pose,
            };
            let seen = self.watch.violations(&sight, &self.config);
            errors = errors.union(self.violations()).union(seen);
        }
        if self.is_guided_out() {
            errors.insert(RobotError::JointMoveInWrongDirection);
        }
        if !errors.is_empty() {
            self.reflex(errors);
        }
    }

    /// Returns the limits that joints, speed, torque and path exceed.
    fn violations(&self) -> Errors {
        let limits = self.model.joint_limits();
        let (q, dq) = (&self.measurement.q, &self.measurement.dq);
        let (lower, upper) = limits.velocity_envelope(q, -VELOCITY_MARGIN);
        let (linear, _) = halves(&(self.dynamics.jacobian * dq));
        let torque = &self.measurement.torque;
        let range = limits.torque * self.config.unpublished.sensor_range;
        [
            (self.is_outside(), RobotError::JointPositionLimitsViolation),
            (
                (0..7).any(|i| dq[i] > upper[i] || dq[i] < lower[i]),
                RobotError::JointVelocityViolation,
            ),
            (
                linear.norm() > self.model.cartesian_limits().translation.velocity,
                RobotError::CartesianVelocityViolation,
            ),
            (
                (0..7).any(|i| torque[i].abs() > range[i]),
                RobotError::TauJRangeViolation,
            ),
            (
                self.leaves_path(),
                RobotError::MaxPathPoseDeviationViolation,
            ),
        ]
        .into_iter()
        .filter_map(|(violated, error)| violated.then_some(error))
        .collect()
    }

    /// Latches errors and stops the arm.
    pub(super) fn reflex(&mut self, errors: Errors) {
        let latched = match self.config.unpublished.error_bits {
            ErrorBits::All => errors,
            ErrorBits::First => errors.iter().take(1).collect(),
        };
        self.errors = self.errors.union(latched);
        self.reflex_reason = self.errors;
        self.end_motion(MoveStatus::ReflexAborted);
        self.guide(false);
        self.abort_recovery(RecoveryStatus::ReflexAborted);
        if let Some((id, _)) = self.waiting.take() {
            self.reply(id, Reply::Move(MoveStatus::CommandNotPossibleRejected));
        }
    }
}

// These values are not published for the robot. Unless noted otherwise, they are choices of this
// simulator.

/// Tolerance of measured velocities outside their envelope, `[rad/s]`.
const VELOCITY_MARGIN: f64 = 0.1;
