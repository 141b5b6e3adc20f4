//! The trajectory generator: time-optimal motions of any number of axes inside limits of velocity,
//! acceleration and jerk.
//!
//! | module | content |
//! |---|---|
//! | this | planning, and the planned motion |
//! | `limits` | its limits |

mod limits;

use franka_otg::{Generator, Limits, PlanError, State, Synchronisation};
use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{Numbers, array, check_finite, unexpected_shape};
use crate::batch::{Cost, outputs};

pub(crate) use limits::AxisLimits;

type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// A planned motion. It begins at time 0 in its start state, and is at rest from `duration` on.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Trajectory {
    motion: Box<dyn Motion>,
    axes: usize,
}

/// A plan for a number of axes known at compile time, which may exceed the requested number.
trait Motion: Send + Sync {
    /// Returns the times at which all axes rest, and at which the target is met, s.
    fn times(&self) -> [f64; 2];

    /// Returns the position of rest.
    fn end(&self) -> &[f64];

    /// Writes position, velocity and acceleration at time `t`.
    fn sample(&self, t: f64, parts: [&mut [f64]; 3]);
}

impl<const N: usize> Motion for Generator<N> {
    fn times(&self) -> [f64; 2] {
        [self.remaining(), self.time_to_target()]
    }

    fn end(&self) -> &[f64] {
        Generator::end(self)
    }

    fn sample(&self, t: f64, parts: [&mut [f64]; 3]) {
        let state = Generator::sample(self, t);
        let whole: [&[f64]; 3] = [&state.position, &state.velocity, &state.acceleration];
        for (part, whole) in parts.into_iter().zip(whole) {
            part.copy_from_slice(&whole[..part.len()]);
        }
    }
}

/// Plans the fastest motion from `start` to `target`, both `(n,)`, inside `limits`; of one axis to
/// 64. Without a target, `None`, to rest as early as possible.
///
/// The motion may begin with `start_velocity` and `start_acceleration`, and pass the target with
/// `target_velocity` and `target_acceleration`, `(n,)` each, zero by default. If the target has a
/// velocity, the motion passes it and stops behind it. All axes are at the target at the same time.
/// With `synchronisation` `straight`, they move on a straight line if the start state allows it;
/// with `time`, each axis moves on its own path.
///
/// `ValueError` for shapes that do not match, numbers that are not finite, and a target that moves
/// faster than the limits allow.
#[pyfunction]
#[pyo3(signature = (start, target, limits, *, start_velocity = None, start_acceleration = None, target_velocity = None, target_acceleration = None, synchronisation = "straight"))]
#[allow(clippy::too_many_arguments)] // the caller names each argument
pub(crate) fn plan_trajectory(
    py: Python<'_>,
    start: &Bound<'_, PyAny>,
    target: Option<&Bound<'_, PyAny>>,
    limits: &AxisLimits,
    start_velocity: Option<&Bound<'_, PyAny>>,
    start_acceleration: Option<&Bound<'_, PyAny>>,
    target_velocity: Option<&Bound<'_, PyAny>>,
    target_acceleration: Option<&Bound<'_, PyAny>>,
    synchronisation: &str,
) -> PyResult<Trajectory> {
    let position = axes("start", start, None)?;
    let n = position.len();
    if let Some(axes) = limits.axes()?
        && axes != n
    {
        let text = format!("limits have {axes} axes, expected {n} as start has");
        return Err(PyValueError::new_err(text));
    }
    let part = |name: &str, argument: Option<&Bound<'_, PyAny>>| {
        argument.map_or(Ok(vec![0.0; n]), |argument| axes(name, argument, Some(n)))
    };
    let start = [
        position,
        part("start_velocity", start_velocity)?,
        part("start_acceleration", start_acceleration)?,
    ];
    let to = [
        part("target", target)?,
        part("target_velocity", target_velocity)?,
        part("target_acceleration", target_acceleration)?,
    ];
    if target.is_none() && (target_velocity.is_some() || target_acceleration.is_some()) {
        let text = "target is None, expected a target for the given velocity or acceleration";
        return Err(PyValueError::new_err(text));
    }
    let synchronisation = match synchronisation {
        "straight" => Synchronisation::Straight,
        "time" => Synchronisation::Time,
        other => {
            let text = format!("synchronisation is {other:?}, expected 'straight' or 'time'");
            return Err(PyValueError::new_err(text));
        }
    };
    let task = Task {
        start,
        target: target.is_some().then_some(to),
        limits,
        synchronisation,
    };
    let motion = py.detach(|| match n {
        1 => task.plan::<1>(),
        2 => task.plan::<2>(),
        3 => task.plan::<3>(),
        4..=6 => task.plan::<6>(),
        7 => task.plan::<7>(),
        8..=16 => task.plan::<16>(),
        _ => task.plan::<AXES_MAX>(),
    });
    let motion = motion.map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(Trajectory { motion, axes: n })
}

/// Largest number of axes.
const AXES_MAX: usize = 64;

fn axes(name: &str, argument: &Bound<'_, PyAny>, expected: Option<usize>) -> PyResult<Vec<f64>> {
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    let fits = match (expected, &*shape) {
        (None, [n]) => (1..=AXES_MAX).contains(n),
        (Some(expected), [n]) => *n == expected,
        _ => false,
    };
    if !fits {
        let expected = match expected {
            Some(n) => format!("({n},) as start has"),
            None => format!("(n,) with n from 1 to {AXES_MAX}"),
        };
        return Err(unexpected_shape(name, &shape, &expected));
    }
    check_finite(name, &values)?;
    Ok(values)
}

/// The planning task: position, velocity and acceleration of each axis.
struct Task<'a> {
    start: [Vec<f64>; 3],
    target: Option<[Vec<f64>; 3]>,
    limits: &'a AxisLimits,
    synchronisation: Synchronisation,
}

impl Task<'_> {
    /// Plans with `N` axes; additional axes stay at zero and do not affect the plan.
    fn plan<const N: usize>(&self) -> Result<Box<dyn Motion>, PlanError> {
        let limits = Limits::per_axis(std::array::from_fn(|axis| self.limits.axis(axis)))?;
        let generator = Generator::<N>::new(state(&self.start), limits)?;
        let mut generator = generator.with_synchronisation(self.synchronisation);
        if let Some(target) = &self.target {
            generator.set_moving_target(&state(target))?;
        }
        Ok(Box::new(generator))
    }
}

fn state<const N: usize>([position, velocity, acceleration]: &[Vec<f64>; 3]) -> State<N> {
    let whole = |part: &[f64]| std::array::from_fn(|axis| part.get(axis).copied().unwrap_or(0.0));
    State {
        position: whole(position),
        velocity: whole(velocity),
        acceleration: whole(acceleration),
    }
}

#[pymethods]
impl Trajectory {
    /// Time until rest, s.
    #[getter]
    fn duration(&self) -> f64 {
        self.motion.times()[0]
    }

    /// Time at which the target is met, s: the duration, unless the target moves.
    #[getter]
    fn arrival(&self) -> f64 {
        self.motion.times()[1]
    }

    /// Number of axes.
    #[getter]
    fn axes(&self) -> usize {
        self.axes
    }

    /// Position of rest, `(axes,)`.
    #[getter]
    fn end<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        array(py, &self.motion.end()[..self.axes])
    }

    /// Position, velocity and acceleration at the time `t` in s, `(axes,)` each, or at many times,
    /// `(m,)`, `(m, axes)` each. Before the beginning it returns the start state, after the end the
    /// state at rest.
    fn at<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
    ) -> PyResult<(Array<'py>, Array<'py>, Array<'py>)> {
        let Numbers { shape, values } = Numbers::read("t", t)?;
        check_finite("t", &values)?;
        match *shape {
            [] => Ok(self.samples(py, None, |_| values[0])),
            [m] => Ok(self.samples(py, Some(m), |i| values[i])),
            _ => Err(unexpected_shape("t", &shape, "a number or (m,)")),
        }
    }

    /// Times every `dt` seconds from the beginning to the first one at rest, `(m,)`, with position,
    /// velocity and acceleration, `(m, axes)` each.
    #[pyo3(signature = (dt = 0.001))]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        dt: f64,
    ) -> PyResult<(Array<'py>, Array<'py>, Array<'py>, Array<'py>)> {
        if !(dt.is_finite() && dt > 0.0) {
            let text = format!("dt is {dt}, expected a positive finite number of seconds");
            return Err(PyValueError::new_err(text));
        }
        let steps = (self.duration() / dt - 1e-9).ceil().max(0.0);
        if steps > SAMPLES_MAX {
            let text = format!("dt is {dt}, which makes {steps} samples, expected fewer");
            return Err(PyValueError::new_err(text));
        }
        let count = Some(steps as usize + 1);
        let [times] = outputs(py, count, [&[]], Cost::Little, |i, [time]| {
            time[0] = i as f64 * dt;
        });
        let (position, velocity, acceleration) = self.samples(py, count, |i| i as f64 * dt);
        Ok((times, position, velocity, acceleration))
    }

    fn __repr__(&self) -> String {
        let axes = if self.axes == 1 { "axis" } else { "axes" };
        format!(
            "<Trajectory of {} {axes}, {:.4} s>",
            self.axes,
            self.duration()
        )
    }
}

impl Trajectory {
    fn samples<'py>(
        &self,
        py: Python<'py>,
        count: Option<usize>,
        time: impl Fn(usize) -> f64 + Send + Sync,
    ) -> (Array<'py>, Array<'py>, Array<'py>) {
        let shape: &[usize] = &[self.axes];
        let arrays = outputs(py, count, [shape; 3], Cost::Little, |i, parts| {
            self.motion.sample(time(i), parts);
        });
        arrays.into()
    }
}

/// Number of samples above which `dt` is considered to have a wrong unit.
const SAMPLES_MAX: f64 = 1e8;
