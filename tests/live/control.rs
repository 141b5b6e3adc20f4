//! The user's own control functions, and sparse targets, over sockets.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_async::control::{
    AbortReason, AsynchronousOptions, CartesianPose, CartesianVelocities, Finish, JointPositions,
    JointVelocities, Next, TargetStatus, Torques,
};
use franka_async::error::{CommandError, GoalError};
use franka_async::state::{RobotMode, RobotState};
use franka_async::{Engage, MotionError, Pose, Robot};
use franka_proto::{MoveControllerMode, RequestError, RobotError, Version};
use franka_sim::{Running, Sim, Tool};
use tokio::time::timeout;
use tracing::Level;

use crate::telemetry::{listen, told};
use crate::{SOON, alone, at_the_clients_pace, by_the_clock, under_way, until};

/// A simulated robot of each kind with its hand, at the pace of the client's answers, and a handle
/// on it.
pub(crate) async fn each() -> Vec<(Robot, Running)> {
    let mut robots = Vec::new();
    for sim in [Sim::fr3().ideal(), Sim::fer().ideal()] {
        robots.push(at_the_clients_pace(sim.tool(Tool::hand())).await);
    }
    robots
}

/// A smooth path from 0 to 1 within `seconds`, at rest at both ends, and its slope per second.
fn smooth(t: f64, seconds: f64) -> (f64, f64) {
    use std::f64::consts::PI;
    let phase = (t / seconds).min(1.0);
    let value = phase - (2.0 * PI * phase).sin() / (2.0 * PI);
    (value, (1.0 - (2.0 * PI * phase).cos()) / seconds)
}

/// The command of a motion over `seconds`, computed by `at` from the time; the last one afterwards.
fn timed<C: Finish>(
    seconds: f64,
    mut at: impl FnMut(&RobotState, f64) -> C + Send + 'static,
) -> impl FnMut(&RobotState, Duration) -> Next<C> + Send + 'static {
    let mut time = 0.0;
    move |state, step| {
        time += step.as_secs_f64();
        let command = at(state, time);
        if time >= seconds {
            command.finish()
        } else {
            command.into()
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn each_generator_takes_the_arm_where_the_function_says() {
    let _alone = alone();
    for (robot, _sim) in each().await {
        let before = robot.state();
        let mut start = None;
        let report = robot
            .control_joint_positions(timed(1.5, move |state, time| {
                let mut q = *start.get_or_insert(state.q_d);
                q[0] += 0.1 * smooth(time, 1.2).0;
                JointPositions(q)
            }))
            .await
            .unwrap();
        assert!(report.duration >= Duration::from_millis(1500), "{report:?}");
        let moved = robot.state().q[0] - before.q[0];
        assert!((moved - 0.1).abs() < 5e-3, "{moved}");

        robot
            .control_joint_velocities(timed(1.5, |_, time| {
                let mut dq = [0.0; 7];
                dq[0] = -0.1 * smooth(time, 1.2).1 * f64::from(u8::from(time < 1.2));
                JointVelocities(dq)
            }))
            .controller(MoveControllerMode::CartesianImpedance)
            .await
            .unwrap();
        let moved = robot.state().q[0] - before.q[0];
        assert!(moved.abs() < 5e-3, "{moved}");

        let mut start = None;
        let from = robot.pose();
        robot
            .control_cartesian_pose(timed(1.5, move |state, time| {
                let mut pose = *start.get_or_insert(state.O_T_EE_c);
                pose[14] += 0.04 * smooth(time, 1.2).0;
                CartesianPose {
                    O_T_EE: pose,
                    elbow: None,
                }
            }))
            .await
            .unwrap();
        let up = robot.pose().translation.z - from.translation.z;
        assert!((up - 0.04).abs() < 2e-3, "{up}");

        robot
            .control_cartesian_velocities(timed(1.5, |_, time| {
                let mut twist = [0.0; 6];
                twist[2] = -0.04 * smooth(time, 1.2).1 * f64::from(u8::from(time < 1.2));
                CartesianVelocities {
                    O_dP_EE: twist,
                    elbow: None,
                }
            }))
            .await
            .unwrap();
        let up = robot.pose().translation.z - from.translation.z;
        assert!(up.abs() < 2e-3, "{up}");
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn torques_alone_and_beside_a_generator() {
    let _alone = alone();
    for (robot, _sim) in each().await {
        // A damped spring to the arm's position.
        let spring = |state: &RobotState, q: &[f64; 7]| {
            Torques(std::array::from_fn(|i| {
                80.0 * (q[i] - state.q[i]) - 10.0 * state.dq[i]
            }))
        };
        let calls = Arc::new(AtomicU64::new(0));
        let counted = calls.clone();
        let mut start = None;
        let report = robot
            .control_torques(timed(0.5, move |state, _| {
                counted.fetch_add(1, Ordering::Relaxed);
                let start = *start.get_or_insert(state.q);
                spring(state, &start)
            }))
            .await
            .unwrap();
        let calls = calls.load(Ordering::Relaxed);
        assert_eq!((report.lost_states, report.skipped_states), (0, 0));
        assert!((499..=502).contains(&calls), "{calls} calls");

        let before = robot.state().q[0];
        let mut start = None;
        robot
            .control_joint_velocities(timed(1.5, |_, time| {
                let mut dq = [0.0; 7];
                dq[0] = 0.1 * smooth(time, 1.2).1 * f64::from(u8::from(time < 1.2));
                JointVelocities(dq)
            }))
            .with_torques(move |state: &RobotState, _| {
                // Follows the generator's reference; the others stay.
                let mut q = *start.get_or_insert(state.q);
                q[0] = state.q_d[0];
                spring(state, &q)
            })
            .await
            .unwrap();
        let moved = robot.state().q[0] - before;
        assert!((moved - 0.1).abs() < 0.02, "{moved}");
        robot.shutdown().await;
    }
}

/// A captured value whose drop panics.
struct Bad;

impl Drop for Bad {
    fn drop(&mut self) {
        panic!("a bug of the user's, where it is freed");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn panicking_drop_of_captured_values_ends_nothing_else() {
    let _alone = alone();
    listen();
    for (robot, _sim) in each().await {
        let mut bad = Some(Bad);
        let held = robot.control_joint_velocities(move |_, _| {
            assert!(bad.as_mut().is_some());
            JointVelocities([0.0; 7])
        });
        let held = tokio::spawn(held.into_future());
        under_way(&robot).await;
        // A refused function is freed, too.
        let bad = Bad;
        let refused = robot.control_torques(move |_, _| {
            let _ = &bad;
            Torques([0.0; 7])
        });
        assert_eq!(refused.await, Err(MotionError::Busy));
        robot.stop().await.expect("the arm rests");
        assert_eq!(held.await.unwrap(), Err(MotionError::Stopped));

        let (bad, mut calls) = (Bad, 0);
        let floating = robot.control_torques(move |_, _| {
            let _ = &bad;
            calls += 1;
            Torques([0.0; 7]).finish_if(calls == 50)
        });
        floating.await.expect("it has finished");
        let bad = Bad;
        let failing = robot.control_joint_velocities(move |_, _| -> JointVelocities {
            let _ = &bad;
            panic!("a bug of the user's, where it runs");
        });
        let text = "the control function panicked: a bug of the user's, where it runs";
        assert_eq!(failing.await.unwrap_err().to_string(), text);
        robot.recover().await.unwrap();

        let bad = Bad;
        let engage = Engage::default().observer(move |_, _| {
            let _ = &bad;
        });
        let arm = robot.engage(engage).await.expect("the bridge lives on");
        arm.disengage().await.unwrap();
        let up = Pose::translation(0.0, 0.0, 0.02) * robot.pose();
        robot.move_to(up).await.expect("the bridge lives on");
        robot.shutdown().await;
        let warned = told("panic");
        let text = "a bug of the user's, where it is freed";
        assert!(warned.iter().all(|told| told.level == Level::WARN));
        assert!(warned.iter().all(|told| told.fields["panic"] == text));
        assert_eq!(warned.len(), 5, "each is told once");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn program_has_the_arm_alone_until_stopped_or_dropped() {
    let _alone = alone();
    for (robot, _sim) in each().await {
        let turning =
            || robot.control_joint_velocities(|_: &RobotState, _| JointVelocities([0.0; 7]));
        let running = tokio::spawn(turning().into_future());
        let mut states = robot.states();
        let moves = |state: &RobotState| state.robot_mode == RobotMode::Move;
        states.wait_for(moves).await.unwrap();

        let busy = "libfranka robot: Cannot perform this operation while another control or read operation is running.";
        assert_eq!(turning().await.unwrap_err().to_string(), busy);
        let goal = robot.move_to(robot.pose()).await.unwrap_err();
        assert_eq!(goal, MotionError::Busy);

        robot.stop().await.expect("the arm rests");
        assert_eq!(running.await.unwrap(), Err(MotionError::Stopped));
        assert_eq!(robot.state().robot_mode, RobotMode::Idle);

        let (dropped, alive) = tokio::sync::oneshot::channel::<()>();
        let mut owned = Some(dropped);
        let holding = robot.control_joint_velocities(move |_: &RobotState, _| {
            assert!(owned.is_some());
            owned.as_mut();
            JointVelocities([0.0; 7])
        });
        tokio::select! {
            outcome = holding.into_future() => panic!("{outcome:?}"),
            () = under_way(&robot) => {}
        }
        let freed = tokio::time::timeout(SOON, alive).await;
        assert!(
            freed.is_ok_and(|end| end.is_err()),
            "the function is dropped with its motion"
        );
        states.wait_for(|state| !moves(state)).await.unwrap();
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_reflex_comes_back_with_the_cycles_that_led_to_it() {
    let _alone = alone();
    for (robot, _sim) in each().await {
        let mut calls = 0;
        let stepping = robot.control_joint_velocities(move |_: &RobotState, _| {
            calls += 1;
            let mut dq = [0.0; 7];
            dq[3] = if calls < 100 { 0.0 } else { 0.5 };
            JointVelocities(dq)
        });
        let error = stepping
            .limit_rate(false)
            .cutoff_frequency(1000.0)
            .await
            .unwrap_err();
        let control = error.control().expect("the robot ended it");
        assert!(control.is_reflex());
        assert!(error.to_string().starts_with(
            "libfranka: Move command aborted: motion aborted by reflex! [\"joint_motion_generator_"
        ), "{error}");
        assert_eq!(control.log.len(), 50);
        let step = control
            .log
            .iter()
            .find(|entry| entry.command.dq_c[3] == 0.5);
        let step = step.expect("the cycle that provoked it is in the log");
        assert_eq!(step.state.message_id, step.command.message_id + 1);
        let last = control.log.iter().next_back().unwrap();
        assert!(
            last.state
                .reflex_reason
                .contains(RobotError::JointMotionGeneratorVelocityDiscontinuity)
                || last
                    .state
                    .reflex_reason
                    .contains(RobotError::JointMotionGeneratorAccelerationDiscontinuity),
            "{error}"
        );
        assert_eq!(control.log.to_csv().lines().count(), 51);
        robot.recover().await.unwrap();
        robot.shutdown().await;
    }
}

/// The book's page for programs of libfranka states this of a simulated arm that is not ideal.
#[tokio::test(flavor = "multi_thread")]
async fn motion_begins_at_the_desired_not_measured_position() {
    let _alone = alone();
    for sim in [Sim::fr3(), Sim::fer()] {
        let (robot, _sim) = at_the_clients_pace(sim).await;
        let limited = robot.version() == Version::V10;
        for (is_measured, limit_rate) in [(false, false), (true, false), (true, limited)] {
            let mut start = None;
            let stands = robot.control_joint_positions(timed(0.5, move |state, _| {
                let q = if is_measured { state.q } else { state.q_d };
                JointPositions(*start.get_or_insert(q))
            }));
            let ended = stands.limit_rate(limit_rate).await;
            let Err(error) = ended else {
                assert!(!is_measured, "with limit_rate({limit_rate})");
                continue;
            };
            let steps = RobotError::JointMotionGeneratorAccelerationDiscontinuity;
            let control = error.control().expect("the robot ended it");
            assert!(
                is_measured && control.failure.reflex_reason.contains(steps),
                "{error}"
            );
            robot.recover().await.unwrap();
        }
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_robot_itself_goes_from_target_to_target() {
    let _alone = alone();
    // The motion needs no commands, so the robot cannot wait for them.
    let sims = [Sim::fr3().ideal(), Sim::fer().ideal()];
    let [fr3, fer] = sims.map(|sim| by_the_clock(sim.tool(Tool::hand())));
    let (robot, sim) = &fr3.await;
    let (fer, _sim) = &fer.await;
    let usual = AsynchronousOptions::default();
    for (goal_tolerance, velocity, text) in [
        (
            -1.0,
            0.5,
            "goal tolerance is -1 rad, expected between 0.000001 and 20 rad",
        ),
        (
            f64::NAN,
            0.5,
            "goal tolerance is NaN rad, expected between 0.000001 and 20 rad",
        ),
        (
            f64::INFINITY,
            0.5,
            "goal tolerance is inf rad, expected between 0.000001 and 20 rad",
        ),
        (
            1e-3,
            -1.0,
            "maximum velocity of joint 3 is -1 rad/s, expected between 0.000001 and 2.62 rad/s",
        ),
        (
            1e-3,
            100.0,
            "maximum velocity of joint 3 is 100 rad/s, expected between 0.000001 and 2.62 rad/s",
        ),
        (
            1e-3,
            f64::NAN,
            "maximum velocity of joint 3 is NaN rad/s, expected between 0.000001 and 2.62 rad/s",
        ),
    ] {
        let mut maximum_joint_velocities = usual.maximum_joint_velocities;
        maximum_joint_velocities[2] = velocity;
        let options = AsynchronousOptions {
            maximum_joint_velocities,
            goal_tolerance,
        };
        let refused = robot.asynchronous_joint_positions(options).await;
        assert_eq!(refused.unwrap_err().to_string(), text);
    }
    let control = robot
        .asynchronous_joint_positions(AsynchronousOptions::default())
        .await
        .unwrap();
    assert_eq!(control.status(), TargetStatus::Idle);
    let mut q = robot.state().q_d;
    q[0] += 0.5;
    control.set_target(q).unwrap();
    until(robot, |_| control.status() == TargetStatus::Executing).await;
    q[1] += 0.1;
    control.set_target(q).unwrap();
    control.reached().await.unwrap();
    assert!((robot.state().q[1] - q[1]).abs() < 5e-3);
    let nothing = control.set_target([f64::NAN; 7]).unwrap_err();
    assert_eq!(nothing.to_string(), "Commanding value is infinite or NaN.");
    control.finish().await.unwrap();

    let control = robot
        .asynchronous_joint_positions(AsynchronousOptions::default())
        .await
        .unwrap();
    sim.with(|robot| robot.trip(RobotError::CartesianReflex))
        .await
        .expect("the simulator runs");
    let error = control.reached().await.unwrap_err();
    assert!(
        error.control().is_some_and(|control| control.is_reflex()),
        "{error}"
    );
    assert_eq!(control.status(), TargetStatus::Aborted(AbortReason::Ended));
    drop(control);

    let error = fer
        .asynchronous_joint_positions(AsynchronousOptions::default())
        .await
        .unwrap_err();
    assert!(
        matches!(
            error,
            MotionError::Unsupported(RequestError::Unsupported { .. })
        ),
        "{error}"
    );
    for robot in [robot, fer] {
        robot.shutdown().await;
    }
}

/// The robot ends the motion meanwhile. Its states are not read.
#[tokio::test(flavor = "multi_thread")]
async fn a_function_that_does_not_return_is_named_and_not_the_link() {
    let _alone = alone();
    let (robot, sim) = by_the_clock(Sim::fr3().ideal()).await;
    let (enter, entered) = tokio::sync::oneshot::channel();
    let (release, held) = std::sync::mpsc::channel::<()>();
    let (mut enter, mut calls) = (Some(enter), 0);
    let floating = robot.control_torques(move |_, _| {
        calls += 1;
        if calls == 10 {
            enter.take().expect("once").send(()).unwrap();
            let _ = held.recv();
        }
        Torques([0.0; 7])
    });
    let floating = tokio::spawn(floating.into_future());
    entered.await.unwrap();
    sim.with(|robot| robot.trip(RobotError::JointReflex))
        .await
        .unwrap();
    let error = floating.await.unwrap().unwrap_err();
    assert!(matches!(error, MotionError::Hung { .. }), "{error:?}");
    let silent = robot.recover().await.unwrap_err();
    assert!(matches!(silent, CommandError::LinkLost { .. }), "{silent}");
    for _ in 0..2 {
        let error = robot.move_to(robot.pose()).await.unwrap_err();
        assert!(matches!(error, MotionError::Hung { .. }), "{error:?}");
    }
    drop(release);
    // The robot has recovered, as requested. Older states may be dropped unread.
    until(&robot, |state| state.robot_mode == RobotMode::Idle).await;
    robot.recover().await.unwrap();
    robot.move_to(robot.pose()).await.unwrap();
    robot.shutdown().await;
}

#[test]
fn stuck_function_blocks_neither_shutdown_nor_exit() {
    let _alone = alone();
    let (forever, held) = std::sync::mpsc::channel::<()>();
    let runtime = tokio::runtime::Runtime::new().unwrap();
    runtime.block_on(async {
        let (robot, _sim) = by_the_clock(Sim::fr3().ideal()).await;
        let (enter, entered) = tokio::sync::oneshot::channel();
        let mut enter = Some(enter);
        let stuck = robot.control_torques(move |_, _| {
            if let Some(enter) = enter.take() {
                enter.send(()).unwrap();
                let _ = held.recv();
            }
            Torques([0.0; 7])
        });
        let stuck = tokio::spawn(stuck.into_future());
        entered.await.unwrap();
        timeout(SOON, robot.shutdown()).await.expect("it ends");
        drop(stuck);
    });
    drop(runtime); // waits for its blocked threads
    drop(forever);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_external_controller_without_torques_is_refused() {
    let _alone = alone();
    let (robot, _sim) = by_the_clock(Sim::fr3().ideal()).await;
    let still = robot.control_joint_velocities(|_, _| JointVelocities([0.0; 7]).finish());
    let refused = still
        .controller(MoveControllerMode::ExternalController)
        .await;
    assert_eq!(refused, Err(GoalError::NoTorques.into()));
    robot.shutdown().await;
}
