//! Reading returns the recorded data.

use std::time::Duration;

use franka_model::RobotKind;
use franka_proto::{Errors, RobotError, RobotMode, gripper};
use franka_record::event::{Ending, Goal, Outcome};
use franka_record::recorder::{Attachment, RecordOptions, Recorder, Robot};
use franka_record::recording::RecordingError;
use franka_record::{EventKind, GripperState, Recording};

use crate::feed::{Arm, Scratch, quick};

#[test]
fn cycles_come_back_as_they_were() {
    let scratch = Scratch::new();
    for kind in RobotKind::ALL {
        let path = scratch.path(&format!("{kind:?}.mcap"));
        let recorder = Recorder::to_file(&path, quick()).unwrap();
        let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(kind));
        arm.run(&recorder, 2500);
        recorder.finish().unwrap();

        let recording = Recording::open(&path).unwrap();
        assert_eq!(recording.damage(), None);
        assert_eq!(recording.robots()[0].kind, Some(kind));
        let robot = recording.robot("").unwrap();
        let mut count = 0;
        for (index, cycle) in robot.cycles().enumerate() {
            let cycle = cycle.unwrap();
            let (state, record) = arm.cycle_at(index as u64 + 1);
            assert_eq!(cycle.record.time, record.time);
            assert_eq!(cycle.record.q, record.q);
            assert!((cycle.state.tau_J[3] - state.tau_J[3]).abs() < 1e-5);
            assert!((cycle.state.O_T_EE[13] - state.O_T_EE[13]).abs() < 1e-6);
            // The masses of an FER are 32-bit numbers.
            assert!((cycle.state.m_ee - 0.73).abs() < 1e-6);
            let reference = cycle.reference.unwrap().translation.vector;
            assert!(reference.norm() > 0.1, "{reference}");
            count += 1;
        }
        assert_eq!(count, 2500);
    }
}

#[test]
fn a_part_is_found_without_the_rest() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let recorder = Recorder::to_file(&path, quick()).unwrap();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    arm.run(&recorder, 20_000);
    recorder.finish().unwrap();
    // Damaged in a part that is not requested, and therefore not read.
    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() / 4;
    bytes[middle..middle + 2000].fill(0xff);
    let recording = Recording::from_bytes(bytes).unwrap();
    assert_eq!(recording.damage(), None);
    let (begin, end) = recording.span().unwrap();
    assert!(end.since(begin) >= Duration::from_millis(19_900));
    let robot = recording.robot("").unwrap();
    let first = begin + Duration::from_secs(15);
    let part = robot.from(first).to(first + Duration::from_millis(99));
    let times: Vec<_> = part
        .cycles()
        .map(|cycle| cycle.unwrap())
        .inspect(|cycle| assert!((cycle.state.m_ee - 0.73).abs() < 1e-6))
        .map(|cycle| cycle.record.time)
        .collect();
    let start = times[0];
    assert!((14_900..15_100).contains(&start), "{start}");
    assert_eq!(times, (start..start + 100).collect::<Vec<_>>());
    let errors = robot.cycles().filter(Result::is_err).count();
    assert!((1..=2).contains(&errors), "{errors}");
}

#[test]
fn events_come_back_in_order_and_changes_are_found() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let options = RecordOptions {
        attachments: vec![Attachment {
            name: "notes.txt".to_owned(),
            media_type: "text/plain".to_owned(),
            data: b"as agreed".to_vec(),
        }],
        metadata: [("operator".to_owned(), "none".to_owned())].into(),
        ..quick()
    };
    let recorder = Recorder::to_file(&path, options).unwrap();
    let mut robot = Robot::new(RobotKind::Fr3).named("left");
    robot.urdf = Some("<robot name=\"left\"/>".to_owned());
    let (mut arm, handle) = Arm::attach(&recorder, robot);
    arm.run(&recorder, 100);
    let goal = EventKind::Goal(Goal {
        number: 1,
        kind: "move_to".to_owned(),
        ..Goal::default()
    });
    handle.event(goal.clone());
    arm.run(&recorder, 100);
    arm.state.robot_mode = RobotMode::Reflex;
    arm.state.errors = [RobotError::CartesianReflex].into_iter().collect();
    arm.run(&recorder, 100);
    let outcome = EventKind::Outcome(Outcome {
        goal: 1,
        ending: Ending::Reflex,
        ..Outcome::default()
    });
    handle.event(outcome.clone());
    let hand = GripperState::Hand(gripper::State {
        width: 0.04,
        ..gripper::State::default()
    });
    handle.gripper(hand);
    let (errors, none) = (arm.state.errors, Errors::NONE);
    recorder.finish().unwrap();

    let recording = Recording::open(&path).unwrap();
    let metadata = recording.metadata();
    assert_eq!(metadata["operator"], "none");
    assert_eq!(
        (&*metadata["thinned"], &*metadata["flush"]),
        ("false", "1s")
    );
    assert_eq!(recording.attachments().unwrap(), ["notes.txt", "left.urdf"]);
    let bytes = std::fs::read(&path).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    for attachment in &summary.attachment_indexes {
        let times = [attachment.log_time, attachment.create_time];
        assert_eq!(times.map(|time| time > 0), [true; 2], "{}", attachment.name);
    }
    assert_eq!(summary.attachment_indexes.len(), 2);
    let notes = recording.attachment("notes.txt").unwrap();
    assert_eq!(notes.as_deref(), Some(&b"as agreed"[..]));
    let left = recording.robot("left").unwrap();
    let mut kinds: Vec<_> = left.events().map(|event| event.unwrap().kind).collect();
    // The host's time and the time of the synthetic cycles diverge.
    let position = kinds.iter().position(|kind| *kind == goal).unwrap();
    kinds.remove(position);
    assert_eq!(
        kinds,
        [
            EventKind::Mode {
                from: RobotMode::Move,
                to: RobotMode::Reflex
            },
            EventKind::Errors {
                errors,
                reflex_reason: none
            },
            outcome,
        ]
    );
    let grippers: Vec<_> = left
        .gripper_states()
        .map(|state| state.unwrap().1)
        .collect();
    assert_eq!(grippers, [hand]);
    let nobody = recording.robot("right").map(drop).unwrap_err();
    assert!(matches!(nobody, RecordingError::NoRobot { .. }), "{nobody}");
}

#[test]
fn two_robots_share_a_file() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let recorder = Recorder::to_file(&path, quick()).unwrap();
    let (mut left, _l) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3).named("left"));
    let right = Robot::new(RobotKind::Fer).named("right");
    let (mut right, handle) = Arm::attach(&recorder, right);
    for _ in 0..1500 {
        left.step();
        right.step();
    }
    while recorder.status().cycles < 3000 {
        std::thread::sleep(Duration::from_millis(1));
    }
    handle.note("only the right one");
    recorder.finish().unwrap();
    let recording = Recording::open(&path).unwrap();
    for (name, notes) in [("left", 0), ("right", 1)] {
        let robot = recording.robot(name).unwrap();
        assert_eq!(robot.cycles().filter(Result::is_ok).count(), 1500);
        let noted = robot
            .events()
            .filter(|event| matches!(event.as_ref().unwrap().kind, EventKind::Note(_)));
        assert_eq!(noted.count(), notes, "{name}");
    }
}

#[test]
fn thinned_cycles_are_whole_around_an_error() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let options = RecordOptions {
        thinned: true,
        ..quick()
    };
    let recorder = Recorder::to_file(&path, options).unwrap();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    arm.run(&recorder, 5000);
    arm.state.robot_mode = RobotMode::Reflex;
    arm.state.errors = [RobotError::JointReflex].into_iter().collect();
    arm.run(&recorder, 5000);
    recorder.finish().unwrap();
    let recording = Recording::open(&path).unwrap();
    let robot = recording.robot("").unwrap();
    let times: Vec<_> = robot
        .cycles()
        .map(|cycle| cycle.unwrap().record.time)
        .collect();
    let around = times.iter().filter(|time| (4600..=5900).contains(*time));
    assert_eq!(around.count(), 1301);
    let elsewhere = times.iter().filter(|time| (1000..2000).contains(*time));
    assert_eq!(elsewhere.count(), 100);
}

#[test]
fn cycles_are_read_at_another_rate() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    let recorder = Recorder::to_file(&path, quick()).unwrap();
    let (mut arm, _handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    arm.run(&recorder, 1000);
    recorder.finish().unwrap();
    let recording = Recording::open(&path).unwrap();
    let robot = recording.robot("").unwrap();
    for (rate, expected) in [(50.0, 50), (30.0, 30), (1000.0, 1000), (5000.0, 1000)] {
        let times: Vec<_> = robot
            .resampled(rate)
            .map(|cycle| cycle.unwrap().record.time)
            .collect();
        assert_eq!(times.len(), expected, "{rate}");
        for (index, time) in times.iter().enumerate() {
            let due = 1.0 + index as f64 * (1e3 / rate).max(1.0);
            assert!((due - *time as f64).abs() < 1.0, "{time} for {due}");
        }
    }
}
