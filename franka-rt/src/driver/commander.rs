//! Source of the commands of a motion.

use super::Program;

/// Source of the commands of a motion. It determines what the commands mean, and which settings the
/// motion has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Commander {
    /// Target control: this driver computes the commands that move the arm to goals.
    Goals,
    /// A control function of the user.
    Function,
    /// A thread of the user, which reads states and writes commands.
    Active,
    /// Sparse joint targets. The robot plans the motion between them.
    Asynchronous,
}

impl Commander {
    /// True if a command is sent in every cycle. The difference between two successive commands
    /// then shows the motion that was intended in one cycle. False for sparse targets, which are
    /// sent only when they are new.
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
