//! Where a motion is to lead: what Python says it with.

use franka_async::Pose;
use franka_async::goal::Destination;
use franka_async::pose;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyAny, PySequence};

use crate::arrays::{Numbers, pose_of, unexpected_shape, vector};

/// Reads a destination of the end effector from the argument called `name`: a pose, `(4, 4)` or 3 + 4
/// numbers; a pair of position and quaternion; or a position alone, which keeps the orientation.
///
/// # Errors
/// `ValueError`, `TypeError`.
pub(crate) fn destination(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Destination> {
    if let Some((position, quaternion)) = pair(argument) {
        return Ok(placed(name, &position, &quaternion)?.into());
    }
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    if *shape == [3] {
        return Ok(Destination::position(vector::<3>(name, argument)?));
    }
    match pose_of(name, &shape, &values)? {
        Some(pose) => Ok(pose.into()),
        None => Err(unexpected_shape(name, &shape, SHAPES)),
    }
}

const SHAPES: &str =
    "(4, 4); (3,), a position; (7,), x y z and a quaternion x y z w; or a pair of the two";

/// The pose of this position and quaternion `x y z w`.
fn placed(
    name: &str,
    position: &Bound<'_, PyAny>,
    quaternion: &Bound<'_, PyAny>,
) -> PyResult<Pose> {
    let position = vector(&format!("the position of {name}"), position)?;
    let quaternion = vector(&format!("the quaternion of {name}"), quaternion)?;
    pose::from_xyzw(position, quaternion).ok_or_else(|| {
        let text = format!("{name} has the quaternion {quaternion:?}, which has no direction");
        PyValueError::new_err(text)
    })
}

/// The two parts of a pair, each of which has parts itself.
fn pair<'py>(argument: &Bound<'py, PyAny>) -> Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let sequence = argument.cast::<PySequence>().ok()?;
    let first = (sequence.len().ok()? == 2).then(|| sequence.get_item(0).ok())??;
    first.len().ok()?;
    Some((first, sequence.get_item(1).ok()?))
}
