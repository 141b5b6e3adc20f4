//! The model of an arm: kinematics, dynamics, limits, inverse kinematics, distances.
//!
//! | module | content |
//! |---|---|
//! | this | the class, poses and Jacobians, and its pickled form |
//! | `arguments` | frames, tools and loads |
//! | `dynamics` | mass, Coriolis, gravity, inverse and forward dynamics |
//! | `ik` | joint positions for a pose, joint velocities for a twist |
//! | `limits` | limits of the joints and of Cartesian motions |
//! | `clearance` | distances within the arm |

pub(crate) mod arguments;
mod clearance;
mod dynamics;
mod ik;
mod limits;

pub(crate) use clearance::Clearance;
pub(crate) use dynamics::Dynamics;
pub(crate) use limits::{CartesianLimits, JointLimits, MotionLimits};

use franka_model::{EndEffector, Frame, Model as Numbers, RobotKind};
use numpy::PyArrayDyn;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyTuple};

use crate::batch::{Batch, Cost, output, write_matrix};
use crate::robot::Robot;
use arguments::{end_effector, frame};

#[pymethods]
impl Robot {
    /// The model of the connected arm, used by control. For a Franka Research 3 it comes from the
    /// robot's description, for a Franka Emika Robot from the constants of its own library.
    fn model(&self) -> PyResult<Model> {
        Ok(Model::of(self.connected()?.model()))
    }
}

/// An array whose number of axes depends on the arguments.
type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Kinematics, dynamics and limits of one arm, without a connection: `Model.fr3()`, `Model.fer()`,
/// `Model.from_urdf(text)`.
///
/// Joint positions `q` (rad), velocities `dq` (rad/s) and so on are one vector, `(7,)`, or a batch,
/// `(n, 7)`: results of a batch have a leading axis of length n. If a function has several
/// arguments, a single one is used for the whole batch of the other. Batches release the
/// interpreter to other threads.
///
/// Frames are `joint1` to `joint7`, `flange`, `ee` (the end effector, `F_T_EE` from the flange) and
/// `stiffness` (`EE_T_K` from the end effector); both poses are the identity unless given. The base
/// frame is the frame of link 0, z upwards along the axis of joint 1. Wrong shapes and numbers that
/// are not finite raise `ValueError`.
#[pyclass(frozen, eq, module = "franka_async")]
#[derive(PartialEq)]
pub(crate) struct Model {
    numbers: Numbers,
    /// The description of the model.
    urdf: Option<Box<str>>,
}

#[pymethods]
impl Model {
    /// The Franka Research 3, with the vendor's numbers.
    #[staticmethod]
    fn fr3() -> Self {
        Self::of(Numbers::fr3())
    }

    /// The Franka Emika Robot (Panda), as computed by its own model library.
    #[staticmethod]
    fn fer() -> Self {
        Self::of(Numbers::fer())
    }

    /// The model from the URDF `text` of a Franka Research 3, with the masses and limits of that
    /// arm. `ValueError` describes the error in another text.
    #[staticmethod]
    fn from_urdf(text: &str) -> PyResult<Self> {
        let numbers = Numbers::from_urdf(text).map_err(|error| {
            PyValueError::new_err(format!("text does not describe a supported arm: {error}"))
        })?;
        let urdf = Some(text.into());
        Ok(Self { numbers, urdf })
    }

    /// Kind of robot: `fr3` or `fer`.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.numbers.kind() {
            RobotKind::Fer => "fer",
            _ => "fr3",
        }
    }

    /// The pose of `frame` in the base frame, `(4, 4)` or `(n, 4, 4)`.
    ///
    /// `F_T_EE` and `EE_T_K` are the identity unless given, even if a robot has a tool: pass the
    /// values of its state for its own `ee` and `stiffness`. `Robot.pose_at` uses the robot's
    /// `F_T_EE`.
    #[pyo3(signature = (frame, q, F_T_EE = None, EE_T_K = None))]
    #[allow(non_snake_case)]
    fn pose<'py>(
        &self,
        py: Python<'py>,
        frame: &str,
        q: &Bound<'py, PyAny>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
        EE_T_K: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let ee = end_effector(F_T_EE, EE_T_K)?;
        let (frame, q) = (self::frame(frame)?, Batch::read("q", q)?);
        Ok(self.poses(py, frame, &q, &ee))
    }

    /// Twist of `frame` per joint velocity, in base axes about the frame's origin, linear rows
    /// first: `(6, 7)` or `(n, 6, 7)`. Tools as for `pose`: the identity unless given.
    #[pyo3(signature = (frame, q, F_T_EE = None, EE_T_K = None))]
    #[allow(non_snake_case)]
    fn zero_jacobian<'py>(
        &self,
        py: Python<'py>,
        frame: &str,
        q: &Bound<'py, PyAny>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
        EE_T_K: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let ee = end_effector(F_T_EE, EE_T_K)?;
        let (frame, q) = (self::frame(frame)?, Batch::read("q", q)?);
        let model = &self.numbers;
        Ok(output(py, q.count(), &[6, 7], Cost::Little, |i, row| {
            write_matrix(&model.zero_jacobian(frame, &(*q.row(i)).into(), &ee), row);
        }))
    }

    /// `zero_jacobian` in the frame's own axes. Tools as for `pose`: the identity unless given.
    #[pyo3(signature = (frame, q, F_T_EE = None, EE_T_K = None))]
    #[allow(non_snake_case)]
    fn body_jacobian<'py>(
        &self,
        py: Python<'py>,
        frame: &str,
        q: &Bound<'py, PyAny>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
        EE_T_K: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let ee = end_effector(F_T_EE, EE_T_K)?;
        let (frame, q) = (self::frame(frame)?, Batch::read("q", q)?);
        let model = &self.numbers;
        Ok(output(py, q.count(), &[6, 7], Cost::Little, |i, row| {
            write_matrix(&model.body_jacobian(frame, &(*q.row(i)).into(), &ee), row);
        }))
    }

    /// The poses of link 1 to link 7 and of the flange in the base frame, `(8, 4, 4)` or
    /// `(n, 8, 4, 4)`: for drawing the arm.
    fn link_poses<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let q = Batch::read("q", q)?;
        let (model, ee) = (&self.numbers, EndEffector::default());
        Ok(output(py, q.count(), &[8, 4, 4], Cost::Little, |i, row| {
            let q = (*q.row(i)).into();
            for (frame, row) in Frame::ALL.iter().zip(row.as_chunks_mut::<16>().0) {
                write_matrix(&model.pose(*frame, &q, &ee), row);
            }
        }))
    }

    /// Distance of an arm from a singularity: `sqrt(det(J J'))`, 0 in a singularity, 0.080 in the
    /// ready pose. A number, or `(n,)`.
    fn manipulability<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let q = Batch::read("q", q)?;
        let (model, ee) = (&self.numbers, EndEffector::default());
        Ok(output(py, q.count(), &[], Cost::Little, |i, row| {
            let jacobian = model.zero_jacobian(Frame::Flange, &(*q.row(i)).into(), &ee);
            row[0] = franka_model::manipulability(&jacobian);
        }))
    }

    fn __repr__(&self) -> String {
        match &self.urdf {
            Some(_) => format!("<Model of a {}, from its description>", self.kind()),
            None => format!("Model.{}()", self.kind()),
        }
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let class = py.get_type::<Self>();
        if let Some(text) = &self.urdf {
            return Ok((class.getattr("from_urdf")?, PyTuple::new(py, [&**text])?));
        }
        if self.numbers != *Numbers::of(self.numbers.kind()) {
            let text = "cannot pickle this model with changed numbers: only models from from_urdf \
                can be pickled";
            return Err(PyTypeError::new_err(text));
        }
        Ok((class.getattr(self.kind())?, PyTuple::empty(py)))
    }
}

impl Model {
    /// Returns the model with these numbers.
    pub(crate) fn of(numbers: &Numbers) -> Self {
        Self {
            numbers: numbers.clone(),
            urdf: None,
        }
    }

    fn poses<'py>(
        &self,
        py: Python<'py>,
        frame: Frame,
        q: &Batch<7>,
        ee: &EndEffector,
    ) -> Array<'py> {
        output(py, q.count(), &[4, 4], Cost::Little, |i, row| {
            write_matrix(&self.numbers.pose(frame, &(*q.row(i)).into(), ee), row);
        })
    }
}
