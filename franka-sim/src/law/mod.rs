//! The robot's own controllers.
//!
//! A controller computes a [`Law`] once per millisecond. Within the millisecond, the spring and
//! damper of the law act on the arm at every step of the plant, like a robot's joint loops. This
//! rate keeps every stiffness stable. The stiffest case is 14 250 N·m/rad on 0.074 kg·m². It
//! oscillates at 70 Hz.

mod cartesian_impedance;
mod joint_impedance;

pub(crate) use cartesian_impedance::{Firmness, POSTURE_STIFFNESS, cartesian_impedance};
pub(crate) use joint_impedance::joint_impedance;

use franka_model::{JointVector, MassMatrix};

/// Joint torques as a function of the arm's state, gravity excluded.
#[derive(Debug, Clone)]
pub(crate) struct Law {
    /// Torques that do not depend on the arm's state, `[N·m]`.
    pub(crate) feedforward: JointVector,
    pub(crate) spring: Option<Spring>,
}

/// A spring and damper towards a moving point in joint space.
#[derive(Debug, Clone)]
pub(crate) struct Spring {
    /// Stiffness, `[N·m/rad]`.
    pub(crate) stiffness: MassMatrix,
    /// Damping, `[N·m·s/rad]`.
    pub(crate) damping: MassMatrix,
    /// Position of the point, `[rad]`.
    pub(crate) q: JointVector,
    /// Velocity of the point, `[rad/s]`.
    pub(crate) dq: JointVector,
}

impl Law {
    /// Returns the law with the same torques for every state of the arm.
    pub(crate) fn constant(torque: JointVector) -> Self {
        Self {
            feedforward: torque,
            spring: None,
        }
    }

    /// Torques at a state of the arm, `[N·m]`.
    pub(crate) fn torque(&self, q: &JointVector, dq: &JointVector) -> JointVector {
        match &self.spring {
            None => self.feedforward,
            Some(spring) => {
                self.feedforward
                    + spring.stiffness * (spring.q - q)
                    + spring.damping * (spring.dq - dq)
            }
        }
    }
}
