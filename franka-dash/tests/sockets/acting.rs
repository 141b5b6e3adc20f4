//! Gains, speed, gripper and recordings over a socket.

use std::cell::Cell;
use std::path::PathBuf;

use franka_async::nalgebra::Vector3;
use franka_async::recording::Recording;
use franka_sim::Touch;
use serde_json::{Value, json};

use crate::viewer::{Served, Viewer};

/// A folder that is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let name = format!("franka-dash-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir(&path).expect("a new folder");
        Self(path)
    }

    fn files(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(&self.0).expect("it is there");
        entries.map(|entry| entry.expect("one").path()).collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Remaining files are harmless.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn act(viewer: &mut Viewer, action: Value) {
    viewer.send(json!({"type": "gripper", "action": action}));
}

fn disturb(viewer: &mut Viewer, disturbance: Value) {
    viewer.send(json!({"type": "disturb", "disturbance": disturbance}));
}

#[test]
fn the_gripper_homes_opens_holds_an_object_and_loses_it() {
    let folder = Folder::new("holds");
    let served = Served::equipped(&folder.0);
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    act(&mut viewer, json!({"kind": "home"}));
    viewer.event("Gripper: homed: the greatest width is known");
    act(
        &mut viewer,
        json!({"kind": "move", "width": 0.05, "speed": 0.1}),
    );
    viewer.event("Gripper: reached the width");
    let open = viewer.wait_for("gripper");
    assert_eq!(open["max_width"], 0.08);
    let width = open["width"].as_f64().expect("a number");
    assert!((width - 0.05).abs() < 1e-3, "{width}");
    disturb(&mut viewer, json!({"kind": "object", "width": 0.06}));
    viewer.event("does not fit");
    disturb(&mut viewer, json!({"kind": "object", "width": 0.03}));
    viewer.wait_for_status(|status| status["simulation"]["object"] == 0.03);
    let grasp =
        json!({"kind": "grasp", "width": 0.03, "tolerance": 0.005, "speed": 0.1, "force": 40});
    act(&mut viewer, grasp);
    viewer.event("Gripper: holds the object");
    viewer.wait_until("gripper", |it| it["is_grasped"] == true);
    // A stop ends motions only: the object stays held.
    viewer.send(json!({"type": "stop"}));
    viewer.event("Stopped by a viewer");
    let held = viewer.wait_for("gripper");
    assert_eq!(held["is_grasped"], true);
    disturb(&mut viewer, json!({"kind": "object", "width": null}));
    viewer.wait_until("gripper", |it| it["is_grasped"] == false);
    act(&mut viewer, json!({"kind": "stop"}));
    viewer.event("Gripper: released");
}

/// Ends the action of the first viewer's fingers; the second viewer is another one.
type Way = dyn Fn(&mut Viewer, &mut Viewer);

#[test]
fn fingers_stop_by_a_stop_of_any_viewer_and_with_the_lease() {
    let folder = Folder::new("stops");
    let served = Served::equipped(&folder.0);
    let mut viewer = Viewer::connect(served.address);
    let mut other = Viewer::connect(served.address);
    act(&mut other, json!({"kind": "home"}));
    assert!(other.refusal().contains("take the lease"));
    let ways: [&Way; 3] = [
        &|_, other| other.send(json!({"type": "stop"})),
        &|viewer, _| viewer.send(json!({"type": "stop"})),
        &|viewer, _| viewer.send(json!({"type": "release"})),
    ];
    for end in ways {
        viewer.take();
        act(&mut viewer, json!({"kind": "home"}));
        let before = viewer.wait_until("gripper", |it| it["acting"] == true);
        viewer.wait_until("gripper", |it| it["width"] != before["width"]);
        end(&mut viewer, &mut other);
        viewer.event("Gripper: stopped");
        // The command was sent to the Hand; its states show when it is at rest.
        let (mut last, mut now) = (Value::Null, viewer.wait_for("gripper"));
        while now != last {
            (last, now) = (now, viewer.wait_for("gripper"));
        }
        // It has not determined its largest opening.
        assert_eq!(
            (&now["acting"], &now["max_width"]),
            (&json!(false), &json!(0.0))
        );
    }
}

/// Distance by which the end effector has been pushed up, `[m]`, once it is at rest.
fn pushed<'a>(served: &'a Served, from: f64) -> impl Fn() -> bool + 'a {
    let last = Cell::new((0, 0.0));
    move || {
        let (time, height) = last.get();
        let (now, risen) = (served.robot.state().message_id, served.height() - from);
        if now < time + 100 {
            return false;
        }
        last.set((now, risen));
        time > 0 && risen > 1e-3 && (risen - height).abs() < 1e-4
    }
}

#[test]
fn gains_change_how_far_a_push_gets_while_the_arm_is_held() {
    let folder = Folder::new("gains");
    let served = Served::equipped(&folder.0);
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    let tune = |viewer: &mut Viewer, factor: f64| {
        let tuning = json!({"end_effector": factor, "joints": factor.min(1.0), "damping": 1,
            "force_cap": 60, "compensation": false});
        viewer.send(json!({"type": "tune", "tuning": tuning}));
        viewer.wait_for_status(|it| it["tuning"]["end_effector"] == factor);
    };
    tune(&mut viewer, 4.0);
    let start = served.height();
    served.with(|robot| robot.touch(Touch::force(Vector3::new(0.0, 0.0, 15.0))));
    let next = viewer.hold_until(&json!({"kind": "stay"}), pushed(&served, start));
    let stiff = served.height() - start;
    // In the same hold.
    viewer.send(
        json!({"type": "tune", "tuning": {"end_effector": 0.5, "joints": 0.5, "damping": 1,
        "force_cap": 60, "compensation": false}}),
    );
    let further = pushed(&served, start);
    let soft = || further() && served.height() - start > 3.0 * stiff;
    viewer.go_on_until(next, soft).expect("it goes on");
    viewer.send(json!({"type": "end"}));
    served.with(|robot| robot.let_go());
    served.wait_for_rest();
    // The next commander starts with the driver's gains.
    viewer.send(json!({"type": "release"}));
    viewer.wait_for_status(|it| it["tuning"]["end_effector"] == 1.0);
}

#[test]
fn the_speed_of_a_hold_changes_while_it_goes_on() {
    let folder = Folder::new("speed");
    let served = Served::equipped(&folder.0);
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    // The mean velocity over 300 ms of robot time, m/s.
    let fast = |least: f64, most: f64| {
        let (last, served) = (Cell::new((0, 0.0)), &served);
        move || {
            let (time, height) = last.get();
            let (now, here) = (served.robot.state().message_id, served.height());
            if now < time + 300 {
                return false;
            }
            last.set((now, here));
            let speed = (here - height) / (now - time) as f64 * 1e3;
            time > 0 && (least..most).contains(&speed)
        }
    };
    let up = json!({"kind": "translate", "direction": [0, 0, 1], "axes": "base"});
    viewer.send(json!({"type": "speed", "speed": 0.02}));
    assert!(viewer.refusal().contains("the motion has already ended"));
    let next = viewer.hold_until(&up, fast(0.08, 0.12));
    viewer.send(json!({"type": "speed", "speed": 0.02}));
    let next = viewer.go_on_until(next, fast(0.015, 0.025));
    viewer.send(json!({"type": "speed", "speed": 0.1}));
    let next = viewer.go_on_until(next.expect("it goes on"), fast(0.08, 0.12));
    assert!(next.is_some());
    viewer.send(json!({"type": "end"}));
    served.wait_for_rest();
}

#[test]
fn a_recording_is_made_in_the_folder_of_the_server() {
    let folder = Folder::new("records");
    let served = Served::equipped(&folder.0);
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    assert_eq!(viewer.wait_for("recording")["recording"], Value::Null);
    // The second request has no effect.
    viewer.send(json!({"type": "record", "on": true}));
    viewer.send(json!({"type": "record", "on": true}));
    let under_way = viewer.wait_until("recording", |it| {
        it["recording"]["cycles"].as_u64().is_some_and(|n| n > 500)
    });
    viewer.send(json!({"type": "record", "on": false}));
    viewer.event("Recorded");
    viewer.wait_until("recording", |it| it["recording"] == Value::Null);
    let files = folder.files();
    let [file] = &files[..] else {
        panic!("one file, not {files:?}");
    };
    let name = file.file_name().and_then(|name| name.to_str());
    assert_eq!(name, under_way["recording"]["file"].as_str());
    let recording = Recording::open(file).expect("a recording");
    assert_eq!(recording.damage(), None);
    let robot = recording.robot("").expect("the only one");
    assert!(robot.cycles().count() > 500 && robot.gripper_states().count() > 0);
}

#[test]
fn recording_is_complete_when_the_connection_has_ended() {
    let folder = Folder::new("ended");
    let served = Served::equipped(&folder.0);
    let mut viewer = Viewer::connect(served.address);
    viewer.take();
    viewer.send(json!({"type": "record", "on": true}));
    viewer.wait_until("recording", |it| {
        it["recording"]["cycles"].as_u64().is_some_and(|n| n > 500)
    });
    served.shut_down();
    let recording = Recording::open(&folder.files()[0]).expect("a recording");
    assert_eq!(recording.damage(), None);
}
