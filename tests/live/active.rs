//! Active control: the cycle on a thread of the test's own.

use std::time::Duration;

use franka_async::control::{Active, Finish, JointVelocities, Torques};
use franka_async::error::ActiveError;
use franka_async::state::RobotMode;
use franka_async::{MotionError, Pose, Robot};
use franka_proto::{MoveControllerMode, RobotError};
use franka_rt::driver::LinkTimeout;

use crate::control::each;
use crate::{SOON, alone, simulated, under_way};

/// Runs `work` on a separate thread, as active control requires, and returns its result.
async fn on_a_thread<C: Send + 'static, T: Send + 'static>(
    control: Active<C>,
    work: impl FnOnce(Active<C>) -> T + Send + 'static,
) -> T {
    let thread = tokio::task::spawn_blocking(move || work(control));
    thread.await.expect("no panic")
}

/// Holds the arm with a damped spring for this many cycles, and then ends the motion.
fn hold(mut control: Active<Torques>, cycles: u64) -> Result<u64, ActiveError> {
    let mut start = None;
    let mut time = Duration::ZERO;
    for cycle in 1.. {
        let (state, step) = control.read_once()?;
        assert_eq!(step.is_zero(), cycle == 1, "cycle {cycle}");
        time += step;
        let start = *start.get_or_insert(state.q);
        let torques = Torques(std::array::from_fn(|joint| {
            60.0 * (start[joint] - state.q[joint]) - 8.0 * state.dq[joint]
        }));
        if cycle == cycles {
            let report = control.write_once(torques.finish())?;
            let report = report.expect("the last command waits for the end");
            assert!(report.duration >= time, "{report:?}");
            assert_eq!(control.read_once(), Err(ActiveError::Finished));
            let late = control.write_once(torques).unwrap_err();
            assert_eq!(late, ActiveError::Finished);
            return Ok(cycle);
        }
        assert_eq!(control.write_once(torques)?, None);
    }
    unreachable!("the cycles are counted")
}

#[tokio::test(flavor = "multi_thread")]
async fn a_thread_holds_the_arm_by_torques_and_hands_it_back() {
    let _alone = alone();
    for (robot, _sim) in each().await {
        for _ in 0..2 {
            let control = robot.active_torques().await.unwrap();
            let held = on_a_thread(control, |control| hold(control, 300)).await;
            assert_eq!(held, Ok(300));
            assert_eq!(robot.state().robot_mode, RobotMode::Idle);
        }
        let up = Pose::translation(0.0, 0.0, 0.02) * robot.pose();
        robot.move_to(up).await.expect("the cycle is back");
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn unfit_command_is_refused_and_the_motion_goes_on() {
    let _alone = alone();
    for (robot, _sim) in each().await {
        let control = robot.active_joint_velocities(MoveControllerMode::JointImpedance);
        let control = control.await.unwrap();
        on_a_thread(control, |mut control| {
            let still = JointVelocities([0.0; 7]);
            control.read_once().unwrap();
            let unwanted = control.write_motion_and_torques(still, Torques([0.0; 7]));
            assert_eq!(
                unwanted.unwrap_err().to_string(),
                "Torques can only be commanded in kExternalController mode."
            );
            let spoiled = control.write_motion(JointVelocities([f64::NAN; 7]));
            assert_eq!(
                spoiled.unwrap_err().to_string(),
                "Commanding value is infinite or NaN."
            );
            for _ in 0..20 {
                control.write_motion(still).unwrap();
                control.read_once().unwrap();
            }
            assert!(control.write_motion(still.finish()).unwrap().is_some());
        })
        .await;

        let both = robot.active_joint_velocities(MoveControllerMode::ExternalController);
        let both = both.await.unwrap();
        on_a_thread(both, |mut control| {
            let still = JointVelocities([0.0; 7]);
            control.read_once().unwrap();
            let missing = control.write_motion(still).unwrap_err().to_string();
            assert!(missing.starts_with("Torque command missing, "), "{missing}");
            for _ in 0..20 {
                control
                    .write_motion_and_torques(still, Torques([0.0; 7]))
                    .unwrap();
                control.read_once().unwrap();
            }
            let end = control.write_motion_and_torques(still, Torques([0.0; 7]).finish());
            assert!(end.unwrap().is_some());
        })
        .await;
        robot.shutdown().await;
    }
}

/// Reads and writes until something ends it, and once more.
fn until_it_ends(mut control: Active<Torques>) -> ActiveError {
    loop {
        let cycle = control.read_once().and_then(|(state, _)| {
            let damping = std::array::from_fn(|joint| -4.0 * state.dq[joint]);
            control.write_once(Torques(damping))
        });
        if let Err(error) = cycle {
            let ActiveError::Motion(ended) = &error else {
                panic!("{error:?}")
            };
            let again = control.write_once(Torques([0.0; 7])).unwrap_err();
            assert_eq!(again, ActiveError::Ended(ended.clone()));
            assert_eq!(control.read_once(), Err(again.clone()));
            let is_reflex = ended.control().is_some_and(|error| error.is_reflex());
            let recover = if is_reflex {
                " (call `recover` before the next motion)"
            } else {
                ""
            };
            assert_eq!(
                again.to_string(),
                format!("the motion has ended{recover}: {ended}")
            );
            return error;
        }
    }
}

async fn started(robot: &Robot) -> tokio::task::JoinHandle<ActiveError> {
    let control = robot.active_torques().await.unwrap();
    let thread = tokio::task::spawn_blocking(move || until_it_ends(control));
    under_way(robot).await;
    thread
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stop_a_reflex_and_a_shutdown_reach_the_thread() {
    let _alone = alone();
    for (robot, sim) in each().await {
        let thread = started(&robot).await;
        assert_eq!(robot.active_torques().await.unwrap_err(), MotionError::Busy);
        robot.stop().await.expect("the arm rests");
        assert_eq!(thread.await.unwrap(), MotionError::Stopped.into());

        let thread = started(&robot).await;
        sim.with(|robot| robot.trip(RobotError::CartesianReflex))
            .await
            .expect("the simulator runs");
        let ActiveError::Motion(error) = thread.await.unwrap() else {
            panic!("the robot ended the motion")
        };
        let control = error.control().expect("it says why");
        assert!(
            control.is_reflex() && control.log.len() == 50,
            "{control:?}"
        );
        robot.recover().await.unwrap();

        let control = robot.active_torques().await.unwrap();
        on_a_thread(control, |mut control| {
            control.read_once().unwrap();
            control.write_once(Torques([0.0; 7])).unwrap();
            // Dropped before its last command.
        })
        .await;
        let mut states = robot.states();
        let rests = states.wait_for(|state| state.robot_mode != RobotMode::Move);
        tokio::time::timeout(SOON, rests)
            .await
            .expect("the robot was told to stop")
            .expect("the connection lives");
        robot.recover().await.unwrap();

        let thread = started(&robot).await;
        robot.shutdown().await;
        assert!(matches!(thread.await.unwrap(), ActiveError::Motion(_)));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn panicking_thread_stops_robot_but_not_the_connection() {
    let _alone = alone();
    for (robot, _sim) in each().await {
        let control = robot.active_torques().await.unwrap();
        let work = tokio::task::spawn_blocking(move || {
            let mut control = control;
            control.read_once().unwrap();
            panic!("the caller's own code fails");
        });
        assert!(work.await.unwrap_err().is_panic());
        let mut states = robot.states();
        let rests = states.wait_for(|state| state.robot_mode != RobotMode::Move);
        tokio::time::timeout(SOON, rests)
            .await
            .expect("the robot was told to stop")
            .expect("the connection lives");
        robot.recover().await.unwrap();
        let up = Pose::translation(0.0, 0.0, 0.02) * robot.pose();
        robot.move_to(up).await.expect("the cycle is back");
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn hanging_thread_is_reported_and_returns_the_connection() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let control = robot.active_torques().await.unwrap();
    let (go_on, hanging) = std::sync::mpsc::channel::<()>();
    let thread = tokio::task::spawn_blocking(move || {
        let mut control = control;
        control.read_once().unwrap();
        hanging.recv().unwrap();
        let error = control.write_once(Torques([0.0; 7])).unwrap_err();
        let ended = control.read_once().unwrap_err();
        assert!(matches!(
            ended,
            ActiveError::Ended(MotionError::Stalled { .. })
        ));
        error
    });
    let reading = robot.read(|_| std::ops::ControlFlow::<()>::Continue(()));
    let reported = tokio::time::timeout(SOON, reading).await;
    reported.expect("the hang is reported").unwrap_err();
    let busy = robot.move_to(robot.pose()).await;
    assert_eq!(busy.unwrap_err(), MotionError::Busy);
    go_on.send(()).unwrap();
    let error = thread.await.unwrap();
    let silence = LinkTimeout::default().get();
    assert_eq!(error, MotionError::Stalled { silence }.into());
    let mut states = robot.states();
    let rests = states.wait_for(|state| state.robot_mode != RobotMode::Move);
    rests.await.expect("it is connected");
    // The robot may have stopped before the request.
    if robot.state().robot_mode == RobotMode::Reflex {
        robot.recover().await.unwrap();
    }
    let up = Pose::translation(0.0, 0.0, 0.02) * robot.pose();
    robot.move_to(up).await.expect("the cycle is back");
    robot.shutdown().await;
}
