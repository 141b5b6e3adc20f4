//! Converts samples at 1 kHz to frames at the rate of a dataset.

use nalgebra::{Isometry3, Vector4};

use super::Action;
use crate::sample::{Sample, told};

/// Returns the names of the numbers in a state or an action: joints, pose of the end effector
/// (position and quaternion), and the gripper's width if `gripper` is true.
pub(super) fn names(gripper: bool) -> Vec<String> {
    let joints = (1..=7).map(|joint| format!("joint_{joint}.pos"));
    let pose = ["x", "y", "z", "qx", "qy", "qz", "qw"].map(|axis| format!("ee_{axis}.pos"));
    let gripper = gripper.then(|| "gripper.pos".to_owned());
    joints.chain(pose).chain(gripper).collect()
}

/// The frames of an episode: rows of states and actions, one after the other.
#[derive(Debug, PartialEq)]
pub(super) struct Frames {
    pub(super) count: usize,
    pub(super) state: Vec<f32>,
    pub(super) action: Vec<f32>,
}

/// The contents of a frame.
struct Moment {
    joints: [f64; 7],
    pose: Isometry3<f64>,
    width: Option<f64>,
}

impl Frames {
    /// Computes frames at this rate, starting at the first sample. The action of a frame is the
    /// target at the next frame. If the targets are references, samples before the first reference
    /// and after the last reference are omitted.
    /// the last reference are left out.
    ///
    /// Returns a text that explains why the samples are invalid.
    /// The reason why the samples are invalid.
    pub(super) fn of(
        samples: impl IntoIterator<Item = Sample>,
        fps: u16,
        gripper: bool,
        action: Action,
    ) -> Result<Self, String> {
        let (at_frames, last) = match action {
            Action::Measured => resampled(samples, fps)?,
            Action::Reference => {
                let samples: Vec<_> = samples.into_iter().collect();
                resampled(told(&samples).iter().copied(), fps)?
            }
        };
        let states = at_frames.iter().map(measured);
        let state = rows(states, gripper, None)?;
        let next = at_frames.iter().skip(1).chain([&last]);
        let actions = next.map(|sample| match action {
            Action::Measured => measured(sample),
            Action::Reference => Ok(Moment {
                joints: sample.q_ref.ok_or_else(|| uncontrolled(sample))?,
                pose: sample.pose_ref.ok_or_else(|| uncontrolled(sample))?,
                width: sample.width_ref.or(sample.width),
            }),
        });
        let action = rows(actions, gripper, Some(&at_frames[0].pose))?;
        Ok(Self {
            count: at_frames.len(),
            state,
            action,
        })
    }
}

fn measured(sample: &Sample) -> Result<Moment, String> {
    Ok(Moment {
        joints: sample.q,
        pose: sample.pose,
        width: sample.width,
    })
}

fn uncontrolled(sample: &Sample) -> String {
    let time = sample.time;
    format!(
        "no commanded position at {time} ms (robot clock): engage the arm for the whole \
         episode, or use measured positions (the action `measured`)"
    )
}

/// Returns the samples at the times of the frames, and the last sample.
fn resampled(
    samples: impl IntoIterator<Item = Sample>,
    fps: u16,
) -> Result<(Vec<Sample>, Sample), String> {
    let mut samples = samples.into_iter();
    let first = samples.next().ok_or("it has no cycles")?;
    let period = 1000.0 / f64::from(fps);
    let due = |frame: usize| period * frame as f64;
    let (mut frames, mut before) = (vec![first], first);
    for sample in samples {
        let step = sample
            .time
            .checked_sub(before.time)
            .filter(|step| *step > 0);
        let step = step.ok_or_else(|| {
            let (from, to) = (before.time, sample.time);
            format!(
                "the robot's clock goes back from {from} ms to {to} ms, expected increasing \
                times"
            )
        })?;
        if step as f64 > period.max(GAP_MIN) {
            let at = before.time;
            return Err(format!(
                "got no cycle for {step} ms after {at} ms of the robot's clock, expected gaps of \
                 {:.0} ms at most",
                period.max(GAP_MIN)
            ));
        }
        let end = (sample.time - first.time) as f64;
        while due(frames.len()) <= end {
            let begin = (before.time - first.time) as f64;
            let share = (due(frames.len()) - begin) / step as f64;
            frames.push(before.towards(&sample, share));
        }
        before = sample;
    }
    Ok((frames, before))
}

/// Text for an episode without widths in a dataset with a gripper.
const NO_WIDTH: &str = "its first cycles have no state of the Hand, expected one for each cycle, since the dataset has the width of a gripper";

/// Longest gap between cycles that is filled at any rate, `[ms]`. The robot itself tolerates a gap
/// of this length.
const GAP_MIN: f64 = 20.0;

/// Returns rows of numbers. Consecutive quaternions have the same sign. The first quaternion has
/// the sign of the pose `nearest`.
fn rows(
    moments: impl Iterator<Item = Result<Moment, String>>,
    gripper: bool,
    nearest: Option<&Isometry3<f64>>,
) -> Result<Vec<f32>, String> {
    let mut rows = Vec::new();
    let mut before = first_sign(nearest);
    for moment in moments {
        let Moment {
            joints,
            pose,
            width,
        } = moment?;
        let coordinates = pose.rotation.coords;
        let same = coordinates.dot(&before) >= 0.0;
        before = if same { coordinates } else { -coordinates };
        let width = gripper.then(|| width.ok_or(NO_WIDTH));
        let numbers = joints.iter().chain(&pose.translation.vector).chain(&before);
        rows.extend(numbers.map(|x| *x as f32));
        rows.extend(width.transpose()?.map(|x| x as f32));
    }
    Ok(rows)
}

/// Returns the quaternion that determines the sign of the first row. If `nearest` is `None`, this
/// is the quaternion of a hand that points down. Near this orientation, signs do not change between
/// episodes.
fn first_sign(nearest: Option<&Isometry3<f64>>) -> Vector4<f64> {
    let down = Vector4::new(1.0, 0.0, 0.0, 0.0);
    match nearest {
        Some(pose) if pose.rotation.coords.dot(&down) < 0.0 => -pose.rotation.coords,
        Some(pose) => pose.rotation.coords,
        None => down,
    }
}
