//! Stiffness and damping of the hybrid impedance law.

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

    /// Checks that every gain is finite, not negative and within what a 1 kHz torque loop holds stable on this arm.
    ///
    /// The upper bounds are those of the robot's own impedance commands (3000 N/m, 300 N m/rad) for the end effector,
    /// and ten times the stiff preset for joints and damping.
    ///
    /// # Errors
    /// [`GainError`] names the first gain that is not.
    pub fn check(&self) -> Result<(), GainError> {
        let groups: [(&'static str, &[f64], &dyn Fn(usize) -> f64); 4] = [
            ("end-effector stiffness", &self.cartesian_stiffness, &|i| {
                if i < 3 { 3000.0 } else { 300.0 }
            }),
            ("end-effector damping", &self.cartesian_damping, &|i| {
                if i < 3 { 500.0 } else { 50.0 }
            }),
            ("joint stiffness", &self.joint_stiffness, &|_| 6000.0),
            ("joint damping", &self.joint_damping, &|_| 500.0),
        ];
        for (what, values, most) in groups {
            for (axis, &got) in values.iter().enumerate() {
                let most = most(axis);
                if !(0.0..=most).contains(&got) {
                    return Err(GainError {
                        what,
                        axis,
                        got,
                        most,
                    });
                }
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
    pub(crate) fn to_array(self) -> [f64; 26] {
        let mut all = [0.0; 26];
        all[..6].copy_from_slice(&self.cartesian_stiffness);
        all[6..12].copy_from_slice(&self.cartesian_damping);
        all[12..19].copy_from_slice(&self.joint_stiffness);
        all[19..].copy_from_slice(&self.joint_damping);
        all
    }

    pub(crate) fn from_array(all: [f64; 26]) -> Self {
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
