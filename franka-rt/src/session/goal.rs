//! What target control is asked for, and its form in the slot that crosses into the thread.

use franka_model::limits::JointLimits;
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

impl Goal {
    /// A goal for an arm with these limits, with the defaults: the default budget, joints stiff on the way to joint
    /// positions and the end effector compliant otherwise, the default tolerance.
    pub fn new(id: GoalId, target: Target, then: Then, limits: &JointLimits) -> Self {
        Self {
            id,
            target,
            then,
            budget: Budget::of(limits),
            gains: match target {
                Target::Joints(_) => Gains::joint(),
                Target::Pose(_) | Target::Rest => Gains::cartesian(),
            },
            tolerance: Tolerance::default(),
        }
    }
}

/// Name, kind of target, what follows; 7 numbers of target, 27 of budget, the gains, 2 of tolerance.
impl Words for Goal {
    const WORDS: usize = 3 + 7 + 27 + Gains::NUMBERS + 2;

    fn store(&self, words: &mut [u64]) {
        let (kind, target) = match self.target {
            Target::Rest => (0, [0.0; 7]),
            Target::Joints(q) => (1, q),
            Target::Pose(pose) => {
                let (p, r) = (pose.translation.vector, pose.rotation.coords);
                (2, [p.x, p.y, p.z, r.x, r.y, r.z, r.w])
            }
        };
        let then = u64::from(self.then == Then::Finish);
        let Budget {
            joints,
            translation,
            rotation,
        } = self.budget;
        let axes = joints.into_iter().chain([translation, rotation]);
        let numbers = target
            .into_iter()
            .chain(axes.flat_map(|l| [l.velocity, l.acceleration, l.jerk]))
            .chain(self.gains.to_array())
            .chain([self.tolerance.translation, self.tolerance.rotation]);
        let all = [self.id.0, kind, then]
            .into_iter()
            .chain(numbers.map(f64::to_bits));
        for (word, value) in words.iter_mut().zip(all) {
            *word = value;
        }
    }

    fn load(words: &[u64]) -> Self {
        let mut words = words.iter().copied();
        let mut next = || words.next().unwrap_or_default();
        let (id, kind, then) = (next(), next(), next());
        let mut number = || f64::from_bits(next());
        let target = core::array::from_fn(|_| number());
        let mut axis = || AxisLimits {
            velocity: number(),
            acceleration: number(),
            jerk: number(),
        };
        let budget = Budget {
            joints: core::array::from_fn(|_| axis()),
            translation: axis(),
            rotation: axis(),
        };
        Self {
            id: GoalId(id),
            target: match kind {
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
            then: if then == 0 { Then::Hold } else { Then::Finish },
            budget,
            gains: Gains::from_array(core::array::from_fn(|_| number())),
            tolerance: Tolerance {
                translation: number(),
                rotation: number(),
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
