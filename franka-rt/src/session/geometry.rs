//! Compares the model's poses with the poses that the robot reports.
//!
//! A robot computes its poses from its own lengths and joint frames, and users read these poses.
//! Therefore goals move the end effector to a pose as the robot reports it.

use franka_model::{EndEffector, Frame, JointVector, Model, transform};
use franka_proto::RobotState;
use nalgebra::Isometry3;

use super::tool::{end_effector_of, rigid};

/// Residual up to which the robot's poses count as equal to the model's poses, `[m]`. The `f32`
/// states of protocol 10 cause up to 0.5 µm. A difference in lengths causes 100 µm or more.
pub const RESIDUAL_MAX: f64 = 2e-6;

/// Distance from the end effector at which its rotation is measured, `[m]`. It converts an angle to
/// a distance.
pub(super) const LEVER: f64 = 0.1;

/// Returns the distance between `O_T_EE` in `state` and the pose that `model` computes from its
/// joint positions, `[m]`. It is the greater of two values: the distance between the positions, and
/// the largest difference between elements of the rotation matrices, times 0.1 m.
///
/// Returns `None` if the poses cannot be compared, because `O_T_EE` or a frame of the tool is not a
/// rigid transformation, or because a joint position is not finite. Also returns `None` if `O_T_EE`
/// is the identity: the end effector cannot be there, so the state contains no pose.
pub fn residual(model: &Model, state: &RobotState) -> Option<f64> {
    let (models, robots) = poses(model, state)?;
    Some(distance(&models, &robots))
}

/// Returns the end effector of `state` as the robot reports it: the frame of the model whose pose
/// is `O_T_EE` at the joint positions of the state. Returns `None` if a frame of the tool is not a
/// rigid transformation.
pub fn reported_end_effector(model: &Model, state: &RobotState) -> Option<EndEffector> {
    let ee = end_effector_of(state)?;
    let correction = poses(model, state).map(|(models, _)| correction(&models, &state.O_T_EE));
    Some(corrected(&ee, &correction.unwrap_or_default()))
}

/// Returns the pose of the reported end effector (`reported`, column-major) relative to the model's
/// end effector. Returns the identity if the two agree or cannot be compared.
///
/// The correction depends on the posture. With geometry errors of 1 mm and 3 mrad, it changes by
/// about 0.1 mm over 5 cm.
pub(super) fn correction(models: &Isometry3<f64>, reported: &[f64; 16]) -> Isometry3<f64> {
    match read(reported) {
        Some(robots) if distance(models, &robots) > RESIDUAL_MAX => models.inverse() * robots,
        _ => Isometry3::identity(),
    }
}

pub(super) fn corrected(ee: &EndEffector, correction: &Isometry3<f64>) -> EndEffector {
    EndEffector {
        f_t_ee: ee.f_t_ee * transform::matrix(correction),
        ..*ee
    }
}

fn poses(model: &Model, state: &RobotState) -> Option<(Isometry3<f64>, Isometry3<f64>)> {
    let robots = read(&state.O_T_EE)?;
    let q = JointVector::from(state.q);
    if !q.iter().all(|q| q.is_finite()) {
        return None;
    }
    let ee = end_effector_of(state)?;
    Some((rigid(&model.pose(Frame::EndEffector, &q, &ee)), robots))
}

fn read(reported: &[f64; 16]) -> Option<Isometry3<f64>> {
    let pose = transform::isometry_from_array(reported)?;
    (pose != Isometry3::identity()).then_some(pose)
}

/// Returns the distance between two poses, `[m]`, as in [`residual`].
pub(super) fn distance(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let way = (a.translation.vector - b.translation.vector).norm();
    let [a, b] = [a, b].map(|pose| pose.rotation.to_rotation_matrix().into_inner());
    way.max(LEVER * (a - b).amax())
}

#[cfg(test)]
mod tests {
    use franka_model::READY;
    use franka_model::geometry::Lengths;
    use franka_proto::Version;
    use nalgebra::{Translation3, UnitQuaternion, Vector3};

    use super::*;

    /// Returns a state with the model's pose and the vendor's Hand, whose frame contains 0.7071 for
    /// `sqrt(1/2)`.
    #[expect(clippy::approx_constant, reason = "four digits are reported")]
    fn state(model: &Model, q: JointVector) -> RobotState {
        let mut hand = transform::array(&Isometry3::translation(0.0, 0.0, 0.1034));
        (hand[0], hand[1], hand[4], hand[5]) = (0.7071, -0.7071, 0.7071, 0.7071);
        let ee = EndEffector::from_arrays(&hand, &RobotState::default().EE_T_K);
        let pose = model.pose(Frame::EndEffector, &q, &ee);
        let mut reported = [0.0; 16];
        reported.copy_from_slice(pose.as_slice());
        RobotState {
            q: q.into(),
            F_T_EE: hand,
            O_T_EE: reported,
            ..RobotState::default()
        }
    }

    fn sent(state: &RobotState) -> RobotState {
        let mut bytes = [0; RobotState::MAX_SIZE];
        let length = state.encode(Version::V10, &mut bytes).unwrap();
        RobotState::decode(Version::V10, &bytes[..length]).unwrap()
    }

    #[test]
    fn residual_is_rounding_only_with_the_right_lengths() {
        let [described, recorded] = Lengths::KNOWN.map(|it| Model::fr3().clone().with_lengths(it));
        for k in 0..200 {
            let q =
                READY + JointVector::from_fn(|i, _| (1.7 * f64::from(k) + i as f64).sin() * 0.6);
            let state = sent(&state(&recorded, q));
            let q = JointVector::from(state.q);
            let right = residual(&recorded, &state).unwrap();
            assert!(right < 0.5 * RESIDUAL_MAX, "{right:e} m");
            let other = residual(&described, &state).unwrap();
            // A folded forearm almost compensates the error of the upper arm, but never exactly.
            assert!(other > 5.0 * RESIDUAL_MAX, "{other:e} m");
            let ee = end_effector_of(&state).unwrap();
            assert_eq!(reported_end_effector(&recorded, &state).unwrap(), ee);
            let ee = reported_end_effector(&described, &state).unwrap();
            let corrected = rigid(&described.pose(Frame::EndEffector, &q, &ee));
            let reported = transform::isometry_from_array(&state.O_T_EE).unwrap();
            assert!(distance(&corrected, &reported) < 1e-12);
        }
    }

    #[test]
    fn a_rotation_counts_as_a_tenth_of_a_metre() {
        let mut state = state(Model::fr3(), READY);
        let pose = transform::isometry_from_array(&state.O_T_EE).unwrap();
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.0, 1e-3));
        let turned = Isometry3::from_parts(pose.translation, turn * pose.rotation);
        state.O_T_EE = transform::array(&turned);
        let residual_of_turn = residual(Model::fr3(), &state).unwrap();
        assert!(
            (residual_of_turn - 1e-4).abs() < 1e-5,
            "{residual_of_turn:e}"
        );
        state.O_T_EE = transform::array(&(Translation3::new(0.0, 3e-4, 4e-4) * turned));
        let residual = residual(Model::fr3(), &state).unwrap();
        assert!((residual - 5e-4).abs() < 1e-9, "{residual:e}");
    }

    #[test]
    fn states_without_a_pose_have_no_residual() {
        let good = state(Model::fr3(), READY);
        let identity = RobotState::default().O_T_EE;
        for pose in [[0.0; 16], [f64::NAN; 16], identity] {
            let state = RobotState {
                O_T_EE: pose,
                ..good
            };
            assert_eq!(residual(Model::fr3(), &state), None);
            let ee = reported_end_effector(Model::fr3(), &state);
            assert_eq!(ee, end_effector_of(&good));
        }
        let state = RobotState {
            q: [f64::NAN; 7],
            ..good
        };
        assert_eq!(residual(Model::fr3(), &state), None);
    }
}
