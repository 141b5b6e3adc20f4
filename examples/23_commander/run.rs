//! The record of each millisecond.

use std::fmt::Write as _;

use franka_async::nalgebra::Vector3;
use franka_async::record::{Activity, ControlLog, LogEntry};
use franka_async::{Pose, Robot};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::watch;

/// One millisecond of the run: positions of the hand, `[m]`.
pub(crate) struct Row {
    time: u64,
    target: Vector3<f64>,
    command: Vector3<f64>,
    measured: Vector3<f64>,
}

/// Returns every millisecond of the motion. The command is the reference of the generator, or the
/// robot's command.
pub(crate) async fn record(robot: Robot, raw: bool, targets: watch::Receiver<Pose>) -> Vec<Row> {
    let (mut records, mut states) = (robot.records(), robot.state_stream());
    let hand = |q| robot.pose_at(q).translation.vector;
    let mut rows = Vec::new();
    loop {
        let (time, command, measured) = if raw {
            let Some(reading) = states.next().await else {
                return rows;
            };
            let state = reading.state;
            if !state.motion_running() {
                continue;
            }
            (
                state.message_id,
                position(&state.O_T_EE_c),
                position(&state.O_T_EE),
            )
        } else {
            match records.recv().await {
                Ok(cycle) if cycle.activity == Activity::Running => {
                    (cycle.time, hand(cycle.q_ref), hand(cycle.q))
                }
                Ok(_) | Err(RecvError::Lagged(_)) => continue,
                Err(RecvError::Closed) => return rows,
            }
        };
        let target = targets.borrow().translation.vector;
        rows.push(Row {
            time,
            target,
            command,
            measured,
        });
    }
}

/// Replaces the end with the log of an error, which contains the command that the robot did not
/// accept.
pub(crate) fn end_with(rows: &mut Vec<Row>, log: &ControlLog) {
    let target = rows.last().map(|row| row.target).unwrap_or_default();
    let first = log.iter().next().map(|entry| entry.state.message_id);
    rows.retain(|row| first.is_none_or(|first| row.time < first));
    // An unanswered state has a command of zeros, which is not a pose.
    let answered = log.iter().filter(|entry| entry.command.O_T_EE_c[15] == 1.0);
    rows.extend(answered.map(|LogEntry { state, command, .. }| Row {
        time: state.message_id,
        target,
        command: position(&command.O_T_EE_c),
        measured: position(&state.O_T_EE),
    }));
}

fn position(pose: &[f64; 16]) -> Vector3<f64> {
    Vector3::from_column_slice(&pose[12..15])
}

/// Returns the largest velocity, acceleration and jerk of the commands, which begin at rest.
pub(crate) fn derivatives(rows: &[Row]) -> [f64; 3] {
    let at_rest = rows.first().into_iter().cycle().take(3);
    let mut values: Vec<_> = at_rest.chain(rows).map(|row| row.command).collect();
    [(); 3].map(|()| {
        values = values
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) * 1e3)
            .collect();
        values.iter().map(Vector3::norm).fold(0.0, f64::max)
    })
}

/// Returns the run as comma-separated values.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut table =
        "time,target_x,target_y,target_z,command_x,command_y,command_z,x,y,z\n".to_owned();
    for Row {
        time,
        target,
        command,
        measured,
    } in rows
    {
        let _ = write!(table, "{time}");
        for value in [target, command, measured].into_iter().flatten() {
            let _ = write!(table, ",{value:.9}");
        }
        table.push('\n');
    }
    table
}
