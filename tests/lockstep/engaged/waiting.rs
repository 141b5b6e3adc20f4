//! Sessions that are requested while the previous motion ends.

use super::{assert_stays, turned};
use franka_lockstep::{Lockstep, for_each_robot};
use franka_rt::control::{Callback, Torques};
use franka_rt::lifecycle::{Engagement, MotionError};
use franka_rt::session::{GoalId, OnArrival};

fn ask(lockstep: &mut Lockstep) -> Result<GoalId, MotionError> {
    lockstep.try_engage(Engagement::default())
}

/// Returns a moving arm and the goal of its motion; with `engaged`, the goal is the session.
fn moving(ready: &dyn Fn() -> Lockstep, engaged: bool) -> (Lockstep, GoalId) {
    let mut lockstep = ready();
    let motion = if engaged {
        let engaged = lockstep.engage();
        lockstep
            .within(engaged, turned(0.3), OnArrival::ReportAndHold)
            .unwrap();
        engaged
    } else {
        lockstep.begin(turned(0.3))
    };
    lockstep.run(400);
    (lockstep, motion)
}

#[test]
fn a_session_waits_for_the_end_of_a_dropped_motion() {
    for_each_robot(|ready| {
        for engaged in [false, true] {
            let (mut lockstep, motion) = moving(ready, engaged);
            assert_eq!(ask(&mut lockstep), Err(MotionError::Busy), "it moves");
            lockstep.cancel(motion);
            let session = ask(&mut lockstep).expect("the arm is let go");
            // Other motions are refused already.
            assert_eq!(ask(&mut lockstep), Err(MotionError::Busy));
            let goal = lockstep.goal(turned(0.0), OnArrival::ReportAndFinish);
            assert_eq!(lockstep.submit(goal), Err(MotionError::Busy));
            while lockstep.client.record.goal != session.0 {
                lockstep.tick();
                assert!(lockstep.now() < 3000, "{:?}", lockstep.client.lifecycle);
            }
            assert!(lockstep.client.outcome(motion).is_some());
            assert_stays(&mut lockstep, session);
        }
    });
}

#[test]
fn a_waiting_session_can_be_cancelled_and_stopped() {
    for_each_robot(|ready| {
        for engaged in [false, true] {
            for stopped in [false, true] {
                let (mut lockstep, motion) = moving(ready, engaged);
                lockstep.cancel(motion);
                let session = ask(&mut lockstep).expect("the arm is let go");
                if stopped {
                    let stop = lockstep.stop().expect("it moves");
                    lockstep.until_resolved(stop, 1000).unwrap();
                } else {
                    lockstep.cancel(session);
                }
                let outcome = lockstep.until_resolved(session, 1);
                assert_eq!(outcome, Err(MotionError::Stopped));
                lockstep.until_idle(2000);
                assert!(lockstep.client.outcome(motion).is_some());
            }
        }
    });
}

#[test]
fn a_session_is_refused_during_a_stop() {
    for_each_robot(|ready| {
        let (mut lockstep, _) = moving(ready, false);
        let stop = lockstep.stop().expect("it moves");
        assert_eq!(ask(&mut lockstep), Err(MotionError::Busy));
        lockstep.until_resolved(stop, 1000).unwrap();
        let session = ask(&mut lockstep).expect("nothing moves");
        lockstep.run(100);
        assert_stays(&mut lockstep, session);
    });
}

#[test]
fn stream_closed_while_waiting_ends_its_own_motion() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let engaged = lockstep.engage();
        lockstep.disengage(engaged);
        let goal = lockstep.goal(turned(0.1), OnArrival::Hold);
        let goal = lockstep.submit(goal).expect("the arm is let go");
        lockstep.client.lifecycle.close(goal);
        assert!(lockstep.client.outcome(engaged).is_none(), "it waited");
        lockstep.until_resolved(goal, 6000).unwrap();
        assert!(lockstep.client.lifecycle.is_idle());
    });
}

#[test]
fn a_session_that_waits_for_a_program_is_stopped_with_it() {
    for_each_robot(|ready| {
        let mut lockstep = ready();
        let version = lockstep.client.version();
        let still = Callback::torques(version, |_, _| Torques([0.0; 7]));
        let program = lockstep.control_function(still).expect("nothing moves");
        lockstep.run(100);
        lockstep.cancel(program);
        let session = ask(&mut lockstep).expect("the arm is let go");
        let stop = lockstep.stop().expect("it moves");
        let outcome = lockstep.until_resolved(session, 1);
        assert_eq!(outcome, Err(MotionError::Stopped));
        lockstep.until_resolved(stop, 1000).unwrap();
        assert!(lockstep.client.outcome(program).is_some());
        assert!(lockstep.client.lifecycle.is_idle());
    });
}
