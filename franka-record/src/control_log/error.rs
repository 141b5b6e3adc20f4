//! Errors of reading a control log.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Reason why a control log of libfranka cannot be read.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ControlLogError {
    /// The file cannot be opened.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// The file is not text.
    #[error("got a byte that is not UTF-8 after {offset} bytes, expected text")]
    NotText {
        /// Number of bytes before the first invalid byte.
        offset: u64,
    },
    /// The file contains neither a table nor an exception text.
    #[error(
        "got {got:?}, expected a recording (MCAP); a table of franka::logToCSV, which begins with \
         \"time,success_rate,state.q[0]\"; or the text of a franka::ControlException, which contains \
         \"Move command aborted\""
    )]
    Unknown {
        /// The beginning of the file's first line.
        got: String,
    },
    /// A cell of a table does not have the form that its column requires.
    #[error("line {line}, column {column} ({name}): got {got:?}, expected {expected}")]
    Cell {
        /// Line in the file, counted from 1.
        line: u64,
        /// Column in the table, counted from 1.
        column: usize,
        /// The name of the column.
        name: String,
        /// The text of the cell.
        got: String,
        /// The expected text.
        expected: String,
    },
    /// A table lacks a column.
    #[error(
        "line {line}: got {got} columns without {missing:?}, expected the columns of \
         franka::logToCSV"
    )]
    Column {
        /// Line in the file, counted from 1.
        line: u64,
        /// Number of columns.
        got: usize,
        /// Name of the missing column.
        missing: String,
    },
    /// A row does not have as many cells as the table has columns.
    #[error("line {line}, column {column}: got a row of {got} cells, expected {expected}{}", if *last { ": the file ends too early" } else { "" })]
    Row {
        /// Line in the file, counted from 1.
        line: u64,
        /// First missing or surplus column, counted from 1.
        column: usize,
        /// Number of cells in the row.
        got: usize,
        /// Number of columns in the table.
        expected: usize,
        /// True if the row is the last of the table.
        last: bool,
    },
    /// A table has no rows.
    #[error("line {line}: got a table without rows, expected a row for each cycle")]
    NoRow {
        /// Line of the column names, counted from 1.
        line: u64,
    },
    /// The exception text is damaged or incomplete.
    #[error("line {line}, column {column}: got {got:?}, expected {expected}")]
    Message {
        /// Line in the file, counted from 1.
        line: u64,
        /// Position in the line, in characters, counted from 1.
        column: usize,
        /// The text at this position.
        got: String,
        /// The expected text.
        expected: &'static str,
    },
}
