//! Filter, limiter and check of a control function's commands. For torques, the limiter bounds the
//! rate. As in libfranka, the limiter is on by default for an FER, and off for an FR3.

#[cfg(test)]
mod tests;

use franka_model::limits::JointLimits;
use franka_proto::{RobotState, Version};

use crate::control::{
    CartesianPose, CartesianVelocities, JointPositions, JointVelocities, Torques,
};
use crate::shaping::rotation::Rigid;
use crate::shaping::{
    Bounds, CYCLE, DEFAULT_CUTOFF_FREQUENCY, InvalidCommand, MAX_CUTOFF_FREQUENCY, VelocityBounds,
    check, filter, limiter,
};

/// Shapes the commands of a control loop: applies the low-pass filter, the limiter and the check,
/// in this order.
///
/// ```
/// use franka_proto::{RobotState, Version};
/// use franka_rt::control::{Shaper, Torques};
///
/// let state = RobotState::default();
/// let shaper = Shaper::new(Version::V10, true, 1000.0);
/// let sent = shaper.torques(&Torques([87.0; 7]), &state)?;
/// assert!((sent.0[0] - 0.999_999).abs() < 1e-12); // 1000 N m/s, less the margin, for 1 ms
/// # Ok::<(), franka_rt::shaping::InvalidCommand>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaper {
    bounds: Bounds,
    /// Joint limits for the bounds that depend on position.
    limits: Option<JointLimits>,
    limit_rate: bool,
    cutoff_frequency: f64,
    start: FirstReference,
    echo: Echo,
}

/// Value with which the filter and the limiter compare the first position or pose of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FirstReference {
    /// The command itself, so that the command passes unchanged if the state is at rest (libfranka
    /// 0.21).
    Itself,
    /// The state, as for all later commands (libfranka 0.9).
    State,
}

/// Precision with which the state echoes the last torques.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Echo {
    /// The echo equals the sent torques, or is assumed to.
    Exact,
    /// The echo is rounded to `f32`. The bound of the rate leaves room for the rounding.
    Rounded,
}

/// Differences between the control loops of libfranka 0.9 and 0.21.
struct Conventions {
    bounds: Bounds,
    limit_rate: bool,
    start: FirstReference,
    echo: Echo,
}

impl Conventions {
    fn of(version: Version) -> Self {
        match version {
            Version::V5 => Self {
                bounds: Bounds::fer(),
                limit_rate: true,
                start: FirstReference::State,
                echo: Echo::Exact,
            },
            Version::V10 => Self {
                bounds: Bounds::fr3(),
                limit_rate: false,
                start: FirstReference::Itself,
                echo: Echo::Rounded,
            },
        }
    }
}

impl Shaper {
    /// Returns the shaper for a robot that speaks `version`. It limits commands if `limit_rate` is
    /// true, and filters them if `cutoff_frequency`, `[Hz]`, is below [`MAX_CUTOFF_FREQUENCY`].
    ///
    /// If the cutoff frequency is not positive, the first command returns an error, as in
    /// libfranka. If it is NaN, the first command also returns an error, whereas libfranka does not
    /// filter.
    pub fn new(version: Version, limit_rate: bool, cutoff_frequency: f64) -> Self {
        let Conventions {
            bounds,
            start,
            echo,
            ..
        } = Conventions::of(version);
        Self {
            bounds,
            limits: None,
            limit_rate,
            cutoff_frequency,
            start,
            echo,
        }
    }

    /// Returns the default shaper of libfranka's control loops: with [`DEFAULT_CUTOFF_FREQUENCY`],
    /// and with a limiter if [`limits_by_default`](Self::limits_by_default) is true.
    pub fn by_default(version: Version) -> Self {
        let limit_rate = Self::limits_by_default(version);
        Self::new(version, limit_rate, DEFAULT_CUTOFF_FREQUENCY)
    }

    /// True if libfranka's control loops limit commands by default. They do so for the FER
    /// (libfranka up to 0.9), but not for the FR3.
    pub fn limits_by_default(version: Version) -> bool {
        Conventions::of(version).limit_rate
    }

    /// Replaces the bounds. By default, the version determines the bounds.
    #[must_use]
    pub fn with_bounds(mut self, bounds: Bounds) -> Self {
        self.bounds = bounds;
        self.limited()
    }

    /// Uses the joint velocity limits in `joints`, which come from the robot's description. They
    /// also replace the limits in bounds that [`with_bounds`](Self::with_bounds) sets later. Has no
    /// effect if the velocity limits of the bounds do not depend on position.
    #[must_use]
    pub fn with_limits_of(mut self, joints: &JointLimits) -> Self {
        self.limits = Some(*joints);
        self.limited()
    }

    fn limited(mut self) -> Self {
        if let (Some(joints), VelocityBounds::Envelope { .. }) =
            (&self.limits, &self.bounds.joint_velocity)
        {
            self.bounds = self.bounds.with_envelope_of(joints);
        }
        self
    }

    /// Limits torque rates without a margin for the rounding of `tau_J_d`, the echoed torques.
    /// libfranka does the same: see [`limiter::within_echo`]. Only protocol 10 rounds the echo.
    #[must_use]
    pub fn trusting_the_echo(mut self) -> Self {
        self.echo = Echo::Exact;
        self
    }

    /// Shapes torques. The last torques are `tau_J_d` of the state.
    ///
    /// # Errors
    /// Returns [`InvalidCommand`] if a number of the command or of the last commanded values is not
    /// finite.
    pub fn torques(
        &self,
        command: &Torques,
        state: &RobotState,
    ) -> Result<Torques, InvalidCommand> {
        let last = &state.tau_J_d;
        let mut tau = self.filtered(&command.0, last)?;
        if self.limit_rate {
            let bounds = self.bounds.torque_rate;
            let bounds = match self.echo {
                Echo::Exact => bounds,
                Echo::Rounded => core::array::from_fn(|i| limiter::within_echo(bounds[i], last[i])),
            };
            tau = limiter::torques(&tau, last, &bounds)?;
        }
        check::finite(&tau)?;
        Ok(Torques(tau))
    }

    /// Shapes joint positions. The last positions are `q_d` of the state, which also contains their
    /// derivatives. `first` is true for the first command of the motion.
    ///
    /// # Errors
    /// Returns the errors of [`torques`](Self::torques).
    pub fn joint_positions(
        &self,
        command: &JointPositions,
        state: &RobotState,
        first: bool,
    ) -> Result<JointPositions, InvalidCommand> {
        let last = if self.starts_itself(first) {
            &command.0
        } else {
            &state.q_d
        };
        let mut q = self.filtered(&command.0, last)?;
        if self.limit_rate {
            let bounds = self.bounds.joints_at(last);
            q = limiter::joint_positions(&bounds, &q, last, &state.dq_d, &state.ddq_d)?;
        }
        check::finite(&q)?;
        Ok(JointPositions(q))
    }

    /// Shapes joint velocities. The last velocities are `dq_d` of the state, which also contains
    /// their derivatives.
    ///
    /// # Errors
    /// Returns the errors of [`torques`](Self::torques).
    pub fn joint_velocities(
        &self,
        command: &JointVelocities,
        state: &RobotState,
    ) -> Result<JointVelocities, InvalidCommand> {
        let mut dq = self.filtered(&command.0, &state.dq_d)?;
        if self.limit_rate {
            let bounds = self.bounds.joints_at(&state.q_d);
            dq = limiter::joint_velocities(&bounds, &dq, &state.dq_d, &state.ddq_d)?;
        }
        check::finite(&dq)?;
        Ok(JointVelocities(dq))
    }

    /// Shapes a pose. The last pose is [`RobotState::commanded_pose`], and the last elbow is
    /// [`RobotState::commanded_elbow`]. The state also contains their derivatives. `first` is true
    /// for the first command of the motion.
    ///
    /// # Errors
    /// Returns the errors of [`torques`](Self::torques), or an error if the pose is not a
    /// transformation or the elbow has no sign.
    pub fn cartesian_pose(
        &self,
        command: &CartesianPose,
        state: &RobotState,
        first: bool,
    ) -> Result<CartesianPose, InvalidCommand> {
        let starts = self.starts_itself(first);
        let last = if starts {
            &command.O_T_EE
        } else {
            state.commanded_pose()
        };
        let pose = self.pose(&command.O_T_EE, last, state)?;
        check::pose(&pose)?;
        // The filter turns any matrix into a rotation. libfranka sends that rotation instead of an
        // error.
        if pose != command.O_T_EE {
            check::pose(&command.O_T_EE)?;
        }
        Ok(CartesianPose {
            O_T_EE: pose,
            elbow: self.elbow(command.elbow, state, starts)?,
        })
    }

    /// Shapes a twist. The last twist is `O_dP_EE_c` of the state, and the last elbow is
    /// [`RobotState::commanded_elbow`]. The state also contains their derivatives.
    ///
    /// # Errors
    /// Returns the errors of [`torques`](Self::torques), or an error if the elbow has no sign.
    pub fn cartesian_velocities(
        &self,
        command: &CartesianVelocities,
        state: &RobotState,
    ) -> Result<CartesianVelocities, InvalidCommand> {
        let mut twist = self.filtered(&command.O_dP_EE, &state.O_dP_EE_c)?;
        if self.limit_rate {
            twist = limiter::cartesian_velocity(
                &self.bounds.cartesian,
                &twist,
                &state.O_dP_EE_c,
                &state.O_ddP_EE_c,
            )?;
        }
        check::finite(&twist)?;
        Ok(CartesianVelocities {
            O_dP_EE: twist,
            elbow: self.elbow(command.elbow, state, false)?,
        })
    }

    /// Filters and limits a pose. Both steps need the nearest rotations of their poses, which take
    /// a large share of the time. So the second step reuses the rotations from the first.
    fn pose(
        &self,
        command: &[f64; 16],
        last: &[f64; 16],
        state: &RobotState,
    ) -> Result<[f64; 16], InvalidCommand> {
        if !self.filters() && !self.limit_rate {
            return Ok(*command);
        }
        let rigid_last = Rigid::nearest(last);
        let (pose, rigid) = if self.filters() {
            let cutoff = self.cutoff_frequency;
            let rigid = filter::low_pass_rigid(CYCLE, command, last, &rigid_last, cutoff)?;
            (rigid.pose(), rigid)
        } else {
            (*command, Rigid::nearest(command))
        };
        if !self.limit_rate {
            return Ok(pose);
        }
        limiter::limit_rigid(
            &self.bounds.cartesian,
            &pose,
            &rigid,
            &rigid_last,
            &state.O_dP_EE_c,
            &state.O_ddP_EE_c,
        )
    }

    /// Shapes the angle of an elbow and keeps the sign. As in the protocol, two zeros mean that
    /// there is no elbow.
    fn elbow(
        &self,
        command: Option<[f64; 2]>,
        state: &RobotState,
        starts: bool,
    ) -> Result<Option<[f64; 2]>, InvalidCommand> {
        let Some(mut elbow) = command.filter(|elbow| *elbow != [0.0, 0.0]) else {
            return Ok(None);
        };
        let last = if starts {
            elbow[0]
        } else {
            state.commanded_elbow()[0]
        };
        [elbow[0]] = self.filtered(&[elbow[0]], &[last])?;
        if self.limit_rate {
            let (velocity, acceleration) = (state.delbow_c[0], state.ddelbow_c[0]);
            elbow[0] =
                limiter::position(&self.bounds.elbow, elbow[0], last, velocity, acceleration)?;
        }
        check::elbow(&elbow)?;
        Ok(Some(elbow))
    }

    fn starts_itself(&self, first: bool) -> bool {
        first && self.start == FirstReference::Itself
    }

    fn filters(&self) -> bool {
        // NaN passes on to the filter, which refuses it.
        self.cutoff_frequency < MAX_CUTOFF_FREQUENCY || self.cutoff_frequency.is_nan()
    }

    fn filtered<const N: usize>(
        &self,
        command: &[f64; N],
        last: &[f64; N],
    ) -> Result<[f64; N], InvalidCommand> {
        if self.filters() {
            filter::low_pass_each(CYCLE, command, last, self.cutoff_frequency)
        } else {
            Ok(*command)
        }
    }
}
