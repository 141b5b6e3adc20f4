//! The datagrams of the wire file: commands and states.

use anyhow::{Context as _, bail};
use franka_proto::{
    ControllerMode, Errors, MotionGeneratorMode, RobotCommand, RobotError, RobotMode, RobotState,
    Version,
};

use super::Report;
use super::wire::Golden;

/// Checks one command.
pub(super) fn command(
    report: &mut Report,
    version: Version,
    name: &str,
    golden: &Golden,
) -> anyhow::Result<()> {
    let values = &golden.values;
    let elbow = values.get("motion.elbow_c")?;
    let valid_elbow = values.flag("motion.valid_elbow")?;
    let expected = RobotCommand {
        message_id: values.get("message_id")?,
        q_c: values.get("motion.q_c")?,
        dq_c: values.get("motion.dq_c")?,
        O_T_EE_c: values.get("motion.O_T_EE_c")?,
        O_dP_EE_c: values.get("motion.O_dP_EE_c")?,
        elbow_c: valid_elbow.then_some(elbow),
        motion_generation_finished: values.flag("motion.motion_generation_finished")?,
        tau_J_d: values.get("control.tau_J_d")?,
        torque_command_finished: values.find("control.torque_command_finished")? == Some(1),
    };
    // An elbow that does not count is random in the file and zero when this crate writes it.
    let mut bytes = golden.bytes.clone();
    if !valid_elbow {
        bytes[ELBOW].fill(0);
    }
    report.case(name, |case| {
        let decoded = RobotCommand::decode(version, &golden.bytes);
        case.equal("values", decoded, Ok(expected));
        let mut buffer = [0; RobotCommand::MAX_SIZE];
        let size = expected.encode(version, &mut buffer);
        case.equal("size", size, Ok(golden.bytes.len()));
        case.equal("bytes", &buffer[..bytes.len()], &bytes[..]);
    });
    Ok(())
}

/// Position of `elbow_c` in a command of both versions.
const ELBOW: std::ops::Range<usize> = 296..312;

/// Checks one state, with the mass that libfranka derives from it.
pub(super) fn state(
    report: &mut Report,
    version: Version,
    name: &str,
    golden: &Golden,
) -> anyhow::Result<()> {
    let values = &golden.values;
    let mut same = serde_json::to_value(RobotState::default())?;
    let fields = same.as_object_mut().context("a state has fields")?;
    for (name, value) in fields {
        if !OTHERWISE.contains(&name.as_str()) {
            *value = values.get(name)?;
        }
    }
    let expected = RobotState {
        accelerometer_top: accelerometers(values.find("accelerometer_top")?),
        accelerometer_bottom: accelerometers(values.find("accelerometer_bottom")?),
        motion_generator_mode: generator(values.get("motion_generator_mode")?)?,
        controller_mode: ControllerMode::from_byte(values.get("controller_mode")?),
        errors: errors(values.get("errors")?),
        reflex_reason: errors(values.get("reflex_reason")?),
        robot_mode: RobotMode::from_byte(values.get("robot_mode")?),
        ..serde_json::from_value(same)?
    };
    let mass = values.get("derived_m_total")?;
    report.case(name, |case| {
        let decoded = RobotState::decode(version, &golden.bytes);
        case.equal("values", decoded, Ok(expected));
        let mut buffer = [0; RobotState::MAX_SIZE];
        let size = expected.encode(version, &mut buffer);
        case.equal("size", size, Ok(golden.bytes.len()));
        case.equal("bytes", &buffer[..golden.bytes.len()], &golden.bytes[..]);
        let total = expected.total_load(version).m_total;
        case.near("m_total", &[total], &[mass], 0.0);
    });
    Ok(())
}

/// Fields that the file writes in another form.
const OTHERWISE: [&str; 7] = [
    "accelerometer_top",
    "accelerometer_bottom",
    "motion_generator_mode",
    "controller_mode",
    "errors",
    "reflex_reason",
    "robot_mode",
];

fn accelerometers(flat: Option<[f32; 18]>) -> [[f32; 3]; 6] {
    let flat = flat.unwrap_or_default();
    std::array::from_fn(|sensor| std::array::from_fn(|axis| flat[3 * sensor + axis]))
}

/// A flag for each of the 41 errors.
fn errors(flags: Vec<u8>) -> Errors {
    assert_eq!(flags.len(), RobotError::ALL.len());
    let errors = RobotError::ALL.into_iter().zip(flags);
    errors
        .filter_map(|(error, flag)| (flag != 0).then_some(error))
        .collect()
}

fn generator(number: u8) -> anyhow::Result<MotionGeneratorMode> {
    Ok(match number {
        0 => MotionGeneratorMode::Idle,
        1 => MotionGeneratorMode::JointPosition,
        2 => MotionGeneratorMode::JointVelocity,
        3 => MotionGeneratorMode::CartesianPosition,
        4 => MotionGeneratorMode::CartesianVelocity,
        5 => MotionGeneratorMode::None,
        _ => bail!("motion generator {number}"),
    })
}
