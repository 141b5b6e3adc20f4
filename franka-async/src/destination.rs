//! Destinations of motions: a target, or an offset from the present target or from the arm's
//! measured pose.

use franka_model::Model;
use franka_proto::RobotState;
use franka_rt::session::Target;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::end_effector_pose::{pose_at, pose_of};

/// Destination of a motion. It is made from a [`Pose`](crate::Pose), joint positions `[rad]` or an
/// [`Offset`], or by the functions here. For a moving target, add its velocity to the pose or the
/// joint positions.
///
/// A destination that is only a position or only an orientation is completed when the motion
/// begins: the rest of the pose comes from the present target.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Destination {
    /// A target.
    Target(Target),
    /// A position of the end effector in the base frame, `[m]`; the orientation does not change.
    Position(Vector3<f64>),
    /// An orientation of the end effector in the base frame; the position does not change.
    Orientation(UnitQuaternion<f64>),
    /// A pose at an offset from the present target, or from the arm's measured pose.
    Offset(Offset),
}

impl Destination {
    /// Returns a position of the end effector in the base frame, `[m]`; the orientation does not
    /// change.
    pub fn position(position: impl Into<Vector3<f64>>) -> Self {
        Self::Position(position.into())
    }

    /// Returns an orientation of the end effector in the base frame; the position does not change.
    pub fn orientation(orientation: UnitQuaternion<f64>) -> Self {
        Self::Orientation(orientation)
    }

    /// Returns the target to the extent that it is known without the current one; its kind is
    /// final.
    pub(crate) fn kind(&self) -> Target {
        match self {
            Self::Target(target) => *target,
            Self::Position(_) | Self::Orientation(_) | Self::Offset(_) => {
                Target::Pose(Isometry3::identity())
            }
        }
    }

    pub(crate) fn seen_from(&self, now: &Now) -> Target {
        let target = now.target;
        match *self {
            Self::Target(target) => target,
            Self::Position(position) => {
                Isometry3::from_parts(Translation3::from(position), target.rotation).into()
            }
            Self::Orientation(orientation) => {
                Isometry3::from_parts(target.translation, orientation).into()
            }
            Self::Offset(offset) => offset.from(now).into(),
        }
    }
}

impl<T: Into<Target>> From<T> for Destination {
    fn from(target: T) -> Self {
        Self::Target(target.into())
    }
}

impl From<Offset> for Destination {
    fn from(offset: Offset) -> Self {
        Self::Offset(offset)
    }
}

/// The end effector's poses to which a destination may be relative, in the base frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Now {
    /// Pose of the present target.
    pub(crate) target: Isometry3<f64>,
    /// Measured pose.
    pub(crate) arm: Isometry3<f64>,
}

impl Now {
    /// Returns the poses of an arm in `state` that moves to a target. `reference` contains the
    /// joint positions of its reference, `[rad]`; `None` if nothing moves the arm.
    pub(crate) fn of(
        model: &Model,
        state: &RobotState,
        heading: Option<Target>,
        reference: Option<[f64; 7]>,
    ) -> Self {
        let pose_at = |q| pose_at(model, state, q);
        let arm = pose_of(state).unwrap_or_else(|| pose_at(state.q));
        let target = match heading {
            Some(Target::Pose(pose)) => pose,
            Some(Target::Joints(q)) => pose_at(q),
            // A target of holding or following has no pose.
            Some(_) => reference.map_or(arm, pose_at),
            None => arm,
        };
        Self { target, arm }
    }
}

/// An offset along the axes of the base or the end effector. It starts at the arm's present target,
/// or at its measured pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset {
    way: Isometry3<f64>,
    axes: Axes,
    from_arm: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Axes {
    Base,
    Tool,
}

impl Offset {
    /// Returns an offset along the axes of the base frame, `[m]`, with a rotation about axes that
    /// are parallel to them and pass through the end effector.
    pub fn base(way: impl Into<Isometry3<f64>>) -> Self {
        Self::along(Axes::Base, way.into())
    }

    /// Returns an offset along the axes of the end effector, `[m]`, with a rotation about them.
    pub fn tool(way: impl Into<Isometry3<f64>>) -> Self {
        Self::along(Axes::Tool, way.into())
    }

    fn along(axes: Axes, way: Isometry3<f64>) -> Self {
        let from_arm = false;
        Self {
            way,
            axes,
            from_arm,
        }
    }

    /// Makes the offset start at the measured pose of the arm. By default, an offset starts at the
    /// target that the arm is held at or moves to, so that several offsets add up exactly. If there
    /// is no such target, it starts at the measured pose.
    #[must_use]
    pub fn from_arm(mut self) -> Self {
        self.from_arm = true;
        self
    }

    fn from(&self, now: &Now) -> Isometry3<f64> {
        let start = if self.from_arm { now.arm } else { now.target };
        match self.axes {
            Axes::Base => Isometry3::from_parts(
                Translation3::from(start.translation.vector + self.way.translation.vector),
                self.way.rotation * start.rotation,
            ),
            Axes::Tool => start * self.way,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn now() -> Now {
        let quarter = UnitQuaternion::from_euler_angles(0.0, 0.0, core::f64::consts::FRAC_PI_2);
        let target = Isometry3::from_parts(Translation3::new(0.4, 0.0, 0.3), quarter);
        let arm = Translation3::new(0.001, 0.0, 0.0) * target;
        Now { target, arm }
    }

    #[test]
    fn an_offset_counts_in_its_axes_from_where_it_says() {
        let now = now();
        let way = Translation3::new(0.1, 0.0, 0.0);
        let place = |offset: Offset| match Destination::from(offset).seen_from(&now) {
            Target::Pose(pose) => pose.translation.vector,
            other => panic!("{other:?}"),
        };
        let near = |a: Vector3<f64>, b: [f64; 3]| assert!((a - Vector3::from(b)).norm() < 1e-15);
        near(place(Offset::base(way)), [0.5, 0.0, 0.3]);
        near(place(Offset::tool(way)), [0.4, 0.1, 0.3]);
        near(place(Offset::base(way).from_arm()), [0.501, 0.0, 0.3]);
    }

    #[test]
    fn a_turn_is_about_the_end_effector() {
        let now = now();
        let turn = UnitQuaternion::from_euler_angles(0.3, 0.0, 0.0);
        for (offset, expected) in [
            (Offset::base(turn_only(turn)), turn * now.target.rotation),
            (Offset::tool(turn_only(turn)), now.target.rotation * turn),
        ] {
            let Target::Pose(pose) = Destination::from(offset).seen_from(&now) else {
                panic!("a pose");
            };
            assert_eq!(pose.translation, now.target.translation);
            assert!(pose.rotation.angle_to(&expected) < 1e-12);
        }
    }

    fn turn_only(turn: UnitQuaternion<f64>) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::identity(), turn)
    }

    #[test]
    fn half_a_pose_keeps_the_other_half_of_the_target() {
        let now = now();
        let there = Destination::position([0.5, 0.1, 0.2]).seen_from(&now);
        let expected = Isometry3::from_parts(Translation3::new(0.5, 0.1, 0.2), now.target.rotation);
        assert_eq!(there, Target::Pose(expected));
        let turn = UnitQuaternion::from_euler_angles(3.0, 0.0, 0.0);
        let turned = Destination::orientation(turn).seen_from(&now);
        let expected = Isometry3::from_parts(now.target.translation, turn);
        assert_eq!(turned, Target::Pose(expected));
        let joints = Destination::from([0.1; 7]);
        assert_eq!(joints.seen_from(&now), Target::Joints([0.1; 7]));
        assert_eq!(joints.kind(), Target::Joints([0.1; 7]));
    }
}
