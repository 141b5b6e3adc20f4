//! Reflexes and user stops, and their consequences.

use std::future::IntoFuture;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use franka_async::diagnosis::Diagnose;
use franka_async::error::{CloseReason, Unready};
use franka_async::state::{RobotError, RobotMode};
use franka_async::supervision::{Condition, EventKind, NotRecovered};
use franka_async::{MotionError, Realtime, Robot};
use franka_sim::Sim;
use tokio::time::timeout;

use super::{condition, policy, small_motion, start, supervised, told};
use crate::{SOON, alone, long_way, under_way};

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_reflex_is_diagnosed_and_recovered_from_as_the_policy_says() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let trip = async || {
        let trip = |robot: &mut franka_sim::Robot| robot.trip(RobotError::CartesianReflex);
        sim.with(trip).await.expect("it runs");
    };
    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    trip().await;
    let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::Control(_))),
        "{outcome:?}"
    );
    let reflex = |kind: &EventKind| match kind {
        EventKind::Reflex(reflex) => Some(reflex.clone()),
        _ => None,
    };
    let told_of = told(&mut events, reflex).await;
    assert!(told_of.errors.contains(RobotError::CartesianReflex));
    let diagnosis = told_of.diagnose().expect("it ended a motion");
    assert_eq!(diagnosis.error, Some(RobotError::CartesianReflex));
    let recovered = |kind: &EventKind| match kind {
        EventKind::Recovered {
            after,
            by_supervisor,
            ..
        } => Some((*after, *by_supervisor)),
        _ => None,
    };
    let (after, by_supervisor) = told(&mut events, recovered).await;
    assert!(by_supervisor);
    let health = robot.health().newest();
    assert_eq!(
        (health.condition, health.last_recovery),
        (Condition::Ready, Some(after))
    );
    small_motion(&robot).await.expect("the next one works");
    robot.shutdown().await;

    // A function decides, and declines the first request.
    let asked = Arc::new(AtomicU64::new(0));
    let count = asked.clone();
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let builder = builder
        .supervise(policy())
        .ask_before_recovery(move |reflex| {
            assert!(reflex.error.is_none(), "nothing moved");
            count.fetch_add(1, Ordering::Relaxed) > 0
        });
    let robot = builder.connect().await.expect("it takes a client");
    let mut events = robot.events();
    trip().await;
    let left = |kind: &EventKind| match kind {
        EventKind::NotRecovered { why, .. } => Some(*why),
        _ => None,
    };
    assert_eq!(told(&mut events, left).await, NotRecovered::Declined);
    condition(&robot, Condition::Unready(Unready::Reflex)).await;
    robot.recover().await.expect("by this program");
    let (_, by_supervisor) = told(&mut events, recovered).await;
    assert!(!by_supervisor);
    trip().await;
    assert!(told(&mut events, recovered).await.1);
    assert_eq!(asked.load(Ordering::Relaxed), 2);
    robot.shutdown().await;

    // A person decides.
    let robot = supervised(&sim, policy().ask_first()).await;
    trip().await;
    condition(&robot, Condition::Unready(Unready::AgreementAwaited)).await;
    let number = robot.health().newest().reflex.expect("there is one");
    assert!(!robot.agree(number + 1, true));
    assert!(robot.agree(number, true));
    condition(&robot, Condition::Ready).await;
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_user_stop_ends_a_motion_and_its_release_starts_none() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let robot = supervised(&sim, policy().motions_wait(SOON)).await;
    let mut events = robot.events();
    let stop = |pressed| {
        move |kind: &EventKind| {
            let told = EventKind::UserStop { pressed };
            (*kind == told).then_some(())
        }
    };
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    sim.with(|robot| robot.press_user_stop(true)).await.unwrap();
    let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::Control(_))),
        "{outcome:?}"
    );
    told(&mut events, stop(true)).await;
    condition(&robot, Condition::Unready(Unready::UserStopped)).await;
    // The robot refuses it: it does not wait for the release.
    let refused = timeout(SOON, small_motion(&robot)).await.expect("at once");
    assert!(
        matches!(refused, Err(MotionError::Rejected(_))),
        "{refused:?}"
    );
    sim.with(|robot| robot.press_user_stop(false))
        .await
        .unwrap();
    told(&mut events, stop(false)).await;
    condition(&robot, Condition::Ready).await;
    crate::robot_time(&robot, 300).await;
    assert_eq!(robot.state().robot_mode, RobotMode::Idle);
    small_motion(&robot).await.expect("the next one works");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn unsupervised_robot_tells_events_and_stays_as_it_is() {
    let _alone = alone();
    let (robot, sim) = crate::simulated().await;
    let mut events = robot.events();
    small_motion(&robot).await.expect("it arrives");
    let ended = |kind: &EventKind| match kind {
        EventKind::MotionEnded { outcome, .. } => Some(outcome.is_ok()),
        _ => None,
    };
    assert!(told(&mut events, ended).await);
    sim.with(|robot| robot.trip(RobotError::JointReflex))
        .await
        .unwrap();
    let left = |kind: &EventKind| match kind {
        EventKind::NotRecovered { why, .. } => Some(*why),
        _ => None,
    };
    assert_eq!(told(&mut events, left).await, NotRecovered::Never);
    condition(&robot, Condition::Unready(Unready::Reflex)).await;
    robot.recover().await.expect("it recovers");
    condition(&robot, Condition::Ready).await;
    sim.stop().await;
    let closed = |kind: &EventKind| match kind {
        EventKind::Closed { reason } => Some(reason.clone()),
        _ => None,
    };
    assert_eq!(told(&mut events, closed).await, CloseReason::ClosedByPeer);
    assert_eq!(robot.health().newest().condition, Condition::Closed);
}
