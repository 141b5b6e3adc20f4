//! Episodes: attempts at a task, marked in a recording.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_async::recording;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use super::Shared;
use crate::errors::Raise;
use crate::runtime::{self, Threaded};

/// An episode of a recording: `with recorder.episode(name, task=task) as episode:`.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct EpisodeUnderWay {
    shared: Threaded<Arc<Shared>>,
    name: String,
    task: String,
    success: Mutex<Option<bool>>,
    has_begun: AtomicBool,
}

impl EpisodeUnderWay {
    pub(super) fn new(shared: Arc<Shared>, name: String, task: String) -> Self {
        Self {
            shared: Threaded::new(shared),
            name,
            task,
            success: Mutex::new(None),
            has_begun: AtomicBool::new(false),
        }
    }
}

#[pymethods]
impl EpisodeUnderWay {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Description of the task.
    #[getter]
    fn task(&self) -> &str {
        &self.task
    }

    /// Success of the task; `None` until it is set.
    #[getter]
    fn get_success(&self) -> Option<bool> {
        *self.judged()
    }

    #[setter]
    fn set_success(&self, success: Option<bool>) {
        *self.judged() = success;
    }

    fn __enter__(this: &Bound<'_, Self>) -> PyResult<Py<Self>> {
        let episode = this.get();
        let refused = |text: &str| Err(PyRuntimeError::new_err(text.to_owned()));
        if episode.has_begun.swap(true, Ordering::Relaxed) {
            return refused("this episode has already begun: call episode() for another episode");
        }
        if episode.shared.in_episode.swap(true, Ordering::Relaxed) {
            return refused("another episode of this recording is running: end it first");
        }
        let begun = episode.tell(this.py(), |recorder| {
            let begun = recorder.begin_episode(&*episode.name, &*episode.task);
            begun.expect("episode() has checked the name and the task");
        });
        if begun.is_err() {
            episode.shared.in_episode.store(false, Ordering::Relaxed);
        }
        begun.map(|()| this.clone().unbind())
    }

    #[pyo3(signature = (kind = None, *_rest))]
    fn __exit__(
        &self,
        py: Python<'_>,
        kind: Option<&Bound<'_, PyAny>>,
        _rest: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let raised = kind.is_some_and(|kind| !kind.is_none());
        if raised {
            *self.judged() = Some(false);
        }
        let success = *self.judged();
        let ended = self.tell(py, |recorder| recorder.end_episode(success));
        self.shared.in_episode.store(false, Ordering::Relaxed);
        // The block's exception is not replaced.
        if raised { Ok(()) } else { ended }
    }

    fn __repr__(&self) -> String {
        format!("<EpisodeUnderWay {:?}: {:?}>", self.name, self.task)
    }
}

impl EpisodeUnderWay {
    fn judged(&self) -> MutexGuard<'_, Option<bool>> {
        self.success.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tell(&self, py: Python<'_>, mark: impl FnOnce(&recording::Recorder) + Send) -> PyResult<()> {
        runtime::runtime()?;
        let told = py.detach(|| self.shared.with(mark));
        told.map_err(|error| error.raise(py))
    }
}
