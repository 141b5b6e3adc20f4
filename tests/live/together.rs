//! Two arms of one process, an FR3 and an FER, whose motions begin together.

use std::future::IntoFuture;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use franka_async::control::{Control, Finish, JointVelocities};
use franka_async::error::StartFault;
use franka_async::motion::StartBarrier;
use franka_async::state::RobotState;
use franka_async::{MotionError, Pose, Robot};
use franka_sim::{Running, Sim};
use tokio::sync::watch;

use crate::{alone, by_the_clock, robot_time, until};

/// Two robots, and the simulators behind them.
async fn two() -> ([Robot; 2], [Running; 2]) {
    let (left, left_sim) = by_the_clock(Sim::fr3().ideal()).await;
    let (right, right_sim) = by_the_clock(Sim::fer().ideal()).await;
    ([left, right], [left_sim, right_sim])
}

/// Turns the last joint a little for half a second, and notes the time of the first call, `[ns]`
/// after `base`.
fn turning(robot: &Robot, base: Instant, called: &Arc<AtomicU64>) -> Control {
    let (called, mut time) = (called.clone(), 0.0);
    robot.control_joint_velocities(move |_, step| {
        if time == 0.0 && called.load(Ordering::Relaxed) == 0 {
            called.store(base.elapsed().as_nanos() as u64, Ordering::Relaxed);
        }
        time += step.as_secs_f64();
        let mut dq = [0.0; 7];
        dq[6] = 0.05 * (1.0 - (std::f64::consts::TAU * 2.0 * time).cos());
        JointVelocities(dq).finish_if(time >= 0.5)
    })
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn two_arms_begin_together_however_late_one_is_asked() {
    let _alone = alone();
    let ([left, right], _sims) = two().await;
    let base = Instant::now();
    let times = [(); 2].map(|()| Arc::new(AtomicU64::new(0)));
    let [first, second] = StartBarrier::new().tickets();
    let one = turning(&left, base, &times[0])
        .start_with(first)
        .into_future();
    let one = tokio::spawn(one);
    until(&left, RobotState::motion_running).await;
    robot_time(&left, 300).await;
    assert_eq!(
        times[0].load(Ordering::Relaxed),
        0,
        "it waits for the other one"
    );
    let asked = base.elapsed();
    let other = turning(&right, base, &times[1]).start_with(second);
    other.await.expect("it ends well");
    one.await.expect("no panic").expect("it ends well");
    let times = times.map(|time| Duration::from_nanos(time.load(Ordering::Relaxed)));
    assert!(
        times.iter().all(|time| *time > asked),
        "{times:?}, {asked:?}"
    );
    // By how much is a matter of the machine; tests/lockstep/together.rs has it exactly.
    println!("apart by {:?}", times[0].abs_diff(times[1]));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn goals_and_streams_begin_together_and_end_by_themselves() {
    let _alone = alone();
    let ([left, right], _sims) = two().await;
    let [first, second] = StartBarrier::new().tickets();
    let up = Pose::translation(0.0, 0.0, 0.03) * left.pose();
    let near = Pose::translation(0.0, 0.0, 0.02) * right.pose();
    let (sender, targets) = watch::channel(right.pose());
    let following = right.follow(targets).start_with(first).into_future();
    let following = tokio::spawn(following);
    until(&right, RobotState::motion_running).await;
    sender.send(near).expect("the motion waits");
    robot_time(&right, 200).await;
    let stayed = right.state();
    assert!(
        stayed.dq.iter().all(|dq| dq.abs() < 1e-3),
        "{:?}",
        stayed.dq
    );
    let report = left
        .move_to(up)
        .start_with(second)
        .await
        .expect("it arrives");
    assert!(report.final_error.expect("a target").translation < 1e-3);
    drop(sender);
    let report = following.await.expect("no panic").expect("it arrives");
    assert!(report.final_error.expect("a target").translation < 1e-3);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn arm_without_its_partner_stays_put_and_moves_again() {
    let _alone = alone();
    let ([left, right], _sims) = two().await;
    let begun = left.state().q;
    let goal = |robot: &Robot| {
        let mut q = robot.state().q;
        q[0] += 0.05;
        robot.move_joints(q)
    };
    let fault_of = |outcome: Result<_, MotionError>| match outcome {
        Err(MotionError::Start(fault)) => fault,
        other => panic!("{other:?}"),
    };

    // Never requested.
    let [first, second] = StartBarrier::new().tickets();
    drop(goal(&right).start_with(second));
    let fault = fault_of(goal(&left).start_with(first).await);
    assert_eq!(fault, StartFault::Dropped { member: 1 });

    // Dropped while it waits.
    let [first, second, _third] = StartBarrier::new().tickets();
    let waiting = tokio::spawn(goal(&left).start_with(first).into_future());
    let dropped = goal(&right).start_with(second).into_future();
    tokio::select! {
        outcome = dropped => panic!("the third one is missing: {outcome:?}"),
        () = until(&right, RobotState::motion_running) => {}
    }
    let fault = fault_of(waiting.await.expect("no panic"));
    assert_eq!(fault, StartFault::Withdrawn { member: 1 });

    // Too late.
    let waited = Duration::from_millis(200);
    let [first, _second] = StartBarrier::new().timeout(waited).tickets();
    let fault = fault_of(goal(&left).start_with(first).await);
    assert_eq!(
        fault,
        StartFault::TimedOut {
            present: 1,
            members: 2,
            waited
        }
    );
    let far = |q: [f64; 7]| (0..7).any(|joint| (q[joint] - begun[joint]).abs() > 1e-4);
    assert!(!far(left.state().q), "the arm has been held");
    goal(&left).await.expect("it moves");
    assert!(far(left.state().q));
    right.stop().await.expect("it comes to rest");
    goal(&right).await.expect("it moves");
}
