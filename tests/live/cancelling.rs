//! Every future of a motion, dropped after each of its polls in turn. The arm stops without a
//! reflex, and accepts the next motion.

use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::task::Poll;
use std::time::Duration;

use franka_async::goal::{Chunk, Free, Tuning, Waypoint};
use franka_async::{Arm, Engage, MotionError, Pose, Robot};
use tokio::sync::watch;

use crate::{SOON, alone, simulated};

/// Most polls that any of them may take to its end.
const POLLS_MAX: u32 = 60;

type Boxed<'a> = Pin<Box<dyn Future<Output = Result<(), MotionError>> + Send + 'a>>;

/// True if a future completes without an error within this many polls. It is dropped in its last
/// state.
async fn ends_within(future: impl Future<Output = Result<(), MotionError>>, polls: u32) -> bool {
    let mut future = pin!(future);
    let mut left = polls;
    poll_fn(|context| {
        if left == 0 {
            return Poll::Ready(false);
        }
        left -= 1;
        match future.as_mut().poll(context) {
            Poll::Ready(outcome) => {
                outcome.expect("nothing hinders it");
                Poll::Ready(true)
            }
            Poll::Pending => Poll::Pending,
        }
    })
    .await
}

/// Waits for the arm to rest after a drop, and checks its errors.
async fn rests(robot: &Robot, what: &str) {
    let mut states = robot.states();
    let still = states.wait_for(|state| state.dq.iter().all(|dq| dq.abs() < 5e-3));
    tokio::time::timeout(SOON, still)
        .await
        .unwrap_or_else(|_| panic!("{what}: the arm does not come to rest"))
        .expect("the connection lives");
    let state = robot.state();
    assert!(state.errors.is_empty(), "{what}: {:?}", state.errors);
    let reason = state.reflex_reason;
    assert!(reason.is_empty(), "{what}: {reason:?}");
}

/// Drops the future of `make` after one poll, then after two, and so on until it completes; returns
/// the number of polls.
async fn drop_at_every_poll<'a>(
    robot: &Robot,
    what: &str,
    mut make: impl FnMut() -> Boxed<'a>,
) -> u32 {
    for polls in 0..POLLS_MAX {
        if ends_within(make(), polls).await {
            return polls;
        }
        // Long enough for the motion to have begun at some, and not at others.
        tokio::time::sleep(Duration::from_millis(u64::from(polls % 4) * 10)).await;
        rests(robot, what).await;
    }
    panic!("{what} takes more than {POLLS_MAX} polls");
}

fn up(robot: &Robot) -> Pose {
    Pose::translation(0.0, 0.0, 0.01) * robot.pose()
}

#[tokio::test(flavor = "multi_thread")]
async fn motions_of_a_robot_may_be_dropped_at_every_poll() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let q = robot.state().q;
    let start = robot.pose();
    drop_at_every_poll(&robot, "move_to", || {
        Box::pin(async { robot.move_to(up(&robot)).await.map(drop) })
    })
    .await;
    drop_at_every_poll(&robot, "move_joints", || {
        Box::pin(async { robot.move_joints(q).await.map(drop) })
    })
    .await;
    drop_at_every_poll(&robot, "move_through", || {
        let way = [start, up(&robot)].map(|pose| Waypoint::new(pose).blend(0.002));
        let motion = robot.move_through(way);
        Box::pin(async move { motion.await.map(drop) })
    })
    .await;
    drop_at_every_poll(&robot, "follow", || {
        let (sender, targets) = watch::channel(start);
        drop(sender);
        Box::pin(async { robot.follow(targets).await.map(drop) })
    })
    .await;
    drop_at_every_poll(&robot, "stop", || Box::pin(robot.stop())).await;
    drop_at_every_poll(&robot, "engage", || {
        Box::pin(async { robot.engage(Engage::default()).await.map(drop) })
    })
    .await;
    robot.move_joints(q).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn goals_of_an_engaged_arm_may_be_dropped_at_every_poll() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let q = robot.state().q;
    let start = robot.pose();
    let arm = robot.engage(Engage::default()).await.unwrap();
    let of = |make: fn(Arm, Pose, [f64; 7]) -> Boxed<'static>| {
        let arm = &arm;
        move || make(arm.clone(), start, q)
    };
    for (what, make) in [
        (
            "move_to",
            (|arm, start, _| {
                let up = Pose::translation(0.0, 0.0, 0.01) * start;
                Box::pin(async move { arm.move_to(up).await.map(drop) })
            }) as fn(Arm, Pose, [f64; 7]) -> Boxed<'static>,
        ),
        ("move_joints", |arm, _, q| {
            Box::pin(async move { arm.move_joints(q).await.map(drop) })
        }),
        ("move_through", |arm, start, _| {
            let up = Pose::translation(0.0, 0.0, 0.01) * start;
            let way = [Waypoint::new(up), Waypoint::new(start)];
            Box::pin(async move { arm.move_through(way).await.map(drop) })
        }),
        ("hold", |arm, _, _| {
            Box::pin(async move { arm.hold().await.map(drop) })
        }),
        ("set", |arm, start, _| {
            Box::pin(async move { arm.set(start).await })
        }),
        ("set joints", |arm, _, q| {
            Box::pin(async move { arm.set(q).await })
        }),
        ("guide", |arm, _, _| {
            Box::pin(async move { arm.guide(Free::ALL).await })
        }),
        ("chunk", |arm, _, q| {
            let chunk = Chunk::joints([(Duration::from_millis(50), q)]).expect("a chunk");
            Box::pin(async move { arm.chunk(chunk).await })
        }),
        ("tune", |arm, _, _| {
            Box::pin(async move { arm.tune(Tuning::default()).await })
        }),
        ("follow_stream", |arm, start, _| {
            let up = Pose::translation(0.0, 0.01, 0.0) * start;
            Box::pin(async move {
                arm.follow_stream(tokio_stream::iter([start, up]))
                    .await
                    .map(drop)
            })
        }),
    ] {
        drop_at_every_poll(&robot, what, of(make)).await;
        // The session continues after any drop.
        arm.hold().await.unwrap();
    }
    arm.move_joints(q).await.unwrap();
    // Dropped after a poll or not at all, the end of a session ends it.
    assert!(!ends_within(async { arm.clone().disengage().await.map(drop) }, 1).await);
    arm.ended().await.unwrap();
    robot.shutdown().await;
}
