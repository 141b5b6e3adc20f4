//! Table of the columns of a cycle: names, units and shapes, for all recordings.

use franka_proto::{RobotError, RobotMode, RobotState};

use super::record::Record;
use crate::session::Guard;

/// One quantity of a cycle, from the state or from the control thread's record.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Column {
    /// Name of the column, usually the name of the field in the state or the record.
    pub name: &'static str,
    /// Unit of the column, or the meaning of its numbers if they have no unit.
    pub unit: &'static str,
    /// Shape of the column in one cycle: empty for one number, `[4, 4]` for a pose in row-major
    /// order.
    pub shape: &'static [usize],
    /// Meaning of the column's numbers.
    pub kind: ColumnKind,
    /// Source of the column's numbers.
    pub source: ColumnSource,
}

/// Meaning of the numbers of a column.
#[derive(Clone, Copy, Debug)]
pub enum ColumnKind {
    /// Measured or computed quantity.
    Float,
    /// Whole number.
    Count,
    /// Boolean, 0 or 1.
    Flag,
    /// Index into this list of names. An index beyond the end of the list has no name.
    Name(&'static [&'static str]),
}

/// Source of a column: a function that appends the column's numbers in one cycle to a row.
#[derive(Clone, Copy, Debug)]
pub enum ColumnSource {
    /// The column is computed from the robot's state.
    State(fn(&RobotState, &mut Vec<f64>)),
    /// The column is computed from the control thread's record.
    Record(fn(&Record, &mut Vec<f64>)),
}

impl Column {
    /// Returns all columns, except the time of the cycle (the `message_id` of its state), which
    /// every recording stores anyway.
    pub fn all() -> &'static [Self] {
        &COLUMNS
    }

    /// Returns the column with this name; `None` if no column has it.
    pub fn find(name: &str) -> Option<&'static Self> {
        COLUMNS.iter().find(|column| column.name == name)
    }

    /// Returns how many numbers the column contains in one cycle.
    pub fn width(&self) -> usize {
        self.shape.iter().product()
    }

    /// Appends the column's numbers in this cycle to `row`.
    pub fn append(&self, state: &RobotState, record: &Record, row: &mut Vec<f64>) {
        match self.source {
            ColumnSource::State(read) => read(state, row),
            ColumnSource::Record(read) => read(record, row),
        }
    }
}

const fn column(
    name: &'static str,
    shape: &'static [usize],
    unit: &'static str,
    kind: ColumnKind,
    source: ColumnSource,
) -> Column {
    Column {
        name,
        unit,
        shape,
        kind,
        source,
    }
}

/// Column of a vector field of the state.
macro_rules! vector {
    ($name:ident, $size:literal, $unit:literal) => {
        column(
            stringify!($name),
            &[$size],
            $unit,
            ColumnKind::Float,
            ColumnSource::State(|state, row| row.extend_from_slice(&state.$name)),
        )
    };
}

/// Column of a matrix field of the state, which is column-major. The column is row-major.
macro_rules! matrix {
    ($name:ident, $size:literal, $unit:literal) => {
        column(
            stringify!($name),
            &[$size, $size],
            $unit,
            ColumnKind::Float,
            ColumnSource::State(|state, row| {
                let entry = |i: usize| state.$name[i % $size * $size + i / $size];
                row.extend((0..$size * $size).map(entry));
            }),
        )
    };
}

/// Column of a scalar field of the state.
macro_rules! number {
    ($name:ident, $unit:literal) => {
        column(
            stringify!($name),
            &[],
            $unit,
            ColumnKind::Float,
            ColumnSource::State(|state, row| row.push(state.$name)),
        )
    };
}

/// Column of the accelerometers of one side.
macro_rules! accelerometers {
    ($name:ident) => {
        column(
            stringify!($name),
            &[6, 3],
            "m/s^2",
            ColumnKind::Float,
            ColumnSource::State(|state, row| {
                row.extend(state.$name.as_flattened().iter().copied().map(f64::from));
            }),
        )
    };
}

/// Column of the control thread's record.
macro_rules! cycle {
    ($name:expr, $shape:expr, $unit:expr, $kind:expr, $read:expr) => {
        column($name, $shape, $unit, $kind, ColumnSource::Record($read))
    };
}

/// Column of the reference, which is zero outside target control.
macro_rules! reference {
    ($name:ident, $unit:literal) => {
        cycle!(
            stringify!($name),
            &[7],
            concat!($unit, ", not a number without a reference"),
            ColumnKind::Float,
            |cycle, row| row.extend(match cycle.q_ref == [0.0; 7] {
                true => [f64::NAN; 7],
                false => cycle.$name,
            })
        )
    };
}

/// Column that is true while a guard limits the command.
macro_rules! binds {
    ($name:literal, $guard:ident) => {
        cycle!($name, &[], "", ColumnKind::Flag, |cycle, row| {
            row.push(f64::from(cycle.bindings.contains(Guard::$guard)));
        })
    };
}

static COLUMNS: [Column; 77] = [
    vector!(q, 7, "rad"),
    vector!(q_d, 7, "rad"),
    vector!(dq, 7, "rad/s"),
    vector!(dq_d, 7, "rad/s"),
    vector!(ddq_d, 7, "rad/s^2"),
    vector!(theta, 7, "rad"),
    vector!(dtheta, 7, "rad/s"),
    vector!(tau_J, 7, "N m"),
    vector!(tau_J_d, 7, "N m"),
    vector!(dtau_J, 7, "N m/s"),
    vector!(tau_ext_hat_filtered, 7, "N m"),
    vector!(joint_contact, 7, "0 or 1"),
    vector!(joint_collision, 7, "0 or 1"),
    vector!(cartesian_contact, 6, "0 or 1"),
    vector!(cartesian_collision, 6, "0 or 1"),
    vector!(O_F_ext_hat_K, 6, "N, N m"),
    vector!(K_F_ext_hat_K, 6, "N, N m"),
    vector!(O_dP_EE_d, 6, "m/s, rad/s"),
    vector!(O_dP_EE_c, 6, "m/s, rad/s"),
    vector!(O_ddP_EE_c, 6, "m/s^2, rad/s^2"),
    vector!(O_ddP_O, 3, "m/s^2"),
    vector!(F_x_Cee, 3, "m"),
    vector!(F_x_Cload, 3, "m"),
    vector!(elbow, 2, "rad, sign"),
    vector!(elbow_d, 2, "rad, sign"),
    vector!(elbow_c, 2, "rad, sign"),
    vector!(delbow_c, 2, "rad/s, 0"),
    vector!(ddelbow_c, 2, "rad/s^2, 0"),
    matrix!(O_T_EE, 4, "m"),
    matrix!(O_T_EE_d, 4, "m"),
    matrix!(O_T_EE_c, 4, "m"),
    matrix!(F_T_EE, 4, "m"),
    matrix!(F_T_NE, 4, "m"),
    matrix!(NE_T_EE, 4, "m"),
    matrix!(EE_T_K, 4, "m"),
    matrix!(I_ee, 3, "kg m^2"),
    matrix!(I_load, 3, "kg m^2"),
    number!(m_ee, "kg"),
    number!(m_load, "kg"),
    number!(control_command_success_rate, "0 to 1"),
    accelerometers!(accelerometer_top),
    accelerometers!(accelerometer_bottom),
    column(
        "robot_mode",
        &[],
        "",
        ColumnKind::Name(&MODES),
        ColumnSource::State(|state, row| row.push(f64::from(state.robot_mode.byte()))),
    ),
    column(
        "current_errors",
        &[RobotError::ALL.len()],
        "errors by index",
        ColumnKind::Flag,
        ColumnSource::State(|state, row| {
            row.extend(RobotError::ALL.map(|error| f64::from(state.errors.contains(error))));
        }),
    ),
    column(
        "last_motion_errors",
        &[RobotError::ALL.len()],
        "errors by index",
        ColumnKind::Flag,
        ColumnSource::State(|state, row| {
            row.extend(RobotError::ALL.map(|error| f64::from(state.reflex_reason.contains(error))));
        }),
    ),
    reference!(q_ref, "rad"),
    cycle!(
        "q_target",
        &[7],
        "rad, not a number where it heads for a pose or nowhere",
        ColumnKind::Float,
        |cycle, row| row.extend(cycle.q_target.unwrap_or([f64::NAN; 7]))
    ),
    reference!(dq_ref, "rad/s"),
    reference!(ddq_ref, "rad/s^2"),
    cycle!("tau_c", &[7], "N m", ColumnKind::Float, |cycle, row| row
        .extend_from_slice(&cycle.tau_c)),
    cycle!(
        "compensation",
        &[7],
        "N m",
        ColumnKind::Float,
        |cycle, row| row.extend_from_slice(&cycle.compensation)
    ),
    cycle!("elapsed", &[], "s", ColumnKind::Float, |cycle, row| row
        .push(cycle.elapsed.as_secs_f64())),
    cycle!("remaining", &[], "s", ColumnKind::Float, |cycle, row| row
        .push(cycle.remaining.as_secs_f64())),
    cycle!("late", &[], "s", ColumnKind::Float, |cycle, row| row
        .push(cycle.late.as_secs_f64())),
    cycle!("turnaround", &[], "s", ColumnKind::Float, |cycle, row| row
        .push(cycle.turnaround.as_secs_f64())),
    cycle!(
        "slack",
        &[],
        "s, not a number where no command left",
        ColumnKind::Float,
        |cycle, row| row.push(
            cycle
                .slack
                .map_or(f64::NAN, |slack| slack.as_nanos() as f64 * 1e-9)
        )
    ),
    cycle!(
        "goal",
        &[],
        "number of the goal, 0 without one",
        ColumnKind::Count,
        |cycle, row| row.push(cycle.goal as f64)
    ),
    cycle!("skipped", &[], "states", ColumnKind::Count, |cycle, row| {
        row.push(cycle.skipped as f64)
    }),
    cycle!(
        "activity",
        &[],
        "",
        ColumnKind::Name(&ACTIVITIES),
        |cycle, row| row.push(cycle.activity as u8 as f64)
    ),
    binds!("leash_binds", Leash),
    binds!("force_cap_binds", ForceCap),
    binds!("torque_clamp_binds", TorqueClamp),
    binds!("velocity_binds", JointVelocity),
    binds!("position_envelope_binds", PositionEnvelope),
    binds!("clearance_binds", Clearance),
    binds!("inverse_kinematics_binds", InverseKinematics),
    binds!("velocity_barrier_binds", VelocityBarrier),
    binds!("torque_rate_binds", TorqueRate),
    binds!("watchdog_binds", Watchdog),
    binds!("deadman_binds", Deadman),
    binds!("backstop_binds", Backstop),
    binds!("deviation_binds", Deviation),
    binds!("lead_binds", Lead),
    binds!("plan_failure_binds", PlanFailure),
    binds!("reaction_binds", Reaction),
    binds!("team_binds", Team),
    binds!("speed_cap_binds", SpeedCap),
];

/// Names of [`RobotMode`], in the order of their bytes.
const MODES: [&str; RobotMode::ALL.len()] = [
    "other",
    "idle",
    "move",
    "guiding",
    "reflex",
    "user_stopped",
    "automatic_error_recovery",
];

/// Names of [`Activity`](super::Activity), in the order of its variants.
const ACTIVITIES: [&str; 6] = [
    "watching",
    "armed",
    "waiting",
    "running",
    "finishing",
    "silent",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::Activity;

    /// Returns a name in lower case, without underscores.
    fn plain(name: &str) -> String {
        name.replace('_', "").to_lowercase()
    }

    #[test]
    fn names_are_those_of_the_values() {
        for mode in RobotMode::ALL {
            let name = MODES[usize::from(mode.byte())];
            assert_eq!(plain(name), plain(&format!("{mode:?}")));
        }
        for activity in [
            Activity::Watching,
            Activity::Armed,
            Activity::Waiting,
            Activity::Running,
            Activity::Finishing,
            Activity::Silent,
        ] {
            let name = ACTIVITIES[activity as usize];
            assert_eq!(plain(name), plain(&format!("{activity:?}")));
        }
    }

    #[test]
    fn column_has_unique_name_and_as_many_numbers_as_shape() {
        let (state, record) = (RobotState::default(), Record::default());
        for column in Column::all() {
            let mut row = Vec::new();
            column.append(&state, &record, &mut row);
            assert_eq!(row.len(), column.width(), "{}", column.name);
            let same = Column::all().iter().filter(|it| it.name == column.name);
            assert_eq!(same.count(), 1, "{}", column.name);
        }
        assert!(Column::find("q").is_some_and(|q| q.shape == [7] && q.unit == "rad"));
        assert!(Column::find("time").is_none());
    }
}
