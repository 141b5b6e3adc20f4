//! Destinations of motions, from their Python forms.

use franka_async::goal::{Destination, Target, Waypoint};
use franka_async::nalgebra::{Matrix4, Translation3, UnitQuaternion, Vector3};
use franka_async::{Offset, Pose};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PySequence};

use crate::arrays::{
    Numbers, array, check_finite, from_xyzw, pose_array, pose_of, unexpected_shape, vector,
};

/// Reads a destination of the end effector or the joints from the argument `name`, as described by
/// `franka_async.goal.Destination`.
///
/// # Errors
/// `ValueError`, `TypeError`.
pub(crate) fn destination(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Destination> {
    if is(argument, "Offset")? {
        let way = argument.getattr("way")?;
        let frame: String = argument.getattr("frame")?.extract()?;
        let from_arm = argument.getattr("from_arm")?.extract()?;
        return Ok(offset(name, &way, &frame, from_arm)?.into());
    }
    if let Some(target) = composed(name, argument)? {
        return Ok(target.into());
    }
    let numbers = Numbers::read(name, argument)?;
    match *numbers.shape {
        [3] => Ok(Destination::position(vector::<3>(name, argument)?)),
        [4] | [3, 3] => Ok(Destination::orientation(orientation(name, &numbers)?)),
        _ => match place(name, &numbers.shape, &numbers.values, JOINTS)? {
            Some(pose) => Ok(pose.into()),
            None => {
                let also = "a position (3,), a quaternion (4,) or a rotation matrix (3, 3)";
                let expected = format!("{SHAPES}; {also}");
                Err(unexpected_shape(name, &numbers.shape, &expected))
            }
        },
    }
}

/// Reads a target, a whole pose or joint positions, from the argument `name`, as described by
/// `franka_async.goal.Target`.
///
/// # Errors
/// `ValueError`, `TypeError`.
pub(crate) fn target(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Target> {
    match composed(name, argument)? {
        Some(target) => Ok(target),
        None => match whole_pose(name, argument) {
            Err(_) if is(argument, "Offset")? => Err(PyTypeError::new_err(format!(
                "{name} is an Offset, expected a pose or Joints: make a pose with robot.pose() @ \
                 way"
            ))),
            pose => Ok(pose?.into()),
        },
    }
}

/// The way to specify joint positions.
const JOINTS: &str = "are Joints(q), or go to move_joints";

const SHAPES: &str = "a pose (4, 4) or (7,), x y z and a quaternion x y z w";

fn whole_pose(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let numbers = Numbers::read(name, argument)?;
    place(name, &numbers.shape, &numbers.values, JOINTS)?
        .ok_or_else(|| unexpected_shape(name, &numbers.shape, SHAPES))
}

/// Like [`pose_of`], but the last four of seven numbers must have about the length of a quaternion,
/// which excludes joint positions given by mistake. The error for them contains `joints`.
pub(crate) fn place(
    name: &str,
    shape: &[usize],
    values: &[f64],
    joints: &str,
) -> PyResult<Option<Pose>> {
    if let ([7], [_, _, _, quaternion @ ..]) = (shape, values) {
        let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (length - 1.0).abs() > LENGTH_OFF {
            let text = format!(
                "{name} has a quaternion of length {length:.3} after its position, expected 1; \
                 joint positions {joints}"
            );
            return Err(PyValueError::new_err(text));
        }
    }
    pose_of(name, shape, values)
}

/// Largest deviation of a quaternion's length from 1: its numbers may be rounded.
const LENGTH_OFF: f64 = 0.1;

/// Returns a target that is `Joints` or a pair.
fn composed(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Option<Target>> {
    if is(argument, "Joints")? {
        let q = vector::<7>(name, &argument.getattr("q")?)?;
        let dq = argument.getattr("dq")?;
        return Ok(Some(if dq.is_none() {
            q.into()
        } else {
            (q, vector::<7>("dq", &dq)?).into()
        }));
    }
    let Some((first, second)) = pair(argument) else {
        return Ok(None);
    };
    let shape = Numbers::read(name, &second)?.shape;
    Ok(Some(match *shape {
        [4] => placed(name, &first, &second)?.into(),
        [6] => {
            let twist = vector::<6>(&format!("the twist of {name}"), &second)?;
            (whole_pose(name, &first)?, twist.into()).into()
        }
        [7] => {
            let q = vector::<7>(&format!("the joint positions of {name}"), &first)?;
            let dq = vector::<7>(&format!("the joint velocities of {name}"), &second)?;
            (q, dq).into()
        }
        _ => {
            let expected = "(4,), a quaternion after a position; (6,), a twist after a pose; \
                            or (7,), joint velocities after joint positions";
            let name = format!("the second of the pair {name}");
            return Err(unexpected_shape(&name, &shape, expected));
        }
    }))
}

/// Returns the pose of this position and quaternion `x y z w`.
fn placed(
    name: &str,
    position: &Bound<'_, PyAny>,
    quaternion: &Bound<'_, PyAny>,
) -> PyResult<Pose> {
    let position = vector(&format!("the position of {name}"), position)?;
    let quaternion = vector(&format!("the quaternion of {name}"), quaternion)?;
    from_xyzw(name, position, quaternion)
}

/// Returns the orientation of a quaternion `x y z w` or a rotation matrix.
fn orientation(name: &str, numbers: &Numbers) -> PyResult<UnitQuaternion<f64>> {
    let values = &numbers.values;
    if let Ok(quaternion) = <[f64; 4]>::try_from(&values[..]) {
        check_finite(name, &quaternion)?;
        return Ok(from_xyzw(name, [0.0; 3], quaternion)?.rotation);
    }
    let matrix = Matrix4::from_fn(|i, j| match (i, j) {
        (0..3, 0..3) => values[3 * i + j],
        (3, 3) => 1.0,
        _ => 0.0,
    });
    let values = matrix.transpose();
    let pose = pose_of(name, &[4, 4], values.as_slice())?.expect("its shape");
    Ok(pose.rotation)
}

/// Reads an offset: 3 numbers, 6 with a rotation vector, or a pose.
///
/// # Errors
/// `ValueError`, `TypeError`.
pub(crate) fn offset(
    name: &str,
    way: &Bound<'_, PyAny>,
    frame: &str,
    from_arm: bool,
) -> PyResult<Offset> {
    let Numbers { shape, values } = Numbers::read(name, way)?;
    let way = match *shape {
        [3] | [6] => {
            let moved = |i: usize| Vector3::from_column_slice(&values[i..i + 3]);
            let turn = if *shape == [6] {
                moved(3)
            } else {
                Vector3::zeros()
            };
            if values.iter().any(|value| !value.is_finite()) {
                let text = format!("{name} is {values:?}, expected finite numbers");
                return Err(PyValueError::new_err(text));
            }
            Pose::from_parts(
                Translation3::from(moved(0)),
                UnitQuaternion::from_scaled_axis(turn),
            )
        }
        _ => pose_of(name, &shape, &values)?.ok_or_else(|| {
            let expected = "(3,), m; (6,), with a rotation vector, rad; or a pose (4, 4) or (7,)";
            unexpected_shape(name, &shape, expected)
        })?,
    };
    let offset = match frame {
        "base" => Offset::base(way),
        "tool" => Offset::tool(way),
        _ => {
            let text = format!("frame is {frame:?}, expected 'base' or 'tool'");
            return Err(PyValueError::new_err(text));
        }
    };
    Ok(if from_arm { offset.from_arm() } else { offset })
}

/// Reads waypoints: targets, which are rounded within `blend`, and `Waypoint`s, which contain their
/// own blend.
///
/// # Errors
/// `ValueError`, `TypeError`.
pub(crate) fn waypoints(argument: &Bound<'_, PyAny>, blend: f64) -> PyResult<Vec<Waypoint>> {
    let waypoint = |(i, place): (usize, PyResult<Bound<'_, PyAny>>)| {
        let (place, name) = (place?, format!("waypoint {}", i + 1));
        if is(&place, "Waypoint")? {
            let at = target(&name, &place.getattr("target")?)?;
            return Ok(Waypoint::new(at).blend(place.getattr("blend")?.extract()?));
        }
        Ok(Waypoint::new(target(&name, &place)?).blend(blend))
    };
    argument.try_iter()?.enumerate().map(waypoint).collect()
}

/// Returns the Python object for a target: a pose `(4, 4)`, `Joints`, or a pair of a pose and its
/// twist. `None` for rest and hand guiding, which have no place.
pub(crate) fn target_object<'py>(
    py: Python<'py>,
    target: Target,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let joints = || py.import("franka_async.goal")?.getattr("Joints");
    Ok(Some(match target {
        Target::Pose(pose) => pose_array(py, &pose).into_any(),
        Target::MovingPose { pose, twist } => (pose_array(py, &pose), array(py, twist.as_slice()))
            .into_pyobject(py)?
            .into_any(),
        Target::Joints(q) => joints()?.call1((array(py, &q),))?,
        Target::MovingJoints { q, dq } => joints()?.call1((array(py, &q), array(py, &dq)))?,
        _ => return Ok(None),
    }))
}

/// True if the argument is an instance of this class of `franka_async.goal`.
pub(crate) fn is(argument: &Bound<'_, PyAny>, class: &str) -> PyResult<bool> {
    let module = argument.py().import("franka_async.goal")?;
    argument.is_instance(&module.getattr(class)?)
}

/// Returns the two parts of a pair, each of which has parts itself.
fn pair<'py>(argument: &Bound<'py, PyAny>) -> Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let sequence = argument.cast::<PySequence>().ok()?;
    let first = (sequence.len().ok()? == 2).then(|| sequence.get_item(0).ok())??;
    first.len().ok()?;
    Some((first, sequence.get_item(1).ok()?))
}
