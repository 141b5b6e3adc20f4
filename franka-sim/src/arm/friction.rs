//! Parameters of joint friction. `plant::drive::friction` computes the torque from them.

use franka_model::{JointVector, RobotKind, joint_vector};

/// Friction of the joints that opposes a torque command. The part of a motor's friction that the
/// control box compensates is not included.
///
/// With a [`Bristle`], a joint sticks. Without one, the torque at velocity `v` is
/// `kinetic · tanh(v / stribeck_speed) + viscous · v`, which has no stiction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Torque at which a joint at rest breaks away, `[N·m]`. It has no effect without a bristle.
    ///
    /// Sources: breakaway ramps of one Panda (franka_emulator, 2021) and of another (ETH PdZ
    /// thesis, 2023-24). The values are 0.83 to 1.6 on joints 1 to 5. On joints 6 and 7 they are
    /// 0.4 to 0.9. A recorded Franka Research 3 (aiofranka) has less friction in motion on joints 3
    /// and 5, and more on joint 1.
    pub static_torque: JointVector,
    /// Friction torque of a joint that slides fast, `[N·m]`. Sources: ETH PdZ, a ratio of static to
    /// kinetic friction of 1 to 1.5; NNFM, a ratio of 2 on joint 7 of a Panda or Research 3.
    pub kinetic_torque: JointVector,
    /// Speed at which friction has fallen from static to kinetic by 63 %, `[rad/s]`. The fall is
    /// Gaussian. Without a bristle: the speed at which friction has reached 76 %. Sources: ETH PdZ,
    /// joint 7, 0.049; NNFM, joint 7, 0.40 N·m at 0.005 rad/s, 0.31 at 0.035, 0.25 at 0.11 and 0.20
    /// at 0.45, which is 0.05 to 0.15.
    pub stribeck_speed: JointVector,
    /// Viscous friction, `[N·m·s/rad]`. Sources: ETH PdZ, 0 to 1.2; Gaz et al., 0 to 0.17; a
    /// recorded Franka Research 3, up to 1.1 on joint 1.
    ///
    /// In the recorded experiment with soft springs, joints 1, 3 and 4 swing as with more friction.
    pub viscous: JointVector,
    /// Elasticity before a joint slides; `None` for smooth friction.
    pub bristle: Option<Bristle>,
    /// Share of the friction that is on the link's side of the torque sensor, 0 to 1. Only this
    /// share appears in `tau_J` and in the external estimate. Source: the friction at the sensor
    /// (Gaz et al. 2019) is 0.25 to 0.5 of the breakaway torque command.
    pub link_share: JointVector,
}

/// Elastic bristles that represent the contact of two rough surfaces: the elasto-plastic LuGre
/// model (Dupont, Hayward, Armstrong and Altpeter, "Single state elasto-plastic friction models",
/// IEEE TAC 2002).
///
/// Bristles yield only at the full torque of the Stribeck curve. Below this torque, a joint moves
/// only as the bristles bend, even under vibration. The original LuGre model drifts under
/// vibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristle {
    /// Stiffness of the bristles, `[N·m/rad]`. Sources: slow reversals in two logs, 800 to 20 000;
    /// joint 7 is the stiffest. With
    /// 1000 to 4000, the drift at the start of a session is 0.13 to 0.23 mm, as franka-rs measured
    /// on two FERs.
    pub stiffness: JointVector,
    /// Damping of the bristles, `[N·m·s/rad]`. With the chosen values, a stuck joint stops within
    /// milliseconds.
    pub damping: JointVector,
}

impl Friction {
    /// No friction.
    pub const NONE: Self = Self {
        static_torque: joint_vector([0.0; 7]),
        kinetic_torque: joint_vector([0.0; 7]),
        stribeck_speed: joint_vector([1.0; 7]),
        viscous: joint_vector([0.0; 7]),
        bristle: None,
        link_share: joint_vector([0.0; 7]),
    };

    /// Smooth friction on the motors' side, after the control box has compensated 95 % of it.
    ///
    /// Coulomb and viscous values: `mujoco_menagerie`, `franka_fr3` (Coulomb for both kinds) and
    /// `franka_emika_panda` (viscous, FER). Smoothing and compensation are choices of this
    /// simulator.
    pub fn smooth(kind: RobotKind) -> Self {
        let coulomb = JointVector::from([1.137, 1.137, 1.137, 1.137, 0.763, 0.44, 0.248]);
        let viscous = if kind == RobotKind::Fer { 1.0 } else { 0.21 };
        let left = 1.0 - 0.95;
        Self {
            static_torque: coulomb * left,
            kinetic_torque: coulomb * left,
            stribeck_speed: JointVector::repeat(0.02),
            viscous: JointVector::repeat(viscous * left),
            ..Self::NONE
        }
    }
}
