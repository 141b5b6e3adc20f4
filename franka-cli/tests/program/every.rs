//! Properties of every command, from tables of commands in the same situation.

use std::net::TcpListener;
use std::path::Path;

use franka_async::gripper::Gripper;
use franka_async::model::Wrench;
use franka_async::state::RobotMode;
use franka_async::{Realtime, Robot};
use franka_sim::Sim;
use nix::sys::signal::Signal;

use crate::program::{Home, until};
use crate::simulated::Simulated;
use crate::terminal::Terminal;

/// Commands without motion: reading and settings. `run.mcap` is a recording.
const STILL: [&str; 16] = [
    "state ROBOT",
    "read ROBOT robot_mode",
    "model pose ROBOT",
    "model ik ROBOT --pose 0.4,0,0.4",
    "model jacobian ROBOT",
    "model mass ROBOT",
    "limits ROBOT",
    "stop ROBOT",
    "recover ROBOT --yes",
    "tool set ROBOT --mass 0",
    "collision careful ROBOT",
    "record new.mcap ROBOT --seconds 0.2",
    "gripper state HAND",
    "gripper home HAND --yes",
    "gripper open HAND --yes",
    "gripper stop HAND",
];

/// Commands that move the arm for some seconds, or that could move it.
const MOVING: [&str; 6] = [
    "move ROBOT --by 0,0.2,0 --speed 0.3 --yes --realtime ignore",
    "replay run.mcap ROBOT --speed 0.3 --yes --realtime ignore",
    "guide ROBOT --yes --realtime ignore",
    "tool identify ROBOT --yes --realtime ignore",
    "test communication ROBOT --seconds 60 --yes --realtime ignore",
    "trial ROBOT --report new.md --yes --realtime ignore",
];

/// Other commands that connect to a robot.
const OTHER: [&str; 4] = [
    "state ROBOT --watch --json",
    "dash ROBOT --listen 127.0.0.1:0",
    "gripper close HAND --yes",
    "gripper grasp HAND --width 0.03 --yes",
];

/// Short motions, and checks that contact the robot.
const SHORT: [&str; 3] = [
    "guide ROBOT --seconds 0.1 --yes --realtime ignore",
    "test communication ROBOT --seconds 0.2 --yes --realtime ignore",
    "doctor ROBOT --only robot,disk --for read --quick",
];

/// Commands that run until Ctrl-C, and the text that they show at their beginning.
const LASTING: [(&str, &str); 7] = [
    ("sim --port 0", "vacuum gripper on"),
    ("sim --robot fer --port 0", "vacuum gripper on"),
    ("dash ROBOT --listen 127.0.0.1:0", "http://"),
    ("tap new.mcap ROBOT --port 0", "Ctrl-C ends"),
    ("record new.mcap ROBOT", "Ctrl-C ends"),
    ("state ROBOT --watch", "Ctrl-C ends"),
    ("guide ROBOT --yes --realtime ignore", "Ctrl-C ends"),
];

/// Commands that need no robot.
const ALONE: [&str; 9] = [
    "robots list",
    "model pose --kind fr3",
    "limits --kind fer",
    "explain run.mcap",
    "export run.mcap --csv table.csv",
    "cassette info tape.mcap",
    "cassette convert tape.mcap new.pcap",
    "bench wake --seconds 0.1",
    "bench loop --seconds 0.1",
];

/// Returns the words of a command, with these addresses.
fn words<'a>(command: &'a str, robot: &'a str, hand: &'a str) -> Vec<&'a str> {
    let word = |word| match word {
        "ROBOT" => robot,
        "HAND" => hand,
        word => word,
    };
    command.split(' ').map(word).collect()
}

/// Records a motion of this robot to `run.mcap`. Returns the robot.
fn record(home: &Home, sim: Sim) -> Simulated {
    let sim = Simulated::fast(sim);
    let robot = sim.address();
    let way = "move ROBOT --by 0,0.1,0 --record run.mcap --yes --realtime ignore";
    home.run(&words(way, &robot, "")).done();
    sim
}

#[test]
fn without_a_robot_every_command_says_so() {
    let home = Home::new();
    record(&home, Sim::fr3());
    let free = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = free.local_addr().expect("bound").to_string();
    drop(free);
    let texts = [
        "the connection was refused",
        "FCI",
        "errors.md#connect-refused",
    ];
    for command in STILL.iter().chain(&MOVING).chain(&OTHER) {
        let ran = home.run(&words(command, &address, &address));
        assert_eq!(ran.code, Some(3), "{command}: {ran:?}");
        ran.failed(3, &texts);
    }
    assert!(!home.path("new.mcap").exists());
    let silent = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = silent.local_addr().expect("bound").to_string();
    home.run(&["state", &address]).failed(3, &["answers at"]);
    home.run(&["state", "nobody"]).failed(3, &["`nobody`"]);
}

#[test]
fn a_robot_that_is_taken_is_left_alone_by_every_command() {
    Simulated::each_kind(|kind, sim| {
        let (home, robot, hand) = (Home::new(), sim.address(), sim.hand());
        record(&home, kind);
        let runtime = tokio::runtime::Runtime::new().expect("a runtime");
        let builder = Robot::builder(robot.as_str()).realtime(Realtime::Ignore);
        let first = runtime.block_on(builder.connect()).expect("connected");
        let fingers = runtime.block_on(Gripper::connect(hand.as_str()));
        let fingers = fingers.expect("connected");
        let texts = [
            "another client is probably connected",
            "one client at a time",
        ];
        for command in STILL.iter().chain(&MOVING).chain(&OTHER) {
            let ran = home.run(&words(command, &robot, &hand));
            assert_eq!(ran.code, Some(4), "{command}: {ran:?}");
            ran.failed(4, &texts);
        }
        assert!(sim.with(|robot| robot.is_connected()));
        sim.rests(RobotMode::Idle);
        drop(fingers);
        runtime.block_on(first.shutdown());
    });
}

#[test]
fn every_motion_is_braked_by_ctrl_c() {
    Simulated::each_kind(|kind, sim| {
        let (home, robot) = (Home::new(), sim.address());
        record(&home, kind);
        for command in MOVING
            .iter()
            .filter(|command| !command.starts_with("guide"))
        {
            let mut program = home.start(&words(command, &robot, ""));
            begins(sim, command);
            program.signal(Signal::SIGINT);
            program
                .ended()
                .failed(130, &["braking", "braked and is at rest"]);
            sim.rests(RobotMode::Idle);
        }
    });
}

#[test]
fn a_reflex_ends_every_motion_and_is_explained() {
    Simulated::each_kind(|kind, sim| {
        let (home, robot) = (Home::new(), sim.address());
        record(&home, kind);
        for command in MOVING {
            let program = home.start(&words(command, &robot, ""));
            begins(sim, command);
            sim.with(|robot| {
                robot.push_end_effector(Wrench::new(0.0, -150.0, 0.0, 0.0, 0.0, 0.0), 500)
            });
            program.ended().failed(1, &["reflex", "franka recover"]);
            sim.rests(RobotMode::Reflex);
            home.run(&["recover", &robot, "--yes"]).done();
            sim.rests(RobotMode::Idle);
        }
    });
}

/// Waits until a command has begun to move or hold the arm.
fn begins(sim: &Simulated, command: &str) {
    match command.split(' ').next() {
        Some("guide" | "test" | "trial") => until("a motion", || sim.state().motion_running()),
        _ => sim.moves(),
    }
}

#[test]
fn everything_fits_into_a_terminal_of_80_columns() {
    Simulated::each_kind(|kind, sim| {
        let (home, robot) = (Home::new(), sim.address());
        // Its Hand is fast.
        let quick = record(&home, kind);
        let hand = quick.hand();
        let tape = Terminal::run(&home, &words("tap tape.mcap ROBOT --port 0", &robot, ""));
        tape.shows("Ctrl-C ends");
        home.run(&["state", &tape.address()]).done();
        tape.signal(Signal::SIGINT);
        fits("tap", &home, tape, &[0]);
        for command in STILL.iter().chain(&ALONE).chain(&SHORT) {
            let terminal = Terminal::run(&home, &words(command, &robot, &hand));
            // On a busy host, a check of the doctor may fail.
            let codes: &[i32] = match command.starts_with("doctor") {
                true => &[0, 1],
                false => &[0],
            };
            fits(command, &home, terminal, codes);
        }
        for (command, begun) in LASTING {
            let terminal = Terminal::run(&home, &words(command, &robot, &hand));
            terminal.shows(begun);
            terminal.signal(Signal::SIGINT);
            fits(command, &home, terminal, &[0]);
        }
        let play = "cassette play tape.mcap --port 0 --patience 60";
        let terminal = Terminal::run(&home, &words(play, "", ""));
        terminal.shows(" at ");
        home.run(&["state", &terminal.address()]).done();
        fits(play, &home, terminal, &[0]);
    });
}

/// Waits for the end of a command with one of these `codes`, and checks that its output fits the
/// terminal.
#[track_caller]
fn fits(command: &str, home: &Home, terminal: Terminal, codes: &[i32]) {
    let (code, shown) = terminal.ended();
    assert!(
        code.is_some_and(|code| codes.contains(&code)),
        "{command}: {shown}"
    );
    let shown = anstream::adapter::strip_str(&shown).to_string();
    // A progress bar rewrites its line, and a page its first line.
    let lines = shown.split(['\n', '\r']).map(|line| line.chars().count());
    let longest = lines.max().unwrap_or(0);
    // File names have their own length, and a log is for other programs, too.
    let has_path = shown.contains(&*home.as_ref().to_string_lossy()) || shown.contains(" INFO ");
    assert!(longest <= 80 || has_path, "{command}: {shown}");
    assert!(longest > 0 || command.contains(" convert "), "{command}");
    for new in ["new.mcap", "new.pcap", "table.csv"] {
        remove(&home.path(new));
    }
}

/// Deletes a file, if it exists.
fn remove(file: &Path) {
    if file.exists() {
        std::fs::remove_file(file).expect("deleted");
    }
}

#[test]
fn every_command_refuses_arguments_that_it_does_not_know() {
    let home = Home::new();
    for command in STILL.iter().chain(&MOVING).chain(&OTHER).chain(&ALONE) {
        let words = [words(command, "x", "x"), vec!["--nonsense"]].concat();
        home.run(&words).failed(2, &["--nonsense"]);
    }
    for command in [
        "doctor",
        "sim",
        "tap x y",
        "cassette play x",
        "robots add a b",
        "robots remove a",
        "completions bash",
        "man pages",
    ] {
        let words: Vec<&str> = command.split(' ').chain(["--nonsense"]).collect();
        home.run(&words).failed(2, &["--nonsense"]);
    }
}
