//! Simulated robots without sockets and clocks: they advance on request, as fast as the machine
//! computes.
//!
//! ```text
//! action ──> Control: a command per cycle ──wire──> franka_sim::Robot ──> observation, errors
//! ```
//!
//! | module | content |
//! |---|---|
//! | this | the class: many robots, stepped together |
//! | `member` | one robot and its client |
//! | `control` | conversion of an action to the commands of each cycle |

mod control;
mod member;

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use franka_model::{Model, RobotKind, Wrench};
use franka_sim::Tool;
use franka_sim::arm::{Arm, Family};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{Numbers, check_finite, unexpected_shape, vector};
use crate::state::RobotState;
use crate::state_views::{FLAT_LEN, write_flat};
use control::Kind;
use member::{Member, Settings};

/// Simulated robots in one process, without sockets, each with a separate motion: `step` sets an
/// action for each and simulates some milliseconds.
///
/// Actions depend on `control`: `joint_velocity`, `(7,)` rad/s to approach; `joint_delta`, `(7,)`
/// rad by which the target moves; `cartesian_delta`, `(6,)` m and a rotation vector in base axes by
/// which the end effector's target moves; `torque`, `(7,)` N m in addition to gravity. Motions keep
/// the robot's limits of velocity, acceleration and jerk, torques its rate limit; positions stay
/// away from the ends of the joint ranges. `speed` is the share of the largest velocity that
/// motions use.
///
/// The arm is `realistic` (with stiction and elasticity), `ideal`, `nominal`, `bad`, or `sampled`:
/// a different realistic arm for each seed. Robots have a Franka Hand unless `hand` is false.
/// `threads` share the work of a step.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct VirtualRobots {
    settings: Settings,
    arm: ArmChoice,
    threads: usize,
    count: usize,
    robots: Mutex<Vec<Member>>,
}

/// Observations, and the flags of the moving robots.
type Step<'py> = (Bound<'py, PyArrayDyn<f64>>, Bound<'py, PyArray1<bool>>);

/// The choice of a robot's arm.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ArmChoice {
    Ideal,
    Nominal,
    Realistic,
    Bad,
    Sampled,
}

impl ArmChoice {
    fn arm(self, kind: RobotKind, seed: u64) -> Arm {
        match self {
            Self::Ideal => Arm::ideal(kind),
            Self::Nominal => Arm::nominal(kind),
            Self::Realistic => Arm::realistic(kind),
            Self::Bad => Arm::bad(kind),
            Self::Sampled => Arm::sample(kind, seed, &Family::realistic()),
        }
    }
}

#[pymethods]
impl VirtualRobots {
    #[new]
    #[pyo3(signature = (kind = "fr3", count = 1, *, control = "joint_velocity", arm = "realistic", hand = true, speed = 0.5, threads = 1))]
    #[allow(clippy::too_many_arguments)] // the caller names each argument
    fn new(
        py: Python<'_>,
        kind: &str,
        count: usize,
        control: &str,
        arm: &str,
        hand: bool,
        speed: f64,
        threads: usize,
    ) -> PyResult<Self> {
        let kind = choice(
            "kind",
            kind,
            &[("fr3", RobotKind::Fr3), ("fer", RobotKind::Fer)],
        )?;
        let control = choice("control", control, &Kind::NAMES)?;
        let arm = choice("arm", arm, &ARMS)?;
        if !(speed > 0.0 && speed <= 1.0) {
            let text = format!("speed is {speed}, expected a share above 0 and up to 1");
            return Err(PyValueError::new_err(text));
        }
        if count == 0 || threads == 0 {
            let text = format!("count is {count} and threads {threads}, expected 1 or more");
            return Err(PyValueError::new_err(text));
        }
        let settings = Settings {
            kind,
            control,
            tool: if hand { Tool::hand() } else { Tool::NONE },
            speed,
        };
        let make = |seed| Member::new(&settings, arm.arm(kind, seed), seed, None);
        let robots: Result<_, String> = py.detach(|| (0..count as u64).map(make).collect());
        Ok(Self {
            robots: Mutex::new(robots.map_err(PyRuntimeError::new_err)?),
            settings,
            arm,
            threads,
            count,
        })
    }

    /// Number of robots.
    fn __len__(&self) -> usize {
        self.count
    }

    /// Length of an action: 6 or 7.
    #[getter]
    fn action_size(&self) -> usize {
        self.settings.control.size()
    }

    /// Largest effective action of each axis in one step of `cycles`: rad/s, rad, m and rad, or N
    /// m. Larger actions are clipped.
    #[pyo3(signature = (cycles = 1))]
    fn action_bound<'py>(&self, py: Python<'py>, cycles: u32) -> Bound<'py, PyArray1<f64>> {
        let bound = self.settings.action_bound(f64::from(cycles) * 1e-3);
        PyArray1::from_vec(py, bound)
    }

    /// Restarts robot `index`, counted from 0: at rest at the joint positions `q`, `(7,)` rad, by
    /// default the ready pose. Noise, and a sampled arm, come from `seed`: the same seed and
    /// actions give the same states.
    #[pyo3(signature = (index, *, seed = 0, q = None))]
    fn reset(
        &self,
        py: Python<'_>,
        index: usize,
        seed: u64,
        q: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let q = q.map(|q| vector::<7>("q", q)).transpose()?;
        let limits = Model::of(self.settings.kind).joint_limits();
        if let Some(q) = q.filter(|q| !limits.contains(&(*q).into())) {
            let text = format!("q is {q:?}, expected positions within the joint limits");
            return Err(PyValueError::new_err(text));
        }
        self.check(index)?;
        py.detach(|| {
            let arm = self.arm.arm(self.settings.kind, seed);
            let member = Member::new(&self.settings, arm, seed, q.map(Into::into));
            self.lock()[index] = member.map_err(PyRuntimeError::new_err)?;
            Ok(())
        })
    }

    /// Sets the action of every robot, `(n, 6 or 7)`, and simulates `cycles` milliseconds. Returns
    /// `flat()` of the states after that, `(n, 69)`, and flags for the moving robots, `(n,)`: a
    /// robot that has stopped itself (see `errors`) does not move until its `reset`.
    #[pyo3(signature = (actions, cycles = 1))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        actions: &Bound<'py, PyAny>,
        cycles: u32,
    ) -> PyResult<Step<'py>> {
        let Numbers { shape, values } = Numbers::read("actions", actions)?;
        let (count, width) = (self.count, self.action_size());
        if shape != [count, width] {
            let expected = format!("({count}, {width})");
            return Err(unexpected_shape("actions", &shape, &expected));
        }
        check_finite("actions", &values)?;
        let mut running = vec![false; count];
        let observations = self.observe(py, |robots, numbers| {
            let jobs = robots
                .iter_mut()
                .zip(values.chunks_exact(width))
                .zip(numbers.chunks_exact_mut(FLAT_LEN))
                .zip(&mut running);
            let jobs: Vec<_> = jobs.collect();
            self.share(jobs, |(((robot, action), numbers), running)| {
                robot.run(action, cycles);
                write_flat(robot.state(), numbers);
                *running = robot.is_running();
            });
        });
        Ok((observations, PyArray1::from_vec(py, running)))
    }

    /// `flat()` of the newest states, `(n, 69)`.
    fn observations<'py>(&self, py: Python<'py>) -> Bound<'py, PyArrayDyn<f64>> {
        self.observe(py, |robots, numbers| {
            for (robot, numbers) in robots.iter().zip(numbers.chunks_exact_mut(FLAT_LEN)) {
                write_flat(robot.state(), numbers);
            }
        })
    }

    /// Newest state of robot `index`.
    fn state(&self, py: Python<'_>, index: usize) -> PyResult<RobotState> {
        self.with(py, index, |robot| {
            RobotState::new(*robot.state(), robot.version())
        })
    }

    /// The errors that stopped robot `index`, by the vendor's names; empty while it moves.
    fn errors(&self, py: Python<'_>, index: usize) -> PyResult<Vec<String>> {
        self.with(py, index, |robot| crate::state::names(robot.state().errors))
    }

    /// Pushes the end effector of robot `index` with `wrench`, `(6,)` N and N m in base axes, for
    /// this number of milliseconds of its time.
    fn push(
        &self,
        py: Python<'_>,
        index: usize,
        wrench: &Bound<'_, PyAny>,
        duration: u64,
    ) -> PyResult<()> {
        let wrench = Wrench::from(vector::<6>("wrench", wrench)?);
        self.with(py, index, |robot| robot.push(wrench, duration))
    }

    fn __repr__(&self) -> String {
        format!(
            "<VirtualRobots: {} of {:?}, control {}>",
            self.count,
            self.settings.kind,
            self.settings.control.name()
        )
    }
}

impl VirtualRobots {
    fn lock(&self) -> MutexGuard<'_, Vec<Member>> {
        self.robots.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn check(&self, index: usize) -> PyResult<()> {
        let count = self.count;
        if index < count {
            return Ok(());
        }
        let text = format!("index is {index}, expected one of 0 to {}", count - 1);
        Err(PyIndexError::new_err(text))
    }

    /// Runs `work` with robot `index`. While it waits for a step of another thread, the interpreter
    /// is released.
    ///
    /// # Errors
    /// `IndexError` if the robot does not exist.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        index: usize,
        work: impl FnOnce(&mut Member) -> T + Send,
    ) -> PyResult<T> {
        self.check(index)?;
        Ok(py.detach(|| work(&mut self.lock()[index])))
    }

    /// Returns a new array with a row for each robot that `write` fills while the interpreter is
    /// released.
    fn observe<'py>(
        &self,
        py: Python<'py>,
        write: impl FnOnce(&mut [Member], &mut [f64]) + Send,
    ) -> Bound<'py, PyArrayDyn<f64>> {
        let array = PyArrayDyn::<f64>::zeros(py, [self.count, FLAT_LEN].as_slice(), false);
        {
            let mut writer = array.readwrite();
            let numbers = writer
                .as_slice_mut()
                .expect("a new array is in one piece of memory");
            py.detach(|| write(&mut self.lock(), numbers));
        }
        array
    }

    /// Runs `work` on every job, shared by the threads.
    fn share<T: Send>(&self, mut jobs: Vec<T>, work: impl Fn(T) + Sync) {
        let each = jobs.len().div_ceil(self.threads);
        thread::scope(|scope| {
            while jobs.len() > each {
                let part = jobs.split_off(jobs.len() - each);
                let work = &work;
                scope.spawn(move || part.into_iter().for_each(work));
            }
            jobs.into_iter().for_each(&work);
        });
    }
}

const ARMS: [(&str, ArmChoice); 5] = [
    ("realistic", ArmChoice::Realistic),
    ("ideal", ArmChoice::Ideal),
    ("nominal", ArmChoice::Nominal),
    ("bad", ArmChoice::Bad),
    ("sampled", ArmChoice::Sampled),
];

/// Returns the value with this name.
///
/// # Errors
/// `ValueError` with all names.
fn choice<T: Copy>(argument: &str, got: &str, all: &[(&str, T)]) -> PyResult<T> {
    let found = all.iter().find(|(name, _)| *name == got);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        let text = format!(
            "{argument} is {got:?}, expected one of {}",
            names.join(", ")
        );
        PyValueError::new_err(text)
    })
}
