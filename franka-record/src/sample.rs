//! What exports and replays read of one cycle.

use franka_model::transform::isometry_from_array;
use franka_proto::MotionGeneratorMode;
use nalgebra::Isometry3;

use crate::cycle::Cycle;

/// Arm and gripper in one cycle of a recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// `message_id` of the state, `[ms]` of the robot's clock.
    pub time: u64,
    /// Measured joint positions, `[rad]`.
    pub q: [f64; 7],
    /// Joint positions that the arm was to have, `[rad]`: the reference of target control, or what
    /// a control function commanded. `None` where the joints were not under control.
    pub q_ref: Option<[f64; 7]>,
    /// Measured pose of the end effector in the base frame, `O_T_EE`, metres.
    pub pose: Isometry3<f64>,
    /// Pose that the end effector was to have, base frame, metres.
    pub pose_ref: Option<Isometry3<f64>>,
    /// Distance between the fingers, `[m]`; `None` before the gripper's first state.
    pub width: Option<f64>,
    /// Distance that the fingers were told to have, `[m]`; `None` before the first order.
    pub width_ref: Option<f64>,
}

impl Sample {
    /// What a cycle says of the arm; the gripper is for the caller to add. A pose that is not a
    /// rigid transformation counts as the identity.
    pub fn of(cycle: &Cycle) -> Self {
        let Cycle {
            record,
            state,
            reference,
            ..
        } = cycle;
        let pose = |array| isometry_from_array(array).unwrap_or_default();
        // No robot can have all joints at zero.
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

    /// The sample between this one and a `later` one, a `share` from 0 to 1 of the way: positions
    /// on the line, rotations on the shorter arc. The finger width is this one's: grippers report
    /// it rarely.
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

/// The samples from the first to the last in which the arm was told where to be; all of them if it
/// never was.
pub(crate) fn told(samples: &[Sample]) -> &[Sample] {
    let is_told = |sample: &Sample| sample.q_ref.is_some();
    let first = samples.iter().position(is_told);
    let last = samples.iter().rposition(is_told);
    first
        .zip(last)
        .map_or(samples, |(first, last)| &samples[first..=last])
}

/// The pose a `share` of the way from `a` to `b`.
fn between(a: &Isometry3<f64>, b: &Isometry3<f64>, share: f64) -> Isometry3<f64> {
    // There is no shorter arc to the opposite orientation.
    a.try_lerp_slerp(b, share, 1e-9).unwrap_or(*a)
}
