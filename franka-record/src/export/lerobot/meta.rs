//! The contents of a dataset's `meta/`: features, tasks, totals and statistics.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::Field as Cell;
use serde_json::{Value, json};

use super::DatasetOptions;
use super::frames::names;
use super::stats::Stats;
use crate::export::error::ExportError;
use crate::export::new_file::NewFile;
use crate::export::parquet::{Field, Kind, TableWriter, Values, at};

/// The version of the layout.
pub(super) const VERSION: &str = "v3.0";

/// Number of files in a folder `chunk-…`.
pub(super) const FILES_IN_CHUNK: u64 = 1000;

/// Size at which the next episode goes to a new data file, `[MB]`.
pub(super) const DATA_FILE_MB: usize = 100;

/// Columns of each frame that do not describe the robot, in order.
pub(super) const BOOKKEEPING: [(&str, &str); 5] = [
    ("timestamp", "float32"),
    ("frame_index", "int64"),
    ("episode_index", "int64"),
    ("index", "int64"),
    ("task_index", "int64"),
];

/// Flags of each frame.
pub(super) const FLAGS: [&str; 2] = ["next.done", "next.success"];

/// Columns that describe the robot.
pub(super) const VECTORS: [&str; 2] = ["observation.state", "action"];

#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    pub(super) tasks: Vec<String>,
    pub(super) episodes: u64,
    pub(super) frames: u64,
    pub(super) stats: BTreeMap<String, Stats>,
}

fn features(gripper: bool) -> Value {
    let names = names(gripper);
    let vectors = VECTORS.map(|name| {
        let feature = json!({ "dtype": "float32", "shape": [names.len()], "names": names });
        (name, feature)
    });
    let one = |dtype: &str| json!({ "dtype": dtype, "shape": [1], "names": null });
    let flags = FLAGS.map(|name| (name, one("bool")));
    let rest = BOOKKEEPING.map(|(name, dtype)| (name, one(dtype)));
    let all = vectors.into_iter().chain(flags).chain(rest);
    Value::Object(all.map(|(name, it)| (name.to_owned(), it)).collect())
}

/// Writes the tasks and the statistics, and then `info.json`.
pub(super) fn write(
    root: &Path,
    options: &DatasetOptions,
    contents: &Contents,
) -> Result<(), ExportError> {
    write_tasks(&root.join("meta/tasks.parquet"), &contents.tasks)?;
    let stats = contents.stats.iter();
    let stats: Value = stats
        .map(|(name, it)| (name.clone(), it.to_json()))
        .collect();
    write_json(&root.join("meta/stats.json"), &stats)?;
    let info = json!({
        "codebase_version": VERSION,
        "robot_type": options.robot_type,
        "total_episodes": contents.episodes,
        "total_frames": contents.frames,
        "total_tasks": contents.tasks.len(),
        "chunks_size": FILES_IN_CHUNK,
        "data_files_size_in_mb": DATA_FILE_MB,
        "video_files_size_in_mb": 200,
        "fps": options.fps,
        "splits": { "train": format!("0:{}", contents.episodes) },
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": null,
        "features": features(options.gripper),
    });
    write_json(&info_path(root), &info)
}

fn info_path(root: &Path) -> PathBuf {
    root.join("meta/info.json")
}

/// Reads the contents of a dataset, if it matches the options.
///
/// # Errors
/// Returns [`ExportError::Dataset`] with the difference if the dataset does not match the options.
pub(super) fn read(root: &Path, options: &DatasetOptions) -> Result<Contents, ExportError> {
    let refused = |why: String| ExportError::Dataset {
        path: root.to_owned(),
        why,
    };
    let info = read_json(&info_path(root))?;
    let expected = [
        ("codebase_version", json!(VERSION)),
        ("robot_type", json!(options.robot_type)),
        ("fps", json!(options.fps)),
    ];
    for (key, expected) in expected {
        let got = info.get(key).unwrap_or(&Value::Null);
        if *got != expected {
            return Err(refused(format!("its {key} is {got}, expected {expected}")));
        }
    }
    let got = info.get("features").unwrap_or(&Value::Null);
    if let Some(why) = difference(got, options.gripper) {
        return Err(refused(why));
    }
    let number = |key: &str| {
        let got = info.get(key).unwrap_or(&Value::Null);
        let wrong = || refused(format!("its {key} is {got}, expected a number"));
        got.as_u64().ok_or_else(wrong)
    };
    let (episodes, frames) = (number("total_episodes")?, number("total_frames")?);
    let tasks = read_tasks(&root.join("meta/tasks.parquet"))?;
    let all = read_json(&root.join("meta/stats.json"))?;
    let mut stats = BTreeMap::new();
    for (name, width) in widths(options.gripper) {
        let read = all.get(name).and_then(|it| Stats::from_json(it, width));
        let read = read.ok_or_else(|| {
            refused(format!(
                "meta/stats.json has no complete statistics of {name}"
            ))
        })?;
        stats.insert(name.to_owned(), read);
    }
    Ok(Contents {
        tasks,
        episodes,
        frames,
        stats,
    })
}

/// Returns the difference between a dataset's features and the features to write, and the user's
/// options; `None` if the features are the same.
fn difference(got: &Value, gripper: bool) -> Option<String> {
    let expected = features(gripper);
    if *got == expected {
        return None;
    }
    if *got == features(!gripper) {
        let (has, to) = match gripper {
            true => ("no width of a gripper", "without"),
            false => ("the width of a gripper", "with"),
        };
        return Some(format!("it has {has}: export {to} the gripper"));
    }
    let empty = serde_json::Map::new();
    let got = got.as_object().unwrap_or(&empty);
    let expected = expected.as_object().unwrap_or(&empty);
    let mut differences = Vec::new();
    let more = got.keys().filter(|name| !expected.contains_key(*name));
    let more: Vec<&str> = more.map(String::as_str).collect();
    if !more.is_empty() {
        differences.push(format!("it also has {}", more.join(", ")));
    }
    for (name, expected) in expected {
        let Some(got) = got.get(name) else {
            differences.push(format!("it has no {name}"));
            continue;
        };
        for key in ["dtype", "shape"] {
            if got[key] != expected[key] {
                let (got, expected) = (&got[key], &expected[key]);
                differences.push(format!("{key} of {name} is {got}, expected {expected}"));
            }
        }
        if got["names"] != expected["names"] {
            differences.push(format!("the names of {name} are {}", got["names"]));
        }
    }
    // The other features may have more keys, as features of videos do.
    if differences.is_empty() {
        differences.push("the features have other properties".into());
    }
    Some(format!(
        "its features differ: {}; export to a folder of its own",
        differences.join("; ")
    ))
}

/// Returns every feature with its number of values per frame.
pub(super) fn widths(gripper: bool) -> impl Iterator<Item = (&'static str, usize)> {
    let vectors = VECTORS.map(|name| (name, names(gripper).len()));
    let rest = BOOKKEEPING.map(|(name, _)| (name, 1));
    let flags = FLAGS.map(|name| (name, 1));
    vectors.into_iter().chain(flags).chain(rest)
}

/// Writes the tasks by their number. Pandas uses the task texts as the index of the table.
fn write_tasks(path: &Path, tasks: &[String]) -> Result<(), ExportError> {
    let column = |name: &str, kind: &str, numpy: &str| json!({ "name": name, "field_name": name, "pandas_type": kind, "numpy_type": numpy, "metadata": null });
    let pandas = json!({
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [column("task_index", "int64", "int64"), column("task", "unicode", "object")],
        "creator": { "library": "pyarrow", "version": "20.0.0" },
        "pandas_version": "2.2.0",
    });
    let fields = vec![
        Field::new("task_index", Kind::Int),
        Field::new("task", Kind::Text),
    ];
    let mut table = TableWriter::new(
        NewFile::create(path)?,
        fields,
        &[("pandas", pandas.to_string())],
    )?;
    let numbers = (0..tasks.len() as i64).collect();
    table.write(&[Values::Int(numbers), Values::Text(tasks.to_vec())])?;
    table.finish()
}

fn read_tasks(path: &Path) -> Result<Vec<String>, ExportError> {
    let reader = open(path)?;
    let mut tasks = BTreeMap::new();
    for row in reader.get_row_iter(None).map_err(at(path))? {
        let row = row.map_err(at(path))?;
        let (mut number, mut text) = (None, None);
        for (name, cell) in row.get_column_iter() {
            match (name.as_str(), cell) {
                ("task_index", Cell::Long(value)) => number = Some(*value),
                // The name that pandas gives to an unnamed index.
                ("task" | "__index_level_0__", Cell::Str(value)) => text = Some(value.clone()),
                _ => {}
            }
        }
        let (Some(number), Some(text)) = (number, text) else {
            let why =
                format!("got the row {row} in meta/tasks.parquet, expected task_index and task");
            return Err(ExportError::Dataset {
                path: path.to_owned(),
                why,
            });
        };
        tasks.insert(number, text);
    }
    Ok(tasks.into_values().collect())
}

pub(super) fn rows_in(path: &Path) -> Result<u64, ExportError> {
    let rows = open(path)?.metadata().file_metadata().num_rows();
    Ok(u64::try_from(rows).unwrap_or_default())
}

fn open(path: &Path) -> Result<SerializedFileReader<File>, ExportError> {
    let file = File::open(path).map_err(ExportError::at(path))?;
    SerializedFileReader::new(file).map_err(at(path))
}

fn write_json(path: &Path, value: &Value) -> Result<(), ExportError> {
    let text = serde_json::to_string_pretty(value).expect("numbers, texts and lists");
    let mut file = NewFile::create(path)?;
    file.write_all(text.as_bytes())
        .map_err(ExportError::at(path))?;
    file.finish()
}

fn read_json(path: &Path) -> Result<Value, ExportError> {
    let text = fs::read_to_string(path).map_err(ExportError::at(path))?;
    serde_json::from_str(&text).map_err(|error| ExportError::Dataset {
        path: path.to_owned(),
        why: error.to_string(),
    })
}
