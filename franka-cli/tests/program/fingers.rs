//! The Franka Hand.

use nix::sys::signal::Signal;

use crate::program::{Home, until};
use crate::simulated::Simulated;

#[test]
fn the_hand_opens_grasps_and_lets_go() {
    Simulated::each(|sim| {
        let (home, hand) = (Home::new(), sim.hand());
        let run = |rest: &[&str]| {
            let arguments = [&["gripper"], rest, &[&hand, "--yes", "--json"]].concat();
            home.run(&arguments)
        };
        run(&["open"]).failed(1, &["franka gripper home"]);
        run(&["home"]).done();
        let open = run(&["open", "--width", "0.06"]).json();
        assert!(
            (open["width"].as_f64().expect("metres") - 0.06).abs() < 2e-3,
            "{open}"
        );
        run(&["grasp", "--width", "0.06"]).failed(1, &["the fingers hold no object of 60.0 mm"]);
        run(&["open"]).done();
        let held = run(&["grasp", "--width", "0.03", "--force", "40"]).json();
        assert_eq!(held["is_grasped"], true, "{held}");
        let text = home.run(&["gripper", "state", &hand]).done();
        assert!(text.contains("holding an object"), "{text}");
        run(&["stop"]).done();
        let state = home.run(&["gripper", "state", &hand, "--json"]).json();
        assert_eq!(state["is_grasped"], false, "{state}");
        run(&["open"]).done();
        // The object blocks the fingers.
        run(&["close"]).failed(1, &["did not close"]);
    });
}

#[test]
fn ctrl_c_stops_the_fingers() {
    Simulated::each(|sim| {
        let home = Home::new();
        let hand = sim.hand();
        let width = || {
            let state = home.run(&["gripper", "state", &hand, "--json"]).json();
            state["width"].as_f64().expect("metres")
        };
        home.run(&["gripper", "home", &hand, "--yes"]).done();
        home.run(&["gripper", "open", &hand, "--yes", "--width", "0.08"])
            .done();
        let slow = ["gripper", "close", &hand, "--yes", "--speed", "0.002"];
        let mut program = home.start(&slow);
        until("a motion", || sim.fingers_width() < 0.0798);
        program.signal(Signal::SIGINT);
        program.ended().failed(130, &["the fingers were stopped"]);
        let stopped = width();
        assert!(stopped > 0.04, "{stopped}");
        assert!((width() - stopped).abs() < 1e-4);
    });
}

#[test]
fn a_hand_that_goes_away_is_told_with_code_3() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let hand = sim.hand();
    home.run(&["gripper", "home", &hand, "--yes"]).done();
    let slow = ["gripper", "close", &hand, "--yes", "--speed", "0.002"];
    let program = home.start(&slow);
    until("a motion", || sim.fingers_width() < 0.0798);
    sim.end();
    program.ended().failed(3, &["errors.md#"]);
}

#[test]
fn a_hand_that_is_not_there_is_named_by_its_own_address() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let (robot, nowhere) = (sim.address(), "127.0.0.1:1");
    home.run(&["robots", "add", "left", &robot, "--hand", nowhere])
        .done();
    home.run(&["gripper", "state"])
        .failed(3, &["no Hand at left (127.0.0.1:1)"]);
}
