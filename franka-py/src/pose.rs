//! Conversion of poses from positions and quaternions, and back.

use franka_async::nalgebra::{UnitQuaternion, Vector3};
use franka_async::pose;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{array, pose as read, pose_array, vector};

/// Returns the pose, `(4, 4)`, of a position, 3 numbers, m, and a quaternion `x y z w` of any
/// non-zero length.
#[pyfunction]
pub(crate) fn from_xyzw<'py>(
    py: Python<'py>,
    position: &Bound<'_, PyAny>,
    quaternion: &Bound<'_, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let quaternion = vector("quaternion", quaternion)?;
    let made = pose::from_xyzw(vector("position", position)?, quaternion);
    let text = || format!("quaternion is {quaternion:?}, expected a length above 0");
    let made = made.ok_or_else(|| PyValueError::new_err(text()))?;
    Ok(pose_array(py, &made))
}

/// Position and quaternion of a pose.
type Parts<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// Returns the position, `(3,)` m, and the quaternion, `(4,)` `x y z w` of length 1 with w >= 0, of
/// a pose, `(4, 4)`.
#[pyfunction]
pub(crate) fn to_xyzw<'py>(py: Python<'py>, pose: &Bound<'_, PyAny>) -> PyResult<Parts<'py>> {
    let (position, mut quaternion) = pose::to_xyzw(&read("pose", pose)?);
    if quaternion[3] < 0.0 {
        quaternion = quaternion.map(|part| -part);
    }
    Ok((array(py, &position), array(py, &quaternion)))
}

/// Returns the pose, `(4, 4)`, rotated by a rotation vector, 3 numbers, rad, about the axes of the
/// `base`, or of the `tool`, through its position, which stays the same.
#[pyfunction]
#[pyo3(signature = (pose, rotation_vector, frame = "base"))]
pub(crate) fn rotated<'py>(
    py: Python<'py>,
    pose: &Bound<'_, PyAny>,
    rotation_vector: &Bound<'_, PyAny>,
    frame: &str,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut pose = read("pose", pose)?;
    let turn = Vector3::from(vector::<3>("rotation_vector", rotation_vector)?);
    let turn = UnitQuaternion::from_scaled_axis(turn);
    match frame {
        "base" => pose = pose::rotated(&pose, turn),
        "tool" => pose.rotation *= turn,
        _ => {
            let text = format!("frame is {frame:?}, expected 'base' or 'tool'");
            return Err(PyValueError::new_err(text));
        }
    }
    Ok(pose_array(py, &pose))
}
