//! The contents of a recording in addition to the cycles.

use core::fmt;
use core::time::Duration;

use franka_proto::{Errors, RobotMode, gripper, vacuum};
use franka_rt::session::Guard;
use nalgebra::Isometry3;

use crate::HostTime;

/// An event and its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Time at which this host was notified.
    pub time: HostTime,
    /// The robot's clock of the newest cycle before it, `[ms]`. Without such a cycle, the clock at
    /// the time when the robot was attached; 0 if unknown.
    pub robot_time: u64,
    /// The kind of event.
    pub kind: EventKind,
}

/// The kind of event. The recorder itself detects changes of the robot's mode and errors, drops,
/// and steps of the clock.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// A goal was set.
    Goal(Goal),
    /// A goal ended.
    Outcome(Outcome),
    /// No state has arrived for this duration.
    LinkLost {
        /// The silence so far.
        silence: Duration,
    },
    /// States arrive again.
    LinkRestored {
        /// Duration without states.
        silence: Duration,
    },
    /// The robot's mode changed.
    Mode {
        /// The previous mode.
        from: RobotMode,
        /// The current mode.
        to: RobotMode,
    },
    /// The current errors changed.
    Errors {
        /// The current errors.
        errors: Errors,
        /// The errors that ended the last motion.
        reflex_reason: Errors,
    },
    /// A request to the robot or its gripper was answered.
    Request(Request),
    /// The reason for the end of a motion, and recommended changes.
    Diagnosis(Diagnosis),
    /// An episode begins.
    EpisodeStart {
        /// Its name.
        name: String,
        /// Description of the task.
        task: String,
    },
    /// The episode ends.
    EpisodeEnd {
        /// True if the task succeeded; `None` if it was not judged.
        success: Option<bool>,
    },
    /// A remark of the program, the user or the recorder.
    Note(Note),
    /// The recorder had no space for some cycles.
    Dropped {
        /// Number of cycles since the last such event.
        cycles: u64,
    },
    /// The wall clock of this host was set; recorded times continue unchanged.
    ClockStep {
        /// The wall clock minus recorded time, `[ns]`.
        by: i64,
    },
}

/// A goal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Goal {
    /// Its number, as in [`Record::goal`](franka_rt::driver::Record::goal); 0 if it has none.
    pub number: u64,
    /// The called method: `move_to`, `follow`, `control_torques`, ...
    pub kind: String,
    /// Its end, if known when the goal was set.
    pub target: Option<Target>,
    /// Its options, as text.
    pub options: String,
}

/// The end of a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Joint positions, `[rad]`.
    Joints([f64; 7]),
    /// Pose of the end effector in the base frame, `[m]`.
    Pose(Isometry3<f64>),
}

/// The outcome of a goal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Number of the goal; 0 if it has none.
    pub goal: u64,
    /// The kind of ending.
    pub ending: Ending,
    /// The text of the result.
    pub text: String,
    /// Time from the first cycle with the goal to its end, if it ran.
    pub duration: Option<Duration>,
}

/// The kind of a goal's ending, in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ending {
    /// The goal arrived, or reached its own end condition.
    Arrived,
    /// A newer goal took over.
    Superseded,
    /// The goal was stopped or dropped.
    Stopped,
    /// The robot stopped itself.
    Reflex,
    /// The robot fell silent.
    LinkLost,
    /// A guard of the driver aborted the goal.
    Guard(Guard),
    /// The goal never began, or a target of its stream was refused.
    Rejected,
    /// Anything else.
    #[default]
    Failed,
}

impl Ending {
    /// True if this ending triggers the black box: a reflex, a lost link, or a guard that aborted
    /// the motion.
    pub fn is_incident(self) -> bool {
        matches!(self, Self::Reflex | Self::LinkLost | Self::Guard(_))
    }
}

impl fmt::Display for Ending {
    /// Formats as words with hyphens, valid in file names.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Arrived => f.write_str("arrived"),
            Self::Superseded => f.write_str("superseded"),
            Self::Stopped => f.write_str("stopped"),
            Self::Reflex => f.write_str("reflex"),
            Self::LinkLost => f.write_str("link-lost"),
            Self::Guard(guard) => write!(f, "guard-{}", guard_name(*guard)),
            Self::Rejected => f.write_str("rejected"),
            Self::Failed => f.write_str("failed"),
        }
    }
}

/// Returns the name of a guard in lower case, with words joined by hyphens.
fn guard_name(guard: Guard) -> String {
    let mut name = String::new();
    for letter in format!("{guard:?}").chars() {
        if letter.is_ascii_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

/// A request to the robot or its gripper, and its answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The called method: `set_load`, `gripper.grasp`, ...
    pub name: String,
    /// Its arguments, as JSON.
    pub arguments: String,
    /// The reason for the failure; `None` if it succeeded.
    pub error: Option<String>,
}

/// The reason for the end of a motion, and recommended changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnosis {
    /// Number of the goal; 0 if it has none.
    pub goal: u64,
    /// The diagnosis as text.
    pub text: String,
    /// The same as JSON; empty without.
    pub json: String,
}

/// A remark.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Note {
    /// Its severity.
    pub level: Level,
    /// Its source.
    pub source: String,
    /// Its text.
    pub text: String,
}

/// The severity of a remark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// For debugging.
    Debug,
    /// For information.
    #[default]
    Info,
    /// A condition that may need attention.
    Warning,
    /// An error.
    Error,
}

/// A state of a gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GripperState {
    /// State of a Hand.
    Hand(gripper::State),
    /// State of a vacuum gripper.
    Vacuum(vacuum::State),
}

impl fmt::Display for EventKind {
    /// Formats as one line for people.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Goal(goal) => match goal.target {
                Some(Target::Joints(q)) => write!(f, "{} to {q:.4?} rad", goal.kind),
                Some(Target::Pose(pose)) => {
                    let [x, y, z]: [f64; 3] = pose.translation.vector.into();
                    write!(f, "{} to {x:.4}, {y:.4}, {z:.4} m", goal.kind)
                }
                None => f.write_str(&goal.kind),
            },
            Self::Outcome(Outcome { ending, text, .. }) => {
                write!(f, "{ending}")?;
                if text.is_empty() {
                    Ok(())
                } else {
                    write!(f, ": {text}")
                }
            }
            Self::LinkLost { silence } => write!(f, "no state for {silence:.1?}"),
            Self::LinkRestored { silence } => {
                write!(f, "states arrive again after {silence:.1?}")
            }
            Self::Mode { from, to } => write!(f, "robot mode {from} -> {to}"),
            Self::Errors {
                errors,
                reflex_reason,
            } => write!(
                f,
                "errors: {errors}; errors of the last motion: {reflex_reason}"
            ),
            Self::Request(request) => {
                write!(f, "{}({})", request.name, request.arguments)?;
                match &request.error {
                    Some(error) => write!(f, " failed: {error}"),
                    None => Ok(()),
                }
            }
            Self::Diagnosis(diagnosis) => f.write_str(&diagnosis.text),
            Self::EpisodeStart { name, task } => write!(f, "episode {name} begins: {task}"),
            Self::EpisodeEnd { success } => match success {
                Some(true) => f.write_str("episode ends with success"),
                Some(false) => f.write_str("episode ends without success"),
                None => f.write_str("episode ends"),
            },
            Self::Note(note) => f.write_str(&note.text),
            Self::Dropped { cycles } => write!(
                f,
                "{cycles} cycles not recorded: the buffer was \
                full"
            ),
            Self::ClockStep { by } => write!(
                f,
                "the clock of this computer was set: it differs from recorded time by {:.3} s",
                *by as f64 * 1e-9
            ),
        }
    }
}

impl EventKind {
    /// Returns its severity.
    pub fn level(&self) -> Level {
        match self {
            Self::Outcome(Outcome { ending, .. }) => match ending {
                Ending::Arrived | Ending::Superseded | Ending::Stopped => Level::Info,
                Ending::Reflex
                | Ending::LinkLost
                | Ending::Guard(_)
                | Ending::Rejected
                | Ending::Failed => Level::Error,
            },
            Self::LinkLost { .. } => Level::Error,
            Self::Errors { errors, .. } if !errors.is_empty() => Level::Error,
            Self::Request(request) if request.error.is_some() => Level::Error,
            Self::Diagnosis(_) | Self::Dropped { .. } | Self::ClockStep { .. } => Level::Warning,
            Self::Note(note) => note.level,
            _ => Level::Info,
        }
    }

    /// True if this event triggers the black box.
    pub fn is_incident(&self) -> bool {
        match self {
            Self::Outcome(outcome) => outcome.ending.is_incident(),
            _ => false,
        }
    }

    /// True if the surrounding cycles are kept at the full rate when others are thinned out.
    pub(crate) fn is_notable(&self) -> bool {
        match self {
            Self::LinkRestored { .. } | Self::Dropped { .. } | Self::Errors { .. } => true,
            Self::Request(_) => false,
            other => other.level() == Level::Error,
        }
    }

    /// Returns the subject, for the `name` of a log.
    pub fn source(&self) -> &str {
        match self {
            Self::Goal(_) | Self::Outcome(_) => "motion",
            Self::LinkLost { .. } | Self::LinkRestored { .. } => "link",
            Self::Mode { .. } | Self::Errors { .. } => "robot",
            Self::Request(_) => "request",
            Self::Diagnosis(_) => "diagnosis",
            Self::EpisodeStart { .. } | Self::EpisodeEnd { .. } => "episode",
            Self::Note(note) => &note.source,
            Self::Dropped { .. } | Self::ClockStep { .. } => "recorder",
        }
    }
}
