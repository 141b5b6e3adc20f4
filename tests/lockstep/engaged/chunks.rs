//! The end of chunks: a cancelled or aborted goal no longer follows a chunk, and a followed chunk
//! passes through its points.

use std::time::Duration;

use super::{assert_stays, chunk, guarded, turned, turned_q, watched};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_model::READY;
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{
    Backend, Chunk, ChunkError, Goal, GoalError, GoalId, Lapse, OnArrival, OnTimeout, Setpoints,
    Target,
};
use nalgebra::Translation3;

fn give(lockstep: &mut Lockstep, engaged: GoalId, goal: Goal, chunk: Chunk) -> GoalId {
    lockstep
        .submit_chunk(engaged, goal, chunk)
        .expect("near the ready pose")
}

#[test]
fn waiting_chunk_is_cancelled_with_the_previous_one() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = lockstep.goal(Target::Rest, OnArrival::Hold);
        let first = give(&mut lockstep, engaged, goal, chunk(0.0, 0.2));
        lockstep.run(200);
        let later = lockstep.client.state.message_id + 300;
        let goal = lockstep.goal(Target::Rest, OnArrival::Hold);
        let waiting = chunk(0.2, 0.6).observed_at(later);
        give(&mut lockstep, engaged, goal, waiting);
        lockstep.run(20);
        lockstep.cancel(first);
        let outcome = lockstep.until_resolved(first, 2000);
        assert_eq!(outcome, Err(MotionError::Stopped));
        assert!(lockstep.robot.q()[0] < turned_q(0.2)[0]);
        assert_stays(&mut lockstep, engaged);
    });
}

#[test]
fn chunk_that_outlasts_a_timeout_still_needs_its_deadman() {
    for_each_robot(|ready| {
        let (mut lockstep, engaged, token) = guarded(ready, 50);
        let goal = watched(&mut lockstep, Target::Rest, 100, OnTimeout::Hold);
        let point = |k: u32| (Duration::from_secs(1) * k, turned_q(0.2 * f64::from(k)));
        let long = Chunk::joints((0..=3).map(point)).expect("points a second apart");
        let goal = give(&mut lockstep, engaged, goal, long);
        for _ in 0..20 {
            token.keep_alive();
            lockstep.run(40);
        }
        drop(token);
        let outcome = lockstep.until_resolved(goal, 1000);
        assert_eq!(outcome, Err(MotionError::Held(Lapse::Deadman)));
        assert!(lockstep.robot.q()[0] < turned_q(0.3)[0], "half way at most");
        assert_stays(&mut lockstep, engaged);
    });
}

#[test]
fn deadman_timeout_is_told_once_by_the_next_chunk() {
    for_each_robot(|ready| {
        let (mut lockstep, engaged, token) = guarded(ready, 50);
        let held = Err(MotionError::Held(Lapse::Deadman));
        let seen = lockstep.client.state.message_id;
        let late = || chunk(0.0, 0.3).observed_at(seen);
        lockstep.chunk(engaged, late()).expect("in time");
        lockstep.run(1500);
        let refused = lockstep.chunk(engaged, late()).map(drop);
        assert_eq!(refused, held, "while it is silent");
        token.keep_alive();
        let refused = lockstep.chunk(engaged, late()).map(drop);
        assert_eq!(refused, held, "of the chunk before");
        let refused = lockstep.chunk(engaged, late()).map(drop);
        let is_late = matches!(refused, Err(MotionError::Goal(GoalError::Late { .. })));
        assert!(is_late, "{refused:?}");

        // The program continues with a goal in between.
        lockstep.chunk(engaged, chunk(0.0, 0.3)).expect("in time");
        lockstep.run(1500);
        token.keep_alive();
        lockstep
            .within(engaged, turned(0.1), OnArrival::Hold)
            .unwrap();
        lockstep.chunk(engaged, chunk(0.1, 0.2)).expect("in time");
    });
}

#[test]
fn chunk_after_its_goal_is_held_does_not_move_the_arm() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let goal = watched(&mut lockstep, Target::Rest, 50, OnTimeout::Hold);
        let goal = give(&mut lockstep, engaged, goal, chunk(0.0, 0.05));
        // The goal settles, and the next chunk is sent before the lifecycle knows.
        lockstep.client.lifecycle_is_paused = true;
        lockstep.run(2000);
        lockstep.chunk(engaged, chunk(0.05, 0.2)).unwrap();
        lockstep.run(500);
        lockstep.client.lifecycle_is_paused = false;
        let outcome = lockstep.until_resolved(goal, 10);
        assert!(matches!(outcome, Err(MotionError::Held(_))), "{outcome:?}");
        assert!((lockstep.robot.q()[0] - turned_q(0.05)[0]).abs() < 2e-3);
        // The chunk after that is followed.
        lockstep.chunk(engaged, chunk(0.05, 0.1)).unwrap();
        lockstep.run(2000);
        assert!((lockstep.robot.q()[0] - turned_q(0.1)[0]).abs() < 2e-3);
    });
}

#[test]
fn an_arm_brakes_before_a_first_point_far_in_the_future() {
    for_each_robot(|ready| {
        for joints in [true, false] {
            let mut lockstep = ready();
            let engaged = lockstep.engage();
            let target = turned(0.8);
            lockstep.within(engaged, target, OnArrival::Hold).unwrap();
            lockstep.run(400);
            let at = lockstep.client.record.q_ref;
            assert!(lockstep.client.record.dq_ref[0] > 0.3, "it is under way");
            let begin = Duration::from_secs(5);
            let chunk = if joints {
                Chunk::joints([(begin, at)])
            } else {
                Chunk::poses([(begin, lockstep.reference_pose())])
            };
            lockstep.chunk(engaged, chunk.unwrap()).unwrap();
            let mut farthest = 0.0_f64;
            for _ in 0..5000 {
                lockstep.tick();
                farthest = farthest.max((lockstep.client.record.q_ref[0] - at[0]).abs());
            }
            assert!(farthest < 0.3, "{farthest} rad on");
        }
    });
}

#[test]
fn lost_commands_do_not_lead_past_the_points_of_a_chunk() {
    for_each_robot(|ready| {
        for (joints, after) in [(true, 30), (true, 60), (false, 30), (false, 60)] {
            let mut lockstep = ready();
            let engaged = lockstep.engage_with(Engagement {
                backend: Backend::joint_impedance(Setpoints::JointPositions),
                ..Engagement::default()
            });
            let start = lockstep.reference_pose();
            // There and back, since the last point alone would not move the arm.
            let there = |k: u32| 0.06 * (1.0 - (f64::from(k) * 0.3).cos());
            let count = 0..=21;
            let apart = Duration::from_millis(100);
            let chunk = if joints {
                Chunk::joints(count.map(|k| (apart * k, turned_q(there(k)))))
            } else {
                let moved = |k| Translation3::new(0.0, there(k), 0.0) * start;
                Chunk::poses(count.map(|k| (apart * k, moved(k))))
            };
            lockstep.chunk(engaged, chunk.unwrap()).unwrap();
            lockstep.run(after);
            lockstep.link.drop_commands(12);
            let mut farthest = 0.0_f64;
            for _ in 0..2500 {
                lockstep.tick();
                let off = if joints {
                    lockstep.client.record.q_ref[0] - READY[0]
                } else {
                    lockstep.reference_pose().translation.y - start.translation.y
                };
                farthest = farthest.max(off);
            }
            assert!(farthest > 0.115, "{farthest} of 0.12");
            assert_eq!(lockstep.client.outcome(engaged), None, "it goes on");
        }
    });
}

#[test]
fn points_too_large_to_plan_are_refused() {
    let lockstep = Lockstep::ready();
    let start = lockstep.arm_pose();
    let apart = Duration::from_millis(50);
    for far in [1e12, 1e200, -1e300] {
        let wild = Translation3::new(far, 0.0, 0.0) * start;
        let poses = Chunk::poses([(apart, start), (apart * 2, wild), (apart * 3, start)]);
        let x = far + start.translation.x;
        assert_eq!(poses, Err(ChunkError::Number { point: 2, got: x }));
        let (at, still) = (READY.into(), [0.0; 7]);
        let fast = [far; 7];
        let joints = Chunk::joints_with_velocities([(apart, at, still), (apart * 2, at, fast)]);
        assert_eq!(joints, Err(ChunkError::Number { point: 2, got: far }));
    }
}

/// The blend of a chunk moves the arm to its only point, which is due immediately.
#[test]
fn a_chunk_of_one_point_without_a_delay_is_followed() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        let point = || Chunk::joints([(Duration::ZERO, turned_q(0.1))]).expect("one point");
        lockstep.chunk(engaged, point()).expect("due when taken up");
        lockstep.run(3000);
        let off = lockstep.robot.q()[0] - turned_q(0.1)[0];
        assert!(off.abs() < 2e-3, "{off} rad");
        // Its time has passed by when it could be taken up.
        let seen = lockstep.client.state.message_id;
        let late = lockstep.chunk(engaged, point().observed_at(seen)).map(drop);
        let is_late = matches!(late, Err(MotionError::Goal(GoalError::Late { .. })));
        assert!(is_late, "{late:?}");
    });
}
