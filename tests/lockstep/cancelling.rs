//! A goal cancelled in any millisecond of its motion, as dropping its future does. The tests cover
//! each of the first milliseconds and every fifth after them; thorough runs cover all. The harness
//! checks every command against the limits, jerk included.

use franka_lockstep::{Lockstep, for_each_robot};
use franka_proto::RobotMode;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{Goal, GoalId, OnArrival, Target};
use nalgebra::Translation3;

/// The longest times from cancelling a goal until the arm rests, and until its motion has ended,
/// `[ms]`.
const STOP: u64 = 600;

/// Joint velocity of an arm at rest, `[rad/s]`.
const REST: f64 = 0.01;

/// A fast goal half a centimetre away, up and down in turn.
fn goal(lockstep: &mut Lockstep, turn: usize, on_arrival: OnArrival, joints: bool) -> Goal {
    let way = if turn.is_multiple_of(2) { 1.0 } else { -1.0 };
    let target = if joints {
        let mut q: [f64; 7] = (*lockstep.robot.q()).into();
        q[3] += way * 0.02;
        Target::Joints(q)
    } else {
        (Translation3::new(0.0, 0.0, way * 0.005) * lockstep.arm_pose()).into()
    };
    let goal = lockstep.goal(target, on_arrival);
    Goal {
        budget: goal.budget.scaled(1.7),
        ..goal
    }
}

/// Cancels a goal in its first millisecond, the next goal in a later millisecond, and so on until a
/// goal arrives before it is cancelled.
fn in_any_millisecond(
    lockstep: &mut Lockstep,
    mut submit: impl FnMut(&mut Lockstep, usize) -> GoalId,
    mut at_rest: impl FnMut(&mut Lockstep),
) {
    let step = if franka_tests::thorough() { 1 } else { 10 };
    for (turn, moment) in (0..20).chain((20..).step_by(step)).enumerate() {
        let goal = submit(lockstep, turn);
        lockstep.run(moment);
        if let Some(outcome) = lockstep.client.outcome(goal) {
            println!("arrived after {moment} ms");
            assert!(outcome.is_ok(), "{outcome:?}");
            assert!(moment > 300, "{moment} ms");
            return;
        }
        lockstep.cancel(goal);
        at_rest(lockstep);
        assert!(lockstep.robot.dq().amax() < REST, "{moment} ms");
        let outcome = lockstep.client.outcome(goal);
        assert!(
            matches!(outcome, None | Some(Ok(_) | Err(MotionError::Stopped))),
            "{moment} ms: {outcome:?}"
        );
    }
}

#[test]
fn a_motion_cancelled_in_any_millisecond_ends_at_rest() {
    for_each_robot(|ready| {
        for joints in [false, true] {
            let mut lockstep = ready();
            in_any_millisecond(
                &mut lockstep,
                |lockstep, turn| {
                    let goal = goal(lockstep, turn, OnArrival::ReportAndFinish, joints);
                    lockstep.submit(goal).expect("within reach")
                },
                |lockstep| {
                    lockstep.until_idle(STOP);
                    lockstep.run(5);
                    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Idle);
                },
            );
        }
    });
}

#[test]
fn session_goal_cancelled_at_any_time_leaves_arm_held() {
    for_each_robot(|ready| {
        for joints in [false, true] {
            let mut lockstep = ready();
            let engaged = lockstep.engage();
            in_any_millisecond(
                &mut lockstep,
                |lockstep, turn| {
                    let goal = goal(lockstep, turn, OnArrival::ReportAndHold, joints);
                    lockstep.submit_within(engaged, goal).expect("within reach")
                },
                |lockstep| {
                    lockstep.run(STOP / 2);
                    assert_eq!(lockstep.client.outcome(engaged), None, "it goes on");
                    assert_eq!(lockstep.client.state.robot_mode, RobotMode::Move);
                },
            );
            lockstep.disengage(engaged);
            lockstep.until_resolved(engaged, 1000).expect("as asked");
        }
    });
}
