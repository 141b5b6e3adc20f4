//! What a recording holds beside the cycles.

use core::fmt;
use core::time::Duration;

use franka_proto::{Errors, RobotMode, gripper, vacuum};
use franka_rt::session::Guard;
use nalgebra::Isometry3;

use crate::HostTime;

/// Something that happened, and when.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When this host had word of it.
    pub time: HostTime,
    /// The robot's clock of the newest cycle before it, `[ms]`. If there was none, that of when the
    /// robot was attached; 0 if that is not known.
    pub robot_time: u64,
    /// What happened.
    pub kind: EventKind,
}

/// What happened. Changes of the robot's mode and errors, drops and steps of the clock are found by
/// the recorder itself.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// A goal was given.
    Goal(Goal),
    /// A goal came to its end.
    Outcome(Outcome),
    /// No state has come for this long.
    LinkLost {
        /// The silence so far.
        silence: Duration,
    },
    /// States come again.
    LinkRestored {
        /// How long none came.
        silence: Duration,
    },
    /// The robot's mode changed.
    Mode {
        /// The mode before.
        from: RobotMode,
        /// The mode now.
        to: RobotMode,
    },
    /// The errors that hold changed.
    Errors {
        /// Those that hold now.
        errors: Errors,
        /// Those that ended the last motion.
        reflex_reason: Errors,
    },
    /// A request to the robot or its gripper was answered.
    Request(Request),
    /// Why a motion ended, and what to change.
    Diagnosis(Diagnosis),
    /// An episode begins.
    EpisodeStart {
        /// Its name.
        name: String,
        /// What is to be done, in words.
        task: String,
    },
    /// The episode ends.
    EpisodeEnd {
        /// True if the task was done; `None` if nobody judged it.
        success: Option<bool>,
    },
    /// A remark of the program, the user or the recorder.
    Note(Note),
    /// Cycles for which the recorder had no room.
    Dropped {
        /// How many, since the last such event.
        cycles: u64,
    },
    /// The wall clock of this host was set; recorded times go on from where they were.
    ClockStep {
        /// The wall clock minus recorded time, `[ns]`.
        by: i64,
    },
}

/// A goal that was given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Goal {
    /// Its number, as in [`Record::goal`](franka_rt::driver::Record::goal); 0 where it has none.
    pub number: u64,
    /// What was called: `move_to`, `follow`, `control_torques`, ...
    pub kind: String,
    /// Where it ends, if that was known when it was given.
    pub target: Option<Target>,
    /// Its options, as text.
    pub options: String,
}

/// Where a goal ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Joint positions, `[rad]`.
    Joints([f64; 7]),
    /// Pose of the end effector in the base frame, `[m]`.
    Pose(Isometry3<f64>),
}

/// How a goal came to its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Number of the goal; 0 where it has none.
    pub goal: u64,
    /// How it ended.
    pub ending: Ending,
    /// What the caller was told.
    pub text: String,
    /// From the first cycle that saw the goal to its end, if it ran.
    pub duration: Option<Duration>,
}

/// How a goal came to its end, in one word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ending {
    /// It arrived, or came to the end that it was given.
    Arrived,
    /// A newer goal took over.
    Superseded,
    /// It was asked to stop, or dropped.
    Stopped,
    /// The robot stopped itself.
    Reflex,
    /// The robot fell silent.
    LinkLost,
    /// A guard of the driver gave it up.
    Guard(Guard),
    /// It never began, or a target of its stream was refused.
    Rejected,
    /// Anything else.
    #[default]
    Failed,
}

impl Ending {
    /// Whether the black box is written for it: a reflex, a lost link, or a guard that gave the
    /// motion up.
    pub fn is_incident(self) -> bool {
        matches!(self, Self::Reflex | Self::LinkLost | Self::Guard(_))
    }
}

impl fmt::Display for Ending {
    /// Words with hyphens, fit for the name of a file.
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

/// The name of a guard in lower case, words joined by hyphens.
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
    /// What was called: `set_load`, `gripper.grasp`, ...
    pub name: String,
    /// Its arguments, as JSON.
    pub arguments: String,
    /// Why it was not done; `None` if it was.
    pub error: Option<String>,
}

/// Why a motion ended, and what to change.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnosis {
    /// Number of the goal; 0 where it has none.
    pub goal: u64,
    /// The diagnosis as text.
    pub text: String,
    /// The same as JSON; empty without.
    pub json: String,
}

/// A remark.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Note {
    /// How much it matters.
    pub level: Level,
    /// Who says it.
    pub source: String,
    /// What it says.
    pub text: String,
}

/// How much a remark matters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// For finding defects.
    Debug,
    /// For whoever is interested.
    #[default]
    Info,
    /// Something may need attention.
    Warning,
    /// Something went wrong.
    Error,
}

/// A state of a gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GripperState {
    /// Of a Hand.
    Hand(gripper::State),
    /// Of a vacuum gripper.
    Vacuum(vacuum::State),
}

impl fmt::Display for EventKind {
    /// One line for people.
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
                write!(f, "states come again after {silence:.1?}")
            }
            Self::Mode { from, to } => write!(f, "robot mode {from} -> {to}"),
            Self::Errors {
                errors,
                reflex_reason,
            } => write!(f, "errors {errors}, of the last motion {reflex_reason}"),
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
            Self::Dropped { cycles } => write!(f, "{cycles} cycles not recorded: no room"),
            Self::ClockStep { by } => write!(
                f,
                "the clock of this host was set: it is {:.3} s from recorded time",
                *by as f64 * 1e-9
            ),
        }
    }
}

impl EventKind {
    /// How much it matters.
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

    /// True if the black box is written for it.
    pub fn is_incident(&self) -> bool {
        match self {
            Self::Outcome(outcome) => outcome.ending.is_incident(),
            _ => false,
        }
    }

    /// True if the cycles around it are kept at the full rate where others are thinned out.
    pub(crate) fn is_notable(&self) -> bool {
        match self {
            Self::LinkRestored { .. } | Self::Dropped { .. } | Self::Errors { .. } => true,
            Self::Request(_) => false,
            other => other.level() == Level::Error,
        }
    }

    /// Who or what it is about, for the `name` of a log.
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
