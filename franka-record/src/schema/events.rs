//! Conversion of events to messages, and back.

use core::time::Duration;

use franka_proto::Errors;

use super::arrays::{from_numbers, numbers};
use super::franka;
use super::franka::event::outcome::Ending as EndingNumber;
use super::franka::event::{self, Kind, note};
use super::numbers::{guard, guard_number, robot_mode, seconds};
use crate::HostTime;
use crate::event::{
    Diagnosis, Ending, Event, EventKind, Goal, Level, Note, Outcome, Request, Target,
};

impl From<&Event> for franka::Event {
    fn from(event: &Event) -> Self {
        Self {
            robot_time: event.robot_time,
            kind: Some(kind(&event.kind)),
        }
    }
}

impl franka::Event {
    /// Returns the event in this message; `None` if a later version of this crate added this kind
    /// of event. `time` is the time of the message.
    pub fn to_event(&self, time: HostTime) -> Option<Event> {
        Some(Event {
            time,
            robot_time: self.robot_time,
            kind: event_kind(self.kind.as_ref()?),
        })
    }
}

fn kind(kind: &EventKind) -> Kind {
    match kind.clone() {
        EventKind::Goal(goal) => {
            let (joints, pose) = match goal.target {
                Some(Target::Joints(joints)) => (joints.into(), Vec::new()),
                Some(Target::Pose(pose)) => (Vec::new(), numbers(&pose).into()),
                None => Default::default(),
            };
            Kind::Goal(event::Goal {
                number: goal.number,
                kind: goal.kind,
                joints,
                pose,
                options: goal.options,
            })
        }
        EventKind::Outcome(outcome) => {
            let guard = match outcome.ending {
                Ending::Guard(guard) => guard_number(guard),
                _ => 0,
            };
            Kind::Outcome(event::Outcome {
                goal: outcome.goal,
                ending: ending_number(outcome.ending).into(),
                guard,
                text: outcome.text,
                duration: outcome.duration.map(|duration| duration.as_secs_f64()),
            })
        }
        EventKind::LinkLost { silence } => Kind::Link(link(true, silence)),
        EventKind::LinkRestored { silence } => Kind::Link(link(false, silence)),
        EventKind::Mode { from, to } => Kind::Mode(event::ModeChange {
            from: i32::from(from.byte()),
            to: i32::from(to.byte()),
        }),
        EventKind::Errors {
            errors,
            reflex_reason,
        } => Kind::Errors(event::ErrorChange {
            errors: errors.bits(),
            reflex_reason: reflex_reason.bits(),
        }),
        EventKind::Request(Request {
            name,
            arguments,
            error,
        }) => Kind::Request(event::Request {
            name,
            arguments,
            error,
        }),
        EventKind::Diagnosis(Diagnosis { goal, text, json }) => {
            Kind::Diagnosis(event::Diagnosis { goal, text, json })
        }
        EventKind::EpisodeStart { name, task } => {
            Kind::EpisodeStart(event::EpisodeStart { name, task })
        }
        EventKind::EpisodeEnd { success } => Kind::EpisodeEnd(event::EpisodeEnd { success }),
        EventKind::Note(Note {
            level,
            source,
            text,
        }) => Kind::Note(event::Note {
            level: level as i32,
            source,
            text,
        }),
        EventKind::Dropped { cycles } => Kind::Dropped(event::Dropped { cycles }),
        EventKind::ClockStep { by } => Kind::ClockStep(event::ClockStep { by }),
    }
}

fn event_kind(kind: &Kind) -> EventKind {
    match kind.clone() {
        Kind::Goal(goal) => EventKind::Goal(Goal {
            number: goal.number,
            target: target(&goal),
            kind: goal.kind,
            options: goal.options,
        }),
        Kind::Outcome(outcome) => EventKind::Outcome(Outcome {
            goal: outcome.goal,
            ending: ending(&outcome),
            text: outcome.text,
            duration: outcome.duration.map(seconds),
        }),
        Kind::Link(link) => {
            let silence = seconds(link.silence);
            if link.lost {
                EventKind::LinkLost { silence }
            } else {
                EventKind::LinkRestored { silence }
            }
        }
        Kind::Mode(mode) => EventKind::Mode {
            from: robot_mode(mode.from),
            to: robot_mode(mode.to),
        },
        Kind::Errors(change) => EventKind::Errors {
            errors: Errors::from_bits(change.errors),
            reflex_reason: Errors::from_bits(change.reflex_reason),
        },
        Kind::Request(event::Request {
            name,
            arguments,
            error,
        }) => EventKind::Request(Request {
            name,
            arguments,
            error,
        }),
        Kind::Diagnosis(event::Diagnosis { goal, text, json }) => {
            EventKind::Diagnosis(Diagnosis { goal, text, json })
        }
        Kind::EpisodeStart(event::EpisodeStart { name, task }) => {
            EventKind::EpisodeStart { name, task }
        }
        Kind::EpisodeEnd(event::EpisodeEnd { success }) => EventKind::EpisodeEnd { success },
        Kind::Note(note) => EventKind::Note(Note {
            level: match note.level() {
                note::Level::Debug => Level::Debug,
                note::Level::Info => Level::Info,
                note::Level::Warning => Level::Warning,
                note::Level::Error => Level::Error,
            },
            source: note.source,
            text: note.text,
        }),
        Kind::Dropped(event::Dropped { cycles }) => EventKind::Dropped { cycles },
        Kind::ClockStep(event::ClockStep { by }) => EventKind::ClockStep { by },
    }
}

fn link(lost: bool, silence: Duration) -> event::Link {
    event::Link {
        lost,
        silence: silence.as_secs_f64(),
    }
}

fn target(goal: &event::Goal) -> Option<Target> {
    if let Ok(joints) = <[f64; 7]>::try_from(&*goal.joints) {
        return Some(Target::Joints(joints));
    }
    let pose = <[f64; 7]>::try_from(&*goal.pose).ok()?;
    from_numbers(pose).map(Target::Pose)
}

fn ending_number(ending: Ending) -> EndingNumber {
    match ending {
        Ending::Arrived => EndingNumber::Arrived,
        Ending::Superseded => EndingNumber::Superseded,
        Ending::Stopped => EndingNumber::Stopped,
        Ending::Reflex => EndingNumber::Reflex,
        Ending::LinkLost => EndingNumber::LinkLost,
        Ending::Guard(_) => EndingNumber::Guard,
        Ending::Rejected => EndingNumber::Rejected,
        Ending::Failed => EndingNumber::Failed,
    }
}

fn ending(outcome: &event::Outcome) -> Ending {
    match outcome.ending() {
        EndingNumber::Arrived => Ending::Arrived,
        EndingNumber::Superseded => Ending::Superseded,
        EndingNumber::Stopped => Ending::Stopped,
        EndingNumber::Reflex => Ending::Reflex,
        EndingNumber::LinkLost => Ending::LinkLost,
        EndingNumber::Guard => guard(outcome.guard).map_or(Ending::Failed, Ending::Guard),
        EndingNumber::Rejected => Ending::Rejected,
        EndingNumber::Failed | EndingNumber::Unknown => Ending::Failed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_proto::RobotMode;
    use franka_rt::session::Guard;
    use nalgebra::{Isometry3, Vector3};
    use prost::Message as _;

    fn every_kind() -> Vec<EventKind> {
        let text = || "as it is said".to_owned();
        let goal = |target| {
            EventKind::Goal(Goal {
                number: 3,
                kind: "move_to".to_owned(),
                target,
                options: "speed 0.5".to_owned(),
            })
        };
        let mut kinds = vec![
            goal(None),
            goal(Some(Target::Joints([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]))),
            goal(Some(Target::Pose(Isometry3::new(
                Vector3::new(0.5, 0.0, 0.3),
                Vector3::zeros(),
            )))),
            EventKind::LinkLost {
                silence: Duration::from_millis(250),
            },
            EventKind::LinkRestored {
                silence: Duration::from_millis(1250),
            },
            EventKind::Mode {
                from: RobotMode::Move,
                to: RobotMode::Reflex,
            },
            EventKind::Errors {
                errors: Errors::from_bits(5),
                reflex_reason: Errors::from_bits(1 << 20),
            },
            EventKind::Diagnosis(Diagnosis {
                goal: 3,
                text: text(),
                json: "{}".to_owned(),
            }),
            EventKind::EpisodeStart {
                name: "one".to_owned(),
                task: "pick".to_owned(),
            },
            EventKind::Note(Note {
                level: Level::Warning,
                source: "program".to_owned(),
                text: text(),
            }),
            EventKind::Dropped { cycles: 12 },
            EventKind::ClockStep {
                by: -3_600_000_000_000,
            },
        ];
        for error in [None, Some(text())] {
            kinds.push(EventKind::Request(Request {
                name: "set_load".to_owned(),
                arguments: "[0.5]".to_owned(),
                error,
            }));
        }
        for success in [None, Some(true), Some(false)] {
            kinds.push(EventKind::EpisodeEnd { success });
        }
        for ending in [
            Ending::Arrived,
            Ending::Superseded,
            Ending::Stopped,
            Ending::Reflex,
            Ending::LinkLost,
            Ending::Guard(Guard::Deviation),
            Ending::Rejected,
            Ending::Failed,
        ] {
            kinds.push(EventKind::Outcome(Outcome {
                goal: 3,
                ending,
                text: text(),
                duration: (ending == Ending::Arrived).then_some(Duration::from_millis(1500)),
            }));
        }
        kinds
    }

    #[test]
    fn every_event_survives_its_message() {
        let time = HostTime::from_nanos(1_700_000_000_000_000_000);
        for kind in every_kind() {
            let event = Event {
                time,
                robot_time: 55,
                kind,
            };
            let bytes = franka::Event::from(&event).encode_to_vec();
            let message = franka::Event::decode(&*bytes).unwrap();
            assert_eq!(message.to_event(time), Some(event));
        }
        assert_eq!(franka::Event::default().to_event(time), None);
    }

    #[test]
    fn every_event_has_a_line_and_a_source() {
        for kind in every_kind() {
            let line = kind.to_string();
            assert!(!line.is_empty() && !line.contains('\n'), "{line:?}");
            assert!(!kind.source().is_empty());
        }
    }

    #[test]
    fn incident_is_a_motion_ended_from_outside() {
        let incidents: Vec<_> = every_kind()
            .into_iter()
            .filter(EventKind::is_incident)
            .map(|kind| kind.to_string())
            .collect();
        assert_eq!(
            incidents,
            [
                "reflex: as it is said",
                "link-lost: as it is said",
                "guard-deviation: as it is said"
            ]
        );
    }
}
