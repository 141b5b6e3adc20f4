//! Cycles as comma-separated text.

use std::error::Error;
use std::io::{self, Write};

use franka_rt::driver::ColumnKind;

use super::cells::{Columns, name_of};
use super::error::ExportError;
use crate::cycle::Cycle;

/// Writes one line with the column names, and one line for each cycle. Returns the number of
/// cycles. The first columns are `time` (the robot's clock in milliseconds) and `host_time`
/// (nanoseconds since 1970). A vector has one column for each number, such as `q[0]` to `q[6]`. A
/// matrix is row-major. A missing number is an empty cell.
///
/// If `units` is true, the first line begins with `#` and contains the unit of each column.
///
/// # Errors
/// Returns [`ExportError::Write`] if the output cannot be written, and [`ExportError::Cycles`] if
/// `cycles` returns an error.
pub fn write_csv<E: Error + Send + Sync + 'static>(
    cycles: impl IntoIterator<Item = Result<Cycle, E>>,
    columns: &Columns,
    units: bool,
    to: impl Write,
) -> Result<u64, ExportError> {
    let mut to = io::BufWriter::new(to);
    if units {
        let units = columns
            .0
            .iter()
            .map(|it| format!(",{}", quoted(it.unit)).repeat(it.width()));
        writeln!(to, "# ms,ns{}", units.collect::<String>())?;
    }
    write!(to, "time,host_time")?;
    for column in &columns.0 {
        for place in 0..column.width() {
            match column.shape {
                [] => write!(to, ",{}", column.name)?,
                _ => write!(to, ",{}[{place}]", column.name)?,
            }
        }
    }
    writeln!(to)?;
    let (mut row, mut count) = (Vec::new(), 0);
    for cycle in cycles {
        let cycle = cycle.map_err(|error| ExportError::Cycles(error.into()))?;
        columns.read(&cycle, &mut row);
        write!(to, "{},{}", cycle.state.message_id, cycle.time.as_nanos())?;
        let mut numbers = row.iter();
        for column in &columns.0 {
            for number in numbers.by_ref().take(column.width()) {
                match column.kind {
                    ColumnKind::Name(list) => write!(to, ",{}", name_of(list, *number))?,
                    _ if number.is_finite() => write!(to, ",{number}")?,
                    _ => write!(to, ",")?,
                }
            }
        }
        writeln!(to)?;
        count += 1;
    }
    to.flush()?;
    Ok(count)
}

fn quoted(text: &str) -> String {
    if text.contains(',') {
        format!("\"{text}\"")
    } else {
        text.to_owned()
    }
}
