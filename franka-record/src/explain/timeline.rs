//! Changes between consecutive cycles.

use franka_proto::{Errors, RobotMode, RobotState};
use franka_rt::driver::Record;
use franka_rt::session::Guard;

use super::MOMENTS_MAX;
use crate::event::{Goal, Outcome};
use crate::{Event, EventKind};

/// An event and its time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Moment {
    /// Time of the cycle on the robot's clock, `[ms]`.
    pub time: u64,
    /// The kind of event.
    pub kind: MomentKind,
    /// The text of the event.
    pub text: String,
}

/// Kinds of [`Moment`]s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MomentKind {
    /// A goal was set, began or ended.
    Goal,
    /// The robot's mode changed.
    Mode,
    /// An external torque or force passed its lower threshold.
    Contact,
    /// An external torque or force passed its upper threshold.
    Collision,
    /// Errors appeared or disappeared.
    Error,
    /// A guard of the driver became active.
    Guard,
    /// States were lost.
    Loss,
    /// Any other recorded event.
    Note,
}

/// Collects changes. A recurring condition is recorded when it appears for the first time, and when
/// it appears again after an absence of [`PAUSE`].
#[derive(Clone, Debug, Default)]
pub(super) struct Timeline {
    moments: Vec<Moment>,
    /// Number of moments.
    count: u64,
    mode: Option<RobotMode>,
    errors: Errors,
    reflex_reason: Errors,
    goal: u64,
    /// Time at which each joint's, axis's or guard's flag was last set.
    contacts: [Option<u64>; AXES],
    collisions: [Option<u64>; AXES],
    guards: [Option<u64>; Guard::ALL.len()],
    last_loss: Option<u64>,
    has_goals: bool,
    /// Time of the newest end of a motion. `until_end` contains the moments until shortly after it.
    end: Option<u64>,
    until_end: Option<Vec<Moment>>,
}

impl Timeline {
    pub(super) fn cycle(&mut self, state: &RobotState, record: Option<&Record>, lost: u64) {
        let time = state.message_id;
        if lost > 0 && appears(&mut self.last_loss, time) {
            let text = format!("{lost} states lost before this state");
            self.add(time, MomentKind::Loss, text);
        }
        let is_first = self.mode.is_none();
        if is_first {
            // The first goal may be set before the first cycle arrives.
            let moments = self.moments.iter_mut();
            moments.for_each(|moment| moment.time = moment.time.max(time));
        }
        if self.mode != Some(state.robot_mode) {
            let text = match self.mode {
                Some(mode) => format!("mode {mode} -> {}", state.robot_mode),
                None => format!("mode {}", state.robot_mode),
            };
            self.mode = Some(state.robot_mode);
            self.add(time, MomentKind::Mode, text);
        }
        self.flags(state);
        if self.reflex_reason != state.reflex_reason {
            self.reflex_reason = state.reflex_reason;
            if !state.reflex_reason.is_empty() {
                let what = if is_first {
                    "the robot ended an earlier motion"
                } else {
                    "the robot ends the motion"
                };
                let text = format!("{what}: {}", state.reflex_reason);
                self.add(time, MomentKind::Error, text);
            }
        }
        if self.errors != state.errors {
            self.errors = state.errors;
            let text = if state.errors.is_empty() {
                "no errors left".to_owned()
            } else {
                format!("errors {}", state.errors)
            };
            self.add(time, MomentKind::Error, text);
        }
        if let Some(record) = record {
            self.driver(record);
        }
    }

    fn flags(&mut self, state: &RobotState) {
        let time = state.message_id;
        let flags = |joints: &[f64; 7], axes: &[f64; 6]| -> [bool; AXES] {
            std::array::from_fn(|i| if i < 7 { joints[i] } else { axes[i - 7] } != 0.0)
        };
        let load = |i: usize| match i {
            0..7 => state.tau_ext_hat_filtered[i],
            _ => state.wrench_at_stiffness_frame()[i - 7],
        };
        let contacts = flags(&state.joint_contact, &state.cartesian_contact);
        let collisions = flags(&state.joint_collision, &state.cartesian_collision);
        for (i, (name, unit)) in NAMES.into_iter().enumerate() {
            if contacts[i] && appears(&mut self.contacts[i], time) {
                let text = format!("contact of {name}, {:.1} {unit}", load(i));
                self.add(time, MomentKind::Contact, text);
            }
            if collisions[i] && appears(&mut self.collisions[i], time) {
                let text = format!("collision of {name}, {:.1} {unit}", load(i));
                self.add(time, MomentKind::Collision, text);
            }
        }
    }

    fn driver(&mut self, record: &Record) {
        let time = record.time;
        if self.goal != record.goal {
            self.goal = record.goal;
            if record.goal != 0 && !self.has_goals {
                self.add(
                    time,
                    MomentKind::Goal,
                    format!("goal {} begins", record.goal),
                );
            }
        }
        for (i, guard) in Guard::ALL.into_iter().enumerate() {
            if record.bindings.contains(guard) && appears(&mut self.guards[i], time) {
                self.add(time, MomentKind::Guard, format!("{guard:?} binds"));
            }
        }
    }

    /// Records the end of a motion. Moments long after the end are dropped from then on.
    pub(super) fn ended(&mut self, time: u64) {
        (self.end, self.until_end) = (Some(time), None);
    }

    /// Processes an event of a run whose first cycle is `first`.
    pub(super) fn event(&mut self, event: &Event, first: u64) {
        let kind = match &event.kind {
            EventKind::Goal(_) | EventKind::Outcome(_) => MomentKind::Goal,
            EventKind::LinkLost { .. } | EventKind::LinkRestored { .. } => MomentKind::Loss,
            // The cycles or other events already report this change.
            EventKind::Mode { .. } | EventKind::Errors { .. } | EventKind::Diagnosis(_) => return,
            _ => MomentKind::Note,
        };
        if kind == MomentKind::Goal && !self.has_goals {
            self.has_goals = true;
            let is_goal = |moment: &mut Moment| moment.kind == MomentKind::Goal;
            self.count -= self.moments.extract_if(.., is_goal).count() as u64;
        }
        // The text of an outcome does not name the goal.
        let text = match &event.kind {
            EventKind::Goal(Goal { number, .. })
            | EventKind::Outcome(Outcome { goal: number, .. })
                if *number > 0 =>
            {
                format!("goal {number}: {}", event.kind)
            }
            kind => kind.to_string(),
        };
        self.add(event.robot_time.max(first), kind, text);
    }

    pub(super) fn add(&mut self, time: u64, kind: MomentKind, text: String) {
        if self.until_end.is_none() && self.is_after(time) {
            self.until_end = Some(self.moments.clone());
        }
        self.count += 1;
        // An event may be older than the newest moments, so the list keeps enough space for
        // sorting.
        if self.moments.len() >= 2 * MOMENTS_MAX {
            self.moments.remove(0);
        }
        self.moments.push(Moment { time, kind, text });
    }

    /// Returns the time at which the robot last detected a contact or a collision.
    pub(super) fn noticed(&self) -> Option<u64> {
        let flags = self.contacts.iter().chain(&self.collisions);
        flags.copied().flatten().max()
    }

    /// Returns the moments until shortly after the end, oldest first, and the number of omitted
    /// moments.
    pub(super) fn finish(self) -> (Vec<Moment>, u64) {
        let mut moments = self.until_end.unwrap_or(self.moments);
        moments.sort_by_key(|moment| moment.time);
        let surplus = moments.len().saturating_sub(MOMENTS_MAX);
        moments.drain(..surplus);
        let left_out = self.count - moments.len() as u64;
        (moments, left_out)
    }

    fn is_after(&self, time: u64) -> bool {
        self.end.is_some_and(|end| time.saturating_sub(end) > AFTER)
    }
}

/// Returns true if the condition was never present before, or was absent for a while.
fn appears(last: &mut Option<u64>, now: u64) -> bool {
    let before = last.replace(now);
    before.is_none_or(|before| now > before + PAUSE)
}

/// Time after the end of a motion in which events still belong to the motion, `[ms]`. The arm
/// brakes in this time.
pub(super) const AFTER: u64 = 500;

/// Duration of an absence after which a condition is recorded again, `[ms]`.
const PAUSE: u64 = 200;

/// Number of flags: one per joint, and one per axis of the base at the stiffness frame.
const AXES: usize = 13;

const NAMES: [(&str, &str); AXES] = [
    ("joint 1", "N·m"),
    ("joint 2", "N·m"),
    ("joint 3", "N·m"),
    ("joint 4", "N·m"),
    ("joint 5", "N·m"),
    ("joint 6", "N·m"),
    ("joint 7", "N·m"),
    ("the end effector along x", "N"),
    ("the end effector along y", "N"),
    ("the end effector along z", "N"),
    ("the end effector about x", "N·m"),
    ("the end effector about y", "N·m"),
    ("the end effector about z", "N·m"),
];
