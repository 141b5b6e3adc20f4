//! Tests of connections, benchmarks, and the simulator as a command. No test judges a measured
//! value.

#[path = "../../../franka-doctor/tests/trace/harm.rs"]
mod harm;

use std::ffi::OsStr;
use std::io::{Read as _, Write as _};
use std::net::TcpListener;

use franka_async::{Realtime, Robot};
use franka_sim::Sim;
use nix::sys::signal::Signal;
use serde_json::Value;

use crate::program::Home;
use crate::simulated::Simulated;

#[test]
fn a_connection_is_tested_or_two() {
    let (home, one) = (Home::new(), Simulated::fast(Sim::fr3()));
    let other = Simulated::fast(Sim::fer());
    let (robot, two) = (one.address(), other.address());
    let test = [
        "test",
        "communication",
        &robot,
        "--realtime",
        "ignore",
        "--seconds",
        "0.5",
    ];
    home.run(&test).failed(5, &["keeps its position"]);
    let ran = home.run(&[&test[..], &["--yes"]].concat());
    assert!(
        ran.out.contains("verdict") && ran.out.contains("turnaround"),
        "{ran:?}"
    );
    let ran = home.run(&[&test[..], &["--yes", "--json", "--two", &two]].concat());
    let json: Value = serde_json::from_str(&ran.out).unwrap_or_else(|_| panic!("{ran:?}"));
    let robots = json["robots"].as_array().expect("robots");
    assert_eq!(robots.len(), 2, "{json}");
    // On a busy machine, the commands of both are late.
    let rates = robots.iter().map(|it| it["success_rate"]["avg"].as_f64());
    let worst = rates.map(|rate| rate.expect("a rate")).fold(1.0, f64::min);
    let expected = match worst {
        0.95.. => ("good", 0),
        0.9.. => ("usable", 0),
        _ => ("not usable", 1),
    };
    let verdict = json["verdict"].as_str().expect("a verdict");
    assert_eq!(
        (verdict, ran.code),
        (expected.0, Some(expected.1)),
        "{json}"
    );
}

#[test]
fn ctrl_c_ends_the_test_of_two_arms() {
    let home = Home::new();
    let (one, other) = (Simulated::fr3(), Simulated::fer());
    let (robot, two) = (one.address(), other.address());
    let test = [
        "test",
        "communication",
        &robot,
        "--realtime",
        "ignore",
        "--yes",
        "--two",
        &two,
    ];
    let mut program = home.start(&test);
    let is_moving = |sim: &Simulated| sim.state().motion_running();
    crate::program::until("both", || is_moving(&one) && is_moving(&other));
    program.signal(Signal::SIGINT);
    program.ended().failed(130, &["braked"]);
    for sim in [one, other] {
        sim.rests(franka_async::state::RobotMode::Idle);
    }
}

#[test]
fn this_computer_is_measured() {
    let home = Home::new();
    let wake = home
        .run(&["bench", "wake", "--seconds", "0.1", "--json"])
        .json();
    assert_eq!(wake["wakes"], 100, "{wake}");
    let text = home.run(&["bench", "loop", "--seconds", "0.2"]).done();
    assert!(text.contains("turnaround"), "{text}");
}

#[test]
fn this_computer_and_the_way_to_a_robot_are_checked() {
    let home = Home::new();
    let text = home.run(&["doctor", "--for", "sim"]).done();
    assert!(
        text.contains("for simulating") && !text.contains('\x1b'),
        "{text}"
    );
    let script = home.run(&["doctor", "--for", "sim", "--fix"]).done();
    assert!(script.starts_with("#!/bin/sh"), "{script}");
    Simulated::each(|sim| {
        let robot = sim.address();
        let ran = home.run(&["doctor", &robot, "--for", "read", "--quick", "--json"]);
        // The test does not judge the suitability of this computer.
        assert!(matches!(ran.code, Some(0 | 1)), "{ran:?}");
        assert_eq!(ran.err, "", "{ran:?}");
        let json: serde_json::Value = serde_json::from_str(&ran.out).expect("JSON");
        let findings = json["findings"].as_array().expect("findings");
        let ids = findings.iter().filter_map(|finding| finding["id"].as_str());
        let ids: Vec<&str> = ids.collect();
        assert!(ids.len() > 10, "{ids:?}");
        for id in ["robot.lost", "timing.dry_run"] {
            assert!(ids.contains(&id), "{ids:?}");
        }
        let good = [
            "robot.version",
            "robot.busy",
            "robot.mode",
            "robot.errors",
            "robot.load",
            "net.firewall",
        ];
        for id in good {
            assert_eq!(verdict(&json, id), "good", "{id}");
        }
    });
    let ran = home.run(&["doctor", "127.0.0.1:1", "--for", "read", "--quick"]);
    assert!(ran.err.contains("not checked"), "{ran:?}");
    assert!(
        ran.out
            .contains("robot.version, robot.busy: unknown: no connection"),
        "{ran:?}"
    );
}

/// This includes the dry run of the control loop, and a connected robot.
#[test]
fn a_doctor_changes_nothing_on_this_computer() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let robot = sim.address();
    let doctor = ["doctor", &robot, "--for", "move", "--quick", "--json"];
    let program = OsStr::new(env!("CARGO_BIN_EXE_franka"));
    let variable = ("XDG_CONFIG_HOME", home.as_ref().as_os_str());
    let traced = harm::traced(&home.path("calls"), program, &doctor, variable);
    let Some((output, calls)) = traced else {
        return;
    };
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let (_, port) = robot.split_once(':').expect("a port");
    assert!(calls.contains(&format!("htons({port})")), "{calls}");
    let found = harm::harmful(&calls);
    assert!(found.is_empty(), "{found:#?}");
}

/// Returns the verdict on this check in a JSON report.
fn verdict<'a>(report: &'a serde_json::Value, id: &str) -> &'a str {
    let findings = report["findings"].as_array().expect("findings");
    let found = findings.iter().find(|finding| finding["id"] == id);
    let found = found.unwrap_or_else(|| panic!("no {id}"));
    found["verdict"].as_str().expect("a text")
}

#[test]
fn desk_status_is_the_reason_for_a_refusal() {
    let home = Home::new();
    let desk = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = desk.local_addr().expect("bound").to_string();
    // Serves all clients until the process ends: a Desk whose system is starting.
    std::thread::spawn(move || {
        for client in desk.incoming() {
            let mut client = client.expect("a client");
            // Not TLS: the client then uses plain HTTP.
            let mut request = [0; 512];
            let length = client.read(&mut request).expect("a request");
            let json = match &request[..length] {
                [b'G', ..] if request.starts_with(b"GET /api/system ") => {
                    r#"{"status": "Starting", "operatingMode": {"status": "Execution"}}"#
                }
                _ => "{}",
            };
            let head = "HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length:";
            let answer = format!("{head} {}\r\n\r\n{json}", json.len());
            // A client that expects TLS disconnects.
            let _ = client.write_all(answer.as_bytes());
        }
    });
    let doctor = ["doctor", "127.0.0.1:1", "--for", "read", "--quick"];
    let only = ["--only", "robot", "--desk", &address];
    let ran = home.run(&[&doctor[..], &only].concat());
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let expected = "robot.web: the system is not started: Starting";
    assert!(ran.out.contains(expected), "{ran:?}");
    assert!(!ran.out.contains("kernel.rt"), "{ran:?}");
    let none = ["doctor", "--only", "nothing", "--skip", "nic"];
    home.run(&none).failed(2, &["none of the chosen checks"]);
}

#[test]
fn a_robot_that_is_taken_or_too_old_is_reported() {
    let home = Home::new();
    Simulated::each(|sim| {
        let robot = sim.address();
        let runtime = tokio::runtime::Runtime::new().expect("a runtime");
        let builder = Robot::builder(robot.as_str()).realtime(Realtime::Ignore);
        let first = runtime.block_on(builder.connect()).expect("connected");
        let ran = home.run(&["doctor", &robot, "--for", "read", "--quick", "--json"]);
        assert!(ran.err.contains("another client"), "{ran:?}");
        let json: serde_json::Value = serde_json::from_str(&ran.out).expect("JSON");
        assert_eq!(verdict(&json, "robot.busy"), "warning");
        assert_eq!(verdict(&json, "robot.version"), "unknown");
        runtime.block_on(first.shutdown());
    });
    let old = TcpListener::bind("127.0.0.1:0").expect("a port");
    let robot = old.local_addr().expect("bound").to_string();
    // Serves all clients until the process ends.
    std::thread::spawn(move || {
        for client in old.incoming() {
            let mut client = client.expect("a client");
            let mut handshake = [0; 16];
            client.read_exact(&mut handshake).expect("a handshake");
            // The answer to the first request, 15 bytes in total: incompatible, version 7.
            let refusal = [0, 0, 0, 0, 0, 0, 0, 0, 15, 0, 0, 0, 1, 7, 0];
            client.write_all(&refusal).expect("sent");
        }
    });
    let ran = home.run(&["doctor", &robot, "--for", "read", "--quick"]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let advice = "update the robot's system to 5.9.0 or later (Desk, Settings, System)";
    assert!(ran.out.contains(advice), "{ran:?}");
}

#[test]
fn the_simulator_is_a_robot_until_ctrl_c() {
    let home = Home::new();
    for robot in ["fr3", "fer"] {
        let mut sim = home.start(&["sim", "--robot", robot, "--port", "0"]);
        let address = {
            use std::io::{BufRead, BufReader};
            let out = sim.child().stdout.as_mut().expect("piped");
            let mut line = String::new();
            BufReader::new(out).read_line(&mut line).expect("a line");
            line.trim()
                .rsplit(' ')
                .next()
                .expect("an address")
                .to_owned()
        };
        let state = home.run(&["state", &address, "--json"]).json();
        let kind = state["kind"].as_str().expect("a kind").to_lowercase();
        assert!(kind.starts_with(robot), "{kind}");
        sim.signal(Signal::SIGINT);
        sim.ended().done();
    }
    home.run(&["sim", "--scene", "x.xml", "--port", "0"])
        .failed(6, &["--plant mujoco"]);
}
