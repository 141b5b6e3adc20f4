//! Data derived from the rows of a table.
//!
//! A table lacks the modes, the command numbers, and the derivatives that the robot computes. This
//! module derives them from two facts: a motion has one kind of command and zeros for all other
//! kinds, and a robot publishes its previous command as the commanded value. All other fields keep
//! their default values, because the log contains no tool, no contact flags and no wrench.

use franka_model::{CYCLE, JointVector, Twist, rotation, transform};
use franka_proto::{
    ControllerMode, Errors, MotionGeneratorMode as Generator, RobotCommand, RobotMode, RobotState,
};
use franka_rt::driver::{ControlLog, LogEntry, Record};
use nalgebra::Isometry3;

use super::table::{Row, Table};
use crate::{Cycle, HostTime};

pub(super) struct Motion {
    pub(super) log: ControlLog,
    pub(super) commands: Vec<RobotCommand>,
}

impl Motion {
    pub(super) fn of(table: Table, errors: Errors) -> Self {
        let rows = table.rows;
        let generator = generator(&rows);
        let has_torques = rows.iter().any(|row| has(&row.command.tau_J_d));
        let commands: Vec<_> = rows.iter().map(|row| row.command).collect();
        let mut entries: Vec<LogEntry> = Vec::with_capacity(rows.len());
        for row in rows {
            let before = entries.last().map(|entry| entry.state);
            let mut entry = LogEntry::new(row.state, row.command);
            entry.command.message_id = match before {
                _ if is_empty(&row.command) && !may_rest(generator, has_torques, before) => 0,
                Some(before) => before.message_id,
                None => row.state.message_id.saturating_sub(1),
            };
            let state = &mut entry.state;
            state.robot_mode = RobotMode::Move;
            state.motion_generator_mode = generator.unwrap_or(Generator::None);
            state.controller_mode = match generator {
                Some(_) if !has_torques => ControllerMode::JointImpedance,
                _ => ControllerMode::ExternalController,
            };
            entries.push(entry);
        }
        echo(&mut entries);
        Self {
            log: ended_by(&ControlLog::from_iter(entries), errors),
            commands,
        }
    }
}

/// Returns the motion generator whose commands are not zero; `None` if the log contains only
/// torques.
fn generator(rows: &[Row]) -> Option<Generator> {
    let any = |of: fn(&RobotCommand) -> &[f64]| rows.iter().any(|row| has(of(&row.command)));
    if any(|it| &it.q_c) {
        Some(Generator::JointPosition)
    } else if any(|it| &it.dq_c) {
        Some(Generator::JointVelocity)
    } else if any(|it| &it.O_T_EE_c) {
        Some(Generator::CartesianPosition)
    } else if any(|it| &it.O_dP_EE_c) {
        Some(Generator::CartesianVelocity)
    } else {
        None
    }
}

/// Returns true if zeros can be a real command. Velocities and torques can be zero, except in the
/// first command of a motion.
fn may_rest(generator: Option<Generator>, has_torques: bool, before: Option<RobotState>) -> bool {
    let is_velocity = matches!(
        generator,
        None | Some(Generator::JointVelocity | Generator::CartesianVelocity)
    );
    before.is_some() && (is_velocity || has_torques)
}

/// Fills in the values that a robot publishes after each command of the motion.
fn echo(entries: &mut [LogEntry]) {
    // The first state of a motion precedes every command.
    let is_whole = entries[0].command.message_id == 0;
    let pose = |entry: &LogEntry| transform::isometry_from_array(&entry.command.O_T_EE_c);
    let start = entries.iter().find_map(pose);
    for i in 0..entries.len() {
        let now = entries[i].state;
        let before = (i > 0).then(|| entries[i - 1].state);
        let passed = before.map_or(CYCLE, |it| (now.message_id - it.message_id) as f64 * CYCLE);
        let commanded = pose(&entries[i]);
        let entry = &mut entries[i];
        let state = &mut entry.state;
        state.tau_J_d = entry.command.tau_J_d;
        state.O_dP_EE_c = entry.command.O_dP_EE_c;
        if let Some(start) = start {
            let then = before.and_then(|it| transform::isometry_from_array(&it.O_T_EE_c));
            let (then, commanded) = (then.unwrap_or(start), commanded.unwrap_or(start));
            state.O_T_EE_c = transform::array(&commanded);
            state.O_dP_EE_c = (difference(&commanded, &then) / passed).into();
        }
        let Some(before) = before else { continue };
        let change = JointVector::from(now.dq_d) - JointVector::from(before.dq_d);
        state.ddq_d = (change / passed).into();
        let change = Twist::from(state.O_dP_EE_c) - Twist::from(before.O_dP_EE_c);
        state.O_ddP_EE_c = (change / passed).into();
    }
    if is_whole {
        return;
    }
    // The cycles before the log are unknown, so the first states are assumed to continue like the
    // states after them.
    if let [first, second, ..] = entries {
        first.state.ddq_d = second.state.ddq_d;
        if start.is_some() {
            first.state.O_dP_EE_c = second.state.O_dP_EE_c;
        }
    }
    if let [first, second, third, ..] = entries {
        if start.is_some() {
            second.state.O_ddP_EE_c = third.state.O_ddP_EE_c;
        }
        first.state.O_ddP_EE_c = second.state.O_ddP_EE_c;
    }
}

/// Returns the displacement and the rotation vector from `from` to `to`, in base axes.
fn difference(to: &Isometry3<f64>, from: &Isometry3<f64>) -> Twist {
    let shift = to.translation.vector - from.translation.vector;
    let turn = rotation::error(&to.rotation, &from.rotation);
    Twist::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

/// Returns the log with an additional last state that shows the end of the motion with these
/// errors. A log of libfranka always has such a state, whose success rate is zero.
pub(super) fn ended_by(log: &ControlLog, errors: Errors) -> ControlLog {
    let mut entries: Vec<LogEntry> = log.iter().copied().collect();
    if let [.., _, last] = &mut entries[..]
        && last.state.control_command_success_rate == 0.0
    {
        last.state.motion_generator_mode = Generator::Idle;
        last.state.controller_mode = ControllerMode::Other;
        last.state.reflex_reason = errors;
        last.state.errors = errors;
        last.state.robot_mode = match errors.is_empty() {
            true => RobotMode::Other,
            false => RobotMode::Reflex,
        };
    }
    ControlLog::from_iter(entries).rounded()
}

/// Returns each state with the command that answers it.
pub(super) fn cycles(log: &ControlLog, commands: &[RobotCommand]) -> impl Iterator<Item = Cycle> {
    let answers = commands.iter().skip(1).copied().map(Some).chain([None]);
    log.iter().zip(answers).map(|(entry, answer)| {
        let state = entry.state;
        let answer = answer.unwrap_or_default();
        let mut record = Record::default();
        record.tau_c = answer.tau_J_d;
        if has(&answer.q_c) {
            record.q_ref = answer.q_c;
            let step = JointVector::from(answer.q_c) - JointVector::from(state.q_d);
            record.dq_ref = (step / CYCLE).into();
        } else if has(&answer.dq_c) {
            let dq = JointVector::from(answer.dq_c);
            record.q_ref = (JointVector::from(state.q_d) + dq * CYCLE).into();
            record.dq_ref = answer.dq_c;
        }
        Cycle {
            time: HostTime::default(),
            record,
            state,
            reference: None,
        }
    })
}

fn has(numbers: &[f64]) -> bool {
    numbers.iter().any(|number| *number != 0.0)
}

fn is_empty(command: &RobotCommand) -> bool {
    ![
        &command.q_c[..],
        &command.dq_c,
        &command.O_T_EE_c,
        &command.O_dP_EE_c,
        &command.tau_J_d,
    ]
    .into_iter()
    .any(has)
}
