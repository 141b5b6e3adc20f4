//! A hand that pushes an arm while the arm holds its pose: its path, and the part of its force that
//! accelerates the arm.

use franka_model::{EndEffector, JointVector, Load, Model, OperationalSpace, transform};
use franka_sim::Arm;
use nalgebra::{SMatrix, Vector3};

use franka_lockstep::Lockstep;

/// Velocity of the hand, `[m/s]`.
pub const PACE: f64 = 0.25;

/// Time in which the hand accelerates to [`PACE`], `[s]`.
pub const START: f64 = 0.1;

/// Duration of the push, `[ms]`: over 16 cm.
pub const PUSH: u64 = 700;

/// Stiffness of the hand, `[N/m]`.
pub const STIFFNESS: f64 = 5000.0;

/// The distance that the hand has moved after `t` seconds, `[m]`.
pub fn hand(t: f64) -> f64 {
    if t < START {
        let turn = core::f64::consts::PI / START;
        PACE / 2.0 * (t - (turn * t).sin() / turn)
    } else {
        PACE * (t - START / 2.0)
    }
}

/// The simulated arm's inertia, to compute the part of a push that accelerates it.
#[derive(Debug)]
pub struct ArmInertia {
    model: Model,
    load: Load,
    arm: Arm,
    ee: EndEffector,
}

impl ArmInertia {
    /// Inertia of this arm in its current state.
    pub fn of(lockstep: &Lockstep) -> Self {
        let config = lockstep.robot.config();
        let f_t_ee = transform::isometry_from_array(&lockstep.robot.state().F_T_EE);
        Self {
            model: lockstep.robot.model().clone(),
            load: config.tool.load,
            arm: config.chosen_arm(),
            ee: EndEffector {
                f_t_ee: transform::matrix(&f_t_ee.expect("a rigid frame")),
                ..EndEffector::default()
            },
        }
    }

    /// The force of a hand at the end effector that accelerates the joints by `ddq`, `[N]`.
    pub fn inertial(&self, q: &JointVector, dq: &JointVector, ddq: &JointVector) -> Vector3<f64> {
        let gravity = &self.arm.body.gravity_earth;
        let dynamics = self.model.dynamics(q, dq, &self.ee, &self.load, gravity);
        let mass = dynamics.mass + SMatrix::from_diagonal(&self.arm.drive.felt_inertia());
        let felt = OperationalSpace::new(&dynamics.jacobian, &mass).expect("positive definite");
        let acceleration = (dynamics.jacobian * ddq).xyz();
        felt.translational_inertia().expect("regular") * acceleration
    }
}
