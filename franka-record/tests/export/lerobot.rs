//! Datasets in LeRobot's layout, checked through their own files.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use franka_record::Sample;
use franka_record::export::ExportError;
use franka_record::export::lerobot::{Action, Dataset, DatasetOptions};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};
use serde_json::Value;

const STATE: usize = 15;

/// Returns an empty folder for the test with this name.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("lerobot")
        .join(name);
    match fs::remove_dir_all(&folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => panic!("{error}"),
        _ => folder,
    }
}

/// Returns a sample of a hand that points down and turns about its own axis. It passes an
/// orientation at which a quaternion with a positive last number would change its sign.
fn sample(millisecond: u64) -> Sample {
    let t = millisecond as f64 * 1e-3;
    let q = |t: f64| std::array::from_fn(|i| 0.1 * (t + i as f64).sin());
    let pose = |t: f64| {
        let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.4 * t - 0.3);
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 3.1 + 0.05 * t);
        Isometry3::from_parts(Vector3::new(0.3 + 0.1 * t, 0.0, 0.5).into(), turned * down)
    };
    Sample {
        time: 5000 + millisecond,
        q: q(t),
        q_ref: Some(q(t + 0.01)),
        pose: pose(t),
        pose_ref: Some(pose(t + 0.01)),
        width: Some(0.08 - 0.01 * t),
        width_ref: None,
    }
}

fn options() -> DatasetOptions {
    DatasetOptions::new("franka_fr3").fps(20)
}

fn rows(root: &Path, file: &str) -> Vec<Row> {
    let file = File::open(root.join(file)).expect("it was written");
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    let rows = reader.get_row_iter(None).expect("rows");
    rows.collect::<Result<_, _>>().expect("readable rows")
}

fn cell<'a>(row: &'a Row, name: &str) -> &'a Field {
    let mut cells = row.get_column_iter();
    let found = cells.find(|(column, _)| *column == name);
    let (_, cell) = found.unwrap_or_else(|| panic!("no column {name}"));
    cell
}

fn number(row: &Row, name: &str) -> i64 {
    match cell(row, name) {
        Field::Long(value) => *value,
        other => panic!("{name}: {other}"),
    }
}

fn numbers(row: &Row, name: &str) -> Vec<f64> {
    let Field::ListInternal(list) = cell(row, name) else {
        panic!("{name} is no list");
    };
    let number = |field: &Field| match field {
        Field::Float(value) => f64::from(*value),
        Field::Double(value) => *value,
        other => panic!("{name}: {other}"),
    };
    list.elements().iter().map(number).collect()
}

fn json(root: &Path, file: &str) -> Value {
    let text = fs::read_to_string(root.join(file)).expect("it was written");
    serde_json::from_str(&text).expect("JSON")
}

fn near(got: f64, expected: f64) -> bool {
    (got - expected).abs() < 1e-6
}

#[test]
fn episodes_are_frames_with_the_next_reference_as_action() {
    let root = folder("frames");
    let mut dataset = Dataset::create(&root, options()).unwrap();
    // Every third state was lost.
    let with_losses = (0..=1990).filter(|k| k % 3 != 1).map(sample);
    assert_eq!(
        dataset
            .add_episode("pick", Some(true), with_losses)
            .unwrap(),
        40
    );
    let other = (100..600).map(sample);
    assert_eq!(
        dataset.add_episode("place", Some(false), other).unwrap(),
        10
    );
    let again = (0..=100).map(sample);
    assert_eq!(dataset.add_episode("pick", None, again).unwrap(), 3);
    dataset.finish().unwrap();

    let rows = rows(&root, "data/chunk-000/file-000.parquet");
    assert_eq!(rows.len(), 53);
    let mut before: Option<Vec<f64>> = None;
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(number(row, "index"), index as i64);
        let (episode, frame, task) = match index {
            0..40 => (0, index, 0),
            40..50 => (1, index - 40, 1),
            _ => (2, index - 50, 0),
        };
        assert_eq!(number(row, "episode_index"), episode);
        assert_eq!(number(row, "frame_index"), frame as i64);
        assert_eq!(number(row, "task_index"), task);
        let Field::Float(timestamp) = cell(row, "timestamp") else {
            panic!("no timestamp");
        };
        assert_eq!(*timestamp, frame as f32 / 20.0);
        let begin = if episode == 1 { 100 } else { 0 };
        let here = sample(begin + 50 * frame as u64);
        let [state, action] = ["observation.state", "action"].map(|name| numbers(row, name));
        assert_eq!((state.len(), action.len()), (STATE, STATE));
        assert!(
            (0..7).all(|i| near(state[i], here.q[i])),
            "{index}: {state:?}"
        );
        assert!(near(state[7], here.pose.translation.x), "{index}");
        // Grippers are read rarely: the width is from the last sample before.
        assert!((state[14] - here.width.unwrap()).abs() < 2e-5, "{index}");
        let is_last = [39, 49, 52].contains(&index);
        if !is_last {
            let next = sample(begin + 50 * (frame as u64 + 1)).q_ref.unwrap();
            assert!(
                (0..7).all(|i| near(action[i], next[i])),
                "{index}: {action:?}"
            );
        }
        assert_eq!(*cell(row, "next.done"), Field::Bool(is_last));
        assert_eq!(*cell(row, "next.success"), Field::Bool(index == 39));
        let turned: f64 = before
            .iter()
            .flat_map(|b| &b[10..14])
            .zip(&state[10..14])
            .map(|(a, b)| (a - b).abs())
            .sum();
        assert!(turned < 0.3, "{index}: the quaternion changes its sign");
        before = (!is_last).then_some(state);
    }
    let info = json(&root, "meta/info.json");
    assert_eq!(info["codebase_version"], "v3.0");
    assert_eq!(info["total_frames"], 53);
    assert_eq!(info["splits"]["train"], "0:3");
    assert_eq!(info["features"]["action"]["names"][14], "gripper.pos");
    let stats = json(&root, "meta/stats.json");
    assert_eq!(stats["frame_index"]["max"][0], 39.0);
    assert_eq!(stats["index"]["count"][0], 53);
    assert!(near(stats["index"]["mean"][0].as_f64().unwrap(), 26.0));
}

#[test]
fn episodes_are_added_to_a_dataset_that_is_there() {
    let root = folder("adding");
    let episode = |dataset: &mut Dataset, task: &str| {
        dataset
            .add_episode(task, Some(true), (0..500).map(sample))
            .unwrap();
    };
    let mut dataset = Dataset::create(&root, options()).unwrap();
    episode(&mut dataset, "pick");
    dataset.finish().unwrap();
    for task in ["place", "pick"] {
        let mut dataset = Dataset::open(&root, options()).unwrap();
        episode(&mut dataset, task);
        dataset.finish().unwrap();
    }
    // A dropped export changes nothing.
    let mut given_up = Dataset::open(&root, options()).unwrap();
    episode(&mut given_up, "never");
    drop(given_up);

    assert_eq!(Dataset::open(&root, options()).unwrap().episodes(), 3);
    let tasks = rows(&root, "meta/tasks.parquet");
    let texts: Vec<String> = tasks
        .iter()
        .map(|row| cell(row, "task").to_string())
        .collect();
    assert_eq!(texts, ["\"pick\"", "\"place\""]);
    for file in 0..3 {
        let name = format!("chunk-000/file-{file:03}.parquet");
        let episode = &rows(&root, &format!("meta/episodes/{name}"))[0];
        let begin = 10 * i64::from(file);
        assert_eq!(number(episode, "dataset_from_index"), begin);
        assert_eq!(number(episode, "dataset_to_index"), begin + 10);
        assert_eq!(number(episode, "data/file_index"), i64::from(file));
        assert_eq!(number(episode, "meta/episodes/file_index"), i64::from(file));
        let data = rows(&root, &format!("data/{name}"));
        assert_eq!(number(&data[0], "index"), begin);
        assert_eq!(number(&data[0], "task_index"), i64::from(file == 1));
    }
    assert_eq!(json(&root, "meta/stats.json")["index"]["max"][0], 29.0);
}

#[test]
fn cycles_around_the_motion_of_an_episode_are_left_out() {
    let root = folder("around");
    let samples = (0..300).map(|millisecond| {
        let mut sample = sample(millisecond);
        if !(60..=210).contains(&millisecond) {
            (sample.q_ref, sample.pose_ref) = (None, None);
        }
        sample
    });
    let mut dataset = Dataset::create(&root, options()).unwrap();
    assert_eq!(dataset.add_episode("pick", None, samples).unwrap(), 4);
    dataset.finish().unwrap();
    let rows = rows(&root, "data/chunk-000/file-000.parquet");
    let state = numbers(&rows[0], "observation.state");
    assert!(near(state[1], sample(60).q[1]), "{state:?}");
}

#[test]
fn invalid_episode_or_dataset_is_refused_with_a_reason() {
    let root = folder("refused");
    let refused = |result: Result<u64, ExportError>| result.unwrap_err().to_string();
    let mut dataset = Dataset::create(&root, options()).unwrap();
    let mut add = |samples: Vec<Sample>| refused(dataset.add_episode("pick", None, samples));
    assert_eq!(
        add(vec![]),
        "episode 0 of the dataset, with the task \"pick\": it has no cycles"
    );
    let gap = (0..10).chain(100..200).map(sample).collect();
    assert!(add(gap).contains("no cycle for 91 ms after 5009 ms"));
    assert!(add(vec![sample(7), sample(7)]).contains("back from 5007 ms to 5007 ms"));
    let without = |change: fn(&mut Sample)| {
        let mut samples: Vec<Sample> = (0..100).map(sample).collect();
        change(&mut samples[50]);
        samples
    };
    assert!(add(without(|it| it.width = None)).contains("have no state of the Hand"));
    assert!(add(without(|it| it.q_ref = None)).contains("no commanded position at 5050 ms"));
    let free = |it: Sample| Sample { q_ref: None, ..it };
    assert!(add(vec![free(sample(3))]).contains("at 5003 ms"));
    assert!(refused(dataset.add_episode(" ", None, [sample(0)])).contains("expected a text"));
    let nothing = dataset.finish().unwrap_err().to_string();
    assert!(nothing.contains("got no episodes"), "{nothing}");
    let mut dataset = Dataset::create(&root, options()).expect("an empty folder");
    dataset
        .add_episode("pick", None, (0..100).map(sample))
        .unwrap();
    drop(dataset);

    let measured = options().action(Action::Measured).gripper(false);
    let mut dataset = Dataset::create(&root, measured.clone()).unwrap();
    let by_hand = without(|it| (it.q_ref, it.width) = (None, None));
    dataset.add_episode("guide", None, by_hand).unwrap();
    dataset.finish().unwrap();
    let full = Dataset::create(&root, options()).unwrap_err().to_string();
    assert!(full.contains("expected an empty or new folder"), "{full}");
    for (other, what) in [
        (
            options(),
            "no width of a gripper: export without the gripper",
        ),
        (measured.clone().fps(30), "its fps is 20, expected 30"),
        (
            DatasetOptions::new("franka_fer").fps(20),
            "its robot_type is \"franka_fr3\"",
        ),
        (measured.clone().fps(0), "1 to 1000"),
    ] {
        let error = Dataset::open(&root, other).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
    // Half of an export that was interrupted between its files.
    let data = root.join("data/chunk-000");
    fs::copy(data.join("file-000.parquet"), data.join("file-001.parquet")).unwrap();
    let error = Dataset::open(&root, measured).unwrap_err().to_string();
    assert!(
        error.contains("the files in data have 4 rows, expected 2 as in meta/info.json"),
        "{error}"
    );
}

#[test]
fn dataset_with_cameras_is_refused_by_its_features() {
    let root = folder("cameras");
    let mut dataset = Dataset::create(&root, options()).unwrap();
    let samples = (0..100).map(sample);
    dataset.add_episode("pick", None, samples).unwrap();
    dataset.finish().unwrap();
    let mut info = json(&root, "meta/info.json");
    let features = info["features"].as_object_mut().unwrap();
    for camera in ["front", "wrist"] {
        let images = serde_json::json!({
            "dtype": "video", "shape": [480, 640, 3], "names": ["height", "width", "channels"],
        });
        features.insert(format!("observation.images.{camera}"), images);
    }
    features.remove("next.success");
    features["action"]["shape"] = serde_json::json!([7]);
    fs::write(root.join("meta/info.json"), info.to_string()).unwrap();
    let error = Dataset::open(&root, options()).unwrap_err().to_string();
    for difference in [
        "it also has observation.images.front, observation.images.wrist;",
        "it has no next.success",
        "shape of action is [7], expected [15]",
        "export to a folder of its own",
    ] {
        assert!(error.contains(difference), "{error}");
    }
    // Equal features are not named.
    assert!(!error.contains("observation.state"), "{error}");
    assert!(error.len() < 400, "{error}");
}

/// A child process of the test adds episodes until the test kills it.
#[test]
fn dataset_of_a_killed_export_takes_the_next_one() {
    const TO: &str = "FRANKA_RECORD_TEST_DATASET";
    if let Some(root) = std::env::var_os(TO) {
        let root = Path::new(&root);
        let mut dataset = match root.join("meta").exists() {
            true => Dataset::open(root, options()).unwrap(),
            false => Dataset::create(root, options()).unwrap(),
        };
        loop {
            let samples = (0..500).map(sample);
            dataset.add_episode("never", None, samples).unwrap();
            fs::write(root.with_extension("under-way"), "").unwrap();
        }
    }
    let root = folder("killed");
    let marker = root.with_extension("under-way");
    for episodes in [1, 2] {
        let _ = fs::remove_file(&marker);
        let mut child = std::process::Command::new(std::env::current_exe().unwrap())
            .args([
                "--exact",
                "lerobot::dataset_of_a_killed_export_takes_the_next_one",
            ])
            .env(TO, &root)
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        while !marker.exists() {
            assert!(child.try_wait().unwrap().is_none(), "it has ended");
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let next = || match episodes {
            1 => Dataset::create(&root, options()),
            _ => Dataset::open(&root, options()),
        };
        let refused = next().unwrap_err().to_string();
        assert!(
            refused.contains("another export to this folder is running"),
            "{refused}"
        );
        child.kill().unwrap();
        child.wait().unwrap();
        let mut dataset = next().unwrap();
        dataset
            .add_episode("pick", None, (0..500).map(sample))
            .unwrap();
        dataset.finish().unwrap();
        assert_eq!(json(&root, "meta/info.json")["total_episodes"], episodes);
    }
    assert_eq!(rows(&root, "meta/tasks.parquet").len(), 1);
    let mut left: Vec<_> = fs::read_dir(&root)
        .unwrap()
        .map(|it| it.unwrap().file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["data", "meta"]);
}

/// Simulates a power failure between any two files of a finished export.
#[test]
fn dataset_is_completed_where_a_finished_export_was_cut() {
    let root = folder("cut");
    let add = || {
        let mut dataset = match root.exists() {
            true => Dataset::open(&root, options()).unwrap(),
            false => Dataset::create(&root, options()).unwrap(),
        };
        let task = format!("task {}", dataset.episodes());
        dataset
            .add_episode(&task, None, (0..500).map(sample))
            .unwrap();
        dataset.finish().unwrap();
    };
    let files = [
        "data/chunk-000/file-001.parquet",
        "meta/episodes/chunk-000/file-001.parquet",
        "meta/tasks.parquet",
        "meta/stats.json",
        "meta/info.json",
    ];
    add();
    let before = files.map(|file| fs::read(root.join(file)).ok());
    add();
    let after = files.map(|file| fs::read(root.join(file)).unwrap());
    for moved in 0..files.len() {
        for (index, file) in files.iter().enumerate() {
            let staged = root.join(".export.complete").join(file);
            if index < moved {
                fs::write(root.join(file), &after[index]).unwrap();
                continue;
            }
            fs::create_dir_all(staged.parent().unwrap()).unwrap();
            fs::write(staged, &after[index]).unwrap();
            match &before[index] {
                Some(bytes) => fs::write(root.join(file), bytes).unwrap(),
                None => fs::remove_file(root.join(file)).unwrap(),
            }
        }
        assert_eq!(Dataset::open(&root, options()).unwrap().episodes(), 2);
        let now = files.map(|file| fs::read(root.join(file)).unwrap());
        assert!(now == after, "{moved}");
        assert!(!root.join(".export.complete").exists());
    }
}
