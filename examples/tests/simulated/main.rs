//! The examples as programs: with a simulator of each kind in their own process, and, to check the
//! arm's motion, with a simulator in the test process.

mod arm;
mod control;
mod doors;
mod first_programs;
mod jobs;
mod program;
mod programs;
mod remote;
mod teleoperation;

use program::ROBOTS;

/// Runs an example with its own simulator, and returns its output.
fn run(name: &str, robot: &str) -> String {
    let said = program::run(name, &["--sim", robot], "");
    assert_eq!(said.code, Some(0), "{name} on {robot}: {said:?}");
    said.stdout
}

#[test]
fn engage_goes_from_goal_to_goal_and_back() {
    for robot in ROBOTS {
        let said = run("engage", robot);
        assert!(
            said.contains("held: no new target arrived"),
            "{robot}: {said}"
        );
        assert!(said.contains("back after "), "{robot}: {said}");
    }
}

#[test]
fn pick_holds_the_block_and_puts_it_down() {
    for robot in ROBOTS {
        let said = run("pick", robot);
        assert!(
            said.contains("holding 30.0 mm\nput down"),
            "{robot}: {said}"
        );
    }
}

#[cfg(feature = "mujoco")]
#[test]
fn carry_takes_the_bar_there_and_back() {
    let said = program::run("carry", &[], "");
    assert_eq!(said.code, Some(0), "{said:?}");
    for way in ["up", "back"] {
        for arm in ["one arm: ", "the other:"] {
            let line = format!("{way}, {arm} ");
            assert!(said.stdout.contains(&line), "no {line:?}: {said:?}");
        }
        // Either arm has carried it there, with an error below 2 mm.
        let line = format!("{way}: the bar is off by ");
        let off = said
            .stdout
            .lines()
            .find_map(|said| said.strip_prefix(&line));
        let off = off.unwrap_or_else(|| panic!("no {line:?}: {said:?}"));
        let off: Vec<f64> = off
            .split(' ')
            .filter_map(|word| word.parse().ok())
            .collect();
        let [one, other] = off[..] else {
            panic!("two distances: {said:?}")
        };
        assert!(one < 2.0 && other < 2.0, "{one} mm, {other} mm");
    }
}

#[cfg(feature = "mujoco")]
#[test]
fn carry_says_why_it_is_refused() {
    let said = program::run("carry", &["--speed", "1000"], "");
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(
        said.stderr.contains("speed is 1000, expected between"),
        "{said:?}"
    );
}

#[test]
fn supervised_goes_on_after_reflexes() {
    for robot in ROBOTS {
        let said = run("supervised", robot);
        assert!(
            said.contains("reflex 2: [\"cartesian_reflex\"]"),
            "{robot}: {said}"
        );
        assert!(
            said.contains("; 0 reconnects, 2 recoveries"),
            "{robot}: {said}"
        );
        assert!(
            said.contains("closed: this program has closed the connection"),
            "{robot}: {said}"
        );
    }
}
