//! The table of `franka::logToCSV`.

use std::ops::Range;

use csv::{ReaderBuilder, StringRecord, Trim};
use franka_proto::{RobotCommand, RobotState};

use super::{ControlLogError, SHOWN};

/// Generation of the columns in libfranka's table. The column names have changed twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Generation {
    /// libfranka 0.2 to 0.9.0: `duration, success rate, q[0]`, with an empty column before the
    /// commands.
    Unprefixed,
    /// libfranka 0.9.1 to 0.14: `time, success_rate, state.q[0]`, with spaces.
    Spaced,
    /// libfranka 0.15 and later, and this driver: `time,success_rate,state.q[0]`.
    Compact,
}

/// Position of a table in a file.
#[derive(Clone, Debug)]
pub(super) struct Place {
    bytes: Range<usize>,
    /// Line of the column names, counted from 1.
    line: u64,
    generation: Generation,
}

#[derive(Debug)]
pub(super) struct Table {
    pub(super) generation: Generation,
    /// At least one row, oldest first.
    pub(super) rows: Vec<Row>,
}

/// A row: a state and the command that preceded it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row {
    pub(super) state: RobotState,
    /// The command. Only the numbers that control the motion are not zero.
    pub(super) command: RobotCommand,
}

/// Returns the tables of a file, oldest first, and the parts of the file between them.
pub(super) fn find(text: &str) -> (Vec<Place>, Vec<Range<usize>>) {
    let (mut tables, mut around): (Vec<Place>, Vec<Range<usize>>) = (Vec::new(), Vec::new());
    let (mut offset, mut is_inside) = (0, false);
    for (line, content) in (1..).zip(text.split_inclusive('\n')) {
        let end = offset + content.len();
        if let Some(generation) = generation(content) {
            let bytes = offset..end;
            tables.push(Place {
                bytes,
                line,
                generation,
            });
            is_inside = true;
        } else if is_inside && is_row(content) {
            tables.last_mut().expect("it is inside").bytes.end = end;
        } else {
            match around.last_mut() {
                Some(part) if part.end == offset => part.end = end,
                _ => around.push(offset..end),
            }
            is_inside = false;
        }
        offset = end;
    }
    (tables, around)
}

fn generation(line: &str) -> Option<Generation> {
    let mut names = line.split(',');
    let blank = |name: &str| name.starts_with(' ');
    let plain = |name: &str| name.trim().trim_matches('"').to_owned();
    let (first, second) = (plain(names.next()?), names.next()?);
    match (first.as_str(), plain(second).as_str()) {
        ("duration", "success rate") => Some(Generation::Unprefixed),
        ("time", "success_rate") if blank(second) => Some(Generation::Spaced),
        ("time", "success_rate") => Some(Generation::Compact),
        _ => None,
    }
}

/// Returns true if a line below the column names belongs to the table, even if it is truncated or
/// garbled. An empty line or a line of words ends the table.
fn is_row(line: &str) -> bool {
    let line = line.trim();
    let is_number = |c: char| c.is_ascii_digit() || c == '-';
    line.starts_with(is_number) || line.contains(',') && !line.contains("libfranka")
}

/// Field that receives the numbers of a group of columns.
enum Field {
    State(fn(&mut RobotState) -> &mut [f64]),
    Command(fn(&mut RobotCommand) -> &mut [f64]),
}

/// The columns with libfranka's names. Each entry is a vector.
const COLUMNS: [(&str, Field); 11] = [
    ("q", Field::State(|it| &mut it.q)),
    ("q_d", Field::State(|it| &mut it.q_d)),
    ("dq", Field::State(|it| &mut it.dq)),
    ("dq_d", Field::State(|it| &mut it.dq_d)),
    ("tau_J", Field::State(|it| &mut it.tau_J)),
    (
        "tau_ext_hat_filtered",
        Field::State(|it| &mut it.tau_ext_hat_filtered),
    ),
    ("q_d", Field::Command(|it| &mut it.q_c)),
    ("dq_d", Field::Command(|it| &mut it.dq_c)),
    ("O_T_EE_d", Field::Command(|it| &mut it.O_T_EE_c)),
    ("O_dP_EE_d", Field::Command(|it| &mut it.O_dP_EE_c)),
    ("tau_J_d", Field::Command(|it| &mut it.tau_J_d)),
];

/// Positions of the time, the success rate and each of [`COLUMNS`] in a row.
struct Layout {
    cells: usize,
    /// For each number: its position in the row, its entry in [`COLUMNS`], and its index in the
    /// vector.
    numbers: Vec<(usize, usize, usize)>,
}

impl Layout {
    /// Finds the columns. The columns may have any order, and there can be other columns between
    /// them.
    fn of(names: &StringRecord, place: &Place) -> Result<Self, ControlLogError> {
        let is_unprefixed = place.generation == Generation::Unprefixed;
        // Without prefixes, the same column name means a state before this column, and a command
        // after it.
        let commands = names.iter().position(|name| name == COMMANDS);
        let commands = commands.unwrap_or(names.len());
        let mut numbers = Vec::new();
        let mut row = Row::default();
        for (column, (name, field)) in COLUMNS.iter().enumerate() {
            let (prefix, among) = match field {
                Field::State(_) => ("state.", 0..commands),
                Field::Command(_) => ("cmd.", commands.min(names.len())..names.len()),
            };
            for index in 0..field.of(&mut row).len() {
                let mut sought = format!("{name}[{index}]");
                let mut among = among.clone();
                if !is_unprefixed {
                    sought = format!("{prefix}{sought}");
                    among = 0..names.len();
                }
                let cell = among.clone().find(|i| names[*i] == sought);
                let cell = cell.ok_or(ControlLogError::Column {
                    line: place.line,
                    got: names.len(),
                    missing: sought,
                })?;
                numbers.push((cell, column, index));
            }
        }
        Ok(Self {
            cells: names.len(),
            numbers,
        })
    }
}

impl Field {
    fn of<'a>(&self, row: &'a mut Row) -> &'a mut [f64] {
        match self {
            Self::State(of) => of(&mut row.state),
            Self::Command(of) => of(&mut row.command),
        }
    }
}

impl Table {
    pub(super) fn read(text: &str, place: &Place) -> Result<Self, ControlLogError> {
        let bytes = &text.as_bytes()[place.bytes.clone()];
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .from_reader(bytes);
        let (mut names, mut record) = (StringRecord::new(), StringRecord::new());
        let read = "a text in memory can be read, and is UTF-8";
        reader.read_record(&mut names).expect(read);
        let layout = Layout::of(&names, place)?;
        let mut rows: Vec<Row> = Vec::new();
        while reader.read_record(&mut record).expect(read) {
            let position = record.position().expect("it was read");
            let line = place.line + position.line() - 1;
            if record.len() != layout.cells {
                return Err(ControlLogError::Row {
                    line,
                    column: record.len().min(layout.cells) + 1,
                    got: record.len(),
                    expected: layout.cells,
                    last: record.len() < layout.cells
                        && reader.position().byte() >= bytes.trim_ascii_end().len() as u64,
                });
            }
            let row = row(&layout, &names, &record, line)?;
            if let Some(before) = rows.last().map(|row| row.state.message_id)
                && row.state.message_id <= before
            {
                let expected = format!("a time after {before} ms");
                return Err(cell(&names, &record, line, 0, expected));
            }
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(ControlLogError::NoRow { line: place.line });
        }
        Ok(Self {
            generation: place.generation,
            rows,
        })
    }
}

fn row(
    layout: &Layout,
    names: &StringRecord,
    record: &StringRecord,
    line: u64,
) -> Result<Row, ControlLogError> {
    let fail = |column, expected: &str| cell(names, record, line, column, expected.to_owned());
    let mut row = Row::default();
    let [time, rate] = [0, 1];
    let Ok(message_id) = record[time].parse() else {
        return Err(fail(time, "whole milliseconds"));
    };
    row.state.message_id = message_id;
    let Ok(success_rate) = record[rate].parse() else {
        return Err(fail(rate, "a success rate, 0 to 1"));
    };
    row.state.control_command_success_rate = success_rate;
    for (place, column, index) in &layout.numbers {
        let Ok(number) = record[*place].parse() else {
            return Err(fail(*place, "a number"));
        };
        COLUMNS[*column].1.of(&mut row)[*index] = number;
    }
    Ok(row)
}

/// Returns the error for a cell. `column` is counted from 0.
fn cell(
    names: &StringRecord,
    record: &StringRecord,
    line: u64,
    column: usize,
    expected: String,
) -> ControlLogError {
    ControlLogError::Cell {
        line,
        column: column + 1,
        name: names[column].to_owned(),
        got: record[column].chars().take(SHOWN).collect(),
        expected,
    }
}

/// The empty column before the commands of [`Generation::Unprefixed`].
const COMMANDS: &str = "sent commands";
