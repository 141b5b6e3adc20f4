//! Log data, prepared for the checks.

use franka_model::{JointVector, Model};
use franka_proto::{MotionGeneratorMode, RobotCommand, RobotError, RobotState};

use super::finding::{Bound, Finding, Origin, Quantity, Subject};
use franka_rt::driver::Commander;
use franka_rt::driver::LogEntry;
use franka_rt::stats::MotionStatistics;

/// Evidence for a diagnosis: a log that is prepared for the checks.
pub(super) struct Evidence<'a> {
    pub(super) commander: Commander,
    /// Cycles, oldest first.
    pub(super) entries: Vec<&'a LogEntry>,
    pub(super) model: &'a Model,
    pub(super) statistics: Option<&'a MotionStatistics>,
    /// True if the numbers of the log have six significant digits.
    pub(super) rounded: bool,
}

/// A command and the state that it answers.
#[derive(Clone, Copy)]
pub(super) struct Sample<'a> {
    pub(super) before: &'a RobotState,
    pub(super) command: &'a RobotCommand,
    pub(super) first: bool,
}

/// A number in one cycle, and its limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub(super) subject: Subject,
    pub(super) quantity: Quantity,
    pub(super) origin: Origin,
    pub(super) value: f64,
    pub(super) bound: Bound,
    /// Ratio of the number to its limit; above 1 if the limit is exceeded.
    pub(super) score: f64,
    pub(super) cycle: u64,
}

impl<'a> Evidence<'a> {
    /// Returns the newest state, which shows the end of the motion.
    pub(super) fn last(&self) -> Option<&'a RobotState> {
        self.entries.last().map(|entry| &entry.state)
    }

    /// Returns all states, oldest first.
    pub(super) fn states(&self) -> impl DoubleEndedIterator<Item = &'a RobotState> {
        self.entries.iter().map(|entry| &entry.state)
    }

    /// Returns the newest state in which the motion was still running.
    pub(super) fn last_running(&self) -> Option<&'a RobotState> {
        self.states().rev().find(|state| state.motion_running())
    }

    /// Returns the motion generator of the motion. In protocol 5, a torque motion also has a
    /// generator, whose commands are at rest.
    pub(super) fn generator(&self) -> MotionGeneratorMode {
        self.last_running()
            .map_or(MotionGeneratorMode::Idle, |state| {
                state.motion_generator_mode
            })
    }

    /// Returns true if the motion was commanded with poses or twists.
    pub(super) fn is_cartesian(&self) -> bool {
        matches!(
            self.generator(),
            MotionGeneratorMode::CartesianPosition | MotionGeneratorMode::CartesianVelocity
        )
    }

    /// Returns the commands that reached the robot (according to its success rate), if the log
    /// contains the state that they answer. Compute differences from the commanded values in this
    /// state, because these values include the robot's extrapolation over cycles without a command.
    pub(super) fn samples(&self) -> impl DoubleEndedIterator<Item = Sample<'a>> {
        self.entries.windows(2).filter_map(|pair| {
            let (before, command) = (&pair[0].state, &pair[1].command);
            let answers = command.message_id == before.message_id && before.motion_running();
            (answers && !is_lost(before, &pair[1].state, 0)).then_some(Sample {
                before,
                command,
                first: pair[0].command.message_id == 0,
            })
        })
    }

    /// Returns the command that answers the state whose `message_id` is `cycle`.
    pub(super) fn sample(&self, cycle: u64) -> Option<Sample<'a>> {
        self.samples().find(|sample| sample.cycle() == cycle)
    }

    /// Returns the first command of the motion, if the log contains it.
    pub(super) fn first(&self) -> Option<Sample<'a>> {
        self.samples().find(|sample| sample.first)
    }
}

impl Sample<'_> {
    pub(super) fn cycle(&self) -> u64 {
        self.before.message_id
    }

    pub(super) fn is_finished(&self) -> bool {
        self.command.motion_generation_finished || self.command.torque_command_finished
    }
}

impl Reading {
    /// Returns the same reading for a value that rounding can have changed by `error`. The score is
    /// then relative to a limit that is larger by this amount.
    pub(super) fn within(self, error: f64) -> Self {
        let limit = self.bound.limit().unwrap_or(0.0).abs();
        let share = if error > 0.0 {
            limit / (limit + error)
        } else {
            1.0
        };
        Self {
            score: self.score * share,
            ..self
        }
    }

    /// Returns a reading of a number whose magnitude is limited.
    pub(super) fn magnitude(
        subject: Subject,
        quantity: Quantity,
        origin: Origin,
        value: f64,
        limit: f64,
        cycle: u64,
    ) -> Self {
        let ratio = value.abs() / limit.abs();
        let bound = if value < 0.0 {
            Bound::AtLeast(-limit.abs())
        } else {
            Bound::AtMost(limit.abs())
        };
        Self {
            subject,
            quantity,
            origin,
            value,
            bound,
            // Zero does not violate a limit of zero.
            score: if ratio.is_nan() { 0.0 } else { ratio },
            cycle,
        }
    }

    /// Returns the finding for a reading at the end of the motion.
    pub(super) fn finding(&self, error: RobotError) -> Finding {
        Finding {
            error,
            subject: self.subject,
            quantity: self.quantity,
            origin: self.origin,
            value: self.value,
            bound: self.bound,
            since: self.cycle,
        }
    }
}

/// Returns true if the command between two states did not reach the robot in time, according to the
/// robot's success rate. `skipped` is the number of unanswered states between the two states. The
/// success rate of the state that ends the motion is not considered.
pub(super) fn is_lost(before: &RobotState, after: &RobotState, skipped: u64) -> bool {
    // The rate covers the last 100 cycles.
    let rate = before.control_command_success_rate - skipped as f64 / 100.0;
    after.message_id == before.message_id + 1 + skipped
        && after.motion_running()
        && after.control_command_success_rate < rate - SAME_RATE
}

/// Returns the readings of every joint's velocity, relative to its limit at `q`.
pub(super) fn velocities(
    model: &Model,
    origin: Origin,
    q: &JointVector,
    dq: &JointVector,
    cycle: u64,
) -> Vec<Reading> {
    let (lower, upper) = model.joint_limits().velocity_envelope(q, 0.0);
    (0..7)
        .map(|i| {
            let limit = if dq[i] < 0.0 { lower[i] } else { upper[i] };
            let subject = Subject::joint(i);
            Reading::magnitude(subject, Quantity::Velocity, origin, dq[i], limit, cycle)
        })
        .collect()
}

/// Returns the readings of every joint's position, relative to the nearer end of its range.
pub(super) fn positions(
    model: &Model,
    origin: Origin,
    q: &JointVector,
    cycle: u64,
) -> Vec<Reading> {
    let limits = model.joint_limits();
    (0..7)
        .map(|i| {
            let (below, above) = (limits.hard_lower[i] - q[i], q[i] - limits.hard_upper[i]);
            let (beyond, bound) = if below > above {
                (below, Bound::AtLeast(limits.hard_lower[i]))
            } else {
                (above, Bound::AtMost(limits.hard_upper[i]))
            };
            Reading {
                subject: Subject::joint(i),
                quantity: Quantity::Position,
                origin,
                value: q[i],
                bound,
                score: 1.0 + beyond / SCALE,
                cycle,
            }
        })
        .collect()
}

/// Returns the finding for the worst of some sensor readings, which are given oldest first. The
/// finding contains the first of the consecutive cycles in which the limit was exceeded. `None` if
/// no reading is near its limit.
pub(super) fn worst(error: RobotError, readings: &[Reading]) -> Option<Finding> {
    let worst = readings
        .iter()
        .filter(|reading| reading.score >= VISIBLE)
        .max_by(|a, b| a.score.total_cmp(&b.score))?;
    Some(since_first(error, worst, readings))
}

/// Returns the finding for readings of commands. The robot stops at the first command that exceeds
/// a limit, so the newest reading above its limit counts. If no reading is certain to exceed its
/// limit, the newest reading near its limit counts.
pub(super) fn newest(error: RobotError, readings: &[Reading]) -> Option<Finding> {
    let last = |least: f64| {
        let cycle = readings
            .iter()
            .rev()
            .find(|reading| reading.score > least)?
            .cycle;
        let of_cycle = readings.iter().filter(|reading| reading.cycle == cycle);
        of_cycle.max_by(|a, b| a.score.total_cmp(&b.score))
    };
    let newest = last(1.0).or_else(|| last(VISIBLE))?;
    Some(since_first(error, newest, readings))
}

fn since_first(error: RobotError, worst: &Reading, readings: &[Reading]) -> Finding {
    let mut since = worst.cycle;
    let earlier = |reading: &&Reading| {
        reading.cycle < worst.cycle
            && reading.quantity == worst.quantity
            && reading.subject.is_like(worst.subject)
    };
    for reading in readings.iter().rev().filter(earlier) {
        if reading.score <= 1.0 {
            break;
        }
        since = reading.cycle;
    }
    Finding {
        since,
        ..worst.finding(error)
    }
}

impl Subject {
    /// Returns true if both subjects are the same part. Components of the same vector count as the
    /// same part.
    fn is_like(self, other: Self) -> bool {
        match (self, other) {
            (Self::Translation(_), Self::Translation(_))
            | (Self::Rotation(_), Self::Rotation(_)) => true,
            (a, b) => a == b,
        }
    }
}

/// Share of a limit at which the limit counts as reached. The single precision of the states
/// changes a third difference by up to a twentieth of its limit, and the robot's own computation is
/// not published.
const VISIBLE: f64 = 0.95;

/// Scale that turns the distance of a position from its limit into a score, `[rad]`. With
/// [`VISIBLE`], a position counts as near its limit within half a hundredth of a radian.
const SCALE: f64 = 0.1;

/// Largest difference between success rates that count as equal. One command in a hundred changes
/// the rate by 0.01, and rates have at least single precision.
const SAME_RATE: f64 = 1e-4;
