//! Control laws that run without the interpreter: a C function in the control cycle.
//!
//! | module | content |
//! |---|---|
//! | this | the class, and the execution of a law by a robot |
//! | `function` | the function's input, and its calls |

mod function;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_async::connection::Version;
use franka_async::control::slot::{Read, SlotReader, SlotWriter, slot};
use franka_async::control::{
    CartesianPose, CartesianVelocities, Control, JointPositions, JointVelocities, Torques,
};
use franka_async::model::{Model, RobotKind};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{Numbers as Argument, array, check_finite, unexpected_shape};
use crate::control::{CommandKind, controller};
use crate::motion::Report;
use crate::operation::{Operation, seconds};
use crate::robot::Robot;
use crate::state::RobotState;
use function::{Code, MOST, Numbers, Output, Running, Setup};

/// A control law: a C function that the real-time thread calls with every state, without the
/// interpreter. `include/franka_async_law.h` documents its input and its return value.
///
/// `code` is a `numba.cfunc`, a result of `franka_async.laws.compiled`, a function of a library
/// loaded by `ctypes` or `cffi`, or an address as an integer, whose code the program must keep.
/// `command` is the kind of the law's output: `torques`, `joint_positions`, `joint_velocities`,
/// `cartesian_pose` or `cartesian_velocities`. With `elbow=True`, the elbow follows the output of
/// the latter two: position of joint 3, rad, and the sign of joint 4; otherwise the robot chooses
/// the elbow. `parameters` and `memory`, `(n,)` with at most 256 numbers, are the initial values in
/// the first cycle.
///
/// The function runs on the real-time thread, with some 300 us to answer. It must not lock,
/// allocate, print or wait. Code that writes to invalid memory is not detected.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Law {
    code: Arc<Code>,
    command: CommandKind,
    /// True if the output has an elbow.
    elbow: bool,
    parameters: Mutex<Parameters>,
    memory: Vec<f64>,
    /// The memory of the newest run.
    remembered: Mutex<(SlotReader<Numbers>, Box<Numbers>)>,
    /// The cycles created by `step`.
    dry_run: Mutex<Option<Running>>,
}

struct Parameters {
    newest: Vec<f64>,
    writer: SlotWriter<Numbers>,
    /// Never read directly: every clone of it receives the newest parameters.
    reader: SlotReader<Numbers>,
}

#[pymethods]
impl Law {
    #[new]
    #[pyo3(signature = (
        code, *, command = "torques", elbow = false, parameters = None, memory = None,
    ))]
    fn new(
        py: Python<'_>,
        code: &Bound<'_, PyAny>,
        command: &str,
        elbow: bool,
        parameters: Option<&Bound<'_, PyAny>>,
        memory: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let command = CommandKind::of(command)?;
        if elbow && elbow_at(command).is_none() {
            let text = format!("elbow is True, expected False for {:?}", command.name());
            return Err(PyValueError::new_err(text));
        }
        let parameters = numbers("parameters", parameters)?;
        let memory = numbers("memory", memory)?;
        let laws = py.import("franka_async.laws")?;
        let address = laws.call_method1("address_of", (code,))?.extract()?;
        // SAFETY: the class requires this from its caller; the object that owns the code is kept
        // with it.
        let code = unsafe { Code::new(address, Box::new(code.clone().unbind())) };
        let code = code.ok_or_else(|| PyValueError::new_err("code is the null pointer"))?;
        let (writer, reader) = slot();
        let (_, nothing) = slot();
        Ok(Self {
            code: Arc::new(code),
            command,
            elbow,
            parameters: Mutex::new(Parameters {
                newest: parameters,
                writer,
                reader,
            }),
            remembered: Mutex::new((nothing, Box::new(function::padded(&memory)))),
            memory,
            dry_run: Mutex::new(None),
        })
    }

    /// Kind of the law's output.
    #[getter]
    fn command(&self) -> &'static str {
        self.command.name()
    }

    /// The newest parameters, `(n,)`. A running law receives new ones in its next cycle, all at
    /// once; their number is fixed. Raises `ValueError`.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &lock(&self.parameters).newest)
    }

    #[setter]
    fn set_parameters(&self, parameters: &Bound<'_, PyAny>) -> PyResult<()> {
        let values = numbers("parameters", Some(parameters))?;
        let mut parameters = lock(&self.parameters);
        if values.len() != parameters.newest.len() {
            let expected = format!("({},)", parameters.newest.len());
            return Err(unexpected_shape("parameters", &[values.len()], &expected));
        }
        parameters.writer.write(&function::padded(&values));
        parameters.newest = values;
        Ok(())
    }

    /// The memory after the newest cycle of the newest run, `(n,)`; before the first run, the
    /// initial memory.
    #[getter]
    fn memory<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let mut remembered = lock(&self.remembered);
        let (reader, newest) = &mut *remembered;
        if let Read::Newer(memory) = reader.read_retry(ATTEMPTS) {
            **newest = memory;
        }
        array(py, &newest[..self.memory.len()])
    }

    /// Calls the law once, with `state` and `dt` seconds after the previous state, without a robot.
    /// Returns its output, `(7,)`, `(4, 4)` or `(6,)`, or with an elbow the raw output, `(18,)` or
    /// `(8,)`; and its return value. Numbers that it did not write are NaN. Time and memory
    /// continue from call to call; `reset()` starts again. Model terms use the vendor's constants
    /// for the state's kind of robot.
    #[pyo3(signature = (state, dt = 0.001))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        state: &RobotState,
        dt: f64,
    ) -> PyResult<(Bound<'py, PyArrayDyn<f64>>, i32)> {
        let dt = seconds("dt", dt)?;
        let mut dry_run = lock(&self.dry_run);
        let running = dry_run.get_or_insert_with(|| {
            let kind = match state.version {
                Version::V5 => RobotKind::Fer,
                Version::V10 => RobotKind::Fr3,
            };
            self.running(Arc::new(Model::of(kind).clone()), state.version)
        });
        let (output, code) = running.call(&state.state, dt);
        Ok((self.shaped(py, &output)?, code))
    }

    /// Makes the next `step` begin with time 0 and the initial memory.
    fn reset(&self) {
        *lock(&self.dry_run) = None;
    }

    fn __repr__(&self) -> String {
        let parameters = lock(&self.parameters).newest.len();
        let memory = self.memory.len();
        let command = self.command.name();
        format!("<Law for {command}, {parameters} parameters, memory of {memory}>")
    }
}

impl Law {
    /// Returns the law before the first cycle of a run, whose memory is visible from now on.
    fn running(&self, model: Arc<Model>, version: Version) -> Running {
        let (remembered, reader) = slot();
        *lock(&self.remembered) = (reader, Box::new(function::padded(&self.memory)));
        let parameters = lock(&self.parameters);
        let setup = Setup {
            model,
            version,
            parameters: &parameters.newest,
            arriving: parameters.reader.clone(),
            memory: &self.memory,
            remembered,
        };
        Running::new(self.code.clone(), setup)
    }

    /// Returns the control function that calls the law.
    fn control(&self, robot: &franka_async::Robot) -> Control {
        let model = Arc::new(robot.model().clone());
        let mut law = self.running(model, robot.version());
        let elbow = elbow_at(self.command).filter(|_| self.elbow);
        let elbow = move |o: &Output| elbow.map(|at| [o[at], o[at + 1]]);
        match self.command {
            CommandKind::Torques => {
                robot.control_torques(move |s, dt| law.next(s, dt, |o| Torques(first(o))))
            }
            CommandKind::JointPositions => robot.control_joint_positions(move |s, dt| {
                law.next(s, dt, |o| JointPositions(first(o)))
            }),
            CommandKind::JointVelocities => robot.control_joint_velocities(move |s, dt| {
                law.next(s, dt, |o| JointVelocities(first(o)))
            }),
            CommandKind::CartesianPose => robot.control_cartesian_pose(move |s, dt| {
                law.next(s, dt, |o| CartesianPose {
                    O_T_EE: transposed(o),
                    elbow: elbow(o),
                })
            }),
            CommandKind::CartesianVelocities => robot.control_cartesian_velocities(move |s, dt| {
                law.next(s, dt, |o| CartesianVelocities {
                    O_dP_EE: first(o),
                    elbow: elbow(o),
                })
            }),
        }
    }

    /// Returns the output as an array of the command's shape.
    fn shaped<'py>(
        &self,
        py: Python<'py>,
        output: &Output,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let shape: &[usize] = match (self.command, self.elbow) {
            (CommandKind::CartesianPose, false) => &[4, 4],
            (CommandKind::CartesianPose, true) => &[18],
            (CommandKind::CartesianVelocities, false) => &[6],
            (CommandKind::CartesianVelocities, true) => &[8],
            _ => &[7],
        };
        array(py, &output[..shape.iter().product()]).reshape(shape)
    }
}

#[pymethods]
impl Robot {
    /// Controls by a law without the interpreter in the cycle: a `Law`, or code for one with
    /// `command`, `elbow`, `parameters` and `memory`. Resolves with a `MotionReport` when the law
    /// has returned a positive number and the robot has ended the motion.
    ///
    /// `controller` selects the robot's own controller for commands other than torques.
    /// `limit_rate` enables the limiter: by default on a Franka Emika Robot and not on a Franka
    /// Research 3, as in the vendor's library. `cutoff_frequency` is the frequency of the low-pass
    /// filter, Hz; 1000 disables it.
    ///
    /// Raises `MotionError` of the kind `given_up` if the law returned a negative number, which is
    /// its `code`; of the kind `invalid` for output that is not finite; and `busy` while another
    /// motion controls the arm. Cancelling stops the robot.
    #[pyo3(signature = (
        law, *, command = None, elbow = false, parameters = None, memory = None,
        controller = "joint_impedance", limit_rate = None, cutoff_frequency = None,
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn run_law(
        &self,
        py: Python<'_>,
        law: &Bound<'_, PyAny>,
        command: Option<&str>,
        elbow: bool,
        parameters: Option<&Bound<'_, PyAny>>,
        memory: Option<&Bound<'_, PyAny>>,
        controller: &str,
        limit_rate: Option<bool>,
        cutoff_frequency: Option<f64>,
    ) -> PyResult<Operation> {
        let controller = self::controller(controller)?;
        let law = match law.cast::<Law>() {
            Ok(_) if command.is_some() || elbow || parameters.is_some() || memory.is_some() => {
                return Err(PyValueError::new_err(
                    "got command, elbow, parameters or memory besides a Law, which already \
                     contains them: pass them to Law",
                ));
            }
            Ok(law) => law.clone(),
            Err(_) => {
                let command = command.unwrap_or("torques");
                Bound::new(py, Law::new(py, law, command, elbow, parameters, memory)?)?
            }
        };
        let robot = self.connected()?;
        let mut control = law.get().control(&robot).controller(controller);
        if let Some(limit) = limit_rate {
            control = control.limit_rate(limit);
        }
        if let Some(frequency) = cutoff_frequency {
            if !(frequency > 0.0 && frequency.is_finite()) {
                let text = format!("cutoff_frequency is {frequency}, expected a positive number");
                return Err(PyValueError::new_err(text));
            }
            control = control.cutoff_frequency(frequency);
        }
        Ok(Operation::new("Robot.run_law", async move {
            control.await.map(Report)
        }))
    }
}

/// Places of a law's input fields: name, offset in bytes, shape, numpy format; and the total size.
#[pyfunction]
pub(crate) fn _law_layout() -> (Vec<function::Place>, usize) {
    (function::layout(), size_of::<function::Cycle>())
}

/// Reads up to [`MOST`] numbers.
fn numbers(name: &str, argument: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<f64>> {
    let Some(argument) = argument else {
        return Ok(Vec::new());
    };
    let Argument { shape, values } = Argument::read(name, argument)?;
    if shape.len() != 1 || values.len() > MOST {
        let expected = format!("(n,) with n up to {MOST}");
        return Err(unexpected_shape(name, &shape, &expected));
    }
    check_finite(name, &values)?;
    Ok(values)
}

/// Returns the position of the elbow in the output, for commands that have one.
fn elbow_at(command: CommandKind) -> Option<usize> {
    match command {
        CommandKind::CartesianPose => Some(16),
        CommandKind::CartesianVelocities => Some(6),
        _ => None,
    }
}

fn first<const N: usize>(output: &Output) -> [f64; N] {
    std::array::from_fn(|i| output[i])
}

/// Returns a pose in column-major order, as in commands, from row-major order.
fn transposed(output: &Output) -> [f64; 16] {
    std::array::from_fn(|i| output[i % 4 * 4 + i / 4])
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // No operation leaves the data in an invalid state.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Number of attempts to read a memory that is written every millisecond, in some 100 ns.
const ATTEMPTS: usize = 100;
