//! Settings of the robot: requests with one answer, between motions.

use franka_async::settings::{CollisionBehavior, Filters, Load};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{self, Numbers, array, columns, unexpected_shape, vector};
use crate::device::at_least_zero;
use crate::operation::Operation;
use crate::robot::Robot;

#[pymethods]
impl Robot {
    /// Sets the torques and forces at which the robot reports contact (lower) and stops itself
    /// (upper).
    ///
    /// Either one of the names `careful` (10 N and 10 N m, for the robot's own controllers),
    /// `compliant` (60, for an arm that is pushed by hand) and `insensitive` (100, for tasks that
    /// press); or four arrays: `lower_torque_thresholds`, `upper_torque_thresholds`, `(7,)` N m,
    /// `lower_force_thresholds`, `upper_force_thresholds`, `(6,)` N and N m; or eight, each of the
    /// four twice: `..._acceleration` while the arm accelerates, and `..._nominal`, in the order of
    /// `COLLISION_THRESHOLDS`. Positional or by name. Below about 10 N the friction of an arm
    /// without contact is enough for a reflex.
    ///
    /// The vendor does not document their ranges. The simulator refuses negative values.
    ///
    /// Raises `ValueError`, `TypeError` and `CommandError`; a moving robot refuses the request.
    /// Once the request has begun, the robot can execute it even if you cancel.
    #[pyo3(signature = (*thresholds, **named))]
    fn set_collision_behavior(
        &self,
        thresholds: &Bound<'_, PyTuple>,
        named: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Operation> {
        let behavior = collision_behavior(thresholds, named)?;
        let robot = self.connected()?;
        Ok(Operation::new("Robot.set_collision_behavior", async move {
            robot.set_collision_behavior(behavior).await
        }))
    }

    /// Sets the stiffness of the robot's own joint impedance controller, `(7,)` N m/rad, each 0 to
    /// 14250. Raises and is cancelled like `set_collision_behavior`.
    fn set_joint_impedance(&self, stiffness: &Bound<'_, PyAny>) -> PyResult<Operation> {
        let stiffness = vector("stiffness", stiffness)?;
        let robot = self.connected()?;
        Ok(Operation::new("Robot.set_joint_impedance", async move {
            robot.set_joint_impedance(stiffness).await
        }))
    }

    /// Sets the stiffness of the robot's own Cartesian impedance controller in the stiffness frame,
    /// `(6,)`: x y z, 10 to 3000 N/m, and roll pitch yaw, 1 to 300 N m/rad. Raises and is cancelled
    /// like `set_collision_behavior`.
    fn set_cartesian_impedance(&self, stiffness: &Bound<'_, PyAny>) -> PyResult<Operation> {
        let stiffness = vector("stiffness", stiffness)?;
        let robot = self.connected()?;
        Ok(Operation::new(
            "Robot.set_cartesian_impedance",
            async move { robot.set_cartesian_impedance(stiffness).await },
        ))
    }

    /// Sets the free directions in hand guiding: six truth values, x y z and roll pitch yaw, and
    /// the `elbow`. Raises and is cancelled like `set_collision_behavior`.
    #[pyo3(signature = (free, elbow = true))]
    fn set_guiding_mode(&self, free: [bool; 6], elbow: bool) -> PyResult<Operation> {
        let robot = self.connected()?;
        Ok(Operation::new("Robot.set_guiding_mode", async move {
            robot.set_guiding_mode(free, elbow).await
        }))
    }

    /// Sets the stiffness frame in the end effector's, `EE_T_K`: a pose. The vendor does not
    /// document a range; the simulator refuses a distance of more than 2 m. Resolves when a state
    /// shows it. Raises and is cancelled like `set_collision_behavior`.
    #[expect(non_snake_case, reason = "the vendor's name")]
    fn set_k(&self, EE_T_K: &Bound<'_, PyAny>) -> PyResult<Operation> {
        let pose = arrays::pose("EE_T_K", EE_T_K)?;
        let robot = self.connected()?;
        Ok(Operation::new("Robot.set_k", async move {
            robot.set_k(pose).await
        }))
    }

    /// Sets the end effector in the nominal end effector's frame, `NE_T_EE`: a pose. Range and
    /// completion are as for `set_k`. Raises and is cancelled like `set_collision_behavior`.
    #[expect(non_snake_case, reason = "the vendor's name")]
    fn set_ee(&self, NE_T_EE: &Bound<'_, PyAny>) -> PyResult<Operation> {
        let pose = arrays::pose("NE_T_EE", NE_T_EE)?;
        let robot = self.connected()?;
        Ok(Operation::new("Robot.set_ee", async move {
            robot.set_ee(pose).await
        }))
    }

    /// Declares the load in addition to the end effector: `mass`, kg; `center` of mass in the
    /// flange frame, `(3,)` m; `inertia` about it, `(3, 3)` or its nine numbers, kg m^2, zero
    /// unless given.
    ///
    /// The vendor does not document a range. The simulator refuses more than 10 kg, a centre more
    /// than 1 m away, and an inertia that is not physical or has a principal moment above 1 kg m^2.
    /// Resolves when a state shows it. Raises and is cancelled like `set_collision_behavior`.
    #[pyo3(signature = (mass, center = None, inertia = None))]
    fn set_load(
        &self,
        mass: f64,
        center: Option<&Bound<'_, PyAny>>,
        inertia: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Operation> {
        let load = Load {
            m_load: at_least_zero("mass", mass)?,
            F_x_Cload: center.map_or(Ok([0.0; 3]), |center| vector("center", center))?,
            I_load: inertia.map_or(Ok([0.0; 9]), self::inertia)?,
        };
        let robot = self.connected()?;
        Ok(Operation::new("Robot.set_load", async move {
            robot.set_load(load).await
        }))
    }

    /// Sets the cutoff frequencies of the robot's own low-pass filters, each 1 to 1000 Hz; 1000
    /// disables a filter. Franka Emika Robot only, and deprecated by the vendor. Raises and is
    /// cancelled like `set_collision_behavior`; `CommandError` of the kind `request` if the robot
    /// has no such command.
    #[pyo3(signature = (
        *, joint_position = 1000.0, joint_velocity = 1000.0, cartesian_position = 1000.0,
        cartesian_velocity = 1000.0, controller = 1000.0,
    ))]
    fn set_filters(
        &self,
        joint_position: f64,
        joint_velocity: f64,
        cartesian_position: f64,
        cartesian_velocity: f64,
        controller: f64,
    ) -> PyResult<Operation> {
        let filters = Filters {
            joint_position_filter_frequency: at_least_zero("joint_position", joint_position)?,
            joint_velocity_filter_frequency: at_least_zero("joint_velocity", joint_velocity)?,
            cartesian_position_filter_frequency: at_least_zero(
                "cartesian_position",
                cartesian_position,
            )?,
            cartesian_velocity_filter_frequency: at_least_zero(
                "cartesian_velocity",
                cartesian_velocity,
            )?,
            controller_filter_frequency: at_least_zero("controller", controller)?,
        };
        let robot = self.connected()?;
        Ok(Operation::new("Robot.set_filters", async move {
            robot.set_filters(filters).await
        }))
    }

    /// Reads the virtual wall `id` from the configuration in Desk; returns a `VirtualWall`. Franka
    /// Emika Robot only. Raises `CommandError`, of the kind `request` if the robot has no such
    /// command.
    fn virtual_wall(&self, id: i32) -> PyResult<Operation> {
        let robot = self.connected()?;
        Ok(Operation::new("Robot.virtual_wall", async move {
            robot.virtual_wall(id).await.map(VirtualWall)
        }))
    }

    /// Reads the robot's description; returns URDF text. Franka Research 3 only. Raises
    /// `CommandError`, of the kind `request` if the robot has no such command.
    fn urdf(&self) -> PyResult<Operation> {
        let robot = self.connected()?;
        Ok(Operation::new(
            "Robot.urdf",
            async move { robot.urdf().await },
        ))
    }
}

/// Converted to a `franka_async.settings.VirtualWall`.
struct VirtualWall(franka_async::settings::VirtualWall);

impl<'py> IntoPyObject<'py> for VirtualWall {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Self(wall) = self;
        let class = py.import("franka_async.settings")?.getattr("VirtualWall")?;
        class.call1((
            array(py, &wall.object_world_size),
            columns::<4, 4>(py, &wall.object_frame),
            wall.object_activation,
        ))
    }
}

/// The eight arrays of a collision behavior: torques `(7,)`, then forces `(6,)`.
pub(crate) const COLLISION_THRESHOLDS: [&str; 8] = [
    "lower_torque_thresholds_acceleration",
    "upper_torque_thresholds_acceleration",
    "lower_torque_thresholds_nominal",
    "upper_torque_thresholds_nominal",
    "lower_force_thresholds_acceleration",
    "upper_force_thresholds_acceleration",
    "lower_force_thresholds_nominal",
    "upper_force_thresholds_nominal",
];

/// Thresholds that are the same for an accelerating and a non-accelerating arm.
const UNIFORM: [&str; 4] = [
    "lower_torque_thresholds",
    "upper_torque_thresholds",
    "lower_force_thresholds",
    "upper_force_thresholds",
];

fn collision_behavior(
    thresholds: &Bound<'_, PyTuple>,
    named: Option<&Bound<'_, PyDict>>,
) -> PyResult<CollisionBehavior> {
    if let [preset] = thresholds.iter().collect::<Vec<_>>().as_slice()
        && named.is_none_or(|named| named.is_empty())
    {
        return self::preset(preset);
    }
    let is_uniform = match named {
        Some(named) if !named.is_empty() => {
            let is_uniform = UNIFORM.iter().map(|name| named.contains(name));
            is_uniform.collect::<PyResult<Vec<bool>>>()?.contains(&true)
        }
        _ => thresholds.len() <= UNIFORM.len(),
    };
    if is_uniform {
        let [lower_torque, upper_torque, lower_force, upper_force] =
            arguments(&UNIFORM, thresholds, named)?;
        return Ok(CollisionBehavior::uniform(
            threshold(UNIFORM[0], &lower_torque)?,
            threshold(UNIFORM[1], &upper_torque)?,
            threshold(UNIFORM[2], &lower_force)?,
            threshold(UNIFORM[3], &upper_force)?,
        ));
    }
    let names = &COLLISION_THRESHOLDS;
    let given = arguments(names, thresholds, named)?;
    let torque = |i: usize| threshold(names[i], &given[i]);
    let force = |i: usize| threshold(names[i], &given[i]);
    Ok(CollisionBehavior {
        lower_torque_thresholds_acceleration: torque(0)?,
        upper_torque_thresholds_acceleration: torque(1)?,
        lower_torque_thresholds_nominal: torque(2)?,
        upper_torque_thresholds_nominal: torque(3)?,
        lower_force_thresholds_acceleration: force(4)?,
        upper_force_thresholds_acceleration: force(5)?,
        lower_force_thresholds_nominal: force(6)?,
        upper_force_thresholds_nominal: force(7)?,
    })
}

/// The accepted forms of thresholds.
const FORMS: &str = "expected 'careful', 'compliant' or 'insensitive'; four arrays, lower and \
                     upper torques (7,), lower and upper forces (6,); or eight, as \
                     COLLISION_THRESHOLDS names them";

/// Reads one of the arrays.
fn threshold<const N: usize>(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<[f64; N]> {
    let shape = Numbers::read(name, argument)?.shape;
    if shape != [N] {
        let text = format!("{name} has the shape {shape:?}, not ({N},): {FORMS}");
        return Err(PyValueError::new_err(text));
    }
    vector(name, argument)
}

fn preset(preset: &Bound<'_, PyAny>) -> PyResult<CollisionBehavior> {
    match preset.extract::<&str>() {
        Ok("careful") => Ok(CollisionBehavior::careful()),
        Ok("compliant") => Ok(CollisionBehavior::compliant()),
        Ok("insensitive") => Ok(CollisionBehavior::insensitive()),
        _ => {
            let got = preset.repr()?;
            Err(PyValueError::new_err(format!("got {got}, {FORMS}")))
        }
    }
}

/// Returns the arguments with these names, positional first, like a function with these parameters.
///
/// # Errors
/// `TypeError` for an argument that is missing, given twice, or unknown.
fn arguments<'py, const N: usize>(
    names: &[&str; N],
    positional: &Bound<'py, PyTuple>,
    named: Option<&Bound<'py, PyDict>>,
) -> PyResult<[Bound<'py, PyAny>; N]> {
    let mut given: [Option<Bound<'py, PyAny>>; N] = [const { None }; N];
    if positional.len() > N {
        let got = positional.len();
        return Err(PyTypeError::new_err(format!("got {got} arrays, {FORMS}")));
    }
    for (place, value) in given.iter_mut().zip(positional.iter()) {
        *place = Some(value);
    }
    for (name, value) in named.into_iter().flat_map(|named| named.iter()) {
        let name: String = name.extract()?;
        let place = names.iter().position(|known| *known == name);
        let place = place.ok_or_else(|| {
            let names = names.join(", ");
            PyTypeError::new_err(format!("got {name}, expected one of {names}"))
        })?;
        if given[place].replace(value).is_some() {
            return Err(PyTypeError::new_err(format!("got {name} twice")));
        }
    }
    if let Some(missing) = given.iter().position(Option::is_none) {
        let text = format!("{} is missing, {FORMS}", names[missing]);
        return Err(PyTypeError::new_err(text));
    }
    Ok(given.map(|given| given.expect("none is missing")))
}

/// Reads an inertia, `(3, 3)` or its nine numbers, and returns it column-major.
///
/// # Errors
/// `ValueError` for another shape, numbers that are not finite, and a matrix that is not symmetric.
pub(crate) fn inertia(argument: &Bound<'_, PyAny>) -> PyResult<[f64; 9]> {
    let Numbers { shape, values } = Numbers::read("inertia", argument)?;
    let matrix: [f64; 9] = match values.try_into() {
        Ok(matrix) if matches!(*shape, [3, 3] | [9]) => matrix,
        _ => return Err(unexpected_shape("inertia", &shape, "(3, 3) or (9,)")),
    };
    let is_symmetric = [(1, 3), (2, 6), (5, 7)]
        .iter()
        .all(|&(upper, lower)| matrix[upper] == matrix[lower]);
    if !is_symmetric || matrix.iter().any(|number| !number.is_finite()) {
        let text = format!("inertia is {matrix:?}, expected a symmetric matrix of finite numbers");
        return Err(PyValueError::new_err(text));
    }
    // Symmetric: rows are columns.
    Ok(matrix)
}
