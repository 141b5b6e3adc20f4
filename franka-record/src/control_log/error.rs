//! Why a control log cannot be read.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Why a control log of libfranka cannot be read.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ControlLogError {
    /// The file cannot be opened.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: Arc<io::Error>,
    },
    /// The file is no text.
    #[error("got a byte that is not UTF-8 after {offset} bytes, expected text")]
    NotText {
        /// Bytes before the first that is no text.
        offset: u64,
    },
    /// The file has no table and no text of an exception.
    #[error(
        "got {got:?}, expected a recording (MCAP), a table of franka::logToCSV, which begins with \
         \"time,success_rate,state.q[0]\", or the text of a franka::ControlException, which has \
         \"Move command aborted\""
    )]
    Unknown {
        /// The beginning of its first line.
        got: String,
    },
    /// A cell of a table is not what its column holds.
    #[error("line {line}, column {column} ({name}): got {got:?}, expected {expected}")]
    Cell {
        /// The line of the file, from 1.
        line: u64,
        /// The column of the table, from 1.
        column: usize,
        /// The name of the column.
        name: String,
        /// The text of the cell.
        got: String,
        /// Expected in its place.
        expected: String,
    },
    /// A table has no column of this name.
    #[error(
        "line {line}: got {got} columns without {missing:?}, expected those of franka::logToCSV"
    )]
    Column {
        /// The line of the file, from 1.
        line: u64,
        /// How many columns there are.
        got: usize,
        /// The name that is missing.
        missing: String,
    },
    /// A row has more or fewer cells than the table has columns.
    #[error("line {line}, column {column}: got a row of {got} cells, expected {expected}{}", if *last { ": the file is cut there" } else { "" })]
    Row {
        /// The line of the file, from 1.
        line: u64,
        /// The first column, from 1, that is missing or too many.
        column: usize,
        /// The cells of the row.
        got: usize,
        /// The columns of the table.
        expected: usize,
        /// True for the last row of the table.
        last: bool,
    },
    /// A table has no row.
    #[error("line {line}: got a table without rows, expected a row for each cycle")]
    NoRow {
        /// The line of the names, from 1.
        line: u64,
    },
    /// The text of an exception is damaged, or ends early.
    #[error("line {line}, column {column}: got {got:?}, expected {expected}")]
    Message {
        /// The line of the file, from 1.
        line: u64,
        /// The character of the line, from 1.
        column: usize,
        /// The text there.
        got: String,
        /// Expected in its place.
        expected: &'static str,
    },
}
