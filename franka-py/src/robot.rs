//! The robot: its connection, its state, stopping and recovering it.

use std::sync::{Mutex, MutexGuard, PoisonError};

use franka_async::Realtime;
use franka_async::connection::{Builder, Endpoint, Version, VersionPolicy};
use futures::FutureExt;
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{pose_array, vector};
use crate::errors::misuse;
use crate::exit;
use crate::identify::PyIdentified;
use crate::operation::{Operation, seconds};
use crate::runtime::{self, Threaded};
use crate::state::RobotState;
use crate::supervision::supervise_by;

/// A robot at an address. `async with Robot(address) as robot:` connects, and shuts down at the
/// end: motions are braked. Its methods may be called from any thread.
///
/// When the last reference to a connected robot is dropped, it is braked and closed in the
/// background; the exit of the interpreter waits for this.
///
/// Options: `realtime` is `enforce` or `ignore`; `enforce` refuses a host without real-time
/// scheduling. `None` uses the environment variable `FRANKA_REALTIME`, or else `enforce`.
/// `priority` (1 to 99) and `cpu` apply to the control thread, not to threads of Python. `version`
/// is the protocol version, 5 or 10; if `None`, it is negotiated. `connect_timeout` applies to each
/// step of connecting. `link_timeout` is the silence of the robot after which a motion fails with
/// `link_lost`, 0.02 to 10 s, 1 s by default; longer times are for simulated robots on busy hosts.
/// `log_size` is the number of cycles in an error, at most 10000. `nominal_model` uses the vendor's
/// constants instead of the robot's description. `accept_geometry_error` connects to a robot whose
/// reported poses disagree with its model; `geometry_residual` is the difference. `known` is an
/// `Identified` of this arm. `supervise` is a `Policy`, or `True` for the default policy: lost
/// connections are restored, and the robot is recovered according to the policy.
/// `ask_before_recovery` is called with the `Reflex` before each recovery, on a separate thread,
/// and must return `True` to allow it; it implies `ask_first`. `ValueError` for invalid options.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Robot {
    builder: Builder,
    address: String,
    connection: Threaded<Mutex<Option<franka_async::Robot>>>,
}

#[pymethods]
impl Robot {
    /// Describes a connection to `address`, `host` or `host:port`; it sends nothing yet.
    #[new]
    #[pyo3(signature = (
        address, *, realtime = None, priority = None, cpu = None, version = None, connect_timeout = None,
        link_timeout = None, log_size = None, nominal_model = false, accept_geometry_error = false,
        known = None, supervise = None, ask_before_recovery = None,
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn new(
        address: String,
        realtime: Option<&str>,
        priority: Option<i32>,
        cpu: Option<usize>,
        version: Option<u16>,
        connect_timeout: Option<f64>,
        link_timeout: Option<f64>,
        log_size: Option<usize>,
        nominal_model: bool,
        accept_geometry_error: bool,
        known: Option<&PyIdentified>,
        supervise: Option<&Bound<'_, PyAny>>,
        ask_before_recovery: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let mut builder = franka_async::Robot::builder(&address)
            .realtime(self::realtime(realtime)?)
            .nominal_model(nominal_model)
            .accept_geometry_error(accept_geometry_error)
            .cancellation(exit::cancellation());
        if let Some(priority) = priority {
            builder = builder.priority(priority);
        }
        if let Some(cpu) = cpu {
            builder = builder.cpu(cpu);
        }
        if let Some(number) = version {
            let version = Version::from_number(number).ok_or_else(|| {
                PyValueError::new_err(format!("version is {number}, expected 5 or 10"))
            })?;
            builder = builder.version(VersionPolicy::Exact(version));
        }
        if let Some(timeout) = connect_timeout {
            builder = builder.connect_timeout(seconds("connect_timeout", timeout)?);
        }
        if let Some(timeout) = link_timeout {
            builder = builder.link_timeout(seconds("link_timeout", timeout)?);
        }
        if let Some(cycles) = log_size {
            builder = builder.log_size(cycles);
        }
        if let Some(PyIdentified(found)) = known {
            builder = builder.known(*found);
        }
        builder = supervise_by(builder, supervise, ask_before_recovery)?;
        Ok(Self {
            builder,
            address,
            connection: Threaded::new(Mutex::new(None)),
        })
    }

    /// Connects, and returns this robot. If the robot is already connected, nothing changes. Raises
    /// `ConnectError`. Cancelling aborts the connection.
    fn connect(this: &Bound<'_, Self>) -> Operation {
        let (robot, builder) = (this.clone().unbind(), this.get().builder.clone());
        Operation::new("Robot.connect", async move {
            if robot.get().open().is_none() {
                let connected = builder.connect().await?;
                exit::wait_for(&connected);
                *robot.get().connection() = Some(connected);
            }
            Ok::<_, franka_async::Error>(robot)
        })
    }

    /// Brakes and ends any motion, and closes the connection, if there is one. Once begun, it
    /// continues even if it is cancelled.
    fn shutdown(this: &Bound<'_, Self>) -> Operation {
        let robot = this.clone().unbind();
        Operation::infallible("Robot.shutdown", async move {
            let connected = robot.get().connection().take();
            if let Some(connected) = connected {
                connected.shutdown().await;
            }
        })
    }

    fn __aenter__(this: &Bound<'_, Self>) -> Operation {
        Self::connect(this)
    }

    #[pyo3(signature = (*_exception))]
    fn __aexit__(this: &Bound<'_, Self>, _exception: &Bound<'_, PyAny>) -> Operation {
        Self::shutdown(this)
    }

    /// Address of the robot: as given, and resolved once it is connected.
    #[getter]
    fn address(&self) -> String {
        match &*self.connection() {
            Some(robot) => robot.address().to_string(),
            None => self.address.clone(),
        }
    }

    /// True if there is a connection, or a supervised robot will be reconnected.
    #[getter]
    fn is_connected(&self) -> bool {
        self.open().is_some()
    }

    /// Protocol version of the robot: 10 for a Franka Research 3, 5 for a Franka Emika Robot.
    #[getter]
    fn fci_version(&self) -> PyResult<u16> {
        Ok(self.connected()?.version().number())
    }

    /// Difference between the reported pose at connect and the pose of `model()` at the same joint
    /// positions, m; or a tenth of a metre times the largest difference of an element of their
    /// rotation matrices, if this is larger. It is at most 2e-6, or an accepted error. `None` if
    /// the robot reported no pose.
    #[getter]
    fn geometry_residual(&self) -> PyResult<Option<f64>> {
        Ok(self.connected()?.geometry_check().residual)
    }

    /// Newest state, without waiting. After the link is lost, this remains the last received state;
    /// `health()` shows the loss.
    fn state(&self) -> PyResult<RobotState> {
        let robot = self.connected()?;
        Ok(RobotState::new(robot.state(), robot.version()))
    }

    /// Measured pose of the end effector in the base frame, `(4, 4)`, from the newest state.
    fn pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(pose_array(py, &self.connected()?.pose()))
    }

    /// Pose of the end effector in the base frame, `(4, 4)`, at joint positions `q`, `(7,)` rad.
    fn pose_at<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let q = vector("q", q)?;
        Ok(pose_array(py, &self.connected()?.pose_at(q)))
    }

    /// Brakes any motion, and waits until it has ended and a state shows the arm at rest. The
    /// braked motion raises `MotionError` of the kind `stopped` at once, while the arm still
    /// brakes. If another task requests a motion meanwhile, this motion begins: `stop` then raises
    /// `MotionError` of the kind `superseded`. It raises other kinds if the arm was not seen to be
    /// at rest: `protocol`, `not_at_rest`, `link_lost`, `connection_closed`. If people keep the arm
    /// in motion for two seconds, the robot's own controller stops it; the wait ends within eight
    /// seconds. Once begun, it continues even if it is cancelled.
    fn stop(&self) -> PyResult<Operation> {
        let robot = self.connected()?;
        Ok(Operation::new(
            "Robot.stop",
            async move { robot.stop().await },
        ))
    }

    /// Stops like `stop`, and latches the stop: until `release_stop`, every motion, session and
    /// goal of any caller is refused, as `MotionError` of the kind `not_ready`. The latch survives
    /// reconnects, and stays set even if this call raises. It is not a safety function.
    fn latch_stop(&self) -> PyResult<Operation> {
        let robot = self.connected()?;
        Ok(Operation::new("Robot.latch_stop", async move {
            robot.latch_stop().await
        }))
    }

    /// Releases a latched stop: motions are allowed again. It does not move the arm. Returns `True`
    /// if a stop was latched.
    fn release_stop(&self) -> PyResult<bool> {
        Ok(self.connected()?.release_stop())
    }

    /// True if a stop is latched.
    #[getter]
    fn is_stop_latched(&self) -> PyResult<bool> {
        Ok(self.connected()?.is_stop_latched())
    }

    /// Recovers the robot from a reflex, and waits until it accepts motions again. If no recovery
    /// is needed, nothing happens. It does not command a motion. Raises `CommandError`.
    fn recover(&self) -> PyResult<Operation> {
        let robot = self.connected()?;
        Ok(Operation::new("Robot.recover", async move {
            robot.recover().await
        }))
    }

    fn __repr__(&self) -> String {
        match &*self.connection() {
            Some(robot) => format!("<Robot at {}>", robot.address()),
            None => format!("<Robot at {}, not connected>", self.address),
        }
    }
}

impl Robot {
    /// Returns the connected robot.
    ///
    /// # Errors
    /// `FrankaError` of the kind `not_connected`; `RuntimeError` in a forked child.
    pub(crate) fn connected(&self) -> PyResult<franka_async::Robot> {
        runtime::runtime()?;
        self.connection().clone().ok_or_else(|| {
            let text = format!(
                "not connected to the robot at {}: call connect() before, or use 'async with' ('with' in sync)",
                self.address
            );
            Python::attach(|py| misuse(py, "not_connected", &text))
        })
    }

    /// Returns the robot's host, with the port `ports` after the robot's: the default ports may
    /// belong to another simulator.
    pub(crate) fn beside(&self, ports: u16) -> Endpoint {
        let endpoint = Endpoint::from(&self.address);
        let port = endpoint.port().unwrap_or(Version::TCP_PORT);
        endpoint.at_port(port.saturating_add(ports))
    }

    /// Returns the connected robot, unless its connection has ended permanently.
    fn open(&self) -> Option<franka_async::Robot> {
        let robot = self.connection().clone()?;
        let ended = robot.closed().now_or_never().is_some();
        (!ended).then_some(robot)
    }

    fn connection(&self) -> MutexGuard<'_, Option<franka_async::Robot>> {
        // No code panics while the lock is held.
        let connection = self.connection.lock();
        connection.unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the choice of `realtime`, or else of the environment.
///
/// # Errors
/// `ValueError`.
pub(crate) fn realtime(choice: Option<&str>) -> PyResult<Realtime> {
    let environment = std::env::var("FRANKA_REALTIME").ok();
    let (name, choice) = match choice {
        Some(choice) => ("realtime", Some(choice)),
        None => ("FRANKA_REALTIME", environment.as_deref()),
    };
    match choice {
        None | Some("" | "enforce") => Ok(Realtime::Enforce),
        Some("ignore") => Ok(Realtime::Ignore),
        Some(other) => {
            let text = format!("{name} is {other:?}, expected 'enforce' or 'ignore'");
            Err(PyValueError::new_err(text))
        }
    }
}
