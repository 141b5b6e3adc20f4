//! Column selections for tables in any format.

use franka_rt::driver::Column;

use crate::cycle::Cycle;

/// A selection of columns. The time of each cycle precedes these columns.
#[derive(Clone, Debug)]
pub struct Columns(pub(super) Vec<&'static Column>);

/// Error for a name that no column has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("got the column {got:?}, expected columns from {}", expected.join(", "))]
pub struct UnknownColumn {
    /// The given name.
    pub got: String,
    /// The existing names.
    pub expected: Vec<&'static str>,
}

impl Columns {
    /// Returns all columns of a recording.
    pub fn all() -> Self {
        Self(recorded().collect())
    }

    /// Returns all columns of a [control log](crate::control_log). `q_ref`, `dq_ref` and `tau_c`
    /// contain the command that answers the state. `O_T_EE_c` and `O_dP_EE_c` contain the values
    /// that were commanded before the state.
    pub fn of_log() -> Self {
        let find = |name| Column::find(name).expect("a column of a cycle");
        Self(LOGGED.map(find).into())
    }

    /// Returns the columns of a recording that have these names, in the given order and without
    /// repetitions.
    ///
    /// # Errors
    /// Returns [`UnknownColumn`] if a recording has no column with one of the names.
    pub fn named<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self, UnknownColumn> {
        Self::all().choose(names)
    }

    /// Returns the columns of this selection that have these names, in the given order and without
    /// repetitions.
    ///
    /// # Errors
    /// Returns [`UnknownColumn`] if the selection has no column with one of the names.
    pub fn choose<'a>(
        &self,
        names: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, UnknownColumn> {
        let mut columns: Vec<&Column> = Vec::new();
        for name in names {
            let unknown = || UnknownColumn {
                got: name.to_owned(),
                expected: self.0.iter().map(|column| column.name).collect(),
            };
            let column = self.0.iter().copied().find(|column| column.name == name);
            let column = column.ok_or_else(unknown)?;
            if !columns.iter().any(|it| it.name == column.name) {
                columns.push(column);
            }
        }
        Ok(Self(columns))
    }

    /// Replaces the contents of `row` with the numbers of a cycle.
    pub(super) fn read(&self, cycle: &Cycle, row: &mut Vec<f64>) {
        row.clear();
        for column in &self.0 {
            column.append(&cycle.state, &cycle.record, row);
        }
    }
}

/// Returns the name for a number; empty if the number has no name.
pub(super) fn name_of(list: &'static [&'static str], number: f64) -> &'static str {
    list.get(number as usize).copied().unwrap_or_default()
}

fn recorded() -> impl Iterator<Item = &'static Column> {
    let is_recorded = |column: &&Column| !NOT_RECORDED.contains(&column.name);
    Column::all().iter().filter(is_recorded)
}

/// The columns of a control log.
const LOGGED: [&str; 12] = [
    "q",
    "q_d",
    "dq",
    "dq_d",
    "tau_J",
    "tau_ext_hat_filtered",
    "control_command_success_rate",
    "q_ref",
    "dq_ref",
    "tau_c",
    "O_T_EE_c",
    "O_dP_EE_c",
];

/// Fields of the state that are not recorded and are zero after reading.
const NOT_RECORDED: [&str; 13] = [
    "theta",
    "dtheta",
    "dtau_J",
    "O_T_EE_c",
    "O_dP_EE_c",
    "O_ddP_EE_c",
    "O_ddP_O",
    "elbow_d",
    "elbow_c",
    "delbow_c",
    "ddelbow_c",
    "accelerometer_top",
    "accelerometer_bottom",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::franka;

    #[test]
    fn unrecorded_field_is_no_column() {
        let mut before = Cycle::default();
        let state = &mut before.state;
        for field in [&mut state.theta, &mut state.dtheta, &mut state.dtau_J] {
            *field = [1.0; 7];
        }
        for field in [&mut state.O_dP_EE_c, &mut state.O_ddP_EE_c] {
            *field = [1.0; 6];
        }
        state.O_T_EE_c[12] = 1.0;
        state.O_ddP_O = [1.0; 3];
        for field in [
            &mut state.elbow_d,
            &mut state.elbow_c,
            &mut state.delbow_c,
            &mut state.ddelbow_c,
        ] {
            *field = [1.0; 2];
        }
        state.accelerometer_top = [[1.0; 3]; 6];
        state.accelerometer_bottom = [[1.0; 3]; 6];
        // These fields are derived from other fields.
        state.elbow = [0.0, 1.0];
        let mut message = franka::Cycle::default();
        message.set(&before);
        let after = message.to_cycle(Some(&franka::Tool::of(&before.state)));
        for column in Column::all() {
            let [mut put, mut got] = [Vec::new(), Vec::new()];
            column.append(&before.state, &before.record, &mut put);
            column.append(&after.state, &after.record, &mut got);
            let name = column.name;
            let is_recorded = Columns::named([name]).is_ok();
            // The comparison uses text, because NaN represents missing values on both sides.
            let same = format!("{put:?}") == format!("{got:?}");
            assert_eq!(same, is_recorded, "{name}: {put:?}, {got:?}");
        }
        let error = Columns::named(["q", "theta"]).unwrap_err();
        let text = error.to_string();
        assert!(
            text.starts_with("got the column \"theta\", expected columns from q, q_d,"),
            "{text}"
        );
    }
}
