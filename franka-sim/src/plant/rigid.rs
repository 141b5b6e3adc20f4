//! An arm of rigid links.

use franka_model::{AsBuilt, JointVector, Load, MassMatrix, RobotKind};
use nalgebra::Vector3;

use super::{External, LinkTorque, Plant};
use crate::arm::{Arm, EndStops};

/// Rigid links without surroundings.
///
/// Each step solves, for the acceleration `a`,
///
/// ```text
/// (M + inertia + slope + h·D + h²·K) a = torque + external − C dq − g − stops(q + h·dq, dq)
/// ```
///
/// `torque` and the inertia come from the drives. `external` and the slope come from external
/// torques. `D` is the damping of drives and stops, and `K` the stops' stiffness. The velocity
/// advances before the position. Stiff parts (friction at rest, end stops, springs of touches)
/// therefore follow the implicit Euler rule, and all other parts follow the symplectic rule. The
/// step stays stable for any stiffness, and a free arm keeps its energy (see the tests in
/// `plant::energy`).
#[derive(Debug)]
pub struct RigidArm {
    model: AsBuilt,
    gravity_earth: Vector3<f64>,
    stops: EndStops,
    load: Load,
    q: JointVector,
    dq: JointVector,
}

impl RigidArm {
    /// The links of `arm` at rest at `q`, `[rad]`, with `load` on the flange.
    pub fn new(kind: RobotKind, arm: &Arm, q: JointVector, load: Load) -> Self {
        Self {
            model: arm.body.as_built(kind),
            gravity_earth: arm.body.gravity_earth,
            stops: arm.body.stops,
            load,
            q,
            dq: JointVector::zeros(),
        }
    }
}

impl Plant for RigidArm {
    fn q(&self) -> &JointVector {
        &self.q
    }

    fn dq(&self) -> &JointVector {
        &self.dq
    }

    fn fit(&mut self, kind: RobotKind, arm: &Arm) {
        self.model = arm.body.as_built(kind);
        self.gravity_earth = arm.body.gravity_earth;
        self.stops = arm.body.stops;
    }

    fn step(&mut self, drive: &LinkTorque, external: &External, dt: f64) {
        let (stop, stop_slope) = self.stops.resistance(&self.q, &self.dq, dt);
        let resisting = drive.inertia + (drive.damping + stop_slope) * dt;
        let mut armature = MassMatrix::from_diagonal(&resisting);
        if let Some(slope) = &external.slope {
            armature += slope;
        }
        let ddq = self
            .model
            .forward_dynamics(
                &self.q,
                &self.dq,
                &(drive.torque + external.torque - stop),
                &self.load,
                &self.gravity_earth,
                &armature,
            )
            // If no acceleration solves the equation, the robot detects the non-finite values and
            // stops.
            .unwrap_or_else(|| JointVector::repeat(f64::NAN));
        self.dq += ddq * dt;
        self.q += self.dq * dt;
    }

    fn place(&mut self, q: &JointVector) -> JointVector {
        self.q = *q;
        self.dq = JointVector::zeros();
        self.model.gravity(q, &self.load, &self.gravity_earth)
    }

    fn attach(&mut self, load: Load) {
        self.load = load;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::{Friction, SystemLimits};
    use crate::plant::DriveTrain;
    use franka_model::{GRAVITY_EARTH, Model, READY};

    const STEP: f64 = 0.000_25;

    /// A Franka Research 3 in the ready pose.
    fn robot(arm: &Arm) -> (RigidArm, DriveTrain) {
        let mut plant = RigidArm::new(RobotKind::Fr3, arm, READY, Load::NONE);
        let holding = plant.place(&READY);
        let train = DriveTrain::new(arm, &READY, &holding);
        (plant, train)
    }

    fn gravity(arm: &RigidArm) -> JointVector {
        Model::fr3().gravity(&arm.q, &Load::NONE, &GRAVITY_EARTH)
    }

    #[test]
    fn gravity_torque_holds_the_arm_still() {
        let (mut arm, mut train) = robot(&Arm::ideal(RobotKind::Fr3));
        let none = External::NONE;
        for _ in 0..4000 {
            let hold = gravity(&arm);
            train.step(&mut arm, &hold, &none, STEP);
        }
        assert!((arm.q - READY).amax() < 1e-9);
    }

    #[test]
    fn the_sensors_read_what_accelerates_the_links() {
        let mut free = Arm::ideal(RobotKind::Fr3);
        free.friction = Friction::NONE;
        let (mut arm, mut train) = robot(&free);
        let motor = JointVector::from([5.0, -3.0, 2.0, 25.0, 0.5, 1.0, 0.1]);
        let before = arm.dq;
        let q = arm.q;
        train.step(&mut arm, &motor, &External::NONE, STEP);
        let ddq = (arm.dq - before) / STEP;
        let model = Model::fr3();
        let links = model.inverse_dynamics(&q, &before, &ddq, &Load::NONE, &GRAVITY_EARTH);
        assert!((train.torque() - links).amax() < 1e-9);
    }

    #[test]
    fn an_end_stop_holds_the_strongest_joint_without_ringing() {
        let limits = SystemLimits::default().joints(RobotKind::Fr3);
        let (mut arm, mut train) = robot(&Arm::ideal(RobotKind::Fr3));
        let mut push = JointVector::zeros();
        push[0] = 87.0;
        for _ in 0..20_000 {
            let hold = gravity(&arm);
            train.step(&mut arm, &(hold + push), &External::NONE, STEP);
        }
        assert!(arm.q[0] > limits.hard_upper[0] && arm.q[0] < limits.hard_upper[0] + 0.08);
        assert!(arm.dq[0].abs() < 1e-3, "{}", arm.dq[0]);
    }

    #[test]
    fn light_last_joint_is_stable_under_a_held_strong_damper() {
        let (mut arm, mut train) = robot(&Arm::ideal(RobotKind::Fr3));
        let kick = JointVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0]);
        train.step(&mut arm, &kick, &External::NONE, 0.01);
        for _ in 0..200 {
            let mut torque = gravity(&arm);
            torque[6] -= 15.0 * arm.dq[6];
            for _ in 0..4 {
                train.step(&mut arm, &torque, &External::NONE, STEP);
            }
        }
        assert!(arm.dq[6].abs() < 1e-3, "{}", arm.dq[6]);
    }
}
