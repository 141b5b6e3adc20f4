//! Motions that an event ends, and goals without an end.

use super::*;

/// The robot stops; later a guard aborts a motion, and then the cable is cut.
#[test]
fn a_guard_and_a_lost_link_end_a_motion_as_the_robot_does() {
    let outcome = |number: u64, ending, text: &str| {
        let outcome = Outcome {
            goal: number,
            ending,
            text: text.into(),
            duration: None,
        };
        event(number, EventKind::Outcome(outcome))
    };
    let stopped = |message_id| RobotState {
        reflex_reason: RobotError::JointReflex.into(),
        ..state(message_id)
    };
    let cycle = |state: RobotState| Cycle {
        time: HostTime::from_nanos(1_000_000 * state.message_id),
        record: {
            let mut record = Record::default();
            (record.time, record.goal) = (state.message_id, 9);
            record
        },
        state,
        ..Cycle::default()
    };
    let of = |last: u64| {
        let cycles = hit().into_iter().chain((3001..=last).map(stopped));
        let events = [
            outcome(2501, Ending::Reflex, "stopped by the robot"),
            outcome(
                4000,
                Ending::Guard(Guard::Clearance),
                "region 1 is too near",
            ),
            outcome(5000, Ending::Arrived, ""),
            outcome(6000, Ending::LinkLost, ""),
        ];
        let events = events.into_iter().filter(|event| event.robot_time <= last);
        Explanation::of(cycles.map(cycle), events, Model::fr3())
    };
    let told = |explanation: &Explanation| {
        let cause = explanation.cause.as_ref().expect("an end");
        assert_eq!(
            explanation.last_second.last().map(|it| it.time),
            Some(explanation.end)
        );
        let text = cause.text.clone();
        (
            explanation.end,
            explanation.earlier,
            cause.errors.is_empty(),
            text,
        )
    };
    let reflex = "the robot stopped: [\"joint_reflex\"]".to_owned();
    assert_eq!(told(&of(3999)), (2500, 0, false, reflex));
    let guard = of(5500);
    assert_eq!(
        told(&guard),
        (4000, 1, true, "region 1 is too near".to_owned())
    );
    let text = guard.to_string();
    assert!(
        text.contains("Why the motion ended at 4000 ms (1970-01-01T00:00:04.000Z)"),
        "{text}"
    );
    assert!(text.contains("one motion ended earlier"), "{text}");
    assert!(
        text.contains("   -1500  the robot ends the motion"),
        "{text}"
    );
    let lost = "link-lost\ncheck the cable, the switch and the power of the robot";
    assert_eq!(told(&of(6400)), (6000, 2, true, lost.to_owned()));
}

/// A lost link ends a session and its goal, and later requests.
#[test]
fn one_loss_is_one_end() {
    let ended = |goal, text: &str| {
        let outcome = Outcome {
            goal,
            ending: Ending::LinkLost,
            text: text.into(),
            duration: None,
        };
        event(700, EventKind::Outcome(outcome))
    };
    let events = [ended(1, "silent"), ended(2, "closed"), ended(3, "closed")];
    let cycles = (1..=700).map(|time| Cycle {
        time: HostTime::from_nanos(1_000_000 * time),
        state: state(time),
        ..Cycle::default()
    });
    let explanation = Explanation::of(cycles, events, Model::fr3());
    let cause = explanation.cause.expect("an end");
    assert!(cause.text.starts_with("silent"), "{}", cause.text);
    assert_eq!((explanation.end, explanation.earlier), (700, 0));
}

#[test]
fn failed_goal_is_told_if_nothing_ended_a_motion() {
    let mut explainer = Explainer::new(Model::fr3());
    explainer.push_state(&state(1));
    let outcome = Outcome {
        goal: 1,
        ending: Ending::Failed,
        text: "User Stop pressed!".into(),
        ..Outcome::default()
    };
    explainer.push_event(&event(1, EventKind::Outcome(outcome)));
    let text = explainer.finish().to_string();
    assert!(
        text.contains("The last goal failed: User Stop pressed!"),
        "{text}"
    );
}

/// A motion that is cut off is reported as such. A goal that is only held afterwards is not.
#[test]
fn a_goal_without_an_end_is_under_way() {
    let of = |ends: bool| {
        let goal = Goal {
            number: 9,
            ..Goal::default()
        };
        let outcome = Outcome {
            goal: 9,
            ending: Ending::Arrived,
            ..Outcome::default()
        };
        let mut explainer = Explainer::new(Model::fr3());
        explainer.push_state(&state(1));
        explainer.push_event(&event(1, EventKind::Goal(goal)));
        if ends {
            explainer.push_event(&event(1, EventKind::Outcome(outcome)));
        }
        explainer.push_state(&state(2));
        explainer.finish()
    };
    let cut = of(false);
    assert_eq!((cut.cause.is_none(), cut.under_way), (true, Some(9)));
    let text = cut.to_string();
    assert!(text.contains("No reflex, guard or lost link"), "{text}");
    assert!(text.contains("Goal 9 was running"), "{text}");
    assert_eq!(of(true).under_way, None);
}

/// Chunks share the goal of the first chunk. Its end is the end of all chunks.
#[test]
fn chunks_that_followed_another_are_not_under_way() {
    let mut explainer = Explainer::new(Model::fr3());
    explainer.push_state(&state(1));
    for number in [2, 3, 4] {
        let goal = Goal {
            number,
            kind: "chunk".into(),
            ..Goal::default()
        };
        explainer.push_event(&event(1, EventKind::Goal(goal)));
    }
    assert_eq!(explainer.clone().finish().under_way, Some(2));
    let outcome = Outcome {
        goal: 2,
        ending: Ending::Superseded,
        ..Outcome::default()
    };
    explainer.push_event(&event(1, EventKind::Outcome(outcome)));
    assert_eq!(explainer.finish().under_way, None);
}
