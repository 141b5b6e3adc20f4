//! Converts the entries of a journal into their recorded form.

use franka_diagnosis::Diagnose;
use franka_proto::{Request, gripper, vacuum};
use franka_record::event::{self, Ending, EventKind, Level};
use franka_rt::lifecycle::{MotionError, Outcome, Party};
use franka_rt::session::{Goal, GoalId, Guard, Lapse, Target};
use franka_rt::supervision;
use serde::Serialize;

use crate::destination::Destination;
use crate::journal::{ActionEnd, Given};

pub(super) fn goal(given: &Given) -> EventKind {
    let Given {
        id,
        kind,
        goal,
        destination,
    } = given;
    let target = match (destination, goal) {
        (Some(Destination::Target(target)), _) => place(*target),
        // The arm's position at the start completes this destination, and the cycles contain that
        // position.
        (Some(_), _) => None,
        (None, Some(goal)) => place(goal.target),
        (None, None) => None,
    };
    // Streams come at their own rate, with the same options each time.
    let options = match goal {
        Some(goal) if !matches!(*kind, "set" | "chunk") => options(goal, *destination),
        _ => String::new(),
    };
    EventKind::Goal(event::Goal {
        number: id.0,
        kind: (*kind).to_owned(),
        target,
        options,
    })
}

fn place(target: Target) -> Option<event::Target> {
    match target.place() {
        Target::Joints(q) => Some(event::Target::Joints(q)),
        Target::Pose(pose) => Some(event::Target::Pose(pose)),
        _ => None,
    }
}

fn options(goal: &Goal, destination: Option<Destination>) -> String {
    let Goal {
        on_arrival,
        budget,
        gains,
        tolerance,
        watchdog,
        force_cap,
        lead,
        leash,
        deviation,
        posture,
        reaction,
        ..
    } = goal;
    let destination = match destination {
        None | Some(Destination::Target(_)) => String::new(),
        Some(relative) => format!("destination {relative:?}; "),
    };
    format!(
        "{destination}on_arrival {on_arrival:?}; budget {budget:?}; gains {gains:?}; tolerance {tolerance:?}; \
         watchdog {watchdog:?}; force_cap {force_cap:?}; lead {lead:?}; leash {leash:?}; deviation {deviation:?}; \
         posture {posture:?}; reaction {reaction:?}"
    )
}

pub(super) fn outcome(goal: GoalId, outcome: &Outcome) -> EventKind {
    let (ending, text, duration) = match outcome {
        Ok(report) => {
            let text = report.reacted.map(|reacted| {
                let after = reacted.after.as_millis();
                format!("the condition became true {after} ms after the start")
            });
            let text = text.unwrap_or_default();
            (Ending::Arrived, text, Some(report.duration))
        }
        Err(error) => (ending(error), error.to_string(), None),
    };
    EventKind::Outcome(event::Outcome {
        goal: goal.0,
        ending,
        text,
        duration,
    })
}

fn ending(error: &MotionError) -> Ending {
    match error {
        MotionError::Superseded => Ending::Superseded,
        MotionError::Stopped => Ending::Stopped,
        MotionError::Held(lapse) | MotionError::Braked(lapse) => {
            guard(*lapse).map_or(Ending::Failed, Ending::Guard)
        }
        MotionError::Control(error) if error.is_reflex() => Ending::Reflex,
        MotionError::LinkLost { .. } => Ending::LinkLost,
        MotionError::ConnectionClosed { reason } if reason.party() == Party::Link => {
            Ending::LinkLost
        }
        MotionError::AfterReaction { error, .. } => ending(error),
        MotionError::Goal(_)
        | MotionError::Path(_)
        | MotionError::Disengaged
        | MotionError::Busy
        | MotionError::Start(_)
        | MotionError::Unsupported(_)
        | MotionError::Rejected(_)
        | MotionError::NotReady { .. } => Ending::Rejected,
        _ => Ending::Failed,
    }
}

fn guard(lapse: Lapse) -> Option<Guard> {
    match lapse {
        Lapse::Silent { .. } => Some(Guard::Watchdog),
        Lapse::Deadman => Some(Guard::Deadman),
        Lapse::Displaced => Some(Guard::Deviation),
        Lapse::Blocked { .. } => Some(Guard::Clearance),
        Lapse::Team(_) => Some(Guard::Team),
        Lapse::TooFast => Some(Guard::SpeedCap),
        Lapse::Unresponsive => Some(Guard::Unresponsive),
        _ => None,
    }
}

/// Returns the diagnosis of a motion that the robot ended by a reflex; `None` if it did not.
pub(super) fn diagnosis(goal: GoalId, outcome: &Outcome) -> Option<EventKind> {
    #[expect(
        clippy::disallowed_methods,
        reason = "this is a thread that nothing waits for, and no task"
    )]
    let diagnosis = outcome.as_ref().err()?.diagnose()?;
    Some(EventKind::Diagnosis(event::Diagnosis {
        goal: goal.0,
        text: diagnosis.to_string(),
        json: json(&diagnosis),
    }))
}

/// Returns the recorded form of an event of the robot; `None` if the event has a separate entry.
pub(super) fn happening(event: &supervision::Event) -> Option<EventKind> {
    use supervision::EventKind as Kind;
    let level = match &event.kind {
        Kind::MotionBegun { .. } | Kind::MotionEnded { .. } => return None,
        Kind::Silent { silence } => return Some(EventKind::LinkLost { silence: *silence }),
        Kind::Resumed { after } => return Some(EventKind::LinkRestored { silence: *after }),
        Kind::Lost { .. } | Kind::Reflex(_) => Level::Error,
        Kind::RealtimeRefused { .. }
        | Kind::NotRecovered { .. }
        | Kind::UserStop { pressed: true }
        | Kind::Brakes { closed: true } => Level::Warning,
        _ => Level::Info,
    };
    Some(note(level, "supervision", event.kind.to_string()))
}

pub(super) fn note(level: Level, source: &str, text: String) -> EventKind {
    EventKind::Note(event::Note {
        level,
        source: source.to_owned(),
        text,
    })
}

/// Returns the event of a request to the robot, with the reason if the request was not carried out.
pub(super) fn request(request: &Request, error: Option<String>) -> EventKind {
    let none = String::new();
    let (name, arguments) = match request {
        Request::SetCollisionBehavior(behavior) => ("set_collision_behavior", json(behavior)),
        Request::SetJointImpedance(stiffness) => ("set_joint_impedance", json(stiffness)),
        Request::SetCartesianImpedance(stiffness) => ("set_cartesian_impedance", json(stiffness)),
        Request::SetGuidingMode {
            guiding_mode,
            nullspace,
        } => ("set_guiding_mode", json(&(guiding_mode, nullspace))),
        Request::SetEEToK(pose) => ("set_k", json(pose)),
        Request::SetNEToEE(pose) => ("set_ee", json(pose)),
        Request::SetLoad(load) => ("set_load", json(load)),
        Request::SetFilters(filters) => ("set_filters", json(filters)),
        Request::GetCartesianLimit { id } => ("virtual_wall", json(id)),
        Request::AutomaticErrorRecovery => ("recover", none),
        Request::GetRobotModel => ("urdf", none),
        other => (other.command().display_name(), none),
    };
    answered(name, arguments, error)
}

pub(super) fn hand(request: &gripper::Request, ended: ActionEnd) -> EventKind {
    let (name, arguments) = match request {
        gripper::Request::Homing => ("gripper.homing", String::new()),
        gripper::Request::Move(to) => ("gripper.move_to", json(to)),
        gripper::Request::Grasp(grasp) => ("gripper.grasp", json(grasp)),
        gripper::Request::Stop => ("gripper.stop", String::new()),
        _ => ("gripper", String::new()),
    };
    answered(name, arguments, failure(ended))
}

pub(super) fn vacuum(request: &vacuum::Request, ended: ActionEnd) -> EventKind {
    let (name, arguments) = match request {
        vacuum::Request::Vacuum(vacuum) => ("vacuum.vacuum", json(vacuum)),
        vacuum::Request::DropOff { timeout } => ("vacuum.drop_off", json(timeout)),
        vacuum::Request::Stop => ("vacuum.stop", String::new()),
        _ => ("vacuum", String::new()),
    };
    answered(name, arguments, failure(ended))
}

fn failure(ended: ActionEnd) -> Option<String> {
    match ended {
        Ok(true) => None,
        Ok(false) => Some("the action ended without success".to_owned()),
        Err(error) => Some(error),
    }
}

fn answered(name: &str, arguments: String, error: Option<String>) -> EventKind {
    EventKind::Request(event::Request {
        name: name.to_owned(),
        arguments,
        error,
    })
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("no map in it has keys that are no text")
}
