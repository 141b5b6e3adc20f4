//! The table with one row per episode, and the numbered files of a dataset.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::meta::{self, FILES_IN_CHUNK};
use super::stats::{NAMES, Stats};
use super::{DatasetOptions, make_folder_of};
use crate::export::error::ExportError;
use crate::export::new_file::NewFile;
use crate::export::parquet::{Field, Kind, TableWriter, Values};

pub(super) struct Episode {
    pub(super) index: u64,
    pub(super) task: String,
    /// Index of the episode's first frame in the dataset.
    pub(super) begin: u64,
    pub(super) length: u64,
    /// Number of the episode's data file.
    pub(super) file: FileNumber,
    /// Statistics of each feature, in the order of [`meta::widths`].
    pub(super) stats: Vec<Stats>,
}

/// Number of a file in a dataset, counted across all chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FileNumber(pub(super) u64);

impl FileNumber {
    pub(super) fn next(self) -> Self {
        Self(self.0 + 1)
    }

    pub(super) fn before(self) -> Self {
        Self(self.0.saturating_sub(1))
    }

    fn chunk(self) -> u64 {
        self.0 / FILES_IN_CHUNK
    }

    fn in_chunk(self) -> u64 {
        self.0 % FILES_IN_CHUNK
    }

    pub(super) fn path(self, root: &Path, folder: &str) -> PathBuf {
        let (chunk, file) = (self.chunk(), self.in_chunk());
        root.join(folder)
            .join(format!("chunk-{chunk:03}/file-{file:03}.parquet"))
    }
}

/// Returns the number of rows in all `chunk-…` folders of this folder, and the number of the next
/// file.
pub(super) fn files_in(folder: &Path) -> Result<(u64, FileNumber), ExportError> {
    let (mut rows, mut next) = (0, FileNumber(0));
    for (chunk, chunk_path) in numbered(folder, "chunk-", "")? {
        for (file, path) in numbered(&chunk_path, "file-", ".parquet")? {
            rows += meta::rows_in(&path)?;
            next = next.max(FileNumber(chunk * FILES_IN_CHUNK + file).next());
        }
    }
    Ok((rows, next))
}

/// Returns the entries of a folder whose names consist of `before`, a number and `after`; empty if
/// the folder does not exist.
fn numbered(folder: &Path, before: &str, after: &str) -> Result<Vec<(u64, PathBuf)>, ExportError> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(ExportError::at(folder))?,
    };
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry.map_err(ExportError::at(folder))?;
        let name = entry.file_name();
        let number = name.to_str().and_then(|name| {
            let number = name.strip_prefix(before)?.strip_suffix(after)?;
            number.parse().ok()
        });
        found.extend(number.map(|number| (number, entry.path())));
    }
    Ok(found)
}

/// Writes the next table of the dataset in `root`, with these episodes. The new file is in
/// `folder`.
pub(super) fn write(
    root: &Path,
    folder: &Path,
    episodes: &[Episode],
    options: &DatasetOptions,
) -> Result<(), ExportError> {
    let (_, number) = files_in(&root.join("meta/episodes"))?;
    let path = number.path(folder, "meta/episodes");
    make_folder_of(&path)?;
    let ints = |of: &dyn Fn(&Episode) -> u64| {
        Values::Int(episodes.iter().map(|episode| of(episode) as i64).collect())
    };
    let one = |name: &str, of: &dyn Fn(&Episode) -> u64| (Field::new(name, Kind::Int), ints(of));
    let tasks = episodes.iter().map(|episode| episode.task.clone());
    let mut columns = vec![
        one("episode_index", &|it| it.index),
        (
            Field::list("tasks", Kind::Text, 1),
            Values::Text(tasks.collect()),
        ),
        one("length", &|it| it.length),
        one("data/chunk_index", &|it| it.file.chunk()),
        one("data/file_index", &|it| it.file.in_chunk()),
        one("dataset_from_index", &|it| it.begin),
        one("dataset_to_index", &|it| it.begin + it.length),
    ];
    for (place, (feature, width)) in meta::widths(options.gripper).enumerate() {
        for (k, name) in NAMES.iter().enumerate() {
            let values = episodes.iter().flat_map(|it| &it.stats[place].values[k]);
            let field = Field::list(format!("stats/{feature}/{name}"), Kind::Double, width);
            columns.push((field, Values::Double(values.copied().collect())));
        }
        let field = Field::list(format!("stats/{feature}/count"), Kind::Int, 1);
        columns.push((field, ints(&|it| it.stats[place].count)));
    }
    columns.push(one("meta/episodes/chunk_index", &|_| number.chunk()));
    columns.push(one("meta/episodes/file_index", &|_| number.in_chunk()));
    let (fields, values): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
    let mut table = TableWriter::new(NewFile::create(path)?, fields, &[])?;
    table.write(&values)?;
    table.finish()
}
