//! The leash: the reference never runs further ahead of the measured arm than this, so that an arm that is held back
//! is pulled by a bounded spring and does not leap when it is let go.

use franka_model::{JointVector, rotation};
use nalgebra::{Isometry3, Translation3};

use crate::law::hybrid::Reference;
use crate::otg::State;
use crate::session::course::Course;

/// Longest distance from the measured end effector to its reference, `[m]`.
pub const TRANSLATION_LEASH: f64 = 0.025;

/// Largest angle from the measured end effector to its reference, `[rad]`.
pub const ROTATION_LEASH: f64 = 0.15;

/// Largest distance of a joint from its reference, `[rad]`.
pub const JOINT_LEASH: f64 = 0.1;

/// Holds course and reference within the leash of the measured arm; tells whether that moved them.
///
/// The course keeps its velocity and plans on from where it is held, so the arm follows smoothly once it is free.
pub(super) fn hold(
    course: &mut Course,
    reference: &mut Reference,
    q: &JointVector,
    measured: &Isometry3<f64>,
) -> bool {
    let held = reference.q.zip_map(q, |reference, q| {
        reference.clamp(q - JOINT_LEASH, q + JOINT_LEASH)
    });
    let mut bound = held != reference.q;
    reference.q = held;
    let planned = match course {
        Course::Joints(generator) if bound => generator.set_state(State {
            position: held.into(),
            ..*generator.state()
        }),
        Course::Pose(generator) => match within(&generator.pose(), measured) {
            Some(pose) => {
                bound = true;
                generator.reanchor(pose)
            }
            None => Ok(()),
        },
        Course::Rest | Course::Joints(_) => Ok(()),
    };
    // A measured state that is not finite; the robot will not send one, and the course then goes on as planned.
    debug_assert!(planned.is_ok(), "{planned:?}");
    bound
}

/// The pose nearest to `pose` within the leash of `measured`, if that is another one.
fn within(pose: &Isometry3<f64>, measured: &Isometry3<f64>) -> Option<Isometry3<f64>> {
    let ahead = pose.translation.vector - measured.translation.vector;
    let turned = rotation::error(&pose.rotation, &measured.rotation);
    let (distance, angle) = (ahead.norm(), turned.norm());
    if distance <= TRANSLATION_LEASH && angle <= ROTATION_LEASH {
        return None;
    }
    let ahead = ahead * (TRANSLATION_LEASH / distance.max(TRANSLATION_LEASH));
    let turned = turned * (ROTATION_LEASH / angle.max(ROTATION_LEASH));
    Some(Isometry3::from_parts(
        Translation3::from(measured.translation.vector + ahead),
        rotation::exp(&turned) * measured.rotation,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn shortens_distance_and_angle_and_keeps_their_directions() {
        let measured = Isometry3::from_parts(
            Translation3::new(0.3, 0.1, 0.5),
            UnitQuaternion::from_euler_angles(3.0, 0.1, 0.2),
        );
        let way = Vector3::new(0.03, -0.04, 0.0);
        let turn = Vector3::new(0.0, 0.3, 0.0);
        let pose = Isometry3::from_parts(
            Translation3::from(measured.translation.vector + way),
            rotation::exp(&turn) * measured.rotation,
        );
        let held = within(&pose, &measured).expect("50 mm is longer than the leash");
        assert!((held.translation.vector - measured.translation.vector - way / 2.0).norm() < 1e-15);
        let turned = rotation::error(&held.rotation, &measured.rotation);
        assert!((turned - turn / 2.0).norm() < 1e-12);
        assert_eq!(within(&measured, &measured), None);
    }
}
