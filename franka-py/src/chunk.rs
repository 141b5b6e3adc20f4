//! Chunks: points with times in arrays.

use std::time::Duration;

use franka_async::goal::Chunk;
use franka_async::nalgebra::{Translation3, UnitQuaternion};
use franka_async::{Arm, Pose};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{Numbers, rows, unexpected_shape};
use crate::destination::place;
use crate::operation::seconds;
use crate::state::RobotState;

/// Reads a `franka_async.goal.Chunk`. Positions keep the arm's current commanded orientation.
///
/// # Errors
/// `ValueError`, `TypeError`.
pub(crate) fn chunk(chunk: &Bound<'_, PyAny>, arm: &Arm) -> PyResult<Chunk> {
    let points = chunk.getattr("points")?;
    let numbers = Numbers::read("points", &points)?;
    let count = numbers.shape.first().copied().unwrap_or(0);
    let times = times(chunk, count)?;
    let velocities = chunk.getattr("velocities")?;
    let velocities = (!velocities.is_none()).then_some(velocities);
    let made = if chunk.getattr("joints")?.extract()? {
        let q = many::<7>("points", &points, count)?;
        match velocities {
            None => Chunk::joints(times.into_iter().zip(q)),
            Some(velocities) => {
                let dq = many::<7>("velocities", &velocities, count)?;
                let points = times.into_iter().zip(q).zip(dq);
                Chunk::joints_with_velocities(points.map(|((time, q), dq)| (time, q, dq)))
            }
        }
    } else {
        let poses = poses(&numbers, arm)?;
        match velocities {
            None => Chunk::poses(times.into_iter().zip(poses)),
            Some(velocities) => {
                let twists = many::<6>("velocities", &velocities, count)?;
                let points = times.into_iter().zip(poses).zip(twists);
                Chunk::poses_with_twists(points.map(|((time, pose), twist)| (time, pose, twist)))
            }
        }
    };
    let mut made = made.map_err(|error| PyValueError::new_err(error.to_string()))?;
    let observed = chunk.getattr("observed_at")?;
    if let Ok(state) = observed.cast::<RobotState>() {
        made = made.observed_at(state.get().state.message_id);
    } else if !observed.is_none() {
        let Ok(time) = observed.extract() else {
            let got = observed.repr()?;
            let text = format!("observed_at is {got}, expected a RobotState or its time_ms");
            return Err(PyTypeError::new_err(text));
        };
        made = made.observed_at(time);
    }
    if let Some(blend) = chunk.getattr("blend")?.extract::<Option<f64>>()? {
        made = made.blend(seconds("blend", blend)?);
    }
    Ok(made)
}

/// Returns the time of each of `count` points.
fn times(chunk: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<Duration>> {
    let (dt, times) = (chunk.getattr("dt")?, chunk.getattr("times")?);
    match (dt.is_none(), times.is_none()) {
        (false, true) => {
            let dt = seconds("dt", dt.extract()?)?;
            (0..count)
                .map(|i| {
                    let step = u32::try_from(i).ok().and_then(|i| dt.checked_mul(i));
                    step.ok_or_else(|| {
                        PyValueError::new_err(
                            "dt is too long, expected at most 60 \
                        s for the whole chunk",
                        )
                    })
                })
                .collect()
        }
        (true, false) => {
            let numbers = Numbers::read("times", &times)?;
            if numbers.shape != [count] {
                let expected = format!("({count},), a time for each point");
                return Err(unexpected_shape("times", &numbers.shape, &expected));
            }
            let times = numbers.values.into_iter();
            times.map(|time| seconds("times", time)).collect()
        }
        _ => Err(PyValueError::new_err(
            "got both or neither of dt and times, expected one: dt, the time between two points, \
             or the times of all points",
        )),
    }
}

/// Returns `count` rows of `N` numbers.
fn many<const N: usize>(
    name: &str,
    argument: &Bound<'_, PyAny>,
    count: usize,
) -> PyResult<Vec<[f64; N]>> {
    let rows = rows::<N>(name, argument)?;
    if rows.len() != count {
        let expected = format!("({count}, {N}), a row for each point");
        return Err(unexpected_shape(name, &[rows.len(), N], &expected));
    }
    Ok(rows)
}

/// Returns the poses of positions `(N, 3)`, or of poses `(N, 7)` or `(N, 4, 4)`.
fn poses(points: &Numbers, arm: &Arm) -> PyResult<Vec<Pose>> {
    let width = match *points.shape {
        [_, 3] => 3,
        [_, 7] => 7,
        [_, 4, 4] => 16,
        _ => {
            let expected = "positions (N, 3), poses (N, 7) or (N, 4, 4)";
            return Err(unexpected_shape("points", &points.shape, expected));
        }
    };
    let kept = || -> UnitQuaternion<f64> {
        let reference = arm.reference().map(|reference| reference.pose);
        reference.unwrap_or_else(|| arm.robot().pose()).rotation
    };
    let kept = if width == 3 {
        kept()
    } else {
        UnitQuaternion::identity()
    };
    let pose = |(i, row): (usize, &[f64])| {
        let name = format!("point {i}");
        match width {
            3 if row.iter().all(|value| value.is_finite()) => {
                let position = Translation3::new(row[0], row[1], row[2]);
                Ok(Pose::from_parts(position, kept))
            }
            3 => Err(PyValueError::new_err(format!(
                "{name} is {row:?}, expected finite numbers"
            ))),
            _ => {
                let pose = place(&name, &points.shape[1..], row, "need joints=True")?;
                Ok(pose.expect("one of its shapes"))
            }
        }
    };
    points.values.chunks(width).enumerate().map(pose).collect()
}
