//! A recording of the arms of a team.

use franka_async::Robot;
use franka_async::recording::{RecordError, Track, TrackError};
use franka_record::event::{Ending, Target};
use franka_record::{EventKind, Recording};

use super::{Folder, assert_no_gap, endings, finish, near, roomy};
use crate::alone;
use crate::team::{two, up};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn each_arm_of_a_team_is_recorded_by_its_name() {
    let _alone = alone();
    let two = two().await;
    let folder = Folder::new();
    let recorder = folder.recorder();
    let names = ["left", "right"];
    let tracks = || {
        names.map(|name| Track {
            name: name.into(),
            ..roomy()
        })
    };
    recorder.attach_team(&two.team, tracks()).await.unwrap();
    let again = recorder.attach_team(&two.team, tracks()).await.unwrap_err();
    assert!(
        matches!(&again, TrackError::Record(RecordError::SameName { name }) if name == "left"),
        "{again}"
    );
    let targets = two.robots.each_ref().map(|robot| up(0.01) * robot.pose());
    for outcome in two.team.move_to(targets).await {
        outcome.expect("it arrives");
    }
    let status = finish(recorder);
    assert_eq!(status.dropped, 0);

    let recording = Recording::open(folder.file()).unwrap();
    let recorded = recording.robots().iter().map(|robot| robot.kind);
    let kinds = two
        .robots
        .each_ref()
        .map(|robot: &Robot| Some(robot.model().kind()));
    assert_eq!(recorded.collect::<Vec<_>>(), kinds);
    let mut all = 0;
    for (member, (name, target)) in names.into_iter().zip(targets).enumerate() {
        let (cycles, events) = folder.read(name);
        all += cycles.len() as u64;
        assert_no_gap(&cycles);
        let ended = endings(&events);
        let [(goal, Ending::Arrived)] = ended[..] else {
            panic!("{name}: {ended:?}");
        };
        let under_way = cycles.iter().filter(|cycle| cycle.record.goal == goal);
        assert!(under_way.count() > 100, "{name}");
        let mut given = events.iter().filter_map(|event| match &event.kind {
            EventKind::Goal(given) if given.number == goal => given.target,
            _ => None,
        });
        let Some(Target::Pose(pose)) = given.next() else {
            panic!("{name}: {events:?}");
        };
        assert!(near(&pose, &target), "{name}");
        let expected = format!("member {member} of the team of left, right");
        let is_told =
            |kind: &EventKind| matches!(kind, EventKind::Note(note) if note.text == expected);
        assert!(events.iter().any(|event| is_told(&event.kind)), "{name}");
    }
    assert_eq!(all, status.cycles);
}
