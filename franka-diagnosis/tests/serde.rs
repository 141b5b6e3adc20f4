//! The output of the feature `serde`, and its round trip.

use std::sync::Arc;

use franka_diagnosis::{Case, Commander, Diagnosis};
use franka_model::Model;
use franka_proto::{ControllerMode, RobotCommand, RobotError, RobotState};
use franka_rt::driver::ControlLog;
use franka_rt::stats::MotionStatistics;
use serde_json::json;

#[test]
fn a_saved_case_is_diagnosed_and_the_diagnosis_names_its_parts() {
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
    let case = Case {
        commander: Commander::Function,
        errors: RobotError::JointVelocityViolation.into(),
        log: Arc::new(log),
        statistics: Some(MotionStatistics::default()),
    };
    let saved = serde_json::to_string(&case).unwrap();
    let read: Case = serde_json::from_str(&saved).unwrap();
    assert_eq!(read, case);
    let diagnosis = Diagnosis::of(&read, Model::fer());
    let text = serde_json::to_string(&diagnosis).unwrap();
    assert_eq!(serde_json::from_str::<Diagnosis>(&text).unwrap(), diagnosis);
    let value = serde_json::to_value(&diagnosis).unwrap();
    assert_eq!(value["commander"], "Function");
    assert_eq!(value["error"], "joint_velocity_violation");
    assert_eq!(value["finding"]["subject"], json!({ "Joint": 4 }));
    assert_eq!(value["finding"]["bound"], json!({ "AtMost": 2.175 }));
    assert_eq!(value["finding"]["since"], 8);
    // Joint 4 at zero is outside its range too.
    assert_eq!(value["advice"], json!(["SlowDown", "StayInRange"]));
}

/// Older cycles are not read, so the time of a diagnosis is bounded.
#[test]
fn the_newest_cycles_of_a_long_log_are_read() {
    let entry = |message_id| {
        let state = RobotState {
            message_id,
            controller_mode: ControllerMode::ExternalController,
            ..RobotState::default()
        };
        json!({ "state": state, "command": RobotCommand::default() })
    };
    let entries: Vec<_> = (1..=Diagnosis::CYCLES_MAX as u64 + 50).map(entry).collect();
    let log: ControlLog = serde_json::from_value(entries.into()).unwrap();
    let case = Case {
        commander: Commander::Function,
        errors: RobotError::JointVelocityViolation.into(),
        log: Arc::new(log),
        statistics: None,
    };
    let diagnosis = Diagnosis::of(&case, Model::fer());
    assert_eq!(diagnosis.cycles, Diagnosis::CYCLES_MAX);
    assert_eq!(diagnosis.end, Some(Diagnosis::CYCLES_MAX as u64 + 50));
}
