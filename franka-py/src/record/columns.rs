//! What can be recorded of a cycle.

use franka_async::record::{Activity, Guard, Record};
use franka_async::state::{RobotError, RobotMode, RobotState};

/// One quantity of every cycle.
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) shape: &'static [usize],
    pub(super) kind: Kind,
    pub(super) read: Read,
}

/// What the numbers of a column become in Python.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Float,
    Count,
    Flag,
    /// Names by their numbers.
    Name(fn(usize) -> String),
}

/// Where a column comes from.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Source {
    State,
    Cycle,
}

/// Where a column comes from, and how it is appended to a row.
#[derive(Clone, Copy)]
pub(super) enum Read {
    State(fn(&RobotState, &mut Vec<f64>)),
    Cycle(fn(&Record, &mut Vec<f64>)),
}

/// One cycle, as the robot or as the control thread has it.
pub(super) enum Seen {
    State(Box<RobotState>),
    Cycle(Box<Record>),
}

impl Seen {
    /// `message_id` of the state.
    pub(super) fn time(&self) -> u64 {
        match self {
            Self::State(state) => state.message_id,
            Self::Cycle(record) => record.time,
        }
    }
}

impl Column {
    /// Appends what it is in this cycle.
    pub(super) fn append(&self, seen: &Seen, row: &mut Vec<f64>) {
        match (self.read, seen) {
            (Read::State(read), Seen::State(state)) => read(state, row),
            (Read::Cycle(read), Seen::Cycle(record)) => read(record, row),
            _ => unreachable!("tables have columns of one source"),
        }
    }

    pub(super) fn source(&self) -> Source {
        match self.read {
            Read::State(_) => Source::State,
            Read::Cycle(_) => Source::Cycle,
        }
    }

    /// Numbers in a row.
    pub(super) fn width(&self) -> usize {
        self.shape.iter().product()
    }
}

/// The column of this name.
pub(super) fn find(name: &str) -> Option<&'static Column> {
    COLUMNS.iter().find(|column| column.name == name)
}

const fn column(
    name: &'static str,
    shape: &'static [usize],
    unit: &'static str,
    kind: Kind,
    read: Read,
) -> Column {
    Column {
        name,
        unit,
        shape,
        kind,
        read,
    }
}

/// A field of the state that is a vector.
macro_rules! vector {
    ($name:ident, $size:literal, $unit:literal) => {
        column(
            stringify!($name),
            &[$size],
            $unit,
            Kind::Float,
            Read::State(|state, row| row.extend_from_slice(&state.$name)),
        )
    };
}

/// A field of the state that is a matrix, column-major there and row-major here.
macro_rules! matrix {
    ($name:ident, $size:literal, $unit:literal) => {
        column(
            stringify!($name),
            &[$size, $size],
            $unit,
            Kind::Float,
            Read::State(|state, row| {
                let entry = |i: usize| state.$name[i % $size * $size + i / $size];
                row.extend((0..$size * $size).map(entry));
            }),
        )
    };
}

/// A number of the state.
macro_rules! number {
    ($name:ident, $unit:literal) => {
        column(
            stringify!($name),
            &[],
            $unit,
            Kind::Float,
            Read::State(|state, row| row.push(state.$name)),
        )
    };
}

/// The accelerometers of a side.
macro_rules! accelerometers {
    ($name:ident) => {
        column(
            stringify!($name),
            &[6, 3],
            "m/s^2",
            Kind::Float,
            Read::State(|state, row| {
                row.extend(state.$name.as_flattened().iter().copied().map(f64::from));
            }),
        )
    };
}

/// A column of the control thread's record.
macro_rules! cycle {
    ($name:literal, $shape:expr, $unit:literal, $kind:expr, $read:expr) => {
        column($name, $shape, $unit, $kind, Read::Cycle($read))
    };
}

pub(super) static COLUMNS: [Column; 64] = [
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
        Kind::Name(|i| {
            RobotMode::ALL
                .get(i)
                .map_or_else(String::new, crate::errors::variant)
        }),
        Read::State(|state, row| {
            let place = RobotMode::ALL
                .iter()
                .position(|mode| *mode == state.robot_mode);
            row.push(place.unwrap_or(RobotMode::ALL.len()) as f64);
        }),
    ),
    column(
        "current_errors",
        &[RobotError::ALL.len()],
        "errors by index",
        Kind::Flag,
        Read::State(|state, row| {
            row.extend(RobotError::ALL.map(|error| f64::from(state.errors.contains(error))));
        }),
    ),
    column(
        "last_motion_errors",
        &[RobotError::ALL.len()],
        "errors by index",
        Kind::Flag,
        Read::State(|state, row| {
            row.extend(RobotError::ALL.map(|error| f64::from(state.reflex_reason.contains(error))));
        }),
    ),
    cycle!("q_ref", &[7], "rad", Kind::Float, |cycle, row| row
        .extend_from_slice(&cycle.q_ref)),
    cycle!("dq_ref", &[7], "rad/s", Kind::Float, |cycle, row| row
        .extend_from_slice(&cycle.dq_ref)),
    cycle!("ddq_ref", &[7], "rad/s^2", Kind::Float, |cycle, row| row
        .extend_from_slice(&cycle.ddq_ref)),
    cycle!("tau_c", &[7], "N m", Kind::Float, |cycle, row| row
        .extend_from_slice(&cycle.tau_c)),
    cycle!("compensation", &[7], "N m", Kind::Float, |cycle, row| row
        .extend_from_slice(&cycle.compensation)),
    cycle!("elapsed", &[], "s", Kind::Float, |cycle, row| row
        .push(cycle.elapsed.as_secs_f64())),
    cycle!("remaining", &[], "s", Kind::Float, |cycle, row| row
        .push(cycle.remaining.as_secs_f64())),
    cycle!("late", &[], "s", Kind::Float, |cycle, row| row
        .push(cycle.late.as_secs_f64())),
    cycle!("turnaround", &[], "s", Kind::Float, |cycle, row| row
        .push(cycle.turnaround.as_secs_f64())),
    cycle!(
        "slack",
        &[],
        "s, not a number where no command left",
        Kind::Float,
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
        Kind::Count,
        |cycle, row| row.push(cycle.goal as f64)
    ),
    cycle!("skipped", &[], "states", Kind::Count, |cycle, row| row
        .push(cycle.skipped as f64)),
    cycle!("activity", &[], "", Kind::Name(activity), |cycle, row| {
        let place = ACTIVITIES.iter().position(|it| *it == cycle.activity);
        row.push(place.unwrap_or(ACTIVITIES.len()) as f64);
    }),
    cycle!("leash_binds", &[], "", Kind::Flag, |cycle, row| binds(
        cycle,
        row,
        Guard::Leash
    )),
    cycle!("force_cap_binds", &[], "", Kind::Flag, |cycle, row| binds(
        cycle,
        row,
        Guard::ForceCap
    )),
    cycle!("torque_clamp_binds", &[], "", Kind::Flag, |cycle, row| {
        binds(cycle, row, Guard::TorqueClamp)
    }),
    cycle!("velocity_binds", &[], "", Kind::Flag, |cycle, row| binds(
        cycle,
        row,
        Guard::JointVelocity
    )),
    cycle!(
        "position_envelope_binds",
        &[],
        "",
        Kind::Flag,
        |cycle, row| binds(cycle, row, Guard::PositionEnvelope)
    ),
    cycle!("clearance_binds", &[], "", Kind::Flag, |cycle, row| binds(
        cycle,
        row,
        Guard::Clearance
    )),
];

fn binds(cycle: &Record, row: &mut Vec<f64>, guard: Guard) {
    row.push(f64::from(cycle.bindings.contains(guard)));
}

const ACTIVITIES: [Activity; 6] = [
    Activity::Watching,
    Activity::Armed,
    Activity::Waiting,
    Activity::Running,
    Activity::Finishing,
    Activity::Silent,
];

fn activity(i: usize) -> String {
    ACTIVITIES
        .get(i)
        .map_or_else(String::new, crate::errors::variant)
}
