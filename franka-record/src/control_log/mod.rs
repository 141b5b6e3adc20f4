//! Reads libfranka's report about a motion that the robot ended. The report is the table of
//! `franka::logToCSV`, and the text of the `franka::ControlException`. This driver's
//! `ControlLog::to_csv` writes the same table.
//!
//! ```text
//! file --> message: refusal, errors, success rate      --> Case --> Explanation
//!      --> table, of any generation of columns --> log -->      --> cycles, for exports
//! ```
//!
//! | module | contents |
//! |---|---|
//! | `table` | rows of numbers, by the names of their columns |
//! | `message` | the text of the exception, at any place in the file |
//! | `motion` | data derived from the rows: modes, numbers of commands, derivatives |
//!
//! A file can contain a table, a text or both, surrounded by other lines, such as the output of a
//! terminal. If the file contains several tables or texts, the reader uses the newest. Tables have
//! three generations of columns, according to the changelog of libfranka:
//!
//! | libfranka | first columns |
//! |---|---|
//! | 0.2 to 0.9.0 | `duration, success rate, q[0], q[1]`; the commands follow an empty column |
//! | 0.9.1 to 0.14 | `time, success_rate, state.q[0], state.q[1]` |
//! | 0.15 and later | `time,success_rate,state.q[0],state.q[1]` |
//!
//! Numbers in a table have six significant digits. The diagnosis does not report a difference that
//! rounding can have caused. Therefore a log of joint positions shows steps, but rarely a jerk.
//!
//! # Example
//!
//! ```
//! use franka_model::Model;
//! use franka_record::control_log::ControlLogFile;
//! use franka_record::explain::Explanation;
//!
//! let text = "libfranka: Move command aborted: motion aborted by reflex! \
//!             [\"communication_constraints_violation\"]\n\
//!             control_command_success_rate: 0.77";
//! let file = ControlLogFile::parse(text)?;
//! let explanation = Explanation::of_control_log(&file, Model::fr3());
//! println!("{explanation}");
//! # assert!(explanation.to_string().contains("direct cable"), "{explanation}");
//! # Ok::<(), franka_record::control_log::ControlLogError>(())
//! ```

mod error;
mod message;
mod motion;
mod table;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::Path;
use std::sync::Arc;

use franka_diagnosis::Case;
use franka_model::RobotKind;
use franka_proto::{Errors, RobotCommand};
use franka_rt::driver::{Commander, ControlLog};

pub use self::error::ControlLogError;
pub use self::message::ControlMessage;
use self::motion::Motion;
pub use self::table::Generation;
use self::table::Table;
use crate::Cycle;

/// A file that contains a log of libfranka, the text of a control exception, or both.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ControlLogFile {
    /// The newest exception text.
    pub message: Option<ControlMessage>,
    /// The newest table, oldest cycle first; empty if the file contains no table. The states
    /// contain the values of the table and values derived from them. All other fields have their
    /// default values.
    pub log: Arc<ControlLog>,
    /// Generation of the table's columns.
    pub generation: Option<Generation>,
    /// Number of older tables and texts in the file.
    pub earlier: u64,
    commands: Vec<RobotCommand>,
}

impl ControlLogFile {
    /// Reads a file.
    ///
    /// # Errors
    /// Returns [`ControlLogError`] if the file cannot be read, or if it contains neither a table
    /// nor an exception text.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ControlLogError> {
        let path = path.as_ref();
        let bytes = fs::read(path).map_err(|source| ControlLogError::File {
            path: path.to_owned(),
            source: source.into(),
        })?;
        let text = String::from_utf8(bytes).map_err(|error| ControlLogError::NotText {
            offset: error.utf8_error().valid_up_to() as u64,
        })?;
        Self::parse(&text)
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// Returns [`ControlLogError`] if the text contains neither a table nor an exception text, or
    /// if one of them is damaged.
    pub fn parse(text: &str) -> Result<Self, ControlLogError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let (tables, around) = table::find(text);
        let mut messages = message::all(text, &around)?;
        if tables.is_empty() && messages.is_empty() {
            let line = text.lines().find(|line| !line.trim().is_empty());
            let got = line.unwrap_or_default().chars().take(SHOWN).collect();
            return Err(ControlLogError::Unknown { got });
        }
        let earlier = tables.len().max(messages.len()) as u64 - 1;
        let message = messages.pop();
        let errors = message.as_ref().map_or(Errors::NONE, |it| it.errors);
        let table = tables.last().map(|place| Table::read(text, place));
        let Some(table) = table.transpose()? else {
            return Ok(Self {
                message,
                earlier,
                ..Self::default()
            });
        };
        let generation = Some(table.generation);
        let motion = Motion::of(table, errors);
        Ok(Self {
            message,
            log: Arc::new(motion.log),
            generation,
            earlier,
            commands: motion.commands,
        })
    }

    /// Returns the kind of robot if the file identifies it. Before libfranka 0.9.1, only one kind
    /// existed.
    pub fn kind(&self) -> Option<RobotKind> {
        (self.generation == Some(Generation::Unprefixed)).then_some(RobotKind::Fer)
    }

    /// Returns the errors in the exception text; empty if the file contains no exception text.
    pub fn errors(&self) -> Errors {
        let message = self.message.as_ref();
        message.map_or(Errors::NONE, |message| message.errors)
    }

    /// Sets the errors that ended the motion. Use this method if the exception text is missing.
    #[must_use]
    pub fn with_errors(mut self, errors: Errors) -> Self {
        let message = self.message.get_or_insert_default();
        message.errors = errors;
        self.log = Arc::new(motion::ended_by(&self.log, errors));
        self
    }

    /// Returns the input of a diagnosis.
    pub fn case(&self) -> Case {
        Case {
            commander: Commander::Function,
            errors: self.errors(),
            log: self.log.clone(),
            statistics: None,
        }
    }

    /// Returns the cycles of the table for exports with
    /// [`Columns::of_log`](crate::export::Columns::of_log). Each cycle contains the command that
    /// answers its state. A log does not contain the host's clock, so [`Cycle::time`] is zero.
    pub fn cycles(&self) -> impl Iterator<Item = Cycle> {
        motion::cycles(&self.log, &self.commands)
    }
}

/// Largest number of characters of a line that an error shows.
const SHOWN: usize = 60;
