//! Reasons why a command cannot be sent.

use core::fmt;

/// Reason why a command cannot be sent. The texts are exactly libfranka 0.21's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidCommand {
    /// A torque, or any number of a command after the filter and the limiter, is not finite.
    #[error("Commanding value is infinite or NaN.")]
    NotFinite,
    /// The scalar given to the velocity limiter is not finite.
    #[error("commanded_velocity is infinite or NaN.")]
    Velocity,
    /// The scalar given to the position limiter, for example an elbow's angle, is not finite.
    #[error("commanded_position is infinite or NaN.")]
    Position,
    /// A joint velocity given to the limiter is not finite.
    #[error("commanded_velocities is infinite or NaN.")]
    JointVelocities,
    /// A joint position given to the limiter is not finite.
    #[error("commanded_positions is infinite or NaN.")]
    JointPositions,
    /// A component of the twist given to the limiter is not finite.
    #[error("O_dP_EE_c is infinite or NaN.")]
    Twist,
    /// An element of the pose given to the limiter is not finite.
    #[error("O_T_EE_c is infinite or NaN.")]
    Pose,
    /// The pose given to the limiter is not a homogeneous transformation in column-major order.
    #[error("O_T_EE_c is invalid transformation matrix. Has to be column major!")]
    LimiterTransformation,
    /// The pose after the filter and the limiter is not a homogeneous transformation in
    /// column-major order.
    #[error(
        "libfranka: Attempt to set invalid transformation in motion generator. Has to be column major!"
    )]
    Transformation,
    /// The sign of joint 4 in an elbow is neither -1 nor +1.
    #[error(
        "Invalid elbow configuration given! Only +1 or -1 are allowed for the sign of the 4th joint."
    )]
    ElbowSign,
    /// The low-pass filter refuses an argument.
    #[error("{signal}lowpass-filter: {fault}")]
    Filter {
        /// Kind of signal that could not be filtered.
        signal: Signal,
        /// Fault of the argument.
        fault: FilterFault,
    },
}

/// Kind of signal that a low-pass filter is applied to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// One or more scalars.
    Scalar,
    /// A pose.
    Pose,
}

/// Prints the signal as the prefix of an error text of the filter.
impl fmt::Display for Signal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Scalar => "",
            Self::Pose => "Cartesian ",
        })
    }
}

/// Argument that a low-pass filter refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FilterFault {
    /// The time between two samples is negative or not finite.
    #[error("sample_time is negative, infinite or NaN.")]
    SampleTime,
    /// The cutoff frequency is not positive, or not finite.
    #[error("cutoff_frequency is zero, negative, infinite or NaN.")]
    CutoffFrequency,
    /// The command is not finite, or the value from the state that the filter uses as its last
    /// value is not finite.
    #[error("current or past input value of the signal to be filtered is infinite or NaN.")]
    Value,
}
