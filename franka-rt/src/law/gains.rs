//! The control law, and its stiffness and damping.

use crate::shaping::{DEFAULT_CUTOFF_FREQUENCY, MAX_CUTOFF_FREQUENCY};

/// Law that turns the springs and dampers of [`Gains`] into torques.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Law {
    /// Springs along the base axes and at the joints, summed in joint space: see
    /// [`law`](crate::law#the-hybrid-law).
    #[default]
    Hybrid,
    /// Springs along the base axes, coupled by the inertia at the end effector; the joints' springs
    /// act in its null space: see [`operational`](crate::law::operational).
    OperationalSpace,
}

/// Law and diagonal gains: a spring and damper at the end effector, along the axes of the base
/// frame, and one at each joint.
///
/// A goal replaces all of them. Between two goals every number cross-fades, including the choices,
/// so that no change steps the torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// The law that uses the gains.
    pub law: Law,
    /// End-effector stiffness, x y z `[N/m]` and about x y z `[N m/rad]`.
    pub cartesian_stiffness: [f64; 6],
    /// End-effector damping, `[N s/m]` and `[N m s/rad]`.
    pub cartesian_damping: [f64; 6],
    /// Joint stiffness, `[N m/rad]`.
    pub joint_stiffness: [f64; 7],
    /// Joint damping, `[N m s/rad]`.
    pub joint_damping: [f64; 7],
    /// Weight of the reference velocity in the dampers, between 0 and 1. At 1 the dampers oppose
    /// only the velocity error, so they do not make the arm lag behind a moving reference. At 0
    /// they oppose all motion.
    pub feedforward: f64,
    /// Cutoff frequency of the first-order low-pass on that reference velocity, `[Hz]`. At 1000 the
    /// filter is off, as in libfranka.
    pub feedforward_cutoff: f64,
    /// True if the joints' springs and dampers act only in the null space of the end effector.
    /// There they move the elbow but do not push at the hand. [`Law::OperationalSpace`] always does
    /// this.
    pub project_joint_gains: bool,
    /// Largest torque against friction and bias at each joint, `[N m]`; zero for none. With springs
    /// alone, friction keeps the arm millimetres from its target.
    pub compensation: [f64; 7],
    /// Largest torque of springs, dampers and compensation together at each joint, including the
    /// torques of the motion itself, `[N m]`. The commanded torque, which excludes gravity, stays
    /// below this limit. Only the brake of a joint that is too fast may use more.
    pub torque_limits: [f64; 7],
    /// Cutoff frequency of the first-order low-pass on the torques, `[Hz]`; at 1000 the filter is
    /// off. A lower frequency is quieter, and reduces the stability
    /// [`Margin`](crate::session::Margin).
    pub torque_cutoff: f64,
}

/// Caller: a gain is out of its bounds.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what}{} is {got}, expected between {least} and {most}", of_axis(*.axis))]
#[non_exhaustive]
pub struct GainError {
    /// Group of gains.
    pub what: &'static str,
    /// Position of the number in the group, from 1; `None` for a single number.
    pub axis: Option<usize>,
    /// The given value.
    pub got: f64,
    /// The lowest accepted value.
    pub least: f64,
    /// The highest accepted value.
    pub most: f64,
}

fn of_axis(axis: Option<usize>) -> String {
    axis.map_or(String::new(), |axis| format!(" of axis {axis}"))
}

impl Gains {
    /// Lowest values that [`check`](Self::check) accepts.
    pub const LEAST: Self = Self {
        law: Law::Hybrid,
        cartesian_stiffness: [0.0; 6],
        cartesian_damping: [0.0; 6],
        joint_stiffness: [0.0; 7],
        joint_damping: [0.0; 7],
        feedforward: 0.0,
        feedforward_cutoff: 1.0,
        project_joint_gains: false,
        compensation: [0.0; 7],
        torque_limits: [1.0; 7],
        torque_cutoff: 20.0,
    };

    /// Highest values that [`check`](Self::check) accepts.
    ///
    /// Stiffness at the end effector has the bounds of the robot's own impedance commands, 3000 N/m
    /// and 300 N m/rad. The bounds of joints and damping are ten times the stiff preset. These
    /// values were never tried on every axis at once on hardware. The bound of the compensation is
    /// twice the default and more. The bound of the torques is the default.
    pub const MOST: Self = Self {
        law: Law::OperationalSpace,
        cartesian_stiffness: [3000.0, 3000.0, 3000.0, 300.0, 300.0, 300.0],
        cartesian_damping: [500.0, 500.0, 500.0, 50.0, 50.0, 50.0],
        joint_stiffness: [6000.0; 7],
        joint_damping: [500.0; 7],
        feedforward: 1.0,
        feedforward_cutoff: MAX_CUTOFF_FREQUENCY,
        project_joint_gains: true,
        compensation: [10.0, 10.0, 10.0, 10.0, 5.0, 5.0, 5.0],
        torque_limits: Self::TORQUE_LIMITS,
        torque_cutoff: MAX_CUTOFF_FREQUENCY,
    };

    /// Default of [`compensation`](Self::compensation). It covers the friction of the worst
    /// simulated arms (`franka_sim::arm::Family::bad`), and the torques of half an undeclared
    /// kilogram and of their torque sensors.
    pub const COMPENSATION: [f64; 7] = [5.0, 6.0, 5.0, 7.0, 4.0, 4.0, 2.0];

    /// Default of [`torque_limits`](Self::torque_limits), `[N m]`: just inside the 87 and 12 N m
    /// that the joints can exert.
    pub const TORQUE_LIMITS: [f64; 7] = [86.0, 86.0, 86.0, 86.0, 11.5, 11.5, 11.5];

    /// Length of the array that [`to_array`](Self::to_array) returns.
    pub(crate) const NUMBERS: usize = 45;

    /// Returns gains with a compliant end effector: 750 N/m and 60 N m/rad, with light joint
    /// springs that hold the elbow. A softer wrist slips by several milliradians when its friction
    /// breaks loose.
    pub const fn cartesian() -> Self {
        Self {
            law: Law::Hybrid,
            cartesian_stiffness: [750.0, 750.0, 750.0, 60.0, 60.0, 60.0],
            cartesian_damping: [50.0, 50.0, 90.0, 3.0, 3.0, 3.0],
            joint_stiffness: [40.0, 30.0, 50.0, 25.0, 35.0, 25.0, 10.0],
            joint_damping: [4.0, 6.0, 5.0, 5.0, 3.0, 2.0, 1.0],
            feedforward: 1.0,
            feedforward_cutoff: MAX_CUTOFF_FREQUENCY,
            project_joint_gains: false,
            compensation: Self::COMPENSATION,
            torque_limits: Self::TORQUE_LIMITS,
            torque_cutoff: DEFAULT_CUTOFF_FREQUENCY,
        }
    }

    /// Returns compliant gains like [`cartesian`](Self::cartesian), with the softer wrist and the
    /// lighter damping of the DROID platform, without feedforward and compensation. For a policy
    /// that was trained on DROID data.
    pub const fn droid() -> Self {
        Self {
            cartesian_stiffness: [750.0, 750.0, 750.0, 15.0, 15.0, 15.0],
            cartesian_damping: [37.0, 37.0, 37.0, 2.0, 2.0, 2.0],
            feedforward: 0.0,
            compensation: [0.0; 7],
            ..Self::cartesian()
        }
    }

    /// Returns gains with stiff joints and no spring at the end effector. With more damping, arms
    /// whose torques lag by 10 ms begin to oscillate.
    pub const fn joint() -> Self {
        Self {
            law: Law::Hybrid,
            cartesian_stiffness: [0.0; 6],
            cartesian_damping: [0.0; 6],
            joint_stiffness: [300.0, 300.0, 300.0, 300.0, 125.0, 75.0, 25.0],
            joint_damping: [20.0, 20.0, 20.0, 20.0, 12.0, 10.0, 6.0],
            feedforward: 1.0,
            feedforward_cutoff: MAX_CUTOFF_FREQUENCY,
            project_joint_gains: false,
            compensation: Self::COMPENSATION,
            torque_limits: Self::TORQUE_LIMITS,
            torque_cutoff: DEFAULT_CUTOFF_FREQUENCY,
        }
    }

    /// Returns the same gains without compensation: springs alone act against friction and bias.
    #[must_use]
    pub const fn without_compensation(self) -> Self {
        Self {
            compensation: [0.0; 7],
            ..self
        }
    }

    /// Returns the same gains with another stiffness at the end effector, base axes. The damping
    /// scales with the square root of the stiffness, which keeps the damping ratio. An axis without
    /// stiffness gets the damping ratio of [`Gains::cartesian`].
    #[must_use]
    pub fn with_cartesian_stiffness(self, stiffness: [f64; 6]) -> Self {
        let preset = Self::cartesian();
        let damping = core::array::from_fn(|i| {
            let from = if self.cartesian_stiffness[i] > 0.0 {
                &self
            } else {
                &preset
            };
            from.cartesian_damping[i] * (stiffness[i] / from.cartesian_stiffness[i]).sqrt()
        });
        Self {
            cartesian_stiffness: stiffness,
            cartesian_damping: damping,
            ..self
        }
    }

    /// Checks that every number lies between its values in [`LEAST`](Self::LEAST) and
    /// [`MOST`](Self::MOST).
    ///
    /// # Errors
    /// [`GainError`] names the first number out of bounds.
    pub fn check(&self) -> Result<(), GainError> {
        let (least, most) = (Self::LEAST.to_array(), Self::MOST.to_array());
        for (i, got) in self.to_array().into_iter().enumerate() {
            if !(least[i]..=most[i]).contains(&got) {
                let (what, axis) = match i {
                    0..3 => ("end-effector stiffness [N/m]", Some(i + 1)),
                    3..6 => ("end-effector stiffness [N m/rad]", Some(i + 1)),
                    6..9 => ("end-effector damping [N s/m]", Some(i - 5)),
                    9..12 => ("end-effector damping [N m s/rad]", Some(i - 5)),
                    12..19 => ("joint stiffness [N m/rad]", Some(i - 11)),
                    19..26 => ("joint damping [N m s/rad]", Some(i - 18)),
                    26 => ("feedforward weight", None),
                    30..37 => ("compensation [N m]", Some(i - 29)),
                    37..44 => ("torque limit [N m]", Some(i - 36)),
                    44.. => ("torque cutoff frequency [Hz]", None),
                    _ => ("feedforward cutoff frequency [Hz]", None),
                };
                return Err(GainError {
                    what,
                    axis,
                    got,
                    least: least[i],
                    most: most[i],
                });
            }
        }
        Ok(())
    }

    /// Returns all numbers: springs and dampers first, then choices, compensation, and the filters
    /// and limits of the torques.
    pub(crate) fn to_array(self) -> [f64; Self::NUMBERS] {
        let mut all = [0.0; Self::NUMBERS];
        all[..6].copy_from_slice(&self.cartesian_stiffness);
        all[6..12].copy_from_slice(&self.cartesian_damping);
        all[12..19].copy_from_slice(&self.joint_stiffness);
        all[19..26].copy_from_slice(&self.joint_damping);
        all[26] = self.feedforward;
        all[27] = self.feedforward_cutoff;
        all[28] = f64::from(u8::from(self.project_joint_gains));
        all[29] = f64::from(u8::from(self.law == Law::OperationalSpace));
        all[30..37].copy_from_slice(&self.compensation);
        all[37..44].copy_from_slice(&self.torque_limits);
        all[44] = self.torque_cutoff;
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_stiffness_keeps_the_damping_ratio() {
        let soft =
            Gains::cartesian().with_cartesian_stiffness([187.5, 750.0, 750.0, 15.0, 60.0, 240.0]);
        assert_eq!(soft.cartesian_damping, [25.0, 50.0, 90.0, 1.5, 3.0, 6.0]);
        let from_joints = Gains::joint().with_cartesian_stiffness([750.0; 6]);
        assert_eq!(from_joints.cartesian_damping[0], 50.0);
    }

    #[test]
    fn presets_pass_their_own_check_and_bad_gains_are_named() {
        Gains::cartesian().check().unwrap();
        Gains::droid().check().unwrap();
        Gains::joint().check().unwrap();
        let mut gains = Gains::cartesian();
        gains.cartesian_stiffness[4] = 301.0;
        let error = gains.check().unwrap_err();
        assert_eq!(
            error.to_string(),
            "end-effector stiffness [N m/rad] of axis 5 is 301, expected between 0 and 300"
        );
        gains = Gains::joint();
        gains.joint_damping[6] = f64::NAN;
        assert_eq!(gains.check().unwrap_err().axis, Some(7));
        gains = Gains::droid();
        gains.feedforward = -0.1;
        assert_eq!(gains.check().unwrap_err().what, "feedforward weight");
        gains = Gains::droid();
        gains.compensation[3] = -1.0;
        let error = gains.check().unwrap_err();
        assert_eq!((error.what, error.axis), ("compensation [N m]", Some(4)));
        gains = Gains::droid();
        gains.feedforward_cutoff = 0.0;
        assert_eq!(
            gains.check().unwrap_err().to_string(),
            "feedforward cutoff frequency [Hz] is 0, expected between 1 and 1000"
        );
    }

    #[test]
    fn the_bounds_themselves_are_within_bounds() {
        for gains in [Gains::LEAST, Gains::MOST, Gains::droid()] {
            gains.check().unwrap();
        }
    }
}
