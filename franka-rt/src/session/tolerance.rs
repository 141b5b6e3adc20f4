//! Tolerance: the distance from the target within which an arm counts as arrived.

use crate::law::compensation::STATIC_FRICTION;
use crate::law::{Gains, Law};
use crate::session::Controller;

/// Greatest distance from the target, measured at the end effector, at which an arm counts as
/// arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Greatest distance, `[m]`.
    pub translation: f64,
    /// Greatest angle, `[rad]`.
    pub rotation: f64,
}

impl Default for Tolerance {
    /// Returns the tolerance for gains that compensate friction: 1 mm and 3 mrad.
    fn default() -> Self {
        Self {
            translation: 1e-3,
            rotation: 3e-3,
        }
    }
}

impl Tolerance {
    /// Greatest value that [`of`](Self::of) returns: 3 cm and 0.15 rad. Springs that leave larger
    /// errors are too soft to hold an arm in place.
    pub const MOST: Self = Self {
        translation: 0.03,
        rotation: 0.15,
    };

    /// Returns the error that remains under `gains` on an arm with friction. The reference is a
    /// realistic simulated arm (`franka_sim::arm::Family::realistic`). The error is the default
    /// tolerance plus the stretch of the springs under the friction that the gains do not
    /// compensate.
    pub fn of(gains: &Gains) -> Self {
        let left: [f64; 7] =
            core::array::from_fn(|i| (STATIC_FRICTION[i] - gains.compensation[i]).max(0.0));
        let share = (0..7).fold(0.0, |most, i| f64::max(most, left[i] / STATIC_FRICTION[i]));
        if share == 0.0 {
            return Self::default();
        }
        let projected = gains.project_joint_gains || gains.law == Law::OperationalSpace;
        let turned: [f64; 7] = core::array::from_fn(|i| match gains.joint_stiffness[i] {
            // Projected joint springs do not act at the end effector.
            _ if projected => f64::INFINITY,
            _ if left[i] == 0.0 => 0.0,
            stiffness => (left[i] / stiffness).powi(2),
        });
        let of_arm = turned[..4].iter().sum::<f64>().sqrt();
        let of_all = turned.iter().sum::<f64>().sqrt();
        let softest = |axes: &[f64]| axes.iter().copied().fold(f64::INFINITY, f64::min);
        let (linear, angular) = gains.cartesian_stiffness.split_at(3);
        // The springs of the joints and of the end effector act in parallel.
        let beside = |one: f64, other: f64| 1.0 / (1.0 / one + 1.0 / other);
        let Self {
            translation,
            rotation,
        } = Self::default();
        let moved = beside(of_arm * REACH, share * FORCE / softest(linear));
        let turned = beside(of_all, share * TORQUE / softest(angular));
        Self {
            translation: (translation + moved).min(Self::MOST.translation),
            rotation: (rotation + turned).min(Self::MOST.rotation),
        }
    }

    /// Returns the error that remains on an arm with friction under one of the robot's own
    /// controllers with its default impedance, for all kinds of setpoints. Under joint impedance
    /// the error is 2 mm and 5 mrad. Under Cartesian impedance it is 5 mm and 15 mrad.
    pub fn under(controller: Controller) -> Self {
        match controller {
            Controller::JointImpedance => Self {
                translation: 2e-3,
                rotation: 5e-3,
            },
            Controller::CartesianImpedance => Self {
                translation: 5e-3,
                rotation: 15e-3,
            },
        }
    }
}

/// Force and torque at the end effector that correspond to [`STATIC_FRICTION`], `[N]` and `[N m]`.
/// Each is a third more than the 99th percentile of the error under springs alone, multiplied by
/// their stiffness.
const FORCE: f64 = 8.0;
const TORQUE: f64 = 2.0;

/// Distance from the first joints to the end effector, `[m]`.
const REACH: f64 = 0.8;

#[cfg(test)]
mod tests {
    use super::*;

    fn of(gains: Gains) -> (f64, f64) {
        let Tolerance {
            translation,
            rotation,
        } = Tolerance::of(&gains);
        (translation * 1e3, rotation * 1e3)
    }

    /// Compares the tolerances with the 99th percentiles that `arms --law springs` and the other
    /// laws print.
    #[test]
    fn error_left_by_springs_alone_is_within_tolerance() {
        for (gains, [mm, mrad]) in [
            (Gains::cartesian().without_compensation(), [7.7, 25.2]),
            (Gains::joint().without_compensation(), [6.9, 32.4]),
        ] {
            let (translation, rotation) = of(gains);
            assert!(mm < translation && translation < 1.5 * mm, "{translation}");
            assert!(mrad < rotation && rotation < 1.5 * mrad, "{rotation}");
        }
    }

    #[test]
    fn compensation_brings_it_down_to_the_default() {
        let full = Gains::cartesian();
        assert_eq!(Tolerance::of(&full), Tolerance::default());
        let half = Gains {
            compensation: STATIC_FRICTION.map(|friction| 0.5 * friction),
            ..full
        };
        let (none, half) = (of(full.without_compensation()), of(half));
        assert!(1.0 < half.0 && half.0 < none.0, "{half:?} {none:?}");
        assert!(3.0 < half.1 && half.1 < none.1, "{half:?} {none:?}");
    }

    #[test]
    fn soft_and_missing_springs_have_one_too() {
        let most = (30.0, 150.0);
        let mut soft = Gains::cartesian().without_compensation();
        soft.project_joint_gains = true;
        let projected = of(soft);
        assert!(10.0 < projected.0 && projected.0 < 15.0, "{projected:?}");
        soft.cartesian_stiffness = [0.0; 6];
        assert_eq!(of(soft), most);
        soft.project_joint_gains = false;
        soft.joint_stiffness = [0.0; 7];
        assert_eq!(of(soft), most);
        // All joints except one are compensated, and no joint has a spring.
        let mut one = Gains::cartesian();
        (one.joint_stiffness, one.compensation[6]) = ([0.0; 7], 0.0);
        assert!(of(one).0 <= most.0 && of(one).1 <= most.1, "{:?}", of(one));
    }
}
