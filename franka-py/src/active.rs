//! Active control: a thread of the program reads states and writes commands.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use franka_async::MotionReport;
use franka_async::connection::Version;
use franka_async::control::{
    Active, CartesianPose, CartesianVelocities, Finish, JointPositions, JointVelocities, Torques,
};
use franka_async::error::ActiveError;
use franka_async::nalgebra::Matrix4;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{pose_matrix, vector};
use crate::control::{CommandKind, controller};
use crate::errors::Raise;
use crate::motion::Report;
use crate::operation::Operation;
use crate::robot::Robot;
use crate::state::RobotState;

/// A motion under active control: from the first `read_once()` on, the thread that calls it runs
/// the control cycle. The thread must answer each state within the millisecond. If it neither reads
/// nor writes, the robot receives no commands and stops. Commands are neither filtered nor limited.
///
/// As a context manager, it stops the robot at the end of the block, unless the last command has
/// been written. Only one thread at a time may use it.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct ActiveControl {
    kind: CommandKind,
    version: Version,
    /// `None` once it was stopped.
    cycle: Mutex<Option<Cycle>>,
}

enum Cycle {
    Torques(Active<Torques>),
    JointPositions(Active<JointPositions>),
    JointVelocities(Active<JointVelocities>),
    CartesianPose(Active<CartesianPose>),
    CartesianVelocities(Active<CartesianVelocities>),
}

/// The numbers of the command, and its additional values.
struct Written {
    motion: Motion,
    torques: Option<Torques>,
    finished: bool,
}

enum Motion {
    Torques(Torques),
    Seven([f64; 7]),
    Pose([f64; 16], Option<[f64; 2]>),
    Twist([f64; 6], Option<[f64; 2]>),
}

#[pymethods]
impl Robot {
    /// Begins control by torques, `(7,)` N m, without gravity and friction. Returns an
    /// `ActiveControl`. The first command is due within a few milliseconds: read at once on the
    /// controlling thread. Raises `MotionError`, of the kind `busy` while another motion controls
    /// the arm. Cancelling stops the robot.
    fn active_torques(&self) -> PyResult<Operation> {
        self.active(CommandKind::Torques, "external_controller")
    }

    /// Begins control by joint positions, `(7,)` rad, for one of the robot's own controllers,
    /// `joint_impedance` or `cartesian_impedance`; with `external_controller` every command also
    /// needs torques. Otherwise like `active_torques`.
    #[pyo3(signature = (controller = "joint_impedance"))]
    fn active_joint_positions(&self, controller: &str) -> PyResult<Operation> {
        self.active(CommandKind::JointPositions, controller)
    }

    /// Begins control by joint velocities, `(7,)` rad/s; otherwise like `active_joint_positions`.
    #[pyo3(signature = (controller = "joint_impedance"))]
    fn active_joint_velocities(&self, controller: &str) -> PyResult<Operation> {
        self.active(CommandKind::JointVelocities, controller)
    }

    /// Begins control by poses of the end effector in the base frame, `(4, 4)` or 3 + 4 numbers
    /// with a quaternion `x y z w`; otherwise like `active_joint_positions`.
    #[pyo3(signature = (controller = "joint_impedance"))]
    fn active_cartesian_pose(&self, controller: &str) -> PyResult<Operation> {
        self.active(CommandKind::CartesianPose, controller)
    }

    /// Begins control by twists of the end effector in the base frame, `(6,)` m/s and rad/s;
    /// otherwise like `active_joint_positions`.
    #[pyo3(signature = (controller = "joint_impedance"))]
    fn active_cartesian_velocities(&self, controller: &str) -> PyResult<Operation> {
        self.active(CommandKind::CartesianVelocities, controller)
    }
}

impl Robot {
    fn active(&self, kind: CommandKind, controller: &str) -> PyResult<Operation> {
        let controller = self::controller(controller)?;
        let robot = self.connected()?;
        Ok(Operation::new("Robot.active_control", async move {
            let cycle = match kind {
                CommandKind::Torques => Cycle::Torques(robot.active_torques().await?),
                CommandKind::JointPositions => {
                    Cycle::JointPositions(robot.active_joint_positions(controller).await?)
                }
                CommandKind::JointVelocities => {
                    Cycle::JointVelocities(robot.active_joint_velocities(controller).await?)
                }
                CommandKind::CartesianPose => {
                    Cycle::CartesianPose(robot.active_cartesian_pose(controller).await?)
                }
                CommandKind::CartesianVelocities => {
                    Cycle::CartesianVelocities(robot.active_cartesian_velocities(controller).await?)
                }
            };
            Ok::<_, franka_async::MotionError>(ActiveControl {
                kind,
                version: robot.version(),
                cycle: Mutex::new(Some(cycle)),
            })
        }))
    }
}

#[pymethods]
impl ActiveControl {
    /// Waits for the next state of the motion, with the interpreter released. Returns it with the
    /// robot's time since the last state read, in seconds: 0 for the first state, and more than
    /// 0.001 after a loss.
    ///
    /// Raises `MotionError` with the reason for the end of the motion. Later calls raise
    /// `ActiveError` of the kind `ended`, or `finished` after the last command.
    fn read_once(&self, py: Python<'_>) -> PyResult<(RobotState, f64)> {
        let read = py.detach(|| {
            let mut guard = self.take_turn()?;
            let cycle = guard.as_mut().ok_or_else(stopped)?;
            Ok::<_, PyErr>(match cycle {
                Cycle::Torques(active) => active.read_once(),
                Cycle::JointPositions(active) => active.read_once(),
                Cycle::JointVelocities(active) => active.read_once(),
                Cycle::CartesianPose(active) => active.read_once(),
                Cycle::CartesianVelocities(active) => active.read_once(),
            })
        })?;
        let (state, step) = read.map_err(|error| error.raise(py))?;
        Ok((RobotState::new(state, self.version), step.as_secs_f64()))
    }

    /// Sends the command that answers the newest state. With `finished` it is the last command: the
    /// call then waits, with the interpreter released, until the robot has ended the motion, and
    /// returns a `MotionReport`.
    ///
    /// `torques`, `(7,)` N m, are required in addition to the command of a motion generator under
    /// `external_controller`. `elbow` is for poses and twists: position of joint 3 in rad, and sign
    /// of joint 4.
    ///
    /// Raises `ValueError` for numbers that are not finite or of the wrong shape. Raises
    /// `ActiveError` if the command cannot be sent; the motion then continues. Raises `MotionError`
    /// if the motion ended for any reason other than the last command.
    #[pyo3(signature = (command, finished = false, *, torques = None, elbow = None))]
    fn write_once(
        &self,
        py: Python<'_>,
        command: &Bound<'_, PyAny>,
        finished: bool,
        torques: Option<&Bound<'_, PyAny>>,
        elbow: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<Report>> {
        let elbow = elbow.map(|elbow| vector("elbow", elbow)).transpose()?;
        let torques = torques.map(|torques| vector("torques", torques));
        let written = Written {
            motion: self.motion(command, elbow)?,
            torques: torques.transpose()?.map(Torques),
            finished,
        };
        let sent = py.detach(|| {
            let mut guard = self.take_turn()?;
            let cycle = guard.as_mut().ok_or_else(stopped)?;
            Ok::<_, PyErr>(cycle.write(written))
        })?;
        let report = sent.map_err(|error| error.raise(py))?;
        Ok(report.map(Report))
    }

    /// Stops the robot, unless the last command has been written. First waits until a call of
    /// another thread has returned.
    fn stop(&self, py: Python<'_>) {
        py.detach(|| {
            let mut guard = self.cycle.lock().unwrap_or_else(PoisonError::into_inner);
            *guard = None;
        });
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, PyAny>) {
        self.stop(py);
    }

    fn __repr__(&self) -> String {
        format!("<ActiveControl by {}>", self.kind.name())
    }
}

impl ActiveControl {
    /// # Errors
    /// Locks the cycle; `RuntimeError` while another thread is in a call.
    fn take_turn(&self) -> PyResult<MutexGuard<'_, Option<Cycle>>> {
        match self.cycle.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread is reading or writing, expected one thread at a time for active \
                 control",
            )),
        }
    }

    fn motion(&self, command: &Bound<'_, PyAny>, elbow: Option<[f64; 2]>) -> PyResult<Motion> {
        Ok(match self.kind {
            CommandKind::Torques => Motion::Torques(Torques(vector("command", command)?)),
            CommandKind::JointPositions | CommandKind::JointVelocities => {
                Motion::Seven(vector("command", command)?)
            }
            CommandKind::CartesianPose => {
                let matrix: Matrix4<f64> = pose_matrix("command", command)?;
                Motion::Pose(matrix.as_slice().try_into().expect("16 numbers"), elbow)
            }
            CommandKind::CartesianVelocities => Motion::Twist(vector("command", command)?, elbow),
        })
    }
}

impl Cycle {
    fn write(&mut self, written: Written) -> Result<Option<MotionReport>, ActiveError> {
        let Written {
            motion,
            torques,
            finished,
        } = written;
        macro_rules! write {
            ($active:ident, $command:expr) => {{
                let command = $command.finish_if(finished);
                match torques {
                    Some(torques) => $active.write_motion_and_torques(command, torques),
                    None => $active.write_motion(command),
                }
            }};
        }
        match (self, motion) {
            (Self::Torques(active), Motion::Torques(torques)) => {
                active.write_once(torques.finish_if(finished))
            }
            (Self::JointPositions(active), Motion::Seven(q)) => write!(active, JointPositions(q)),
            (Self::JointVelocities(active), Motion::Seven(dq)) => {
                write!(active, JointVelocities(dq))
            }
            (Self::CartesianPose(active), Motion::Pose(pose, elbow)) => {
                write!(
                    active,
                    CartesianPose {
                        O_T_EE: pose,
                        elbow
                    }
                )
            }
            (Self::CartesianVelocities(active), Motion::Twist(twist, elbow)) => {
                write!(
                    active,
                    CartesianVelocities {
                        O_dP_EE: twist,
                        elbow
                    }
                )
            }
            _ => unreachable!("`ActiveControl::motion` reads what the cycle takes"),
        }
    }
}

fn stopped() -> PyErr {
    PyRuntimeError::new_err("active control was stopped")
}
