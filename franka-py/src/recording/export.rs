//! Exports recordings as tables and datasets for other programs.

use std::path::PathBuf;

use franka_async::export::lerobot::{Action, Dataset, DatasetOptions};
use franka_async::export::{Columns, ExportError, NewFile, write_csv, write_parquet};
use franka_async::recording::event::EventKind;
use franka_async::recording::{Episode, Sample, Samples};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::RecordingFile;
use crate::errors::{Raise, made};
use crate::names::Named;

#[pymethods]
impl RecordingFile {
    /// Writes a table as comma-separated text, one line for each cycle, and returns the number of
    /// cycles. The first columns are `time`, ms of the robot's clock, and `host_time`; then these
    /// columns of `recording_columns()`, or all. The file gets its name once it is complete, and
    /// never replaces another. With `units` the first line contains the units. Raises
    /// `ExportError`, `ValueError`.
    #[pyo3(signature = (path, columns = None, *, units = true))]
    fn to_csv(
        &self,
        py: Python<'_>,
        path: PathBuf,
        columns: Option<Vec<String>>,
        units: bool,
    ) -> PyResult<u64> {
        let columns = named(columns)?;
        let cycles = self.cycles(py)?;
        let written = py.detach(|| {
            let mut file = NewFile::create(path)?;
            let rows = write_csv(cycles, &columns, units, &mut file)?;
            file.finish()?;
            Ok(rows)
        });
        written.map_err(|error: ExportError| error.raise(py))
    }

    /// Writes a Parquet table, one row for each cycle, and returns the number of cycles; columns as
    /// for `to_csv`. The metadata of the file contains the units, as JSON with the key `units`. The
    /// file gets its name once it is complete, and never replaces another. Raises `ExportError`,
    /// `ValueError`.
    #[pyo3(signature = (path, columns = None))]
    fn to_parquet(
        &self,
        py: Python<'_>,
        path: PathBuf,
        columns: Option<Vec<String>>,
    ) -> PyResult<u64> {
        let columns = named(columns)?;
        let cycles = self.cycles(py)?;
        let written = py.detach(|| write_parquet(cycles, &columns, path));
        written.map_err(|error| error.raise(py))
    }

    /// Writes the episodes as a dataset in LeRobot's layout v3.0 to `folder`, which must not exist
    /// or be empty; returns the numbers of episodes and frames. `append` adds them to an existing
    /// dataset: twice, if the same recording is given twice. `fps` are frames per second.
    /// `robot_type` is `franka_fr3` or `franka_fer` unless given. `gripper` includes the width in
    /// states and actions; the default is true if the recording contains a Hand. `action` is
    /// `reference`, the commanded position at the next frame, or `measured`, the measured one: for
    /// demonstrations by hand. `episodes` are the names of the episodes to write; all by default.
    /// Raises `ExportError`, `ValueError`; an existing dataset is then unchanged.
    #[pyo3(signature = (
        folder, *, fps = 30, robot_type = None, gripper = None, action = "reference", append = false,
        episodes = None,
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords")]
    fn to_lerobot(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        fps: u16,
        robot_type: Option<String>,
        gripper: Option<bool>,
        action: &str,
        append: bool,
        episodes: Option<Vec<String>>,
    ) -> PyResult<(usize, u64)> {
        let action = match action {
            "reference" => Action::Reference,
            "measured" => Action::Measured,
            _ => {
                let text = format!("action is {action:?}, expected 'reference' or 'measured'");
                return Err(PyValueError::new_err(text));
            }
        };
        self.chosen()?;
        let robot_type = robot_type.map_or_else(
            || match self.kind() {
                Some(kind) => Ok(format!("franka_{}", kind.python_name())),
                None => Err(PyValueError::new_err(
                    "the recording does not name the kind of its robot: give robot_type",
                )),
            },
            Ok,
        )?;
        let mut chosen = self.read_episodes(py)?;
        if chosen.is_empty()
            && let Some(name) = self.view(py, |view| {
                let events = view.events().filter_map(Result::ok);
                let begun = events.filter_map(|event| match event.kind {
                    EventKind::EpisodeStart { name, .. } => Some(name),
                    _ => None,
                });
                begun.last()
            })?
        {
            let text = format!("no episode was added: {name:?} has begun, but not ended");
            return Err(made(py, "ExportError", "dataset", "caller", &text));
        }
        if let Some(names) = episodes {
            chosen = Episode::named(chosen, &names)
                .map_err(|error| PyValueError::new_err(error.to_string()))?;
        }
        let written = self.view(py, |view| {
            let gripper = gripper.unwrap_or_else(|| {
                let mut states = view.gripper_states();
                states.any(|state| matches!(state, Ok((_, super::GripperState::Hand(_)))))
            });
            let options = DatasetOptions::new(robot_type)
                .fps(fps)
                .gripper(gripper)
                .action(action);
            let mut dataset = match append {
                true => Dataset::open(folder, options)?,
                false => Dataset::create(folder, options)?,
            };
            let mut frames = 0;
            for Episode {
                name,
                task,
                success,
                begin,
                end,
                ..
            } in &chosen
            {
                // The first frames use the previous width of the gripper.
                let until = view.to(*end);
                let samples = Samples::new(until.from(*begin).cycles(), until.gripper_states());
                let samples = samples.collect::<Result<Vec<Sample>, _>>();
                let samples = samples.map_err(|error| ExportError::Cycles(error.into()))?;
                let added = dataset.add_episode(task, *success, samples);
                frames += added.map_err(|mut error| {
                    if let ExportError::Episode { why, .. } = &mut error {
                        *why = format!("{why} (in the recording: {name:?})");
                    }
                    error
                })?;
            }
            dataset.finish()?;
            Ok((chosen.len(), frames))
        })?;
        written.map_err(|error: ExportError| error.raise(py))
    }
}

fn named(columns: Option<Vec<String>>) -> PyResult<Columns> {
    let Some(names) = columns else {
        return Ok(Columns::all());
    };
    let names = names.iter().map(String::as_str);
    Columns::named(names).map_err(|unknown| PyValueError::new_err(unknown.to_string()))
}

impl Raise for ExportError {
    fn raise(self, py: Python<'_>) -> PyErr {
        let party = match &self {
            Self::Option { .. } => return PyValueError::new_err(self.to_string()),
            Self::Exists { .. } | Self::Episode { .. } | Self::Dataset { .. } => "caller",
            _ => "host",
        };
        made(
            py,
            "ExportError",
            self.python_name(),
            party,
            &self.to_string(),
        )
    }
}
