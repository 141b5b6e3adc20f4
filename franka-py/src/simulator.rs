//! A simulated robot in the process.

use std::sync::{Mutex, MutexGuard, PoisonError};

use franka_async::model::{JointVector, RobotKind};
use franka_sim::{Running, Stopped};
use futures::future::try_join_all;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict};

use crate::once_moving::{JobId, OnceMoving};
use crate::operation::Operation;
use crate::options::Keywords;
use crate::runtime::{self, Threaded};
use crate::simulator_options::{configured, positions};
use crate::state::RobotState;

/// A simulated robot on a free port of this host, from the call until `stop()` or the end of the
/// `with` or `async with` block. Its methods release the interpreter, and act between two
/// milliseconds of the robot.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Sim {
    /// `None` once it has been stopped.
    running: Threaded<Mutex<Option<Running>>>,
    pub(crate) once_moving: OnceMoving,
    kind: RobotKind,
    address: String,
    hand_address: Option<String>,
    vacuum_gripper_address: Option<String>,
}

#[pymethods]
impl Sim {
    /// Starts a Franka Research 3 in the ready pose, with realistic stiction, elasticity and lag of
    /// the arm.
    ///
    /// Options: `virtual_time`, true if its next millisecond begins with the command, which may
    /// take up to `patience` seconds (0.5): for tests, and for learning. `patience` alone waits for
    /// late commands, but is never faster than the wall clock. `arm`, `ideal`, `nominal`,
    /// `realistic` or `bad`: an exact arm for precise tests, or worse ones; with `arm_seed`, a
    /// random arm of this kind; `ideal=True` is `arm="ideal"`. `limits`, `5.9` (the default) or
    /// `before-5.9`: the joint limits of the robot's system, of an FR3. `state_geometry`,
    /// `recorded` (upper arm 0.3162 m, forearm 0.3842 m; the default unless `ideal`), `described`
    /// (0.316 m, 0.384 m) or `random` (1 mm and 3 mrad off, by `seed`): the geometry of its own
    /// poses. `kinematic_error`, `none` or `random` (by `seed`): errors of the true links against
    /// these poses, instead of the arm's own. `seed` of all other randomness. `q`, joint
    /// positions at the start, 7 numbers, rad, within the joint ranges. `tool`, `hand` or a tuple
    /// of its frame on the flange (a pose), its mass, kg, and its centre of mass in the flange
    /// frame, m: declared to the robot. `load`, a tuple of mass and centre: not declared. `hand`
    /// serves a Franka Hand and mounts it, `vacuum_gripper` a vacuum gripper, each at a separate
    /// address: use `Gripper(sim.hand_address)`, because `robot.gripper()` uses the port after the
    /// robot's, which is the Hand's with `address` only. `network`, a `Network` between robot and
    /// clients. `address`, the address to listen on; the grippers then listen on the following
    /// ports, as on a robot. `enforce_limits`, true if commands outside the limits cause a reflex.
    #[staticmethod]
    #[pyo3(signature = (**options))]
    fn fr3(py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::start(py, "Sim.fr3", RobotKind::Fr3, options)
    }

    /// Starts a Franka Emika Robot (Panda). Apart from that, it is like `fr3`.
    #[staticmethod]
    #[pyo3(signature = (**options))]
    fn fer(py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::start(py, "Sim.fer", RobotKind::Fer, options)
    }

    /// Starts two to four robots, each `fr3` or `fer`, that begin every millisecond together, and
    /// returns them in a list. If one robot waits for a command, all robots wait. For several arms
    /// of one program, especially teams: `left, right = Sim.in_step("fr3", "fer",
    /// virtual_time=True)`. Options as for `fr3` except `address`; they apply to all robots. If a
    /// robot was stopped, the other robots do not wait for it.
    #[staticmethod]
    #[pyo3(signature = (*kinds, **options))]
    fn in_step(
        py: Python<'_>,
        kinds: Vec<String>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Vec<Self>> {
        let mut sims = Vec::with_capacity(kinds.len());
        for name in &kinds {
            let kind = match name.as_str() {
                "fr3" => RobotKind::Fr3,
                "fer" => RobotKind::Fer,
                _ => {
                    let text = format!("got the robot {name:?}, expected 'fr3' or 'fer'");
                    return Err(PyValueError::new_err(text));
                }
            };
            let mut keywords = Keywords::new("Sim.in_step", options)?;
            let (sim, once_moving) = watched(configured(kind, &mut keywords)?);
            sims.push(((kind, once_moving), sim));
            keywords.end()?;
        }
        let (kinds, sims): (Vec<_>, Vec<_>) = sims.into_iter().unzip();
        let sims = match sims.len() {
            2 => together::<2>(sims),
            3 => together::<3>(sims),
            4 => together::<4>(sims),
            count => {
                let text = format!("got {count} robots, expected 2 to 4");
                return Err(PyValueError::new_err(text));
            }
        };
        let running = runtime::blocking(py, try_join_all(sims.into_iter().map(|sim| sim.start())))?;
        let running = running.map_err(PyOSError::new_err)?;
        let named = kinds.into_iter().zip(running);
        Ok(named
            .map(|(kind, running)| Self::new(kind, running))
            .collect())
    }

    /// Address of the robot: `host:port`.
    #[getter]
    fn address(&self) -> &str {
        &self.address
    }

    /// Address of the Hand; `None` without one.
    #[getter]
    fn hand_address(&self) -> Option<&str> {
        self.hand_address.as_deref()
    }

    /// Address of the vacuum gripper; `None` without one.
    #[getter]
    fn vacuum_gripper_address(&self) -> Option<&str> {
        self.vacuum_gripper_address.as_deref()
    }

    /// The newest state, in full precision.
    fn state(&self, py: Python<'_>) -> PyResult<RobotState> {
        let (state, version) = self.robot(py, |robot| (*robot.state(), robot.version()))?;
        Ok(RobotState::new(state, version))
    }

    /// Number of calls with `once_moving=True` that still wait for a motion, without those
    /// cancelled by `let_go()` or `release()`.
    #[getter]
    fn waiting(&self) -> usize {
        self.once_moving.count()
    }

    /// Stops the simulation: now or, with `once_moving`, in mid-motion, as in `push`. Connections
    /// to it are lost. Without effect if it has stopped.
    #[pyo3(signature = (*, once_moving = false))]
    fn stop(&self, py: Python<'_>, once_moving: bool) -> PyResult<()> {
        if once_moving {
            let stop = self.disturb(py, true, |_| {
                // Ends the thread of the robot, with its sockets and connections; `panic!` would
                // also print a message.
                std::panic::resume_unwind(Box::new("stopped"))
            });
            return match stop {
                Err(error) if error.is_instance_of::<PyOSError>(py) => Ok(()),
                other => other.map(drop),
            };
        }
        let runtime = runtime::runtime()?;
        py.detach(|| {
            let running = self.running().take();
            if let Some(running) = running {
                runtime.block_on(running.stop());
            }
        });
        Ok(())
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, PyAny>) -> PyResult<()> {
        self.stop(py, false)
    }

    fn __aenter__(this: Py<Self>) -> Operation {
        Operation::infallible("Sim", async move { this })
    }

    #[pyo3(signature = (*_exception))]
    fn __aexit__(&self, _exception: &Bound<'_, PyAny>) -> PyResult<Operation> {
        runtime::runtime()?;
        let running = self.running().take();
        Ok(Operation::infallible("Sim.stop", async move {
            if let Some(running) = running {
                running.stop().await;
            }
        }))
    }

    fn __repr__(&self) -> String {
        format!("<Sim of the {:?} at {}>", self.kind, self.address)
    }
}

impl Sim {
    fn start(
        py: Python<'_>,
        name: &'static str,
        kind: RobotKind,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut keywords = Keywords::new(name, options)?;
        let (sim, once_moving) = watched(configured(kind, &mut keywords)?);
        keywords.end()?;
        let running = runtime::blocking(py, sim.start())?.map_err(PyOSError::new_err)?;
        Ok(Self::new((kind, once_moving), running))
    }

    fn new((kind, once_moving): (RobotKind, OnceMoving), running: Running) -> Self {
        let hand = running.hand().map(|hand| hand.addr().to_string());
        let gripper = running.vacuum_gripper();
        Self {
            kind,
            once_moving,
            address: running.addr().to_string(),
            hand_address: hand,
            vacuum_gripper_address: gripper.map(|gripper| gripper.addr().to_string()),
            running: Threaded::new(Mutex::new(Some(running))),
        }
    }

    fn running(&self) -> MutexGuard<'_, Option<Running>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs a function with the simulation, with the interpreter released.
    ///
    /// # Errors
    /// `OSError` if the simulation has stopped.
    pub(crate) fn with<R: Send>(
        &self,
        py: Python<'_>,
        act: impl AsyncFnOnce(&Running) -> Result<R, Stopped> + Send,
    ) -> PyResult<R> {
        let runtime = runtime::runtime()?;
        py.detach(|| match &*self.running() {
            Some(running) => runtime.block_on(act(running)),
            None => Err(Stopped),
        })
        .map_err(|Stopped| PyOSError::new_err("the simulation has stopped"))
    }

    /// Runs a function with the robot between two of its milliseconds.
    ///
    /// # Errors
    /// The errors of [`Self::with`].
    pub(crate) fn robot<R: Send + 'static>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut franka_sim::Robot) -> R + Send + 'static,
    ) -> PyResult<R> {
        self.with(py, async |running| running.with(act).await)
    }

    /// Runs a function with the robot between two of its milliseconds: now or, with `once_moving`,
    /// once its arm moves. Returns the waiting job.
    ///
    /// # Errors
    /// The errors of [`Self::with`].
    pub(crate) fn disturb(
        &self,
        py: Python<'_>,
        once_moving: bool,
        act: impl FnOnce(&mut franka_sim::Robot) + Send + 'static,
    ) -> PyResult<Option<JobId>> {
        let waiting = self.once_moving.clone();
        self.robot(py, move |robot| {
            if once_moving {
                return Some(waiting.push(act));
            }
            act(robot);
            None
        })
    }

    /// Reads joint positions within the ranges of this robot.
    ///
    /// # Errors
    /// The errors of [`positions`], and `OSError` if the simulation has stopped.
    pub(crate) fn positions(&self, q: &Bound<'_, PyAny>) -> PyResult<JointVector> {
        let limits = self.robot(q.py(), |robot| *robot.model().joint_limits())?;
        positions(&limits, q)
    }
}

/// Returns a robot, and the jobs that wait for its arm to move.
fn watched(sim: franka_sim::Sim) -> (franka_sim::Sim, OnceMoving) {
    let once_moving = OnceMoving::default();
    let waiting = once_moving.clone();
    let sim = sim.every_millisecond(move |robot| waiting.look_at(robot));
    (sim, once_moving)
}

/// Returns the same robots, which begin each of their milliseconds together.
///
/// # Panics
/// Unless there are `N`.
fn together<const N: usize>(sims: Vec<franka_sim::Sim>) -> Vec<franka_sim::Sim> {
    let Ok(sims) = <[franka_sim::Sim; N]>::try_from(sims) else {
        panic!("there are {N}");
    };
    franka_sim::Sim::in_step(sims).into()
}
