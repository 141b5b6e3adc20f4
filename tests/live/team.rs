//! Teams of two simulated robots, over sockets: outcomes in order, one stop, and joint motions
//! dropped at every poll. tests/lockstep/team has the cycles.

mod dropping;
mod grasp;

use std::future::{Future, poll_fn};
use std::pin::pin;
use std::task::Poll;

use franka_async::error::Lapse;
use franka_async::team::{MemberFault, MemberMotion, NotEngaged, Team, TeamStop};
use franka_async::{Engage, MotionError, Offset, Pose, Robot};
use franka_sim::{Running, Sim};
use tokio::sync::watch;

use crate::{SOON, alone, at_the_clients_pace, robot_time, until};

pub(crate) struct Two {
    pub(crate) team: Team<2>,
    pub(crate) robots: [Robot; 2],
    sims: [Running; 2],
}

/// An FR3 and an FER that stick and lag as real arms do, at the pace of their client.
pub(crate) async fn two() -> Two {
    two_with([Engage::default(), Engage::default()]).await
}

async fn two_with([for_left, for_right]: [Engage; 2]) -> Two {
    let (left, left_sim) = at_the_clients_pace(Sim::fr3()).await;
    let (right, right_sim) = at_the_clients_pace(Sim::fer()).await;
    let members = [(&left, for_left), (&right, for_right)];
    let team = Team::engage_tolerating(SOON, members).await;
    Two {
        team: team.expect("both are free"),
        robots: [left, right],
        sims: [left_sim, right_sim],
    }
}

pub(crate) fn up(by: f64) -> Pose {
    Pose::translation(0.0, 0.0, by)
}

fn stopped_by(member: usize, fault: MemberFault) -> MotionError {
    MotionError::Braked(Lapse::Team(TeamStop::Member { member, fault }))
}

/// Waits until both have moved for a while.
async fn under_way(two: &Two) {
    for robot in &two.robots {
        until(robot, |_| robot.reference().is_some_and(|it| moves(&it.dq))).await;
        robot_time(robot, 100).await;
    }
}

fn moves(dq: &[f64; 7]) -> bool {
    dq.iter().any(|dq| dq.abs() > 0.01)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn joint_motions_have_one_outcome_per_arm_in_their_order() {
    let _alone = alone();
    let two = two().await;
    let [left, right] = &two.robots;
    let targets = [up(0.05) * left.pose(), up(-0.05) * right.pose()];
    let [first, second] = two.team.move_to(targets).await;
    first.expect("it arrives");
    second.expect("it arrives");
    for (robot, target) in two.robots.iter().zip(targets) {
        let off = robot.pose().translation.vector - target.translation.vector;
        assert!(off.norm() < 5e-3, "{} m off", off.norm());
    }
    assert_eq!(two.team.stopped(), None);

    // One arm follows a stream of targets, the other goes to a single target.
    let (sender, targets) = watch::channel(up(0.02) * left.pose());
    let mixed = two.team.run(|member, arm| -> MemberMotion {
        match member {
            0 => arm.follow(targets.clone()).into(),
            _ => arm.move_by(Offset::base(up(0.02))).into(),
        }
    });
    drop(sender);
    for outcome in mixed.await {
        outcome.expect("it arrives");
    }

    // An arm that is only held keeps its place, and the other arm still begins.
    for held in [[true, false], [false, true], [true, true]] {
        let there = two.robots.each_ref().map(|robot| robot.pose());
        let motion = two.team.run(|member, arm| -> MemberMotion {
            match held[member] {
                true => arm.hold().into(),
                false => arm.move_by(Offset::base(up(0.02))).into(),
            }
        });
        for outcome in motion.await {
            outcome.expect("it arrives");
        }
        for ((robot, there), held) in two.robots.iter().zip(there).zip(held) {
            let height = robot.pose().translation.z - there.translation.z;
            let expected = if held { 0.0 } else { 0.02 };
            assert!((height - expected).abs() < 5e-3, "{height} m, {held}");
        }
    }

    // A goal that is refused keeps the others from beginning.
    let there = right.pose();
    let wrong = [up(5.0) * left.pose(), up(0.1) * right.pose()];
    let [first, second] = two.team.move_to(wrong).await;
    assert!(matches!(first, Err(MotionError::Goal(_))), "{first:?}");
    assert_eq!(second, Err(stopped_by(0, MemberFault::Refused)));
    let moved = right.pose().translation.vector - there.translation.vector;
    assert!(moved.norm() < 3e-3, "{} m", moved.norm());
    let [first, second] = two.team.disengage().await;
    first.expect("it was asked for");
    second.expect("it was asked for");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_user_stop_and_a_stopper_brake_both() {
    let _alone = alone();
    let two = two().await;
    let targets = || [0, 1].map(|member: usize| up(0.1) * two.robots[member].pose());
    let slow = |targets: [Pose; 2]| {
        let motion = two
            .team
            .run(move |i, arm| arm.move_to(targets[i]).speed(0.1));
        tokio::spawn(motion)
    };
    let stopper = two.team.stopper();
    let motion = slow(targets());
    under_way(&two).await;
    stopper.stop();
    let requested = MotionError::Braked(Lapse::Team(TeamStop::Requested));
    let outcomes = motion.await.expect("no panic");
    assert_eq!(
        outcomes.map(Result::err),
        [(); 2].map(|()| Some(requested.clone()))
    );

    let motion = slow(targets());
    under_way(&two).await;
    let pressed = two.sims[1].with(|robot| robot.press_user_stop(true)).await;
    pressed.expect("it runs");
    let [first, second] = motion.await.expect("no panic");
    assert_eq!(first, Err(stopped_by(1, MemberFault::RobotStopped)));
    let control = matches!(second, Err(MotionError::Control(_)));
    assert!(control, "{second:?}");
    let stopped = two.team.stopped();
    let stop = TeamStop::Member {
        member: 1,
        fault: MemberFault::RobotStopped,
    };
    assert_eq!(stopped, Some(stop));
    // The remaining arm can be moved alone.
    let back = Offset::base(up(-0.01));
    let alone = two.team.arms()[0].move_by(back).await;
    alone.expect("it arrives");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn joint_motions_may_be_dropped_at_every_poll() {
    let _alone = alone();
    let two = two().await;
    let start = two.robots.each_ref().map(Robot::pose);
    let mut polls = 0_u64;
    loop {
        let way = if polls.is_multiple_of(2) { 0.01 } else { 0.0 };
        let mut motion = pin!(two.team.move_to(start.map(|start| up(way) * start)));
        let mut left = polls;
        let ended = poll_fn(|context| {
            if left == 0 {
                return Poll::Ready(None);
            }
            left -= 1;
            motion.as_mut().poll(context).map(Some)
        });
        if let Some(outcomes) = ended.await {
            for outcome in outcomes {
                outcome.expect("nothing hinders it");
            }
            break;
        }
        polls += 1;
        assert!(polls < 60, "it takes ever more polls");
        // Some are met on their way, others before it.
        for robot in &two.robots {
            robot_time(robot, polls % 4 * 10).await;
            assert!(robot.state().errors.is_empty());
        }
    }
    // The first poll of a motion cannot be the last.
    assert!(polls > 1, "dropped {polls} times on the way");
    // A dropped motion leaves nothing behind.
    for outcome in two.team.move_to(start).await {
        outcome.expect("it arrives");
    }
}
