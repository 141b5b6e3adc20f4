//! A robot that accepts no motion, and a robot that disconnects.

use franka_async::state::RobotMode;
use nix::sys::signal::Signal;

use crate::program::Home;
use crate::simulated::Simulated;

#[test]
fn a_robot_that_somebody_guides_is_not_moved() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    assert!(sim.with(|robot| robot.guide(true)));
    let robot = sim.address();
    let ready = ["move", &robot, "--ready", "--yes", "--realtime", "ignore"];
    home.run(&ready).failed(4, &["guided by hand"]);
    sim.rests(RobotMode::Guiding);
}

#[test]
fn a_robot_that_needs_a_person_is_told_with_code_7() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let ready = ["move", &robot, "--ready", "--yes", "--realtime", "ignore"];
        sim.with(|robot| robot.press_user_stop(true));
        sim.rests(RobotMode::UserStopped);
        home.run(&ready).failed(7, &["user stop"]);
        home.run(&["recover", &robot, "--yes"])
            .failed(7, &["user stop"]);
        sim.with(|robot| robot.press_user_stop(false));
        sim.with(|robot| robot.close_brakes());
        sim.rests(RobotMode::Other);
        home.run(&["collision", "careful", &robot])
            .failed(7, &["brakes"]);
    });
}

#[test]
fn a_robot_that_goes_away_ends_the_watching_with_code_3() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let mut watching = home.start(&["state", &sim.address(), "--watch", "--json"]);
    read_line(&mut watching);
    sim.end();
    watching.ended().failed(3, &["is lost"]);
}

#[test]
fn ctrl_c_ends_the_watching_with_code_0() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let mut watching = home.start(&["state", &sim.address(), "--watch", "--json"]);
    for _ in 0..3 {
        let line = read_line(&mut watching);
        let json: serde_json::Value = serde_json::from_str(&line).expect("JSON");
        assert_eq!(json["state"]["robot_mode"], "Idle");
        assert_eq!(json["schema"], 1);
    }
    watching.signal(Signal::SIGINT);
    watching.ended().done();
}

/// Returns the next line of the program's output.
fn read_line(program: &mut crate::program::Started) -> String {
    use std::io::Read;
    let mut line = Vec::new();
    let out = program.child().stdout.as_mut().expect("piped");
    let mut byte = [0];
    // Byte by byte, so that later output is not consumed.
    while byte[0] != b'\n' {
        out.read_exact(&mut byte).expect("a line");
        line.push(byte[0]);
    }
    String::from_utf8(line).expect("text")
}
