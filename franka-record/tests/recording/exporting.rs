//! Episodes of a file as datasets, tables and replays.

use std::time::{Duration, Instant};

use franka_model::{Model, RobotKind};
use franka_proto::gripper;
use franka_record::export::lerobot::{Dataset, DatasetOptions};
use franka_record::export::{Columns, write_csv};
use franka_record::recorder::{Recorder, Robot};
use franka_record::replay::{ReplayError, ReplayOptions, ReplayPlan};
use franka_record::{Episode, EventKind, GripperState, Recording, Sample, Samples};

use crate::feed::{Arm, Scratch, quick};
use crate::standard::{PYTHON, python};

/// Records four seconds of an arm with a gripper that closes. An episode lasts from the first to
/// the third second.
fn recorded(path: &std::path::Path) {
    let recorder = Recorder::to_file(path, quick()).unwrap();
    let began = Instant::now();
    let (mut arm, handle) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    let at = |ms| handle.clock().at(began + Duration::from_millis(ms));
    for ms in (0..4000).step_by(100) {
        let state = gripper::State {
            width: 0.08 - 1e-5 * ms as f64,
            ..gripper::State::default()
        };
        handle.gripper_at(at(ms), GripperState::Hand(state));
    }
    let (name, task) = ("pick-1".to_owned(), "pick the cube".to_owned());
    handle.event_at(at(1000), EventKind::EpisodeStart { name, task });
    let success = Some(true);
    handle.event_at(at(3000), EventKind::EpisodeEnd { success });
    arm.run(&recorder, 4000);
    recorder.finish().unwrap();
}

#[test]
#[ignore = "needs Python with pyarrow: `cargo xtask check --only recordings` has it"]
fn python_reads_a_dataset_of_a_recording() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    recorded(&path);
    let recording = Recording::open(&path).unwrap();
    let robot = recording.robot("").unwrap();
    let folder = scratch.path("dataset");
    let mut dataset = Dataset::create(&folder, DatasetOptions::new("fr3").gripper(true)).unwrap();
    let mut frames = 0;
    // The same samples twice, with two tasks.
    for task in ["pick the cube", "pick it again"] {
        let samples = Samples::new(robot.cycles(), robot.gripper_states());
        let samples: Vec<Sample> = samples.collect::<Result<_, _>>().unwrap();
        frames += dataset.add_episode(task, Some(true), samples).unwrap();
    }
    dataset.finish().unwrap();

    let arguments = [folder.into_os_string(), frames.to_string().into()];
    python("dataset.py", PYTHON, &arguments);
    if std::env::var_os(LEROBOT).is_some() {
        let arguments = [&["--lerobot".into()], &arguments[..]].concat();
        python("dataset.py", LEROBOT, &arguments);
    }
}

/// Environment variable with the path of an interpreter that has LeRobot.
const LEROBOT: &str = "FRANKA_LEROBOT_PYTHON";

#[test]
fn an_episode_of_a_file_becomes_a_dataset_a_table_and_a_replay() {
    let scratch = Scratch::new();
    let path = scratch.path("run.mcap");
    recorded(&path);
    let recording = Recording::open(&path).unwrap();
    let robot = recording.robot("").unwrap();
    let episodes = Episode::of(robot.events()).unwrap();
    let [episode] = &episodes[..] else {
        panic!("{episodes:?}");
    };
    assert_eq!(
        (&*episode.name, &*episode.task),
        ("pick-1", "pick the cube")
    );
    let part = robot.from(episode.begin).to(episode.end);
    let widths = robot.to(episode.end).gripper_states();
    let samples: Vec<Sample> = Samples::new(part.cycles(), widths)
        .collect::<Result<_, _>>()
        .unwrap();
    // The times of the cycles and of the marks are taken at slightly different moments.
    assert!((1990..=2001).contains(&samples.len()), "{}", samples.len());
    let width = samples[0].width.unwrap();
    assert!((width - 0.07).abs() < 2e-3, "{width}");

    let mut dataset = Dataset::create(scratch.path("dataset"), DatasetOptions::new("fr3")).unwrap();
    let frames = dataset.add_episode(&episode.task, episode.success, samples.iter().copied());
    assert!((59..=61).contains(&frames.unwrap()));
    dataset.finish().unwrap();

    let mut text = Vec::new();
    let columns = Columns::named(["q"]).unwrap();
    let rows = write_csv(part.cycles(), &columns, false, &mut text).unwrap();
    assert_eq!(rows, samples.len() as u64);

    // The joints of this synthetic arm leave their ranges: the plan succeeds, and the check refuses
    // it.
    let kind = recording.robots()[0].kind.expect("the file says it");
    let model = Model::of(kind);
    let plan = ReplayPlan::new(kind, &samples, ReplayOptions::default(), model).unwrap();
    let took = Duration::from_millis(samples.len() as u64);
    assert!(plan.duration().abs_diff(took) <= Duration::from_millis(20));
    let state = franka_proto::RobotState::default();
    let refused = plan.check(model, &state).unwrap_err();
    assert!(matches!(refused, ReplayError::Target { .. }), "{refused}");
}
