//! What an arm has besides links: rotors, friction and end stops.

use franka_model::{JointVector, Model, RobotKind, joint_vector};
use nalgebra::Vector3;

use super::{EndStops, Friction};

/// Rotor inertia of the joints of a Franka Research 3, felt at the joint, `[kg·m²]`.
///
/// Source: `mujoco_menagerie`, `franka_fr3`. Joint 7 needs it: its link alone has 1.2e-4 kg·m²,
/// with which a torque client's damping above 0.24 N·m·s/rad is unstable at 1 kHz.
const ARMATURE_FR3: JointVector = joint_vector([0.195, 0.195, 0.195, 0.195, 0.074, 0.074, 0.074]);

/// Rotor inertia of the joints of a Franka Emika Robot, felt at the joint, `[kg·m²]`.
///
/// Source: `mujoco_menagerie`, `franka_emika_panda`.
const ARMATURE_FER: JointVector = joint_vector([0.1; 7]);

/// What a plant is made of besides the links of its [`Model`]; the same for every plant.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmParameters {
    /// Rotor inertia felt at each joint, `[kg·m²]`.
    pub armature: JointVector,
    /// Joint friction.
    pub friction: Friction,
    /// Mechanical end stops.
    pub stops: EndStops,
    /// Gravitational acceleration in the base frame, `[m/s²]`: that of the physics alone. The
    /// robot's controllers believe that the arm stands upright, and its state says so (`O_ddP_O`);
    /// with another value here they feel a load that is not there, as on an arm that is mounted
    /// at a tilt that Desk does not know of.
    pub gravity_earth: Vector3<f64>,
}

impl ArmParameters {
    /// An arm of this kind, standing upright.
    pub fn of(kind: RobotKind) -> Self {
        let kinds: [(RobotKind, fn() -> Self); 2] =
            [(RobotKind::Fr3, Self::fr3), (RobotKind::Fer, Self::fer)];
        let found = kinds.into_iter().find(|(of, _)| *of == kind);
        let (_, parameters) = found.expect("every kind has parameters");
        parameters()
    }

    /// A Franka Research 3 standing upright.
    pub fn fr3() -> Self {
        Self::upright(Model::fr3(), ARMATURE_FR3, Friction::FR3)
    }

    /// A Franka Emika Robot standing upright.
    pub fn fer() -> Self {
        Self::upright(Model::fer(), ARMATURE_FER, Friction::FER)
    }

    fn upright(model: &Model, armature: JointVector, friction: Friction) -> Self {
        let limits = model.joint_limits();
        Self {
            armature,
            friction,
            stops: EndStops::around(&limits.hard_lower, &limits.hard_upper),
            gravity_earth: franka_model::GRAVITY_EARTH,
        }
    }

    /// What resists a step of `dt` seconds that begins at `q`, `dq`.
    pub(super) fn resistance(&self, q: &JointVector, dq: &JointVector, dt: f64) -> Resistance {
        let (friction, friction_slope) = self.friction.at(dq);
        let mut resistance = Resistance {
            friction,
            friction_slope,
            stop: JointVector::zeros(),
            stop_slope: JointVector::zeros(),
        };
        let stops = &self.stops;
        for i in 0..7 {
            let depth = stops.depth(i, q[i] + dt * dq[i]);
            if depth != 0.0 {
                resistance.stop[i] = stops.stiffness * depth + stops.damping * dq[i];
                resistance.stop_slope[i] = stops.damping + dt * stops.stiffness;
            }
        }
        resistance
    }
}

/// Torques that depend on the motion itself, to be taken implicitly: at velocities that are `a·dt`
/// away from where they were computed, they are larger by `slope·a·dt`.
pub(super) struct Resistance {
    /// Of the joints, on the motors' side of the sensors, `[N·m]`; subtract it.
    pub(super) friction: JointVector,
    /// `[N·m·s/rad]`
    pub(super) friction_slope: JointVector,
    /// Of the end stops, on the links, `[N·m]`; subtract it.
    pub(super) stop: JointVector,
    /// `[N·m·s/rad]`
    pub(super) stop_slope: JointVector,
}

impl Resistance {
    /// What the sensors between gear and link read when motors of these torques accelerate by
    /// `ddq`: rotor and friction are on the motor's side.
    pub(super) fn sensed(
        &self,
        motor: &JointVector,
        armature: &JointVector,
        ddq: &JointVector,
        dt: f64,
    ) -> JointVector {
        motor - self.friction - (armature + self.friction_slope * dt).component_mul(ddq)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_parameters_of_its_own() {
        let [first, second] = RobotKind::ALL.map(ArmParameters::of);
        assert_ne!(first, second);
    }
}
