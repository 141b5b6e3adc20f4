//! Sessions that have not begun, and their options.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use franka_async::goal::{Backend, Controller, Setpoints};
use franka_async::model::collision::Obstacle;
use franka_async::nalgebra::{UnitVector3, Vector3};
use franka_async::{Engage, MotionError};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict};

use crate::arm::Arm;
use crate::arrays::{pose, vector};
use crate::deadman::Deadman;
use crate::destination::is;
use crate::operation::Operation;
use crate::options::{Keywords, Options, with_options};
use crate::told::{Told, leave};

/// A session that begins when it is awaited, or entered with `async with`, and is then an `Arm`.
#[pyclass(frozen, extends = Operation, module = "franka_async")]
pub(crate) struct Engagement {
    entered: Arc<Entered>,
}

/// The session of a `with` block.
#[derive(Default)]
struct Entered {
    is_entered: AtomicBool,
    session: OnceLock<(Told, franka_async::Arm)>,
}

impl Engagement {
    pub(crate) fn new(
        py: Python<'_>,
        robot: franka_async::Robot,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<Self>> {
        let mut keywords = Keywords::new("Robot.engage", options)?;
        let common = Options::of_session(&mut keywords, robot.model())?;
        let mut engage = with_options!(Engage::default(), common, session);
        if let Some(regions) = keywords.take("keep_out")? {
            let regions: PyResult<Vec<_>> = regions.try_iter()?.map(|it| region(&it?)).collect();
            engage = engage.keep_out(regions?);
        }
        if let Some(cap) = keywords.take("speed_cap")? {
            engage = engage.speed_cap(cap.extract()?);
        }
        if let Some(chosen) = keywords.take("backend")? {
            engage = engage.backend(backend(&chosen)?);
        }
        if let Some(deadman) = keywords.take("deadman")? {
            engage = engage.deadman(deadman.cast::<Deadman>()?.get().bind()?);
        }
        keywords.end()?;
        let entered = Arc::new(Entered::default());
        let shared = entered.clone();
        let begin = Operation::new("Robot.engage", async move {
            let (told, arm) = (Told::default(), robot.engage(engage).await?);
            if shared.is_entered.load(Ordering::Relaxed) {
                // Set once: the operation runs once.
                let _ = shared.session.set((told.clone(), arm.clone()));
            }
            Ok::<_, MotionError>(Arm::new(arm, told))
        });
        Py::new(
            py,
            PyClassInitializer::from(begin).add_subclass(Self { entered }),
        )
    }
}

#[pymethods]
impl Engagement {
    fn __aenter__(this: Py<Self>) -> Py<Self> {
        this.get().entered.is_entered.store(true, Ordering::Relaxed);
        this
    }

    #[pyo3(signature = (kind = None, *_rest))]
    fn __aexit__(
        &self,
        kind: Option<&Bound<'_, PyAny>>,
        _rest: &Bound<'_, PyAny>,
    ) -> PyResult<Operation> {
        let session = self.entered.session.get();
        let session = session.ok_or_else(|| {
            PyTypeError::new_err(
                "the session has not begun: use \
            'with' or 'async with'",
            )
        })?;
        Ok(leave(session.clone(), kind))
    }
}

/// Reads a region that the arm must avoid.
fn region(region: &Bound<'_, PyAny>) -> PyResult<Obstacle> {
    if is(region, "Plane")? {
        let normal = Vector3::from(vector::<3>("normal", &region.getattr("normal")?)?);
        let normal = UnitVector3::try_new(normal, 1e-9).ok_or_else(|| {
            PyValueError::new_err(
                "the normal of a plane has the length 0, \
                expected a direction",
            )
        })?;
        let offset = region.getattr("offset")?.extract()?;
        return Ok(Obstacle::Plane { normal, offset });
    }
    if is(region, "Box")? {
        let sides = Vector3::from(vector::<3>("sides", &region.getattr("sides")?)?);
        let pose = pose("pose", &region.getattr("pose")?)?;
        let half = 0.5 * sides;
        return Ok(Obstacle::Box { pose, half });
    }
    let text = format!("keep_out has {}, expected a Plane or a Box", region.repr()?);
    Err(PyTypeError::new_err(text))
}

/// Reads `torques`, or a pair of a controller and its setpoints.
fn backend(backend: &Bound<'_, PyAny>) -> PyResult<Backend> {
    let unknown = || {
        let text = format!(
            "backend is {backend}, expected 'torques' or a pair of 'joint_impedance' or \
             'cartesian_impedance' and 'joint_positions', 'joint_velocities', 'cartesian_poses' or \
             'cartesian_velocities'"
        );
        PyValueError::new_err(text)
    };
    if let Ok(name) = backend.extract::<String>() {
        return (name == "torques")
            .then_some(Backend::Torques)
            .ok_or_else(unknown);
    }
    let (controller, setpoints) = backend
        .extract::<(String, String)>()
        .map_err(|_| unknown())?;
    let setpoints = match setpoints.as_str() {
        "joint_positions" => Setpoints::JointPositions,
        "joint_velocities" => Setpoints::JointVelocities,
        "cartesian_poses" => Setpoints::CartesianPoses,
        "cartesian_velocities" => Setpoints::CartesianVelocities,
        _ => return Err(unknown()),
    };
    let controller = match controller.as_str() {
        "joint_impedance" => Controller::JointImpedance,
        "cartesian_impedance" => Controller::CartesianImpedance,
        _ => return Err(unknown()),
    };
    Ok(match controller {
        Controller::JointImpedance => Backend::joint_impedance(setpoints),
        _ => Backend::cartesian_impedance(setpoints),
    })
}
