//! What target control is asked for, and its form in the slot that crosses into the thread.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use crate::law::Gains;
use crate::otg::AxisLimits;
use crate::session::Budget;
use crate::slot::Words;

/// Names one goal for the life of a connection. Updates of a followed target keep the name of the goal they belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GoalId(pub u64);

/// Where to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// To rest, over the joints, in about a quarter of a second and under the robot's jerk limit, however gentle the goal's
    /// budget is.
    Rest,
    /// To joint positions, `[rad]`.
    Joints([f64; 7]),
    /// To a pose of the end effector in the base frame, `O_T_EE`, metres.
    Pose(Isometry3<f64>),
}

/// What follows the arrival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Then {
    /// Hold the target until a newer goal comes.
    Hold,
    /// Settle, report and end the motion.
    Finish,
}

/// How near counts as arrived, measured at the end effector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Distance, `[m]`.
    pub translation: f64,
    /// Angle, `[rad]`.
    pub rotation: f64,
}

impl Default for Tolerance {
    /// 1 mm and 1 mrad.
    fn default() -> Self {
        Self {
            translation: 1e-3,
            rotation: 1e-3,
        }
    }
}

/// One goal, complete: a newer one replaces all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Its name.
    pub id: GoalId,
    /// Where to go.
    pub target: Target,
    /// What follows the arrival.
    pub then: Then,
    /// How fast.
    pub budget: Budget,
    /// How stiff.
    pub gains: Gains,
    /// How near counts as arrived.
    pub tolerance: Tolerance,
}

/// Numbers of a goal behind its first three words: 7 of target, 27 of budget, 26 of gains, 2 of tolerance.
const NUMBERS: usize = 7 + 27 + 26 + 2;

/// Name, kind of target and what follows, then the numbers.
impl Words for Goal {
    const WORDS: usize = 3 + NUMBERS;

    fn store(&self, words: &mut [u64]) {
        let (kind, target) = match self.target {
            Target::Rest => (0, [0.0; 7]),
            Target::Joints(q) => (1, q),
            Target::Pose(pose) => {
                let (p, r) = (pose.translation.vector, pose.rotation.coords);
                (2, [p.x, p.y, p.z, r.x, r.y, r.z, r.w])
            }
        };
        words[0] = self.id.0;
        words[1] = kind;
        words[2] = u64::from(self.then == Then::Finish);
        let axes = self
            .budget
            .joints
            .into_iter()
            .chain([self.budget.translation, self.budget.rotation]);
        let numbers = target
            .into_iter()
            .chain(axes.flat_map(|l| [l.velocity, l.acceleration, l.jerk]))
            .chain(self.gains.to_array())
            .chain([self.tolerance.translation, self.tolerance.rotation]);
        for (word, number) in words[3..].iter_mut().zip(numbers) {
            *word = number.to_bits();
        }
    }

    fn load(words: &[u64]) -> Self {
        let number = |i: usize| f64::from_bits(words[3 + i]);
        let target = core::array::from_fn(number);
        let axis = |i: usize| AxisLimits {
            velocity: number(7 + 3 * i),
            acceleration: number(8 + 3 * i),
            jerk: number(9 + 3 * i),
        };
        Self {
            id: GoalId(words[0]),
            target: match words[1] {
                1 => Target::Joints(target),
                2 => {
                    let [x, y, z, i, j, k, w] = target;
                    Target::Pose(Isometry3::from_parts(
                        Translation3::new(x, y, z),
                        UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
                    ))
                }
                _ => Target::Rest,
            },
            then: if words[2] == 0 {
                Then::Hold
            } else {
                Then::Finish
            },
            budget: Budget {
                joints: core::array::from_fn(axis),
                translation: axis(7),
                rotation: axis(8),
            },
            gains: Gains::from_array(core::array::from_fn(|i| number(34 + i))),
            tolerance: Tolerance {
                translation: number(60),
                rotation: number(61),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::Model;

    #[test]
    fn every_field_of_a_goal_survives_its_words() {
        let pose = Isometry3::from_parts(
            Translation3::new(0.4, -0.1, 0.3),
            UnitQuaternion::from_euler_angles(3.0, 0.2, -0.7),
        );
        for (target, then) in [
            (Target::Rest, Then::Finish),
            (
                Target::Joints([0.1, -0.2, 0.3, -2.0, 0.5, 1.6, 0.7]),
                Then::Hold,
            ),
            (Target::Pose(pose), Then::Finish),
        ] {
            let goal = Goal {
                id: GoalId(77),
                target,
                then,
                budget: Budget::of(Model::fr3().joint_limits()).scaled(0.37),
                gains: Gains::joint(),
                tolerance: Tolerance {
                    translation: 2e-3,
                    rotation: 3e-3,
                },
            };
            let mut words = [u64::MAX; Goal::WORDS];
            goal.store(&mut words);
            assert_eq!(Goal::load(&words), goal);
        }
    }
}
