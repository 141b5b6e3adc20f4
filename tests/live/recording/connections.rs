//! Recordings of robots with a silent link, with a new connection, or without a connection.

use std::future::IntoFuture;
use std::time::Duration;

use franka_async::MotionError;
use franka_async::recording::{Track, TrackError};
use franka_async::state::RobotMode;
use franka_async::supervision::Condition;
use franka_record::EventKind;
use franka_record::event::Ending;
use franka_sim::Sim;

use super::{Folder, assert_no_gap, divided, endings, finish, roomy};
use crate::supervising::{
    condition, connected, policy, restart, small_motion, start, supervised, told,
};
use crate::{alone, long_way, simulated, under_way, until};

#[tokio::test(flavor = "multi_thread")]
async fn lost_link_is_recorded_and_cycles_resume_after_it() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let folder = Folder::new();
    let recorder = folder.recorder();
    recorder.attach(&robot, roomy()).await.unwrap();
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    // The cycle of the simulator stands still until the motion has ended.
    let (release, held) = std::sync::mpsc::channel::<()>();
    let silence = sim.with(move |_| held.recv().is_err());
    let (silent, outcome) = tokio::join!(silence, async {
        let outcome = moving.await.unwrap();
        drop(release);
        outcome
    });
    silent.unwrap();
    let error = outcome.unwrap_err();
    assert!(matches!(error, MotionError::LinkLost { .. }), "{error}");
    until(&robot, |state| state.robot_mode != RobotMode::Move).await;
    robot.recover().await.unwrap();
    finish(recorder);
    robot.shutdown().await;

    let (cycles, events) = folder.read("");
    assert_no_gap(&cycles);
    let ended = endings(&events);
    assert!(matches!(ended[..], [(_, Ending::LinkLost)]), "{ended:?}");
    let of_link: Vec<_> = events
        .iter()
        .filter_map(|event| match event.kind {
            EventKind::LinkLost { .. } => Some((true, event.time)),
            EventKind::LinkRestored { .. } => Some((false, event.time)),
            _ => None,
        })
        .collect();
    let [(true, lost), (false, restored)] = of_link[..] else {
        panic!("{of_link:?}");
    };
    assert!(lost < restored);
    let gap = cycles
        .windows(2)
        .map(|pair| pair[1].time.since(pair[0].time));
    assert!(gap.max() >= Some(Duration::from_millis(900)));
    assert!(cycles.iter().any(|cycle| cycle.time > lost));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_recording_goes_on_when_a_supervised_robot_is_there_again() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    let mut happening = robot.events();
    let folder = Folder::new();
    let recorder = folder.recorder();
    recorder.attach(&robot, roomy()).await.unwrap();
    small_motion(&robot).await.expect("it is ready");
    sim.stop().await;
    let _sim = restart(address).await;
    told(&mut happening, connected).await;
    condition(&robot, Condition::Ready).await;
    small_motion(&robot).await.expect("it is ready again");
    let status = finish(recorder);
    robot.shutdown().await;

    let (cycles, events) = folder.read("");
    assert_eq!((cycles.len() as u64, status.dropped), (status.cycles, 0));
    // The clock of the robot starts again.
    let parts = divided(&cycles);
    let [first, second] = parts[..] else {
        panic!("{} parts", parts.len());
    };
    let ended = endings(&events);
    let [(one, Ending::Arrived), (other, Ending::Arrived)] = ended[..] else {
        panic!("{ended:?}");
    };
    for (part, goal) in [(first, one), (second, other)] {
        let goals: Vec<_> = part.iter().map(|cycle| cycle.record.goal).collect();
        assert!(goals.contains(&goal), "the motion of goal {goal}");
        assert!(
            goals.iter().all(|it| [0, goal].contains(it)),
            "and no other"
        );
    }
    let told = events.iter().filter_map(|event| match &event.kind {
        EventKind::Note(note) => ["connection lost", "connected"]
            .into_iter()
            .find(|begin| note.text.starts_with(begin)),
        EventKind::Outcome(_) => Some("arrived"),
        _ => None,
    });
    let told: Vec<_> = told.collect();
    let expected = ["arrived", "connection lost", "connected", "arrived"];
    assert_eq!(told, expected);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_without_a_connection_is_not_recorded() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let folder = Folder::new();
    let recorder = folder.recorder();
    sim.stop().await;
    robot.closed().await;
    let error = recorder.attach(&robot, Track::default()).await.unwrap_err();
    assert!(matches!(error, TrackError::Cycles(_)), "{error}");
    assert_eq!(finish(recorder).cycles, 0);
}
