//! Exports cycles as a Parquet table.

use std::error::Error;
use std::path::Path;

use franka_rt::driver::ColumnKind;
use serde_json::{Map, Value};

use super::cells::{Columns, name_of};
use super::error::ExportError;
use super::new_file::NewFile;
use super::parquet::{Field, Kind, TableWriter, Values};
use crate::cycle::Cycle;

/// Number of rows per write: one minute of cycles, which needs some 100 MB with all columns.
const ROWS: usize = 60_000;

/// Writes the cycles to a new file at `path`, with one row per cycle. Returns the number of rows.
/// The first columns are `time` (the robot's clock in milliseconds) and `host_time` (nanoseconds
/// since 1970). A vector is a list, and a matrix is a row-major list. Flags and counts are
/// integers, modes are texts, and all other numbers are `f64`. The file's metadata contains the
/// units as JSON with the key `units`.
///
/// The file appears under its name once it is complete.
///
/// # Errors
/// Returns [`ExportError::Exists`] if a file with this name exists, [`ExportError::Cycles`] if
/// `cycles` returns an error, and other errors if the file cannot be written.
pub fn write_parquet<E: Error + Send + Sync + 'static>(
    cycles: impl IntoIterator<Item = Result<Cycle, E>>,
    columns: &Columns,
    path: impl AsRef<Path>,
) -> Result<u64, ExportError> {
    let unit = |(name, unit): (&str, &str)| (name.to_owned(), Value::from(unit));
    let units = columns.0.iter().map(|column| (column.name, column.unit));
    let times = [("time", "ms"), ("host_time", "ns")];
    let units: Map<String, Value> = times.into_iter().chain(units).map(unit).collect();
    let chosen = columns.0.iter().map(|column| {
        let kind = match column.kind {
            ColumnKind::Name(_) => Kind::Text,
            ColumnKind::Count | ColumnKind::Flag => Kind::Int,
            _ => Kind::Double,
        };
        match column.shape {
            [] => Field::new(column.name, kind),
            _ => Field::list(column.name, kind, column.width()),
        }
    });
    let times = times.map(|(name, _)| Field::new(name, Kind::Int));
    let fields: Vec<Field> = times.into_iter().chain(chosen).collect();
    let units = Value::from(units).to_string();
    let mut table = TableWriter::new(NewFile::create(path.as_ref())?, fields, &[("units", units)])?;
    let mut cycles = cycles.into_iter();
    let mut count = 0;
    loop {
        let rows = next_rows(&mut cycles, columns)?;
        if rows[0].len() > 0 {
            table.write(&rows)?;
        }
        count += rows[0].len() as u64;
        if rows[0].len() < ROWS {
            break;
        }
    }
    table.finish()?;
    Ok(count)
}

/// Returns the columns of the next rows. The last group has fewer than [`ROWS`] rows.
fn next_rows<E: Error + Send + Sync + 'static>(
    cycles: &mut impl Iterator<Item = Result<Cycle, E>>,
    columns: &Columns,
) -> Result<Vec<Values>, ExportError> {
    let (mut times, mut host_times) = (Vec::new(), Vec::new());
    let mut chosen: Vec<Values> = columns
        .0
        .iter()
        .map(|column| match column.kind {
            ColumnKind::Name(_) => Values::Text(Vec::new()),
            ColumnKind::Count | ColumnKind::Flag => Values::Int(Vec::new()),
            _ => Values::Double(Vec::new()),
        })
        .collect();
    let mut row = Vec::new();
    for cycle in cycles.take(ROWS) {
        let cycle = cycle.map_err(|error| ExportError::Cycles(error.into()))?;
        times.push(cycle.state.message_id as i64);
        host_times.push(cycle.time.as_nanos() as i64);
        columns.read(&cycle, &mut row);
        let mut numbers = row.iter().copied();
        for (column, values) in columns.0.iter().zip(&mut chosen) {
            let numbers = numbers.by_ref().take(column.width());
            match (values, column.kind) {
                (Values::Text(texts), ColumnKind::Name(list)) => {
                    texts.extend(numbers.map(|number| name_of(list, number).to_owned()));
                }
                (Values::Int(values), _) => values.extend(numbers.map(|number| number as i64)),
                (Values::Double(values), _) => values.extend(numbers),
                _ => unreachable!("made for these columns"),
            }
        }
    }
    let times = [Values::Int(times), Values::Int(host_times)];
    Ok(times.into_iter().chain(chosen).collect())
}
