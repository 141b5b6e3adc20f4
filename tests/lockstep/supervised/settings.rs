//! Settings of a program at a robot, across connections. The harness checks at the start of each
//! motion that the robot has them.

use std::time::Duration;

use franka_lockstep::{Lockstep, Supervised, shows};
use franka_model::{READY, RobotKind};
use franka_proto::{CollisionBehavior, Command, Load, Request};
use franka_rt::lifecycle::{MotionError, Unready};
use franka_rt::session::Target;
use franka_rt::supervision::{Answer, Backoff, Condition, EventKind, Policy};

const NOT_SET: Condition = Condition::Unready(Unready::NotConfigured(Command::SetLoad));
const CONFIGURING: Condition = Condition::Unready(Unready::Configuring);

fn robot() -> Supervised {
    let policy = Policy::default().reconnect(Backoff {
        first: Duration::from_millis(20),
        most: Duration::from_millis(100),
        jitter: 0.0,
    });
    let policy = policy.motions_wait(Duration::from_secs(60));
    Supervised::new(Lockstep::config_of(RobotKind::Fr3), policy)
}

/// A declared load that does not exist, so light that the arm still arrives.
pub(super) fn load(mass: f64) -> Request {
    Request::SetLoad(Load {
        m_load: mass,
        F_x_Cload: [0.0, 0.0, 0.05],
        I_load: [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1e-3],
    })
}

pub(super) fn end_effector(z: f64) -> Request {
    let mut frame = [0.0; 16];
    for place in [0, 5, 10, 15] {
        frame[place] = 1.0;
    }
    frame[14] = z;
    Request::SetNEToEE(frame)
}

fn run(robot: &mut Supervised, milliseconds: u64) {
    for _ in 0..milliseconds {
        robot.tick();
    }
}

/// Sets these, one after the other, and waits for the answers.
fn set(robot: &mut Supervised, requests: &[Request]) -> Vec<Answer> {
    requests.iter().for_each(|request| robot.set(*request));
    while robot.is_setting() {
        robot.tick();
    }
    let answers = std::mem::take(&mut robot.answers);
    answers.into_iter().map(|(_, answer)| answer).collect()
}

fn wait(robot: &mut Supervised, condition: Condition) {
    let end = robot.now() + 8000;
    while robot.health().condition != condition {
        assert!(robot.now() < end, "{:?}", robot.health());
        robot.tick();
    }
}

/// Moves once the robot accepts motions, and checks that the robot has these settings.
fn moves_with(robot: &mut Supervised, settings: &[Request]) {
    wait(robot, Condition::Ready);
    let state = *robot.robot().state();
    for request in settings {
        assert!(shows(request, &state), "{request:?}");
    }
    let q = READY.map(|q| q + 0.01);
    let goal = robot.submit(Target::Joints(q.into()));
    while !robot.outcomes.contains_key(&goal) {
        robot.tick();
    }
    assert!(robot.outcomes[&goal].is_ok(), "{:?}", robot.outcomes[&goal]);
    run(robot, 100);
}

fn restart(robot: &mut Supervised) {
    robot.kill();
    run(robot, 30);
    robot.restart();
}

fn refused(robot: &mut Supervised) -> MotionError {
    let goal = robot.submit(Target::Joints(READY.into()));
    robot.tick();
    robot.outcomes[&goal].clone().expect_err("no motion")
}

fn not_ready(why: Unready) -> MotionError {
    let waited = Duration::ZERO;
    MotionError::NotReady { why, waited }
}

#[test]
fn settings_hold_at_a_robot_restarted_between_and_after_them() {
    let mut robot = robot();
    let thresholds = Request::SetCollisionBehavior(CollisionBehavior::careful());
    assert_eq!(
        set(&mut robot, &[load(0.05), thresholds]),
        [Answer::Taken, Answer::Taken]
    );
    moves_with(&mut robot, &[load(0.05)]);
    restart(&mut robot);
    wait(&mut robot, Condition::Ready);
    assert_eq!(set(&mut robot, &[end_effector(0.05)]), [Answer::Taken]);
    for _ in 0..2 {
        restart(&mut robot);
        // The robot has its own values until it is set up.
        wait(&mut robot, CONFIGURING);
        let restarted = *robot.robot().state();
        assert!(!shows(&load(0.05), &restarted) && !shows(&end_effector(0.05), &restarted));
        moves_with(&mut robot, &[load(0.05), end_effector(0.05)]);
    }
}

#[test]
fn motion_during_the_configuring_waits_for_its_end() {
    let mut robot = robot();
    set(&mut robot, &[load(0.05), end_effector(0.05)]);
    restart(&mut robot);
    wait(&mut robot, CONFIGURING);
    let goal = robot.submit(Target::Joints(READY.into()));
    while !robot.outcomes.contains_key(&goal) {
        robot.tick();
    }
    assert!(robot.outcomes[&goal].is_ok(), "{:?}", robot.outcomes[&goal]);
}

#[test]
fn settings_hold_at_a_robot_restarted_while_they_are_made() {
    for after in 0..12 {
        let mut robot = robot();
        set(&mut robot, &[load(0.02)]);
        robot.set(load(0.05));
        robot.set(end_effector(0.05));
        run(&mut robot, after);
        restart(&mut robot);
        moves_with(&mut robot, &[load(0.05), end_effector(0.05)]);
    }
}

#[test]
fn robot_restarted_while_it_is_configured_is_configured_again() {
    for after in 0..12 {
        let mut robot = robot();
        set(&mut robot, &[load(0.05), end_effector(0.05)]);
        restart(&mut robot);
        wait(&mut robot, CONFIGURING);
        run(&mut robot, after);
        restart(&mut robot);
        moves_with(&mut robot, &[load(0.05), end_effector(0.05)]);
    }
}

#[test]
fn newest_of_two_settings_of_a_kind_holds() {
    for after in 0..8 {
        let mut robot = robot();
        robot.set(load(0.02));
        robot.set(load(0.05));
        run(&mut robot, after);
        restart(&mut robot);
        moves_with(&mut robot, &[load(0.05)]);
    }
    // A refused setting does not count.
    let mut robot = robot();
    let answers = set(&mut robot, &[load(0.02), load(50.0)]);
    assert!(
        matches!(answers[..], [Answer::Taken, Answer::Refused { .. }]),
        "{answers:?}"
    );
    moves_with(&mut robot, &[load(0.02)]);
    restart(&mut robot);
    moves_with(&mut robot, &[load(0.02)]);
}

#[test]
fn setting_during_the_configuring_is_not_undone() {
    for after in 0..8 {
        let mut robot = robot();
        set(&mut robot, &[load(0.02), end_effector(0.05)]);
        restart(&mut robot);
        wait(&mut robot, CONFIGURING);
        run(&mut robot, after);
        robot.set(load(0.05));
        while robot.is_setting() {
            robot.tick();
        }
        moves_with(&mut robot, &[load(0.05), end_effector(0.05)]);
    }
}

#[test]
fn setting_whose_answer_was_lost_is_set_after_the_reconnect() {
    for before in [None, Some(load(0.02))] {
        let mut robot = robot();
        set(&mut robot, before.as_slice());
        robot.set(load(0.05));
        robot.lose_answers();
        run(&mut robot, 1);
        let (_, answer) = robot.answers.pop().expect("an answer");
        assert!(matches!(answer, Answer::Unknown { .. }), "{answer:?}");
        moves_with(&mut robot, &[load(0.05)]);
        restart(&mut robot);
        moves_with(&mut robot, &[load(0.05)]);
    }
}

#[test]
fn robot_that_does_not_answer_a_setting_takes_no_motion() {
    let mut robot = robot();
    robot.lose_replies();
    let answers = set(&mut robot, &[load(0.05)]);
    assert!(
        matches!(answers[..], [Answer::Unknown { .. }]),
        "{answers:?}"
    );
    assert_eq!(robot.health().condition, CONFIGURING);
    wait(&mut robot, NOT_SET);
    let why = Unready::NotConfigured(Command::SetLoad);
    assert_eq!(refused(&mut robot), not_ready(why));
    robot.mend(true);
    moves_with(&mut robot, &[load(0.05)]);
}

#[test]
fn robot_that_refuses_a_setting_again_takes_no_motion() {
    let mut robot = robot();
    set(&mut robot, &[load(0.05), end_effector(0.05)]);
    robot.config.unpublished.setter_bounds.mass = 0.03;
    restart(&mut robot);
    wait(&mut robot, CONFIGURING);
    let waiting = robot.submit(Target::Joints(READY.into()));
    wait(&mut robot, NOT_SET);
    let why = Unready::NotConfigured(Command::SetLoad);
    let outcome = robot.outcomes[&waiting].clone();
    assert!(
        matches!(outcome, Err(MotionError::NotReady { why: it, .. }) if it == why),
        "{outcome:?}"
    );
    let told: Vec<_> = robot.events.iter().map(|event| &event.kind).collect();
    let is_told = |kind: &&EventKind| {
        matches!(kind, EventKind::NotConfigured { command: Command::SetLoad, text }
            if text.contains("InvalidArgument"))
    };
    assert!(told.iter().any(is_told), "{told:?}");
    run(&mut robot, 1000);
    assert_eq!(refused(&mut robot), not_ready(why));
    // Another refused setting changes nothing, and a setting of another kind is no help.
    set(&mut robot, &[load(0.04), end_effector(0.06)]);
    run(&mut robot, 100);
    assert_eq!(robot.health().condition, NOT_SET);
    assert_eq!(set(&mut robot, &[load(0.02)]), [Answer::Taken]);
    moves_with(&mut robot, &[load(0.02), end_effector(0.06)]);
}

#[test]
fn user_stop_while_configuring_holds_motions_until_done() {
    for (after, long) in [(0, 1), (0, 500), (1, 1), (1, 500), (2, 2), (3, 500)] {
        let mut robot = robot();
        set(&mut robot, &[load(0.05), end_effector(0.05)]);
        robot.config.unpublished.setters.user_stopped = false;
        restart(&mut robot);
        wait(&mut robot, CONFIGURING);
        run(&mut robot, after);
        robot.robot().press_user_stop(true);
        for _ in 0..long {
            robot.tick();
            let goal = robot.submit(Target::Joints(READY.into()));
            assert!(!robot.is_under_way(goal) || shows(&load(0.05), robot.state()));
        }
        robot.robot().press_user_stop(false);
        run(&mut robot, 300);
        moves_with(&mut robot, &[load(0.05), end_effector(0.05)]);
    }
}
