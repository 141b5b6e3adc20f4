//! Explanations of recordings from their files.

use std::time::Duration;

use franka_model::geometry::Lengths;
use franka_model::{Model, RobotKind};
use franka_proto::{RobotError, RobotMode};
use franka_record::event::{Diagnosis, Ending, Goal, Outcome};
use franka_record::explain::{Explainer, Explanation, MomentKind};
use franka_record::recorder::{RecordOptions, Recorder, Robot};
use franka_record::{EventKind, Recording};

use crate::feed::{Arm, Scratch, quick};

/// Returns the bytes of a recording, and the explanation of the same cycles without a file. The arm
/// is touched at 1501 ms and stops at 1526 ms.
fn stopped() -> (Vec<u8>, Explanation) {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let options = RecordOptions {
        flush: Duration::from_millis(100),
        ..quick()
    };
    let recorder = Recorder::to_file(&path, options).unwrap();
    let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    let mut explainer = Explainer::new(Model::fr3());
    let mut run = |arm: &mut Arm, count: u64| {
        let first = arm.cycles() + 1;
        arm.run(&recorder, count);
        for ms in first..first + count {
            explainer.push_state(&arm.cycle_at(ms).0);
        }
    };
    let event = |arm: &Arm, kind| handle.event_at(handle.clock().at(arm.received()), kind);
    run(&mut arm, 1500);
    let goal = EventKind::Goal(Goal {
        number: 1,
        kind: "move_to".to_owned(),
        ..Goal::default()
    });
    event(&arm, goal);
    arm.state.joint_contact[1] = 1.0;
    run(&mut arm, 20);
    arm.state.joint_collision[1] = 1.0;
    run(&mut arm, 5);
    arm.state.robot_mode = RobotMode::Reflex;
    arm.state.errors = RobotError::JointReflex.into();
    arm.state.reflex_reason = arm.state.errors;
    run(&mut arm, 500);
    let outcome = EventKind::Outcome(Outcome {
        goal: 1,
        ending: Ending::Reflex,
        ..Outcome::default()
    });
    event(&arm, outcome);
    let diagnosis = EventKind::Diagnosis(Diagnosis {
        goal: 1,
        text: "joint 2 was hit".to_owned(),
        json: String::new(),
    });
    event(&arm, diagnosis);
    recorder.finish().unwrap();
    (std::fs::read(path).unwrap(), explainer.finish())
}

#[test]
fn a_recording_is_explained_as_its_cycles_are() {
    let (bytes, expected) = stopped();
    let recording = Recording::from_bytes(bytes).unwrap();
    let robot = recording.robot("").unwrap();
    let model = robot.model().expect("a known kind");
    let explanation = Explanation::of_recording(&robot, &model);
    assert_eq!((explanation.end, explanation.cycles), (1526, 2025));
    let cause = explanation.cause.as_ref().expect("a reflex");
    assert_eq!(cause.errors, RobotError::JointReflex.into());
    assert_eq!(cause.text, "joint 2 was hit");
    assert_eq!(explanation.lost, expected.lost);
    let of_cycles = |explanation: &Explanation| -> Vec<_> {
        let moments = explanation.timeline.iter();
        let moments = moments.filter(|moment| moment.kind != MomentKind::Goal);
        moments.map(|moment| (moment.time, moment.kind)).collect()
    };
    assert_eq!(of_cycles(&explanation), of_cycles(&expected));
    let goals = explanation.timeline.iter();
    let goals = goals.filter(|moment| moment.kind == MomentKind::Goal);
    let goals: Vec<_> = goals.map(|it| (it.time, it.text.as_str())).collect();
    assert_eq!(goals, [(1500, "goal 1: move_to"), (2025, "goal 1: reflex")]);
    let torque = |explanation: &Explanation| explanation.margins.torque.unwrap();
    let (torque, expected) = (torque(&explanation), torque(&expected));
    assert_eq!((torque.joint, torque.time), (expected.joint, expected.time));
    assert!((torque.value - expected.value).abs() < 1e-5, "{torque:?}");

    // A part without the stop has no cause.
    let mut cycles = robot.cycles().map(Result::unwrap);
    let end = cycles.find(|cycle| cycle.record.time == 1400).unwrap();
    let before = Explanation::of_recording(&robot.to(end.time), &model);
    assert_eq!((before.end, before.cause), (1400, None));
}

#[test]
fn unreadable_part_is_noted_and_the_rest_explained() {
    let (mut bytes, _) = stopped();
    let middle = bytes.len() / 4;
    bytes[middle..middle + 2000].fill(0xff);
    let recording = Recording::from_bytes(bytes).unwrap();
    let robot = recording.robot("").unwrap();
    let model = robot.model().expect("a known kind");
    let explanation = Explanation::of_recording(&robot, &model);
    assert!(explanation.cause.is_some());
    assert_eq!(explanation.end, 1526);
    assert!(explanation.lost.states >= 50, "{:?}", explanation.lost);
    let text = explanation.to_string();
    assert!(text.contains("cannot be read: the chunk at byte"), "{text}");
}

/// Only a Franka Research 3 has a description. Its lengths are known without one.
#[test]
fn a_recording_without_a_description_says_that_limits_are_constants() {
    let refused = "the description of the robot is refused: ";
    for (kind, urdf, expected) in [
        (
            RobotKind::Fr3,
            None,
            Some("the file has no description of the robot"),
        ),
        (RobotKind::Fr3, Some("<robot name=\"fr3\"/>"), Some(refused)),
        (RobotKind::Fer, None, None),
    ] {
        let scratch = Scratch::new();
        let path = scratch.path("run.mcap");
        let recorder = Recorder::to_file(&path, quick()).unwrap();
        let mut robot = Robot::new(kind);
        robot.urdf = urdf.map(str::to_owned);
        robot.lengths = Lengths::RECORDED_FR3;
        let (mut arm, _handle) = Arm::attach(&recorder, robot);
        arm.run(&recorder, 100);
        recorder.finish().unwrap();
        let recording = Recording::open(&path).unwrap();
        let robot = recording.robot("").unwrap();
        let model = robot.model().expect("a known kind");
        let constants = Model::of(kind).clone();
        assert_eq!(model.model, constants.with_lengths(Lengths::RECORDED_FR3));
        let text = Explanation::of_recording(&robot, &model).to_string();
        let line = text.lines().find(|line| line.contains("constants"));
        match expected {
            Some(reason) => assert!(line.is_some_and(|line| line.contains(reason)), "{text}"),
            None => assert_eq!((line, model.fallback), (None, None)),
        }
    }
}
