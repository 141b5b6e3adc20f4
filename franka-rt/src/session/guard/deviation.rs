//! Deviation: stops an arm that was pushed too far off its path from swinging back.
//!
//! The leash moves the reference along with a pushed arm, and the course continues from the place
//! where the arm is released. Therefore only this guard limits how far the arm can be pushed, and
//! how far it moves back after the release.

use franka_model::{EndEffector, Frame, JointVector, Model, rotation};
use nalgebra::{Isometry3, Vector3};

use crate::session::{Target, rigid};

/// Greatest distance that the arm may be pushed off its path. The path leads from the last
/// reference that the leash did not hold to the target. Beyond this distance, the goal is given up.
/// Infinite numbers switch the guard off. A distance within the [`Leash`](crate::session::Leash)
/// never counts as a deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Greatest translation of the end effector, `[m]`.
    pub translation: f64,
    /// Greatest rotation of the end effector, `[rad]`.
    pub rotation: f64,
    /// Greatest displacement of each joint, `[rad]`.
    pub joints: f64,
}

impl Default for Deviation {
    /// Returns 30 cm, 0.5 rad and 1 rad.
    fn default() -> Self {
        Self {
            translation: 0.3,
            rotation: 0.5,
            joints: 1.0,
        }
    }
}

/// Remembers the reference before the leash moved it along.
#[derive(Debug)]
pub(crate) struct Displacement {
    /// Joint positions of the reference when the leash last did not hold it, `[rad]`.
    anchor: JointVector,
}

impl Displacement {
    pub(crate) fn at(anchor: JointVector) -> Self {
        Self { anchor }
    }

    pub(crate) fn set_free(&mut self, reference: &JointVector) {
        self.anchor = *reference;
    }

    /// True if the arm, at `q` and `measured`, is further than `most` from the path between the
    /// last free reference and the target. An arm that follows slowly is on its path, so it is not
    /// displaced.
    pub(crate) fn is_exceeded(
        &self,
        model: &Model,
        ee: &EndEffector,
        q: &JointVector,
        measured: &Isometry3<f64>,
        target: &Target,
        most: &Deviation,
    ) -> bool {
        let pose_at = |q: &JointVector| rigid(&model.pose(Frame::EndEffector, q, ee));
        let way = match target {
            Target::Joints(target) => JointVector::from_fn(|i, _| {
                let (a, b) = (self.anchor[i], target[i]);
                q[i].clamp(a.min(b), a.max(b))
            }),
            _ => self.anchor,
        };
        let anchor = pose_at(&way);
        let end = match target {
            Target::Pose(pose) => pose,
            _ => &anchor,
        };
        let from = anchor.translation.vector;
        let aside = beside(
            &(measured.translation.vector - from),
            &(end.translation.vector - from),
        );
        let turned = beside(
            &rotation::error(&measured.rotation, &anchor.rotation),
            &rotation::error(&end.rotation, &anchor.rotation),
        );
        aside > most.translation || turned > most.rotation || (q - way).amax() > most.joints
    }
}

/// Returns the distance between `point` and the line from the origin to `end`.
pub(crate) fn beside(point: &Vector3<f64>, end: &Vector3<f64>) -> f64 {
    let along = point.dot(end) / end.norm_squared().max(f64::MIN_POSITIVE);
    (point - end * along.clamp(0.0, 1.0)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;
    use nalgebra::{Translation3, UnitQuaternion};

    fn exceeded(q: &JointVector, measured: &Isometry3<f64>, target: &Target) -> bool {
        let (ee, most) = (EndEffector::default(), Deviation::default());
        Displacement::at(READY).is_exceeded(Model::fr3(), &ee, q, measured, target, &most)
    }

    fn ready() -> Isometry3<f64> {
        let pose = Model::fr3().pose(Frame::EndEffector, &READY, &EndEffector::default());
        rigid(&pose)
    }

    #[test]
    fn a_hand_is_carried_off_at_thirty_centimetres_or_half_a_radian() {
        let pose = Target::Pose(ready());
        for (distance, off) in [(0.29, false), (0.31, true)] {
            let there = Translation3::new(0.0, distance, 0.0) * ready();
            assert_eq!(exceeded(&READY, &there, &pose), off);
        }
        for (angle, off) in [(0.49, false), (0.51, true)] {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, angle, 0.0));
            let there = Isometry3::from_parts(ready().translation, turn * ready().rotation);
            assert_eq!(exceeded(&READY, &there, &pose), off);
        }
    }

    #[test]
    fn an_arm_on_its_way_to_the_target_is_not_carried_off() {
        let far = Translation3::new(0.0, 0.8, 0.0) * ready();
        let on_the_way = Translation3::new(0.0, 0.5, 0.1) * ready();
        assert!(!exceeded(&READY, &on_the_way, &Target::Pose(far)));
        assert!(exceeded(&READY, &on_the_way, &Target::Pose(ready())));
        let beyond = Translation3::new(0.0, 1.15, 0.0) * ready();
        assert!(exceeded(&READY, &beyond, &Target::Pose(far)));
    }

    #[test]
    fn a_joint_is_carried_off_at_a_radian_from_its_way() {
        let mut target = READY;
        target[6] += 1.5;
        for (angle, off) in [
            (1.4, false),
            (1.9, false),
            (2.1, true),
            (-0.4, false),
            (-0.6, true),
        ] {
            let mut q = READY;
            q[6] += angle;
            let pose = rigid(&Model::fr3().pose(Frame::EndEffector, &q, &EndEffector::default()));
            assert_eq!(
                exceeded(&q, &pose, &Target::Joints(target.into())),
                off,
                "{angle}"
            );
        }
    }
}
