//! Frames, tools and loads as arguments.

use franka_async::Pose;
use franka_async::nalgebra::{Matrix3, Matrix4, Vector3};
use franka_model::{EndEffector, Frame, GRAVITY_EARTH, Load, transform};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Numbers, check_finite, pose_of, unexpected_shape, vector};

/// Returns the frame with this name.
///
/// # Errors
/// `ValueError` with all names.
pub(crate) fn frame(name: &str) -> PyResult<Frame> {
    let known = FRAMES.iter().zip(Frame::ALL);
    let mut frames = known.filter(|(known, _)| **known == name);
    frames.next().map(|(_, frame)| frame).ok_or_else(|| {
        let text = format!("frame is {name:?}, expected one of {}", FRAMES.join(", "));
        PyValueError::new_err(text)
    })
}

const FRAMES: [&str; 10] = [
    "joint1",
    "joint2",
    "joint3",
    "joint4",
    "joint5",
    "joint6",
    "joint7",
    "flange",
    "ee",
    "stiffness",
];

/// Returns the poses of the user's frames on the flange; the identity for a missing argument.
///
/// # Errors
/// `ValueError` for values that are not a pose.
#[allow(non_snake_case)]
pub(super) fn end_effector(
    F_T_EE: Option<&Bound<'_, PyAny>>,
    EE_T_K: Option<&Bound<'_, PyAny>>,
) -> PyResult<EndEffector> {
    Ok(EndEffector {
        f_t_ee: transformation("F_T_EE", F_T_EE)?,
        ee_t_k: transformation("EE_T_K", EE_T_K)?,
    })
}

/// Returns a transformation unchanged, because a robot's may deviate slightly from a rigid one.
fn transformation(name: &str, argument: Option<&Bound<'_, PyAny>>) -> PyResult<Matrix4<f64>> {
    let Some(argument) = argument else {
        return Ok(Matrix4::identity());
    };
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    let Some(pose) = pose_of(name, &shape, &values)? else {
        let expected = "(4, 4) or (7,): x y z and a quaternion x y z w";
        return Err(unexpected_shape(name, &shape, expected));
    };
    Ok(match *shape {
        [4, 4] => Matrix4::from_row_slice(&values),
        _ => transform::matrix(&pose),
    })
}

/// Returns the load with the mass `m_total`, the centre of mass `F_x_Ctotal` and the inertia
/// `I_total`.
///
/// # Errors
/// `ValueError` for a mass below zero or shapes other than `(3,)` and `(3, 3)`.
#[allow(non_snake_case)]
pub(crate) fn load(
    I_total: Option<&Bound<'_, PyAny>>,
    m_total: f64,
    F_x_Ctotal: Option<&Bound<'_, PyAny>>,
) -> PyResult<Load> {
    if !(m_total.is_finite() && m_total >= 0.0) {
        let text = format!("m_total is {m_total}, expected a mass of 0 kg or more");
        return Err(PyValueError::new_err(text));
    }
    let com = F_x_Ctotal.map_or(Ok([0.0; 3]), |argument| vector("F_x_Ctotal", argument))?;
    let inertia = I_total.map_or(Ok(Matrix3::zeros()), inertia)?;
    Ok(Load {
        mass: m_total,
        com: com.into(),
        inertia,
    })
}

fn inertia(argument: &Bound<'_, PyAny>) -> PyResult<Matrix3<f64>> {
    let Numbers { shape, values } = Numbers::read("I_total", argument)?;
    if shape != [3, 3] {
        return Err(unexpected_shape("I_total", &shape, "(3, 3)"));
    }
    check_finite("I_total", &values)?;
    Ok(Matrix3::from_row_slice(&values))
}

/// Returns the gravitational acceleration in the base frame; the value of an upright robot for a
/// missing argument.
///
/// # Errors
/// `ValueError` for another shape than `(3,)`.
pub(super) fn gravity(argument: Option<&Bound<'_, PyAny>>) -> PyResult<Vector3<f64>> {
    argument.map_or(Ok(GRAVITY_EARTH), |argument| {
        Ok(vector("gravity_earth", argument)?.into())
    })
}

/// Poses of an argument with one or many.
pub(super) struct Poses {
    poses: Vec<Pose>,
    is_single: bool,
}

impl Poses {
    /// Reads `(4, 4)`, `(7,)`, `(n, 4, 4)` or `(n, 7)`.
    ///
    /// # Errors
    /// `ValueError` for another shape and for invalid poses, with their index.
    pub(super) fn read(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Numbers { shape, values } = Numbers::read(name, argument)?;
        if let Some(pose) = pose_of(name, &shape, &values)? {
            let (poses, is_single) = (vec![pose], true);
            return Ok(Self { poses, is_single });
        }
        let poses: Option<Vec<Pose>> = match *shape {
            [_, 4, 4] | [_, 7] => {
                let shape = &shape[1..];
                let each = values.chunks_exact(shape.iter().product()).enumerate();
                let each = each.map(|(i, values)| pose_of(&format!("{name}[{i}]"), shape, values));
                each.collect::<PyResult<_>>()?
            }
            _ => None,
        };
        let is_single = false;
        let poses = poses.ok_or_else(|| {
            let expected = "(4, 4), (7,), (n, 4, 4) or (n, 7)";
            unexpected_shape(name, &shape, expected)
        })?;
        Ok(Self { poses, is_single })
    }

    /// Returns pose `index`; a single pose is used for every index.
    pub(super) fn get(&self, index: usize) -> &Pose {
        &self.poses[if self.is_single { 0 } else { index }]
    }

    /// The number of poses; `None` for one without a leading axis.
    pub(super) fn count(&self) -> Option<usize> {
        (!self.is_single).then_some(self.poses.len())
    }
}
