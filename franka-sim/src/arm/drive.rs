//! The drives: rotors, gears and torque loops.

use franka_model::{JointVector, RobotKind, joint_vector};

/// Parameters of the drives, which turn commanded torques into torques on the links.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Rotor inertia at each joint without torque control, `[kg·m²]`. Source: the README of Drake's
    /// FR3 model, "given by Franka".
    pub rotor_inertia: JointVector,
    /// Gain of the inner loop that makes the torque between gear and link follow the command. The
    /// apparent rotor inertia is `rotor_inertia / (1 + gain)`. Sources: with a gain of 2, the
    /// wrist's 0.2055 appears as the 0.074 of franka-rs and `mujoco_menagerie`; fits to a recorded
    /// Franka Research 3 give 1.3 (joint 4) to more than 4 (wrist).
    pub torque_loop_gain: f64,
    /// Time constant of the first-order lag with which the torque follows a command of the torque
    /// interface, `[s]`. No source is known. A force bandwidth of 10 Hz, and the gains that are
    /// stable on real arms, bound the value.
    pub torque_lag: f64,
    /// Number of cycles between a state and the cycle in which the answer to this state takes
    /// effect, at least 1. The protocol prescribes 1.
    pub command_delay: u32,
    /// Elasticity between gear and link; `None` for rigid joints.
    pub elasticity: Option<Elasticity>,
    /// Torque ripple of the gears.
    pub ripple: Ripple,
    /// Torque on the links that depends on the joint's angle.
    pub pose_torque: PoseTorque,
}

/// Springs and dampers between rotors and links.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    /// Stiffness of each spring, `[N·m/rad]`. Source: `theta − q = tau_J / K` in published states:
    /// 14250 (joints 1 to 4) and 9000 (joints 5 to 7) on two FERs, and 7000 in the oldest sample of
    /// the documentation.
    pub stiffness: JointVector,
    /// Damping of each damper, `[N·m·s/rad]`. The values are computed from a model with two masses.
    /// With 30 and 5, libfranka's example gains are just stable. With 30 to 40 at the wrist, the
    /// arm rings, as users report.
    pub damping: JointVector,
}

/// A torque that depends on the motor's angle: `amplitude · sin(order · angle)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// Amplitude, `[N·m]`. Sources: the log of Gaz et al. and a recorded Franka Research 3.
    ///
    /// | joint | amplitude |
    /// |---|---|
    /// | 1 | 0.1 to 0.2 |
    /// | 2 | 0.17 to 0.22 |
    /// | 3 | 0.03 to 0.09 |
    /// | 4 | 0.16 to 0.2 |
    /// | 5, 6 | 0.015 to 0.02 |
    /// | 7 | 0.003 |
    pub amplitude: JointVector,
    /// Periods per turn of the joint. Source: the logs of `amplitude`, 239.5 to 243 and 160.
    pub order: JointVector,
}

/// A torque that opposes the link of each joint and is missing in the robot's model, for example
/// the torque of cables: `sine · sin(angle) + cosine · cos(angle)`.
///
/// Source: the log of Gaz et al., in which such a term, with an amplitude of 0.26 N·m, explains a
/// part of joint 4's torque. The unexplained part falls from 0.23 to 0.14 N·m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseTorque {
    /// Coefficient of the sine, `[N·m]`.
    pub sine: JointVector,
    /// Coefficient of the cosine, `[N·m]`.
    pub cosine: JointVector,
}

/// Rotor inertia of a Franka Research 3 under its torque loop, `[kg·m²]`.
///
/// Source: `mujoco_menagerie`, `franka_fr3`. Joint 7 needs rotor inertia, because its link alone
/// has 1.2e-4 kg·m². Without a rotor, a torque client with a damping above 0.24 N·m·s/rad would be
/// unstable at 1 kHz.
const IDEAL_FR3: JointVector = joint_vector([0.195, 0.195, 0.195, 0.195, 0.074, 0.074, 0.074]);

/// Rotor inertia of a Franka Emika Robot under its torque loop, `[kg·m²]`. Source:
/// `mujoco_menagerie`, `franka_emika_panda`.
const IDEAL_FER: JointVector = joint_vector([0.1; 7]);

impl Drive {
    /// Rigid joints with a perfect torque loop.
    pub fn ideal(kind: RobotKind) -> Self {
        Self {
            rotor_inertia: if kind == RobotKind::Fer {
                IDEAL_FER
            } else {
                IDEAL_FR3
            },
            torque_loop_gain: 0.0,
            torque_lag: 0.0,
            command_delay: 1,
            elasticity: None,
            ripple: Ripple::NONE,
            pose_torque: PoseTorque::NONE,
        }
    }

    /// Apparent rotor inertia at the joints, `[kg·m²]`.
    pub fn felt_inertia(&self) -> JointVector {
        self.rotor_inertia / (1.0 + self.torque_loop_gain)
    }

    /// Inertia that the drives add to the links over a step of `dt` seconds, without friction,
    /// `[kg·m²]`.
    #[cfg(feature = "mujoco")]
    pub(crate) fn link_inertia(&self, dt: f64) -> JointVector {
        let felt = self.felt_inertia();
        let Some(elasticity) = &self.elasticity else {
            return felt;
        };
        let spring = (elasticity.damping + elasticity.stiffness * dt) * dt;
        felt.zip_map(&spring, |felt, spring| spring * felt / (felt + spring))
    }
}

impl PoseTorque {
    /// No torque.
    pub const NONE: Self = Self {
        sine: joint_vector([0.0; 7]),
        cosine: joint_vector([0.0; 7]),
    };

    /// Torques at these angles, `[N·m]`.
    pub(crate) fn at(&self, q: &JointVector) -> JointVector {
        self.sine.component_mul(&q.map(f64::sin)) + self.cosine.component_mul(&q.map(f64::cos))
    }
}

impl Ripple {
    /// No ripple.
    pub const NONE: Self = Self {
        amplitude: joint_vector([0.0; 7]),
        order: joint_vector([0.0; 7]),
    };
}
