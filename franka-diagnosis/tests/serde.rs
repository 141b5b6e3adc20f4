//! What the feature `serde` writes, and that it is read back as it was.

use franka_diagnosis::{Case, Commander, Diagnosis};
use franka_model::Model;
use franka_proto::{ControllerMode, RobotCommand, RobotError, RobotState};
use franka_rt::driver::ControlLog;
use serde_json::json;

#[test]
fn a_diagnosis_names_its_parts() {
    let state = |message_id, dq: f64| RobotState {
        message_id,
        dq: [0.0, 0.0, 0.0, dq, 0.0, 0.0, 0.0],
        controller_mode: ControllerMode::ExternalController,
        ..RobotState::default()
    };
    let log: ControlLog = serde_json::from_value(json!([
        { "state": state(7, 0.0), "command": RobotCommand::default() },
        { "state": state(8, 3.0), "command": RobotCommand::default() },
    ]))
    .unwrap();
    let diagnosis = Diagnosis::of(&Case {
        commander: Commander::Function,
        errors: RobotError::JointVelocityViolation.into(),
        log: &log,
        model: Model::fer(),
        statistics: None,
    });
    let text = serde_json::to_string(&diagnosis).unwrap();
    assert_eq!(serde_json::from_str::<Diagnosis>(&text).unwrap(), diagnosis);
    let value = serde_json::to_value(&diagnosis).unwrap();
    assert_eq!(value["commander"], "Function");
    assert_eq!(value["error"], "joint_velocity_violation");
    assert_eq!(value["finding"]["subject"], json!({ "Joint": 4 }));
    assert_eq!(value["finding"]["bound"], json!({ "AtMost": 2.175 }));
    assert_eq!(value["finding"]["since"], 8);
    // Joint 4 at zero is outside its range, too.
    assert_eq!(value["advice"], json!(["SlowDown", "StayInRange"]));
}
