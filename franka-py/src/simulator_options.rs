//! The keyword arguments that describe a simulated robot.

use std::net::SocketAddr;
use std::time::Duration;

use franka_async::model::limits::JointLimits;
use franka_async::model::{JointVector, Load, RobotKind};
use franka_sim::arm::{Arm, Family, StateGeometry, SystemLimits};
use franka_sim::network::{Conditions, Loss, Network, Stalls};
use franka_sim::{Fingers, Suction, Tool};
use pyo3::exceptions::{PyAttributeError, PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{pose, vector};
use crate::model::arguments;
use crate::operation::seconds;
use crate::options::Keywords;

/// Returns the robot described by the keyword arguments.
pub(crate) fn configured(
    kind: RobotKind,
    keywords: &mut Keywords<'_>,
) -> PyResult<franka_sim::Sim> {
    let mut sim = match kind {
        RobotKind::Fer => franka_sim::Sim::fer(),
        _ => franka_sim::Sim::fr3(),
    };
    let mut arm = arm(kind, keywords)?;
    if let Some(limits) = keywords.value::<String>("limits")? {
        arm.limits = self::limits(kind, &limits)?;
    }
    let limits = arm.limits.joints(kind);
    let seed = keywords.take("seed")?;
    let seed = seed.map(|seed| self::seed("seed", &seed)).transpose()?;
    if let Some(name) = keywords.value::<String>("state_geometry")? {
        arm.body.state_geometry = state_geometry(&name, seed.unwrap_or_default())?;
    }
    if let Some(name) = keywords.value::<String>("kinematic_error")? {
        let other = with_kinematic_error(kind, &name, seed.unwrap_or_default())?;
        arm.body.kinematic_error = other.body.kinematic_error;
    }
    sim = sim.arm(arm);
    let q = keywords.take("q")?;
    let q = q.map(|q| positions(limits, &q)).transpose()?;
    let load = keywords
        .take("load")?
        .map(|load| self::load(&load))
        .transpose()?;
    let enforce_limits: Option<bool> = keywords.value("enforce_limits")?;
    sim = sim.configure(|config| {
        config.seed = seed.unwrap_or(config.seed);
        config.q = q.unwrap_or(config.q);
        config.payload = load.unwrap_or(config.payload);
        config.enforce_limits = enforce_limits.unwrap_or(config.enforce_limits);
    });
    let address = keywords.value::<String>("address")?;
    let address = address.map(|text| self::address(&text)).transpose()?;
    if let Some(address) = address {
        sim = sim.bind(address);
    }
    // The ports follow the robot's as on a real one; with a free port they are free too.
    let gripper_port = |place: u16| match address.map_or(0, |address| address.port()) {
        0 => 0,
        port => port.checked_add(place).unwrap_or(0),
    };
    if keywords.value("hand")?.unwrap_or(false) {
        let port = gripper_port(1);
        sim = sim.tool(Tool::hand()).hand(Fingers::new(), port);
    }
    if let Some(tool) = keywords.take("tool")? {
        sim = sim.tool(self::tool(&tool)?);
    }
    if keywords.value("vacuum_gripper")?.unwrap_or(false) {
        sim = sim.vacuum_gripper(Suction::new(), gripper_port(2));
    }
    let patience: Option<f64> = keywords.value("patience")?;
    let patience = patience.map(|patience| seconds("patience", patience));
    let patience = patience.transpose()?;
    if keywords.value("virtual_time")?.unwrap_or(false) {
        sim = sim.virtual_time(patience.unwrap_or(PATIENCE));
    } else if let Some(patience) = patience {
        sim = sim.wait_for_commands(patience);
    }
    if let Some(network) = keywords.take("network")? {
        sim = sim.network(self::network(&network)?);
    }
    Ok(sim)
}

/// Reads joint positions within the ranges of a robot with these limits.
///
/// # Errors
/// The errors of [`vector`], and `ValueError` outside the ranges of the joints.
pub(crate) fn positions(limits: &JointLimits, q: &Bound<'_, PyAny>) -> PyResult<JointVector> {
    let q = JointVector::from(vector::<7>("q", q)?);
    match limits.outside_hard(&q) {
        None => Ok(q),
        Some(i) => Err(PyValueError::new_err(format!(
            "joint {} of q is {} rad, expected {} to {}",
            i + 1,
            q[i],
            limits.hard_lower[i],
            limits.hard_upper[i]
        ))),
    }
}

/// Reads a seed from the argument `name`.
fn seed(name: &str, seed: &Bound<'_, PyAny>) -> PyResult<u64> {
    seed.extract().map_err(|error: PyErr| {
        let text = format!("{name} is {seed}, expected an integer from 0 to 2^64 - 1");
        match error.is_instance_of::<PyOverflowError>(seed.py()) {
            true => PyValueError::new_err(text),
            false => PyTypeError::new_err(text),
        }
    })
}

/// Reads the address to listen on.
fn address(text: &str) -> PyResult<SocketAddr> {
    text.parse().map_err(|_| {
        let text = format!("address is {text:?}, expected an IP address and a port");
        PyValueError::new_err(text)
    })
}

/// Returns the arm selected by `arm`, `arm_seed` and `ideal`.
fn arm(kind: RobotKind, keywords: &mut Keywords<'_>) -> PyResult<Arm> {
    let arm: Option<String> = keywords.value("arm")?;
    let seed = keywords.take("arm_seed")?;
    let seed = seed.map(|seed| self::seed("arm_seed", &seed)).transpose()?;
    let is_ideal = keywords.value("ideal")?.unwrap_or(false);
    let name = match arm.as_deref() {
        Some(name) if is_ideal && name != "ideal" => {
            let text = format!("got arm={name:?} and ideal=True, expected one of them");
            return Err(PyValueError::new_err(text));
        }
        _ if is_ideal => "ideal",
        name => name.unwrap_or("realistic"),
    };
    let family = match name {
        "ideal" if seed.is_none() => return Ok(Arm::ideal(kind)),
        "nominal" => Family::nominal(),
        "realistic" => Family::realistic(),
        "bad" => Family::bad(),
        _ => {
            let expected = "'ideal' (without arm_seed), 'nominal', 'realistic' or 'bad'";
            let text = format!("arm is {name:?}, expected {expected}");
            return Err(PyValueError::new_err(text));
        }
    };
    Ok(match seed {
        Some(seed) => Arm::sample(kind, seed, &family),
        None => Arm::central(kind, &family),
    })
}

/// Reads the system with the robot's joint limits.
fn limits(kind: RobotKind, name: &str) -> PyResult<SystemLimits> {
    match (kind, name) {
        (RobotKind::Fr3, "5.9") => Ok(SystemLimits::From5_9),
        (RobotKind::Fr3, "before-5.9") => Ok(SystemLimits::Before5_9),
        _ => {
            let expected = "'5.9' or 'before-5.9', of an FR3";
            let text = format!("limits is {name:?}, expected {expected}");
            Err(PyValueError::new_err(text))
        }
    }
}

/// Reads the geometry of the robot's own poses; `random` is drawn by `seed`.
fn state_geometry(name: &str, seed: u64) -> PyResult<StateGeometry> {
    match name {
        "described" => Ok(StateGeometry::DESCRIBED),
        "recorded" => Ok(StateGeometry::RECORDED_FR3),
        "random" => Ok(StateGeometry::random(seed)),
        _ => {
            let expected = "'described', 'recorded' or 'random'";
            let text = format!("state_geometry is {name:?}, expected {expected}");
            Err(PyValueError::new_err(text))
        }
    }
}

/// Returns an arm whose true links have the named errors; `random` is drawn by `seed`.
fn with_kinematic_error(kind: RobotKind, name: &str, seed: u64) -> PyResult<Arm> {
    match name {
        "none" => Ok(Arm::ideal(kind)),
        "random" => Ok(Arm::sample(kind, seed, &Family::realistic())),
        _ => {
            let text = format!("kinematic_error is {name:?}, expected 'none' or 'random'");
            Err(PyValueError::new_err(text))
        }
    }
}

/// Reads a load: a tuple of mass, kg, and centre of mass in the flange frame, m; or with its
/// inertia.
fn load(load: &Bound<'_, PyAny>) -> PyResult<Load> {
    let (mass, center, inertia) = match load.extract::<(f64, Bound<'_, PyAny>)>() {
        Ok((mass, center)) => (mass, center, None),
        Err(_) => {
            let (mass, center, inertia): (f64, Bound<'_, PyAny>, Bound<'_, PyAny>) =
                load.extract()?;
            (mass, center, Some(inertia))
        }
    };
    arguments::load(inertia.as_ref(), mass, Some(&center))
}

/// Reads a tool: `hand`, or a tuple of its frame on the flange, its mass and its centre of mass.
fn tool(tool: &Bound<'_, PyAny>) -> PyResult<Tool> {
    if let Ok(name) = tool.extract::<String>() {
        if name == "hand" {
            return Ok(Tool::hand());
        }
        let text = format!("tool is {name:?}, expected 'hand' or a tuple (frame, mass, center)");
        return Err(PyValueError::new_err(text));
    }
    let (frame, mass, center): (Bound<'_, PyAny>, f64, Bound<'_, PyAny>) = tool.extract()?;
    Ok(Tool {
        f_t_ne: pose("the frame of tool", &frame)?.to_homogeneous(),
        load: arguments::load(None, mass, Some(&center))?,
        has_hand_shape: false,
    })
}

/// Returns the field `name` of a `franka_async.Network`.
fn field<'py, T>(network: &Bound<'py, PyAny>, name: &str, expected: &str) -> PyResult<T>
where
    T: for<'a> FromPyObject<'a, 'py>,
{
    let value = network.getattr(name).map_err(|error| {
        if error.is_instance_of::<PyAttributeError>(network.py()) {
            PyTypeError::new_err(format!("network is {network:?}, expected a Network"))
        } else {
            error
        }
    })?;
    value.extract().map_err(|_| {
        PyTypeError::new_err(format!(
            "{name} of network is {value:?}, expected {expected}"
        ))
    })
}

/// Reads a `franka_async.Network`.
fn network(network: &Bound<'_, PyAny>) -> PyResult<Network> {
    let number = |name| field::<f64>(network, name, "a number");
    let (loss, duplication) = (number("loss")?, number("duplication")?);
    let (delay, jitter) = (number("delay")?, number("jitter")?);
    let stalls: bool = field(network, "stalls", "True or False")?;
    let cuts = "pairs of seconds, from and to, such as [(1.0, 1.1)]";
    let cuts: Vec<(f64, f64)> = field(network, "cuts", cuts)?;
    let seed = self::seed("seed of network", &field(network, "seed", "an integer")?)?;
    for (name, share) in [("loss", loss), ("duplication", duplication)] {
        if !(0.0..=1.0).contains(&share) {
            let text = format!("{name} is {share}, expected a share from 0 to 1");
            return Err(PyValueError::new_err(text));
        }
    }
    let conditions = Conditions {
        loss: Loss::Independent(loss),
        delay: seconds("delay", delay)?,
        jitter: seconds("jitter", jitter)?,
        duplication,
        ..Conditions::default()
    };
    let to_client = Conditions {
        stalls: stalls.then_some(Stalls::FER),
        ..conditions
    };
    let mut network = Network::new(seed, to_client, conditions);
    for (from, to) in cuts {
        let time = seconds("a cut", from)?..seconds("a cut", to)?;
        network.to_client.cut(time.clone());
        network.to_robot.cut(time);
    }
    Ok(network)
}

/// Time for which a simulated robot in virtual time waits for a command.
const PATIENCE: Duration = Duration::from_millis(500);
