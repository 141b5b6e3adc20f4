//! Conditions that end a motion.

use franka_async::condition::{self, Axis, Reaction};
use franka_async::error::ConditionError;
use pyo3::basic::CompareOp;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::destination::target;
use crate::operation::seconds;
use crate::tare::PyWrenchTare;

/// A condition: comparisons of quantities, flags of the robot and the time, joined by `&`, `|` and
/// `~`. See `franka_async.condition`.
#[pyclass(frozen, from_py_object, module = "franka_async.condition")]
#[derive(Clone, PartialEq)]
pub(crate) struct Condition {
    condition: condition::Condition,
    text: String,
}

impl Condition {
    /// # Errors
    /// `ValueError` for impossible thresholds, and for conditions that are too long.
    fn new(condition: condition::Condition, text: String) -> PyResult<Self> {
        let text = match condition.check() {
            Ok(()) => return Ok(Self { condition, text }),
            Err(ConditionError::Threshold { quantity, got }) => format!(
                "the threshold for {} is {got}, expected a finite number (above 0 for a \
                 magnitude)",
                name(quantity)
            ),
            Err(error) => error.to_string(),
        };
        Err(PyValueError::new_err(text))
    }
}

#[pymethods]
impl Condition {
    fn __and__(&self, other: &Self) -> PyResult<Self> {
        let text = format!("({} & {})", self.text, other.text);
        Self::new(self.condition & other.condition, text)
    }

    fn __or__(&self, other: &Self) -> PyResult<Self> {
        let text = format!("({} | {})", self.text, other.text);
        Self::new(self.condition | other.condition, text)
    }

    fn __invert__(&self) -> PyResult<Self> {
        Self::new(!self.condition, format!("~{}", self.text))
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(PyTypeError::new_err(
            "a condition is neither true nor false in Python: join conditions with & | ~, each in \
             brackets",
        ))
    }

    /// Compares the changes since the beginning of the motion instead of the values, in every
    /// comparison of this condition: for undeclared loads, and for displacements.
    fn relative(&self) -> PyResult<Self> {
        Self::new(
            self.condition.relative(),
            format!("{}.relative()", self.text),
        )
    }

    /// Subtracts a tare from the forces, moments and joint torques of this condition, as returned
    /// by `await robot.tare()`. The moment is then about the origin of the stiffness frame.
    #[pyo3(signature = (tare, /))]
    fn tared(&self, tare: &PyWrenchTare) -> PyResult<Self> {
        Self::new(
            self.condition.tared(&tare.0),
            format!("{}.tared({})", self.text, tare.__repr__()),
        )
    }

    /// True once this condition has been true for `seconds` without a break, by the robot's clock.
    #[pyo3(signature = (seconds, /))]
    fn held_for(&self, seconds: f64) -> PyResult<Self> {
        let time = self::seconds("seconds", seconds)?;
        let text = format!("{}.held_for({seconds:?})", self.text);
        Self::new(self.condition.held_for(time), text)
    }

    /// Moves to `target`, a pose or `Joints`, once the condition is true; without a target the arm
    /// stops. The arm turns to the target at once, without waiting for the program.
    fn then(&self, target: &Bound<'_, PyAny>) -> PyResult<Then> {
        let reaction = self.condition.then(self::target("target", target)?);
        let text = format!("{}.then({})", self.text, target.repr()?);
        Ok(Then { reaction, text })
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.condition == other.condition
    }

    fn __repr__(&self) -> &str {
        &self.text
    }
}

/// A condition with the target once it is true: created by `Condition.then(target)`.
#[pyclass(
    frozen,
    from_py_object,
    name = "Reaction",
    module = "franka_async.condition"
)]
#[derive(Clone)]
pub(crate) struct Then {
    reaction: Reaction,
    text: String,
}

#[pymethods]
impl Then {
    fn __eq__(&self, other: &Self) -> bool {
        self.reaction == other.reaction
    }

    fn __repr__(&self) -> &str {
        &self.text
    }
}

/// Reads the argument `until`: a condition, or a condition with a target.
pub(crate) fn reaction(until: &Bound<'_, PyAny>) -> PyResult<Reaction> {
    if let Ok(then) = until.cast::<Then>() {
        return Ok(then.get().reaction);
    }
    match until.cast::<Condition>() {
        Ok(condition) => Ok(condition.get().condition.into()),
        Err(_) => Err(PyTypeError::new_err(format!(
            "until is {}, expected a condition of franka_async.condition",
            until.repr()?
        ))),
    }
}

/// A number that changes while the arm moves: compare it with `<`, `<=`, `>` or `>=` to create a
/// condition.
///
/// Forces and torques are the robot's estimates, positive where the arm exerts them. Axes are the
/// base frame's.
#[pyclass(frozen, module = "franka_async.condition")]
pub(crate) struct Quantity {
    quantity: condition::Quantity,
    text: String,
}

#[pymethods]
impl Quantity {
    /// True while it is at or above `value`: the same as `quantity >= value`.
    fn above(&self, value: f64) -> PyResult<Condition> {
        let text = format!("({} >= {value:?})", self.text);
        Condition::new(self.quantity.above(value), text)
    }

    /// True while it is at or below `value`: the same as `quantity <= value`.
    fn below(&self, value: f64) -> PyResult<Condition> {
        let text = format!("({} <= {value:?})", self.text);
        Condition::new(self.quantity.below(value), text)
    }

    /// True while its magnitude is at or above `value`, which must be above zero.
    fn beyond(&self, value: f64) -> PyResult<Condition> {
        let text = format!("{}.beyond({value:?})", self.text);
        Condition::new(self.quantity.beyond(value), text)
    }

    fn __richcmp__(&self, py: Python<'_>, other: f64, compare: CompareOp) -> PyResult<Py<PyAny>> {
        let condition = match compare {
            CompareOp::Lt | CompareOp::Le => self.below(other)?,
            CompareOp::Gt | CompareOp::Ge => self.above(other)?,
            CompareOp::Eq | CompareOp::Ne => return Ok(py.NotImplemented()),
        };
        Ok(Py::new(py, condition)?.into_any())
    }

    fn __repr__(&self) -> &str {
        &self.text
    }
}

macro_rules! comparisons {
    ($($(#[$doc:meta])* $name:ident($argument:ident: $type:ty);)*) => {$(
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = ($argument, /))]
        pub(crate) fn $name($argument: $type) -> PyResult<Condition> {
            let text = format!(concat!(stringify!($name), "({:?})"), $argument);
            Condition::new(condition::$name($argument), text)
        }
    )*};
}

comparisons! {
    /// True while the external force along x is at or beyond `newtons`, in either direction.
    force_x(newtons: f64);
    /// True while the external force along y is at or beyond `newtons`, in either direction.
    force_y(newtons: f64);
    /// True while the external force along z is at or beyond `newtons`, in either direction.
    force_z(newtons: f64);
    /// True while the external force in any direction is at or beyond `newtons`.
    force(newtons: f64);
    /// True while the external torque at the end effector about any axis is at or beyond
    /// `newton_metres`.
    torque(newton_metres: f64);
    /// True while the external torque of any joint is at or beyond `newton_metres`.
    joint_torques(newton_metres: f64);
    /// True while the robot reports a contact of this joint, 1 to 7.
    joint_contact(joint: u8);
}

/// True from `seconds` after the beginning of the motion on, by the robot's clock.
#[pyfunction]
#[pyo3(signature = (seconds, /))]
pub(crate) fn elapsed(seconds: f64) -> PyResult<Condition> {
    let time = self::seconds("seconds", seconds)?;
    Condition::new(condition::elapsed(time), format!("elapsed({seconds:?})"))
}

/// True while the robot reports any contact, of a joint or at the end effector.
#[pyfunction]
pub(crate) fn contact() -> PyResult<Condition> {
    Condition::new(condition::contact(), "contact()".into())
}

/// True while the robot reports a contact at the end effector.
#[pyfunction]
pub(crate) fn cartesian_contact() -> PyResult<Condition> {
    Condition::new(condition::cartesian_contact(), "cartesian_contact()".into())
}

/// True while the robot reports any collision.
#[pyfunction]
pub(crate) fn collision() -> PyResult<Condition> {
    Condition::new(condition::collision(), "collision()".into())
}

macro_rules! joint_quantities {
    ($($(#[$doc:meta])* $name:ident: $variant:ident;)*) => {$(
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = (joint, /))]
        pub(crate) fn $name(joint: u8) -> Quantity {
            let text = format!(concat!(stringify!($name), "({})"), joint);
            Quantity { quantity: condition::Quantity::$variant(joint), text }
        }
    )*};
}

joint_quantities! {
    /// External torque of a joint, 1 to 7, N m.
    joint_torque: JointTorque;
    /// Measured position of a joint, 1 to 7, rad.
    joint_position: JointPosition;
    /// Measured velocity of a joint, 1 to 7, rad/s.
    joint_velocity: JointVelocity;
}

/// Returns the Python name of a quantity: `FORCE_Z`, `joint_torque(3)`.
fn name(quantity: condition::Quantity) -> String {
    use condition::Quantity as Q;
    let known = named().find(|(_, known)| *known == quantity);
    match (known, quantity) {
        (Some((name, _)), _) => name,
        (None, Q::JointTorque(joint)) => format!("joint_torque({joint})"),
        (None, Q::JointPosition(joint)) => format!("joint_position({joint})"),
        (None, Q::JointVelocity(joint)) => format!("joint_velocity({joint})"),
        (None, quantity) => format!("{quantity:?}"),
    }
}

/// Returns the quantities with their own names.
fn named() -> impl Iterator<Item = (String, condition::Quantity)> {
    use condition::Quantity as Q;
    let axes = [("X", Axis::X), ("Y", Axis::Y), ("Z", Axis::Z)];
    type OfAxis = fn(Axis) -> Q;
    let along: [(&str, OfAxis); 5] = [
        ("FORCE", Q::Force),
        ("TORQUE", Q::Torque),
        ("POSITION", Q::Position),
        ("VELOCITY", Q::Velocity),
        ("ANGULAR_VELOCITY", Q::AngularVelocity),
    ];
    let plain = [
        ("FORCE_NORM", Q::ForceNorm),
        ("TORQUE_NORM", Q::TorqueNorm),
        ("LARGEST_JOINT_TORQUE", Q::LargestJointTorque),
        ("SPEED", Q::Speed),
        ("ANGULAR_SPEED", Q::AngularSpeed),
    ];
    let named = along.into_iter().flat_map(move |(name, quantity)| {
        axes.map(|(letter, axis)| (format!("{name}_{letter}"), quantity(axis)))
    });
    named.chain(plain.map(|(name, quantity)| (name.to_owned(), quantity)))
}

/// Adds the quantities with their own names to the module.
pub(crate) fn add_quantities(module: &Bound<'_, PyModule>) -> PyResult<()> {
    for (text, quantity) in named() {
        module.add(text.clone().as_str(), Quantity { quantity, text })?;
    }
    Ok(())
}
