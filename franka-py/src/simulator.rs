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

/// A simulated robot on a free port of this host, from the call on until `stop()` or the end of the
/// `with` or `async with` block. Its methods release the interpreter, and act between two of its
/// milliseconds.
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
    /// Starts a Franka Research 3 in the ready pose, with an arm that sticks, flexes and lags like
    /// real ones.
    ///
    /// Options: `virtual_time`, whether its next millisecond begins with the command, however long
    /// that takes up to `patience` seconds (0.5): for tests, and for programs that learn.
    /// `patience` alone waits for commands that come late, but is never faster than the clock
    /// on the wall. `arm`, `ideal`, `nominal`, `realistic` or `bad`: a good arm for tests that
    /// need exactness, or worse ones; with `arm_seed`, one that is drawn at random from such
    /// arms; `ideal=True` is `arm="ideal"`. `limits`, `5.9` (the default) or `before-5.9`: the
    /// joint limits of the robot's system, of an FR3. `state_geometry`, `recorded` (upper arm 0.3162
    /// m, forearm 0.3842 m; by default, unless `ideal`), `described` (0.316 m, 0.384 m) or `random`
    /// (1 mm and 3 mrad off, by `seed`): what it computes its own poses with. `seed` of all other
    /// randomness. `q`, joint positions at the start, 7 numbers, rad, where the joints can be. `tool`, `hand` or a
    /// tuple of its frame on the flange (a pose), its mass, kg, and its centre of mass in the
    /// flange frame, m: what the robot knows of. `load`, a tuple of mass and centre: what it does
    /// not know of. `hand` serves a Franka Hand and mounts it, `vacuum_gripper` a vacuum gripper,
    /// each at an address of its own: `Gripper(sim.hand_address)`, since `robot.gripper()` looks at
    /// the port after the robot's, where the Hand is with `address` only. `network`, a `Network`
    /// between robot and clients. `address`, where to listen; the grippers then listen on the ports
    /// that follow, as on a robot. `enforce_limits`, whether commands outside the limits end in a
    /// reflex.
    #[staticmethod]
    #[pyo3(signature = (**options))]
    fn fr3(py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::start(py, "Sim.fr3", RobotKind::Fr3, options)
    }

    /// Starts a Franka Emika Robot (Panda); otherwise like `fr3`.
    #[staticmethod]
    #[pyo3(signature = (**options))]
    fn fer(py: Python<'_>, options: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Self::start(py, "Sim.fer", RobotKind::Fer, options)
    }

    /// Starts two to four robots, each `fr3` or `fer`, that begin every millisecond together, and
    /// returns them in a list: where one waits for a command, all do. For arms of one program,
    /// teams above all: `left, right = Sim.in_step("fr3", "fer", virtual_time=True)`. Options as of
    /// `fr3`, the same for all, but for `address`. One that has stopped is not waited for.
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

    /// Where to connect to: `host:port`.
    #[getter]
    fn address(&self) -> &str {
        &self.address
    }

    /// Where the Hand is; `None` without one.
    #[getter]
    fn hand_address(&self) -> Option<&str> {
        self.hand_address.as_deref()
    }

    /// Where the vacuum gripper is; `None` without one.
    #[getter]
    fn vacuum_gripper_address(&self) -> Option<&str> {
        self.vacuum_gripper_address.as_deref()
    }

    /// The newest state, in full precision.
    fn state(&self, py: Python<'_>) -> PyResult<RobotState> {
        let (state, version) = self.robot(py, |robot| (*robot.state(), robot.version()))?;
        Ok(RobotState::new(state, version))
    }

    /// How many of the calls with `once_moving=True` still wait for a motion, without those that
    /// `let_go()` or `release()` took back.
    #[getter]
    fn waiting(&self) -> usize {
        self.once_moving.count()
    }

    /// Stops the simulation: now or, `once_moving`, in mid-motion, as of `push`. Connections to it
    /// are lost. Without effect if it has stopped.
    #[pyo3(signature = (*, once_moving = false))]
    fn stop(&self, py: Python<'_>, once_moving: bool) -> PyResult<()> {
        if once_moving {
            let stop = self.disturb(py, true, |_| {
                // Ends the thread of the robot, and with it sockets and connections; `panic!` would
                // print something, too.
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

    /// Does something with the simulation, with the interpreter released.
    ///
    /// # Errors
    /// `OSError` if it has stopped.
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

    /// Does something with the robot between two of its milliseconds.
    ///
    /// # Errors
    /// As [`Self::with`].
    pub(crate) fn robot<R: Send + 'static>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut franka_sim::Robot) -> R + Send + 'static,
    ) -> PyResult<R> {
        self.with(py, async |running| running.with(act).await)
    }

    /// Does something to the robot between two of its milliseconds: now or, `once_moving`, once
    /// its arm moves. Returns what then waits.
    ///
    /// # Errors
    /// As [`Self::with`].
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

    /// Reads joint positions, where the joints of this robot can be.
    ///
    /// # Errors
    /// As [`positions`], and `OSError` if it has stopped.
    pub(crate) fn positions(&self, q: &Bound<'_, PyAny>) -> PyResult<JointVector> {
        let limits = self.robot(q.py(), |robot| *robot.model().joint_limits())?;
        positions(&limits, q)
    }
}

/// A robot, and what is to happen to it once its arm moves.
fn watched(sim: franka_sim::Sim) -> (franka_sim::Sim, OnceMoving) {
    let once_moving = OnceMoving::default();
    let waiting = once_moving.clone();
    let sim = sim.every_millisecond(move |robot| waiting.look_at(robot));
    (sim, once_moving)
}

/// The same robots, which begin each of their milliseconds together.
///
/// # Panics
/// Unless there are `N`.
fn together<const N: usize>(sims: Vec<franka_sim::Sim>) -> Vec<franka_sim::Sim> {
    let Ok(sims) = <[franka_sim::Sim; N]>::try_from(sims) else {
        panic!("there are {N}");
    };
    franka_sim::Sim::in_step(sims).into()
}
