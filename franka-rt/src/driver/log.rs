//! The last cycles of a motion, which its error carries.

use core::fmt;

use franka_proto::{General, RobotCommand, RobotState, SuccessRate};

/// One cycle of a motion: a state, and the command that was sent before the state arrived.
///
/// Each entry shows the effect of a command, as in libfranka 0.21 (`logger.h`). If the command
/// answered the state `n`, the entry contains the state `n + 1`. The command of the first entry is
/// all zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LogEntry {
    /// The state.
    pub state: RobotState,
    /// The newest command that was sent before the state; zeros before the first command.
    pub command: RobotCommand,
}

impl LogEntry {
    /// Returns the entry for `state`. `command` is the newest command before the state.
    pub fn new(state: RobotState, command: RobotCommand) -> Self {
        Self { state, command }
    }
}

/// Log of the last cycles of one motion, oldest first, up to a capacity.
///
/// The log allocates its memory when it is created. Writing neither allocates nor frees.
#[derive(Clone, Default)]
pub struct ControlLog {
    /// Entries: one more than the capacity, or none for a capacity of 0.
    entries: Box<[LogEntry]>,
    /// Index of the entry that has a command and waits for its state.
    next: usize,
    len: usize,
    rounded: bool,
}

impl ControlLog {
    /// Default number of cycles. Source: `log_size` of libfranka 0.21, `robot.h`.
    pub const DEFAULT_CAPACITY: usize = 50;

    /// Largest number of cycles that a connected robot can log per motion: ten seconds. A log of
    /// this size needs 30 MB, which every motion allocates anew.
    pub const CAPACITY_MAX: usize = 10_000;

    /// Returns an empty log for the newest `capacity` cycles. If `capacity` is 0, the log keeps no
    /// cycle.
    pub fn with_capacity(capacity: usize) -> Self {
        let entries = if capacity == 0 { 0 } else { capacity + 1 };
        Self {
            entries: vec![LogEntry::default(); entries].into(),
            next: 0,
            len: 0,
            rounded: false,
        }
    }

    /// Marks the numbers as rounded to six significant digits, as in libfranka's CSV tables. A
    /// diagnosis then ignores differences that rounding may have caused.
    #[must_use]
    pub fn rounded(self) -> Self {
        Self {
            rounded: true,
            ..self
        }
    }

    /// True if the numbers are rounded to six significant digits.
    pub fn is_rounded(&self) -> bool {
        self.rounded
    }

    /// Returns the largest number of cycles that the log can keep.
    pub fn capacity(&self) -> usize {
        self.entries.len().saturating_sub(1)
    }

    /// Returns the number of cycles in the log.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True if the log contains no cycles.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Iterates over the cycles, oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &LogEntry> {
        let (newer, rest) = self.entries.split_at(self.next);
        let full = self.len == self.capacity();
        let older = if full {
            rest.get(1..).unwrap_or_default()
        } else {
            &[]
        };
        older.iter().chain(newer)
    }

    /// Returns the success rate at the end of the motion. Like libfranka 0.21, it reads the rate
    /// from the second-to-last state, because the last state always shows 0. Returns `None` if the
    /// log has fewer than two entries.
    pub fn success_rate(&self) -> Option<SuccessRate> {
        let mut newest = self.iter().rev();
        let (last, before) = (newest.next()?, newest.next()?);
        Some(SuccessRate::of_log(
            before.state.control_command_success_rate,
            before.state.message_id,
            last.state.message_id,
        ))
    }

    /// Returns the log as a table with one row per cycle and times in milliseconds, or an empty
    /// string for an empty log. Column names and number format are as in `franka::logToCSV` of
    /// libfranka 0.21.
    pub fn to_csv(&self) -> String {
        let mut text = String::new();
        if !self.is_empty() {
            csv(self.iter(), &mut text).expect("a string takes any text");
        }
        text
    }

    /// Adds a state. If the log is full, the state replaces the oldest entry.
    pub(super) fn note_state(&mut self, state: &RobotState) {
        let Some(entry) = self.entries.get_mut(self.next) else {
            return; // No capacity.
        };
        entry.state = *state;
        self.next = (self.next + 1) % self.entries.len();
        self.len = (self.len + 1).min(self.capacity());
    }

    /// Notes the newest command, which belongs to the next state. Call it after each state, because
    /// the entry may still contain an older command.
    pub(super) fn note_command(&mut self, command: &RobotCommand) {
        if let Some(entry) = self.entries.get_mut(self.next) {
            entry.command = *command;
        }
    }
}

/// Collects the entries into a log that has no room for more.
impl FromIterator<LogEntry> for ControlLog {
    fn from_iter<T: IntoIterator<Item = LogEntry>>(entries: T) -> Self {
        let mut entries: Vec<LogEntry> = entries.into_iter().collect();
        let len = entries.len();
        if len > 0 {
            entries.push(LogEntry::default());
        }
        Self {
            entries: entries.into(),
            next: len,
            len,
            rounded: false,
        }
    }
}

impl PartialEq for ControlLog {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl fmt::Debug for ControlLog {
    /// Prints only the times of the cycles, because entries contain pages of numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let times = |entry: &LogEntry| entry.state.message_id;
        f.debug_struct("ControlLog")
            .field("len", &self.len)
            .field("first", &self.iter().next().map(times))
            .field("last", &self.iter().next_back().map(times))
            .finish()
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for ControlLog {
    /// Serializes the entries as a sequence, oldest first.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for ControlLog {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut entries = Vec::<LogEntry>::deserialize(deserializer)?;
        let len = entries.len();
        if len > 0 {
            entries.push(LogEntry::default());
        }
        Ok(Self {
            next: len,
            len,
            entries: entries.into(),
            rounded: false,
        })
    }
}

/// A group of columns: its name, and a function that returns its numbers.
type Columns = (&'static str, fn(&LogEntry) -> &[f64]);

const COLUMNS: [Columns; 11] = [
    ("state.q", |entry| &entry.state.q),
    ("state.q_d", |entry| &entry.state.q_d),
    ("state.dq", |entry| &entry.state.dq),
    ("state.dq_d", |entry| &entry.state.dq_d),
    ("state.tau_J", |entry| &entry.state.tau_J),
    ("state.tau_ext_hat_filtered", |entry| {
        &entry.state.tau_ext_hat_filtered
    }),
    ("cmd.q_d", |entry| &entry.command.q_c),
    ("cmd.dq_d", |entry| &entry.command.dq_c),
    ("cmd.O_T_EE_d", |entry| &entry.command.O_T_EE_c),
    ("cmd.O_dP_EE_d", |entry| &entry.command.O_dP_EE_c),
    ("cmd.tau_J_d", |entry| &entry.command.tau_J_d),
];

fn csv<'a>(entries: impl Iterator<Item = &'a LogEntry>, to: &mut impl fmt::Write) -> fmt::Result {
    let shape = LogEntry::default();
    write!(to, "time,success_rate")?;
    for (name, numbers) in COLUMNS {
        for index in 0..numbers(&shape).len() {
            write!(to, ",{name}[{index}]")?;
        }
    }
    writeln!(to)?;
    for entry in entries {
        let rate = General(entry.state.control_command_success_rate);
        write!(to, "{},{rate}", entry.state.message_id)?;
        for number in COLUMNS.iter().flat_map(|(_, numbers)| numbers(entry)) {
            write!(to, ",{}", General(*number))?;
        }
        writeln!(to)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(capacity: usize, times: core::ops::RangeInclusive<u64>) -> ControlLog {
        let mut log = ControlLog::with_capacity(capacity);
        for time in times {
            let state = RobotState {
                message_id: time,
                control_command_success_rate: 0.25,
                ..RobotState::default()
            };
            let command = RobotCommand {
                message_id: time - 1,
                ..RobotCommand::default()
            };
            log.note_command(&command);
            log.note_state(&state);
        }
        log
    }

    #[test]
    fn holds_the_newest_cycles_oldest_first() {
        for (capacity, pushed, expected) in [
            (5, 11, vec![7, 8, 9, 10, 11]),
            (5, 5, vec![1, 2, 3, 4, 5]),
            (5, 3, vec![1, 2, 3]),
            (1, 3, vec![3]),
            (0, 3, vec![]),
        ] {
            let log = log(capacity, 1..=pushed);
            assert_eq!(log.iter().copied().collect::<ControlLog>(), log);
            let times = |entry: &LogEntry| entry.state.message_id;
            assert_eq!(log.iter().map(times).collect::<Vec<_>>(), expected);
            assert_eq!((log.len(), log.capacity()), (expected.len(), capacity));
            assert!(
                log.iter()
                    .all(|entry| entry.command.message_id + 1 == entry.state.message_id)
            );
            let backwards: Vec<_> = log.iter().rev().map(times).collect();
            assert!(backwards.iter().rev().eq(&expected));
        }
    }

    #[test]
    fn the_success_rate_is_that_of_the_last_but_one() {
        assert_eq!(log(50, 1..=1).success_rate(), None);
        assert_eq!(log(1, 1..=9).success_rate(), None);
        let mut log = log(3, 1..=4);
        let last = RobotState {
            message_id: 8,
            ..RobotState::default()
        };
        log.note_state(&last);
        let rate = log.success_rate().unwrap();
        assert_eq!(rate.lost, 3);
        assert!((rate.rate - 0.25 * 0.97).abs() < 1e-15);
    }

    #[test]
    fn the_table_has_a_header_and_a_row_per_cycle() {
        assert_eq!(ControlLog::with_capacity(50).to_csv(), "");
        let text = log(50, 1..=2).to_csv();
        let lines: Vec<_> = text.split('\n').collect();
        assert_eq!(lines.len(), 4, "two rows below the header, each ended");
        assert_eq!(lines[3], "");
        assert!(lines[0].starts_with("time,success_rate,state.q[0],state.q[1],"));
        assert!(lines[0].contains(",state.tau_ext_hat_filtered[6],cmd.q_d[0],"));
        assert!(lines[0].ends_with(",cmd.O_dP_EE_d[5],cmd.tau_J_d[0],cmd.tau_J_d[1],cmd.tau_J_d[2],cmd.tau_J_d[3],cmd.tau_J_d[4],cmd.tau_J_d[5],cmd.tau_J_d[6]"));
        let columns = |line: &str| line.split(',').count();
        assert_eq!(columns(lines[0]), 2 + 6 * 7 + 2 * 7 + 16 + 6 + 7);
        assert_eq!(columns(lines[0]), columns(lines[1]));
        assert!(lines[2].starts_with("2,0.25,0,0,"));
    }
}
