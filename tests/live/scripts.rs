//! Programs without async.

use std::thread;
use std::time::Duration;

use franka_async::blocking::{Wait, WaitEach, targets};
use franka_async::control::{Finish, Torques};
use franka_async::error::{GoalError, Lapse, PoseError};
use franka_async::goal::{Deadman, Destination};
use franka_async::gripper::Gripper;
use franka_async::nalgebra::Translation3;
use franka_async::supervision::EventKind;
use franka_async::team::Team;
use franka_async::{Engage, MotionError, Offset, Pose, Robot};
use franka_sim::{Fingers, Running, Sim};
use franka_tests::PATIENCE;

use crate::{SOON, alone, at_the_clients_pace, long_way, simulated};

/// An FR3 that sticks and lags as real arms do.
fn realistic() -> (Robot, Running) {
    at_the_clients_pace(Sim::fr3()).wait()
}

#[test]
fn a_plain_thread_sends_targets_and_iterates_over_states() {
    let _alone = alone();
    let (robot, _sim) = realistic();
    let start = robot.pose();
    let (sender, targets) = targets(start);
    let following = robot.follow(targets);
    let following = thread::spawn(move || following.wait());
    let at = |step: u32| Pose::translation(0.0, 5e-5 * f64::from(step), 0.0) * start;
    let mut times = Vec::new();
    for (reading, step) in robot.state_stream().wait_each().zip(1..=1000) {
        times.push((reading.state.message_id, reading.missed));
        assert!(sender.send(at(step)), "the motion goes on");
    }
    drop(sender);
    following.join().unwrap().unwrap();
    let error = PoseError::between(&robot.pose(), &at(1000));
    assert!(error.translation < 2e-3, "{error:?}");
    for pair in times.windows(2) {
        assert_eq!(pair[1].0, pair[0].0 + 1 + pair[1].1, "each once, in order");
    }
    let mut states = robot.states().wait_each();
    assert!(states.next().is_some());
    robot.shutdown().wait();
    // Ends with the connection.
    states.for_each(drop);
}

#[test]
fn a_sender_whose_motion_has_ended_says_so() {
    let _alone = alone();
    let (robot, _sim) = simulated().wait();
    let (sender, targets) = targets(robot.pose());
    let late = robot.follow(targets).wait_for(Duration::from_millis(20));
    assert_eq!(late, None, "dropped, and so braked");
    assert!(!sender.send(robot.pose()));
    robot.shutdown().wait();
}

#[test]
fn a_plain_thread_hears_of_events_until_the_connection_ends() {
    let _alone = alone();
    let (robot, _sim) = simulated().wait();
    let events = robot.events();
    let listening = thread::spawn(move || {
        let kinds = events
            .wait_each()
            .map(|notification| notification.event.kind);
        kinds.collect::<Vec<_>>()
    });
    robot
        .move_by(Offset::base([0.0, 0.0, 0.02]))
        .wait()
        .unwrap();
    robot.shutdown().wait();
    drop(robot);
    let kinds = listening.join().unwrap();
    for wanted in ["MotionBegun", "MotionEnded", "Closed"] {
        let heard = |kind: &EventKind| format!("{kind:?}").starts_with(wanted);
        assert!(kinds.iter().any(heard), "{wanted} in {kinds:?}");
    }
}

/// A deadman, a hand, a control function, a team: each from a plain thread.
#[test]
fn plain_threads_can_use_deadman_hand_and_control() {
    let _alone = alone();
    let (robot, _sim) = realistic();
    let (deadman, monitor) = Deadman::new(Duration::from_millis(300));
    let arm = robot
        .engage(Engage::default().deadman(monitor))
        .wait()
        .unwrap();
    deadman.keep_alive();
    drop(deadman);
    let held = arm.move_by(Offset::base([0.0, 0.0, 0.05])).wait();
    assert_eq!(held, Err(MotionError::Held(Lapse::Deadman)));
    assert_eq!(arm.try_set(robot.pose()), held.map(|_| ()));
    arm.disengage().wait().unwrap();

    let mut time = Duration::ZERO;
    let report = robot.control_torques(move |_, step| {
        time += step;
        let none = Torques([0.0; 7]);
        if time < Duration::from_millis(200) {
            none.into()
        } else {
            none.finish()
        }
    });
    report.wait().unwrap();

    // Only one arm: it must not wait for cycles of another, which a busy machine may delay.
    let team = Team::engage_tolerating(SOON, [(&robot, Engage::default())]);
    let team = team.wait().unwrap();
    let up = Pose::translation(0.0, 0.0, 0.02) * robot.pose();
    let [outcome] = team.move_to([up]).wait();
    outcome.unwrap();
    drop(team);

    let sim = Sim::fr3()
        .hand(Fingers::new(), 0)
        .wait_for_commands(PATIENCE);
    let sim = sim.start().wait().unwrap();
    let gripper = Gripper::connect(sim.hand().unwrap().addr()).wait().unwrap();
    assert!(gripper.homing().wait().unwrap());
    let mut widths = gripper.states().wait_each().map(|state| state.width);
    assert!(widths.next().is_some_and(|width| width > 0.0));
    robot.shutdown().wait();
}

#[test]
fn a_plain_thread_waits_for_whatever_can_be_awaited() {
    let _alone = alone();
    let (robot, _sim) = simulated().wait();
    let start = robot.pose();
    let up = Pose::translation(0.0, 0.0, 0.02) * start;
    robot.move_to(up).wait().unwrap();
    assert!(PoseError::between(&robot.pose(), &up).translation < 1e-3);

    let late = long_way(&robot).wait_for(Duration::from_millis(1));
    assert_eq!(late, None, "dropped, and so braked");
    robot.stop().wait().unwrap();
    assert!(!robot.state().motion_running());
    robot.shutdown().wait();
    let closed = robot.move_to(up).wait().unwrap_err();
    assert!(
        matches!(closed, MotionError::ConnectionClosed { .. }),
        "{closed}"
    );
}

#[test]
fn goals_are_set_without_waiting_and_the_newest_counts() {
    let _alone = alone();
    let (robot, _sim) = simulated().wait();
    let start = robot.pose();
    let arm = robot.engage(Engage::default()).wait().unwrap();
    let at = |step: u32| Pose::translation(0.0, 0.02e-3 * f64::from(step), 0.0) * start;
    for step in 0..=2000 {
        arm.try_set(at(step)).unwrap();
    }
    // This goal is accepted in order, so the earlier ones have been accepted by then.
    arm.set(Offset::base(Translation3::identity()))
        .wait()
        .unwrap();
    arm.at_rest().wait().unwrap();
    let error = PoseError::between(&robot.pose(), &at(2000));
    assert!(error.translation < 1e-3, "{error:?}");

    let far = Pose::translation(5.0, 0.0, 0.0);
    for far in [
        Destination::from(far * start),
        Destination::position([3.0, 0.0, 0.0]),
        Offset::base(far).into(),
    ] {
        let refused = arm.try_set(far).unwrap_err();
        assert!(
            matches!(refused, MotionError::Goal(GoalError::Unreachable { .. })),
            "{refused}"
        );
    }
    let other = arm.clone();
    arm.disengage().wait().unwrap();
    assert_eq!(other.try_set(start), Err(MotionError::Disengaged));
    robot.shutdown().wait();
}
