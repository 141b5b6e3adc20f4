//! Disturbances of a simulated robot by viewers.

use std::time::{Duration, Instant};

use franka_async::state::RobotMode;
use serde_json::{Value, json};

use crate::viewer::{LONGEST, Served, Viewer};

fn disturb(viewer: &mut Viewer, disturbance: Value) {
    viewer.send(json!({"type": "disturb", "disturbance": disturbance}));
}

#[test]
fn network_is_set_and_cut_and_the_cut_stops_a_motion() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    viewer.wait_for_status(|it| it["simulation"]["seed"] == 1);
    let lost = || served.robot.stats().lost.get();
    let before = lost();
    disturb(&mut viewer, json!({"kind": "cut", "milliseconds": 100}));
    viewer.wait_until("statistics", |_| lost() >= before + 50);
    let start = served.height();
    let up = json!({"kind": "translate", "direction": [0, 0, 1], "axes": "base"});
    viewer.hold_until(&up, || served.height() > start + 0.003);
    disturb(&mut viewer, json!({"kind": "cut", "milliseconds": 100}));
    viewer.event("communication_constraints_violation");
    assert_eq!(
        served.with(|robot| robot.state().robot_mode),
        RobotMode::Reflex
    );
    viewer.send(json!({"type": "recover"}));
    viewer.event("Recovered");

    let mut conditions = json!({"loss": 0.0, "burst": 1.0, "delay_ms": 4.0, "jitter_ms": 0.0,
        "stalls_per_second": 0.0, "stall_ms": 0.0});
    disturb(
        &mut viewer,
        json!({"kind": "network", "conditions": conditions}),
    );
    viewer.wait_for_status(|it| it["simulation"]["network"] == conditions);
    conditions["loss"] = json!(0.3);
    let before = lost();
    disturb(
        &mut viewer,
        json!({"kind": "network", "conditions": conditions}),
    );
    viewer.wait_until("statistics", |_| lost() > before + 100);
}

#[test]
fn load_and_arm_can_change_but_object_needs_a_hand() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    viewer.wait_for_status(|it| it["simulation"]["arm"] == "realistic");
    let felt = || served.robot.state().O_F_ext_hat_K[2];
    let before = felt();
    disturb(&mut viewer, json!({"kind": "load", "mass": 2}));
    viewer.wait_for_status(|it| it["simulation"]["load"] == 2.0);
    viewer.wait_until("statistics", |_| felt() - before > 15.0);
    let q = served.with(|robot| *robot.q());
    disturb(&mut viewer, json!({"kind": "arm", "arm": "bad"}));
    viewer.wait_for_status(|it| it["simulation"]["arm"] == "bad");
    let (arm, now) = served.with(|robot| (robot.config().chosen_arm(), *robot.q()));
    assert_eq!(arm, franka_sim::Arm::bad(served.robot.model().kind()));
    assert!((now - q).amax() < 0.05, "{now}");
    disturb(&mut viewer, json!({"kind": "object", "width": 0.04}));
    viewer.event("no Hand");
    viewer.wait_for_status(|it| it["simulation"]["object"] == Value::Null);
}

#[test]
fn virtual_time_pauses_and_resumes_without_disconnecting() {
    let served = Served::in_virtual_time();
    let mut viewer = Viewer::connect(served.address);
    assert_eq!(viewer.hello["virtual_time"], true);
    viewer.take();
    let time = || served.with(|robot| robot.state().message_id);
    disturb(&mut viewer, json!({"kind": "speed", "speed": 0}));
    viewer.wait_for_status(|it| it["simulation"]["speed"] == 0.0);
    let (begun, before) = (Instant::now(), time());
    // Longer than the time after which clients consider the connection lost.
    std::thread::sleep(Duration::from_millis(1500));
    let passed = time() - before;
    assert!(
        u128::from(passed) <= begun.elapsed().as_millis() / 400 + 2,
        "{passed} ms"
    );
    disturb(&mut viewer, json!({"kind": "speed", "speed": 20}));
    viewer.event("expected 0 (a pause)");
    disturb(&mut viewer, json!({"kind": "speed", "speed": null}));
    viewer.wait_until("frame", |_| served.robot.state().message_id > before + 500);

    let on_the_wall = Served::movable();
    let viewer = Viewer::connect(on_the_wall.address);
    assert_eq!(viewer.hello["virtual_time"], false);
}

#[test]
fn the_user_stop_guiding_and_the_brakes_are_those_of_the_robot() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    for (disturbance, mode) in [
        (
            json!({"kind": "user_stop", "pressed": true}),
            RobotMode::UserStopped,
        ),
        (
            json!({"kind": "user_stop", "pressed": false}),
            RobotMode::Idle,
        ),
        (
            json!({"kind": "guide", "pressed": true}),
            RobotMode::Guiding,
        ),
        (json!({"kind": "guide", "pressed": false}), RobotMode::Idle),
    ] {
        disturb(&mut viewer, disturbance);
        let begin = Instant::now();
        while viewer.frame[3] != mode.byte() {
            viewer.wait_for("frame");
            assert!(begin.elapsed() < LONGEST, "it is not {mode}");
        }
    }
    disturb(&mut viewer, json!({"kind": "brakes", "closed": true}));
    viewer.event("Brakes closed");
    disturb(&mut viewer, json!({"kind": "brakes", "closed": false}));
    viewer.event("Brakes open");
}

#[test]
fn unsimulated_robot_refuses_disturbances() {
    let served = Served::new(|_| franka_dash::Options::default().allow_motion());
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    for disturbance in [
        json!({"kind": "load", "mass": 2}),
        json!({"kind": "cut", "milliseconds": 100}),
        json!({"kind": "reflex"}),
    ] {
        disturb(&mut viewer, disturbance);
        assert!(viewer.refusal().contains("only a simulated robot"));
    }
    viewer.send(json!({"type": "gripper", "action": {"kind": "home"}}));
    assert!(viewer.refusal().contains("no gripper"));
    viewer.send(json!({"type": "record", "on": true}));
    assert!(viewer.refusal().contains("records nothing"));
    assert_eq!(served.robot.state().robot_mode, RobotMode::Idle);
}
