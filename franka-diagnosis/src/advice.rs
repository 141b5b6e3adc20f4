//! Which setting to change.

use franka_rt::driver::Commander;

/// What to change, so that the next motion does not end likewise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Advice {
    /// Commands to the motion generator have to go on without a leap.
    Smooth,
    /// Torques have to go on without a step.
    SmoothTorques,
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
    /// What touched the arm was more than its joints can hold.
    GiveWay,
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

impl Advice {
    /// The advice in words, with the settings of this driver that there are where `commander`
    /// commands.
    pub fn text(self, commander: Commander) -> &'static str {
        use Commander::{Active, Asynchronous, Function, Goals};
        match (self, commander) {
            (Self::Smooth, Function) => {
                "commands that go on in position, velocity and acceleration; limit_rate(true) takes up small steps of \
                 joints, not of poses"
            }
            (Self::Smooth, Active) => {
                "commands that go on in position, velocity and acceleration: nothing limits what is written"
            }
            (Self::SmoothTorques, Function) => {
                "torques without steps that begin and end at zero; limit_rate(true) makes ramps of steps"
            }
            (Self::SmoothTorques, Active) => {
                "torques without steps that begin and end at zero: nothing limits what is written"
            }
            (Self::Smooth | Self::SmoothTorques | Self::SlowDown, Goals) => {
                "speed below 1 or limits with less velocity and acceleration, or softer gains"
            }
            (Self::Smooth | Self::SmoothTorques | Self::SlowDown, Asynchronous) => {
                "lower maximum_joint_velocities"
            }
            (Self::SlowDown, Function | Active) => {
                "less speed and acceleration; of a torque law, smaller torques or more damping"
            }
            (Self::StartWhereItIs, Function | Active) => {
                "begin with what the first state has: q_d, O_T_EE_c, elbow_c, and zero velocity and torque"
            }
            (Self::StartWhereItIs, Goals | Asynchronous) => {
                "begin when the arm rests and nothing pushes it"
            }
            (Self::FinishAtRest, Function | Active) => {
                "bring the command to rest, and the arm that your torques lead, before it says that it is finished"
            }
            (Self::FinishAtRest, Goals | Asynchronous) => {
                "end the motion when the arm rests and nothing pushes it"
            }
            (Self::Network, _) => {
                "a direct cable to the robot, nothing else on it, and no power saving of the network card"
            }
            (Self::Host, Function) => {
                "less work in the control function, Realtime::Enforce, and a processor of its own for the control thread"
            }
            (Self::Host, Active) => {
                "less work between reading and writing, Realtime::Enforce, and a processor of its own for the thread that \
                 writes"
            }
            (Self::Host, Goals | Asynchronous) => {
                "Realtime::Enforce, and a processor of its own for the control thread"
            }
            (Self::Thresholds, Goals) => {
                "set_collision_behavior or a lower force_cap if the contact is meant; set_load and less acceleration if \
                 nothing was touched"
            }
            (Self::Thresholds, _) => {
                "set_collision_behavior if the contact is meant; set_load and less acceleration if nothing was touched"
            }
            (Self::GiveWay, _) => {
                "a clear way; softer gains have the arm give way, lower thresholds of set_collision_behavior stop it before"
            }
            (Self::AvoidSingularity, _) => "go there by joint positions, or by another elbow",
            (Self::StayInRange, Function | Active) => {
                "commands that keep the joint further inside its range, or another elbow"
            }
            (Self::StayInRange, _) => "a target further inside the joint's range, or another elbow",
            (Self::StayClearOfItself, _) => "a way on which the links stay further apart",
            (Self::LessEffort, _) => {
                "less acceleration, less load, or the load declared by set_load"
            }
            (Self::SofterGains, Function) => {
                "lower stiffness, other damping, or cutoff_frequency for the torques"
            }
            (Self::SofterGains, _) => "lower stiffness, or other damping",
            (Self::Desk, _) => "walls, load and tasks in Desk",
        }
    }
}
