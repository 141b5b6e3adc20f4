//! The command-line programs: their output, their files, their exit codes.

use franka_async::state::{RobotError, RobotMode};

use crate::arm::{Arm, Scene};
use crate::program::{ROBOTS, run};

#[test]
fn grasp_tells_by_its_exit_code_what_it_holds() {
    // The simulator of the program has a block of 3 cm between the fingers.
    for (width, code, said) in [
        ("0.03", 0, "holds 30.0 mm with 30 N\n"),
        (
            "0.05",
            3,
            "nothing of 50.0 mm: the fingers stopped at 30.0 mm\n",
        ),
        (
            "0.01",
            3,
            "nothing of 10.0 mm: the fingers stopped at 30.0 mm\n",
        ),
    ] {
        for robot in ROBOTS {
            let grasped = run("grasp", &[width, "--sim", robot], "");
            assert_eq!(grasped.code, Some(code), "{robot}, {width}: {grasped:?}");
            assert!(
                grasped.stdout.starts_with("homed: the fingers open to 80"),
                "{grasped:?}"
            );
            assert!(
                grasped.stdout.ends_with(said),
                "{robot}, {width}: {grasped:?}"
            );
        }
    }
}

#[test]
fn recover_explains_asks_and_recovers() {
    for (input, code, left) in [("", 1, RobotMode::Reflex), ("\n", 0, RobotMode::Idle)] {
        let arm = Arm::start("fr3", Scene::default());
        arm.trip(RobotError::CartesianReflex);
        arm.wait_for("stopped", |state| state.robot_mode == RobotMode::Reflex);
        let said = run("recover", &[&arm.address, "--realtime", "ignore"], input);
        assert_eq!(said.code, Some(code), "{said:?}");
        let text = &said.stdout;
        assert!(
            text.starts_with("mode: Reflex, errors: [\"cartesian_reflex\"]\n"),
            "{said:?}"
        );
        assert!(text.contains("\nchange: "), "{said:?}");
        assert_eq!(arm.state().robot_mode, left, "{said:?}");
        arm.stop();
    }
}

#[test]
fn recover_reports_nothing_to_do_and_need_of_a_person() {
    let arm = Arm::start("fer", Scene::default());
    let arguments = [arm.address.as_str(), "--realtime", "ignore"];
    let said = run("recover", &arguments, "");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(
        said.stdout.ends_with("nothing to recover from\n"),
        "{said:?}"
    );
    arm.with(|robot| robot.press_user_stop(true));
    arm.wait_for("stopped", |state| {
        state.robot_mode == RobotMode::UserStopped
    });
    let said = run("recover", &arguments, "");
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.stdout.contains("release the user stop"), "{said:?}");
    arm.stop();
}

/// Returns the columns of a row of the commander's table.
fn columns(row: &str) -> Vec<f64> {
    let columns = row.split(',').map(str::parse);
    columns.collect::<Result<_, _>>().expect("numbers")
}

/// Returns the largest jerk of the commands, as printed by the commander, `[m/s^3]`.
fn jerk(said: &str) -> f64 {
    let line = said.lines().find(|line| line.starts_with("command: "));
    let jerk = line.and_then(|line| line.rsplit_once(", ")?.1.strip_suffix(" m/s^3"));
    jerk.and_then(|jerk| jerk.parse().ok()).expect("a jerk")
}

#[test]
fn commander_follows_its_input_and_raw_commands_end_in_a_reflex() {
    let file = std::env::temp_dir().join(format!("franka-commander-{}.csv", std::process::id()));
    let path = file.to_str().expect("a path of text");
    let input = "higher\nby 0 0 0.05\nwait 0.3\nby 0 0.05 0\nwait 0.5\n";
    let mut jerks = Vec::new();
    for (raw, code) in [(false, 0), (true, 3)] {
        let arm = Arm::by_the_clock("fr3");
        let mut arguments = vec!["--realtime", "ignore", "--yes", "--csv", path, &arm.address];
        arguments.extend(raw.then_some("--raw"));
        let said = run("commander", &arguments, input);
        let moved = arm.stop();
        assert_eq!(said.code, Some(code), "{said:?}");
        assert!(said.stderr.contains("not understood: higher"), "{said:?}");
        jerks.push(jerk(&said.stdout));
        let table = std::fs::read_to_string(&file).expect("it was written");
        let mut rows = table.lines();
        assert_eq!(rows.next().map(|head| head.split(',').count()), Some(10));
        let rows: Vec<_> = rows.map(columns).collect();
        assert!(rows.iter().all(|row| row.len() == 10), "{table}");
        if raw {
            let reason = "cartesian_motion_generator_acceleration_discontinuity";
            assert!(said.stdout.contains(reason), "{said:?}");
            assert_eq!(moved.last().robot_mode, RobotMode::Reflex);
            continue;
        }
        assert_eq!(moved.last().robot_mode, RobotMode::Idle);
        for (axis, way) in [(0, 0.0), (1, 0.05), (2, 0.05)] {
            let (_, _, last) = moved.hand(axis);
            assert!((last - way).abs() < 2e-3, "axis {axis}: {last}");
            let [target, measured] = [1, 7].map(|column| rows[rows.len() - 1][column + axis]);
            assert!(
                (target - measured).abs() < 2e-3,
                "axis {axis}: {measured}, expected {target}"
            );
        }
    }
    std::fs::remove_file(&file).expect("it is ours");
    let [smooth, raw] = jerks[..] else {
        panic!("two runs")
    };
    assert!(
        raw > 10.0 * smooth,
        "{raw} m/s^3, and with the generator {smooth}"
    );
}

#[test]
fn record_keeps_both_motions_in_a_file_that_is_read_back() {
    for robot in ROBOTS {
        let folder = Folder::new(&format!("record-{robot}"));
        let file = folder.file("run.mcap");
        let said = run("record", &["--sim", robot, "--to", &file], "");
        assert_eq!(said.code, Some(0), "{said:?}");
        assert!(
            said.stdout.contains(" 0 dropped, 0 black boxes"),
            "{said:?}"
        );
        assert_eq!(said.stdout.matches("arrived").count(), 2, "{said:?}");
        // An existing file is not overwritten.
        let said = run("record", &["--sim", robot, "--to", &file], "");
        assert_eq!(said.code, Some(1), "{said:?}");
        assert!(said.stderr.contains("exists"), "{said:?}");
    }
}

#[test]
fn explain_names_the_contact_link_and_draws_a_figure() {
    let folder = Folder::new("explain");
    let figure = folder.file("blow.svg");
    let said = run("explain", &["--figure", &figure], "");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.stdout.contains("link 5"), "{said:?}");
    let figure = std::fs::read_to_string(figure).expect("it was drawn");
    assert!(figure.starts_with("<svg"), "{figure:.100}");
}

#[test]
fn replay_exports_the_motion_and_goes_it_again() {
    let folder = Folder::new("replay");
    let to = folder.file("run");
    let said = run("replay", &["--to", &to], "");
    assert_eq!(said.code, Some(0), "{said:?}");
    for expected in [" 0 dropped", "episode square-1: ", "replayed in "] {
        assert!(said.stdout.contains(expected), "no {expected:?}: {said:?}");
    }
    for file in [
        "run.mcap",
        "run.csv",
        "run.parquet",
        "dataset/meta/info.json",
    ] {
        let file = std::path::Path::new(&to).join(file);
        let length = std::fs::metadata(&file).expect("it was written").len();
        assert!(length > 100, "{}: {length} bytes", file.display());
    }
}

/// A new folder that is deleted at the end.
struct Folder(std::path::PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let name = format!("franka-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir(&folder).expect("there is none");
        Self(folder)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Left behind if a file in it is still open, which is not an error of the program.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn cassette_plays_a_motion_to_the_program_that_made_it() {
    let said = run("cassette", &["demo"], "");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(
        said.stdout.contains("arrived at the same place"),
        "{said:?}"
    );
}

#[test]
fn link_test_shows_two_robots_side_by_side() {
    let arms = Arm::in_step([Scene::default(), Scene::default()]);
    let [one, other] = arms.each_ref().map(|arm| arm.address.as_str());
    let arguments = [
        one,
        other,
        "--realtime",
        "ignore",
        "--yes",
        "--seconds",
        "1.5",
        "--good",
        "0",
    ];
    let said = run("link_test", &arguments, "");
    assert_eq!(said.code, Some(0), "{said:?}");
    for (row, columns) in [
        ("robot", 2),
        ("success rate, avg", 2),
        ("turnaround, max", 2),
    ] {
        let line = said.stdout.lines().find_map(|line| line.strip_prefix(row));
        let figures = line.expect("the row is there").replace(" us", "us");
        assert_eq!(
            figures.split_whitespace().count(),
            columns,
            "{row}: {said:?}"
        );
    }
    let mut robots = said.stdout.lines().filter(|line| line.starts_with("robot"));
    let robots = robots.next().expect("the row is there");
    assert!(robots.contains(one) && robots.contains(other), "{said:?}");
    for arm in arms {
        assert_eq!(arm.stop().last().robot_mode, RobotMode::Idle);
    }
}

#[test]
fn rules_says_what_the_book_quotes() {
    let said = run("rules", &[], "");
    assert_eq!(said.code, Some(0), "{said:?}");
    let page = include_str!("../../../docs/src/start/rules.md");
    let (mut is_quote, mut count) = (false, 0);
    for line in page.lines() {
        if line.starts_with("```") {
            is_quote = line == "```text";
        } else if is_quote {
            let is_said = said
                .stdout
                .lines()
                .any(|said| without_numbers(said.trim()) == without_numbers(line));
            assert!(is_said, "not said: {line}\n{}", said.stdout);
            count += 1;
        }
    }
    assert_eq!(count, 17);
}

/// Returns the text with each number replaced by one character.
fn without_numbers(text: &str) -> String {
    let mut masked = String::new();
    for part in text.chars() {
        let is_number = part.is_ascii_digit() || (masked.ends_with('#') && part == '.');
        match (is_number, masked.ends_with('#')) {
            (true, true) => {}
            (true, false) => masked.push('#'),
            (false, _) => masked.push(part),
        }
    }
    masked
}
