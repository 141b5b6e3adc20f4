//! The model of an arm, evaluated at the robot's states.

use std::sync::Arc;

use franka_model::{Dynamics, EndEffector, Load, Model, RobotKind};
use franka_proto::{RobotState, Version};

/// The model of one robot, evaluated at its states. Each state contains the joint positions and
/// velocities, and the end effector, the load and the gravity that are set on the robot. Move a
/// copy into a control function: no method here allocates or waits.
///
/// ```no_run
/// # use franka_async::control::Torques;
/// # use franka_async::model::JointVector;
/// # use franka_async::{MotionError, Robot};
/// # async fn run(robot: Robot) -> Result<(), MotionError> {
/// let model = robot.state_model();
/// let held = JointVector::from(robot.state().q);
/// let springs = robot.control_torques(move |state, _| {
///     let terms = model.dynamics(state); // pose, Jacobian, mass, coriolis, gravity
///     let away = held - JointVector::from(state.q);
///     let torques = away * 50.0 - JointVector::from(state.dq) * 10.0 + terms.coriolis;
///     Torques(torques.into())
/// });
/// springs.limit_rate(true).await?; // until it is dropped
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct StateModel {
    model: Arc<Model>,
    version: Version,
}

impl StateModel {
    pub(crate) fn new(model: Arc<Model>, version: Version) -> Self {
        Self { model, version }
    }

    /// Returns a model with the nominal constants of the robot kind that uses protocol `version`.
    /// Use it to test control laws without a robot. For a connected robot, use
    /// [`Robot::state_model`](crate::Robot::state_model).
    pub fn nominal(version: Version) -> Self {
        Self::new(Arc::new(nominal(version)), version)
    }

    /// Computes the pose and the Jacobian of the end effector, the mass matrix, and the Coriolis
    /// and gravity torques, in one pass over the arm.
    pub fn dynamics(&self, state: &RobotState) -> Dynamics {
        self.model.dynamics(
            &state.q.into(),
            &state.dq.into(),
            &self.end_effector(state),
            &self.load(state),
            &state.O_ddP_O.into(),
        )
    }

    /// Returns the end effector and the stiffness frame, for the methods of [`Model`] that need
    /// them.
    pub fn end_effector(&self, state: &RobotState) -> EndEffector {
        EndEffector::from_arrays(&state.F_T_EE, &state.EE_T_K)
    }

    /// Returns the end effector and the payload as one load, for the methods of [`Model`] that need
    /// it.
    pub fn load(&self, state: &RobotState) -> Load {
        let load = state.total_load(self.version);
        Load::from_arrays(load.m_total, &load.F_x_Ctotal, &load.I_total)
    }

    /// Returns the model behind this value.
    pub fn model(&self) -> &Model {
        &self.model
    }
}

/// Returns the constants of the kind of robot that uses `version`; every version belongs to one
/// kind.
pub(crate) fn nominal(version: Version) -> Model {
    let kind = match version {
        Version::V5 => RobotKind::Fer,
        Version::V10 => RobotKind::Fr3,
    };
    Model::of(kind).clone()
}

#[cfg(test)]
mod tests {
    use franka_model::READY;

    use super::*;

    /// In both protocols, 2 kg of payload and 1 kg of end effector weigh as much as 3 kg, for any
    /// direction of gravity in the state.
    #[test]
    fn gravity_of_a_state_includes_payload_and_end_effector() {
        let state = RobotState {
            q: READY.into(),
            m_ee: 1.0,
            m_load: 2.0,
            F_x_Cee: [0.0, 0.0, 0.03],
            F_x_Cload: [0.0, 0.0, 0.06],
            O_ddP_O: [0.0, 3.0, -9.0],
            ..RobotState::default()
        };
        let weight = Load::from_arrays(3.0, &[0.0, 0.0, 0.05], &[0.0; 9]);
        for version in Version::ALL {
            let model = StateModel::new(Arc::new(Model::fr3().clone()), version);
            let gravity = model.dynamics(&state).gravity;
            let expected = Model::fr3().gravity(&READY, &weight, &[0.0, 3.0, -9.0].into());
            assert!(
                (gravity - expected).amax() < 1e-12,
                "{version:?}: {gravity}"
            );
        }
    }
}
