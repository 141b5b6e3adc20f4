//! Recordings and cassettes.

use franka_sim::Sim;
use nix::sys::signal::Signal;

use crate::program::{Home, until};
use crate::simulated::Simulated;

#[test]
fn a_motion_is_recorded_exported_and_replayed() {
    for sim in [Sim::fr3(), Sim::fer()] {
        let (home, sim) = (Home::new(), Simulated::fast(sim));
        let robot = sim.address();
        let moving = ["--realtime", "ignore", "--yes"];
        let record = ["move", &robot, "--by", "0,0.1,0", "--record", "run.mcap"];
        let ran = home.run(&[&record[..], &moving].concat());
        assert!(ran.err.contains("recorded"), "{ran:?}");
        ran.done();
        home.run(&[&record[..], &moving].concat())
            .failed(6, &["run.mcap exists"]);
        let text = home.run(&["explain", "run.mcap"]).done();
        assert!(!text.is_empty());
        let export = [
            "export",
            "run.mcap",
            "--csv",
            "run.csv",
            "--columns",
            "q,dq",
        ];
        let rows = home.run(&[&export[..], &["--json"]].concat()).json()["rows"].as_u64();
        let table = std::fs::read_to_string(home.path("run.csv")).expect("a table");
        assert_eq!(rows, Some(table.lines().count() as u64 - 2), "{rows:?}");
        assert!(
            table.lines().nth(1).expect("names").contains("q[6],dq[0]"),
            "{table}"
        );
        home.run(&export).failed(6, &["run.csv"]);
        home.run(&["export", "run.mcap", "--parquet", "run.parquet"])
            .done();
        assert!(home.path("run.parquet").exists());
        home.run(&["export", "run.mcap", "--lerobot", "data"])
            .failed(1, &["no episodes"]);
        let bad = [
            "export",
            "run.mcap",
            "--csv",
            "x.csv",
            "--columns",
            "nothing",
        ];
        home.run(&bad).failed(2, &["nothing"]);
        let replay = ["replay", "run.mcap", &robot, "--speed", "0.5"];
        home.run(&replay[..3]).failed(6, &["realtime"]);
        let ran = home.run(&[&replay[..], &["--realtime", "ignore"]].concat());
        ran.failed(
            5,
            &["First to where the recording begins", "Then as recorded"],
        );
        let json = home
            .run(&[&replay[..], &moving, &["--json"]].concat())
            .json();
        assert!(
            json["position"]["max"].as_f64().expect("metres") < 0.05,
            "{json}"
        );
    }
}

#[test]
fn states_are_recorded_until_ctrl_c() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let robot = sim.address();
    let live = ["--live", "127.0.0.1:0"];
    let record = ["record", "a.mcap", &robot, "--seconds", "0.3", "--json"];
    let ran = home.run(&[&record[..], &live].concat());
    assert!(
        ran.err.contains("Foxglove can watch at ws://127.0.0.1:"),
        "{ran:?}"
    );
    let json = ran.json();
    assert!(json["cycles"].as_u64() > Some(0), "{json}");
    let mut program = home.start(&["record", "b.mcap", &robot, "--black-box", "box"]);
    until("a file", || home.path("b.mcap").exists());
    program.signal(Signal::SIGINT);
    let text = program.ended().done();
    assert!(text.contains("b.mcap"), "{text}");
    home.run(&["explain", "nothing.mcap"])
        .failed(6, &["nothing.mcap"]);
}

#[test]
fn a_session_is_tapped_played_and_converted() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let robot = sim.address();
    let mut tap = home.start(&["tap", "tape.mcap", &robot, "--port", "0"]);
    let at = address(&mut tap);
    home.run(&["collision", "compliant", &at]).done();
    tap.signal(Signal::SIGINT);
    let text = tap.ended().done();
    assert!(
        text.contains("1 connections") && text.contains("0 dropped"),
        "{text}"
    );
    let info = home
        .run(&["cassette", "info", "tape.mcap", "--json"])
        .json();
    assert!(
        info["connections"][0]["datagrams"].as_u64() > Some(0),
        "{info}"
    );
    let mut play = home.start(&[
        "cassette",
        "play",
        "tape.mcap",
        "--port",
        "0",
        "--patience",
        "60",
    ]);
    let at = address(&mut play);
    home.run(&["collision", "compliant", &at]).done();
    play.ended().done();
    home.run(&["cassette", "convert", "tape.mcap", "tape.pcap"])
        .done();
    home.run(&["cassette", "convert", "tape.pcap", "again.mcap"])
        .done();
    let again = home
        .run(&["cassette", "info", "again.mcap", "--json"])
        .json();
    assert_eq!(
        again["connections"][0]["datagrams"],
        info["connections"][0]["datagrams"]
    );
    home.run(&["cassette", "info", "tape.pcap"])
        .failed(6, &["tape.pcap"]);
}

/// The address of the robot, from the first line on standard error.
fn address(program: &mut crate::program::Started) -> String {
    use std::io::Read;
    let (mut line, mut byte) = (Vec::new(), [0]);
    let err = program.child().stderr.as_mut().expect("piped");
    while byte[0] != b'\n' {
        err.read_exact(&mut byte).expect("a line");
        line.push(byte[0]);
    }
    let line = String::from_utf8(line).expect("text");
    let (_, rest) = line.split_once(" at ").expect("an address");
    rest.trim()
        .split(',')
        .next()
        .expect("an address")
        .to_owned()
}
