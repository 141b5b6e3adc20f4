//! Which setting to change.

use core::fmt;

/// What to change, so that the next motion does not end likewise. Names of settings are those of this driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Advice {
    /// Commands have to go on without a leap.
    Smooth,
    /// They are too fast, although they do not leap.
    SlowDown,
    /// The first command has to be where the robot is.
    StartWhereItIs,
    /// The last command has to stand still.
    FinishAtRest,
    /// Datagrams get lost between the two computers.
    Network,
    /// This computer answers too late.
    Host,
    /// Something was touched, or seemed to be.
    Thresholds,
    /// The pose is the problem.
    AvoidSingularity,
    /// A joint is near the end of its range.
    StayInRange,
    /// The arm comes near itself.
    StayClearOfItself,
    /// The load or the motion asks for too much torque or power.
    LessEffort,
    /// The gains are too high for this pose or contact.
    SofterGains,
    /// Set in Desk, not by a client.
    Desk,
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Smooth => {
                "limit_rate(true) for the control function, or targets that go on in position, velocity and acceleration"
            }
            Self::SlowDown => "less speed and acceleration",
            Self::StartWhereItIs => {
                "begin with what the first state has: q_d, O_T_EE_c, elbow_c, and zero velocity and torque"
            }
            Self::FinishAtRest => "bring the command to rest before it says that it is finished",
            Self::Network => "a direct cable to the robot, nothing else on it, and no power saving of the network card",
            Self::Host => {
                "Realtime::Enforce, a processor of its own for the control thread, and less work in the control function"
            }
            Self::Thresholds => {
                "set_collision_behavior if the contact is meant; set_load and less acceleration if nothing was touched"
            }
            Self::AvoidSingularity => "go there by joint positions, or by another elbow",
            Self::StayInRange => "a target further inside the joint's range, or another elbow",
            Self::StayClearOfItself => "a way on which the links stay further apart",
            Self::LessEffort => "less acceleration, less load, or the load declared by set_load",
            Self::SofterGains => "lower stiffness, more damping, or cutoff_frequency for the torques",
            Self::Desk => "walls, load and tasks in Desk",
        })
    }
}
