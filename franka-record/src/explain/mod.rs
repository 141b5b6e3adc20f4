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
//! | `timeline` | what changed, and when |
//! | `margins` | the nearest approach to each limit, and peaks |
//! | `place` | the contact when the motion ended |
//! | `report` | the text |
//! | `figure`, `polyline`, `sketch` | the figure: curves with few points, and the arm with the contact |
//!
//! What ended is the last motion that the robot stopped; without such a stop, it is the newest
//! cycle. Memory is bounded, however many cycles there are.
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

mod figure;
mod margins;
mod place;
mod polyline;
mod report;
mod sketch;
#[cfg(test)]
mod tests;
mod timeline;

use std::collections::VecDeque;

use franka_diagnosis::{Case, Diagnosis};
use franka_model::contact::Tare;
use franka_model::{JointVector, Model, RobotKind};
use franka_proto::{Errors, RobotState};
use franka_rt::driver::Record;
use franka_rt::lifecycle::ControlError;

use crate::recording::{RecordingError, RobotRecording};
use crate::{Cycle, Event, EventKind};

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
    /// The cycle that shows the end of the last motion that the robot stopped; without one, the
    /// last cycle.
    pub end: u64,
    /// Why the robot stopped; `None` if it did not.
    pub cause: Option<Cause>,
    /// What changed, oldest first, [`MOMENTS_MAX`] at most.
    pub timeline: Vec<Moment>,
    /// Changes for which the timeline had no room.
    pub moments_left_out: u64,
    /// The nearest approach to each limit.
    pub margins: Margins,
    /// The largest values.
    pub peaks: Peaks,
    /// Where something touched the arm as the motion ended; `None` without cycles.
    pub contact: Option<Place>,
    /// States that were lost.
    pub lost: Lost,
    /// The cycles before the end, for the figure.
    pub last_second: Vec<Trace>,
}

/// Why the robot stopped.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cause {
    /// What the robot named.
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

/// Makes an [`Explanation`] of cycles, one after the other.
#[derive(Clone, Debug)]
pub struct Explainer<'a> {
    model: &'a Model,
    tare: Tare,
    timeline: timeline::Timeline,
    margins: Margins,
    peaks: Peaks,
    lost: Lost,
    /// Of the newest cycles, until the end.
    window: VecDeque<Trace>,
    ended: Option<Ended>,
    first: Option<u64>,
    last: u64,
    cycles: u64,
    has_hand: bool,
    diagnosis: Option<Told>,
}

/// A diagnosis, and when it was made.
#[derive(Clone, Debug)]
struct Told {
    time: u64,
    diagnosis: Option<Diagnosis>,
    text: String,
}

/// The newest end of a motion.
#[derive(Clone, Debug)]
struct Ended {
    time: u64,
    errors: Errors,
    window: VecDeque<Trace>,
    tared: f64,
    /// Whether the robot still shows it.
    holds: bool,
}

impl<'a> Explainer<'a> {
    /// For cycles of a robot of this model.
    pub fn new(model: &'a Model) -> Self {
        Self {
            model,
            tare: Tare::new(),
            timeline: timeline::Timeline::default(),
            margins: Margins::default(),
            peaks: Peaks::default(),
            lost: Lost::default(),
            window: VecDeque::new(),
            ended: None,
            first: None,
            last: 0,
            cycles: 0,
            has_hand: false,
            diagnosis: None,
        }
    }

    /// Takes in the next cycle. One that is not newer than the last is left out.
    pub fn push(&mut self, cycle: &Cycle) {
        self.take(&cycle.state, Some(&cycle.record));
    }

    /// Takes in a state of which nothing else is known.
    pub fn push_state(&mut self, state: &RobotState) {
        self.take(state, None);
    }

    /// Takes in an event: goals, outcomes, notes and the diagnosis of an error. Changes of mode and
    /// errors are found in the cycles.
    pub fn push_event(&mut self, event: &Event) {
        if let EventKind::Diagnosis(diagnosis) = &event.kind {
            self.diagnosis = Some(Told {
                time: event.robot_time,
                diagnosis: read(&diagnosis.json),
                text: diagnosis.text.clone(),
            });
        }
        self.timeline.event(event);
    }

    fn note_unread(&mut self, error: &RecordingError) {
        let text = format!("part of the recording cannot be read: {error}");
        self.timeline.add(self.last, MomentKind::Note, text);
    }

    fn take(&mut self, state: &RobotState, record: Option<&Record>) {
        let time = state.message_id;
        if self.first.is_some() && time <= self.last {
            return;
        }
        let lost = match self.first {
            Some(_) => time - self.last - 1,
            None => 0,
        };
        self.first.get_or_insert(time);
        self.cycles += 1;
        if lost > 0 {
            self.lost.states += lost;
            if lost > self.lost.most_in_a_row {
                self.lost.most_in_a_row = lost;
                self.lost.most_at = self.last;
            }
        }
        self.has_hand = state.m_ee > BARE;
        let dq = JointVector::from(state.dq);
        let torque = -JointVector::from(state.tau_ext_hat_filtered);
        let passed = if self.cycles > 1 {
            (1 + lost) as f64 * 1e-3
        } else {
            0.0
        };
        let external = self.tare.update(&torque, &dq, passed);
        self.timeline.cycle(state, record, lost);
        self.margins.cycle(self.model, state);
        self.peaks.cycle(state, record, &external);
        self.last = time;

        let trace = self.trace(state, lost, &external);
        self.window.push_back(trace);
        while self.window.front().is_some_and(|t| time - t.time >= SPAN) {
            self.window.pop_front();
        }
        self.note_end(state);
    }

    fn trace(&self, state: &RobotState, lost: u64, external: &JointVector) -> Trace {
        let limits = self.model.joint_limits();
        let (least, greatest) = limits.velocity_envelope(&state.q.into(), 0.0);
        let share = |value: f64, limit: f64| {
            if limit.abs() > 0.0 {
                value / limit.abs()
            } else {
                0.0
            }
        };
        let [x, y, z, ..] = state.O_F_ext_hat_K;
        Trace {
            time: state.message_id,
            lost,
            q: state.q,
            speed: std::array::from_fn(|i| {
                let v = state.dq[i];
                share(v, if v < 0.0 { least[i] } else { greatest[i] })
            }),
            external: (*external).into(),
            torque: std::array::from_fn(|i| share(state.tau_J[i], limits.torque[i])),
            fastest: state.dq.iter().fold(0.0, |most: f64, v| most.max(v.abs())),
            force: nalgebra::Vector3::new(x, y, z).norm(),
        }
    }

    /// Keeps the window of the first state that shows why the last motion was ended.
    fn note_end(&mut self, state: &RobotState) {
        let errors = state.reflex_reason;
        match &mut self.ended {
            Some(ended) if ended.holds && ended.errors == errors => {}
            Some(ended) if errors.is_empty() => ended.holds = false,
            // A recording that begins after a reflex shows no end.
            _ if self.cycles == 1 && !errors.is_empty() => {
                self.ended = None;
            }
            _ if errors.is_empty() => {}
            _ => {
                self.ended = Some(Ended {
                    time: state.message_id,
                    errors,
                    window: self.window.clone(),
                    tared: self.tare.learned(),
                    holds: true,
                });
            }
        }
    }

    /// The explanation of all that was taken in.
    pub fn finish(self) -> Explanation {
        let stopped = self.ended.is_some();
        let ended = self.ended.unwrap_or(Ended {
            time: self.last,
            errors: Errors::NONE,
            window: self.window,
            tared: self.tare.learned(),
            holds: false,
        });
        let traces: Vec<_> = ended.window.into();
        let contact = place::of(self.model, self.has_hand, &traces, ended.tared);
        let (timeline, moments_left_out) = self.timeline.finish();
        let cause = stopped.then(|| {
            // One that is older is of another motion.
            let told = self.diagnosis.filter(|told| told.time >= ended.time);
            let (diagnosis, text) = match told {
                Some(told) => (told.diagnosis, told.text),
                None => (None, format!("the robot stopped: {}", ended.errors)),
            };
            Cause {
                errors: ended.errors,
                diagnosis,
                text,
            }
        });
        Explanation {
            robot: self.model.kind(),
            first: self.first.unwrap_or_default(),
            last: self.last,
            cycles: self.cycles,
            end: ended.time,
            cause,
            timeline,
            moments_left_out,
            margins: self.margins,
            peaks: self.peaks,
            contact,
            lost: Lost {
                in_last_second: traces.iter().skip(1).map(|trace| trace.lost).sum(),
                ..self.lost
            },
            last_second: traces,
        }
    }
}

impl Explanation {
    /// Of cycles, oldest first, and events.
    pub fn of(cycles: impl IntoIterator<Item = Cycle>, events: &[Event], model: &Model) -> Self {
        let mut explainer = Explainer::new(model);
        for cycle in cycles {
            explainer.push(&cycle);
        }
        for event in events {
            explainer.push_event(event);
        }
        explainer.finish()
    }

    /// Of one robot of a recording, or of a part of its time. What cannot be read is left out and
    /// noted in the timeline.
    pub fn of_recording(recording: &RobotRecording<'_>, model: &Model) -> Self {
        let mut explainer = Explainer::new(model);
        for cycle in recording.cycles() {
            match cycle {
                Ok(cycle) => explainer.push(&cycle),
                Err(error) => explainer.note_unread(&error),
            }
        }
        for event in recording.events() {
            match event {
                Ok(event) => explainer.push_event(&event),
                Err(error) => explainer.note_unread(&error),
            }
        }
        explainer.finish()
    }

    /// Of the log of an error, which holds the last cycles of its motion.
    pub fn of_error(error: &ControlError) -> Self {
        Self::of_case(&Case::from(error), &error.model)
    }

    /// Of a log that was saved.
    pub fn of_case(case: &Case, model: &Model) -> Self {
        let mut explainer = Explainer::new(model);
        for entry in case.log.iter() {
            explainer.push_state(&entry.state);
        }
        let diagnosis = Diagnosis::of(case, model);
        let text = diagnosis.to_string();
        explainer.diagnosis = Some(Told {
            time: explainer.last,
            diagnosis: Some(diagnosis),
            text: text.clone(),
        });
        let mut explanation = explainer.finish();
        // A motion may be ended without a reason in the states: preempted, or the user stop.
        if explanation.cause.is_none() && !case.errors.is_empty() {
            explanation.cause = Some(Cause {
                errors: case.errors,
                diagnosis: None,
                text,
            });
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

/// A diagnosis that was recorded.
#[cfg(feature = "serde")]
fn read(json: &str) -> Option<Diagnosis> {
    serde_json::from_str(json).ok()
}

/// Recorded diagnoses are read with the feature `serde`; the text is there without.
#[cfg(not(feature = "serde"))]
fn read(_: &str) -> Option<Diagnosis> {
    None
}

/// How much of the time before the end is kept, `[ms]`.
const SPAN: u64 = 1000;

/// Below this mass, `[kg]`, nothing is taken to be on the flange; above it is taken for a Hand.
const BARE: f64 = 0.05;

/// Moments that a timeline holds.
pub const MOMENTS_MAX: usize = 500;
