//! Explains why a motion ended, from a series of cycles or from the log of an error.
//!
//! ```text
//! cycles ──> Explainer ──> timeline, margins, peaks, losses, the last second
//! events ──────┤                │
//! errors ──────┘                ├─> cause (franka_diagnosis)
//!                               └─> place of the contact (franka_model::contact)
//! Explanation ──> Display: a report    ──> figure(): SVG of the last second
//! ```
//!
//! | module | contents |
//! |---|---|
//! | `explainer` | processes cycles and events |
//! | `timeline` | changes and their times |
//! | `margins` | the smallest distance from each limit, and peaks |
//! | `place` | the contact when the motion ended |
//! | `report` | the text |
//! | `figure`, `polyline`, `sketch` | the figure: curves with few points, and the arm with the contact |
//!
//! The module explains the last motion that the robot stopped, a guard aborted, or a lost link
//! ended. Without such a motion, it explains the time up to the newest cycle. The robot's clock
//! starts again when the robot restarts. The module then explains the newest run in which such a
//! motion ended, or the newest run if no run has such a motion. The memory use is bounded,
//! regardless of the number of cycles.
//!
//! # Example
//!
//! ```
//! use franka_model::Model;
//! use franka_proto::RobotState;
//! use franka_record::explain::Explainer;
//!
//! let mut explainer = Explainer::new(Model::fr3());
//! for message_id in 1..=100 {
//!     explainer.push_state(&RobotState { message_id, ..RobotState::default() });
//! }
//! let explanation = explainer.finish();
//! assert_eq!(explanation.cycles, 100);
//! assert!(explanation.cause.is_none());
//! println!("{explanation}");
//! ```

mod explainer;
mod figure;
mod margins;
mod place;
mod polyline;
mod report;
mod sketch;
#[cfg(test)]
mod tests;
mod timeline;

use core::time::Duration;

use franka_diagnosis::{Case, Diagnosis};
use franka_model::{Model, RobotKind};
use franka_proto::Errors;
use franka_rt::lifecycle::ControlError;

use crate::control_log::ControlLogFile;
use crate::recording::{RecordingError, RobotRecording};
use crate::{Cycle, Event, HostTime, ModelFallback, RecordedModel};

pub use explainer::Explainer;
pub use margins::{Approach, Margins, Peak, Peaks};
pub use place::{Place, Placed};
pub use timeline::{Moment, MomentKind};

/// Explanation of a series of cycles. The `Display` implementation writes a report of one page.
///
/// All times are on the robot's clock, in milliseconds. They are the `message_id` of states.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Explanation {
    /// Kind of the robot.
    pub robot: RobotKind,
    /// Reason why constants replace the limits of the robot's description; `None` if the limits
    /// come from the description.
    pub fallback: Option<ModelFallback>,
    /// Time of the first cycle.
    pub first: u64,
    /// Time of the last cycle.
    pub last: u64,
    /// Number of cycles.
    pub cycles: u64,
    /// Time of the cycle that shows the end of the explained motion. This is the last motion that
    /// the robot stopped, a guard aborted or a lost link ended. If a guard aborted it, the time is
    /// the cycle in which the arm came to a stop. Without such a motion, it is the last cycle.
    pub end: u64,
    /// Time at which this host received the cycle at [`end`](Self::end); `None` if the source has
    /// no such time. A log has none.
    pub received: Option<HostTime>,
    /// Number of the newest goal whose end was not recorded, if no motion ended.
    pub under_way: Option<u64>,
    /// Result text of the last goal, if the goal failed without a reflex, for example after a user
    /// stop or at an obstacle.
    pub failed: Option<String>,
    /// Number of earlier motions that the robot stopped, a guard aborted or a lost link ended.
    pub earlier: u64,
    /// Reason why the explained motion ended; `None` if no motion ended.
    pub cause: Option<Cause>,
    /// Changes up to half a second after the end, oldest first. The timeline contains at most
    /// [`MOMENTS_MAX`] changes.
    pub timeline: Vec<Moment>,
    /// Number of changes for which the timeline had no space.
    pub moments_left_out: u64,
    /// Smallest distance from each limit, up to half a second after the end.
    pub margins: Margins,
    /// Largest values, up to half a second after the end.
    pub peaks: Peaks,
    /// The contact at the end of the motion; `None` without cycles.
    pub contact: Option<Place>,
    /// States that were lost.
    pub lost: Lost,
    /// Commands that left after the next state was due.
    pub late: Late,
    /// Cycles of the last second before the end, for the figure.
    pub last_second: Vec<Trace>,
}

/// Reason why a motion ended.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cause {
    /// Errors that the robot reported; empty if a guard or a lost link ended the motion.
    pub errors: Errors,
    /// The exceeded limit and its causes. `None` if the commands of the motion are unknown, for
    /// example if a recording contains no diagnosis event.
    pub diagnosis: Option<Diagnosis>,
    /// The diagnosis as text. Without a diagnosis, the other known facts.
    pub text: String,
}

/// States that did not arrive, or that arrived too late to be answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Lost {
    /// Total number of lost states.
    pub states: u64,
    /// Largest number of consecutive lost states.
    pub most_in_a_row: u64,
    /// Time of the cycle before the longest run of lost states.
    pub most_at: u64,
    /// Number of lost states in the last second before the end.
    pub in_last_second: u64,
}

/// Commands that left this computer too late. Their times are known only in recordings of a robot,
/// but not in logs and not under active control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Late {
    /// Number of late commands.
    pub commands: u64,
    /// Largest delay of a command, measured from the time at which the next state was due.
    pub most: Duration,
    /// Time of the state that the command with the largest delay answered.
    pub at: u64,
    /// Time from the arrival of this state to the departure of its command.
    pub turnaround: Duration,
}

/// One cycle of the last second before the end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trace {
    /// Time of the state.
    pub time: u64,
    /// Number of states lost directly before this state.
    pub lost: u64,
    /// Measured joint positions, `[rad]`.
    pub q: [f64; 7],
    /// Joint velocity divided by the limit in its direction, in `[-1, 1]`.
    pub speed: [f64; 7],
    /// Torque that the environment exerts on each joint, minus the baseline without contact,
    /// `[N·m]`.
    pub external: [f64; 7],
    /// Joint torque divided by its limit, in `[-1, 1]`.
    pub torque: [f64; 7],
    /// Largest measured joint velocity, `[rad/s]`.
    pub fastest: f64,
    /// Norm of the estimated force at the stiffness frame, `[N]`. The robot computes the estimate.
    pub force: f64,
}

impl Explanation {
    /// Explains cycles and events. Both must be sorted by time, oldest first.
    pub fn of(
        cycles: impl IntoIterator<Item = Cycle>,
        events: impl IntoIterator<Item = Event>,
        model: &Model,
    ) -> Self {
        let cycles = cycles.into_iter().map(Ok);
        Self::of_readable(cycles, events.into_iter().map(Ok), model)
    }

    /// Explains the recording of one robot, or a time range of it, with its
    /// [model](RobotRecording::model). Unreadable data is skipped and mentioned in the timeline.
    pub fn of_recording(recording: &RobotRecording<'_>, model: &RecordedModel) -> Self {
        let RecordedModel { model, fallback } = model;
        Self {
            fallback: fallback.clone(),
            ..Self::of_readable(recording.cycles(), recording.events(), model)
        }
    }

    fn of_readable(
        cycles: impl Iterator<Item = Result<Cycle, RecordingError>>,
        events: impl Iterator<Item = Result<Event, RecordingError>>,
        model: &Model,
    ) -> Self {
        let mut explainer = Explainer::new(model);
        let take = |explainer: &mut Explainer<'_>, event| match event {
            Ok(event) => explainer.push_event(&event),
            Err(error) => explainer.note_unread(&error),
        };
        let mut events = events.peekable();
        for cycle in cycles {
            let cycle = match cycle {
                Ok(cycle) => cycle,
                Err(error) => {
                    explainer.note_unread(&error);
                    continue;
                }
            };
            let is_before = |event: &Result<Event, _>| match event {
                Ok(event) => event.time < cycle.time,
                Err(_) => true,
            };
            while let Some(event) = events.next_if(is_before) {
                take(&mut explainer, event);
            }
            explainer.push(&cycle);
        }
        events.for_each(|event| take(&mut explainer, event));
        explainer.finish()
    }

    /// Explains an error from its log. The log contains the last cycles of the motion.
    pub fn of_error(error: &ControlError) -> Self {
        Self::of_case(&Case::from(error), &error.model)
    }

    /// Explains a saved log. The result always contains a cause, even if the log does not show one.
    pub fn of_case(case: &Case, model: &Model) -> Self {
        let mut explainer = Explainer::new(model);
        for entry in case.log.iter() {
            explainer.push_state(&entry.state);
        }
        let cause = || {
            let diagnosis = Diagnosis::of(case, model);
            Cause {
                errors: case.errors,
                text: diagnosis.to_string(),
                diagnosis: Some(diagnosis),
            }
        };
        Self {
            cause: (!case.errors.is_empty()).then(cause),
            ..explainer.finish()
        }
    }

    /// Explains a log of libfranka. If the file does not name the errors, the explanation covers
    /// the table and reports that the errors are missing. The constants of [`Model::fr3`] count as
    /// a fallback, because a log contains no description of the robot.
    pub fn of_control_log(file: &ControlLogFile, model: &Model) -> Self {
        let case = file.case();
        let mut explanation = Self::of_case(&case, model);
        explanation.fallback = (model == Model::fr3()).then_some(ModelFallback::Missing);
        explanation.earlier = file.earlier;
        let message = file.message.as_ref().map_or("", |message| &message.text);
        let cause = explanation.cause.get_or_insert_with(|| Cause {
            errors: Errors::NONE,
            diagnosis: None,
            text: match message {
                "" => UNNAMED.to_owned(),
                text => text.to_owned(),
            },
        });
        if let Some(rate) = file.message.as_ref().and_then(|it| it.success_rate) {
            cause.text += &rate.to_string();
        }
        explanation
    }

    /// Returns the last second before the end as an SVG image. The image shows contact torques,
    /// velocities and torques relative to their limits, events, and the place of the contact on the
    /// arm.
    ///
    /// The image has no background. Its colours are easy to distinguish on white and on black.
    pub fn figure(&self) -> String {
        figure::draw(self)
    }
}

/// Text of the cause if the file contains a table but no exception text.
const UNNAMED: &str = "the file does not name the errors: paste the text of the exception, which \
    names them, into the file";

/// Largest number of moments in a timeline.
pub const MOMENTS_MAX: usize = 500;
