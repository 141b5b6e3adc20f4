//! Disturbances of a simulated robot by people and objects.

use std::sync::{Arc, OnceLock};

use franka_async::model::Frame;
use franka_async::nalgebra::{UnitVector3, Vector3};
use franka_async::state::RobotError;
use franka_sim::{Freeze, TouchId};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{array, pose_array, vector};
use crate::model::arguments;
use crate::once_moving::JobId;
use crate::operation::seconds;
use crate::simulator::Sim;

/// A contact with the arm of a simulated robot, created by the methods of `Sim`.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Touch {
    sim: Py<Sim>,
    /// The job that begins it, if it waits for the arm to move.
    waits: Option<JobId>,
    /// Set when it begins.
    id: Arc<OnceLock<TouchId>>,
}

#[pymethods]
impl Touch {
    /// Ends it, also before it has begun. Returns `True` if it still existed.
    fn release(&self, py: Python<'_>) -> PyResult<bool> {
        let sim = self.sim.get();
        let (once_moving, waits, id) = (sim.once_moving.clone(), self.waits, self.id.clone());
        sim.robot(py, move |robot| {
            waits.is_some_and(|job| once_moving.take_back(job))
                || id.get().is_some_and(|id| robot.release(*id))
        })
    }

    /// The wrench that it currently exerts on the arm, base axes, `(6,)` N and N m; `None` if it is
    /// over, has not begun, or acts on joints.
    fn felt<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let id = self.id.clone();
        let felt = move |robot: &mut franka_sim::Robot| id.get().and_then(|id| robot.felt(*id));
        let felt = self.sim.get().robot(py, felt)?;
        Ok(felt.map(|wrench| array(py, wrench.as_slice())))
    }
}

/// Applies `touch` to the arm.
fn touch(
    sim: &Bound<'_, Sim>,
    touch: franka_sim::Touch,
    at: Option<(&str, Option<&Bound<'_, PyAny>>)>,
    (duration, once_moving): (Option<f64>, bool),
) -> PyResult<Touch> {
    let mut touch = touch;
    if let Some((frame, offset)) = at {
        let frame: Frame = arguments::frame(frame)?;
        let offset = offset.map_or(Ok([0.0; 3]), |offset| vector("offset", offset))?;
        touch = touch.at(frame).offset(offset.into());
    }
    if let Some(duration) = duration {
        let time = seconds("duration", duration)?.as_millis();
        touch = touch.lasting(u64::try_from(time).unwrap_or(u64::MAX));
    }
    let id = Arc::new(OnceLock::new());
    let begun = id.clone();
    let begin = move |robot: &mut franka_sim::Robot| {
        // It begins once.
        let _ = begun.set(robot.touch(touch));
    };
    let waits = sim.get().disturb(sim.py(), once_moving, begin)?;
    let sim = sim.clone().unbind();
    Ok(Touch { sim, waits, id })
}

#[pymethods]
impl Sim {
    /// Pushes the arm `at` a frame (`ee`, `flange`, `joint4`, ...), `offset` from its origin in its
    /// axes, m. The push has a force, base axes, N, and a torque, N m, and lasts for `duration`
    /// seconds of the robot's clock; if `None`, until it is released. It begins now. With
    /// `once_moving` it begins in the millisecond in which a joint becomes faster than 0.05 rad/s.
    /// Use this in virtual time, where a motion can be over before a program sees the arm move.
    /// Without a motion, the push never begins: see `waiting`.
    #[pyo3(signature = (force, torque = None, *, duration = None, once_moving = false, at = "ee", offset = None))]
    fn push(
        this: &Bound<'_, Self>,
        force: &Bound<'_, PyAny>,
        torque: Option<&Bound<'_, PyAny>>,
        duration: Option<f64>,
        once_moving: bool,
        at: &str,
        offset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Touch> {
        let [x, y, z] = vector("force", force)?;
        let [a, b, c] = torque.map_or(Ok([0.0; 3]), |torque| vector("torque", torque))?;
        let wrench = franka_sim::Touch::wrench([x, y, z, a, b, c].into());
        touch(this, wrench, Some((at, offset)), (duration, once_moving))
    }

    /// Pushes the joints with torques, 7 numbers, N m. Apart from that, it is like `push`.
    #[pyo3(signature = (torques, *, duration = None, once_moving = false))]
    fn push_joints(
        this: &Bound<'_, Self>,
        torques: &Bound<'_, PyAny>,
        duration: Option<f64>,
        once_moving: bool,
    ) -> PyResult<Touch> {
        let torques = franka_sim::Touch::torque(vector::<7>("torques", torques)?.into());
        touch(this, torques, None, (duration, once_moving))
    }

    /// Pulls the arm to the point `to`, base frame, m, with a spring of this stiffness, N/m;
    /// otherwise like `push`.
    #[pyo3(signature = (to, stiffness, *, duration = None, once_moving = false, at = "ee", offset = None))]
    fn pull(
        this: &Bound<'_, Self>,
        to: &Bound<'_, PyAny>,
        stiffness: f64,
        duration: Option<f64>,
        once_moving: bool,
        at: &str,
        offset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Touch> {
        let to = Vector3::from(vector::<3>("to", to)?);
        let spring = franka_sim::Touch::spring(to, positive("stiffness", stiffness)?);
        touch(this, spring, Some((at, offset)), (duration, once_moving))
    }

    /// Grips the arm firmly in its current place; otherwise like `push`.
    #[pyo3(signature = (*, duration = None, once_moving = false, at = "ee", offset = None))]
    fn hold(
        this: &Bound<'_, Self>,
        duration: Option<f64>,
        once_moving: bool,
        at: &str,
        offset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Touch> {
        touch(
            this,
            franka_sim::Touch::hold(),
            Some((at, offset)),
            (duration, once_moving),
        )
    }

    /// Blocks a joint, 1 to 7, at its current angle.
    #[pyo3(signature = (joint, *, duration = None, once_moving = false))]
    fn block(
        this: &Bound<'_, Self>,
        joint: i64,
        duration: Option<f64>,
        once_moving: bool,
    ) -> PyResult<Touch> {
        let number = usize::try_from(joint).ok();
        let Some(number @ 1..=7) = number else {
            let text = format!("joint is {joint}, expected 1 to 7");
            return Err(PyValueError::new_err(text));
        };
        touch(
            this,
            franka_sim::Touch::block(number),
            None,
            (duration, once_moving),
        )
    }

    /// Places a wall for the end effector: through `point`, base frame, m, with an outward
    /// `normal`.
    #[pyo3(signature = (point, normal, *, duration = None, once_moving = false, at = "ee", offset = None))]
    fn wall(
        this: &Bound<'_, Self>,
        point: &Bound<'_, PyAny>,
        normal: &Bound<'_, PyAny>,
        duration: Option<f64>,
        once_moving: bool,
        at: &str,
        offset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Touch> {
        let point = Vector3::from(vector::<3>("point", point)?);
        let normal =
            UnitVector3::try_new(vector::<3>("normal", normal)?.into(), 1e-9).ok_or_else(|| {
                PyValueError::new_err("normal has the length 0, expected a direction")
            })?;
        let wall = franka_sim::Touch::wall(point, normal.into_inner());
        touch(this, wall, Some((at, offset)), (duration, once_moving))
    }

    /// Ends every touch, and cancels all that wait for the arm to move.
    fn let_go(&self, py: Python<'_>) -> PyResult<()> {
        let waiting = self.once_moving.clone();
        self.robot(py, move |robot| {
            waiting.clear();
            robot.let_go();
        })
    }

    /// Presses the user stop, or releases it; `once_moving` as in `push`.
    #[pyo3(signature = (pressed = true, *, once_moving = false))]
    fn press_user_stop(&self, py: Python<'_>, pressed: bool, once_moving: bool) -> PyResult<()> {
        let press = move |robot: &mut franka_sim::Robot| robot.press_user_stop(pressed);
        self.disturb(py, once_moving, press).map(drop)
    }

    /// Activates a safety function that forbids motion, as configured in Desk, or deactivates it.
    #[pyo3(signature = (active = true))]
    fn activate_safety_function(&self, py: Python<'_>, active: bool) -> PyResult<()> {
        self.robot(py, move |robot| robot.activate_safety_function(active))
    }

    /// Presses the guiding buttons, or releases them. Returns `True` if the arm is then guided.
    #[pyo3(signature = (pressed = true))]
    fn guide(&self, py: Python<'_>, pressed: bool) -> PyResult<bool> {
        self.robot(py, move |robot| robot.guide(pressed))
    }

    /// Closes the brakes of the joints, or opens them, as Desk locks and unlocks a robot.
    #[pyo3(signature = (closed = true))]
    fn lock(&self, py: Python<'_>, closed: bool) -> PyResult<()> {
        self.robot(py, move |robot| match closed {
            true => robot.close_brakes(),
            false => robot.open_brakes(),
        })
    }

    /// Makes the arm ignore its commands while the robot reports the motion and no error: its
    /// `"joints"` do not move, or its `"controllers"` accept nothing; `None` ends this.
    #[pyo3(signature = (what = Some("joints")), text_signature = "($self, what='joints')")]
    fn freeze(&self, py: Python<'_>, what: Option<&str>) -> PyResult<()> {
        let freeze = match what {
            None => None,
            Some("joints") => Some(Freeze::Joints),
            Some("controllers") => Some(Freeze::Controllers),
            Some(other) => {
                let expected = "expected 'joints', 'controllers' or None";
                return Err(PyValueError::new_err(format!(
                    "what is {other:?}, {expected}"
                )));
            }
        };
        self.robot(py, move |robot| robot.freeze(freeze))
    }

    /// Raises an error of the robot, by the vendor's name, such as `cartesian_reflex`: the robot
    /// stops itself. `once_moving` as in `push`.
    #[pyo3(signature = (error, *, once_moving = false))]
    fn trip(&self, py: Python<'_>, error: &str, once_moving: bool) -> PyResult<()> {
        let found = RobotError::from_name(error).ok_or_else(|| {
            let names = "a name such as 'joint_reflex'; the book's page Errors by cause lists all \
                names";
            PyValueError::new_err(format!("error is {error:?}, expected {names}"))
        })?;
        let trip = move |robot: &mut franka_sim::Robot| robot.trip(found);
        self.disturb(py, once_moving, trip).map(drop)
    }

    /// Performs the recovery that needs a person.
    fn recover_manually(&self, py: Python<'_>) -> PyResult<()> {
        self.robot(py, |robot| robot.recover_manually())
    }

    /// Places the arm at joint positions, 7 numbers, rad, at rest. Raises `ValueError` for
    /// impossible positions.
    fn place(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<()> {
        let q = self.positions(q)?;
        self.robot(py, move |robot| robot.place(&q))
    }

    /// Attaches an undeclared body to the flange, replacing the previous one: mass, kg, centre of
    /// mass in the flange frame, m, and inertia about it, `(3, 3)` kg m^2.
    #[pyo3(signature = (mass, center, inertia = None))]
    fn attach(
        &self,
        py: Python<'_>,
        mass: f64,
        center: &Bound<'_, PyAny>,
        inertia: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let body = arguments::load(inertia, mass, Some(center))?;
        self.robot(py, move |robot| robot.attach(body))
    }

    /// True pose of the end effector, base frame, `(4, 4)`: the pose that the robot reports can
    /// deviate, because its joint sensors have errors.
    fn true_pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pose = self.robot(py, |robot| robot.true_pose())?;
        Ok(pose_array(py, &pose))
    }

    /// Places an object of this width, m, between the fingers of the Hand. Raises `ValueError` if
    /// it does not fit, or if there is no Hand.
    fn place_object(&self, py: Python<'_>, width: f64) -> PyResult<()> {
        let place = move |hand: &mut franka_sim::Hand| hand.mechanism_mut().place_object(width);
        let placed = self.with(py, async |sim| match sim.hand() {
            Some(hand) => hand.with(place).await.map(Some),
            None => Ok(None),
        })?;
        let problem = match placed {
            Some(true) => return Ok(()),
            Some(false) => format!(
                "got an object of {width} m, which does not fit between the \
                fingers"
            ),
            None => "this robot has no Hand: start it with hand=True".into(),
        };
        Err(PyValueError::new_err(problem))
    }

    /// Places a part in front of the vacuum gripper. Raises `ValueError` if there is no vacuum
    /// gripper.
    fn place_part(&self, py: Python<'_>) -> PyResult<()> {
        let place =
            |gripper: &mut franka_sim::VacuumGripper| gripper.mechanism_mut().place_object();
        let placed = self.with(py, async |sim| match sim.vacuum_gripper() {
            Some(gripper) => gripper.with(place).await.map(Some),
            None => Ok(None),
        })?;
        let without = "this robot has no vacuum gripper: start it with vacuum_gripper=True";
        placed.ok_or_else(|| PyValueError::new_err(without))
    }
}

fn positive(name: &str, value: f64) -> PyResult<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    let text = format!("{name} is {value}, expected a number above 0");
    Err(PyValueError::new_err(text))
}
