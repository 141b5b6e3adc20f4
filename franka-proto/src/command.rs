//! The commands of a robot, and what the commands of all services have in common.

use core::fmt;

/// Counter of a client's requests on one connection: 0 for `Connect`, then one more for each
/// request. Only this counter matches replies to requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommandId(pub u32);

impl fmt::Display for CommandId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

/// A command of a service. `Display` is its name.
pub trait ServiceCommand: Copy + fmt::Debug + fmt::Display + Eq + 'static {
    /// The command `Connect`.
    const CONNECT: Self;

    /// The name of this service with which libfranka's messages begin.
    const SERVICE: &'static str;

    /// Writes libfranka's text about a reply with an undefined status.
    ///
    /// # Errors
    /// The errors of the formatter.
    fn unexpected_response(self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let service = Self::SERVICE;
        write!(f, "{service}: Unexpected response while handling command!")
    }
}

/// The commands of all versions. The version table states which versions have a command, and its
/// number: see [`Version::command_number`](crate::Version::command_number).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Opens a session.
    Connect,
    /// Starts a motion. It has two replies.
    Move,
    /// Stops the motion.
    StopMove,
    /// Reads a virtual wall; protocol 5 only.
    GetCartesianLimit,
    /// Sets the thresholds of contact and collision.
    SetCollisionBehavior,
    /// Sets the stiffness of the robot's joint controller.
    SetJointImpedance,
    /// Sets the stiffness of the robot's Cartesian controller.
    SetCartesianImpedance,
    /// Sets the axes in which a person may guide the hand.
    SetGuidingMode,
    /// Sets the stiffness frame.
    SetEEToK,
    /// Sets the end-effector frame.
    SetNEToEE,
    /// Sets the load.
    SetLoad,
    /// Sets the filters of the robot's interfaces; protocol 5 only.
    SetFilters,
    /// Clears errors after a reflex.
    AutomaticErrorRecovery,
    /// Fetches the robot's description; protocol 10 only.
    GetRobotModel,
    /// Fetches the robot's model as a shared library; protocol 5 only.
    LoadModelLibrary,
}

impl Command {
    /// All commands of all versions.
    pub const ALL: [Self; 15] = [
        Self::Connect,
        Self::Move,
        Self::StopMove,
        Self::GetCartesianLimit,
        Self::SetCollisionBehavior,
        Self::SetJointImpedance,
        Self::SetCartesianImpedance,
        Self::SetGuidingMode,
        Self::SetEEToK,
        Self::SetNEToEE,
        Self::SetLoad,
        Self::SetFilters,
        Self::AutomaticErrorRecovery,
        Self::GetRobotModel,
        Self::LoadModelLibrary,
    ];

    /// Name of the command in libfranka's messages. `Connect` and `LoadModelLibrary` have no name
    /// in libfranka, and its messages do not use one.
    #[must_use]
    pub fn display_name(self) -> &'static str {
        match self {
            Self::Connect => "Connect",
            Self::Move => "Move",
            Self::StopMove => "Stop Move",
            Self::GetCartesianLimit => "Get Cartesian Limit",
            Self::SetCollisionBehavior => "Set Collision Behavior",
            Self::SetJointImpedance => "Set Joint Impedance",
            Self::SetCartesianImpedance => "Set Cartesian Impedance",
            Self::SetGuidingMode => "Set Guiding Mode",
            Self::SetEEToK => "Set EE to K",
            Self::SetNEToEE => "Set NE to EE",
            Self::SetLoad => "Set Load",
            Self::SetFilters => "Set Filters",
            Self::AutomaticErrorRecovery => "Automatic Error Recovery",
            Self::GetRobotModel => "Get Robot Model",
            Self::LoadModelLibrary => "Load Model Library",
        }
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.display_name())
    }
}

impl ServiceCommand for Command {
    const CONNECT: Self = Self::Connect;
    const SERVICE: &'static str = "libfranka";

    fn unexpected_response(self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let service = Self::SERVICE;
        match self {
            // libfranka only checks whether the status of a library is a success.
            Self::LoadModelLibrary => write!(f, "{service}: {NO_LIBRARY}"),
            _ => write!(
                f,
                "{service}: Unexpected response while handling {self} command!"
            ),
        }
    }
}

/// libfranka's text about a library that the robot does not provide. The text names no command.
pub(crate) const NO_LIBRARY: &str = "Server reports error when loading model library.";
