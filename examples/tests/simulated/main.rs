//! The examples as programs: with a simulator of each kind in their own process, and, to check what
//! the arm does, with a simulator in the process of the test.

mod arm;
mod control;
mod program;

use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};

use program::{ROBOTS, example};

/// Runs an example with its own simulator, and returns its output.
fn run(name: &str, robot: &str) -> String {
    let said = program::run(name, &["--sim", robot], "");
    assert_eq!(said.code, Some(0), "{name} on {robot}: {said:?}");
    said.stdout
}

#[test]
fn quickstart_arrives() {
    for robot in ROBOTS {
        let said = run("quickstart", robot);
        assert!(said.contains("\narrived: "), "{robot}: {said}");
    }
}

#[test]
fn follow_watch_follows_to_the_end() {
    for robot in ROBOTS {
        let said = run("follow_watch", robot);
        assert!(said.contains("followed for "), "{robot}: {said}");
    }
}

#[test]
fn engage_goes_from_goal_to_goal_and_back() {
    for robot in ROBOTS {
        let said = run("engage", robot);
        assert!(said.contains("held: no target came"), "{robot}: {said}");
        assert!(said.contains("back after "), "{robot}: {said}");
    }
}

#[test]
fn script_draws_its_circle_and_comes_back() {
    for robot in ROBOTS {
        let said = program::run("script", &["--sim", robot, "--turns", "1"], "");
        assert_eq!(said.code, Some(0), "{robot}: {said:?}");
        assert!(said.stdout.contains("\nback, 0."), "{robot}: {said:?}");
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

/// A service that is killed at the end of the test, also when the test fails.
struct Service(Child);

impl Drop for Service {
    fn drop(&mut self) {
        // Fails only if the service has ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_web_service_moves_the_arm() {
    for robot in ROBOTS {
        let child = example("axum_service")
            .args(["--sim", robot, "--listen", "127.0.0.1:0"])
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut service = Service(child);
        let stdout = service.0.stdout.take().expect("it is piped");
        let mut lines = BufReader::new(stdout).lines();
        let address = lines.by_ref().find_map(|line| {
            let line = line.expect("it prints text");
            line.strip_prefix("listening on ").map(str::to_owned)
        });
        let url = format!("http://{}", address.expect("it listens"));
        let state = ureq::get(format!("{url}/state")).call().unwrap();
        let before = joint_2(state);
        let moved = ureq::post(format!("{url}/move_to"))
            .send_json([0.0, 0.0, 0.03])
            .unwrap()
            .body_mut()
            .read_to_string()
            .unwrap();
        assert!(moved.starts_with("arrived after "), "{robot}: {moved}");
        let after = joint_2(ureq::get(format!("{url}/state")).call().unwrap());
        assert!(before != after, "{robot}: the joints have moved");
    }
}

/// The position of joint 2 in the service's answer.
fn joint_2(mut answer: ureq::http::Response<ureq::Body>) -> f64 {
    let state: serde_json::Value = answer.body_mut().read_json().unwrap();
    state["q"][1].as_f64().expect("joint positions")
}
