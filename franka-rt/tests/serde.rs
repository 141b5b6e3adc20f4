//! Output of the feature `serde`, and reading it back unchanged.

use std::fmt::Debug;
use std::sync::Arc;
use std::time::Duration;

use franka_proto::{
    ControllerMode, MotionGeneratorMode, RobotError, RobotMode, RobotState, Version,
};
use franka_rt::control::{Callback, Finish, Modes, TargetStatus, Torques};
use franka_rt::driver::{Activity, ControlLog, Driver, MotionId, Order, Program, Record};
use franka_rt::lifecycle::{MotionReport, Party};
use franka_rt::session::{Bindings, PoseError};
use franka_rt::stats::{Arrival, CycleTimes, Phase, Phases, Quantiles};
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
fn a_report_and_the_words_around_it() {
    let worst: CycleTimes = serde_json::from_value(json!({
        "time": 7,
        "late": Duration::from_micros(900),
        "turnaround": Duration::from_nanos(112_500),
        "slack": -12_500,
        "phases": Phases { program: Duration::from_micros(80), ..Phases::default() },
    }))
    .unwrap();
    assert_eq!(worst.longest().0, Phase::Arrival);
    let report: MotionReport = serde_json::from_value(json!({
        "duration": Duration::from_millis(1234),
        "final_error": PoseError { translation: 1.0 / 3.0, rotation: 1e-300 },
        "released_error": null,
        "compensation": [0.8, -0.1, 0.0, 1.2, 0.0, 0.0, 1.0 / 3.0],
        "lost_states": u64::MAX,
        "skipped_states": 2,
        "success_rate_min": 0.97,
        "success_rate_avg": 0.99,
        "worst_turnaround": Duration::from_nanos(81_234),
        "slack_min": worst.slack,
        "overruns": 1,
        "worst_cycle": worst,
        "interval": null,
        "turnaround": Quantiles { p50: Duration::from_micros(30), ..Quantiles::default() },
    }))
    .unwrap();
    let json = round_trip(&report);
    assert_eq!(json["duration"], json!({ "secs": 1, "nanos": 234_000_000 }));
    assert_eq!(json["slack_min"], json!(-12_500));
    assert_eq!(
        json["worst_cycle"]["phases"]["program"]["nanos"],
        json!(80_000)
    );
    let mut without = report;
    without.final_error = None;
    assert_eq!(round_trip(&without)["final_error"], Value::Null);
    assert_eq!(round_trip(&Party::Robot), json!("Robot"));
    assert_eq!(
        round_trip(&TargetStatus::TargetReached),
        json!("TargetReached")
    );
}

#[test]
fn a_record_names_its_errors_and_guards() {
    let bindings: Bindings = serde_json::from_value(json!(["Leash", "TorqueRate"])).unwrap();
    let mut record = Record::default();
    record.time = 7;
    record.activity = Activity::Running;
    record.robot_mode = RobotMode::Move;
    record.errors = RobotError::JointReflex.into();
    record.q = [0.1; 7];
    record.bindings = bindings;
    let json = round_trip(&record);
    assert_eq!(json["bindings"], json!(["Leash", "TorqueRate"]));
    assert_eq!(json["errors"], json!(["joint_reflex"]));
    assert_eq!(json["activity"], json!("Running"));
    assert!(serde_json::from_value::<Bindings>(json!(["Fence"])).is_err());
}

#[test]
fn a_log_is_its_cycles_oldest_first() {
    let version = Version::V10;
    let torques = Torques([1.5; 7]);
    let mut calls = 0;
    let callback = Callback::torques(version, move |_, _| {
        calls += 1;
        if calls < 4 {
            torques.into()
        } else {
            torques.finish()
        }
    });
    let mut driver = Driver::new(version);
    driver.on_order(Order::Arm {
        motion: MotionId(1),
        modes: Modes {
            generator: MotionGeneratorMode::None,
            controller: ControllerMode::ExternalController,
        },
        program: Program::Callback(Box::new(callback)),
        log: ControlLog::with_capacity(3),
        ticket: None,
        times: Arc::default(),
        observer: None,
    });
    let mut state = RobotState {
        robot_mode: RobotMode::Move,
        motion_generator_mode: MotionGeneratorMode::None,
        controller_mode: ControllerMode::ExternalController,
        ..RobotState::default()
    };
    for time in 1..=5 {
        state.message_id = time;
        driver.on_state(&state);
        driver.after_send(&state, &Arrival::default(), None);
    }
    state.robot_mode = RobotMode::Idle;
    state.message_id = 6;
    driver.on_state(&state);
    let log = std::iter::from_fn(|| driver.take_event()).find_map(|event| match event {
        franka_rt::driver::Event::Ended(ended) => Some(ended.log),
        _ => None,
    });
    let json = round_trip(&log.expect("the motion has ended"));
    let entries = json.as_array().unwrap();
    assert_eq!(entries.len(), 3);
    assert_eq!(entries[0]["state"]["message_id"], json!(4));
    assert_eq!(entries[0]["command"]["message_id"], json!(3));
    assert_eq!(
        entries[2]["command"]["torque_command_finished"],
        json!(true)
    );
}
