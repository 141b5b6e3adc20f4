//! Recordings and cassettes.

use std::net::TcpListener;

use franka_async::gripper::Gripper;
use franka_async::recording::{RecordOptions, Recorder, Track};
use franka_async::state::RobotError;
use franka_async::{Offset, Pose, Realtime, Robot};
use nix::sys::signal::Signal;

use crate::program::{Home, robot_address, until};
use crate::simulated::Simulated;

#[test]
fn a_motion_is_recorded_exported_and_replayed() {
    Simulated::each_kind(|kind, patient| {
        let (home, sim) = (Home::new(), Simulated::fast(kind));
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
        let recorded = std::fs::read(home.path("run.mcap")).expect("a recording");
        for onto in ["run.mcap", "run.parquet", "run.csv"] {
            for format in ["--parquet", "--csv"] {
                let export = ["export", "run.mcap", format, onto];
                home.run(&export)
                    .failed(6, &[onto, "never replaces a file"]);
            }
        }
        let figure = ["explain", "run.mcap", "--figure", "run.mcap"];
        home.run(&figure)
            .failed(6, &["run.mcap exists", "never replaces a file"]);
        assert!(std::fs::read(home.path("run.mcap")).expect("it is there") == recorded);
        home.run(&["export", "run.mcap", "--lerobot", "data"])
            .failed(1, &["no finished episode"]);
        let bad = [
            "export",
            "run.mcap",
            "--csv",
            "x.csv",
            "--columns",
            "nothing",
        ];
        home.run(&bad).failed(2, &["nothing"]);
        // Targets arrive by the wall clock.
        let robot = patient.address();
        let replay = ["replay", "run.mcap", &robot, "--speed", "0.8"];
        let ran = home.run(&replay[..3]);
        // On a host with real-time rights, the question is asked.
        if ran.code != Some(5) {
            ran.failed(6, &["realtime"]);
        }
        let ran = home.run(&[&replay[..], &["--realtime", "ignore"]].concat());
        ran.failed(
            5,
            &[
                "First, the motion to the start of the recording",
                "Then the recorded motion",
            ],
        );
        let json = home
            .run(&[&replay[..], &moving, &["--json"]].concat())
            .json();
        assert!(
            json["position"]["max"].as_f64().expect("metres") < 0.05,
            "{json}"
        );
    });
}

#[test]
fn an_earlier_end_of_a_motion_is_explained() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let (robot, recorder) = runtime.block_on(async {
        let builder = Robot::builder(sim.address()).realtime(Realtime::Ignore);
        let robot = builder.connect().await.expect("connected");
        let recorder = Recorder::to_file(home.path("run.mcap"), RecordOptions::default());
        let recorder = recorder.expect("a file");
        let attached = recorder.attach(&robot, Track::default()).await;
        attached.expect("attached");
        (robot, recorder)
    });
    for error in [RobotError::JointReflex, RobotError::CartesianReflex] {
        let away = Offset::base(Pose::translation(0.0, 0.2, 0.0));
        let motion = robot.move_to(away).speed(0.1);
        let motion = runtime.spawn(async move { motion.await });
        sim.moves();
        sim.with(move |robot| robot.trip(error));
        let ended = runtime.block_on(motion).expect("no panic");
        assert!(ended.is_err_and(|error| error.control().is_some()));
        runtime.block_on(robot.recover()).expect("recovered");
    }
    recorder.finish().expect("recorded");
    runtime.block_on(robot.shutdown());
    let explain = ["explain", "run.mcap"];
    let text = home.run(&explain).done();
    assert!(text.contains("Why the robot stopped"), "{text}");
    assert!(text.contains("one motion ended earlier"), "{text}");
    let ends = |earlier| {
        let earlier = ["--json", "--earlier", earlier];
        let json = home.run(&[&explain[..], &earlier].concat()).json();
        (
            json["end"].as_u64().expect("a time"),
            json["cause"]["errors"].to_string(),
        )
    };
    let (newest, first) = (ends("0"), ends("1"));
    assert!(first.0 < newest.0, "{first:?}, {newest:?}");
    assert!(newest.1.contains("cartesian_reflex"), "{newest:?}");
    assert!(first.1.contains("joint_reflex"), "{first:?}");
    let none = [&explain[..], &["--earlier", "2"]].concat();
    home.run(&none)
        .failed(2, &["--earlier 2", "expected at most 1"]);
}

#[test]
fn a_file_of_another_program_is_refused_with_its_name() {
    let home = Home::new();
    std::fs::write(home.path("bag.mcap"), foreign_mcap()).expect("a file");
    for command in [
        &["explain", "bag.mcap"][..],
        &["export", "bag.mcap", "--csv", "bag.csv"],
        &["export", "bag.mcap", "--lerobot", "data"],
        &["replay", "bag.mcap", "127.0.0.1:1", "--yes"],
    ] {
        let said = ["bag.mcap: not a recording of this program", "libmcap 0.8.0"];
        home.run(command).failed(6, &said);
    }
    assert!(!home.path("bag.csv").exists() && !home.path("data").exists());
}

/// Returns an MCAP file with the minimum that every file has: the record that names its writer, and
/// an end.
fn foreign_mcap() -> Vec<u8> {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let record = |kind: u8, body: &[u8]| {
        let length = (body.len() as u64).to_le_bytes();
        [&[kind][..], &length, body].concat()
    };
    let magic = b"\x89MCAP0\r\n";
    let header = [text("ros2"), text("libmcap 0.8.0")].concat();
    let mut file = [&magic[..], &record(0x01, &header), &record(0x0f, &[0; 4])].concat();
    // The summary has one record, of statistics, all zero.
    let summary = (file.len() as u64).to_le_bytes();
    file.extend(record(0x0b, &[0; 46]));
    let footer = [&summary[..], &[0; 12]].concat();
    file.extend(record(0x02, &footer));
    file.extend(magic);
    file
}

/// Returns a table of libfranka 0.9.2 in which joint 4 jumps, and the text of its exception.
fn log_of_libfranka() -> String {
    let vectors = [
        ("state.q", 7),
        ("state.q_d", 7),
        ("state.dq", 7),
        ("state.dq_d", 7),
        ("state.tau_J", 7),
        ("state.tau_ext_hat_filtered", 7),
        ("cmd.q_d", 7),
        ("cmd.dq_d", 7),
        ("cmd.O_T_EE_d", 16),
        ("cmd.O_dP_EE_d", 6),
        ("cmd.tau_J_d", 7),
    ];
    let names = vectors.map(|(name, size)| {
        let names = (0..size).map(|i| format!("{name}[{i}]"));
        names.collect::<Vec<_>>().join(", ")
    });
    let mut text = format!(
        "libfranka: Move command aborted: motion aborted by reflex! \
         [\"joint_motion_generator_acceleration_discontinuity\"]\n\
         control_command_success_rate: 1\n\ntime, success_rate, {}\n",
        names.join(",")
    );
    for time in 1..=5 {
        let q = "0,-0.785,0,-2.356,0,1.571,0.785";
        let speed = if time == 5 {
            0.5
        } else {
            0.0001 * f64::from(time)
        };
        let rate = if time == 5 { "0" } else { "1" };
        let zeros = ["0"; 29].join(",");
        let still = ["0"; 21].join(",");
        let (idle, dq_d) = (["0"; 7].join(","), "0,0,0,0,0,0,0");
        text +=
            &format!("{time},{rate},{q},{q},{idle},{dq_d},{still},0,0,0,{speed},0,0,0,{zeros}\n");
    }
    text
}

#[test]
fn a_log_of_libfranka_is_explained_and_exported() {
    let home = Home::new();
    let log = log_of_libfranka();
    std::fs::write(home.path("reflex.txt"), &log).expect("a file");
    let explain = ["explain", "reflex.txt"];
    home.run(&explain).failed(2, &["--kind fr3 or --kind fer"]);
    let fer = [&explain[..], &["--kind", "fer"]].concat();
    let text = home.run(&fer).done();
    for part in ["Why the robot stopped", "joint 4", "commanded acceleration"] {
        assert!(text.contains(part), "{text}");
    }
    let figure = [&fer[..], &["--figure", "reflex.svg", "--json"]].concat();
    assert_eq!(home.run(&figure).json()["robot"], "Fer");
    assert!(home.path("reflex.svg").exists());
    let export = ["export", "reflex.txt", "--csv", "log.csv", "--json"];
    assert_eq!(home.run(&export).json()["rows"], 5);
    let export = ["export", "reflex.txt", "--lerobot", "data"];
    home.run(&export).failed(2, &["it has no episodes"]);
    // The text alone needs no kind of robot, and names none.
    let message = log.split("\n\n").next().expect("a text");
    std::fs::write(home.path("text.txt"), message).expect("a file");
    let text = home.run(&["explain", "text.txt"]).done();
    assert!(
        text.contains("the log has no cycle of the motion"),
        "{text}"
    );
    let json = home.run(&["explain", "text.txt", "--json"]).json();
    assert!(json.get("robot").is_none(), "{json}");
    home.run(&["export", "text.txt", "--csv", "x.csv"])
        .failed(2, &["expected a table"]);
    let cut = &log[..log.len() - 20];
    std::fs::write(home.path("cut.txt"), cut).expect("a file");
    home.run(&["explain", "cut.txt", "--kind", "fer"])
        .failed(6, &["cut.txt: line 9, column ", "the file ends too early"]);
}

#[test]
fn episodes_become_a_dataset() {
    Simulated::each_fast(|sim| {
        let home = Home::new();
        let runtime = tokio::runtime::Runtime::new().expect("a runtime");
        let file = home.path("run.mcap");
        let recorded = async {
            let builder = Robot::builder(sim.address()).realtime(Realtime::Ignore);
            let robot = builder.connect().await?;
            let gripper = Gripper::connect(sim.hand()).await?;
            let recorder = Recorder::to_file(&file, RecordOptions::default())?;
            recorder.attach(&robot, Track::default()).await?;
            recorder.attach_gripper(&gripper, "")?;
            // From the time when it has reported its address, because the robot's time is fast.
            gripper.homing().await?;
            for (name, way) in [("one", 0.03), ("two", -0.03)] {
                recorder.begin_episode(name, "move the hand")?;
                let away = Pose::translation(0.0, way, 0.0);
                robot.move_to(Offset::base(away)).await?;
                recorder.end_episode(Some(true));
            }
            tokio::task::spawn_blocking(|| recorder.finish()).await??;
            robot.shutdown().await;
            anyhow::Ok(())
        };
        runtime.block_on(recorded).expect("recorded");
        let export = ["export", "run.mcap", "--lerobot", "data", "--fps", "20"];
        // The arm is not under control before and after its motions: those frames are left out.
        let led = home.run(&[&export[..], &["--json"]].concat()).json();
        std::fs::remove_dir_all(home.path("data")).expect("deleted");
        let export = [&export[..], &["--measured"]].concat();
        let json = home.run(&[&export[..], &["--json"]].concat()).json();
        assert_eq!(json["episodes"], 2, "{json}");
        let frames = json["frames"].as_u64().expect("a count");
        assert!(frames > 10, "{json}");
        assert_eq!(led["episodes"], 2, "{led}");
        let led = led["frames"].as_u64().expect("a count");
        assert!((5..=frames).contains(&led), "{led} of {frames}");
        // They are added to the existing dataset.
        let text = home.run(&export).done();
        assert_eq!(text.trim(), format!("2 episodes, {frames} frames"));
        let info = std::fs::read_to_string(home.path("data/meta/info.json")).expect("a dataset");
        let info: serde_json::Value = serde_json::from_str(&info).expect("JSON");
        assert_eq!(info["total_episodes"], 4, "{info}");
        assert_eq!(info["total_frames"], 2 * frames, "{info}");
        let one = [
            "export",
            "run.mcap",
            "--lerobot",
            "one",
            "--episodes",
            "two",
            "--json",
        ];
        assert_eq!(home.run(&one).json()["episodes"], 1);
        let none = [
            "export",
            "run.mcap",
            "--lerobot",
            "none",
            "--episodes",
            "three",
        ];
        home.run(&none)
            .failed(2, &["\"three\"", "expected one of one, two"]);
        let other = [&export[..4], &["--measured", "--fps", "30"]].concat();
        home.run(&other).failed(1, &["fps"]);
    });
}

#[test]
fn states_are_recorded_until_ctrl_c() {
    Simulated::each(|sim| {
        let home = Home::new();
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
    });
}

#[test]
fn a_tap_tells_why_it_turns_clients_away_and_keeps_files() {
    let home = Home::new();
    let free = TcpListener::bind("127.0.0.1:0").expect("a port");
    let nowhere = free.local_addr().expect("bound").to_string();
    drop(free);
    let arguments = ["tap", "empty.mcap", &nowhere, "--port", "0"];
    let mut tap = home.start(&arguments);
    let at = address(&mut tap);
    home.run(&["state", &at])
        .failed(4, &["closed the connection"]);
    tap.signal(Signal::SIGINT);
    let ran = tap.ended();
    assert!(
        ran.err.contains(&format!("no robot at {nowhere}")),
        "{ran:?}"
    );
    ran.done();
    home.run(&arguments)
        .failed(6, &["empty.mcap", "File exists"]);
    let unknown = ["tap", "x.mcap", "no.such.host.invalid"];
    home.run(&unknown).failed(3, &["no.such.host.invalid"]);
    for command in [&["tap", "x.mcap", "y"][..], &["cassette", "play", "x.mcap"]] {
        let last = [command, &["--port", "65534"]].concat();
        home.run(&last).failed(2, &["0..=65533"]);
    }
    let convert = ["cassette", "convert", "empty.mcap", "empty.mcap"];
    home.run(&convert).failed(6, &["writing empty.mcap"]);
}

#[test]
fn a_session_is_tapped_played_and_converted() {
    Simulated::each(|sim| {
        let home = Home::new();
        let robot = sim.address();
        let mut tap = home.start(&["tap", "tape.mcap", &robot, "--port", "0"]);
        let at = address(&mut tap);
        home.run(&["collision", "compliant", &at]).done();
        tap.signal(Signal::SIGINT);
        let text = tap.ended().done();
        assert!(
            text.contains(" connections, ") && text.contains("0 dropped"),
            "{text}"
        );
        // For each connection; an FER refuses the first one, whose version is too new.
        let datagrams = |file: &str| -> Vec<u64> {
            let info = home.run(&["cassette", "info", file, "--json"]).json();
            let connections = info["connections"].as_array().expect("a list");
            let counts = connections.iter().map(|it| it["datagrams"].as_u64());
            counts.map(|count| count.expect("a count")).collect()
        };
        let taped = datagrams("tape.mcap");
        assert!(taped.last() > Some(&0), "{taped:?}");
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
        assert_eq!(datagrams("again.mcap"), taped);
        home.run(&["cassette", "info", "tape.pcap"])
            .failed(6, &["tape.pcap", "franka explain"]);
    });
}

/// Returns the address of the robot from the first line on standard error.
fn address(program: &mut crate::program::Started) -> String {
    use std::io::Read;
    let (mut line, mut byte) = (Vec::new(), [0]);
    let err = program.child().stderr.as_mut().expect("piped");
    while byte[0] != b'\n' {
        err.read_exact(&mut byte).expect("a line");
        line.push(byte[0]);
    }
    robot_address(&String::from_utf8(line).expect("text")).expect("an address")
}
