//! The motion of the arm under each example of control at 1 kHz, as recorded by the simulator in
//! the test.

use franka_async::READY;
use franka_async::identify::Identified;
use franka_async::state::{RobotError, RobotMode};

use crate::arm::{Arm, Event, MeasuredPath, SAMPLE, Scene};
use crate::program::{ROBOTS, Said, on_both, run};

/// Asserts that a program has succeeded, and that the robot did not stop itself.
pub(crate) fn succeeded(robot: &str, said: &Said, path: &MeasuredPath) {
    assert_eq!(said.code, Some(0), "{robot}: {said:?}");
    let erred = path.first(|state| !state.errors.is_empty());
    assert!(erred.is_none(), "{robot}: {said:?}");
    assert_eq!(path.last().robot_mode, RobotMode::Idle, "{robot}");
}

/// Asserts that smallest, largest and last value are as expected.
fn is_about(what: &str, got: (f64, f64, f64), expected: (f64, f64, f64), tolerance: f64) {
    let off = [got.0 - expected.0, got.1 - expected.1, got.2 - expected.2];
    assert!(
        off.iter().all(|off| off.abs() <= tolerance),
        "{what}: {got:?}, expected {expected:?}"
    );
}

#[test]
fn move_to_ready_arrives_from_elsewhere() {
    let mut scene = Scene::default();
    for (joint, q) in scene.q.iter_mut().enumerate() {
        *q += if joint % 2 == 0 { 0.25 } else { -0.15 };
    }
    on_both("move_to_ready", &[], &scene, |robot, said, path| {
        succeeded(robot, said, path);
        for (joint, ready) in READY.iter().enumerate() {
            let error = path.last().q[joint] - ready;
            assert!(error.abs() < 2e-3, "{robot}: joint {joint} is {error} off");
        }
    });
}

#[test]
fn identify_goes_as_far_as_it_says_and_saves_what_it_found() {
    let path = std::env::temp_dir().join(format!("franka-identify-{}", std::process::id()));
    for robot in ROBOTS {
        let arm = Arm::start(robot, Scene::default());
        let file = path.with_extension(robot);
        let save = file.to_str().expect("a path of text");
        let arguments = [
            "--save",
            save,
            &arm.address,
            "--realtime",
            "ignore",
            "--yes",
        ];
        let said = run("identify", &arguments, "");
        let moved = arm.stop();
        succeeded(robot, &said, &moved);
        assert!(said.stdout.contains("\nload   "), "{robot}: {said:?}");
        // As in the plan's unit tests, plus the overshoot of an arm.
        for joint in 0..7 {
            let (least, most, last) = moved.joint(joint);
            assert!(least > -0.37 && most < 0.37, "{robot}: {least} {most}");
            assert!(last.abs() < 0.2, "{robot}: back, then 5 cm up: {last}");
        }
        let text = std::fs::read_to_string(&file).expect("it was saved");
        std::fs::remove_file(&file).expect("it is ours");
        let found: Identified = serde_json::from_str(&text).expect("as it was written");
        for joint in found.joints {
            assert!(joint.friction.value < 0.2, "{robot}: {found}");
        }
        assert!(found.load.mass.value.abs() < 0.1, "{robot}: {found}");
    }
}

#[test]
fn joint_generators_swing_three_joints_and_bring_them_back() {
    for generator in ["joint-positions", "joint-velocities"] {
        let scene = Scene::default();
        on_both("generators", &[generator], &scene, |robot, said, path| {
            succeeded(robot, said, path);
            for joint in 0..7 {
                let far = if [3, 4, 6].contains(&joint) { 0.2 } else { 0.0 };
                let what = format!("{robot}, {generator}: joint {joint}");
                is_about(&what, path.joint(joint), (0.0, far, 0.0), 5e-3);
            }
        });
    }
}

#[test]
fn cartesian_generators_move_the_hand_along_an_axis_and_back() {
    for (generator, axis, way) in [
        ("cartesian-pose", 2, -0.06),
        ("cartesian-velocities", 1, 0.06),
    ] {
        let scene = Scene::default();
        on_both("generators", &[generator], &scene, |robot, said, path| {
            succeeded(robot, said, path);
            for other in 0..3 {
                let way: f64 = if other == axis { way } else { 0.0 };
                let what = format!("{robot}, {generator}: axis {other}");
                is_about(
                    &what,
                    path.hand(other),
                    (way.min(0.0), way.max(0.0), 0.0),
                    2e-3,
                );
            }
        });
    }
}

#[test]
fn joint_impedance_follows_the_circle() {
    on_both(
        "joint_impedance",
        &[],
        &Scene::default(),
        |robot, said, path| {
            succeeded(robot, said, path);
            // The springs are soft: the remaining friction causes errors of some millimetres.
            is_about(robot, path.hand(0), (0.0, 0.0, 0.0), 5e-3);
            is_about(robot, path.hand(1), (-0.05, 0.05, 0.0), 5e-3);
            is_about(robot, path.hand(2), (0.0, 0.1, 0.0), 5e-3);
        },
    );
}

#[test]
fn cartesian_impedance_yields_by_its_stiffness_in_both_ways() {
    let scene = Scene {
        events: vec![(|_, time| time > 500, Event::PushHand([0.0, 9.0, 0.0], 1500))],
        ..Scene::default()
    };
    for way in ["callback", "active"] {
        let arguments = [way, "--seconds", "4"];
        on_both(
            "cartesian_impedance",
            &arguments,
            &scene,
            |robot, said, path| {
                succeeded(robot, said, path);
                // 9 N against 300 N/m.
                let what = format!("{robot}, {way}");
                is_about(&what, path.hand(1), (0.0, 0.03, 0.0), 4e-3);
                is_about(&what, path.hand(2), (0.0, 0.0, 0.0), 4e-3);
            },
        );
    }
}

#[test]
fn figure_eight_has_its_stated_size_and_begins_and_ends_at_rest() {
    let scene = Scene::default();
    on_both(
        "figure_eight",
        &["--laps", "3"],
        &scene,
        |robot, said, path| {
            succeeded(robot, said, path);
            is_about(robot, path.hand(0), (0.0, 0.0, 0.0), 2e-3);
            is_about(robot, path.hand(1), (-0.08, 0.08, 0.0), 2e-3);
            is_about(robot, path.hand(2), (-0.04, 0.04, 0.0), 2e-3);
        },
    );
}

#[test]
fn virtual_floor_stops_the_hand_releases_it_and_keeps_the_elbow() {
    let scene = Scene {
        events: vec![
            (|_, time| time > 500, Event::SwingElbow(4.0, 500)),
            (
                |_, time| time > 3000,
                Event::PushHand([0.0, 0.0, -10.0], 1500),
            ),
            (
                |_, time| time > 5000,
                Event::PushHand([0.0, 0.0, 4.0], 1000),
            ),
        ],
        ..Scene::default()
    };
    let arguments = ["--below", "0.05", "--seconds", "8"];
    on_both("virtual_floor", &arguments, &scene, |robot, said, path| {
        succeeded(robot, said, path);
        let (lowest, highest, _) = path.hand(2);
        // 10 N compress the spring of 2000 N/m by 5 mm, and at first the hand arrives with some
        // speed.
        assert!((-0.07..-0.054).contains(&lowest), "{robot}: {lowest}");
        assert!(
            highest > 0.0,
            "{robot}: the floor held the hand at {highest}"
        );
        let (_, swung, left) = path.elbow();
        assert!(swung > 0.05, "{robot}: the elbow went {swung} rad");
        assert!(
            left.abs() < 0.02,
            "{robot}: the elbow is {left} rad from its posture"
        );
    });
}

#[test]
fn link_test_reports_by_its_exit_code() {
    for (good, usable, code) in [("0", "0", 0), ("1.01", "0", 3), ("1.01", "1.01", 4)] {
        let arguments = ["--seconds", "1.5", "--good", good, "--usable", usable];
        let scene = Scene::default();
        on_both("link_test", &arguments, &scene, |robot, said, path| {
            assert_eq!(said.code, Some(code), "{robot}: {said:?}");
            assert!(
                said.stdout.contains("success rate, min "),
                "{robot}: {said:?}"
            );
            for axis in 0..3 {
                is_about(robot, path.hand(axis), (0.0, 0.0, 0.0), 5e-3);
            }
        });
    }
}

#[test]
fn recover_explains_a_reflex_and_moves_on_after_it() {
    on_both(
        "recover",
        &["--provoke"],
        &Scene::default(),
        |robot, said, path| {
            assert_eq!(said.code, Some(0), "{robot}: {said:?}");
            assert!(
            said.stdout.contains(
                "motion aborted by reflex! [\"joint_motion_generator_acceleration_discontinuity\"]"
            ),
            "{robot}: {said:?}"
        );
            assert_eq!(path.last().robot_mode, RobotMode::Idle, "{robot}");
            is_about(robot, path.joint(6), (0.0, 0.3, 0.3), 5e-3);
        },
    );
}

/// Runs the example with a robot of each kind in these scenes.
fn two_robots(scenes: [Scene; 2]) -> (Said, [MeasuredPath; 2]) {
    let arms = Arm::in_step(scenes);
    let [one, other] = arms.each_ref().map(|arm| arm.address.as_str());
    let said = run(
        "two_robots",
        &[one, other, "--realtime", "ignore", "--yes"],
        "",
    );
    (said, arms.map(Arm::stop))
}

#[test]
fn two_robots_swing_at_the_same_time() {
    let (said, [one, other]) = two_robots([Scene::default(), Scene::default()]);
    succeeded("one", &said, &one);
    succeeded("other", &said, &other);
    is_about("one", one.joint(0), (0.0, 0.3, 0.0), 5e-3);
    is_about("other", other.joint(0), (-0.3, 0.0, 0.0), 5e-3);
    let passed = [&one, &other].map(|arm| arm.first(|state| state.q[0].abs() > 0.15));
    let [Some(one), Some(other)] = passed else {
        panic!("they have swung");
    };
    let apart = one.max(other) - one.min(other);
    assert!(apart <= 2 * SAMPLE, "{apart} ms apart");
}

#[test]
fn neither_of_two_robots_continues_without_the_other() {
    // The other robot must not be far ahead when the program receives the reflex.
    let patient = Scene {
        on_the_wall: true,
        ..Scene::default()
    };
    let tripped = Scene {
        events: vec![(
            |state, _| state.q[0] > 0.15,
            Event::Trip(RobotError::CartesianReflex),
        )],
        ..patient.clone()
    };
    let (said, [one, other]) = two_robots([tripped, patient]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.stderr.contains("cartesian_reflex"), "{said:?}");
    assert_eq!(one.last().robot_mode, RobotMode::Reflex);
    // Halfway when the other robot tripped, and a second before its turning point.
    assert_eq!(other.last().robot_mode, RobotMode::Idle);
    let (farthest, _, left) = other.joint(0);
    assert!((-0.301..-0.12).contains(&left), "stopped at {left}");
    assert!(
        left - farthest < 0.02,
        "went on to {farthest}, and then to {left}"
    );
}

#[test]
fn with_an_address_nothing_moves_before_the_confirmation() {
    let elsewhere = || {
        let mut scene = Scene::default();
        scene.q[0] += 0.1;
        scene
    };
    for (input, code) in [("", 1), ("\n", 0)] {
        let arm = Arm::start("fr3", elsewhere());
        let arguments = [arm.address.as_str(), "--realtime", "ignore"];
        let said = run("move_to_ready", &arguments, input);
        let path = arm.stop();
        assert_eq!(said.code, Some(code), "{said:?}");
        assert!(said.stdout.contains("user stop"), "{said:?}");
        let moved = path.first(|state| state.robot_mode == RobotMode::Move);
        assert_eq!(moved.is_some(), code == 0, "{said:?}");
    }
}
