//! Recommended changes to settings and programs.

use franka_rt::driver::Commander;

/// A recommended change that should prevent the next motion from ending for the same reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Advice {
    /// Send motion commands that continue without a jump.
    Smooth,
    /// Send torque commands that continue without a step.
    SmoothTorques,
    /// Move more slowly: the commands are too fast, although they do not jump.
    SlowDown,
    /// Send a first command that matches the robot's position.
    StartWhereItIs,
    /// Send a last command that is at rest.
    FinishAtRest,
    /// Check the network: it loses datagrams between the robot and this computer.
    Network,
    /// Check this computer: it replies too late.
    Host,
    /// Check the contact and collision thresholds: a contact occurred, or appeared to occur.
    Thresholds,
    /// Yield to contacts: the contact exceeded the force against which the joints can hold.
    GiveWay,
    /// Avoid poses close to a singularity.
    AvoidSingularity,
    /// Stay away from the ends of the joint ranges.
    StayInRange,
    /// Keep the links of the arm away from each other.
    StayClearOfItself,
    /// Reduce the load or the motion: they require too much torque or power.
    LessEffort,
    /// Reduce the gains: they are too high for this pose or contact.
    SofterGains,
    /// Check a setting in Desk. A client cannot change it.
    Desk,
}

impl Advice {
    /// Returns the advice as text. The text names the settings of this driver that apply to
    /// `commander`, the source of the commands.
    pub fn text(self, commander: Commander) -> &'static str {
        use Commander::{Active, Asynchronous, Function, Goals};
        match (self, commander) {
            (Self::Smooth, Function) => {
                "commands continuous in position, velocity and acceleration; limit_rate(true) smooths small steps of joints, not of poses"
            }
            (Self::Smooth, Active) => {
                "commands continuous in position, velocity and acceleration: the driver does not limit them here"
            }
            (Self::SmoothTorques, Function) => {
                "torques that start and end at zero and have no steps; limit_rate(true) turns steps into ramps"
            }
            (Self::SmoothTorques, Active) => {
                "torques that start and end at zero and have no steps: the driver does not limit them here"
            }
            (Self::Smooth | Self::SmoothTorques | Self::SlowDown, Goals) => {
                "speed below 1, limits with less velocity and acceleration, or softer gains"
            }
            (Self::Smooth | Self::SmoothTorques | Self::SlowDown, Asynchronous) => {
                "lower maximum_joint_velocities"
            }
            (Self::SlowDown, Function | Active) => {
                "less speed and acceleration; in a torque law, smaller torques or more damping"
            }
            (Self::StartWhereItIs, Function | Active) => {
                "start from the first state: q_d, O_T_EE_c, elbow_c, zero velocity and zero torque"
            }
            (Self::StartWhereItIs, Goals | Asynchronous) => {
                "start when the arm rests and nothing pushes it"
            }
            (Self::FinishAtRest, Function | Active) => {
                "bring the command, and the arm that your torques move, to rest before the last command"
            }
            (Self::FinishAtRest, Goals | Asynchronous) => {
                "end the motion when the arm rests and nothing pushes it"
            }
            (Self::Network, _) => {
                "a direct cable to the robot without other traffic, and no power saving of the network card"
            }
            (Self::Host, Function) => {
                "less work in the control function, Realtime::Enforce, and a dedicated processor for the control thread"
            }
            (Self::Host, Active) => {
                "less work between reading and writing, Realtime::Enforce, and a dedicated processor for the writing thread"
            }
            (Self::Host, Goals | Asynchronous) => {
                "Realtime::Enforce, and a dedicated processor for the control thread"
            }
            (Self::Thresholds, Goals) => {
                "a slower approach, or higher thresholds of set_collision_behavior, if the contact is intended; set_load and less acceleration if nothing was touched"
            }
            (Self::Thresholds, _) => {
                "set_collision_behavior if the contact is intended; set_load and less acceleration if nothing was touched"
            }
            (Self::GiveWay, _) => {
                "a clear path; softer gains, so that the arm yields, or lower thresholds of set_collision_behavior, so that it stops earlier"
            }
            (Self::AvoidSingularity, _) => {
                "move there by joint positions, or with another elbow position"
            }
            (Self::StayInRange, Function | Active) => {
                "commands that keep the joint further inside its range, or another elbow position"
            }
            (Self::StayInRange, _) => {
                "a target further inside the joint's range, or another elbow position"
            }
            (Self::StayClearOfItself, _) => "a path on which the links stay further apart",
            (Self::LessEffort, _) => {
                "less acceleration, less load, or the load declared by set_load"
            }
            (Self::SofterGains, Function) => {
                "lower stiffness, other damping, or cutoff_frequency for the torques"
            }
            (Self::SofterGains, _) => "lower stiffness, or other damping",
            (Self::Desk, _) => "the walls, load and tasks in Desk",
        }
    }
}
