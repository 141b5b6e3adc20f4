//! The preview of a motion, which the motion then follows.

use franka_async::Pose;
use franka_async::goal::target_range;
use franka_async::model::collision::Obstacle;
use franka_async::nalgebra::{UnitQuaternion, Vector3};
use franka_async::pose;
use franka_dash::Options;
use serde_json::{Value, json};

use crate::viewer::{Served, Viewer};

fn motion(pose: &Pose) -> Value {
    let (position, orientation) = pose::to_xyzw(pose);
    json!({"kind": "pose", "position": position, "orientation": orientation})
}

/// Returns the answer to a question.
fn preview(viewer: &mut Viewer, number: u32, motion: &Value) -> Value {
    viewer.send(json!({"type": "preview", "number": number, "motion": motion, "speed": 0.2}));
    let answer = viewer.wait_for("preview");
    assert_eq!(answer["number"], number);
    answer
}

#[test]
fn a_target_is_previewed_and_then_gone_to() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.send(json!({"type": "preview", "number": 1, "motion": {"kind": "ready"}, "speed": 0.1}));
    assert!(viewer.refusal().contains("take the lease"));
    viewer.take();
    let mut other = Viewer::connect(served.address);
    let start = served.robot.pose();
    let there = Pose::translation(0.05, 0.03, -0.04) * start;
    let answer = preview(&mut viewer, 7, &motion(&there));
    let way = &answer["way"];
    assert!(
        answer["refused"].is_null() && way["fastest"].as_f64() <= Some(0.21),
        "{way}"
    );
    assert!(
        (way["length"].as_f64().expect("a length") - 0.0707).abs() < 1e-3,
        "{way}"
    );
    let line = way["line"].as_array().expect("a line");
    let last = line.last().expect("points");
    let off = (0..3).map(|i| last[i].as_f64().expect("numbers") - there.translation.vector[i]);
    assert!(off.map(f64::abs).fold(0.0, f64::max) < 1e-3, "{last}");
    assert!(!served.robot.state().motion_running());
    let off = || (served.robot.pose().translation.vector - there.translation.vector).norm();
    viewer.hold_until(&motion(&there), || off() < 4e-3);
    // The other viewers see the plan too.
    while other.wait_for("heading")["way"].is_null() {}
    viewer.send(json!({"type": "end"}));
    served.wait_for_rest();
    while !other.wait_for("heading")["way"].is_null() {}
}

#[test]
fn targets_of_joints_reach_the_ends_that_the_driver_accepts() {
    let served = Served::movable();
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    let ends = target_range(served.robot.model().joint_limits());
    for (number, q1, end) in [(1, 9.0, ends[0].1), (2, -9.0, ends[0].0)] {
        let mut q = served.robot.state().q;
        q[0] = q1;
        let answer = preview(&mut viewer, number, &json!({"kind": "joints", "q": q}));
        let got = answer["way"]["q"][0].as_f64().expect("a way");
        assert!((got - end).abs() < 1e-6, "{got} and {end}");
    }
    for (end, bound) in [("target_lower", 0), ("target_upper", 1)] {
        let told: Vec<f64> = serde_json::from_value(viewer.hello[end].clone()).expect("numbers");
        let ends = ends.map(|(lower, upper)| [lower, upper][bound]);
        assert_eq!(told, ends);
    }
}

#[test]
fn forbidden_motion_is_refused_in_preview_and_on_request() {
    let height = 0.3;
    let served = Served::new(|running| {
        let options = Options::default().allow_motion().simulated(running);
        let block = Obstacle::Box {
            pose: Pose::translation(0.4, 0.0, 0.5 * height),
            half: Vector3::new(0.2, 0.2, 0.5 * height),
        };
        options.keep_out([Obstacle::floor(-1.0), block])
    });
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    let start = served.robot.pose();
    let down = Pose::translation(0.0, 0.0, height - start.translation.z) * start;
    let away = Pose::translation(1.0, 0.0, 0.0) * start;
    let turned = pose::rotated(&start, UnitQuaternion::from_euler_angles(3.1, 0.0, 0.0));
    for (target, why) in [
        (down, "keep-out region 2"),
        (away, "no joint positions"),
        (turned, "expected less than 170 degrees"),
    ] {
        let motion = motion(&target);
        let answer = preview(&mut viewer, 1, &motion);
        let refused = answer["refused"].as_str().expect("a refusal").to_owned();
        assert!(refused.contains(why) && answer["way"].is_null(), "{answer}");
        viewer.send(json!({"type": "begin", "motion": motion, "speed": 0.2}));
        let told = loop {
            let event = viewer.wait_for("event");
            if event["level"] == "error" {
                break event["text"].as_str().expect("a text").to_owned();
            }
        };
        assert_eq!(told, format!("Not moved: {refused}"));
        served.wait_for_rest();
    }
    assert!((served.robot.pose().translation.vector - start.translation.vector).norm() < 1e-3);
}
