//! What happened, and why: of a series of cycles, or of the log of an error.
//!
//! ```text
//! cycles ──> Explainer ──> timeline, margins, peaks, losses, the last second
//! events ──────┤                │
//! errors ──────┘                ├─> cause (franka_diagnosis)
//!                               └─> place of the contact (franka_model::contact)
//! Explanation ──> Display: a report    ──> figure(): SVG of the last second
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `explainer` | cycles and events, one after the other |
//! | `timeline` | what changed, and when |
//! | `margins` | the nearest approach to each limit, and peaks |
//! | `place` | the contact when the motion ended |
//! | `report` | the text |
//! | `figure`, `polyline`, `sketch` | the figure: curves with few points, and the arm with the contact |
//!
//! What ended is the last motion that the robot stopped, a guard gave up or a lost link ended; if
//! none did, it is the newest cycle. A robot that is started again counts its time anew: what is
//! explained is then the newest run with such an end, or else the newest. Memory is bounded,
//! however many cycles there are.
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
use crate::{Cycle, Event, HostTime};

pub use explainer::Explainer;
pub use margins::{Approach, Margins, Peak, Peaks};
pub use place::{Place, Placed};
pub use timeline::{Moment, MomentKind};

/// What happened in a series of cycles. `Display` is a report of a page.
///
/// Times are the robot's clock, `[ms]`: the `message_id` of states.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Explanation {
    /// The robot.
    pub robot: RobotKind,
    /// The first cycle.
    pub first: u64,
    /// The last cycle.
    pub last: u64,
    /// How many there were.
    pub cycles: u64,
    /// The cycle that shows the end of the last motion that the robot stopped, a guard gave up or
    /// a lost link ended, of a guard that in which the arm rested; without one, the last cycle.
    pub end: u64,
    /// When this host had that cycle; `None` if that is not known, as in a log.
    pub received: Option<HostTime>,
    /// The newest goal whose end was not recorded, where nothing has ended a motion.
    pub under_way: Option<u64>,
    /// What the last goal that failed of itself said, as after a user stop or at an obstacle;
    /// `None` if the last one did not fail.
    pub failed: Option<String>,
    /// How many such ends came before.
    pub earlier: u64,
    /// Why that motion ended; `None` without such an end.
    pub cause: Option<Cause>,
    /// What changed, oldest first, [`MOMENTS_MAX`] at most: until the end and half a second after
    /// it.
    pub timeline: Vec<Moment>,
    /// Changes for which the timeline had no room.
    pub moments_left_out: u64,
    /// The nearest approach to each limit, until half a second after the end.
    pub margins: Margins,
    /// The largest values, until half a second after the end.
    pub peaks: Peaks,
    /// Where something touched the arm as the motion ended; `None` without cycles.
    pub contact: Option<Place>,
    /// States that were lost.
    pub lost: Lost,
    /// Commands that left after the next state was due.
    pub late: Late,
    /// The cycles before the end, for the figure.
    pub last_second: Vec<Trace>,
}

/// Why a motion ended.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cause {
    /// What the robot named; none where a guard or a lost link ended the motion.
    pub errors: Errors,
    /// Which limit was exceeded, and what led up to it; `None` where the commands of the motion are
    /// not known, as in a recording without the event that has the diagnosis.
    pub diagnosis: Option<Diagnosis>,
    /// The diagnosis, or what is known without one, as text.
    pub text: String,
}

/// States that did not come, or came too late to be answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Lost {
    /// In all.
    pub states: u64,
    /// The most in a row.
    pub most_in_a_row: u64,
    /// After which cycle those were missing.
    pub most_at: u64,
    /// In the second before the end.
    pub in_last_second: u64,
}

/// Commands that left this computer too late, where it is known when they did: in recordings of a
/// robot, not in logs and not under active control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Late {
    /// How many.
    pub commands: u64,
    /// The most by which one left after the next state was due.
    pub most: Duration,
    /// Which state that one answers.
    pub at: u64,
    /// From when its state was there to when it left.
    pub turnaround: Duration,
}

/// One cycle of the last second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trace {
    /// Of the state.
    pub time: u64,
    /// States lost before it.
    pub lost: u64,
    /// Measured, `[rad]`.
    pub q: [f64; 7],
    /// Velocity over the limit in its direction, -1 to 1.
    pub speed: [f64; 7],
    /// What the environment exerts on the joints, less the tare, `[N·m]`.
    pub external: [f64; 7],
    /// Torque over its limit, -1 to 1.
    pub torque: [f64; 7],
    /// Greatest measured joint velocity, `[rad/s]`.
    pub fastest: f64,
    /// Norm of the robot's estimate of the force at the stiffness frame, `[N]`.
    pub force: f64,
}

impl Explanation {
    /// Of cycles and events, each oldest first.
    pub fn of(
        cycles: impl IntoIterator<Item = Cycle>,
        events: impl IntoIterator<Item = Event>,
        model: &Model,
    ) -> Self {
        let cycles = cycles.into_iter().map(Ok);
        Self::of_readable(cycles, events.into_iter().map(Ok), model)
    }

    /// Of one robot of a recording, or of a part of its time. What cannot be read is left out and
    /// noted in the timeline.
    pub fn of_recording(recording: &RobotRecording<'_>, model: &Model) -> Self {
        Self::of_readable(recording.cycles(), recording.events(), model)
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

    /// Of the log of an error, which holds the last cycles of its motion.
    pub fn of_error(error: &ControlError) -> Self {
        Self::of_case(&Case::from(error), &error.model)
    }

    /// Of a log that was saved. The cause is there whether or not the log shows it.
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

    /// Of a log of libfranka. A file without the errors explains what its table shows, and says
    /// that they are missing.
    pub fn of_control_log(file: &ControlLogFile, model: &Model) -> Self {
        let case = file.case();
        let mut explanation = Self::of_case(&case, model);
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

    /// The last second before the end as an SVG image: what touched the arm, velocities and torques
    /// against their limits, what happened when, and where on the arm the contact was.
    ///
    /// It has no background, and colours that can be told apart on white and on black.
    pub fn figure(&self) -> String {
        figure::draw(self)
    }
}

/// Of a table without the text of its exception.
const UNNAMED: &str = "the file does not name the errors: they are in the text of the exception, \
                       which may be pasted into it";

/// Moments that a timeline holds.
pub const MOMENTS_MAX: usize = 500;
