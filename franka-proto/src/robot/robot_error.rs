//! The 41 errors of a robot state.

use core::fmt;

/// Declares the errors, each with its variant and libfranka's text, in wire order.
macro_rules! robot_errors {
    ($($variant:ident = $text:literal,)*) => {
        /// One of the 41 reasons why a robot stops itself.
        ///
        /// The errors have the order of the wire, which is the same in protocols 5 and 10. The
        /// texts come from libfranka 0.21.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum RobotError {
            $(#[doc = concat!("`", $text, "`")] $variant,)*
        }

        impl RobotError {
            /// All errors, by index.
            pub const ALL: [Self; 41] = [$(Self::$variant,)*];

            /// Returns libfranka's name of the error.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text,)*
                }
            }
        }
    };
}

robot_errors! {
    JointPositionLimitsViolation = "joint_position_limits_violation",
    CartesianPositionLimitsViolation = "cartesian_position_limits_violation",
    SelfCollisionAvoidanceViolation = "self_collision_avoidance_violation",
    JointVelocityViolation = "joint_velocity_violation",
    CartesianVelocityViolation = "cartesian_velocity_violation",
    ForceControlSafetyViolation = "force_control_safety_violation",
    JointReflex = "joint_reflex",
    CartesianReflex = "cartesian_reflex",
    MaxGoalPoseDeviationViolation = "max_goal_pose_deviation_violation",
    MaxPathPoseDeviationViolation = "max_path_pose_deviation_violation",
    CartesianVelocityProfileSafetyViolation = "cartesian_velocity_profile_safety_violation",
    JointPositionMotionGeneratorStartPoseInvalid = "joint_position_motion_generator_start_pose_invalid",
    JointMotionGeneratorPositionLimitsViolation = "joint_motion_generator_position_limits_violation",
    JointMotionGeneratorVelocityLimitsViolation = "joint_motion_generator_velocity_limits_violation",
    JointMotionGeneratorVelocityDiscontinuity = "joint_motion_generator_velocity_discontinuity",
    JointMotionGeneratorAccelerationDiscontinuity = "joint_motion_generator_acceleration_discontinuity",
    CartesianPositionMotionGeneratorStartPoseInvalid = "cartesian_position_motion_generator_start_pose_invalid",
    CartesianMotionGeneratorElbowLimitViolation = "cartesian_motion_generator_elbow_limit_violation",
    CartesianMotionGeneratorVelocityLimitsViolation = "cartesian_motion_generator_velocity_limits_violation",
    CartesianMotionGeneratorVelocityDiscontinuity = "cartesian_motion_generator_velocity_discontinuity",
    CartesianMotionGeneratorAccelerationDiscontinuity = "cartesian_motion_generator_acceleration_discontinuity",
    CartesianMotionGeneratorElbowSignInconsistent = "cartesian_motion_generator_elbow_sign_inconsistent",
    CartesianMotionGeneratorStartElbowInvalid = "cartesian_motion_generator_start_elbow_invalid",
    ForceControllerDesiredForceToleranceViolation = "force_controller_desired_force_tolerance_violation",
    StartElbowSignInconsistent = "start_elbow_sign_inconsistent",
    CommunicationConstraintsViolation = "communication_constraints_violation",
    PowerLimitViolation = "power_limit_violation",
    CartesianMotionGeneratorJointPositionLimitsViolation = "cartesian_motion_generator_joint_position_limits_violation",
    CartesianMotionGeneratorJointVelocityLimitsViolation = "cartesian_motion_generator_joint_velocity_limits_violation",
    CartesianMotionGeneratorJointVelocityDiscontinuity = "cartesian_motion_generator_joint_velocity_discontinuity",
    CartesianMotionGeneratorJointAccelerationDiscontinuity = "cartesian_motion_generator_joint_acceleration_discontinuity",
    CartesianPositionMotionGeneratorInvalidFrameFlag = "cartesian_position_motion_generator_invalid_frame_flag",
    ControllerTorqueDiscontinuity = "controller_torque_discontinuity",
    JointP2pInsufficientTorqueForPlanning = "joint_p2p_insufficient_torque_for_planning",
    TauJRangeViolation = "tau_J_range_violation",
    InstabilityDetected = "instability_detected",
    JointMoveInWrongDirection = "joint_move_in_wrong_direction",
    CartesianSplineMotionGeneratorViolation = "cartesian_spline_motion_generator_violation",
    JointViaMotionGeneratorPlanningJointLimitViolation = "joint_via_motion_generator_planning_joint_limit_violation",
    BaseAccelerationInitializationTimeout = "base_acceleration_initialization_timeout",
    BaseAccelerationInvalidReading = "base_acceleration_invalid_reading",
}

impl RobotError {
    /// Returns the position of the error's flag on the wire, 0 to 40.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// Returns the error at a wire position.
    #[must_use]
    pub fn from_index(index: usize) -> Option<Self> {
        Self::ALL.get(index).copied()
    }

    /// Returns the error with libfranka's name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|error| error.name() == name)
    }

    fn bit(self) -> u64 {
        1 << self.index()
    }
}

impl fmt::Display for RobotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A set of robot errors.
///
/// `Display` prints libfranka's list: `["joint_reflex", "cartesian_reflex"]`, or `[]`.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Errors(u64);

impl Errors {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// Reads the flags from the wire. Each flag is one byte, and any non-zero value is true.
    #[must_use]
    pub fn from_flags(flags: &[u8; 41]) -> Self {
        let mut bits = 0;
        for (index, &flag) in flags.iter().enumerate() {
            bits |= u64::from(flag != 0) << index;
        }
        Self(bits)
    }

    /// Returns the flags for the wire. Each flag is one byte, 0 or 1.
    #[must_use]
    pub fn to_flags(self) -> [u8; 41] {
        core::array::from_fn(|index| u8::from(self.0 >> index & 1 != 0))
    }

    /// Returns true if `error` is in the set.
    #[must_use]
    pub fn contains(self, error: RobotError) -> bool {
        self.0 & error.bit() != 0
    }

    /// Adds `error` to the set.
    pub fn insert(&mut self, error: RobotError) {
        self.0 |= error.bit();
    }

    /// Removes `error` from the set.
    pub fn remove(&mut self, error: RobotError) {
        self.0 &= !error.bit();
    }

    /// Returns the union of both sets.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns true if the set is empty.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Returns the number of errors in the set.
    #[must_use]
    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Returns the set as an integer. Bit `n` represents the error with index `n`.
    #[must_use]
    pub fn bits(self) -> u64 {
        self.0
    }

    /// Returns the set from an integer of [`Errors::bits`]. Bits above 40 are ignored.
    #[must_use]
    pub fn from_bits(bits: u64) -> Self {
        Self(bits & ((1 << RobotError::ALL.len()) - 1))
    }

    /// Returns the errors in the order of the wire.
    pub fn iter(self) -> impl Iterator<Item = RobotError> {
        RobotError::ALL
            .into_iter()
            .filter(move |&error| self.contains(error))
    }
}

impl FromIterator<RobotError> for Errors {
    fn from_iter<I: IntoIterator<Item = RobotError>>(errors: I) -> Self {
        let mut set = Self::NONE;
        set.extend(errors);
        set
    }
}

impl Extend<RobotError> for Errors {
    fn extend<I: IntoIterator<Item = RobotError>>(&mut self, errors: I) {
        for error in errors {
            self.insert(error);
        }
    }
}

impl From<RobotError> for Errors {
    fn from(error: RobotError) -> Self {
        Self(error.bit())
    }
}

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[")?;
        for (position, error) in self.iter().enumerate() {
            if position > 0 {
                f.write_str(", ")?;
            }
            write!(f, "\"{error}\"")?;
        }
        f.write_str("]")
    }
}

impl fmt::Debug for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn an_error_sits_at_its_index() {
        for (index, error) in RobotError::ALL.into_iter().enumerate() {
            assert_eq!(error.index(), index);
            assert_eq!(RobotError::from_name(error.name()), Some(error));
            let mut flags = [0; 41];
            flags[index] = 0x80;
            assert_eq!(Errors::from_flags(&flags), Errors::from(error));
        }
        assert_eq!(RobotError::from_index(41), None);
        assert_eq!(RobotError::from_name("tau_j_range_violation"), None);
    }

    #[test]
    fn flags_come_back_as_zeros_and_ones() {
        let set: Errors = [RobotError::JointReflex, RobotError::TauJRangeViolation]
            .into_iter()
            .collect();
        let flags = set.to_flags();
        assert_eq!(
            flags.iter().map(|&flag| usize::from(flag)).sum::<usize>(),
            2
        );
        assert_eq!((flags[6], flags[34]), (1, 1));
        assert_eq!(Errors::from_flags(&flags), set);
    }

    #[test]
    fn the_text_is_libfrankas_list() {
        assert_eq!(Errors::NONE.to_string(), "[]");
        let set: Errors = [
            RobotError::CartesianReflex,
            RobotError::CartesianPositionMotionGeneratorInvalidFrameFlag,
            RobotError::JointReflex,
        ]
        .into_iter()
        .collect();
        assert_eq!(
            set.to_string(),
            r#"["joint_reflex", "cartesian_reflex", "cartesian_position_motion_generator_invalid_frame_flag"]"#
        );
    }

    #[test]
    fn foreign_bits_are_dropped() {
        assert_eq!(Errors::from_bits(u64::MAX).len(), 41);
    }
}
