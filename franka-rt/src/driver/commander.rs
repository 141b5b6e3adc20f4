//! Source of the commands of a motion.

use super::Program;

/// Source of the commands of a motion. The source decides the meaning of the commands, and which
/// settings exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Commander {
    /// Target control: this driver computes commands on the way to goals.
    Goals,
    /// A control function of the user.
    Function,
    /// A thread of the user that reads states and writes commands.
    Active,
    /// Sparse joint targets between which the robot plans.
    Asynchronous,
}

impl Commander {
    /// True if each command is the position one cycle later, so that differences of commands are
    /// the intended motion of the joints. False for targets between which the robot plans: only new
    /// targets are sent.
    pub fn commands_every_cycle(self) -> bool {
        self != Self::Asynchronous
    }
}

impl From<&Program> for Commander {
    fn from(program: &Program) -> Self {
        match program {
            Program::Target(_) => Self::Goals,
            Program::Callback(_) => Self::Function,
            Program::Active(_) => Self::Active,
            Program::Asynchronous(_) => Self::Asynchronous,
        }
    }
}
