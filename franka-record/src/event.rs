//! Events of a recording, and states of grippers.

use core::fmt;
use core::time::Duration;

use franka_proto::{Errors, RobotMode, gripper, vacuum};
use franka_rt::session::Guard;
use nalgebra::Isometry3;

use crate::HostTime;

/// An event and its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Time at which this host noticed the event.
    pub time: HostTime,
    /// Robot clock of the newest cycle before the event, `[ms]`. Before the first cycle, this is
    /// the robot clock at the time when the robot was attached to the recorder; 0 if unknown.
    pub robot_time: u64,
    /// The kind of event.
    pub kind: EventKind,
}

/// The kind of an event. The recorder itself detects changes of the robot's mode, changes of its
/// errors, dropped cycles, and clock steps.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EventKind {
    /// A goal was set.
    Goal(Goal),
    /// A goal ended.
    Outcome(Outcome),
    /// The link to the robot is lost, because no state has arrived for some time.
    LinkLost {
        /// Time since the newest state.
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
    /// The set of active errors changed.
    Errors {
        /// The errors that are active now.
        errors: Errors,
        /// The errors that ended the last motion.
        reflex_reason: Errors,
    },
    /// The robot or its gripper answered a request.
    Request(Request),
    /// The driver diagnosed why a motion ended, and recommends changes.
    Diagnosis(Diagnosis),
    /// An episode began.
    EpisodeStart {
        /// Name of the episode.
        name: String,
        /// Description of the task.
        task: String,
    },
    /// An episode ended.
    EpisodeEnd {
        /// True if the task succeeded, false if it failed; `None` if the attempt was not judged.
        success: Option<bool>,
    },
    /// A remark of the program, the user or the recorder.
    Note(Note),
    /// The recorder dropped some cycles, because it had no space for them.
    Dropped {
        /// Number of cycles dropped since the previous event of this kind.
        cycles: u64,
    },
    /// This host's wall clock was set. Recorded times do not change.
    ClockStep {
        /// Difference of the wall clock from recorded time, `[ns]`.
        by: i64,
    },
}

/// A goal: the task that one call such as `move_to` or `follow` sets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Goal {
    /// Number of the goal, as in [`Record::goal`](franka_rt::driver::Record::goal); 0 if the goal
    /// has no number.
    pub number: u64,
    /// Name of the method that set the goal, such as `move_to`, `follow` or `control_torques`.
    pub kind: String,
    /// Final position of the goal; `None` if it was not known when the goal was set.
    pub target: Option<Target>,
    /// Options of the goal, as text.
    pub options: String,
}

/// Final position of a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// Final joint positions, `[rad]`.
    Joints([f64; 7]),
    /// Final pose of the end effector in the base frame, `[m]`.
    Pose(Isometry3<f64>),
}

/// Time and kind of a goal's end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Number of the goal; 0 if the goal has no number.
    pub goal: u64,
    /// The way in which the goal ended.
    pub ending: Ending,
    /// The result of the goal as text.
    pub text: String,
    /// Time from the first cycle of the goal to its end; `None` if the goal never ran.
    pub duration: Option<Duration>,
}

/// The way in which a goal ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Ending {
    /// The goal reached its target or met its end condition.
    Arrived,
    /// A newer goal replaced the goal.
    Superseded,
    /// The program stopped or dropped the goal.
    Stopped,
    /// The robot stopped itself with a reflex.
    Reflex,
    /// No more states arrived from the robot.
    LinkLost,
    /// A guard (a safety check of the driver) aborted the goal.
    Guard(Guard),
    /// The goal never began, or the driver refused a target from the goal's stream.
    Rejected,
    /// The goal failed for any other reason.
    #[default]
    Failed,
}

impl Ending {
    /// Returns true if the black box writes a file after this ending. This is the case for a
    /// reflex, a lost link, and a guard that aborted the motion.
    pub fn is_incident(self) -> bool {
        matches!(self, Self::Reflex | Self::LinkLost | Self::Guard(_))
    }
}

impl fmt::Display for Ending {
    /// Formats the ending as words joined by hyphens, for use in file names.
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

/// Returns the name of a guard in lower case, as words joined by hyphens.
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

/// A request to the robot or its gripper, and the result of the request.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// Name of the method, such as `set_load` or `gripper.grasp`.
    pub name: String,
    /// Arguments of the method as JSON.
    pub arguments: String,
    /// Reason for the failure; `None` if the request succeeded.
    pub error: Option<String>,
}

/// An explanation of why a motion ended, and the recommended changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnosis {
    /// Number of the goal; 0 if the goal has no number.
    pub goal: u64,
    /// The diagnosis as text.
    pub text: String,
    /// The same diagnosis as JSON; empty if no JSON is available.
    pub json: String,
}

/// A remark of the program, the user or the recorder.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Note {
    /// Severity of the remark.
    pub level: Level,
    /// Source of the remark.
    pub source: String,
    /// Text of the remark.
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
    /// A condition that might need attention.
    Warning,
    /// An error.
    Error,
}

/// A state of a Franka Hand or of a vacuum gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GripperState {
    /// State of a Franka Hand.
    Hand(gripper::State),
    /// State of a vacuum gripper.
    Vacuum(vacuum::State),
}

impl fmt::Display for EventKind {
    /// Formats the state as one readable line.
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
    /// Returns the severity of the event.
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

    /// Returns true if the black box writes a file after this event.
    pub fn is_incident(&self) -> bool {
        match self {
            Self::Outcome(outcome) => outcome.ending.is_incident(),
            _ => false,
        }
    }

    /// Returns true if a thinned recording keeps the full rate near this event.
    pub(crate) fn is_notable(&self) -> bool {
        match self {
            Self::LinkRestored { .. } | Self::Dropped { .. } | Self::Errors { .. } => true,
            Self::Request(_) => false,
            other => other.level() == Level::Error,
        }
    }

    /// Returns the subject of the event, which becomes the `name` of a log message.
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
