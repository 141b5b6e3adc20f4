//! Cycles without a command.

use core::ops::Range;

use franka_proto::RobotError;

use super::cause::Cause;
use super::evidence::{Evidence, is_lost};
use super::finding::{Bound, Finding, Origin, Quantity, Subject};

/// Largest number of consecutive lost cycles that a motion survives. The robot ends a motion after
/// 20 lost cycles (FCI documentation, `communication_constraints_violation`).
const LOST_LIMIT: f64 = 19.0;

/// Number of cycles after a loss in which the loss can affect a command. A jerk is a difference
/// over two commands.
const BEFORE: u64 = 2;

/// Cycles without a command, oldest first. Each cycle is identified by the state whose answer is
/// missing.
struct Losses {
    states: u64,
    commands: u64,
    unanswered: u64,
    cycles: Vec<u64>,
    success_rate: f64,
}

impl Losses {
    /// Collects the losses in the cycles `within`.
    fn of(evidence: &Evidence<'_>, starved: bool, within: Range<u64>) -> Self {
        let mut losses = Self {
            states: 0,
            commands: 0,
            unanswered: 0,
            cycles: Vec::new(),
            success_rate: evidence
                .last_running()
                .map_or(0.0, |state| state.control_command_success_rate),
        };
        // A state that is not in the log did not arrive, unless the counts of the motion show
        // skipped states.
        let skips = evidence
            .statistics
            .is_some_and(|counts| counts.lost_states == 0 && counts.skipped_states > 0);
        for pair in evidence.entries.windows(2) {
            let (before, command, after) = (&pair[0].state, &pair[1].command, &pair[1].state);
            let (id, next) = (before.message_id, after.message_id);
            let is_within = id < within.end && next > within.start;
            if next <= id || !before.motion_running() || !is_within {
                continue;
            }
            let missing = next - id - 1;
            let ends = !after.motion_running();
            // A thread that is delayed while it answers a state skips the states that arrive
            // meanwhile.
            let skipped = if skips { missing } else { 0 };
            if command.message_id == 0 {
                // The robot waits until it receives the first command.
            } else if command.message_id != id {
                // While the robot plans between two targets, no commands are needed.
                if evidence.commander.commands_every_cycle() {
                    losses.unanswered += 1;
                    losses.cycles.push(id);
                }
            } else if is_lost(before, after, skipped)
                || (ends && starved && missing == skipped)
                // No command has reached the robot in time yet.
                || (!ends && starved && after.control_command_success_rate == 0.0)
            {
                losses.commands += 1;
                losses.cycles.push(id);
            }
            losses.states += missing - skipped;
            losses.unanswered += skipped;
            losses.cycles.extend(id + 1..next);
        }
        losses
    }

    /// Returns the length and the first cycle of the longest run of losses.
    fn longest(&self) -> Option<(u64, u64)> {
        let mut longest = None;
        let mut run = (0, 0);
        for &cycle in &self.cycles {
            run = match run {
                (length, first) if length > 0 && first + length == cycle => (length + 1, first),
                _ => (1, cycle),
            };
            if longest.is_none_or(|(length, _)| run.0 > length) {
                longest = Some(run);
            }
        }
        longest
    }

    fn cause(&self) -> Option<Cause> {
        let (longest_run, _) = self.longest()?;
        Some(Cause::LostPackets {
            states: self.states,
            commands: self.commands,
            unanswered: self.unanswered,
            longest_run,
            first: *self.cycles.first()?,
            last: *self.cycles.last()?,
            success_rate: self.success_rate,
        })
    }
}

/// Returns the longest run of cycles without a command, if the robot stopped because of it.
pub(super) fn starvation(evidence: &Evidence<'_>) -> Option<Finding> {
    let (length, first) = Losses::of(evidence, true, 0..u64::MAX).longest()?;
    Some(Finding {
        error: RobotError::CommunicationConstraintsViolation,
        subject: Subject::Arm,
        quantity: Quantity::LostCycles,
        origin: Origin::Measured,
        // Cycles after the cycle that ended the motion do not count.
        value: (length as f64).min(LOST_LIMIT + 1.0),
        bound: Bound::AtMost(LOST_LIMIT),
        since: first,
    })
}

/// Returns the losses in the log, if the robot stopped because of missing commands. In this case,
/// the last command did not reach the robot either.
pub(super) fn lost_packets(evidence: &Evidence<'_>) -> Option<Cause> {
    Losses::of(evidence, true, 0..u64::MAX).cause()
}

/// Returns the consecutive losses directly before the wrong command. If this command is unknown,
/// returns the losses in the log. The robot extrapolates missing commands, and the next command may
/// jump relative to the extrapolation.
pub(super) fn lost_before(evidence: &Evidence<'_>, finding: Option<&Finding>) -> Option<Cause> {
    let Some(Finding { since, .. }) = finding else {
        return Losses::of(evidence, false, 0..u64::MAX).cause();
    };
    let losses = Losses::of(evidence, false, 0..*since);
    let last = losses.cycles.iter().rev().find(|cycle| *cycle < since);
    let mut first = *last.filter(|last| *last + BEFORE >= *since)?;
    while first > 0 && losses.cycles.contains(&(first - 1)) {
        first -= 1;
    }
    Losses::of(evidence, false, first..*since).cause()
}

/// Returns the late commands of the whole motion.
pub(super) fn late_commands(evidence: &Evidence<'_>) -> Option<Cause> {
    let statistics = evidence.statistics?;
    (statistics.overruns > 0).then_some(Cause::LateCommands {
        count: statistics.overruns,
        worst_turnaround: statistics.worst_turnaround,
    })
}
