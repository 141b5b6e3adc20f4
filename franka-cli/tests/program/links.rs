//! No robot, one that is taken, one that goes away.

use std::net::TcpListener;

use franka_async::state::RobotMode;
use franka_async::{Realtime, Robot};
use nix::sys::signal::Signal;

use crate::program::Home;
use crate::simulated::Simulated;

#[test]
fn no_robot_is_told_with_code_3() {
    let home = Home::new();
    let free = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = free.local_addr().expect("bound").to_string();
    drop(free);
    let refused = ["the connection was refused", "FCI"];
    for arguments in [
        &["state", &address][..],
        &["read", &address, "q"],
        &["move", &address, "--ready", "--yes", "--realtime", "ignore"],
        &["recover", &address],
        &["record", "x.mcap", &address],
        &["gripper", "open", &address, "--yes"],
    ] {
        home.run(arguments).failed(3, &refused);
    }
    assert!(!home.path("x.mcap").exists());
    let silent = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = silent.local_addr().expect("bound").to_string();
    home.run(&["state", &address]).failed(3, &["answers at"]);
    home.run(&["state", "nobody"]).failed(3, &["`nobody`"]);
}

#[test]
fn a_robot_that_is_taken_is_told_with_code_4() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let runtime = tokio::runtime::Runtime::new().expect("a runtime");
        let builder = Robot::builder(robot.as_str()).realtime(Realtime::Ignore);
        let first = runtime.block_on(builder.connect()).expect("connected");
        let texts = ["somebody else is connected", "one client at a time"];
        home.run(&["state", &robot]).failed(4, &texts);
        let ready = ["move", &robot, "--ready", "--yes", "--realtime", "ignore"];
        home.run(&ready).failed(4, &texts);
        home.run(&["stop", &robot]).failed(4, &texts);
        runtime.block_on(first.shutdown());
    });
}

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
    }
    watching.signal(Signal::SIGINT);
    watching.ended().done();
}

/// The next line of its output.
fn read_line(program: &mut crate::program::Started) -> String {
    use std::io::Read;
    let mut line = Vec::new();
    let out = program.child().stdout.as_mut().expect("piped");
    let mut byte = [0];
    // Byte by byte: nothing of what comes later is taken.
    while byte[0] != b'\n' {
        out.read_exact(&mut byte).expect("a line");
        line.push(byte[0]);
    }
    String::from_utf8(line).expect("text")
}
