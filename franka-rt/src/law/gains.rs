//! Stiffness and damping of the hybrid impedance law.

use crate::session::Free;

/// Diagonal gains of the hybrid impedance law: a spring and damper at the end effector, along the axes of the base
/// frame, and one at each joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// End-effector stiffness, x y z `[N/m]` and about x y z `[N m/rad]`.
    pub cartesian_stiffness: [f64; 6],
    /// End-effector damping, `[N s/m]` and `[N m s/rad]`.
    pub cartesian_damping: [f64; 6],
    /// Joint stiffness, `[N m/rad]`.
    pub joint_stiffness: [f64; 7],
    /// Joint damping, `[N m s/rad]`.
    pub joint_damping: [f64; 7],
}

/// A gain that no law should run with.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} of axis {axis} is {got}, expected between 0 and {most}")]
#[non_exhaustive]
pub struct GainError {
    /// The group of gains.
    pub what: &'static str,
    /// Index in the group, from 0.
    pub axis: usize,
    /// The value given.
    pub got: f64,
    /// The highest value accepted.
    pub most: f64,
}

impl Gains {
    /// How many numbers there are in all.
    pub(crate) const NUMBERS: usize = 26;

    /// Compliant at the end effector: 750 N/m and 15 N m/rad, with light joint springs that keep the elbow.
    pub const fn cartesian() -> Self {
        Self {
            cartesian_stiffness: [750.0, 750.0, 750.0, 15.0, 15.0, 15.0],
            cartesian_damping: [50.0, 50.0, 90.0, 2.0, 2.0, 2.0],
            joint_stiffness: [40.0, 30.0, 50.0, 25.0, 35.0, 25.0, 10.0],
            joint_damping: [4.0, 6.0, 5.0, 5.0, 3.0, 2.0, 1.0],
        }
    }

    /// Stiff joints, no spring at the end effector.
    pub const fn joint() -> Self {
        Self {
            cartesian_stiffness: [0.0; 6],
            cartesian_damping: [0.0; 6],
            joint_stiffness: [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0],
            joint_damping: [50.0, 50.0, 50.0, 50.0, 30.0, 25.0, 15.0],
        }
    }

    /// For hand guiding: springs at the end effector as by [`Self::cartesian`] on the axes that are not free, and a light
    /// damping of the joints.
    pub fn guiding(free: Free) -> Self {
        let preset = Self::cartesian();
        let locked =
            |gains: [f64; 6]| core::array::from_fn(|i| if free.axes[i] { 0.0 } else { gains[i] });
        Self {
            cartesian_stiffness: locked(preset.cartesian_stiffness),
            cartesian_damping: locked(preset.cartesian_damping),
            joint_stiffness: preset.joint_stiffness,
            joint_damping: [1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5],
        }
    }

    /// The same gains with another stiffness at the end effector, base axes. Its damping scales with the square root, which
    /// keeps the damping ratio; an axis without stiffness takes its damping ratio from [`Gains::cartesian`].
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

    /// Checks that every gain is finite, not negative and within what a 1 kHz torque loop holds stable on this arm.
    ///
    /// The upper bounds are those of the robot's own impedance commands (3000 N/m, 300 N m/rad) for the end effector,
    /// and ten times the stiff preset for joints and damping.
    ///
    /// # Errors
    /// [`GainError`] names the first gain that is not.
    pub fn check(&self) -> Result<(), GainError> {
        let end_effector = |axis: usize, linear, angular| if axis < 3 { linear } else { angular };
        let most_of = |i: usize| match i {
            0..6 => ("end-effector stiffness", i, end_effector(i, 3000.0, 300.0)),
            6..12 => (
                "end-effector damping",
                i - 6,
                end_effector(i - 6, 500.0, 50.0),
            ),
            12..19 => ("joint stiffness", i - 12, 6000.0),
            _ => ("joint damping", i - 19, 500.0),
        };
        for (i, got) in self.to_array().into_iter().enumerate() {
            let (what, axis, most) = most_of(i);
            if !(0.0..=most).contains(&got) {
                return Err(GainError {
                    what,
                    axis,
                    got,
                    most,
                });
            }
        }
        Ok(())
    }

    /// The gains at `share` of the way to `other`, linearly: each stays between its two ends.
    pub(crate) fn blend(&self, other: &Self, share: f64) -> Self {
        let (a, b) = (self.to_array(), other.to_array());
        Self::from_array(core::array::from_fn(|i| a[i] + share * (b[i] - a[i])))
    }

    /// All gains in the order of the fields.
    pub(crate) fn to_array(self) -> [f64; Self::NUMBERS] {
        let mut all = [0.0; Self::NUMBERS];
        all[..6].copy_from_slice(&self.cartesian_stiffness);
        all[6..12].copy_from_slice(&self.cartesian_damping);
        all[12..19].copy_from_slice(&self.joint_stiffness);
        all[19..].copy_from_slice(&self.joint_damping);
        all
    }

    pub(crate) fn from_array(all: [f64; Self::NUMBERS]) -> Self {
        Self {
            cartesian_stiffness: core::array::from_fn(|i| all[i]),
            cartesian_damping: core::array::from_fn(|i| all[6 + i]),
            joint_stiffness: core::array::from_fn(|i| all[12 + i]),
            joint_damping: core::array::from_fn(|i| all[19 + i]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_stiffness_keeps_the_damping_ratio() {
        let soft =
            Gains::cartesian().with_cartesian_stiffness([187.5, 750.0, 750.0, 15.0, 15.0, 60.0]);
        assert_eq!(soft.cartesian_damping, [25.0, 50.0, 90.0, 2.0, 2.0, 4.0]);
        let from_joints = Gains::joint().with_cartesian_stiffness([750.0; 6]);
        assert_eq!(from_joints.cartesian_damping[0], 50.0);
    }

    #[test]
    fn presets_pass_their_own_check_and_bad_gains_are_named() {
        Gains::cartesian().check().unwrap();
        Gains::joint().check().unwrap();
        let mut gains = Gains::cartesian();
        gains.cartesian_stiffness[4] = 301.0;
        let error = gains.check().unwrap_err();
        assert_eq!(
            error.to_string(),
            "end-effector stiffness of axis 4 is 301, expected between 0 and 300"
        );
        gains = Gains::joint();
        gains.joint_damping[6] = f64::NAN;
        assert_eq!(gains.check().unwrap_err().axis, 6);
    }
}
