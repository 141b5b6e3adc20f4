//! The output of the feature `serde`, and its round trip.
#![allow(non_snake_case)]

use std::fmt::Debug;

use franka_proto::{
    Command, ControllerMode, Errors, MotionGeneratorMode, MoveControllerMode, MoveGeneratorMode,
    MoveRequest, MoveStatus, Refusal, RobotCommand, RobotError, RobotMode, RobotState, Status,
    Version, gripper, vacuum,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// Returns the value as JSON, after a round trip through its text.
fn round_trip<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) -> Value {
    let text = serde_json::to_string(value).unwrap();
    assert_eq!(&serde_json::from_str::<T>(&text).unwrap(), value, "{text}");
    serde_json::to_value(value).unwrap()
}

#[test]
fn a_state_has_the_vendors_names_and_its_errors_by_name() {
    let state = RobotState {
        message_id: u64::MAX,
        q: [0.1, -0.2, 1e-300, f64::MAX, 0.3, 1.0 / 3.0, -0.0],
        accelerometer_top: [[0.1, 0.2, 9.81]; 6],
        motion_generator_mode: MotionGeneratorMode::Unknown(77),
        controller_mode: ControllerMode::ExternalController,
        errors: RobotError::TauJRangeViolation.into(),
        reflex_reason: [RobotError::CartesianReflex, RobotError::JointReflex]
            .into_iter()
            .collect(),
        robot_mode: RobotMode::UserStopped,
        control_command_success_rate: 0.97,
        ..RobotState::default()
    };
    let json = round_trip(&state);
    assert_eq!(json["errors"], json!(["tau_J_range_violation"]));
    assert_eq!(
        json["reflex_reason"],
        json!(["joint_reflex", "cartesian_reflex"])
    );
    assert_eq!(json["robot_mode"], json!("UserStopped"));
    assert_eq!(json["motion_generator_mode"], json!({ "Unknown": 77 }));
    assert_eq!(json["O_T_EE"][5], json!(1.0));
    let fields = json.as_object().unwrap();
    assert!(fields.contains_key("K_F_ext_hat_K") && fields.contains_key("ddelbow_c"));
    round_trip(&state.total_load(Version::V10));
}

#[test]
fn every_error_goes_by_its_name_and_no_other_is_read() {
    for error in RobotError::ALL {
        assert_eq!(round_trip(&error), json!(error.name()));
    }
    assert_eq!(round_trip(&Errors::NONE), json!([]));
    let all = RobotError::ALL.into_iter().collect::<Errors>();
    assert_eq!(round_trip(&all).as_array().unwrap().len(), 41);
    let unknown = serde_json::from_str::<Errors>(r#"["joint_reflex", "no_such_error"]"#);
    let text = unknown.unwrap_err().to_string();
    assert!(text.contains("no_such_error"), "{text}");
}

#[test]
fn commands_statuses_and_refusals_come_back() {
    let command = RobotCommand {
        message_id: 1,
        elbow_c: Some([0.1, -1.0]),
        tau_J_d: [0.1; 7],
        torque_command_finished: true,
        ..RobotCommand::default()
    };
    assert_eq!(round_trip(&command)["elbow_c"], json!([0.1, -1.0]));
    let status = Status::Move(MoveStatus::ReflexAborted);
    assert_eq!(round_trip(&status), json!({ "Move": "ReflexAborted" }));
    // A refusal is never a success, so it is only serialised.
    let refusal = Refusal::new(Command::Move, status, RobotMode::Reflex).unwrap();
    assert_eq!(serde_json::to_value(refusal).unwrap()["mode"], "Reflex");
    round_trip(&MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::None,
    ));
    assert_eq!(round_trip(&Version::V10), json!("V10"));
}

#[test]
fn states_of_end_effectors_come_back() {
    round_trip(&gripper::State {
        message_id: 7,
        width: 0.04,
        max_width: 0.08,
        is_grasped: true,
        temperature: 31,
    });
    let state = vacuum::State {
        device_status: vacuum::DeviceStatus::Orange,
        vacuum: 610,
        ..vacuum::State::default()
    };
    assert_eq!(round_trip(&state)["device_status"], json!("Orange"));
    round_trip(&gripper::Grasp::new(0.02, 0.1, 40.0));
    round_trip(&gripper::Status::Unsuccessful);
}
