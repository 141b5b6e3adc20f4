//! The commands of a robot, and the trait that the commands of all services implement.

use core::fmt;

/// Id of a request on one connection: 0 for `Connect`, then one more for each request. A reply
/// repeats the id of its request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommandId(pub u32);

impl fmt::Display for CommandId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

/// A command of a service. `Display` prints its name.
pub trait ServiceCommand: Copy + fmt::Debug + fmt::Display + Eq + 'static {
    /// The command `Connect`.
    const CONNECT: Self;

    /// Name of this service. libfranka's messages begin with this name.
    const SERVICE: &'static str;

    /// Writes libfranka's text about a reply with an undefined status.
    ///
    /// # Errors
    /// Returns an error if the formatter fails.
    fn unexpected_response(self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let service = Self::SERVICE;
        write!(f, "{service}: Unexpected response while handling command!")
    }
}

/// The commands of all versions. [`Version::command_number`](crate::Version::command_number)
/// returns a command's number in a version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Command {
    /// Opens a session.
    Connect,
    /// Starts a motion. This command has two replies.
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

    /// Returns the name of the command in libfranka's messages. `Connect` and `LoadModelLibrary`
    /// have no name in libfranka.
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
            // libfranka only checks if the status of a library is a success.
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
