//! `franka man`: writes one man page per command.

use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, CommandFactory};

use crate::Program;
use crate::ending::Ending;
use crate::output::line;

/// Write the man pages
#[derive(Debug, Args)]
pub(crate) struct Man {
    /// Folder for the pages
    folder: PathBuf,
}

impl Man {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        let write = || {
            fs::create_dir_all(&self.folder)?;
            clap_mangen::generate_to(Program::command(), &self.folder)
        };
        write().with_context(|| format!("writing to {}", self.folder.display()))?;
        line(&format!("man pages in {}", self.folder.display()))?;
        Ok(Ending::Done)
    }
}
