//! Differences between the kinds of robot, except their arms: versions, names, statuses.

use franka_model::RobotKind;
use franka_proto::{MoveStatus, RecoveryStatus, RobotError, SetterStatus, Version};

/// One kind of robot.
pub(crate) struct Description {
    kind: RobotKind,
    /// Version of the robot's protocol.
    pub(crate) version: Version,
    /// Name of the robot in its description; `None` if the robot serves no description.
    pub(crate) urdf_name: Option<&'static str>,
    pub(crate) precision: Precision,
    /// Errors that the robot raises for desired joint positions outside their range.
    pub(crate) range: RangeErrors,
    /// Answers to requests while a safety function is active.
    pub(crate) safety: SafetyStatuses,
}

/// Answers to requests while a safety function forbids motion.
pub(crate) struct SafetyStatuses {
    /// Answer for a running motion.
    pub(crate) preempted: MoveStatus,
    /// Answer for a requested motion.
    pub(crate) rejected: MoveStatus,
    pub(crate) setter: SetterStatus,
    pub(crate) recovery: RecoveryStatus,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    Single,
    Double,
}

impl Precision {
    /// Rounds a number to the value that a client reads.
    pub(crate) fn round(self, value: f64) -> f64 {
        match self {
            Self::Single => f64::from(value as f32),
            Self::Double => value,
        }
    }
}

/// Errors for desired joint positions outside their range, by the kind of command.
pub(crate) struct RangeErrors {
    pub(crate) joint_position: RobotError,
    pub(crate) joint_velocity: RobotError,
    pub(crate) cartesian: RobotError,
}

impl Description {
    pub(crate) fn of(kind: RobotKind) -> &'static Self {
        [&FR3, &FER]
            .into_iter()
            .find(|description| description.kind == kind)
            .expect("every kind is described")
    }
}

static FR3: Description = Description {
    kind: RobotKind::Fr3,
    version: Version::V10,
    urdf_name: Some("fr3"),
    precision: Precision::Single,
    // This robot has one error for every kind of command (FCI documentation, since system 5.7.2).
    range: RangeErrors {
        joint_position: RobotError::JointPositionLimitsViolation,
        joint_velocity: RobotError::JointPositionLimitsViolation,
        cartesian: RobotError::JointPositionLimitsViolation,
    },
    safety: SafetyStatuses {
        preempted: MoveStatus::PreemptedDueToActivatedSafetyFunctions,
        rejected: MoveStatus::CommandRejectedDueToActivatedSafetyFunctions,
        setter: SetterStatus::CommandRejectedDueToActivatedSafetyFunctions,
        recovery: RecoveryStatus::CommandRejectedDueToActivatedSafetyFunctions,
    },
};

static FER: Description = Description {
    kind: RobotKind::Fer,
    version: Version::V5,
    urdf_name: None,
    precision: Precision::Double,
    range: RangeErrors {
        joint_position: RobotError::JointMotionGeneratorPositionLimitsViolation,
        joint_velocity: RobotError::JointPositionLimitsViolation,
        cartesian: RobotError::CartesianMotionGeneratorJointPositionLimitsViolation,
    },
    // The protocol of this robot has no statuses for safety functions; they act like the user
    // stop.
    safety: SafetyStatuses {
        preempted: MoveStatus::EmergencyAborted,
        rejected: MoveStatus::CommandNotPossibleRejected,
        setter: SetterStatus::CommandNotPossibleRejected,
        recovery: RecoveryStatus::CommandNotPossibleRejected,
    },
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_a_description_and_a_version_of_its_own() {
        let versions = RobotKind::ALL.map(|kind| Description::of(kind).version);
        assert_eq!(versions, [Version::V10, Version::V5]);
    }
}
