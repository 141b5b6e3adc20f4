//! An object that all arms of a team hold.

use franka_rt::lifecycle::MotionError;
use franka_rt::session::Budget;
use nalgebra::Isometry3;

use super::{Team, TeamMotion};
use crate::move_to::Motion;
use crate::robot::Pose;

/// An object that all arms of a team hold, each in its hand. The destinations of motions are poses
/// of the object. The poses of the hands relative to each other do not change. [`Team::grasp`]
/// returns such an object.
///
/// Every real-time thread plans the same path of the object, with the same limits, and its own arm
/// follows the path. The springs and the [force cap](Motion::force_cap) of each arm act at its
/// hand. Except for inertia, the cap of an arm therefore limits the force between the arm and the
/// object, and the force with which two arms pull at each other.
///
/// If an obstacle or its own limits hold back one arm, this arm delays the others. While it is 15
/// mm behind its reference, all references stop on their lines, decelerating at 2.5 m/s^2. For
/// rotations, a radian counts as 0.2 m. A reference that is more than 2 mm ahead of any other
/// reference waits until the other one has caught up. If an arm does not catch up within 5 s, it
/// stops, and its motion ends as [`MotionError::TargetNotReached`]. The motions of the other arms
/// then end with an error, too.
///
/// No arm knows exactly where its hand is, so the arms hold each other slightly away from their
/// targets. By default, an arm that stops within 5 mm and 10 mrad of its target has arrived.
/// [`MotionReport::final_error`](crate::MotionReport::final_error) returns its distance from the
/// target.
#[derive(Clone, Copy, Debug)]
pub struct Grasp<'a, const N: usize> {
    team: &'a Team<N>,
    bases: [Pose; N],
    /// Pose of the object in the frame of each end effector.
    hands: [Pose; N],
}

impl<const N: usize> Team<N> {
    /// Returns an object that all arms hold from now on, at its present place. `bases` are the
    /// robots' base frames and `object` is the object's frame, all in one frame of the program's
    /// choice. The present positions of the arms determine the pose of the object in each hand.
    /// Nothing moves.
    ///
    /// The springs of the arms carry any weight that is not declared with
    /// [`Robot::set_load`](crate::Robot::set_load). If several arms hold a load, declare each arm's
    /// share of it.
    ///
    /// # Errors
    /// Returns the reason why the session of an arm ended, if one has ended.
    pub fn grasp(&self, bases: [Pose; N], object: Pose) -> Result<Grasp<'_, N>, MotionError> {
        let mut hands = [Pose::identity(); N];
        for ((hand, arm), base) in hands.iter_mut().zip(&self.arms).zip(&bases) {
            *hand = (base * arm.held_pose()?).inverse() * object;
        }
        Ok(self.grasp_at(bases, hands))
    }

    /// Returns an object that all arms hold. `hands` are its poses in the frames of the end
    /// effectors. Take these poses from an earlier [`Grasp::hands`], or from a different source.
    /// Nothing moves.
    pub fn grasp_at(&self, bases: [Pose; N], hands: [Pose; N]) -> Grasp<'_, N> {
        let team = self;
        Grasp { team, bases, hands }
    }
}

impl<const N: usize> Grasp<'_, N> {
    /// Returns the pose of the object in the frame of each end effector.
    pub fn hands(&self) -> &[Pose; N] {
        &self.hands
    }

    /// Returns a motion of the object to this pose, in the frame of the bases. A motion that begins
    /// at rest is a straight line and a rotation about one axis. See [`Team::run`] for the start
    /// and the end.
    pub fn move_to(&self, object: Pose) -> TeamMotion<N> {
        self.move_with(object, |motion| motion)
    }

    /// Returns a motion as [`Self::move_to`] does, with options, which must be the same for each
    /// arm. Example: `grasp.move_with(pose, |motion| motion.speed(0.3).force_cap(15.0))`. The
    /// limits of translation and rotation apply at the origin of the object, and are the smallest
    /// of all arms.
    pub fn move_with(&self, object: Pose, options: impl Fn(Motion) -> Motion) -> TeamMotion<N> {
        let budgets = self.team.arms.each_ref().map(|arm| {
            let limits = arm.robot().model().joint_limits();
            Budget::of(limits)
        });
        let slowest = slowest(&budgets);
        self.team.run(|member, arm| {
            let target: Isometry3<f64> = self.bases[member].inverse() * object;
            let budget = Budget {
                joints: budgets[member].joints,
                ..slowest
            };
            let motion = arm.move_to(target).limits(budget);
            options(motion).of_object(self.hands[member])
        })
    }

    /// Returns the pose of the object in the frame of the bases, as each arm measures it in its
    /// newest state. The poses differ because the arms and the grasps are compliant.
    pub fn measured(&self) -> [Pose; N] {
        core::array::from_fn(|member| {
            let hand = self.team.arms[member].robot().pose();
            self.bases[member] * hand * self.hands[member]
        })
    }
}

/// Returns the smallest limits of translation and rotation.
fn slowest<const N: usize>(budgets: &[Budget; N]) -> Budget {
    let mut least = budgets[0];
    for budget in budgets {
        for (least, of) in [
            (&mut least.translation, budget.translation),
            (&mut least.rotation, budget.rotation),
        ] {
            least.velocity = least.velocity.min(of.velocity);
            least.acceleration = least.acceleration.min(of.acceleration);
            least.jerk = least.jerk.min(of.jerk);
        }
    }
    least
}
