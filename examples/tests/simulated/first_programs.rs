//! The programs of the book's first chapter, with realistic arms.

use std::io::Write;
use std::time::{Duration, Instant};

use franka_async::state::{RobotError, RobotMode};
use nix::sys::signal::Signal;

use crate::arm::{Arm, Event, SOON, Scene};
use crate::control::succeeded;
use crate::program::{Beside, ROBOTS, on_both};

#[test]
fn each_program_is_short_and_depends_on_the_driver_alone() {
    for (name, program) in [
        ("job_queue", include_str!("../../24_job_queue.rs")),
        ("policy", include_str!("../../03_policy.rs")),
        ("guarded_move", include_str!("../../19_guarded_move.rs")),
        ("script", include_str!("../../05_script.rs")),
    ] {
        let lines = program.lines().count();
        assert!(lines < 65, "{name}: {lines} lines");
        let ours = program.matches("franka_").count();
        assert_eq!(ours, program.matches("franka_async::").count(), "{name}");
    }
}

fn realistic() -> Scene {
    Scene {
        realistic: true,
        ..Scene::default()
    }
}

#[test]
fn job_queue_does_jobs_in_order_and_goes_on_after_a_recovery() {
    for robot in ROBOTS {
        let arm = Arm::start(robot, realistic());
        let start = arm.state();
        let mut service = Beside::start("job_queue", &[&arm.address]);
        let url = format!("http://{}", service.said("listening on "));
        let add = |by: [f64; 3]| {
            let sent = ureq::post(format!("{url}/jobs")).send_json(by);
            assert_eq!(sent.expect("it is taken").status(), 202, "{robot}");
        };
        let recover = || {
            let agent = ureq::Agent::config_builder().http_status_as_error(false);
            let agent: ureq::Agent = agent.build().into();
            let answer = agent.post(format!("{url}/recover")).send_empty();
            answer.expect("an answer").status()
        };
        let outcomes = |count: usize| -> Vec<String> {
            let end = Instant::now() + SOON;
            loop {
                let answer = ureq::get(format!("{url}/jobs")).call().expect("an answer");
                let outcomes: Vec<String> = answer.into_body().read_json().expect("a list");
                if outcomes.len() == count {
                    return outcomes;
                }
                assert!(Instant::now() < end, "{robot}: {outcomes:?}");
                std::thread::sleep(Duration::from_millis(20));
            }
        };
        add([0.0, 0.0, 0.04]);
        add([0.0, 0.03, 0.0]);
        assert_eq!(outcomes(2), ["arrived", "arrived"], "{robot}");
        let state = arm.state();
        for (axis, way) in [(0, 0.0), (1, 0.03), (2, 0.04)] {
            let moved = state.O_T_EE[12 + axis] - start.O_T_EE[12 + axis];
            assert!((moved - way).abs() < 4e-3, "{robot}: {moved} along {axis}");
        }

        arm.trip(RobotError::CartesianReflex);
        arm.wait_for("stopped", |state| state.robot_mode == RobotMode::Reflex);
        add([0.0, 0.0, -0.04]);
        assert_ne!(outcomes(3)[2], "arrived", "{robot}");
        arm.with(|robot| robot.press_user_stop(true));
        assert_eq!(recover(), 409, "{robot}");
        arm.with(|robot| robot.press_user_stop(false));
        assert_eq!(recover(), 200, "{robot}");
        add([0.0, 0.0, -0.04]);
        assert_eq!(outcomes(4)[3], "arrived", "{robot}");

        // A client that never completes its request delays no other.
        let mut half =
            std::net::TcpStream::connect(url.trim_start_matches("http://")).expect("it listens");
        half.write_all(b"POST /jobs HTTP/1.1\r\n")
            .expect("it is taken");
        service.signal(match robot {
            "fr3" => Signal::SIGTERM,
            _ => Signal::SIGINT,
        });
        assert!(service.ended().success(), "{robot}");
        arm.rests();
        arm.stop();
    }
}

#[test]
fn policy_leads_the_hand_around_and_back() {
    let scene = Scene {
        slow: Duration::from_millis(3),
        ..realistic()
    };
    on_both("policy", &[], &scene, |robot, said, path| {
        succeeded(robot, said, path);
        assert!(said.stdout.contains("followed for "), "{robot}: {said:?}");
        // The policy uses this computer's clock: on a busy machine the robot has too little time
        // for the whole circle.
        let (_, highest, last) = path.hand(2);
        assert!(highest > 0.01, "{robot}: {highest} m up");
        assert!(last.abs() < 3e-3, "{robot}: {last} m off");
        let (_, aside, last) = path.hand(1);
        assert!(aside > 0.005, "{robot}: {aside} m aside");
        assert!(last.abs() < 3e-3, "{robot}: {last} m off");
    });
}

#[test]
fn guarded_move_stops_at_the_table_and_leaves_it() {
    // The motion to the ready pose, where the arm already is, is the first motion.
    let table = Scene {
        events: vec![(|_, time| time > 0, Event::LayTable(0.06))],
        ..realistic()
    };
    for (scene, text, depth) in [
        (table, "contact at ", -0.06),
        (realistic(), "nothing there", -0.15),
    ] {
        on_both("guarded_move", &[], &scene, |robot, said, path| {
            succeeded(robot, said, path);
            assert!(said.stdout.starts_with(text), "{robot}: {said:?}");
            let (lowest, _, last) = path.hand(2);
            assert!((lowest - depth).abs() < 6e-3, "{robot}: {lowest} m");
            assert!(last.abs() < 3e-3, "{robot}: {last} m off");
        });
    }
}

#[test]
fn script_draws_its_circle_and_comes_back() {
    on_both("script", &[], &realistic(), |robot, said, path| {
        succeeded(robot, said, path);
        assert!(said.stdout.starts_with("back, "), "{robot}: {said:?}");
        let (_, highest, last) = path.hand(2);
        assert!(highest > 0.09, "{robot}: {highest} m up");
        assert!(last.abs() < 3e-3, "{robot}: {last} m off");
    });
}
