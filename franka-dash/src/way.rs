//! Path, speed limits and stiffness of a motion.

use franka_async::goal::{Budget, Gains, Target, target_range};
use franka_async::{Pose, READY, Robot, pose};

use crate::pace;
use crate::request::{Motion, SPEED_MAX, Tuning};

/// The path of a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Way {
    /// The joints move to `target`, `[rad]`. `way` is the displacement from the start, `[rad]`.
    Joints { target: [f64; 7], way: [f64; 7] },
    /// The end effector moves to a pose on a straight line.
    Pose(Pose),
    /// The end effector moves in a direction.
    EndEffector,
}

impl Way {
    pub(crate) fn of(robot: &Robot, motion: &Motion) -> Self {
        let range = target_range(robot.model().joint_limits());
        let state = robot.state();
        let target = match motion {
            Motion::Joint { joint, up } => {
                // The other joints keep their positions, even outside their ranges.
                let mut q = state.q_d;
                let index = joint - 1;
                let (lower, upper) = range[index];
                q[index] = if *up { upper } else { lower };
                q
            }
            Motion::Joints { q } => core::array::from_fn(|i| q[i].clamp(range[i].0, range[i].1)),
            Motion::Ready {} => READY.into(),
            Motion::Pose {
                position,
                orientation,
            } => {
                let target = pose::from_xyzw(*position, *orientation);
                return target.map_or(Self::EndEffector, Self::Pose);
            }
            Motion::Translate { .. } | Motion::Rotate { .. } | Motion::Stay {} => {
                return Self::EndEffector;
            }
        };
        let way = core::array::from_fn(|i| target[i] - state.q[i]);
        Self::Joints { target, way }
    }

    /// Returns the target of the motion; `None` if the motion has no target and continues while its
    /// button is held.
    pub(crate) fn target(&self) -> Option<Target> {
        match self {
            Self::Joints { target, .. } => Some(Target::Joints(*target)),
            Self::Pose(pose) => Some(Target::Pose(*pose)),
            Self::EndEffector => None,
        }
    }

    /// Returns the speed limits of the motion. In a joint motion, `speed` limits every point of the
    /// arm, `[m/s]`. In other motions, `speed` limits the end effector.
    pub(crate) fn budget(&self, robot: &Robot, speed: f64) -> Budget {
        match self {
            Self::Joints { way, .. } => pace::joints(robot.model(), &robot.state(), *way, speed),
            Self::Pose(_) => pace::end_effector_at(robot.model(), speed),
            // A moving target needs a reserve of one tenth, so that the arm can catch up.
            Self::EndEffector => pace::end_effector_at(robot.model(), (speed / 0.9).min(SPEED_MAX)),
        }
    }

    /// Returns the driver's gains for this kind of motion, changed by the viewer's stiffness
    /// setting.
    pub(crate) fn gains(&self, tuning: &Tuning) -> Gains {
        let preset = match self {
            Self::Joints { .. } => Gains::joint(),
            Self::Pose(_) | Self::EndEffector => Gains::cartesian(),
        };
        let stiffness = preset.cartesian_stiffness.map(|k| k * tuning.end_effector);
        let gains = preset.with_cartesian_stiffness(stiffness);
        let joint_damping = tuning.damping * tuning.joints.sqrt();
        Gains {
            cartesian_damping: gains.cartesian_damping.map(|d| d * tuning.damping),
            joint_stiffness: gains.joint_stiffness.map(|k| k * tuning.joints),
            joint_damping: gains.joint_damping.map(|d| d * joint_damping),
            compensation: match tuning.compensation {
                true => gains.compensation,
                false => [0.0; 7],
            },
            ..gains
        }
    }
}
