//! A robot that sends no states during a motion: nothing happens before the link timeout, and the
//! motion is aborted at it, or when its end is told and no state can show it.

use std::time::Duration;

use franka_lockstep::for_each_robot;
use franka_rt::driver::{Driver, LINK_TIMEOUT, LinkTimeout};
use franka_rt::lifecycle::{END_TIMEOUT, MotionError};
use franka_rt::session::Target;
use nalgebra::Translation3;

#[test]
fn a_motion_survives_a_silence_below_the_timeout_and_no_longer_one() {
    for timeout in [LinkTimeout::MIN, Duration::from_millis(150), LINK_TIMEOUT] {
        for_each_robot(|robot| {
            for (silent, lost) in [(-1, false), (0, true)] {
                let mut lockstep = robot();
                let timeout = LinkTimeout::new(timeout).expect("in range");
                let driver = Driver::new(lockstep.client.version());
                lockstep.client.driver = driver.with_link_timeout(timeout);
                let target = Translation3::new(0.0, 0.0, 0.2) * lockstep.arm_pose();
                let goal = lockstep.begin(Target::Pose(target));
                lockstep.run(400);
                let silence = timeout.get().as_millis() as u64;
                lockstep
                    .link
                    .drop_states(silence.saturating_add_signed(silent));
                lockstep.run(silence);
                let outcome = lockstep.client.outcome(goal);
                match outcome {
                    Some(Err(MotionError::LinkLost { silence })) if lost => {
                        assert_eq!(*silence, timeout.get());
                    }
                    // From 20 missing commands on, the robot stops by itself.
                    Some(Err(MotionError::Control(_))) if !lost && silence > 20 => {}
                    None if !lost => {}
                    other => panic!("{silence} ms {silent:+}: {other:?}"),
                }
            }
        });
    }
}

/// The robot misses the commands, aborts the motion and says so: its states would show that.
#[test]
fn an_end_that_no_state_confirms_is_a_lost_link_even_before_the_link_timeout() {
    for_each_robot(|robot| {
        let mut lockstep = robot();
        let timeout = LinkTimeout::new(LinkTimeout::MAX).expect("in range");
        let driver = Driver::new(lockstep.client.version());
        lockstep.client.driver = driver.with_link_timeout(timeout);
        let target = Translation3::new(0.0, 0.0, 0.2) * lockstep.arm_pose();
        let goal = lockstep.begin(Target::Pose(target));
        lockstep.run(400);
        let patience = END_TIMEOUT.as_millis() as u64 + 100;
        lockstep.link.drop_states(patience);
        lockstep.run(patience);
        let outcome = lockstep.client.outcome(goal);
        let Some(Err(MotionError::LinkLost { silence })) = outcome else {
            panic!("{outcome:?}");
        };
        assert!(
            (END_TIMEOUT..timeout.get()).contains(silence),
            "{silence:?}"
        );
    });
}
