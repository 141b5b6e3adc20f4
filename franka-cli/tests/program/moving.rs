//! Motions, and their early ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use franka_async::model::Wrench;
use franka_async::state::{RobotError, RobotMode};
use franka_sim::network::{BurstLoss, Conditions, Loss};
use franka_sim::{Network, Sim};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use crate::program::{Home, until};
use crate::simulated::Simulated;

/// Returns the arguments of a motion that starts without a question.
fn moving<'a>(robot: &'a str, rest: &[&'a str]) -> Vec<&'a str> {
    let all = ["move", robot, "--realtime", "ignore", "--yes"];
    all.iter().chain(rest).copied().collect()
}

/// A motion of some seconds.
const SLOW: [&str; 4] = ["--by", "0,0.2,0", "--speed", "0.3"];

#[test]
fn every_kind_of_target_is_reached() {
    Simulated::each_fast(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let run = |rest: &[&str]| home.run(&moving(&robot, rest)).done();
        let place = || sim.with(|robot| robot.true_pose().translation.vector);
        let near = |got: f64, wanted: f64| assert!((got - wanted).abs() < 0.01, "{got}, {wanted}");
        let text = run(&["--joints", "0,-45,0,-135,0,90,60", "--degrees"]);
        assert!(text.contains("arrived after"), "{text}");
        near(sim.state().q[6], 60_f64.to_radians());
        run(&["--ready"]);
        near(sim.state().q[6], 45_f64.to_radians());
        let start = place();
        run(&["--by", "0,0,-0.05,0,0,10"]);
        near(place().z, start.z - 0.05);
        // The hand points down.
        run(&["--by", "0,0,0.05", "--tool"]);
        near(place().z, start.z - 0.1);
        let to = format!("{},{},{}", start.x, start.y, start.z);
        let json = home.run(&moving(&robot, &["--pose", &to, "--json"])).json();
        near(place().z, start.z);
        assert!(json["duration"].is_object(), "{json}");
    });
}

#[test]
fn target_out_of_reach_is_refused_before_anything_moves() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        for (rest, text) in [
            (["--pose", "2,0,0"], "out of reach"),
            (
                ["--joints", "9,0,0,-2,0,2,0"],
                "the target of joint 1 is 9.0000 rad, expected",
            ),
        ] {
            home.run(&moving(&robot, &rest)).failed(1, &[text]);
        }
        let fast = home.run(&moving(&robot, &["--ready", "--speed", "100"]));
        fast.failed(2, &["100"]);
        sim.rests(RobotMode::Idle);
    });
}

#[test]
fn without_real_time_rights_nothing_moves() {
    let (home, sim) = (Home::new(), Simulated::fr3());
    let ran = home.run(&["move", &sim.address(), "--ready", "--yes"]);
    // A host that grants the rights moves the arm.
    if ran.code != Some(0) {
        ran.failed(6, &["--realtime ignore"]);
    }
}

#[test]
fn ctrl_c_and_sigterm_brake_and_say_so() {
    Simulated::each(|sim| {
        let signals = [
            (Signal::SIGINT, 130, "Ctrl-C: braking"),
            (Signal::SIGTERM, 143, "SIGTERM: braking"),
        ];
        for (signal, code, text) in signals {
            let (home, robot) = (Home::new(), sim.address());
            let mut program = home.start(&moving(&robot, &SLOW));
            sim.moves();
            program.signal(signal);
            program
                .ended()
                .failed(code, &[text, "braked and is at rest"]);
            sim.rests(RobotMode::Idle);
        }
    });
}

#[test]
fn a_reflex_is_explained() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let mut arguments = moving(&robot, &SLOW);
        arguments.extend(["--record", "reflex.mcap"]);
        let program = home.start(&arguments);
        sim.moves();
        sim.with(|robot| {
            robot.push_end_effector(Wrench::new(0.0, -150.0, 0.0, 0.0, 0.0, 0.0), 500)
        });
        let texts = ["reflex", "recorded", "franka recover"];
        program.ended().failed(1, &texts);
        sim.rests(RobotMode::Reflex);
        let file = home.path("reflex.mcap");
        let file = file.to_str().expect("text");
        let text = home.run(&["explain", file, "--figure", "x.svg"]).done();
        assert!(text.contains("reflex"), "{text}");
        let figure = std::fs::read_to_string(home.path("x.svg")).expect("a figure");
        assert!(figure.contains("<svg"), "{figure}");
        let ready = moving(&robot, &["--ready"]);
        home.run(&ready)
            .failed(1, &["has stopped itself", "franka recover"]);
        home.run(&["recover", &robot])
            .failed(5, &["may move by some millimetres"]);
        sim.rests(RobotMode::Reflex);
        let json = home.run(&["recover", &robot, "--yes", "--json"]).json();
        assert_eq!(json["recovered"], true);
        sim.rests(RobotMode::Idle);
        let text = home.run(&["recover", &robot]).done();
        assert!(text.contains("already ready: no recovery needed"), "{text}");
    });
}

#[test]
fn ctrl_c_at_a_recovery_says_that_it_may_go_on() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        sim.with(|robot| robot.trip(RobotError::CartesianReflex));
        sim.rests(RobotMode::Reflex);
        let mut program = home.start(&["recover", &robot, "--yes"]);
        let id = program.child().id();
        until("a recovery", || {
            sim.with(move |robot| {
                let recovers = robot.state().robot_mode == RobotMode::AutomaticErrorRecovery;
                if recovers {
                    interrupt_and_wait(id);
                }
                recovers
            })
        });
        program
            .ended()
            .failed(130, &["may still complete the recovery"]);
        sim.rests(RobotMode::Idle);
    });
}

/// Interrupts a program, and waits for its end, or for some seconds. The robot must be at rest
/// meanwhile.
fn interrupt_and_wait(id: u32) {
    kill(Pid::from_raw(id as i32), Signal::SIGINT).expect("it runs");
    let begin = Instant::now();
    let has_ended = || {
        let status = std::fs::read_to_string(format!("/proc/{id}/stat"));
        status.is_ok_and(|status| status.contains(") Z"))
    };
    while !has_ended() && begin.elapsed() < Duration::from_secs(5) {
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn motion_ended_by_lost_packets_names_causes_on_this_host() {
    // After about 200 commands all are lost.
    let lost = Conditions {
        loss: Loss::Bursts(BurstLoss {
            begin: 0.005,
            end: 0.0,
            good: 0.0,
            bad: 1.0,
        }),
        ..Conditions::default()
    };
    let network = Network::new(1, Conditions::default(), lost);
    let (home, sim) = (Home::new(), Simulated::start(Sim::fr3().network(network)));
    let texts = [
        "communication_constraints_violation",
        "on this computer:",
        "franka recover",
    ];
    home.run(&moving(&sim.address(), &SLOW)).failed(1, &texts);
}

#[test]
fn a_guided_arm_is_held_again_at_the_end() {
    Simulated::each(|sim| {
        let (home, robot) = (Home::new(), sim.address());
        let guide = ["guide", &robot, "--realtime", "ignore", "--yes"];
        let mut program = home.start(&guide);
        until("a session", || sim.state().robot_mode == RobotMode::Move);
        sim.with(|robot| robot.push_end_effector(Wrench::new(0.0, 20.0, 0.0, 0.0, 0.0, 0.0), 200));
        sim.moves();
        program.signal(Signal::SIGINT);
        let text = program.ended().done();
        assert!(text.contains("the arm rests at"), "{text}");
        sim.rests(RobotMode::Idle);
        let timed = [&guide[..], &["--seconds", "0.1", "--free", "elbow"]].concat();
        home.run(&timed).done();
    });
}

/// The command ends with a second signal, or automatically after some seconds.
#[test]
fn guide_ends_while_a_hand_pushes_on() {
    for again in [true, false] {
        let (home, sim) = (Home::new(), Simulated::fr3());
        let robot = sim.address();
        let mut program = home.start(&["guide", &robot, "--realtime", "ignore", "--yes"]);
        until("a session", || sim.state().robot_mode == RobotMode::Move);
        let ended = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                for force in [15.0, -15.0].into_iter().cycle() {
                    if ended.load(Ordering::Relaxed) {
                        break;
                    }
                    let push = Wrench::new(0.0, force, 0.0, 0.0, 0.0, 0.0);
                    sim.with(move |robot| robot.push_end_effector(push, 250));
                    std::thread::sleep(Duration::from_millis(250));
                }
            });
            sim.moves();
            let begin = Instant::now();
            program.signal(Signal::SIGINT);
            // A program that still handles the first signal misses one of these.
            while again && program.child().try_wait().expect("its child").is_none() {
                std::thread::sleep(Duration::from_millis(300));
                program.signal(Signal::SIGTERM);
            }
            let ran = program.ended();
            ended.store(true, Ordering::Relaxed);
            // The arm may be at rest between two pushes.
            assert!(matches!(ran.code, Some(1 | 130 | 143)), "{ran:?}");
            assert_eq!(ran.err.contains("SIGTERM: braking"), again, "{ran:?}");
            assert!(begin.elapsed() < Duration::from_secs(30), "{ran:?}");
        });
    }
}
