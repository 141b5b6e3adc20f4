//! Selected columns of every cycle, collected without the interpreter.
//!
//! ```text
//!  Robot::state_stream --task--> Table of states --+
//!                                                  +-- rows of the same time --> numpy
//!  Robot::records ------task--> Table of cycles ---+
//! ```

mod rows;
mod table;

use std::pin::pin;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use franka_async::record::{Column, Record};
use futures::{Stream, StreamExt};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyIterator, PyList, PyString, PyTuple};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, watch};

use crate::device::at_least_zero;
use crate::operation::Operation;
use crate::robot::Robot;
use crate::runtime;
pub(crate) use rows::column_array;
use rows::{Cut, Tables};
use table::{Seen, Source, Table};

#[pymethods]
impl Robot {
    /// Records these columns of every cycle, of `record_columns()`, while a `with` or `async with`
    /// block runs: see `Recording`. It keeps the first `longest` seconds. Raises `ValueError` for
    /// an unknown column.
    #[pyo3(signature = (columns, *, longest = 3600.0))]
    fn record(&self, columns: &Bound<'_, PyAny>, longest: f64) -> PyResult<Recording> {
        let columns: Vec<String> = match columns.is_instance_of::<PyString>() {
            true => {
                let got = columns.repr()?;
                let text = format!("columns is {got}, expected a list of names: [{got}]");
                return Err(PyTypeError::new_err(text));
            }
            false => columns.extract()?,
        };
        let mut chosen = Vec::with_capacity(columns.len());
        // The time of each row is always recorded.
        for name in columns.iter().filter(|name| *name != "time") {
            let column = Column::find(name).ok_or_else(|| {
                let known: Vec<&str> = Column::all().iter().map(|column| column.name).collect();
                let known = known.join(", ");
                let expected = format!("expected columns from time, {known}");
                PyValueError::new_err(format!("got the column {name:?}, {expected}"))
            })?;
            if !chosen.iter().any(|it: &&Column| it.name == column.name) {
                chosen.push(column);
            }
        }
        let most = at_least_zero("longest", longest)? * 1000.0;
        Ok(Recording {
            robot: Mutex::new(Some(self.connected()?)),
            columns: chosen,
            most: most as usize,
            begun: Mutex::new(None),
        })
    }
}

/// The columns that can be recorded: a `dict` of each column's name to its unit and shape in one
/// cycle.
#[pyfunction]
pub(crate) fn record_columns(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("time", ("s", PyTuple::empty(py)))?;
    for column in Column::all() {
        let shape = PyTuple::new(py, column.shape)?;
        all.set_item(column.name, (column.unit, shape))?;
    }
    Ok(all)
}

/// Columns of every cycle: `with robot.record(["q", "tau_c"]) as recording:` begins, and the end of
/// the block ends it. `recording["q"]` is an array of one row for each cycle, `recording["time"]`
/// its time, s.
///
/// The data is collected without the interpreter, so nothing is lost while Python is busy. The
/// columns of a state and of the control thread for the same cycle are in the same row. The
/// recording can be read while it runs.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Recording {
    /// The robot until the end of the recording, so that a finished recording does not keep the
    /// connection.
    robot: Mutex<Option<franka_async::Robot>>,
    columns: Vec<&'static Column>,
    /// Largest number of rows.
    most: usize,
    begun: Mutex<Option<Begun>>,
}

#[derive(Clone)]
struct Begun {
    shared: Arc<Shared>,
    end: Arc<watch::Sender<Option<u64>>>,
}

struct Shared {
    begin: u64,
    tables: Mutex<Tables>,
    completed: Condvar,
}

#[pymethods]
impl Recording {
    fn __enter__(this: &Bound<'_, Self>) -> PyResult<Py<Self>> {
        this.get().begin()?;
        Ok(this.clone().unbind())
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, _exception: &Bound<'_, PyAny>) {
        self.end();
    }

    fn __aenter__(this: &Bound<'_, Self>) -> PyResult<Operation> {
        let recording = Self::__enter__(this)?;
        Ok(Operation::infallible("record", async move { recording }))
    }

    #[pyo3(signature = (*_exception))]
    fn __aexit__(&self, _exception: &Bound<'_, PyAny>) -> Operation {
        self.end();
        Operation::infallible("record", async {})
    }

    /// Names of the columns, `time` first.
    fn keys(&self) -> Vec<&'static str> {
        let names = self.columns.iter().map(|column| column.name);
        std::iter::once("time").chain(names).collect()
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<&str>()
            .is_ok_and(|name| self.keys().contains(&name))
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyList::new(py, self.keys())?.try_iter()
    }

    /// Returns the column with this name, a new array with one row for each cycle. Raises
    /// `KeyError`.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.begun()?.cut(py).column(py, &self.columns, name)
    }

    /// All columns, a new `dict` of arrays.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let begun = self.begun()?;
        let cut = begun.cut(py);
        let all = PyDict::new(py);
        for name in self.keys() {
            all.set_item(name, cut.column(py, &self.columns, name)?)?;
        }
        Ok(all)
    }

    /// Number of recorded cycles.
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(self.begun()?.cut(py).len())
    }

    /// Number of missing cycles since the beginning: their states did not arrive, were skipped by
    /// the control thread for a newer one, or came after the longest time.
    #[getter]
    fn lost(&self, py: Python<'_>) -> PyResult<u64> {
        let begun = self.begun()?;
        Ok(begun.cut(py).lost(begun.shared.begin))
    }

    /// Writes all columns to a file, `.npz`: `numpy.load(path)["q"]`.
    fn save(&self, py: Python<'_>, path: &Bound<'_, PyAny>) -> PyResult<()> {
        let arrays = self.arrays(py)?;
        py.import("numpy")?
            .call_method("savez", (path,), Some(&arrays))?;
        Ok(())
    }

    fn __repr__(&self) -> String {
        let names = self.keys().join(", ");
        let begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner);
        match &*begun {
            None => format!("<Recording of {names}, not begun>"),
            Some(begun) => {
                let is_over = begun.end.borrow().is_some();
                let state = if is_over { "over" } else { "under way" };
                format!("<Recording of {names}, {state}>")
            }
        }
    }
}

impl Recording {
    fn begin(&self) -> PyResult<()> {
        let mut begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner);
        if begun.is_some() {
            let text = "this recording has already begun: call record() for another recording";
            return Err(PyRuntimeError::new_err(text));
        }
        let robot = self.robot().clone().expect("taken at the end only");
        let begin = robot.state().message_id;
        let of = |source: Source| {
            let columns = self.columns.iter().copied();
            columns
                .filter(|column| Source::of(column) == source)
                .collect::<Vec<_>>()
        };
        let (of_state, of_cycle) = (of(Source::State), of(Source::Cycle));
        // At least one table must show the existing cycles.
        let uses_states = !of_state.is_empty() || of_cycle.is_empty();
        let uses_cycles = !of_cycle.is_empty();
        let shared = Arc::new(Shared {
            begin,
            tables: Mutex::new(Tables([
                Table::new(of_state, begin, uses_states),
                Table::new(of_cycle, begin, uses_cycles),
            ])),
            completed: Condvar::new(),
        });
        let (end, ended) = watch::channel(None);
        let (runtime, most) = (runtime::runtime()?, self.most);
        if uses_states {
            let states = robot.state_stream();
            let states = states.map(|reading| Seen::State(Box::new(reading.state)));
            let (shared, ended) = (shared.clone(), ended.clone());
            runtime.spawn(collect(states, Source::State, shared, ended, most));
        }
        if uses_cycles {
            let cycles = cycles(robot.records());
            runtime.spawn(collect(cycles, Source::Cycle, shared.clone(), ended, most));
        }
        let end = Arc::new(end);
        *begun = Some(Begun { shared, end });
        Ok(())
    }

    /// Ends with the newest state. Reading waits for the rest.
    fn end(&self) {
        let robot = self.robot().take();
        let begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some(begun), Some(robot)) = (&*begun, &robot) {
            begun.end.send_replace(Some(robot.state().message_id));
        }
    }

    fn robot(&self) -> MutexGuard<'_, Option<franka_async::Robot>> {
        self.robot.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn begun(&self) -> PyResult<Begun> {
        let begun = self.begun.lock().unwrap_or_else(PoisonError::into_inner);
        begun.clone().ok_or_else(|| {
            PyRuntimeError::new_err("this recording has not begun: use 'with' or 'async with'")
        })
    }
}

impl Begun {
    /// Returns the time of the last cycle of the recording.
    fn last(&self) -> u64 {
        self.end.borrow().unwrap_or(u64::MAX)
    }

    /// Returns the readable part.
    fn cut(&self, py: Python<'_>) -> Cut<'_> {
        if self.end.borrow().is_some() {
            self.shared.wait(py);
        }
        let (tables, last) = (self.shared.tables(), self.last());
        Cut {
            rows: tables.rows(last),
            tables,
            last,
        }
    }
}

/// Fills a table until it contains the last cycle of the recording, or the recording is dropped.
async fn collect(
    items: impl Stream<Item = Seen>,
    source: Source,
    shared: Arc<Shared>,
    mut ended: watch::Receiver<Option<u64>>,
    most: usize,
) {
    let mut items = pin!(items);
    loop {
        tokio::select! {
            seen = items.next() => match seen {
                Some(seen) => shared.tables().of(source).push(&seen, most),
                None => break,
            },
            is_kept = ended.changed() => if is_kept.is_err() { break },
        }
        let end = *ended.borrow();
        if end.is_some_and(|end| shared.tables().of(source).newest >= end) {
            break;
        }
    }
    shared.tables().of(source).is_complete = true;
    shared.completed.notify_all();
}

/// Returns the records of the control thread.
fn cycles(records: broadcast::Receiver<Record>) -> impl Stream<Item = Seen> {
    futures::stream::unfold(records, async |mut records| {
        loop {
            match records.recv().await {
                Ok(record) => return Some((Seen::Cycle(Box::new(record)), records)),
                // The times of the rows show the number.
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => return None,
            }
        }
    })
}

impl Shared {
    fn tables(&self) -> MutexGuard<'_, Tables> {
        self.tables.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the tables contain all data of a finished recording. If the robot sends no more
    /// states, the existing data is used.
    fn wait(&self, py: Python<'_>) {
        py.detach(|| {
            let is_incomplete =
                |tables: &mut Tables| !tables.0.iter().all(|table| table.is_complete);
            let waited = self
                .completed
                .wait_timeout_while(self.tables(), PATIENCE, is_incomplete);
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        });
    }
}

/// Time limit for the last cycles of a finished recording when it is read: the control thread
/// delivers them within 50 ms.
const PATIENCE: Duration = Duration::from_secs(2);
