//! A robot that sends no states during a motion. Nothing happens before the link timeout, at which
//! the motion is aborted, even if its end was reported before and no state could show it.

use std::time::Duration;

use franka_lockstep::{Lockstep, for_each_robot};
use franka_rt::driver::{Driver, LINK_TIMEOUT, LinkTimeout};
use franka_rt::lifecycle::{END_TIMEOUT, Lifecycle, MotionError};
use franka_rt::session::Target;
use nalgebra::Translation3;

#[test]
fn link_survives_only_silence_shorter_than_the_timeout() {
    for timeout in [LinkTimeout::MIN, Duration::from_millis(150), LINK_TIMEOUT] {
        for_each_robot(|robot| {
            for (silent, lost) in [(-1, false), (0, true)] {
                let mut lockstep = robot();
                allow(&mut lockstep, timeout);
                let target = Translation3::new(0.0, 0.0, 0.2) * lockstep.arm_pose();
                let goal = lockstep.begin(Target::Pose(target));
                lockstep.run(400);
                let silence = timeout.as_millis() as u64;
                lockstep
                    .link
                    .drop_states(silence.saturating_add_signed(silent));
                lockstep.run(silence);
                let outcome = lockstep.client.outcome(goal);
                match outcome {
                    Some(Err(MotionError::LinkLost { silence })) if lost => {
                        assert_eq!(*silence, timeout);
                    }
                    // After more than 20 missing commands, the robot stops on its own.
                    Some(Err(MotionError::Control(_))) if !lost && silence > 20 => {}
                    None if !lost => {}
                    other => panic!("{silence} ms {silent:+}: {other:?}"),
                }
            }
        });
    }
}

/// The robot misses the commands, aborts the motion and reports that: its states would show it.
#[test]
fn unconfirmed_end_is_lost_link_at_the_timeout() {
    for_each_robot(|robot| {
        for silence in [END_TIMEOUT * 2, LinkTimeout::MAX] {
            let mut lockstep = robot();
            allow(&mut lockstep, LinkTimeout::MAX);
            let target = Translation3::new(0.0, 0.0, 0.2) * lockstep.arm_pose();
            let goal = lockstep.begin(Target::Pose(target));
            lockstep.run(400);
            let patience = silence.as_millis() as u64;
            lockstep.link.drop_states(patience);
            lockstep.run(patience - 1);
            assert!(lockstep.client.outcome(goal).is_none());
            lockstep.run(2);
            match lockstep.client.outcome(goal) {
                Some(Err(MotionError::LinkLost { silence: lost }))
                    if silence == LinkTimeout::MAX =>
                {
                    assert_eq!(*lost, silence);
                }
                Some(Err(MotionError::Control(_))) if silence < LinkTimeout::MAX => {}
                other => panic!("{silence:?}: {other:?}"),
            }
        }
    });
}

/// Allows for this silence.
fn allow(lockstep: &mut Lockstep, timeout: Duration) {
    let timeout = LinkTimeout::new(timeout).expect("in range");
    let client = &mut lockstep.client;
    client.driver = Driver::new(client.version()).with_link_timeout(timeout);
    let model = client.lifecycle.model().clone();
    client.lifecycle = Lifecycle::new(model, client.version()).with_link_timeout(timeout);
}
