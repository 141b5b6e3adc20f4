//! A hold over a socket: it moves the arm, and the arm stops at its end.

use std::time::{Duration, Instant};

use serde_json::json;

use crate::viewer::{Served, Viewer};

/// Ends a hold of a viewer; the argument is the number of the hold's next message.
type Way = dyn Fn(&mut Viewer, u32);

fn up() -> serde_json::Value {
    json!({"kind": "translate", "direction": [0, 0, 1], "axes": "base"})
}

#[test]
fn the_arm_moves_while_held_and_rests_when_the_hold_is_lost() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    // Each way in which it ends, on the same arm.
    let ways: [&Way; 4] = [
        &|viewer, _| viewer.send(json!({"type": "end"})),
        &|viewer, next| viewer.send(json!({"type": "hold", "seq": next + 1})),
        &|viewer, _| viewer.send(json!({"type": "stop"})),
        // Silence, while frames are still read.
        &|viewer, _| {
            while viewer.holding {
                viewer.wait_for("frame");
            }
        },
    ];
    for (way, end) in ways.iter().enumerate() {
        let start = served.height();
        let next = viewer.hold_until(&up(), || served.height() > start + 0.005);
        end(&mut viewer, next);
        while viewer.holding {
            viewer.read().expect("the server has closed");
        }
        served.wait_for_rest();
        let rested = served.height();
        std::thread::sleep(Duration::from_millis(100));
        let crept = (served.height() - rested).abs();
        assert!(crept < 1e-3, "way {way}: it moved on by {crept} m");
    }
}

#[test]
fn the_arm_rests_when_the_page_of_its_commander_has_gone() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    let joint = json!({"kind": "joint", "joint": 1, "up": true});
    let start = served.robot.state().q[0];
    viewer.hold_until(&joint, || served.robot.state().q[0] > start + 0.01);
    drop(viewer);
    served.wait_for_rest();
    // The lease is free for the next viewer.
    Viewer::connect(served.address).take();
}

#[test]
fn a_second_viewer_sees_stops_and_does_not_command() {
    let served = Served::movable();
    let mut commander = Viewer::connect(served.address);
    commander.take();
    let mut other = Viewer::connect(served.address);
    other.send(json!({"type": "take", "name": "another"}));
    assert!(other.refusal().contains("a test"));
    other.send(json!({"type": "begin", "motion": up(), "speed": 0.1}));
    assert!(other.refusal().contains("take the lease"));
    let start = served.height();
    commander.hold_until(&up(), || served.height() > start + 0.005);
    other.send(json!({"type": "stop"}));
    while commander.holding {
        commander.read().expect("the server has closed");
    }
    served.wait_for_rest();
}

/// A dashboard and another service of the same program, or two dashboards, share the robot's lease.
#[test]
fn lease_of_the_robot_is_shared_by_all_services() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    let silence = Duration::from_secs(60);
    let lease = served.robot.lease();
    let joystick = lease.take("a joystick", silence, Instant::now());
    let joystick = joystick.expect("it is free");
    viewer.wait_for_status(|status| status["name"] == "a joystick");
    viewer.send(json!({"type": "take", "name": "a viewer"}));
    assert!(viewer.refusal().contains("\"a joystick\" holds the lease"));
    viewer.send(json!({"type": "begin", "motion": up(), "speed": 0.1}));
    assert!(viewer.refusal().contains("take the lease"));
    assert!(!served.robot.state().motion_running());
    drop(joystick);
    viewer.take();
    let taken = lease.take("a joystick", silence, Instant::now());
    assert_eq!(taken.expect_err("it is taken").name, "a test");
}

#[test]
fn status_and_refusals_tell_the_number_of_earlier_holds() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    viewer.send(json!({"type": "hold", "seq": 1}));
    assert_eq!(viewer.wait_for("refused")["begun"], 0);
    for begun in 1..=2 {
        viewer.send(json!({"type": "begin", "motion": {"kind": "stay"}, "speed": 0.1}));
        viewer.send(json!({"type": "end"}));
        viewer.wait_until("status", |it| {
            it["holding"] == false && it["begun"] == begun
        });
        viewer.send(json!({"type": "hold", "seq": 1}));
        assert_eq!(viewer.wait_for("refused")["begun"], begun);
    }
}

#[test]
fn a_stop_is_answered_to_who_asked_for_it() {
    let served = Served::new(|_| franka_dash::Options::default());
    let mut viewer = Viewer::connect(served.address);
    viewer.send(json!({"type": "stop"}));
    viewer.wait_for("stopping");
}

#[test]
fn malformed_request_is_refused_and_ends_nothing() {
    let served = Served::movable();
    let mut commander = Viewer::connect(served.address);
    commander.take();
    let mut other = Viewer::connect(served.address);
    for text in [
        "",
        "[]",
        "{\"type\":\"hold\"}",
        "\u{0}",
        "{\"type\":\"begin\"}",
    ] {
        other.send_text(text);
        assert!(other.refusal().starts_with("not a request"), "{text:?}");
    }
    let start = served.height();
    commander.hold_until(&up(), || served.height() > start + 0.005);
    commander.send(json!({"type": "end"}));
    served.wait_for_rest();
}

#[test]
fn a_view_only_server_moves_nothing() {
    let served = Served::new(|_| franka_dash::Options::default());
    let mut viewer = Viewer::connect(served.address);
    viewer.send(json!({"type": "take", "name": "a test"}));
    assert!(viewer.refusal().contains("view-only"));
    viewer.send(json!({"type": "begin", "motion": up(), "speed": 0.1}));
    assert!(viewer.refusal().contains("take the lease"));
    assert!(!served.robot.state().motion_running());
}
