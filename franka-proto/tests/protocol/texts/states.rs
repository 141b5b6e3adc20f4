//! libfranka's text form of states.
#![allow(non_snake_case)]

use franka_proto::{RobotError, RobotMode, RobotState, Version, gripper, vacuum};
use serde_json::{Value, json};

/// Returns the keys of an object's text, in the order of the text.
fn keys(text: &str, value: &Value) -> Vec<String> {
    let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
    keys.sort_by_key(|key| text.find(&format!("\"{key}\": ")).unwrap());
    keys
}

#[test]
fn state_prints_as_json_object_in_libfranka_key_order() {
    let state = RobotState {
        message_id: 1234,
        q: [0.123456789, -1e-9, 2.0, 1e7, 0.0, -0.5, 3.0],
        m_ee: 0.73,
        m_load: 0.5,
        accelerometer_top: [[1.0, 2.0, 9.81]; 6],
        errors: RobotError::JointReflex.into(),
        robot_mode: RobotMode::UserStopped,
        control_command_success_rate: 0.97,
        ..RobotState::default()
    };
    let text = state.text(Version::V10).to_string();
    let value: Value = serde_json::from_str(&text).unwrap();
    let order = "O_T_EE O_T_EE_d F_T_NE NE_T_EE F_T_EE EE_T_K m_ee F_x_Cee I_ee m_load F_x_Cload \
                 I_load m_total F_x_Ctotal I_total elbow elbow_d elbow_c delbow_c ddelbow_c tau_J \
                 tau_J_d dtau_J q dq q_d dq_d ddq_d joint_contact cartesian_contact \
                 joint_collision cartesian_collision tau_ext_hat_filtered O_F_ext_hat_K \
                 K_F_ext_hat_K O_dP_EE_d O_ddP_O O_T_EE_c O_dP_EE_c O_ddP_EE_c theta dtheta \
                 accelerometer_top accelerometer_bottom current_errors last_motion_errors \
                 control_command_success_rate robot_mode time";
    let order: Vec<&str> = order.split(' ').collect();
    assert_eq!(keys(&text, &value), order);
    assert!(text.contains(r#""q": [0.123457,-1e-09,2,1e+07,0,-0.5,3], "dq": [0,0"#));
    assert!(text.contains(r#""accelerometer_top": [[1,2,9.81], [1,2,9.81], "#));
    assert!(text.contains(r#""m_total": 1.23, "#));
    assert!(text.ends_with(
        r#""current_errors": ["joint_reflex"], "last_motion_errors": [], "control_command_success_rate": 0.97, "robot_mode": "User stopped", "time": 1234}"#
    ));

    let text = state.text(Version::V5).to_string();
    let value: Value = serde_json::from_str(&text).unwrap();
    let order: Vec<&str> = order
        .into_iter()
        .filter(|key| !key.starts_with("accelerometer"))
        .collect();
    assert_eq!(keys(&text, &value), order);
}

#[test]
fn states_of_end_effectors_print_with_seconds() {
    let state = gripper::State {
        message_id: 1500,
        width: 0.04,
        max_width: 0.08,
        is_grasped: true,
        temperature: 31,
    };
    assert_eq!(
        state.to_string(),
        r#"{"width": 0.04, "max_width": 0.08, "is_grasped": 1, "temperature": 31, "time": 1.5}"#
    );
    let state = vacuum::State {
        message_id: 20,
        in_control_range: true,
        part_present: true,
        device_status: vacuum::DeviceStatus::Orange,
        actual_power: 55,
        vacuum: 610,
        ..vacuum::State::default()
    };
    let text = state.to_string();
    assert_eq!(
        text,
        r#"{"in_control_range": 1, "part_detached": 0, "part_present": 1, "device_status": "Orange", "actual_power": 55, "vacuum": 610, "time": 0.02}"#
    );
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["time"], json!(0.02));
}
