//! The displayed wrench without its offset for an untouched arm, over a socket.

use franka_async::nalgebra::Vector3;
use franka_sim::Touch;
use serde_json::{Value, json};

use crate::viewer::{Served, Viewer};

fn tare(viewer: &mut Viewer, on: bool) {
    viewer.send(json!({"type": "tare", "on": on}));
}

/// Returns the force along z of the newest frame, `[N]`.
fn force_z(viewer: &mut Viewer) -> f64 {
    viewer.wait_for("frame");
    let bytes = viewer.frame[152..156].try_into().expect("four bytes");
    f64::from(f32::from_le_bytes(bytes))
}

#[test]
fn a_tare_is_shown_to_every_viewer_until_it_is_cleared() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    let mut other = Viewer::connect(served.address);
    tare(&mut other, true);
    assert!(other.refusal().contains("take the lease"));
    viewer.take();
    // An undeclared weight.
    served.with(|robot| robot.touch(Touch::force(Vector3::new(0.0, 0.0, -5.0))));
    while force_z(&mut viewer) < 2.0 {}
    served.wait_for_rest();
    tare(&mut viewer, true);
    viewer.event("Tare taken");
    let taken = other.wait_until("tare", |it| it["tare"] != Value::Null);
    let taken = &taken["tare"];
    let numbers = |name: &str| -> Vec<f64> {
        let list = taken[name].as_array().expect("a list");
        list.iter()
            .map(|it| it.as_f64().expect("a number"))
            .collect()
    };
    let left = force_z(&mut viewer) - numbers("wrench")[2];
    assert!(left.abs() < 1.0, "{left} N");
    let state = served.robot.state();
    for (q, expected) in numbers("q").iter().zip(state.q) {
        assert!((q - expected).abs() < 2e-3, "{q}, {expected}");
    }
    assert_eq!(taken["near"], 0.035);
    assert!(!state.motion_running());
    // A later viewer receives it, even after the commander has disconnected.
    viewer.send(json!({"type": "release"}));
    let mut late = Viewer::connect(served.address);
    late.take();
    tare(&mut late, false);
    other.wait_until("tare", |it| it["tare"] == Value::Null);
}

#[test]
fn late_viewer_gets_tare_and_cleared_tare_stays_cleared() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    tare(&mut viewer, true);
    viewer.event("Tare taken");
    // The socket sends it as its first message.
    let mut late = Viewer::greeted(served.address, "ws");
    assert_ne!(late.wait_for("tare")["tare"], Value::Null);
    // The second tare is cancelled while it is running.
    tare(&mut viewer, true);
    tare(&mut viewer, false);
    late.wait_until("tare", |it| it["tare"] == Value::Null);
    let time = served.robot.state().message_id;
    while served.robot.state().message_id < time + 1000 {
        let message = late.read().expect("the server has closed");
        assert!(message["type"] != "tare" || message["tare"] == Value::Null);
    }
}

#[test]
fn a_tare_is_cleared_when_the_load_changes() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    tare(&mut viewer, true);
    viewer.event("Tare taken");
    served.set_load(0.2);
    viewer.event("Tare cleared: the load has changed");
    let mut late = Viewer::greeted(served.address, "ws");
    assert_eq!(late.wait_for("tare")["tare"], Value::Null);
}

#[test]
fn an_arm_that_moves_is_not_tared() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    let start = served.height();
    let up = json!({"kind": "translate", "direction": [0, 0, 1], "axes": "base"});
    viewer.hold_until(&up, || served.height() > start + 0.005);
    // Refused at once while the arm moves up or brakes.
    tare(&mut viewer, true);
    viewer.event("Tare failed: ");
    viewer.send(json!({"type": "end"}));
    served.wait_for_rest();
    tare(&mut viewer, true);
    viewer.event("Tare taken");
}
