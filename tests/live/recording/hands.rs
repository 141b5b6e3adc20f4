//! Recordings of robots with a hand or a vacuum gripper.

use std::time::Duration;

use franka_async::gripper::{Grasp, Gripper};
use franka_async::vacuum::{Profile, Vacuum, VacuumGripper};
use franka_record::{Event, EventKind, GripperState, Recording};
use franka_sim::{Fingers, Sim, Suction};
use franka_tests::PATIENCE;

use super::{Folder, finish, roomy};
use crate::{alone, connect};

#[tokio::test(flavor = "multi_thread")]
async fn actions_and_states_of_a_hand_are_recorded() {
    let _alone = alone();
    let sim = Sim::fr3().ideal().hand(Fingers::new().with_object(0.05), 0);
    let sim = sim.wait_for_commands(PATIENCE).start().await.unwrap();
    let robot = connect(&sim).await;
    let gripper = Gripper::connect(sim.hand().expect("a hand").addr())
        .await
        .unwrap();
    let folder = Folder::new();
    let recorder = folder.recorder();
    recorder.attach(&robot, roomy()).await.unwrap();
    let unknown = recorder.attach_gripper(&gripper, "left").unwrap_err();
    assert_eq!(
        unknown.to_string(),
        "no robot named \"left\" is attached to the recorder: attach the robot first"
    );
    recorder.attach_gripper(&gripper, "").unwrap();
    let twice = recorder.attach_gripper(&gripper, "").unwrap_err();
    assert!(twice.to_string().contains("already recorded"), "{twice}");
    let refused = recorder.begin_episode("one/two", "grasp the object");
    let expected =
        "got the episode name \"one/two\", expected 1 to 128 letters, digits, '-' and '_'";
    assert_eq!(refused.unwrap_err().to_string(), expected);
    recorder.begin_episode("one", "grasp the object").unwrap();
    assert!(gripper.homing().await.unwrap());
    assert!(gripper.grasp(Grasp::new(0.05, 0.1, 40.0)).await.unwrap());
    assert!(!gripper.grasp(Grasp::new(0.01, 0.1, 40.0)).await.unwrap());
    recorder.end_episode(Some(true));
    finish(recorder);
    robot.shutdown().await;

    let (_, events) = folder.read("");
    let told: Vec<_> = events
        .iter()
        .filter_map(|event| match &event.kind {
            EventKind::Request(request) if request.name.starts_with("gripper") => {
                Some((request.name.clone(), request.error.is_none()))
            }
            EventKind::EpisodeStart { task, .. } => Some((task.clone(), true)),
            EventKind::EpisodeEnd { success } => Some(("end".into(), *success == Some(true))),
            _ => None,
        })
        .collect();
    let expected = [
        ("grasp the object", true),
        ("gripper.homing", true),
        ("gripper.grasp", true),
        ("gripper.grasp", false),
        ("end", true),
    ];
    assert_eq!(told, expected.map(|(name, done)| (name.to_owned(), done)));
    let recording = Recording::open(folder.file()).unwrap();
    let states = recording.robot("").unwrap().gripper_states();
    let states: Vec<_> = states.map(Result::unwrap).collect();
    // The episode began sooner than another state can have come.
    let began = |event: &Event| matches!(event.kind, EventKind::EpisodeStart { .. });
    let began = events
        .iter()
        .find(|event| began(event))
        .expect("an episode");
    assert!(states[0].0 <= began.time);
    let grasped = states.into_iter().any(|(_, state)| match state {
        GripperState::Hand(state) => state.is_grasped,
        GripperState::Vacuum(_) => false,
    });
    assert!(grasped);
}

#[tokio::test(flavor = "multi_thread")]
async fn actions_and_states_of_a_vacuum_gripper_are_recorded() {
    let _alone = alone();
    let suction = Suction::new().with_object();
    let sim = Sim::fr3().ideal().vacuum_gripper(suction, 0);
    let sim = sim.wait_for_commands(PATIENCE).start().await.unwrap();
    let robot = connect(&sim).await;
    let address = sim.vacuum_gripper().expect("a gripper").addr();
    let gripper = VacuumGripper::connect(address).await.unwrap();
    let folder = Folder::new();
    let recorder = folder.recorder();
    recorder.attach(&robot, roomy()).await.unwrap();
    recorder.attach_vacuum_gripper(&gripper, "").unwrap();
    let suck = |vacuum, timeout| {
        let profile = Profile::P0;
        gripper.vacuum(Vacuum {
            vacuum,
            profile,
            timeout,
        })
    };
    assert!(suck(50, 2000).await.unwrap());
    assert!(gripper.drop_off(Duration::from_secs(1)).await.unwrap());
    assert!(!suck(70, 100).await.unwrap());
    let refused = suck(50, -1).await.unwrap_err();
    finish(recorder);
    robot.shutdown().await;

    let (_, events) = folder.read("");
    let told = events.iter().filter_map(|event| match &event.kind {
        EventKind::Request(request) if request.name.starts_with("vacuum") => {
            Some((request.name.as_str(), request.error.as_deref()))
        }
        _ => None,
    });
    let refused = refused.to_string();
    let expected = [
        ("vacuum.vacuum", None),
        ("vacuum.drop_off", None),
        ("vacuum.vacuum", Some("the action ended without success")),
        ("vacuum.vacuum", Some(refused.as_str())),
    ];
    assert_eq!(told.collect::<Vec<_>>(), expected);
    let recording = Recording::open(folder.file()).unwrap();
    let states = recording.robot("").unwrap().gripper_states();
    let held = states.map(Result::unwrap).any(|(_, state)| match state {
        GripperState::Vacuum(state) => state.part_present,
        GripperState::Hand(_) => false,
    });
    assert!(held);
}
