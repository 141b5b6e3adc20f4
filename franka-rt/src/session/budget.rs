//! How fast a goal may be approached: limits per joint, and limits for the norm of translation and
//! rotation.

use franka_model::limits::{CartesianLimits, JointLimits, MotionLimits};
use franka_model::{Model, Twist};
use franka_otg::AxisLimits;
use nalgebra::Vector3;

use crate::session::GoalError;

/// Limits of the reference: how fast the goal is approached.
///
/// A stop, and a goal that comes while the arm moves faster than its budget allows, may use more
/// acceleration and jerk than the budget has, up to the robot's limits. On the way to a pose each
/// joint may use thrice its velocity, and the robot's acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Per joint, `[rad/s, rad/s^2, rad/s^3]`.
    pub joints: [AxisLimits; 7],
    /// For the norm of the end effector's translation, `[m/s, m/s^2, m/s^3]`.
    pub translation: AxisLimits,
    /// For the norm of the end effector's rotation, `[rad/s, rad/s^2, rad/s^3]`.
    pub rotation: AxisLimits,
}

impl Budget {
    /// Share of the robot's joint limits that the default budget uses.
    pub const JOINT_SHARE: f64 = 0.2;

    /// The default budget: a fifth of the robot's joint limits, 0.3 m/s, 0.5 m/s^2, 20 m/s^3 and
    /// 0.5 rad/s, 1 rad/s^2, 20 rad/s^3. A person beside the arm can follow and stop a motion of
    /// this pace.
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

    /// Returns the budget for the same paths at `factor` times the speed: velocities times
    /// `factor`, accelerations times its square, jerks times its cube.
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

    /// Least velocity, acceleration and jerk of every axis, in its units. The default budget at
    /// [`Self::SPEED_MIN`] has more. A joint needs days with them for a third of a radian.
    pub const LIMITS_MIN: [f64; 3] = [1e-6, 1e-9, 1e-12];

    /// Least factor that [`Self::at_speed`] takes.
    pub const SPEED_MIN: f64 = 1e-4;

    /// The same as [`Self::scaled`], where that keeps the limits of the robot.
    ///
    /// # Errors
    /// [`GoalError::Speed`] with the greatest factor that does, unless `factor` is between
    /// [`Self::SPEED_MIN`] and that.
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

    /// The greatest factor by which all limits can be scaled and stay inside those of the robot.
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
        // Less what rounding may add to a limit.
        fastest.fold(f64::INFINITY, f64::min) * (1.0 - 1e-12)
    }

    /// The budget with the accelerations and jerks of translation and rotation raised as
    /// [`able_to_stop`] does, where a motion at `twist` and `acceleration` does not keep them.
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

    /// Limits of the three axes of translation and the three of rotation for a plan from `velocity`
    /// along `way`, such that even all axes at their limits at once stay inside the budgets of the
    /// norms.
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

/// Time in which a motion that leaves its budget, or is to stop, can be brought to rest, `[s]`. A
/// stop from the default joint velocities within the default joint accelerations takes as long.
const STOP_TIME: f64 = 0.25;

/// Time in which the acceleration of that stop is built up or taken back, `[s]`.
const RAMP_TIME: f64 = 0.025;

/// `limits`, with acceleration and jerk raised as far as it takes to stop from `velocity` and
/// `acceleration` in about [`STOP_TIME`], up to the robot's `most`.
///
/// A goal may come, with a budget of its own, while the arm moves faster than that budget allows.
/// Its small acceleration would then brake over an unexpectedly long distance, and its small
/// jerk would first let the acceleration of the motion before it run on.
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

/// Share of a velocity limit that is kept for catching up with a target that moves.
const RESERVE: f64 = 0.1;

/// The speed of a frame that moves with a target at `speed`, and what it leaves of the limit `most`
/// for motions within the frame, whatever their direction.
pub(crate) fn beside(speed: f64, most: f64) -> (f64, f64) {
    let kept = speed.min((1.0 - RESERVE) * most);
    (kept, most - kept)
}

/// True if a motion at `velocity` and `acceleration` keeps `limits`, to one per cent.
pub(crate) fn keeps(limits: &AxisLimits, velocity: f64, acceleration: f64) -> bool {
    velocity.abs() <= 1.01 * limits.velocity && acceleration.abs() <= 1.01 * limits.acceleration
}

/// The distance of three axes to their target, and their motion at its start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    pub(crate) way: Vector3<f64>,
    pub(crate) velocity: Vector3<f64>,
    pub(crate) acceleration: Vector3<f64>,
}

impl Leg {
    /// The share of a norm budget that each axis gets. The squares sum to 1.
    ///
    /// A third each would keep the norm, but a motion along one axis would then use 58 % of the
    /// budget. So the shares follow the way to go: on a straight line each axis gets its part of
    /// the line and the line gets the whole budget. While the axes move elsewhere, part of it
    /// follows the velocity, and part is spread evenly, so that a sideways motion can be braked.
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

    /// True if velocity and acceleration lie on the line of the way, to a millionth of their size.
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
    fn a_speed_that_no_motion_can_have_is_told_with_the_range_of_those_that_can() {
        for model in [Model::fr3(), Model::fer()] {
            let budget = Budget::of(model.joint_limits());
            // The default is a fifth of the joints' jerks, and those grow with the cube.
            let most = 5.0_f64.cbrt();
            for factor in [Budget::SPEED_MIN, 0.5, 1.0, most - 1e-9] {
                assert_eq!(budget.at_speed(factor, model), Ok(budget.scaled(factor)));
            }
            for (factor, got) in [
                (0.0, "speed 0,"),
                (-1.0, "speed -1,"),
                (7.0, "speed 7,"),
                (f64::NAN, "speed NaN,"),
            ] {
                let error = budget.at_speed(factor, model).unwrap_err().to_string();
                let expected = "expected between 0.0001 and 1.709 times the limits of the motion";
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
