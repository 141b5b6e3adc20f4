//! What commanded a motion.

use super::Program;

/// What commanded a motion, which decides what its commands mean and which settings there are to
/// change.
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
    /// True if a command says where to be a cycle later, so that differences of commands are what
    /// the joints are to do. A target that the robot plans to is not that, and only new targets are
    /// sent.
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
