//! Options of motions and sessions: keyword arguments, the same everywhere.

use std::time::Duration;

use franka_async::condition::Reaction;
use franka_async::goal::{
    AxisLimits, Budget, Deviation, ForceCap, Leash, OnTimeout, Settling, Tolerance, Tuning,
};
use franka_async::model::Model;
use pyo3::exceptions::{PyAttributeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::vector;
use crate::condition;
use crate::gains;
use crate::operation::seconds;

/// Keyword arguments that a call takes one after the other.
pub(crate) struct Keywords<'py> {
    call: &'static str,
    left: Option<Bound<'py, PyDict>>,
}

impl<'py> Keywords<'py> {
    /// Creates the keywords of the function `call`.
    pub(crate) fn new(call: &'static str, keywords: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        let left = keywords.map(PyDictMethods::copy).transpose()?;
        Ok(Self { call, left })
    }

    /// Returns the argument with this name, if it is given and not `None`.
    pub(crate) fn take(&mut self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.given(name)?.filter(|value| !value.is_none()))
    }

    /// Returns the argument with this name, if it is given, including `None`.
    fn given(&mut self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(left) = &self.left else {
            return Ok(None);
        };
        let value = left.get_item(name)?;
        if value.is_some() {
            left.del_item(name)?;
        }
        Ok(value)
    }

    /// Returns the argument with this name, if it is given and not `None`, as a plain value.
    pub(crate) fn value<T>(&mut self, name: &str) -> PyResult<Option<T>>
    where
        T: for<'a> FromPyObject<'a, 'py, Error: Into<PyErr>>,
    {
        self.read(name, |value| value.extract().map_err(Into::into))
    }

    /// Returns the argument with this name, if it is given and not `None`, converted by `read`.
    ///
    /// # Errors
    /// The errors of `read`; for a value of the wrong type with the name of the argument.
    pub(crate) fn read<T>(
        &mut self,
        name: &str,
        read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
    ) -> PyResult<Option<T>> {
        let value = self.take(name)?;
        value.map(|value| named(name, &value, read)).transpose()
    }

    /// Refuses arguments that were not taken.
    ///
    /// # Errors
    /// `TypeError`, as raised by Python.
    pub(crate) fn end(self) -> PyResult<()> {
        let left = self.left.as_ref().and_then(|left| left.iter().next());
        match left {
            None => Ok(()),
            Some((name, _)) => Err(PyTypeError::new_err(format!(
                "{}() got an unexpected keyword argument '{name}'",
                self.call
            ))),
        }
    }
}

/// Reads the argument `name`; an error of the wrong type contains this name.
fn named<'py, T>(
    name: &str,
    value: &Bound<'py, PyAny>,
    read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
) -> PyResult<T> {
    read(value).map_err(|error| {
        let py = value.py();
        if error.is_instance_of::<PyTypeError>(py) {
            return PyTypeError::new_err(format!("{name} is {value:?}: {}", error.value(py)));
        }
        // The expected class is more helpful than the missing attribute.
        match CLASSES.iter().find(|(argument, _)| *argument == name) {
            Some((_, class)) if error.is_instance_of::<PyAttributeError>(py) => {
                PyTypeError::new_err(format!("{name} is {value:?}, expected {class}"))
            }
            _ => error,
        }
    })
}

/// Arguments that are objects of `franka_async.goal`, with their classes.
const CLASSES: [(&str, &str); 7] = [
    ("gains", "Gains"),
    ("limits", "a Budget"),
    ("leash", "a Leash"),
    ("deviation", "a Deviation"),
    ("lead", "a Lead"),
    ("tolerance", "a Tolerance"),
    ("settling", "a Settling"),
];

/// The common options of motions, streams and sessions.
#[derive(Default)]
pub(crate) struct Options {
    pub(crate) speed: Option<f64>,
    pub(crate) tuning: Tuning,
    pub(crate) stiffness: Option<[f64; 6]>,
    pub(crate) tolerance: Option<Tolerance>,
    pub(crate) settling: Option<Settling>,
    pub(crate) until: Option<Reaction>,
}

impl Options {
    /// Takes the options of a session: `speed`, and the options of [`Self::tuning`].
    pub(crate) fn of_session(keywords: &mut Keywords<'_>, model: &Model) -> PyResult<Self> {
        Ok(Self {
            speed: keywords.value("speed")?,
            tuning: tuning(keywords, model)?,
            ..Self::default()
        })
    }

    /// Takes the options of a motion or a stream.
    pub(crate) fn of_goal(keywords: &mut Keywords<'_>, model: &Model) -> PyResult<Self> {
        let stiffness = keywords.take("stiffness")?;
        let until = keywords.take("until")?;
        Ok(Self {
            stiffness: stiffness
                .map(|value| vector("stiffness", &value))
                .transpose()?,
            tolerance: keywords.read("tolerance", tolerance)?,
            settling: keywords.read("settling", settling)?,
            until: until.map(|value| condition::reaction(&value)).transpose()?,
            ..Self::of_session(keywords, model)?
        })
    }
}

/// Sets the options on a builder of motions, streams or sessions, which have the same methods.
macro_rules! with_options {
    ($builder:expr, $options:expr, session) => {{
        let (mut builder, options) = ($builder, $options);
        let tuning = options.tuning;
        if let Some(limits) = tuning.budget {
            builder = builder.limits(limits);
        }
        if let Some(factor) = options.speed {
            builder = builder.speed(factor);
        }
        if let Some(gains) = tuning.gains {
            builder = builder.gains(gains);
        }
        match tuning.force_cap {
            None | Some(franka_async::goal::ForceCap::Default) => {}
            Some(franka_async::goal::ForceCap::Newtons(newtons)) => {
                builder = builder.force_cap(newtons);
            }
            Some(franka_async::goal::ForceCap::Off) => builder = builder.without_force_cap(),
        }
        if let Some(leash) = tuning.leash {
            builder = builder.leash(leash);
        }
        if let Some(deviation) = tuning.deviation {
            builder = builder.deviation(deviation);
        }
        if let Some(posture) = tuning.posture {
            builder = builder.posture(posture);
        }
        builder
    }};
    ($builder:expr, $options:expr) => {{
        let options = $options;
        let (stiffness, tolerance) = (options.stiffness, options.tolerance);
        let (settling, until) = (options.settling, options.until);
        let mut builder = $crate::options::with_options!($builder, options, session);
        if let Some(stiffness) = stiffness {
            builder = builder.stiffness(stiffness);
        }
        if let Some(tolerance) = tolerance {
            builder = builder.tolerance(tolerance);
        }
        if let Some(settling) = settling {
            builder = builder.settling(settling);
        }
        if let Some(until) = until {
            builder = builder.until(until);
        }
        builder
    }};
}

pub(crate) use with_options;

/// Takes the options that a session keeps and that can be tuned: `limits`, `gains`, `force_cap`,
/// `leash`, `deviation`, `posture`.
pub(crate) fn tuning(keywords: &mut Keywords<'_>, model: &Model) -> PyResult<Tuning> {
    let posture = keywords.take("posture")?;
    let force_cap = match keywords.given("force_cap")? {
        None => None,
        Some(cap) if cap.is_none() => Some(ForceCap::Off),
        Some(cap) => Some(ForceCap::Newtons(named("force_cap", &cap, |cap| {
            cap.extract()
        })?)),
    };
    let bounds = |value: &Bound<'_, PyAny>| value.extract::<Bounds>();
    Ok(Tuning {
        gains: keywords.read("gains", gains::read)?,
        budget: keywords.read("limits", |limits| budget(limits, model))?,
        force_cap,
        leash: keywords.read("leash", bounds)?.map(Bounds::leash),
        deviation: keywords.read("deviation", bounds)?.map(Bounds::deviation),
        posture: posture.map(|value| vector("posture", &value)).transpose()?,
    })
}

/// `franka_async.goal.Leash`, `Deviation` or `Lead`.
#[derive(FromPyObject)]
pub(crate) struct Bounds {
    pub(crate) translation: f64,
    pub(crate) rotation: f64,
    pub(crate) joints: f64,
}

impl Bounds {
    fn leash(self) -> Leash {
        Leash {
            translation: self.translation,
            rotation: self.rotation,
            joints: self.joints,
        }
    }

    fn deviation(self) -> Deviation {
        Deviation {
            translation: self.translation,
            rotation: self.rotation,
            joints: self.joints,
        }
    }
}

fn tolerance(value: &Bound<'_, PyAny>) -> PyResult<Tolerance> {
    Ok(Tolerance {
        translation: value.getattr("translation")?.extract()?,
        rotation: value.getattr("rotation")?.extract()?,
    })
}

fn settling(value: &Bound<'_, PyAny>) -> PyResult<Settling> {
    let part = |name| seconds(name, value.getattr(name)?.extract()?);
    Ok(Settling {
        hold: part("hold")?,
        timeout: part("timeout")?,
    })
}

/// `franka_async.goal.Limits`.
#[derive(FromPyObject)]
struct Limits {
    velocity: Option<f64>,
    acceleration: Option<f64>,
    jerk: Option<f64>,
}

impl Limits {
    fn or(&self, default: AxisLimits) -> AxisLimits {
        AxisLimits {
            velocity: self.velocity.unwrap_or(default.velocity),
            acceleration: self.acceleration.unwrap_or(default.acceleration),
            jerk: self.jerk.unwrap_or(default.jerk),
        }
    }
}

#[derive(FromPyObject)]
enum OfJoints {
    Each(Vec<Limits>),
    All(Limits),
}

/// Reads a `franka_async.goal.Budget`; missing fields have the default of `model`.
fn budget(value: &Bound<'_, PyAny>, model: &Model) -> PyResult<Budget> {
    let default = Budget::of(model.joint_limits());
    let part = |name| value.getattr(name)?.extract::<Limits>();
    let joints: OfJoints = value.getattr("joints")?.extract()?;
    Ok(Budget {
        translation: part("translation")?.or(default.translation),
        rotation: part("rotation")?.or(default.rotation),
        joints: core::array::from_fn(|i| match &joints {
            OfJoints::All(limits) => limits.or(default.joints[i]),
            OfJoints::Each(limits) => limits[i].or(default.joints[i]),
        }),
    })
}

/// Returns a `franka_async.goal.Budget`.
pub(crate) fn budget_object<'py>(py: Python<'py>, budget: &Budget) -> PyResult<Bound<'py, PyAny>> {
    let module = py.import("franka_async.goal")?;
    let class = module.getattr("Limits")?;
    let limits = |l: AxisLimits| class.call1((l.velocity, l.acceleration, l.jerk));
    let joints: PyResult<Vec<_>> = budget.joints.into_iter().map(limits).collect();
    let parts = (
        limits(budget.translation)?,
        limits(budget.rotation)?,
        joints?,
    );
    module.getattr("Budget")?.call1(parts)
}

/// Reads `watchdog`: seconds, and `brake` or `hold`.
pub(crate) fn watchdog(value: &Bound<'_, PyAny>) -> PyResult<(Duration, OnTimeout)> {
    let pair = value.extract();
    let (silence, what): (f64, String) = pair.map_err(|_: PyErr| {
        PyTypeError::new_err("expected a pair of seconds and 'brake' or 'hold'")
    })?;
    let on_timeout = match what.as_str() {
        "brake" => OnTimeout::Brake,
        "hold" => OnTimeout::Hold,
        _ => {
            let text =
                format!("watchdog is {what:?} after {silence} s, expected 'brake' or 'hold'");
            return Err(PyValueError::new_err(text));
        }
    };
    Ok((seconds("watchdog", silence)?, on_timeout))
}
