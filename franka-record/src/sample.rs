//! Data of one cycle for exports and replays.

use franka_model::transform::isometry_from_array;
use franka_proto::MotionGeneratorMode;
use nalgebra::Isometry3;

use crate::cycle::Cycle;

/// The arm and the gripper in one cycle of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// `message_id` of the state, `[ms]` of the robot's clock.
    pub time: u64,
    /// Measured joint positions, `[rad]`.
    pub q: [f64; 7],
    /// Commanded joint positions, `[rad]`: the reference of target control, or the output of a
    /// control function. `None` if this cycle commanded no positions.
    pub q_ref: Option<[f64; 7]>,
    /// Measured pose of the end effector in the base frame (`O_T_EE`), `[m]`.
    pub pose: Isometry3<f64>,
    /// Commanded pose of the end effector in the base frame, `[m]`; `None` if this cycle commanded
    /// no positions.
    pub pose_ref: Option<Isometry3<f64>>,
    /// Distance between the fingers, `[m]`; `None` before the first gripper state.
    pub width: Option<f64>,
    /// Commanded distance between the fingers, `[m]`; `None` before the first command.
    pub width_ref: Option<f64>,
}

impl Sample {
    /// Creates a sample from the arm's data in `cycle`. The caller must add the gripper's width. A
    /// pose that is not a rigid transformation becomes the identity.
    pub fn of(cycle: &Cycle) -> Self {
        let Cycle {
            record,
            state,
            reference,
            ..
        } = cycle;
        let pose = |array| isometry_from_array(array).unwrap_or_default();
        // These robots cannot reach a position with all joints at zero.
        let has_targets = record.q_ref != [0.0; 7];
        let is_commanded = matches!(
            state.motion_generator_mode,
            MotionGeneratorMode::JointPosition
                | MotionGeneratorMode::JointVelocity
                | MotionGeneratorMode::CartesianPosition
                | MotionGeneratorMode::CartesianVelocity
        );
        let (q_ref, pose_ref) = match (has_targets, is_commanded) {
            (true, _) => (Some(record.q_ref), *reference),
            (false, true) => (Some(state.q_d), Some(pose(&state.O_T_EE_d))),
            (false, false) => (None, None),
        };
        Self {
            time: state.message_id,
            q: state.q,
            q_ref,
            pose: pose(&state.O_T_EE),
            pose_ref,
            width: None,
            width_ref: None,
        }
    }

    /// Returns the sample at a `share`, in `[0, 1]`, of the way from this sample to the sample
    /// `later`. Positions are interpolated linearly, and rotations along the shorter arc. The
    /// finger width is copied from this sample, because grippers report their width rarely.
    pub fn towards(&self, later: &Self, share: f64) -> Self {
        let line =
            |a: &[f64; 7], b: &[f64; 7]| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share);
        let time = later.time.saturating_sub(self.time) as f64 * share;
        let both = |a: Option<[f64; 7]>, b: Option<[f64; 7]>| Some(line(&a?, &b?));
        let turn =
            |a: Option<Isometry3<f64>>, b: Option<Isometry3<f64>>| Some(between(&a?, &b?, share));
        Self {
            time: self.time + time.round() as u64,
            q: line(&self.q, &later.q),
            q_ref: both(self.q_ref, later.q_ref),
            pose: between(&self.pose, &later.pose, share),
            pose_ref: turn(self.pose_ref, later.pose_ref),
            ..if share < 1.0 { *self } else { *later }
        }
    }
}

/// Returns the samples from the first to the last sample with a commanded position. Returns all
/// samples if no sample has a commanded position.
pub(crate) fn told(samples: &[Sample]) -> &[Sample] {
    let is_told = |sample: &Sample| sample.q_ref.is_some();
    let first = samples.iter().position(is_told);
    let last = samples.iter().rposition(is_told);
    first
        .zip(last)
        .map_or(samples, |(first, last)| &samples[first..=last])
}

fn between(a: &Isometry3<f64>, b: &Isometry3<f64>, share: f64) -> Isometry3<f64> {
    // The shorter arc is not unique if the orientations are opposite.
    a.try_lerp_slerp(b, share, 1e-9).unwrap_or(*a)
}
