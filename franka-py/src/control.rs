//! Names of command kinds and of the robot's controllers.

use franka_async::control::MoveControllerMode;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The kind of command in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CommandKind {
    Torques,
    JointPositions,
    JointVelocities,
    CartesianPose,
    CartesianVelocities,
}

impl CommandKind {
    const ALL: [Self; 5] = [
        Self::Torques,
        Self::JointPositions,
        Self::JointVelocities,
        Self::CartesianPose,
        Self::CartesianVelocities,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Torques => "torques",
            Self::JointPositions => "joint_positions",
            Self::JointVelocities => "joint_velocities",
            Self::CartesianPose => "cartesian_pose",
            Self::CartesianVelocities => "cartesian_velocities",
        }
    }

    /// # Errors
    /// `ValueError` with all names.
    pub(crate) fn of(name: &str) -> PyResult<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|kind| kind.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join("', '");
            PyValueError::new_err(format!("command is {name:?}, expected one of '{names}'"))
        })
    }
}

/// Returns the robot's controller with this name.
///
/// # Errors
/// `ValueError` with all names.
pub(crate) fn controller(name: &str) -> PyResult<MoveControllerMode> {
    Ok(match name {
        "joint_impedance" => MoveControllerMode::JointImpedance,
        "cartesian_impedance" => MoveControllerMode::CartesianImpedance,
        "external_controller" => MoveControllerMode::ExternalController,
        _ => {
            let text = format!(
                "controller is {name:?}, expected 'joint_impedance', 'cartesian_impedance' or \
                 'external_controller'"
            );
            return Err(PyValueError::new_err(text));
        }
    })
}
