//! The datagrams of the wire file: commands and states.

use franka_proto::{
    ControllerMode, Errors, MotionGeneratorMode, RobotCommand, RobotError, RobotMode, RobotState,
};

use super::wire::{Golden, narrow};
use super::{Malformed, Node, Report};

/// Checks one command.
pub(super) fn command(report: &mut Report, golden: &Golden<'_>) -> Result<(), Malformed> {
    let values = &golden.values;
    let flag = |name: &str| values.get(name)?.boolean();
    let elbow = values.get("motion.elbow_c")?.numbers()?;
    let valid_elbow = flag("motion.valid_elbow")?;
    let expected = RobotCommand {
        message_id: values.get("message_id")?.integer()?,
        q_c: values.get("motion.q_c")?.numbers()?,
        dq_c: values.get("motion.dq_c")?.numbers()?,
        O_T_EE_c: values.get("motion.O_T_EE_c")?.numbers()?,
        O_dP_EE_c: values.get("motion.O_dP_EE_c")?.numbers()?,
        elbow_c: valid_elbow.then_some(elbow),
        motion_generation_finished: flag("motion.motion_generation_finished")?,
        tau_J_d: values.get("control.tau_J_d")?.numbers()?,
        torque_command_finished: match values.find("control.torque_command_finished") {
            Some(flag) => flag.boolean()?,
            None => false,
        },
    };
    // An elbow that does not count is random in the file and zero when this crate writes it.
    let mut bytes = golden.bytes.clone();
    if !valid_elbow {
        bytes[ELBOW].fill(0);
    }
    report.case(&golden.name, |case| {
        let decoded = RobotCommand::decode(golden.version, &golden.bytes);
        case.equal("values", decoded, Ok(expected));
        let mut buffer = [0; RobotCommand::MAX_SIZE];
        let size = expected.encode(golden.version, &mut buffer);
        case.equal("size", size, Ok(golden.bytes.len()));
        case.equal("bytes", &buffer[..bytes.len()], &bytes[..]);
    });
    Ok(())
}

/// Where `elbow_c` is in a command of both versions.
const ELBOW: std::ops::Range<usize> = 296..312;

/// Checks one state, with the mass that libfranka derives from it.
pub(super) fn state(report: &mut Report, golden: &Golden<'_>) -> Result<(), Malformed> {
    let values = &golden.values;
    macro_rules! expected {
        ($($array:ident),*) => {
            RobotState {
                message_id: values.get("message_id")?.integer()?,
                m_ee: values.get("m_ee")?.number()?,
                m_load: values.get("m_load")?.number()?,
                $($array: values.get(stringify!($array))?.numbers()?,)*
                accelerometer_top: accelerometers(values.find("accelerometer_top"))?,
                accelerometer_bottom: accelerometers(values.find("accelerometer_bottom"))?,
                motion_generator_mode: generator(&values.get("motion_generator_mode")?)?,
                controller_mode: ControllerMode::from_byte(narrow(&values.get("controller_mode")?)?),
                errors: errors(&values.get("errors")?)?,
                reflex_reason: errors(&values.get("reflex_reason")?)?,
                robot_mode: RobotMode::from_byte(narrow(&values.get("robot_mode")?)?),
                control_command_success_rate:
                    values.get("control_command_success_rate")?.number()?,
            }
        };
    }
    let expected = expected!(
        O_T_EE,
        O_T_EE_d,
        F_T_EE,
        EE_T_K,
        F_T_NE,
        NE_T_EE,
        I_ee,
        F_x_Cee,
        I_load,
        F_x_Cload,
        elbow,
        elbow_d,
        tau_J,
        tau_J_d,
        dtau_J,
        q,
        q_d,
        dq,
        dq_d,
        ddq_d,
        joint_contact,
        cartesian_contact,
        joint_collision,
        cartesian_collision,
        tau_ext_hat_filtered,
        O_F_ext_hat_K,
        K_F_ext_hat_K,
        O_dP_EE_d,
        O_ddP_O,
        elbow_c,
        delbow_c,
        ddelbow_c,
        O_T_EE_c,
        O_dP_EE_c,
        O_ddP_EE_c,
        theta,
        dtheta
    );
    let mass = values.get("derived_m_total")?.number()?;
    report.case(&golden.name, |case| {
        let decoded = RobotState::decode(golden.version, &golden.bytes);
        case.equal("values", decoded, Ok(expected));
        let mut buffer = [0; RobotState::MAX_SIZE];
        let size = expected.encode(golden.version, &mut buffer);
        case.equal("size", size, Ok(golden.bytes.len()));
        case.equal("bytes", &buffer[..golden.bytes.len()], &golden.bytes[..]);
        let total = expected.total_load(golden.version).m_total;
        case.near("m_total", &[total], &[mass], 0.0);
    });
    Ok(())
}

fn accelerometers(node: Option<Node<'_>>) -> Result<[[f32; 3]; 6], Malformed> {
    let Some(node) = node else {
        return Ok(Default::default());
    };
    let flat: [f64; 18] = node.numbers()?;
    Ok(std::array::from_fn(|sensor| {
        std::array::from_fn(|axis| flat[3 * sensor + axis] as f32)
    }))
}

fn errors(node: &Node<'_>) -> Result<Errors, Malformed> {
    let flags = node.list()?;
    let mut errors = Errors::NONE;
    for (index, flag) in flags.iter().enumerate() {
        let error = RobotError::from_index(index).ok_or_else(|| flag.malformed("41 flags"))?;
        if flag.boolean()? {
            errors.insert(error);
        }
    }
    Ok(errors)
}

fn generator(node: &Node<'_>) -> Result<MotionGeneratorMode, Malformed> {
    Ok(match node.integer()? {
        0 => MotionGeneratorMode::Idle,
        1 => MotionGeneratorMode::JointPosition,
        2 => MotionGeneratorMode::JointVelocity,
        3 => MotionGeneratorMode::CartesianPosition,
        4 => MotionGeneratorMode::CartesianVelocity,
        5 => MotionGeneratorMode::None,
        _ => return Err(node.malformed("a motion generator")),
    })
}
