//! The trial of an arm, and its report.

use std::fs;

use franka_async::model::{RobotKind, Wrench};
use franka_async::state::RobotMode;
use franka_sim::arm::Family;
use franka_sim::{Arm, Robot, Sim};
use nix::sys::signal::Signal;
use serde_json::Value;

use crate::program::{Home, until};
use crate::simulated::Simulated;
use crate::terminal::Terminal;

/// Returns the arguments of a trial; with `--yes` it asks nothing.
fn trial<'a>(robot: &'a str, rest: &[&'a str]) -> Vec<&'a str> {
    let all = ["trial", robot, "--realtime", "ignore"];
    all.iter().chain(rest).copied().collect()
}

/// Returns the report of a trial, and its JSON data.
#[track_caller]
fn report(home: &Home, name: &str) -> (String, Value) {
    let text = fs::read_to_string(home.path(name)).expect("a report");
    let (_, json) = text.split_once("```json\n").expect("figures");
    let (json, _) = json.split_once("\n```").expect("their end");
    let all: Value = serde_json::from_str(json).expect("JSON");
    (text, all["trial"].clone())
}

/// Returns the findings of this step and check.
#[track_caller]
fn found<'a>(report: &'a Value, step: &str, check: &str) -> &'a Value {
    let by = |list: &'a Value, key: &str, name: &str| {
        let list = list.as_array().expect("a list");
        let found = list.iter().find(|it| it[key] == name);
        found.unwrap_or_else(|| panic!("no {name}: {report}"))
    };
    by(
        &by(&report["steps"], "name", step)["findings"],
        "check",
        check,
    )
}

fn figure(finding: &Value, name: &str) -> f64 {
    finding["figures"][name].as_f64().expect("a number")
}

/// Steps that move the arm or hold it.
const STEPS: [&str; 5] = ["hold", "1 cm", "5 cm", "one joint", "a stream"];

/// Arms with stiction, elasticity and deviations like real arms.
#[test]
fn a_trial_ends_in_a_report_and_a_recording() {
    for (sim, seed) in [(Sim::fr3(), 1), (Sim::fer(), 2)] {
        let kind = match seed {
            1 => RobotKind::Fr3,
            _ => RobotKind::Fer,
        };
        let arm = Arm::sample(kind, seed, &Family::realistic());
        let (home, sim) = (Home::new(), Simulated::fast(sim.arm(arm)));
        let robot = sim.address();
        let ran = home.run(&trial(&robot, &["--yes", "--json"]));
        let longest = ran.err.lines().map(|line| line.chars().count()).max();
        assert!(longest.is_some_and(|longest| longest <= 80), "{}", ran.err);
        let json = ran.json();
        let (text, trial) = report(&home, "trial.md");
        println!("{text}");
        assert_eq!(json["steps"], trial["steps"]);
        assert_eq!(trial["complete"], true);
        assert!(text.contains("**complete: 7 steps"), "{text}");
        assert!(!text.contains(&robot), "{text}");
        for step in STEPS {
            let rate = &found(&trial, step, "timing")["figures"]["success_rate_avg"];
            assert!(rate.is_f64(), "{rate}");
        }
        for step in ["1 cm", "5 cm"] {
            for way in ["there", "back"] {
                let off = figure(found(&trial, step, way), "translation_mm");
                assert!(off < 2.0, "{step} {way}: {off} mm");
            }
        }
        assert_eq!(found(&trial, "at rest", "limits")["verdict"], "good");
        // The lengths that this robot describes, and reports its poses with.
        let geometry = found(&trial, "at rest", "geometry");
        let lengths = match kind {
            RobotKind::Fr3 => (0.3162, 0.3842),
            _ => (0.316, 0.384),
        };
        let own = &geometry["figures"][0];
        assert_eq!(geometry["verdict"], "good", "{geometry}");
        assert_eq!(own["upper_arm"], lengths.0);
        assert_eq!(own["forearm"], lengths.1);
        assert!(figure(found(&trial, "hold", "drift"), "translation_mm") < 0.5);
        assert!(found(&trial, "at rest", "wrench")["figures"]["wrench"].is_array());
        // The recording is complete, but does not contain the name of this computer.
        home.run(&["explain", "trial.mcap"]).done();
        let recording = fs::read(home.path("trial.mcap")).expect("a recording");
        assert!(recording.len() > 1_000_000, "{}", recording.len());
        // Metadata are not compressed: the key and an empty text, each after its length.
        let nameless = b"\x04\0\0\0host\0\0\0\0";
        assert!(
            recording
                .windows(nameless.len())
                .any(|part| part == nameless)
        );
        sim.rests(RobotMode::Idle);
    }
}

#[test]
fn a_trial_asks_before_each_step_and_replaces_no_file() {
    let (home, sim) = (Home::new(), Simulated::fast(Sim::fr3()));
    let robot = sim.address();
    let mut terminal = Terminal::run(&home, &trial(&robot, &[]));
    terminal.shows("[y/N]");
    for text in ["trial, hold", "holds its position", "15 N"] {
        terminal.shows(text);
    }
    terminal.types("y\n");
    terminal.shows("10 mm up and back");
    terminal.shows("75 mm/s");
    terminal.types("n\n");
    let (code, shown) = terminal.ended();
    assert_eq!(code, Some(5), "{shown}");
    let (text, trial_of) = report(&home, "trial.md");
    assert_eq!(trial_of["complete"], false);
    assert_eq!(trial_of["ended"]["step"], "1 cm");
    assert_eq!(trial_of["ended"]["exit_code"], 5);
    assert!(
        text.contains("**incomplete: ended at the step \"1 cm\""),
        "{text}"
    );
    found(&trial_of, "hold", "drift");
    // Neither the report nor the recording is replaced, and no other files remain.
    home.run(&trial(&robot, &["--yes"])).failed(6, &["trial."]);
    fs::remove_file(home.path("trial.mcap")).expect("it is there");
    let again = home.run(&trial(&robot, &["--yes"]));
    again.failed(6, &["trial.md", "exists"]);
    assert_eq!(report(&home, "trial.md").0, text);
    // Without a terminal the arm does not move, and the report contains the reason.
    let other = home.run(&trial(&robot, &["--report", "other.md"]));
    other.failed(5, &["no terminal"]);
    assert_eq!(report(&home, "other.md").1["ended"]["step"], "hold");
    let names = fs::read_dir(&home).expect("a folder");
    let names: Vec<_> = names.map(|it| it.expect("an entry").file_name()).collect();
    assert!(
        !names
            .iter()
            .any(|it| it.to_string_lossy().contains("partial")),
        "{names:?}"
    );
}

/// The arm is pushed while it moves up by 5 cm.
#[test]
fn a_reflex_ends_a_trial_with_its_report() {
    for kind in [Sim::fr3 as fn() -> Sim, Sim::fer] {
        let mut height = None;
        let push = move |robot: &mut Robot| {
            let z = robot.true_pose().translation.z;
            if z > *height.get_or_insert(z) + 0.02 {
                height = Some(f64::INFINITY);
                robot.push_end_effector(Wrench::new(0.0, -150.0, 0.0, 0.0, 0.0, 0.0), 500);
            }
        };
        let sim = Simulated::fast(kind().every_millisecond(push));
        let (home, robot) = (Home::new(), sim.address());
        let ran = home.run(&trial(&robot, &["--yes"]));
        ran.failed(1, &["reflex", "franka recover", "report in trial.md"]);
        let (text, trial) = report(&home, "trial.md");
        assert_eq!(trial["complete"], false);
        assert_eq!(trial["ended"]["step"], "5 cm");
        assert_eq!(trial["ended"]["kind"], "failed");
        assert!(text.contains("reflex") && !text.contains(&robot), "{text}");
        home.run(&["explain", "trial.mcap"]).done();
        sim.rests(RobotMode::Reflex);
    }
}

#[test]
fn an_interrupted_trial_brakes_and_says_that_it_is_incomplete() {
    for (signal, code, kind) in [
        (Signal::SIGINT, 130, "interrupted"),
        (Signal::SIGTERM, 143, "terminated"),
    ] {
        let (home, sim) = (Home::new(), Simulated::fr3());
        let robot = sim.address();
        let mut program = home.start(&trial(&robot, &["--yes"]));
        until("a session", || sim.state().robot_mode == RobotMode::Move);
        program.signal(signal);
        program
            .ended()
            .failed(code, &["braking", "braked and is at rest"]);
        let (_, trial) = report(&home, "trial.md");
        assert_eq!(trial["complete"], false);
        assert_eq!(trial["ended"]["kind"], kind);
        assert_eq!(trial["ended"]["step"], "hold");
        found(&trial, "at rest", "geometry");
        sim.rests(RobotMode::Idle);
    }
}

/// During the observation of the arm, no motion runs.
#[test]
fn a_trial_that_is_interrupted_at_rest_moves_nothing() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let robot = sim.address();
    let mut program = home.start(&trial(&robot, &["--yes"]));
    until("a recording", || home.path("trial.mcap").exists());
    program.signal(Signal::SIGINT);
    program.ended().failed(130, &["is at rest"]);
    assert_eq!(report(&home, "trial.md").1["ended"]["step"], "at rest");
    sim.rests(RobotMode::Idle);
}

#[test]
fn undeclared_load_ends_the_trial_before_anything_moves() {
    let (home, sim) = (Home::new(), Simulated::fast(Sim::fr3()));
    // Thresholds that are not reached.
    let robot = sim.address();
    home.run(&["collision", "insensitive", &robot]).done();
    sim.with(|robot| {
        let push = Wrench::new(0.0, 0.0, -40.0, 0.0, 0.0, 0.0);
        robot.push_end_effector(push, 20_000);
    });
    let ran = home.run(&trial(&robot, &["--yes"]));
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let (text, trial) = report(&home, "trial.md");
    assert_eq!(trial["ended"]["step"], "at rest", "{text}");
    assert!(!text.contains("## 2. hold"), "{text}");
}
