//! The control law, with its stiffness and damping.

use crate::shaping::{DEFAULT_CUTOFF_FREQUENCY, MAX_CUTOFF_FREQUENCY};

/// Control law that turns the springs and dampers of [`Gains`] into torques.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Law {
    /// Adds the torques of two sets of springs: along the base axes at the end effector, and at the
    /// joints. See [`law`](crate::law#the-hybrid-law).
    #[default]
    Hybrid,
    /// Couples the springs along the base axes by the inertia at the end effector. The joints'
    /// springs act only in the null space of the end effector: see
    /// [`operational`](crate::law::operational).
    OperationalSpace,
}

/// Control law and diagonal gains. Each base axis at the end effector and each joint has a spring
/// and a damper.
///
/// Each goal brings its own gains. When the goal changes, all gains change gradually, so that the
/// torque does not jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Control law that uses the gains.
    pub law: Law,
    /// End-effector stiffness along x, y, z `[N/m]`, and about x, y, z `[N m/rad]`.
    pub cartesian_stiffness: [f64; 6],
    /// End-effector damping along x, y, z `[N s/m]`, and about x, y, z `[N m s/rad]`.
    pub cartesian_damping: [f64; 6],
    /// Joint stiffness, `[N m/rad]`.
    pub joint_stiffness: [f64; 7],
    /// Joint damping, `[N m s/rad]`.
    pub joint_damping: [f64; 7],
    /// Weight of the reference velocity in the dampers, between 0 and 1. At 1 the dampers act on
    /// the velocity error, so they do not make the arm lag behind a moving reference. At 0 they
    /// oppose all motion.
    pub feedforward: f64,
    /// Cutoff frequency of the first-order low-pass on the reference velocity, `[Hz]`. At 1000 the
    /// filter is off, as in libfranka.
    pub feedforward_cutoff: f64,
    /// True if the joints' springs and dampers act only in the null space of the end effector.
    /// There they move the elbow but do not push the hand. With [`Law::OperationalSpace`] they
    /// always act there.
    pub project_joint_gains: bool,
    /// Largest torque that may compensate friction and bias at each joint, `[N m]`. Zero disables
    /// the compensation. Without compensation, friction stops the arm millimetres from its target.
    pub compensation: [f64; 7],
    /// Largest sum of the torques of springs, dampers and compensation at each joint, `[N m]`,
    /// including the torques of the motion itself. The commanded torque, which excludes gravity,
    /// stays below this limit. Only the torque that brakes a joint above its speed limit may be
    /// larger.
    pub torque_limits: [f64; 7],
    /// Cutoff frequency of the first-order low-pass on the torques, `[Hz]`. At 1000 the filter is
    /// off. A lower frequency makes the arm quieter but reduces the stability
    /// [`Margin`](crate::session::Margin).
    pub torque_cutoff: f64,
}

/// Caller: a gain is outside its bounds.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what}{} is {got}, expected between {least} and {most}", of_axis(*.axis))]
#[non_exhaustive]
pub struct GainError {
    /// Name of the group of gains.
    pub what: &'static str,
    /// Position of the number in its group, from 1; `None` for a single number.
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
    /// and 300 N m/rad. The bounds of joint stiffness and of damping are far above the presets. No
    /// real robot has been tested with all axes at these values. The compensation may exceed its
    /// default on every joint; the torque limits may not exceed theirs.
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
    /// simulated arms (`franka_sim::arm::Family::bad`), the bias of their torque sensors, and half
    /// a kilogram of undeclared load.
    pub const COMPENSATION: [f64; 7] = [5.0, 6.0, 5.0, 7.0, 4.0, 4.0, 2.0];

    /// Default of [`torque_limits`](Self::torque_limits), `[N m]`: just below the joints' own
    /// limits, 87 and 12 N m.
    pub const TORQUE_LIMITS: [f64; 7] = [86.0, 86.0, 86.0, 86.0, 11.5, 11.5, 11.5];

    /// Length of the array that [`to_array`](Self::to_array) returns.
    pub(crate) const NUMBERS: usize = 45;

    /// Returns gains for a compliant end effector: 750 N/m and 60 N m/rad, with light joint springs
    /// that hold the elbow. A softer wrist would slip by several milliradians when its friction
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

    /// Returns gains for policies that were trained on DROID data. They are compliant like
    /// [`cartesian`](Self::cartesian), but have the softer wrist and the lighter damping of the
    /// DROID platform, and neither feedforward nor compensation.
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
    /// whose torques lag by 10 ms would begin to oscillate.
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

    /// Returns the same gains without compensation: only the springs act against friction and bias.
    #[must_use]
    pub const fn without_compensation(self) -> Self {
        Self {
            compensation: [0.0; 7],
            ..self
        }
    }

    /// Returns the same gains with a different stiffness at the end effector, in base axes. The
    /// damping scales with the square root of the stiffness, so the damping ratio does not change.
    /// An axis that had no stiffness gets the damping ratio of [`Gains::cartesian`].
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
    /// Returns a [`GainError`] that names the first number outside its bounds.
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

    /// Returns all numbers: first springs and dampers, then the choices, the compensation, and the
    /// filters and limits of the torques.
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
