//! First-order low-pass filters.
//!
//! A filter returns `y = g x + (1 - g) y_last` with `g = T / (T + 1 / (2 pi f))`, for the sample
//! time `T` and the cutoff frequency `f`. For example, `g` is 0.386 at 1 ms and 100 Hz.

use core::f64::consts::PI;

use crate::shaping::check::all_finite;
use crate::shaping::rotation::{Rigid, slerp};
use crate::shaping::{FilterFault, InvalidCommand, Signal};

/// Cutoff frequency at and above which a control loop does not filter, `[Hz]` (libfranka 0.21,
/// `lowpass_filter.h`).
pub const MAX_CUTOFF_FREQUENCY: f64 = 1000.0;

/// Default cutoff frequency of a control loop, `[Hz]` (libfranka 0.21, `lowpass_filter.h`).
pub const DEFAULT_CUTOFF_FREQUENCY: f64 = 100.0;

/// Filters a number. `last` is the last filtered value, `sample_time` is in `[s]` and may be 0, and
/// `cutoff_frequency` is in `[Hz]`.
///
/// # Errors
/// Returns [`InvalidCommand::Filter`] if an argument is not finite or has the wrong sign.
pub fn low_pass(
    sample_time: f64,
    current: f64,
    last: f64,
    cutoff_frequency: f64,
) -> Result<f64, InvalidCommand> {
    let [filtered] = low_pass_each(sample_time, &[current], &[last], cutoff_frequency)?;
    Ok(filtered)
}

/// Filters each number of an array as [`low_pass`] does.
///
/// # Errors
/// Returns the errors of [`low_pass`].
pub fn low_pass_each<const N: usize>(
    sample_time: f64,
    current: &[f64; N],
    last: &[f64; N],
    cutoff_frequency: f64,
) -> Result<[f64; N], InvalidCommand> {
    let gain = checked_gain(sample_time, current, last, cutoff_frequency);
    let gain = gain.map_err(|fault| InvalidCommand::Filter {
        signal: Signal::Scalar,
        fault,
    })?;
    Ok(core::array::from_fn(|i| mix(gain, current[i], last[i])))
}

/// Filters a pose in column-major order: the translation as [`low_pass`] does, the orientation
/// along the arc from the orientation of `last`.
///
/// The rotation block of each pose is first replaced by the nearest rotation. The last row is
/// copied from `current`.
///
/// # Errors
/// Returns [`InvalidCommand::Filter`] if an argument is not finite or has the wrong sign.
pub fn low_pass_pose(
    sample_time: f64,
    current: &[f64; 16],
    last: &[f64; 16],
    cutoff_frequency: f64,
) -> Result<[f64; 16], InvalidCommand> {
    let rigid_last = Rigid::nearest(last);
    low_pass_rigid(sample_time, current, last, &rigid_last, cutoff_frequency)
        .map(|filtered| filtered.pose())
}

/// Does the same as [`low_pass_pose`], for poses that [`Rigid::nearest`] returned.
pub(crate) fn low_pass_rigid(
    sample_time: f64,
    current: &[f64; 16],
    last: &[f64; 16],
    rigid_last: &Rigid,
    cutoff_frequency: f64,
) -> Result<Rigid, InvalidCommand> {
    let gain = checked_gain(sample_time, current, last, cutoff_frequency);
    let gain = gain.map_err(|fault| InvalidCommand::Filter {
        signal: Signal::Pose,
        fault,
    })?;
    let (from, to) = (rigid_last, Rigid::nearest(current));
    let orientation = slerp(&from.orientation, &to.orientation, gain);
    Ok(Rigid {
        rotation: orientation.to_rotation_matrix().into_inner(),
        orientation,
        translation: to
            .translation
            .zip_map(&from.translation, |to, from| mix(gain, to, from)),
        last_row: to.last_row,
    })
}

/// Returns the weight of the new value.
pub(crate) const fn gain(sample_time: f64, cutoff_frequency: f64) -> f64 {
    sample_time / (sample_time + (1.0 / (2.0 * PI * cutoff_frequency)))
}

/// Returns the weighted mean of the new value and the last value. `gain` is the weight of the new
/// value.
pub(crate) fn mix(gain: f64, current: f64, last: f64) -> f64 {
    gain * current + (1.0 - gain) * last
}

fn checked_gain(
    sample_time: f64,
    current: &[f64],
    last: &[f64],
    cutoff_frequency: f64,
) -> Result<f64, FilterFault> {
    if !sample_time.is_finite() || sample_time < 0.0 {
        return Err(FilterFault::SampleTime);
    }
    if !cutoff_frequency.is_finite() || cutoff_frequency <= 0.0 {
        return Err(FilterFault::CutoffFrequency);
    }
    if !all_finite(current) || !all_finite(last) {
        return Err(FilterFault::Value);
    }
    Ok(gain(sample_time, cutoff_frequency))
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::transform;
    use nalgebra::{Isometry3, Vector3};

    #[test]
    fn the_gain_at_1_ms_and_100_hz_is_that_of_libfranka() {
        assert_eq!(gain(1e-3, DEFAULT_CUTOFF_FREQUENCY), 0.3858695450950375);
        assert_eq!(low_pass(1e-3, 1.0, 0.0, 100.0), Ok(0.3858695450950375));
    }

    #[test]
    fn without_time_nothing_changes() {
        assert_eq!(low_pass(0.0, 1.0, 0.25, 100.0), Ok(0.25));
        assert_eq!(low_pass_each(0.0, &[1.0; 3], &[2.0; 3], 1.0), Ok([2.0; 3]));
    }

    #[test]
    fn a_pose_goes_the_share_of_the_gain_along_the_way() {
        let last = Isometry3::new(Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.0, 0.0, 0.5));
        let current = Isometry3::new(Vector3::new(0.2, 0.2, 0.3), Vector3::new(0.0, 0.0, 1.5));
        let got = low_pass_pose(
            1e-3,
            &transform::array(&current),
            &transform::array(&last),
            100.0,
        );
        let g = 0.3858695450950375;
        let expected = Isometry3::new(
            Vector3::new(0.1 + 0.1 * g, 0.2, 0.3),
            Vector3::new(0.0, 0.0, 0.5 + g),
        );
        let got = got.expect("both are poses");
        let errors = got.iter().zip(transform::array(&expected));
        assert!(
            errors
                .map(|(got, want)| (got - want).abs())
                .all(|error| error < 1e-15)
        );
    }

    #[test]
    fn faults_are_named_in_the_order_of_the_arguments() {
        let fault = |time, x, cutoff| match low_pass_pose(time, &[x; 16], &[x; 16], cutoff) {
            Err(InvalidCommand::Filter {
                signal: Signal::Pose,
                fault,
            }) => Some(fault),
            _ => None,
        };
        assert_eq!(fault(-1.0, f64::NAN, 0.0), Some(FilterFault::SampleTime));
        assert_eq!(
            fault(1e-3, f64::NAN, 0.0),
            Some(FilterFault::CutoffFrequency)
        );
        assert_eq!(fault(1e-3, f64::NAN, 1.0), Some(FilterFault::Value));
        assert_eq!(fault(1e-3, 0.5, 1.0), None);
    }

    #[test]
    fn the_texts_are_those_of_libfranka() {
        assert_eq!(
            low_pass(f64::NAN, 0.0, 0.0, 100.0).unwrap_err().to_string(),
            "lowpass-filter: sample_time is negative, infinite or NaN."
        );
        assert_eq!(
            low_pass_pose(1e-3, &[0.0; 16], &[0.0; 16], -1.0)
                .unwrap_err()
                .to_string(),
            "Cartesian lowpass-filter: cutoff_frequency is zero, negative, infinite or NaN."
        );
    }
}
