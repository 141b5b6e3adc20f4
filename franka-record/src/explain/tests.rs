//! Explanations of synthetic states. For a simulated arm with a collision see
//! `tests/lockstep/explaining.rs`.

use super::*;
use crate::event::{Ending, Goal, Note, Outcome};
use crate::{EventKind, HostTime};
use franka_proto::{RobotError, RobotMode, RobotState};
use franka_rt::driver::Record;
use franka_rt::session::Guard;
use franka_rt::stats::Slack;

mod goals;

fn state(message_id: u64) -> RobotState {
    RobotState {
        message_id,
        q: franka_model::READY.into(),
        robot_mode: RobotMode::Move,
        m_ee: 0.73,
        F_T_EE: franka_model::layout::pose(&nalgebra::Matrix4::identity()),
        ..RobotState::default()
    }
}

fn explained(states: impl IntoIterator<Item = RobotState>) -> Explanation {
    let mut explainer = Explainer::new(Model::fr3());
    for state in states {
        explainer.push_state(&state);
    }
    explainer.finish()
}

/// Returns an event after the cycle with this number.
fn event(robot_time: u64, kind: EventKind) -> Event {
    Event {
        time: HostTime::from_nanos(1_000_000 * robot_time),
        robot_time,
        kind,
    }
}

fn note(robot_time: u64, text: &str) -> Event {
    let note = Note {
        text: text.into(),
        ..Note::default()
    };
    event(robot_time, EventKind::Note(note))
}

/// Returns three seconds of states: a contact and a collision of joint 2 before a reflex at 2500
/// ms.
fn hit() -> Vec<RobotState> {
    (1..=3000)
        .map(|time| {
            let mut state = state(time);
            state.dq[3] = 1e-3 * time as f64 * 0.3;
            if time >= 2480 {
                state.joint_contact[1] = 1.0;
                state.tau_ext_hat_filtered[1] = 2.0 * (time - 2479) as f64;
            }
            if time >= 2495 {
                state.joint_collision[1] = 1.0;
            }
            if time >= 2500 {
                state.reflex_reason = RobotError::JointReflex.into();
                state.errors = RobotError::JointReflex.into();
                state.robot_mode = RobotMode::Reflex;
                state.dq = [0.0; 7];
            }
            state
        })
        .collect()
}

#[test]
fn first_edges_come_in_their_order_and_once() {
    let explanation = explained(hit());
    assert_eq!((explanation.end, explanation.cycles), (2500, 3000));
    let kinds: Vec<_> = explanation
        .timeline
        .iter()
        .map(|moment| (moment.time, moment.kind))
        .collect();
    assert_eq!(
        kinds,
        [
            (1, MomentKind::Mode),
            (2480, MomentKind::Contact),
            (2495, MomentKind::Collision),
            (2500, MomentKind::Mode),
            (2500, MomentKind::Error),
            (2500, MomentKind::Error),
        ]
    );
    let cause = explanation.cause.expect("a reflex");
    assert_eq!(cause.errors, RobotError::JointReflex.into());
    assert!(cause.text.contains("joint_reflex"), "{}", cause.text);
    // The window ends with the state that shows the reflex, although more states follow.
    let window = &explanation.last_second;
    assert_eq!(window.first().map(|t| t.time), Some(1501));
    assert_eq!(window.last().map(|t| t.time), Some(2500));
}

#[test]
fn motions_after_the_stop_do_not_hide_it() {
    let later = (3001..=60_000).map(|time| {
        let mut state = state(time);
        state.reflex_reason = RobotError::JointReflex.into();
        state.tau_ext_hat_filtered[4] = -1e-3 * time as f64;
        state
    });
    let mut explainer = Explainer::new(Model::fr3());
    for state in hit().into_iter().chain(later) {
        explainer.push_state(&state);
        // Far more than the capacity of a timeline.
        if state.message_id % 20 == 0 {
            explainer.push_event(&note(state.message_id, "chunk"));
        }
    }
    let explanation = explainer.finish();
    let times = explanation.timeline.iter().map(|moment| moment.time);
    assert_eq!((explanation.end, times.max()), (2500, Some(3000)));
    // All 3000 chunks except the chunks of the first three seconds, and two changes of the state.
    assert_eq!(explanation.moments_left_out, 2852);
    assert_eq!(explanation.earlier, 0);
    let peak = explanation.peaks.external_torque.expect("a hit");
    assert_eq!(peak.joint, Some(2));
    assert!(
        explanation
            .to_string()
            .contains("     -20  contact of joint 2")
    );
}

#[test]
fn an_arm_that_nothing_touches_is_not_said_to_be_touched() {
    let untouched = (1..=2000).map(|time| {
        let mut state = state(time);
        state.dq[0] = 0.1;
        state.tau_ext_hat_filtered[1] = if time > 1990 { 3.0 } else { 0.0 };
        state
    });
    let text = explained(untouched).to_string();
    assert!(text.contains("No reflex, guard or lost link"), "{text}");
    assert!(!text.contains("touche"), "{text}");
}

#[test]
fn a_contact_that_was_over_before_the_end_is_not_said_to_touch() {
    let text = |since: u64, until: u64| {
        let touched = (1..=2000).map(|time| {
            let mut state = state(time);
            state.dq[0] = 0.1;
            if (since..until).contains(&time) {
                state.joint_contact[1] = 1.0;
                state.tau_ext_hat_filtered[1] = 22.0;
            } else if time > 1990 {
                state.tau_ext_hat_filtered[1] = 3.0;
            }
            state
        });
        explained(touched).to_string()
    };
    let over = text(500, 600);
    assert!(over.contains("contact of joint 2"), "{over}");
    assert!(!over.contains("touche"), "{over}");
    let lasting = text(500, 2001);
    assert!(lasting.contains("Contact with the arm"), "{lasting}");
    // A stop because of missing commands, without a contact.
    let silent = hit().into_iter().map(|mut state| {
        (state.joint_contact, state.joint_collision) = ([0.0; 7], [0.0; 7]);
        if state.message_id >= 2500 {
            state.reflex_reason = RobotError::CommunicationConstraintsViolation.into();
            state.errors = state.reflex_reason;
        }
        state
    });
    let silent = explained(silent).to_string();
    assert!(silent.contains("Why the robot stopped"), "{silent}");
    assert!(!silent.contains("touche"), "{silent}");
}

#[test]
fn a_stop_before_the_first_cycle_is_none_of_these() {
    let explanation = explained(hit().into_iter().skip(2600));
    assert_eq!((&explanation.cause, explanation.end), (&None, 3000));
    let text = explanation.to_string();
    assert!(
        text.contains("ended an earlier motion: [\"joint_reflex"),
        "{text}"
    );
}

/// The robot stops. It is then restarted, which restarts its clock, and does not stop again.
#[test]
fn a_robot_that_was_started_again_does_not_hide_the_stop_before() {
    let received = |number: usize| HostTime::from_nanos(number as u64 * 1_000_000);
    let states = hit().into_iter().chain((5..=400).map(state));
    let mut explainer = Explainer::new(Model::fr3());
    for (number, state) in states.enumerate() {
        explainer.push(&Cycle {
            time: received(number),
            state,
            ..Cycle::default()
        });
        match number {
            1200 => explainer.push_event(&note(1, "before")),
            3100 => explainer.push_event(&note(1, "after")),
            _ => {}
        }
    }
    let explained = |explainer: Explainer<'_>| {
        let explanation = explainer.finish();
        let notes = explanation.timeline.iter();
        let notes = notes.filter(|moment| moment.kind == MomentKind::Note);
        let notes: Vec<_> = notes.map(|moment| moment.text.clone()).collect();
        let earlier = explanation.earlier;
        (explanation.end, explanation.cycles, earlier, notes)
    };
    let again = "the robot was restarted: its clock continues at 5 ms";
    let notes = vec!["before".to_owned(), again.to_owned()];
    assert_eq!(explained(explainer.clone()), (2500, 3000, 0, notes));
    // The robot stops again.
    for message_id in 401..=402 {
        explainer.push_state(&RobotState {
            reflex_reason: RobotError::JointReflex.into(),
            ..state(message_id)
        });
    }
    assert_eq!(
        explained(explainer),
        (401, 398, 1, vec!["after".to_owned()])
    );
}

#[test]
fn margins_and_peaks_name_joint_value_and_time() {
    let mut states = hit();
    let limits = Model::fr3().joint_limits();
    states[999].q[5] = limits.upper[5] - 0.3;
    states[1999].tau_J[6] = -11.0;
    let explanation = explained(states);
    let position = explanation.margins.position.expect("cycles");
    assert_eq!((position.joint, position.time), (Some(6), 1000));
    assert!((position.margin - 0.3).abs() < 1e-12, "{position:?}");
    let velocity = explanation.margins.velocity.expect("cycles");
    assert_eq!((velocity.joint, velocity.time), (Some(4), 2499));
    assert!((velocity.value - 0.7497).abs() < 1e-12, "{velocity:?}");
    let torque = explanation.margins.torque.expect("cycles");
    assert_eq!((torque.joint, torque.time), (Some(7), 2000));
    assert_eq!((torque.limit, torque.margin), (-12.0, 1.0));
    let external = explanation.peaks.external_torque.expect("cycles");
    assert_eq!((external.joint, external.time), (Some(2), 3000));
    assert_eq!(explanation.peaks.following_error, None);
}

#[test]
fn lost_states_are_counted_and_placed() {
    let missing = |time: u64| (100..120).contains(&time) || (2400..2403).contains(&time);
    let states = hit().into_iter().filter(|s| !missing(s.message_id));
    let explanation = explained(states);
    assert_eq!(
        explanation.lost,
        Lost {
            states: 23,
            most_in_a_row: 20,
            most_at: 99,
            in_last_second: 3,
        }
    );
    let losses = explanation
        .timeline
        .iter()
        .filter(|m| m.kind == MomentKind::Loss);
    assert_eq!(losses.count(), 2);
}

#[test]
fn events_tell_goals_and_the_diagnosis() {
    let cycles = hit().into_iter().map(|state| {
        let mut record = Record::default();
        record.time = state.message_id;
        record.goal = 7;
        record.q_ref = state.q;
        record.q_ref[2] += 0.02;
        if (500..508).contains(&state.message_id) {
            record.slack = Some(Slack::from_nanos(-59_000 * (1000 - record.time as i64)));
            record.turnaround = Duration::from_micros(30_250);
        }
        Cycle {
            time: HostTime::from_nanos(1_000_000 * state.message_id),
            record,
            state,
            ..Cycle::default()
        }
    });
    // The first goal is set before the first cycle arrives.
    let goal = Goal {
        number: 7,
        kind: "move_to".into(),
        ..Goal::default()
    };
    let outcome = Outcome {
        goal: 7,
        ending: Ending::Reflex,
        text: "reflex".into(),
        duration: None,
    };
    let diagnosis = crate::event::Diagnosis {
        text: "joint 2: external torque".into(),
        ..Default::default()
    };
    let events = [
        event(0, EventKind::Goal(goal)),
        note(1200, "a remark"),
        event(2501, EventKind::Outcome(outcome)),
        event(2502, EventKind::Diagnosis(diagnosis)),
    ];
    let explanation = Explanation::of(cycles.clone(), events, Model::fr3());
    let goals: Vec<_> = explanation
        .timeline
        .iter()
        .filter(|moment| moment.kind == MomentKind::Goal)
        .map(|moment| moment.text.as_str())
        .collect();
    assert_eq!(goals, ["goal 7: move_to", "goal 7: reflex: reflex"]);
    let first = explanation.timeline.first().map(|moment| moment.time);
    assert_eq!(first, Some(explanation.first));
    let cause = explanation.cause.as_ref().expect("a reflex");
    assert_eq!(cause.text, "joint 2: external torque");
    let error = explanation.peaks.following_error.expect("a reference");
    assert_eq!(error.joint, Some(3));
    assert!((error.value - 0.02).abs() < 1e-12);
    assert!(explanation.to_string().contains("a remark"));
    let late = "8 commands left after the next state was due, 29.5 ms late at most,\n  2000 ms \
        before the end \
                (the answer to that state took 30.250 ms)";
    assert!(explanation.to_string().contains(late), "{explanation}");
    // Without events, the goal is detected in the records.
    let explanation = Explanation::of(cycles, [], Model::fr3());
    assert!(explanation.to_string().contains("goal 7 begins"));
}

#[test]
fn explanation_accepts_empty_input_and_odd_numbers() {
    assert!(explained([]).to_string().contains("nothing to explain"));
    assert!(explained([]).figure().contains("no cycles"));
    let mut odd = state(1);
    odd.q = [f64::NAN; 7];
    odd.dq = [f64::INFINITY; 7];
    odd.tau_J = [f64::NAN; 7];
    odd.tau_ext_hat_filtered = [f64::NAN; 7];
    let again = RobotState {
        message_id: 1,
        ..odd
    };
    let late = RobotState {
        message_id: u64::MAX,
        ..odd
    };
    let explanation = explained([odd, again, late]);
    assert_eq!(explanation.cycles, 2);
    let place = explanation.contact.as_ref().expect("cycles");
    let unknown = place.unknown.as_deref().expect("no contact");
    assert!(unknown.contains("not finite"), "{unknown}");
    assert!(explanation.figure().ends_with("</svg>"));
}

#[test]
fn memory_is_bounded() {
    let states = (1..=20_000).map(|i| {
        // Mode and losses change all the time.
        let mut state = state(i * 300);
        if i % 2 == 0 {
            state.robot_mode = RobotMode::Idle;
        }
        state
    });
    let explanation = explained(states);
    assert_eq!(explanation.timeline.len(), MOMENTS_MAX);
    assert_eq!(explanation.moments_left_out, 20_000 + 19_999 - 500);
    assert!(explanation.last_second.len() <= 1000);
}

#[test]
fn an_explanation_is_saved_and_read() {
    let explanation = explained(hit());
    let text = serde_json::to_string(&explanation).expect("plain data");
    let read: Explanation = serde_json::from_str(&text).expect("what was written");
    assert_eq!(read.timeline, explanation.timeline);
    assert_eq!(read.figure(), explanation.figure());
}
