//! Rows of numbers by the robot's time, in order of arrival.

use franka_async::record::{Column, ColumnSource, Record};
use franka_async::state::RobotState;

/// The table of a column.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Source {
    State,
    Cycle,
}

impl Source {
    pub(super) fn of(column: &Column) -> Self {
        match column.source {
            ColumnSource::State(_) => Self::State,
            ColumnSource::Record(_) => Self::Cycle,
        }
    }
}

/// One cycle, from the robot or from the control thread.
pub(super) enum Seen {
    State(Box<RobotState>),
    Cycle(Box<Record>),
}

impl Seen {
    /// Returns `message_id` of the state.
    fn time(&self) -> u64 {
        match self {
            Self::State(state) => state.message_id,
            Self::Cycle(record) => record.time,
        }
    }

    /// Appends the value of a column in this cycle.
    fn append(&self, column: &Column, row: &mut Vec<f64>) {
        match (column.source, self) {
            (ColumnSource::State(read), Self::State(state)) => read(state, row),
            (ColumnSource::Record(read), Self::Cycle(record)) => read(record, row),
            _ => unreachable!("tables have columns of one source"),
        }
    }
}

/// Rows of some columns, each with the `message_id` of its state, in the order of time.
pub(super) struct Table {
    pub(super) columns: Vec<&'static Column>,
    width: usize,
    pub(super) times: Vec<u64>,
    /// Consecutive rows, in blocks, so that growing copies nothing.
    blocks: Vec<Vec<f64>>,
    /// Time of the newest received row.
    pub(super) newest: u64,
    /// True if rows are stored.
    pub(super) is_used: bool,
    /// True if no more rows arrive.
    pub(super) is_complete: bool,
}

impl Table {
    /// Creates an empty table for rows after `begin`.
    pub(super) fn new(columns: Vec<&'static Column>, begin: u64, is_used: bool) -> Self {
        Self {
            width: columns.iter().map(|column| column.width()).sum(),
            is_used,
            is_complete: !is_used,
            columns,
            times: Vec::new(),
            blocks: Vec::new(),
            newest: begin,
        }
    }

    /// Appends a row for this cycle, unless it is old or the table already has `most` rows.
    pub(super) fn push(&mut self, seen: &Seen, most: usize) {
        let time = seen.time();
        if time <= self.newest {
            return;
        }
        self.newest = time;
        if self.times.len() == most {
            return;
        }
        if self.times.len().is_multiple_of(BLOCK) {
            self.blocks.push(Vec::with_capacity(BLOCK * self.width));
        }
        self.times.push(time);
        let block = self.blocks.last_mut().expect("just made");
        for column in &self.columns {
            seen.append(column, block);
        }
    }

    /// Returns the numbers of a column in these rows.
    pub(super) fn values(&self, column: &Column, rows: &[usize]) -> Vec<f64> {
        let before = self.columns.iter().take_while(|it| it.name != column.name);
        let offset: usize = before.map(|column| column.width()).sum();
        let mut values = Vec::with_capacity(rows.len() * column.width());
        for row in rows {
            let begin = row % BLOCK * self.width + offset;
            values.extend_from_slice(&self.blocks[row / BLOCK][begin..begin + column.width()]);
        }
        values
    }
}

/// Number of rows of a block.
const BLOCK: usize = 1024;
