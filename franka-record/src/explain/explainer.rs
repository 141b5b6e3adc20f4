//! Processes cycles and events in sequence.

use core::mem;
use std::collections::VecDeque;

use franka_diagnosis::Diagnosis;
use franka_model::contact::Tare;
use franka_model::{JointVector, Model};
use franka_proto::{Errors, RobotState};
use franka_rt::driver::Record;
use franka_rt::stats::Slack;

use super::timeline::{AFTER, Timeline};
use super::{Cause, Explanation, Late, Lost, Margins, MomentKind, Peaks, Trace, place};
use crate::event::Ending;
use crate::recording::RecordingError;
use crate::{Cycle, Event, EventKind, HostTime};

/// Builds an [`Explanation`] from consecutive cycles.
#[derive(Clone, Debug)]
pub struct Explainer<'a> {
    model: &'a Model,
    /// Data since the last start of the robot.
    run: Run,
    /// The newest earlier run in which a motion ended; `None` if no motion ended before.
    before: Option<Run>,
    /// Number of motions that ended.
    ends: u64,
}

/// Data of one run, which starts when the robot starts. The robot's clock does not restart within a
/// run.
#[derive(Clone, Debug, Default)]
struct Run {
    tare: Tare,
    timeline: Timeline,
    margins: Margins,
    peaks: Peaks,
    lost: Lost,
    late: Late,
    /// Traces of the newest cycles, up to the end of the motion.
    window: VecDeque<Trace>,
    /// Errors that ended the last motion, as the newest cycle reports them.
    reflex_reason: Option<Errors>,
    ended: Option<Ended>,
    first: Option<u64>,
    last: u64,
    /// Time at which this host received the newest cycle, if known.
    received: Option<HostTime>,
    /// Goals that have begun but not ended, oldest first. The flag is true for a goal that consists
    /// of chunks.
    open: Vec<(u64, bool)>,
    /// Result text of the goal that ended last, if it failed.
    failed: Option<String>,
    cycles: u64,
    has_hand: bool,
    diagnosis: Option<Told>,
}

/// A recorded diagnosis and its time.
#[derive(Clone, Debug)]
struct Told {
    time: u64,
    diagnosis: Option<Diagnosis>,
    text: String,
}

/// The newest end of a motion that the robot stopped, a guard aborted or a lost link ended.
#[derive(Clone, Debug)]
struct Ended {
    time: u64,
    received: Option<HostTime>,
    errors: Errors,
    /// The reason as text, if it is known without a diagnosis.
    text: String,
    window: VecDeque<Trace>,
    tared: f64,
    /// Distances to the limits until the arm came to a stop.
    margins: Margins,
    peaks: Peaks,
}

impl<'a> Explainer<'a> {
    /// Creates an explainer for the cycles of a robot with this model.
    pub fn new(model: &'a Model) -> Self {
        Self {
            model,
            run: Run::default(),
            before: None,
            ends: 0,
        }
    }

    /// Processes the next cycle. Ignores the cycle if its robot time equals the robot time of the
    /// last cycle. If its robot time is earlier, the robot was restarted.
    pub fn push(&mut self, cycle: &Cycle) {
        self.take(Some(cycle.time), &cycle.state, Some(&cycle.record));
    }

    /// Processes a state without a driver record, like [`Self::push`].
    pub fn push_state(&mut self, state: &RobotState) {
        self.take(None, state, None);
    }

    /// Processes an event that occurred after the cycles so far. Pass goals, outcomes, notes and
    /// diagnoses. The explainer itself finds changes of the mode and the errors in the cycles.
    pub fn push_event(&mut self, event: &Event) {
        self.ends += u64::from(self.run.event(event));
    }

    pub(super) fn note_unread(&mut self, error: &RecordingError) {
        let text = format!("part of the recording cannot be read: {error}");
        self.run.note(text);
    }

    fn take(&mut self, received: Option<HostTime>, state: &RobotState, record: Option<&Record>) {
        let time = state.message_id;
        if self.run.first.is_some() && time < self.run.last {
            let text = format!("the robot was restarted: its clock continues at {time} ms");
            self.run.note(text);
            let run = mem::take(&mut self.run);
            if run.ended.is_some() {
                self.before = Some(run);
            }
        } else if self.run.first.is_some() && time == self.run.last {
            return;
        }
        self.run.received = received;
        self.ends += u64::from(self.run.take(self.model, state, record));
    }

    /// Returns the explanation of all processed data.
    pub fn finish(self) -> Explanation {
        let run = match self.before {
            Some(before) if self.run.ended.is_none() => before,
            _ => self.run,
        };
        let earlier = self.ends.saturating_sub(1);
        Explanation {
            earlier,
            ..run.explained(self.model)
        }
    }
}

impl Run {
    fn note(&mut self, text: String) {
        self.timeline.add(self.last, MomentKind::Note, text);
    }

    /// Processes an event. Returns true if the event reports the end of a motion.
    fn event(&mut self, event: &Event) -> bool {
        if let EventKind::Diagnosis(diagnosis) = &event.kind {
            self.diagnosis = Some(Told {
                time: event.robot_time,
                diagnosis: read(&diagnosis.json),
                text: diagnosis.text.clone(),
            });
        }
        self.timeline.event(event, self.first.unwrap_or_default());
        // If the link is lost, several goals end, including later requests. Only the first end
        // counts.
        let is_told = self.ended.as_ref().is_some_and(|it| it.time == self.last);
        match &event.kind {
            EventKind::Goal(goal) if goal.number > 0 => {
                let is_chunk = goal.kind == "chunk";
                // The goal of the first chunk represents all later chunks.
                if !(is_chunk && self.open.iter().any(|(_, is_chunk)| *is_chunk)) {
                    self.open.retain(|(open, _)| *open != goal.number);
                    self.open.push((goal.number, is_chunk));
                }
                false
            }
            EventKind::Outcome(outcome) => {
                self.open.retain(|(open, _)| *open != outcome.goal);
                let failed = outcome.ending == Ending::Failed;
                self.failed = failed.then(|| outcome.text.clone());
                // The cycles already show ends that the robot caused.
                if outcome.ending == Ending::Reflex || !outcome.ending.is_incident() || is_told {
                    return false;
                }
                let mut text = outcome.text.clone();
                if text.is_empty() {
                    text = outcome.ending.to_string();
                }
                if outcome.ending == Ending::LinkLost {
                    text += "\ncheck the cable, the switch and the power of the robot";
                }
                self.end(Errors::NONE, text);
                true
            }
            _ => false,
        }
    }

    /// Processes a state that is newer than the last state. Returns true if the state shows the end
    /// of a motion.
    fn take(&mut self, model: &Model, state: &RobotState, record: Option<&Record>) -> bool {
        let time = state.message_id;
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
        if let Some(record) = record
            && let Some(overrun) = record.slack.and_then(Slack::overrun)
        {
            self.late.commands += 1;
            if overrun > self.late.most {
                (self.late.most, self.late.at) = (overrun, time);
                self.late.turnaround = record.turnaround;
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
        self.margins.cycle(model, state);
        self.peaks.cycle(state, record, &external);
        self.last = time;
        self.window.push_back(trace(model, state, lost, &external));
        while self.window.front().is_some_and(|t| time - t.time >= SPAN) {
            self.window.pop_front();
        }
        let errors = state.reflex_reason;
        // An error that the first cycle already shows ended an earlier motion.
        let before = self.reflex_reason.replace(errors).unwrap_or(errors);
        let ended = errors != before && !errors.is_empty();
        if ended {
            self.end(errors, format!("the robot stopped: {errors}"));
        }
        if let Some(ended) = &mut self.ended
            && time.saturating_sub(ended.time) <= AFTER
        {
            (ended.margins, ended.peaks) = (self.margins, self.peaks);
        }
        ended
    }

    /// Keeps the data of the last second before the end of a motion.
    fn end(&mut self, errors: Errors, text: String) {
        self.ended = Some(self.end_now(errors, text));
        self.timeline.ended(self.last);
    }

    fn end_now(&self, errors: Errors, text: String) -> Ended {
        Ended {
            time: self.last,
            received: self.received,
            errors,
            text,
            window: self.window.clone(),
            tared: self.tare.learned(),
            margins: self.margins,
            peaks: self.peaks,
        }
    }

    fn explained(mut self, model: &Model) -> Explanation {
        let (ended, is_over) = match self.ended.take() {
            Some(ended) => (ended, true),
            None => (self.end_now(Errors::NONE, String::new()), false),
        };
        let traces: Vec<_> = ended.window.into();
        let noticed = self.timeline.noticed();
        let contact = place::of(model, self.has_hand, &traces, ended.tared, noticed);
        let (timeline, moments_left_out) = self.timeline.finish();
        let cause = is_over.then(|| {
            // An older diagnosis belongs to another motion.
            let told = self.diagnosis.filter(|told| told.time >= ended.time);
            let (diagnosis, text) = match told {
                Some(told) => (told.diagnosis, told.text),
                None => (None, ended.text),
            };
            Cause {
                errors: ended.errors,
                diagnosis,
                text,
            }
        });
        Explanation {
            robot: model.kind(),
            fallback: None,
            first: self.first.unwrap_or_default(),
            last: self.last,
            cycles: self.cycles,
            end: ended.time,
            received: ended.received,
            under_way: self.open.last().map(|(goal, _)| *goal).filter(|_| !is_over),
            failed: self.failed,
            earlier: 0,
            cause,
            timeline,
            moments_left_out,
            margins: ended.margins,
            peaks: ended.peaks,
            contact,
            lost: Lost {
                in_last_second: traces.iter().skip(1).map(|trace| trace.lost).sum(),
                ..self.lost
            },
            late: self.late,
            last_second: traces,
        }
    }
}

fn trace(model: &Model, state: &RobotState, lost: u64, external: &JointVector) -> Trace {
    let limits = model.joint_limits();
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

#[cfg(feature = "serde")]
fn read(json: &str) -> Option<Diagnosis> {
    serde_json::from_str(json).ok()
}

/// Recorded diagnoses are parsed only with the feature `serde`; the text is available without it.
#[cfg(not(feature = "serde"))]
fn read(_: &str) -> Option<Diagnosis> {
    None
}

/// Length of the period before the end for which data is kept, `[ms]`.
const SPAN: u64 = 1000;

/// Mass below which the flange counts as empty, `[kg]`. Above this mass, a Hand is assumed.
const BARE: f64 = 0.05;
