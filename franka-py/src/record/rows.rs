//! The rows of a recording as arrays: rows of its tables for the same cycles.

use std::cmp::Ordering;
use std::sync::MutexGuard;

use franka_async::record::{Column, ColumnKind};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict};

use super::table::{Source, Table};
use crate::arrays::array;

/// The table of the states, and the table of the control thread's cycles.
pub(super) struct Tables(pub(super) [Table; 2]);

impl Tables {
    pub(super) fn of(&mut self, source: Source) -> &mut Table {
        &mut self.0[source as usize]
    }

    /// Returns the rows of each table up to `last` for the same cycles, of all tables in use.
    pub(super) fn rows(&self, last: u64) -> [Vec<usize>; 2] {
        let [states, cycles] = &self.0;
        let until = |table: &Table| table.times.partition_point(|time| *time <= last);
        let (n, m) = (until(states), until(cycles));
        match (states.is_used, cycles.is_used) {
            (_, false) => [(0..n).collect(), Vec::new()],
            (false, true) => [Vec::new(), (0..m).collect()],
            (true, true) => {
                let mut rows = [Vec::new(), Vec::new()];
                let (mut i, mut j) = (0, 0);
                while i < n && j < m {
                    match states.times[i].cmp(&cycles.times[j]) {
                        Ordering::Less => i += 1,
                        Ordering::Greater => j += 1,
                        Ordering::Equal => {
                            rows[0].push(i);
                            rows[1].push(j);
                            (i, j) = (i + 1, j + 1);
                        }
                    }
                }
                rows
            }
        }
    }

    /// Returns the time of the newest cycle that all tables in use have received.
    pub(super) fn newest(&self) -> u64 {
        let used = self.0.iter().filter(|table| table.is_used);
        used.map(|table| table.newest).min().unwrap_or_default()
    }
}

/// The current rows of the cycles of a recording, and their tables.
pub(super) struct Cut<'a> {
    pub(super) tables: MutexGuard<'a, Tables>,
    pub(super) rows: [Vec<usize>; 2],
    pub(super) last: u64,
}

impl Cut<'_> {
    pub(super) fn len(&self) -> usize {
        self.rows[0].len().max(self.rows[1].len())
    }

    pub(super) fn lost(&self, begin: u64) -> u64 {
        let last = self.last.min(self.tables.newest());
        last.saturating_sub(begin).saturating_sub(self.len() as u64)
    }

    pub(super) fn column<'py>(
        &self,
        py: Python<'py>,
        columns: &[&'static Column],
        name: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        if name == "time" {
            let source = usize::from(!self.tables.0[0].is_used);
            let times = &self.tables.0[source].times;
            let rows = self.rows[source].iter();
            let seconds: Vec<f64> = rows.map(|row| times[*row] as f64 / 1000.0).collect();
            return Ok(array(py, &seconds).into_any());
        }
        let column = columns.iter().find(|column| column.name == name);
        let column = column.ok_or_else(|| {
            let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
            let names = names.join(", ");
            PyKeyError::new_err(format!(
                "got the column {name:?}, expected one of the recorded \
                columns: time, {names}"
            ))
        })?;
        let source = Source::of(column) as usize;
        let values = self.tables.0[source].values(column, &self.rows[source]);
        column_array(py, column, &values, self.len())
    }
}

/// Returns the numbers of a column in some rows as a new array, with the type of its kind.
pub(crate) fn column_array<'py>(
    py: Python<'py>,
    column: &Column,
    values: &[f64],
    rows: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let mut shape = vec![rows];
    shape.extend(column.shape);
    let shaped = |array: Bound<'py, PyAny>| array.call_method1("reshape", (shape,));
    match column.kind {
        ColumnKind::Float => shaped(array(py, values).into_any()),
        ColumnKind::Count => shaped(array(py, values).call_method1("astype", ("int64",))?),
        ColumnKind::Flag => shaped(array(py, values).call_method1("astype", ("bool",))?),
        ColumnKind::Name(list) => {
            let named = |value: &f64| list.get(*value as usize).copied().unwrap_or_default();
            let names: Vec<&str> = values.iter().map(named).collect();
            let options = PyDict::new(py);
            options.set_item("dtype", "U")?;
            py.import("numpy")?
                .call_method("array", (names,), Some(&options))
        }
    }
}
