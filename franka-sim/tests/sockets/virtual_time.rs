//! Robot time that follows the client's answers, over sockets.

use std::time::{Duration, Instant};

use franka_async::control::{Finish as _, Next, Torques};
use franka_async::gripper::{Grasp, Gripper};
use franka_async::{Realtime, Robot};
use franka_proto::RobotError;
use franka_sim::{Fingers, Running, Sim, Tool};

use crate::alone;

/// Wait that exceeds the delay of a thread on any busy machine.
const PATIENCE: Duration = Duration::from_secs(5);

async fn start(sim: Sim, patience: Duration) -> (Running, Robot) {
    let sim = sim
        .tool(Tool::hand())
        .hand(Fingers::new().with_object(0.04), 0)
        .virtual_time(patience)
        .start()
        .await
        .expect("a robot");
    let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    (sim, robot.connect().await.expect("a session"))
}

#[tokio::test]
async fn virtual_time_takes_patience() {
    let refused = Sim::fr3().virtual_time(Duration::ZERO).start().await;
    let text = refused.map(drop).expect_err("every command would be late");
    assert!(text.to_string().contains("expected more"), "{text}");
}

#[tokio::test(flavor = "multi_thread")]
async fn states_outpace_the_wall_clock_with_equal_counts() {
    let _alone = alone();
    for sim in [Sim::fr3, Sim::fer] {
        let mut runs = Vec::new();
        for _ in 0..2 {
            let (sim, robot) = start(sim().ideal(), PATIENCE).await;
            let begun = Instant::now();
            let mut moved = Duration::ZERO;
            let mut typical = Duration::MAX;
            let home = robot.state().q;
            let mut there = home;
            there[0] += 0.6;
            there[3] += 0.4;
            for q in [there, home] {
                let motion = robot.move_joints(q).speed(0.1);
                let report = motion.await.expect("an arrival");
                assert_eq!(report.lost_states, 0);
                assert_eq!(report.success_rate_min, 1.0);
                moved += report.duration;
                typical = typical.min(report.interval.expect("states").p50);
            }
            println!("{moved:?} of motion in {:?}", begun.elapsed());
            assert!(moved > Duration::from_secs(10), "{moved:?}");
            // A busy machine may be slow in total, but most states must still follow fast.
            assert!(typical < Duration::from_millis(1), "{typical:?}");
            runs.push(moved);
            robot.shutdown().await;
            sim.stop().await;
        }
        assert_eq!(runs[0], runs[1]);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn no_answer_is_too_late_for_a_patient_robot() {
    let _alone = alone();
    let (sim, robot) = start(Sim::fr3().ideal(), PATIENCE).await;
    let mut calls = 0;
    let control = robot.control_torques(move |_, period| {
        calls += 1;
        assert!(
            calls == 1 || period == Duration::from_millis(1),
            "{period:?}"
        );
        // The client is much too slow for the wall clock, a hundred times.
        std::thread::sleep(Duration::from_millis(3));
        let torques = Torques([0.0; 7]);
        if calls < 100 {
            Next::Continue(torques)
        } else {
            Next::Finish(torques)
        }
    });
    let report = control.await.expect("a motion to its end");
    assert_eq!(report.success_rate_min, 1.0);
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_that_waits_for_commands_is_no_faster_than_the_wall() {
    let _alone = alone();
    let sim = Sim::fr3().ideal().wait_for_commands(PATIENCE).start().await;
    let sim = sim.expect("a robot");
    let robot = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = robot.connect().await.expect("a session");
    let mut calls = 0;
    let begun = Instant::now();
    let control = robot.control_torques(move |_, _| {
        calls += 1;
        if calls % 100 == 0 {
            // Without waiting, the robot would stop in half of this time.
            std::thread::sleep(Duration::from_millis(40));
        }
        let torques = Torques([0.0; 7]);
        torques.finish_if(calls == 500)
    });
    let report = control.await.expect("a motion to its end");
    assert_eq!(report.success_rate_min, 1.0);
    let took = begun.elapsed();
    assert!(took >= report.duration, "{took:?}, {:?}", report.duration);
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_falls_silent_is_noticed_when_patience_is_over() {
    let _alone = alone();
    let (sim, robot) = start(Sim::fr3().ideal(), Duration::from_millis(5)).await;
    let mut calls = 0;
    let control = robot.control_torques(move |_, _| {
        calls += 1;
        if calls == 50 {
            std::thread::sleep(Duration::from_secs(2));
        }
        Next::Continue(Torques([0.0; 7]))
    });
    let error = control.await.expect_err("twenty commands are missing");
    assert!(
        error
            .to_string()
            .contains("communication_constraints_violation"),
        "{error}"
    );
    let errors = sim.state().await.expect("running").errors;
    assert_eq!(errors, RobotError::CommunicationConstraintsViolation.into());
    // The steps of a recovery do not wait for answers.
    robot.recover().await.expect("a recovery");
    sim.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_hand_grasps_in_the_time_of_the_robot() {
    let _alone = alone();
    let (sim, robot) = start(Sim::fr3().ideal(), PATIENCE).await;
    let address = sim.hand().expect("a hand").addr();
    let hand = Gripper::connect(address).await.expect("a session");
    let begun = robot.state().message_id;
    hand.homing().await.expect("a homing");
    let grasped = hand
        .grasp(Grasp::new(0.04, 0.1, 40.0))
        .await
        .expect("a grasp");
    assert!(grasped);
    // Robot and hand use the same clock, on which a homing takes more than a second.
    let took = robot.state().message_id - begun;
    assert!((1000..10_000).contains(&took), "{took} ms");
    sim.stop().await;
}
