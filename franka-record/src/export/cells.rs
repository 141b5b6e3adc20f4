//! Chosen columns of cycles, for tables of any format.

use franka_rt::driver::{Column, ColumnKind};

use crate::cycle::Cycle;

/// The columns that a table gets, after the time of each cycle.
#[derive(Clone, Debug)]
pub struct Columns(pub(super) Vec<&'static Column>);

/// No column has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("got the column {got:?}, expected some of {}", names().join(", "))]
pub struct UnknownColumn {
    /// The name given.
    pub got: String,
}

impl Columns {
    /// All that there are.
    pub fn all() -> Self {
        Self(Column::all().iter().collect())
    }

    /// Those of these names, each once, in this order.
    ///
    /// # Errors
    /// [`UnknownColumn`] for the first name that no column has.
    pub fn named<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self, UnknownColumn> {
        let mut columns: Vec<&Column> = Vec::new();
        for name in names {
            let got = || UnknownColumn {
                got: name.to_owned(),
            };
            let column = Column::find(name).ok_or_else(got)?;
            if !columns.iter().any(|it| it.name == column.name) {
                columns.push(column);
            }
        }
        Ok(Self(columns))
    }

    /// Writes the numbers of a cycle into `row`, in the place of what it holds.
    pub(super) fn read(&self, cycle: &Cycle, row: &mut Vec<f64>) {
        row.clear();
        for column in &self.0 {
            column.append(&cycle.state, &cycle.record, row);
        }
    }
}

/// The name that a number stands for; none if it stands for none.
pub(super) fn name_of(list: &'static [&'static str], number: f64) -> &'static str {
    list.get(number as usize).copied().unwrap_or_default()
}

/// What the numbers of a column are to be counted as.
pub(super) fn is_whole(kind: ColumnKind) -> bool {
    matches!(kind, ColumnKind::Count | ColumnKind::Flag)
}

fn names() -> Vec<&'static str> {
    Column::all().iter().map(|column| column.name).collect()
}
