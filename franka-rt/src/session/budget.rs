//! Speed limits of an approach: for each joint, and for the norms of translation and rotation.

use franka_model::limits::{CartesianLimits, JointLimits, MotionLimits};
use franka_model::{Model, Twist};
use franka_otg::AxisLimits;
use nalgebra::Vector3;

use crate::session::GoalError;

/// Limits of the reference, which set the speed of the approach to a goal.
///
/// A stop may use more acceleration and jerk than the budget, up to the robot's limits. The same
/// holds for a goal that begins while the arm moves faster than the goal's budget allows. On the
/// way to a pose, each joint may use three times its velocity limit in the budget, and the robot's
/// acceleration limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Limits of each joint, `[rad/s, rad/s^2, rad/s^3]`.
    pub joints: [AxisLimits; 7],
    /// Limits of the norm of the end effector's translation, `[m/s, m/s^2, m/s^3]`.
    pub translation: AxisLimits,
    /// Limits of the norm of the end effector's rotation, `[rad/s, rad/s^2, rad/s^3]`.
    pub rotation: AxisLimits,
}

impl Budget {
    /// Share of the robot's joint limits that the default budget uses.
    pub const JOINT_SHARE: f64 = 0.2;

    /// Returns the default budget. Joints get a fifth of the robot's limits. Translation gets 0.3
    /// m/s, 0.5 m/s^2 and 20 m/s^3; rotation gets 0.5 rad/s, 1 rad/s^2 and 20 rad/s^3. A person
    /// next to the arm can follow and stop a motion of this speed.
    pub fn of(limits: &JointLimits) -> Self {
        Self {
            joints: core::array::from_fn(|i| AxisLimits {
                velocity: Self::JOINT_SHARE * limits.velocity[i],
                acceleration: Self::JOINT_SHARE * limits.acceleration[i],
                jerk: Self::JOINT_SHARE * limits.jerk[i],
            }),
            translation: AxisLimits {
                velocity: 0.3,
                acceleration: 0.5,
                jerk: 20.0,
            },
            rotation: AxisLimits {
                velocity: 0.5,
                acceleration: 1.0,
                jerk: 20.0,
            },
        }
    }

    /// Returns a budget that moves along the same paths at `factor` times the speed: velocities are
    /// multiplied by `factor`, accelerations by its square, and jerks by its cube.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let scale = |l: AxisLimits| AxisLimits {
            velocity: l.velocity * factor,
            acceleration: l.acceleration * factor * factor,
            jerk: l.jerk * factor * factor * factor,
        };
        Self {
            joints: self.joints.map(scale),
            translation: scale(self.translation),
            rotation: scale(self.rotation),
        }
    }

    /// Lowest accepted velocity, acceleration and jerk of every axis, in the units of the axis. The
    /// default budget at [`Self::SPEED_MIN`] is above these limits. With them a joint needs days
    /// for a third of a radian.
    pub const LIMITS_MIN: [f64; 3] = [1e-6, 1e-9, 1e-12];

    /// Lowest factor that [`Self::at_speed`] accepts.
    pub const SPEED_MIN: f64 = 1e-4;

    /// Same as [`Self::scaled`], for factors that keep all limits within the robot's limits.
    ///
    /// # Errors
    /// Returns [`GoalError::Speed`], with the greatest valid factor, unless `factor` is between
    /// [`Self::SPEED_MIN`] and that greatest factor.
    pub fn at_speed(self, factor: f64, model: &Model) -> Result<Self, GoalError> {
        let most = self.fastest(model);
        if (Self::SPEED_MIN..=most).contains(&factor) {
            return Ok(self.scaled(factor));
        }
        Err(GoalError::Speed {
            got: factor,
            most: (most * 1e3).floor() / 1e3,
        })
    }

    /// Returns the greatest factor with which all scaled limits stay within the robot's limits.
    fn fastest(&self, model: &Model) -> f64 {
        let (robot, cartesian) = (model.joint_limits(), model.cartesian_limits());
        let joints = self.joints.iter().enumerate().map(|(i, own)| {
            let most = [robot.velocity[i], robot.acceleration[i], robot.jerk[i]];
            (*own, most)
        });
        let of = |limits: &MotionLimits| [limits.velocity, limits.acceleration, limits.jerk];
        let ends = [
            (self.translation, of(&cartesian.translation)),
            (self.rotation, of(&cartesian.rotation)),
        ];
        let fastest = joints
            .chain(ends)
            .map(|(own, [velocity, acceleration, jerk])| {
                let velocity = velocity / own.velocity;
                let acceleration = (acceleration / own.acceleration).sqrt();
                velocity.min(acceleration).min((jerk / own.jerk).cbrt())
            });
        // Subtracts the rounding error that scaling may add to a limit.
        fastest.fold(f64::INFINITY, f64::min) * (1.0 - 1e-12)
    }

    /// Returns the budget, with its accelerations and jerks of translation and rotation raised as
    /// in [`able_to_stop`] if a motion at `twist` and `acceleration` exceeds them.
    pub(crate) fn able_to_stop(
        &self,
        twist: &Twist,
        acceleration: &Twist,
        most: &CartesianLimits,
    ) -> Self {
        let raised = |limits: AxisLimits, part: usize, most: &MotionLimits| {
            let velocity = twist.fixed_rows::<3>(part).norm();
            let acceleration = acceleration.fixed_rows::<3>(part).norm();
            if keeps(&limits, velocity, acceleration) {
                return limits;
            }
            let most = AxisLimits {
                velocity: most.velocity,
                acceleration: most.acceleration,
                jerk: most.jerk,
            };
            able_to_stop(limits, velocity, acceleration, most)
        };
        Self {
            joints: self.joints,
            translation: raised(self.translation, 0, &most.translation),
            rotation: raised(self.rotation, 3, &most.rotation),
        }
    }

    /// Returns the limits of the six axes of translation and rotation for a plan that follows the
    /// two legs. Even if all axes are at their limits at once, the motion stays within the budgets
    /// of the norms.
    pub(crate) fn axes(&self, translation: &Leg, rotation: &Leg) -> [AxisLimits; 6] {
        let (t, r) = (translation.shares(), rotation.shares());
        core::array::from_fn(|i| {
            let (limits, share) = if i < 3 {
                (self.translation, t[i])
            } else {
                (self.rotation, r[i - 3])
            };
            AxisLimits {
                velocity: limits.velocity * share,
                acceleration: limits.acceleration * share,
                jerk: limits.jerk * share,
            }
        })
    }
}

/// Time to brake a motion that exceeds its budget or that must stop, `[s]`. A stop from the default
/// joint velocities with the default joint accelerations takes the same time.
const STOP_TIME: f64 = 0.25;

/// Time to build up or remove the acceleration of that stop, `[s]`.
const RAMP_TIME: f64 = 0.025;

/// Raises acceleration and jerk of `limits` so that a stop from `velocity` and `acceleration` takes
/// about [`STOP_TIME`]. They are raised to the robot's limits, `most`, at the highest.
///
/// A goal with a smaller budget may arrive while the arm moves faster than that budget allows. With
/// the small acceleration, the arm would brake over an unexpectedly long distance. With the small
/// jerk, its present acceleration would at first continue.
pub(crate) fn able_to_stop(
    limits: AxisLimits,
    velocity: f64,
    acceleration: f64,
    most: AxisLimits,
) -> AxisLimits {
    let needed = (velocity.abs() / STOP_TIME).max(acceleration.abs());
    AxisLimits {
        velocity: limits.velocity,
        acceleration: limits.acceleration.max(needed.min(most.acceleration)),
        jerk: limits.jerk.max((needed / RAMP_TIME).min(most.jerk)),
    }
}

/// Share of a velocity limit that is reserved for catching up with a moving target.
const RESERVE: f64 = 0.1;

/// Returns the speed of a frame that moves with a target at `speed`. Also returns the part of the
/// limit `most` that is left for motions within the frame, in any direction.
pub(crate) fn beside(speed: f64, most: f64) -> (f64, f64) {
    let kept = speed.min((1.0 - RESERVE) * most);
    (kept, most - kept)
}

/// True if a motion at `velocity` and `acceleration` stays within `limits`, with a tolerance of one
/// per cent.
pub(crate) fn keeps(limits: &AxisLimits, velocity: f64, acceleration: f64) -> bool {
    velocity.abs() <= 1.01 * limits.velocity && acceleration.abs() <= 1.01 * limits.acceleration
}

/// Distance of three axes from their target, and their motion at the start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub(crate) way: Vector3<f64>,
    pub(crate) velocity: Vector3<f64>,
    pub(crate) acceleration: Vector3<f64>,
}

impl Leg {
    /// Returns the share of a norm budget for each axis. The squares of the shares sum to 1.
    ///
    /// If each axis got a third, a motion along one axis would use only 58 % of the budget.
    /// Therefore the shares follow the direction to the target: a motion on a straight line uses
    /// the whole budget. If the axes start in another direction, part of the budget follows the
    /// velocity and part is spread evenly, so that a sideways motion can be braked.
    fn shares(&self) -> Vector3<f64> {
        let (along_way, along_velocity) = if self.is_straight() {
            (0.99, 0.0)
        } else {
            (0.6, 0.3)
        };
        let even = 1.0 / 3.0;
        let part = |v: &Vector3<f64>, weight: f64| {
            let square = v.norm_squared();
            if square > f64::MIN_POSITIVE {
                v.component_mul(v) * (weight / square)
            } else {
                Vector3::repeat(weight * even)
            }
        };
        let squares = part(&self.way, along_way)
            + part(&self.velocity, along_velocity)
            + Vector3::repeat((1.0 - along_way - along_velocity) * even);
        squares.map(f64::sqrt)
    }

    /// True if velocity and acceleration lie on the line to the target, to within a millionth of
    /// their size.
    fn is_straight(&self) -> bool {
        let on_line =
            |v: &Vector3<f64>| self.way.cross(v).norm() <= 1e-6 * self.way.norm() * v.norm();
        on_line(&self.velocity) && on_line(&self.acceleration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::RobotKind;

    fn leg(way: [f64; 3], velocity: [f64; 3]) -> Leg {
        Leg {
            way: way.into(),
            velocity: velocity.into(),
            acceleration: Vector3::zeros(),
        }
    }

    #[test]
    fn impossible_speed_is_refused_with_the_possible_range() {
        for model in [Model::fr3(), Model::fer()] {
            let budget = Budget::of(model.joint_limits());
            // The default uses a fifth of the joints' jerk limits, and jerk grows with the cube of
            // the factor.
            let most = 5.0_f64.cbrt();
            for factor in [Budget::SPEED_MIN, 0.5, 1.0, most - 1e-9] {
                assert_eq!(budget.at_speed(factor, model), Ok(budget.scaled(factor)));
            }
            for (factor, got) in [
                (0.0, "speed is 0,"),
                (-1.0, "speed is -1,"),
                (7.0, "speed is 7,"),
                (f64::NAN, "speed is NaN,"),
            ] {
                let error = budget.at_speed(factor, model).unwrap_err().to_string();
                let expected =
                    "expected between 0.0001 and 1.709, as a factor of the motion's limits";
                assert_eq!(error, format!("{got} {expected}"));
            }
        }
    }

    #[test]
    fn all_axes_at_their_limits_stay_inside_the_norm() {
        for (way, velocity) in [
            ([0.0, 0.0, 0.1], [0.0; 3]),
            ([0.1, -0.2, 0.3], [0.0; 3]),
            ([0.0; 3], [0.0; 3]),
            ([0.1, 0.0, 0.0], [0.0, 0.3, 0.0]),
            ([0.1, 0.0, 0.0], [-0.1, 0.2, 0.05]),
        ] {
            let shares = leg(way, velocity).shares();
            assert!((shares.norm() - 1.0).abs() < 1e-12, "{shares}");
            assert!(shares.min() > 0.05, "{shares}");
        }
    }

    #[test]
    fn a_straight_line_gets_nearly_the_whole_budget() {
        let along_z = leg([0.0, 0.0, 0.05], [0.0, 0.0, 0.1]).shares();
        assert!(along_z.z > 0.99);
        let across = leg([0.0, 0.0, 0.05], [0.3, 0.0, 0.0]).shares();
        assert!(across.x > 0.5 && across.z > 0.7);
    }

    #[test]
    fn a_slow_budget_can_still_stop_a_fast_motion() {
        let most = AxisLimits {
            velocity: 2.62,
            acceleration: 10.0,
            jerk: 5000.0,
        };
        let slow = AxisLimits {
            velocity: 0.05,
            acceleration: 0.02,
            jerk: 1.0,
        };
        assert_eq!(able_to_stop(slow, 0.0, 0.0, most), slow);
        let raised = able_to_stop(slow, -0.5, 1.0, most);
        assert_eq!((raised.acceleration, raised.jerk), (2.0, 80.0));
        assert_eq!(able_to_stop(slow, 9.0, 0.0, most).acceleration, 10.0);
    }

    #[test]
    fn the_default_budget_is_within_the_limits_of_either_robot() {
        for kind in RobotKind::ALL {
            let (joints, hand) = (JointLimits::of(kind), CartesianLimits::of(kind));
            let budget = Budget::of(joints);
            for i in 0..7 {
                assert_eq!(budget.joints[i].velocity, 0.2 * joints.velocity[i]);
                assert_eq!(budget.joints[i].acceleration, 0.2 * joints.acceleration[i]);
                assert_eq!(budget.joints[i].jerk, 0.2 * joints.jerk[i]);
            }
            for (budget, most) in [
                (budget.translation, hand.translation),
                (budget.rotation, hand.rotation),
            ] {
                assert!(budget.velocity < most.velocity);
                assert!(budget.acceleration < most.acceleration);
                assert!(budget.jerk < most.jerk);
            }
        }
    }

    #[test]
    fn scaling_by_a_factor_keeps_paths() {
        let budget = Budget::of(Model::fr3().joint_limits());
        let slow = budget.scaled(0.5);
        assert_eq!(
            slow.translation,
            AxisLimits {
                velocity: 0.15,
                acceleration: 0.125,
                jerk: 2.5
            }
        );
        assert!((slow.joints[0].velocity - 0.1 * 2.62).abs() < 1e-15);
    }
}
