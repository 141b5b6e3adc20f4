//! Content of a recording of robots over real sockets, read back from its file.

mod connections;
mod hands;
mod team;

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use franka_async::control::JointVelocities;
use franka_async::diagnosis::Diagnose;
use franka_async::goal;
use franka_async::recording::{BlackBox, RecordOptions, RecordStatus, Recorder, Track, TrackError};
use franka_async::settings::CollisionBehavior;
use franka_async::state::RobotState;
use franka_async::{Engage, MotionError, Pose};
use franka_record::event::{Ending, Target};
use franka_record::{Cycle, Event, EventKind, Recording};
use franka_sim::{Sim, Tool};
use tokio::sync::watch;

use crate::{alone, at_the_clients_pace, long_way, simulated, under_way};

/// A folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("franka-recording-{}-{count}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir(&path).expect("a new folder");
        Self(path)
    }

    fn file(&self) -> PathBuf {
        self.0.join("run.mcap")
    }

    fn recorder(&self) -> Recorder {
        Recorder::to_file(self.file(), RecordOptions::default()).expect("a new file")
    }

    /// Cycles and events of the robot of this name.
    fn read(&self, name: &str) -> (Vec<Cycle>, Vec<Event>) {
        let recording = Recording::open(self.file()).expect("a recording");
        let robot = recording.robot(name).expect("it was recorded");
        let cycles = robot.cycles().map(|cycle| cycle.expect("a cycle"));
        let events = robot.events().map(|event| event.expect("an event"));
        (cycles.collect(), events.collect())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Room for every cycle of these tests: none is lost however late the recorder comes to run.
fn roomy() -> Track {
    Track {
        capacity: 65_536,
        ..Track::default()
    }
}

fn finish(recorder: Recorder) -> RecordStatus {
    let status = recorder.finish().expect("the disk takes it");
    assert_eq!(status.events_dropped, 0, "{status:?}");
    status
}

/// The cycles, divided at gaps. A robot at rest waits for no client: states that came too fast for
/// the control thread are no cycles.
fn divided(cycles: &[Cycle]) -> Vec<&[Cycle]> {
    let follows = |before: &Cycle, after: &Cycle| {
        let [before, after] = [before, after].map(|cycle| cycle.record);
        before.time + after.skipped + 1 == after.time
    };
    cycles.chunk_by(follows).collect()
}

fn assert_no_gap(cycles: &[Cycle]) {
    let parts = divided(cycles);
    let begins: Vec<_> = parts.iter().map(|part| part[0].record.time).collect();
    assert_eq!(parts.len(), 1, "they begin anew at {begins:?}");
}

/// Number and ending of each goal that ended.
fn endings(events: &[Event]) -> Vec<(u64, Ending)> {
    let ended = |event: &Event| match &event.kind {
        EventKind::Outcome(outcome) => Some((outcome.goal, outcome.ending)),
        _ => None,
    };
    events.iter().filter_map(ended).collect()
}

fn near(a: &Pose, b: &Pose) -> bool {
    // Poses are recorded as 32-bit floats.
    let turned = a.rotation.angle_to(&b.rotation);
    (a.translation.vector - b.translation.vector).norm() < 1e-6 && turned < 1e-3
}

#[tokio::test(flavor = "multi_thread")]
async fn a_motion_is_recorded_with_every_cycle_and_what_was_asked_for() {
    let _alone = alone();
    for sim in [Sim::fr3(), Sim::fer()] {
        let (robot, _sim) = at_the_clients_pace(sim.ideal().tool(Tool::hand())).await;
        let folder = Folder::new();
        let recorder = folder.recorder();
        let attached = robot.state().message_id;
        recorder.attach(&robot, roomy()).await.unwrap();
        let behavior = CollisionBehavior::careful();
        robot.set_collision_behavior(behavior).await.unwrap();
        let start = robot.pose();
        let target = Pose::translation(0.0, 0.0, 0.02) * start;
        let report = robot.move_to(target).await.unwrap();
        // All events before this call are in the recording.
        let status = finish(recorder);
        robot.shutdown().await;
        assert_eq!(status.dropped, 0);

        let (cycles, events) = folder.read("");
        assert_eq!(cycles.len() as u64, status.cycles);
        assert_no_gap(&cycles);
        assert!(cycles.is_sorted_by_key(|cycle| cycle.time));
        // Also of requests before the first cycle.
        let times: Vec<_> = events.iter().map(|event| event.robot_time).collect();
        assert!(times.iter().all(|time| *time >= attached), "{times:?}");
        let moving: Vec<_> = cycles
            .iter()
            .filter(|cycle| cycle.record.goal > 0)
            .collect();
        let duration = report.duration.as_millis() as usize;
        assert!(moving.len() >= duration, "{} of {duration}", moving.len());
        let number = moving[0].record.goal;
        for cycle in &moving {
            let headed = cycle.record.pose_target.map(|pose| near(&pose, &target));
            assert_ne!(headed, Some(false), "{:?}", cycle.record.pose_target);
        }
        assert!(moving[10].record.pose_target.is_some());
        let reference = moving[10].reference.expect("target control has one");
        let way = reference.translation.vector - start.translation.vector;
        assert!(way.norm() < 0.02, "{way}");

        let asked = events.iter().filter_map(|event| match &event.kind {
            EventKind::Request(request) if request.name != "urdf" => Some(request.name.clone()),
            EventKind::Goal(goal) => {
                assert_eq!(goal.number, number);
                let Some(Target::Pose(pose)) = goal.target else {
                    panic!("{:?}", goal.target);
                };
                assert!(near(&pose, &target));
                Some(goal.kind.clone())
            }
            EventKind::Outcome(outcome) => {
                assert_eq!((outcome.goal, outcome.ending), (number, Ending::Arrived));
                assert_eq!(outcome.duration, Some(report.duration));
                Some("arrived".to_owned())
            }
            _ => None,
        });
        let asked: Vec<_> = asked.collect();
        assert_eq!(asked, ["set_collision_behavior", "move_to", "arrived"]);

        let recording = Recording::open(folder.file()).unwrap();
        let described = &recording.robots()[0];
        let protocol = robot.version().number().to_string();
        assert_eq!(described.kind, Some(robot.model().kind()));
        assert_eq!(described.metadata.get("protocol"), Some(&protocol));
        let address = robot.address().ip().to_string();
        let told = format!("{:?} {:?}", described.metadata, recording.metadata());
        assert!(!told.contains(&address), "{told}");
        let urdf = recording.attachments().unwrap();
        let has_urdf = urdf.iter().any(|name| name.contains("urdf"));
        assert_eq!(has_urdf, robot.version().number() >= 10, "{urdf:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn reflex_is_recorded_with_diagnosis_and_black_box() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let folder = Folder::new();
    let options = RecordOptions {
        black_box: Some(BlackBox {
            after: Duration::ZERO,
            ..BlackBox::new(folder.0.join("incidents"))
        }),
        ..RecordOptions::default()
    };
    let recorder = Recorder::to_file(folder.file(), options).unwrap();
    recorder.attach(&robot, roomy()).await.unwrap();
    let mut calls = 0;
    let stepping = robot.control_joint_velocities(move |_: &RobotState, _| {
        calls += 1;
        let mut dq = [0.0; 7];
        dq[3] = if calls < 100 { 0.0 } else { 0.5 };
        JointVelocities(dq)
    });
    let stepping = stepping.limit_rate(false).cutoff_frequency(1000.0);
    let error = stepping.await.unwrap_err();
    robot.recover().await.unwrap();
    let status = finish(recorder);
    robot.shutdown().await;

    let (cycles, events) = folder.read("");
    assert_no_gap(&cycles);
    let end = cycles.iter().find(|cycle| !cycle.record.errors.is_empty());
    assert!(end.is_some(), "the cycle that shows the reflex");
    let ended = endings(&events);
    assert!(matches!(ended[..], [(_, Ending::Reflex)]), "{ended:?}");
    let expected = error.diagnose().expect("a reflex").to_string();
    let diagnosed = events.iter().find_map(|event| match &event.kind {
        EventKind::Diagnosis(diagnosis) => Some(diagnosis),
        _ => None,
    });
    let diagnosed = diagnosed.expect("a diagnosis");
    assert_eq!(diagnosed.text, expected);
    assert!(diagnosed.json.starts_with('{'), "{}", diagnosed.json);
    let recovered = events.iter().any(|event| match &event.kind {
        EventKind::Request(request) => request.name == "recover" && request.error.is_none(),
        _ => false,
    });
    assert!(recovered);
    let [incident] = &status.black_boxes[..] else {
        panic!("{:?}", status.black_boxes);
    };
    let name = incident.file_name().unwrap().to_string_lossy();
    assert!(name.ends_with("-fr3-reflex.mcap"), "{name}");
    assert!(Recording::open(incident).unwrap().span().is_some());
}

#[tokio::test(flavor = "multi_thread")]
async fn targets_that_are_refused_are_told() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let folder = Folder::new();
    let recorder = folder.recorder();
    recorder.attach(&robot, roomy()).await.unwrap();
    let (targets, newest) = watch::channel(robot.pose());
    let following = tokio::spawn(robot.follow(newest).into_future());
    under_way(&robot).await;
    targets.send_replace(Pose::translation(2.0, 0.0, 0.5));
    let of_stream = following.await.unwrap().unwrap_err();

    let arm = robot.engage(Engage::default()).await.unwrap();
    let mut q = robot.state().q_d;
    q[3] = 1.0;
    let bent = goal::Chunk::joints([(Duration::from_millis(500), q)]).unwrap();
    let of_chunk = arm.chunk(bent).await.unwrap_err();
    let of_set = arm.set(goal::Target::Joints(q)).await.unwrap_err();
    finish(recorder);
    robot.shutdown().await;

    let (_, events) = folder.read("");
    for refused in [of_stream, of_chunk, of_set] {
        assert!(matches!(refused, MotionError::Goal(_)), "{refused}");
        let told = |event: &Event| match &event.kind {
            EventKind::Outcome(outcome) => {
                outcome.ending == Ending::Rejected && outcome.text == refused.to_string()
            }
            _ => false,
        };
        assert!(events.iter().any(told), "{refused}: {events:?}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn recorder_ended_in_mid_motion_leaves_file_and_motion() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let folder = Folder::new();
    let recorder = folder.recorder();
    let other = Recorder::black_box(BlackBox::new(folder.0.join("incidents"))).unwrap();
    recorder.attach(&robot, roomy()).await.unwrap();
    other.attach(&robot, roomy()).await.unwrap();
    let again = recorder.attach(&robot, roomy()).await.unwrap_err();
    assert!(matches!(again, TrackError::Record(_)), "{again}");
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    drop(other);
    let status = finish(recorder);
    let report = moving.await.unwrap().expect("the motion goes on");
    assert_eq!((report.lost_states, report.success_rate_min), (0, 1.0));
    let (cycles, events) = folder.read("");
    assert_eq!(cycles.len() as u64, status.cycles);
    assert_no_gap(&cycles);
    assert!(endings(&events).is_empty(), "it had not ended");
    robot.shutdown().await;
}

/// The ring has room for one cycle, and the recorder looks 50 times a second.
#[tokio::test(flavor = "multi_thread")]
async fn every_cycle_that_is_missing_is_told() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let folder = Folder::new();
    let recorder = folder.recorder();
    let track = Track {
        name: "left".into(),
        capacity: 1,
        ..Track::default()
    };
    recorder.attach(&robot, track).await.unwrap();
    long_way(&robot).await.unwrap();
    let status = finish(recorder);
    robot.shutdown().await;

    let (cycles, events) = folder.read("left");
    // A robot in motion waits for every command, so the recorder has dropped the missing ones.
    let moving: Vec<_> = cycles
        .iter()
        .filter(|cycle| cycle.record.goal > 0)
        .collect();
    let [first, .., last] = moving[..] else {
        panic!("{} cycles of the motion", moving.len());
    };
    let missing = last.record.time + 1 - first.record.time - moving.len() as u64;
    let dropped = |event: &Event| match event.kind {
        EventKind::Dropped { cycles } => Some((event.time, cycles)),
        _ => None,
    };
    let dropped: Vec<_> = events.iter().filter_map(dropped).collect();
    let within = dropped
        .iter()
        .filter(|(time, _)| first.time < *time && *time <= last.time);
    assert_eq!(within.map(|(_, cycles)| cycles).sum::<u64>(), missing);
    assert_eq!(
        dropped.iter().map(|(_, cycles)| cycles).sum::<u64>(),
        status.dropped
    );
    assert!(missing > 0, "{status:?}");
}
