//! `franka completions`: scripts that complete arguments in a shell.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::Program;
use crate::ending::Ending;
use crate::output::line;

/// Print the completions for a shell
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Program::command(), "franka", &mut script);
        line(String::from_utf8(script)?.trim_end())?;
        Ok(Ending::Done)
    }
}
