//! Exports episodes as a dataset in LeRobot's layout v3.0, for training.
//!
//! ```text
//! samples at 1 kHz -> frames at `fps` -> data/chunk-000/file-000.parquet       a row per frame
//!                          '-> stats --> meta/episodes/chunk-000/file-000.parquet  a row per episode
//!                                        meta/{info.json, stats.json, tasks.parquet}
//! ```
//!
//! * `frames`: resampling, and the names of the numbers.
//! * `stats`: statistics of each feature, from the minimum to the quantiles.
//! * `meta`: the files in `meta/` of the whole dataset.
//! * `episodes`: the table with a row per episode.
//! * `staging`: makes an export one atomic step.
//!
//! Every export adds new files, and rewrites only the three files of the whole dataset.

mod episodes;
mod frames;
mod meta;
mod staging;
mod stats;

use std::fs;
use std::path::{Path, PathBuf};

use super::error::ExportError;
use super::new_file::NewFile;
use super::parquet::{Field, Kind, TableWriter, Values};
use crate::sample::Sample;
use episodes::{Episode, FileNumber};
use frames::Frames;
use meta::{BOOKKEEPING, Contents, FLAGS, VECTORS};
use staging::Staging;
use stats::Stats;

/// Settings that all episodes of a dataset share.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DatasetOptions {
    /// Frames per second, 1 to 1000. Policies are usually trained at 15 to 50 frames per second.
    pub fps: u16,
    /// Name of the robot, for example `franka_fr3` or `franka_fer`.
    pub robot_type: String,
    /// True if states and actions include the gripper's width.
    pub gripper: bool,
    /// Source of each frame's action.
    pub action: Action,
}

/// Source of a frame's action.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Action {
    /// The arm's target at the next frame. This source requires a recording in which the client
    /// controlled the arm.
    #[default]
    Reference,
    /// The arm's measured position at the next frame. Use this source for demonstrations in which a
    /// person guides the arm.
    Measured,
}

impl DatasetOptions {
    /// Creates options with 30 frames per second, the gripper's width, and actions from references.
    pub fn new(robot_type: impl Into<String>) -> Self {
        Self {
            fps: 30,
            robot_type: robot_type.into(),
            gripper: true,
            action: Action::default(),
        }
    }

    /// Sets the number of frames per second.
    #[must_use]
    pub fn fps(mut self, fps: u16) -> Self {
        self.fps = fps;
        self
    }

    /// Sets whether states and actions include the gripper's width.
    #[must_use]
    pub fn gripper(mut self, gripper: bool) -> Self {
        self.gripper = gripper;
        self
    }

    /// Sets the source of actions.
    #[must_use]
    pub fn action(mut self, action: Action) -> Self {
        self.action = action;
        self
    }
}

/// Writer that adds episodes to a dataset. [`finish`](Self::finish) makes the new episodes part of
/// the dataset. If the writer is dropped earlier, or the process is killed, the dataset stays
/// unchanged.
///
/// Each frame contains `observation.state`, `action`, `next.done`, `next.success`, and the fields
/// common to all datasets. The numbers of a state or an action are `joint_1.pos` to `joint_7.pos`
/// in radians, `ee_x.pos` to `ee_z.pos` in metres, `ee_qx.pos` to `ee_qw.pos` (a quaternion), and
/// `gripper.pos` in metres. The dataset contains no images.
pub struct Dataset {
    root: PathBuf,
    staging: Staging,
    options: DatasetOptions,
    contents: Contents,
    next_file: FileNumber,
    data: Option<TableWriter>,
    /// Data files that are complete, but do not have their final names yet.
    full: Vec<TableWriter>,
    added: Vec<Episode>,
}

impl Dataset {
    /// Creates a dataset in the folder `root`. The folder must be empty, or must not exist.
    ///
    /// # Errors
    /// Returns [`ExportError`] if an option is invalid, or if the folder is not empty or cannot be
    /// written to.
    pub fn create(root: impl Into<PathBuf>, options: DatasetOptions) -> Result<Self, ExportError> {
        let root = root.into();
        checked(&options)?;
        fs::create_dir_all(&root).map_err(ExportError::at(&root))?;
        let staging = Staging::begin(&root)?;
        if let Some(entry) = fs::read_dir(&root).map_err(ExportError::at(&root))?.next() {
            let entry = entry.map_err(ExportError::at(&root))?;
            return Err(ExportError::Dataset {
                why: format!(
                    "the folder contains {:?}, expected an empty or new folder",
                    entry.file_name()
                ),
                path: root,
            });
        }
        Ok(Self::with(
            root,
            staging,
            options,
            Contents::default(),
            FileNumber(0),
        ))
    }

    /// Opens the dataset in the folder `root`, to add episodes. Another program may have written
    /// the dataset, provided that it has the same features.
    ///
    /// # Errors
    /// Returns [`ExportError::Dataset`] if the dataset has a different version, robot, rate or
    /// features, or if its files do not contain the declared number of frames.
    pub fn open(root: impl Into<PathBuf>, options: DatasetOptions) -> Result<Self, ExportError> {
        let root = root.into();
        checked(&options)?;
        let staging = Staging::begin(&root)?;
        let contents = meta::read(&root, &options)?;
        let files = [
            ("data", contents.frames),
            ("meta/episodes", contents.episodes),
        ];
        let mut next_file = FileNumber(0);
        for (folder, expected) in files {
            let (rows, next) = episodes::files_in(&root.join(folder))?;
            if rows != expected {
                let why = format!(
                    "the files in {folder} have {rows} rows, expected {expected} as in \
                     meta/info.json: another export was interrupted, or is running"
                );
                return Err(ExportError::Dataset { path: root, why });
            }
            next_file = next_file.max(next);
        }
        Ok(Self::with(root, staging, options, contents, next_file))
    }

    fn with(
        root: PathBuf,
        staging: Staging,
        options: DatasetOptions,
        contents: Contents,
        next_file: FileNumber,
    ) -> Self {
        Self {
            root,
            staging,
            options,
            contents,
            next_file,
            data: None,
            full: Vec::new(),
            added: Vec::new(),
        }
    }

    /// Returns the number of episodes, including new episodes.
    pub fn episodes(&self) -> u64 {
        self.contents.episodes
    }

    /// Returns the number of frames, including new frames.
    pub fn frames(&self) -> u64 {
        self.contents.frames
    }

    /// Adds an episode from its task, its success and all its cycles. Returns the number of frames.
    /// In the last frame, `next.done` is true, and `next.success` is true if the episode is known
    /// to have succeeded.
    ///
    /// # Errors
    /// Returns [`ExportError::Episode`] if the samples are invalid: they are empty, have gaps of
    /// more than a frame, or lack the gripper or a reference. The dataset then stays unchanged.
    pub fn add_episode(
        &mut self,
        task: &str,
        success: Option<bool>,
        samples: impl IntoIterator<Item = Sample>,
    ) -> Result<u64, ExportError> {
        let index = self.contents.episodes;
        let refused = |why: String| ExportError::Episode {
            index,
            task: task.to_owned(),
            why,
        };
        if task.trim().is_empty() {
            return Err(refused("the task is empty, expected a text".into()));
        }
        let DatasetOptions {
            fps,
            gripper,
            action,
            ..
        } = self.options;
        let frames = Frames::of(samples, fps, gripper, action).map_err(refused)?;
        let count = frames.count as u64;
        let tasks = &mut self.contents.tasks;
        let known = tasks.iter().position(|it| it == task);
        let task_index = known.unwrap_or(tasks.len());
        let columns = columns(&frames, &self.contents, fps, task_index, success);
        let file = self.begin_file()?;
        let data = self.data.as_mut().expect("begun just now");
        data.write(&columns)?;
        if data.size() >= meta::DATA_FILE_MB << 20 {
            self.full.extend(self.data.take());
        }
        let contents = &mut self.contents;
        if known.is_none() {
            contents.tasks.push(task.to_owned());
        }
        let names = VECTORS.into_iter().chain(FLAGS);
        let names = names.chain(BOOKKEEPING.map(|(name, _)| name));
        let stats: Vec<_> = names
            .zip(&columns)
            .map(|(name, values)| {
                (
                    name,
                    Stats::of(&values.numbers(), values.len() / frames.count),
                )
            })
            .collect();
        for (name, stats) in &stats {
            let all = contents.stats.entry((*name).to_owned());
            all.and_modify(|all| *all = all.and(stats))
                .or_insert_with(|| stats.clone());
        }
        self.added.push(Episode {
            index: contents.episodes,
            task: task.to_owned(),
            begin: contents.frames,
            length: count,
            file,
            stats: stats.into_iter().map(|(_, stats)| stats).collect(),
        });
        contents.episodes += 1;
        contents.frames += count;
        Ok(count)
    }

    /// Makes the new episodes part of the dataset.
    ///
    /// # Errors
    /// Returns [`ExportError::Dataset`] if a new dataset has no episodes, and [`ExportError::Io`]
    /// if a file cannot be written.
    pub fn finish(mut self) -> Result<(), ExportError> {
        if self.contents.episodes == 0 {
            let why = "got no episodes, expected at least one".to_owned();
            let path = self.root.clone();
            return Err(ExportError::Dataset { path, why });
        }
        if self.added.is_empty() {
            return Ok(());
        }
        for file in self.full.drain(..).chain(self.data.take()) {
            file.finish()?;
        }
        let folder = &self.staging.folder;
        episodes::write(&self.root, folder, &self.added, &self.options)?;
        meta::write(folder, &self.options, &self.contents)?;
        self.staging.commit()
    }

    /// Creates a data file unless one is open. Returns the number of the open file.
    fn begin_file(&mut self) -> Result<FileNumber, ExportError> {
        if self.data.is_none() {
            let path = self.next_file.path(&self.staging.folder, "data");
            make_folder_of(&path)?;
            let width = frames::names(self.options.gripper).len();
            let vectors = VECTORS.map(|name| Field::list(name, Kind::Single, width));
            let flags = FLAGS.map(|name| Field::new(name, Kind::Bool));
            let rest = BOOKKEEPING.map(|(name, dtype)| match dtype {
                "float32" => Field::new(name, Kind::Single),
                _ => Field::new(name, Kind::Int),
            });
            let fields = vectors.into_iter().chain(flags).chain(rest).collect();
            self.data = Some(TableWriter::new(NewFile::create(path)?, fields, &[])?);
            self.next_file = self.next_file.next();
        }
        Ok(self.next_file.before())
    }
}

impl std::fmt::Debug for Dataset {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Dataset")
            .field("root", &self.root)
            .field("options", &self.options)
            .field("episodes", &self.contents.episodes)
            .finish_non_exhaustive()
    }
}

fn checked(options: &DatasetOptions) -> Result<(), ExportError> {
    if (1..=1000).contains(&options.fps) {
        return Ok(());
    }
    Err(ExportError::Option {
        option: "fps",
        got: options.fps.to_string(),
        expected: "1 to 1000 frames per second",
    })
}

/// Returns the columns of an episode: the vectors, the flags, and the other numbers of each frame.
fn columns(
    frames: &Frames,
    before: &Contents,
    fps: u16,
    task_index: usize,
    success: Option<bool>,
) -> Vec<Values> {
    let count = frames.count;
    let last = |flag: bool| Values::Bool((1..=count).map(|i| flag && i == count).collect());
    let all = |value: u64| Values::Int(vec![value as i64; count]);
    let from = |begin: u64| Values::Int((0..count as i64).map(|i| begin as i64 + i).collect());
    let timestamps = (0..count).map(|i| (i as f64 / f64::from(fps)) as f32);
    vec![
        Values::Single(frames.state.clone()),
        Values::Single(frames.action.clone()),
        last(true),
        last(success == Some(true)),
        Values::Single(timestamps.collect()),
        from(0),
        all(before.episodes),
        from(before.frames),
        all(task_index as u64),
    ]
}

fn make_folder_of(path: &Path) -> Result<(), ExportError> {
    let folder = path.parent().expect("a file in a folder");
    fs::create_dir_all(folder).map_err(ExportError::at(folder))
}
