//! Source of the commands of a motion.

use super::Program;

/// Source of the commands of a motion. It decides the meaning of the commands and which settings
/// there are to change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Commander {
    /// Target control: this driver, on the way to goals.
    Goals,
    /// A control function of the user's.
    Function,
    /// A thread of the user's, by reading and writing.
    Active,
    /// Sparse joint targets between which the robot plans.
    Asynchronous,
}

impl Commander {
    /// True if a command is the position one cycle later, so that differences of commands are the
    /// motion that the joints should make. Targets between which the robot plans are not such
    /// commands, and only new targets are sent.
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
