//! Connections that end, and robots that send nothing or invalid messages.

use franka_lockstep::Outcome;
use franka_proto::framing::Header;
use franka_proto::{MoveStatus, RobotError};
use franka_rt::driver::{Activity, LINK_TIMEOUT};
use franka_rt::lifecycle::{CloseReason, END_TIMEOUT, MotionError, START_TIMEOUT};

use crate::faults::expect::Expect;
use crate::faults::program::Misbehaviour;
use crate::faults::trial::{Moment, Trial};
use crate::faults::variant::Variant;
use crate::faults::{Matrix, course};

/// One moment of each phase.
const MOMENTS: [Moment; 4] = [
    Moment::Armed(2),
    Moment::Cycle(1),
    Moment::Cycle(course::REST + course::RAMP),
    Moment::Finishing(2),
];

fn closed(reason: &str) -> Expect {
    let closed = |error: &MotionError| matches!(error, MotionError::ConnectionClosed { .. });
    Expect::Other(closed, reason.to_owned())
}

fn protocol(what: &str) -> Expect {
    let protocol = |error: &MotionError| matches!(error, MotionError::Protocol { .. });
    Expect::Other(protocol, what.to_owned())
}

/// The outcome so far, if resolved.
fn so_far(trial: &Trial) -> Option<Outcome> {
    trial.lockstep.client.outcome(trial.work).cloned()
}

/// Asserts that the outcome is the expected one, that no more motions start, and that the next
/// motion works on a new connection.
fn starts_over(mut trial: Trial, expected: &Expect) {
    let outcome = so_far(&trial).expect("resolved at once");
    expected.check(&trial, &outcome);
    trial.lockstep.silence(LINK_TIMEOUT.as_millis() as u64);
    assert!(trial.lockstep.client.driver.is_watching());
    assert!(trial.lockstep.stop().is_none());
    trial.lockstep.reconnect();
    trial.works_again();
}

#[test]
fn a_robot_that_closes_the_connection_ends_everything() {
    const REASON: &str = "libfranka: server closed connection";
    let mut matrix = Matrix::new("closed");
    for variant in Variant::all() {
        for moment in MOMENTS {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                trial.lockstep.robot.disconnect();
                trial.lockstep.client.close(CloseReason::ClosedByPeer);
                starts_over(trial, &closed(REASON));
            });
            // The robot accepts requests and commands, and sends states, until the client has
            // closed its side.
            matrix.case(format_args!("{variant}/{moment:?}/half"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                trial.lockstep.client.close(CloseReason::ClosedByPeer);
                for _ in 0..5 {
                    trial.lockstep.tick();
                    let activity = trial.lockstep.client.record.activity;
                    let commanded = matches!(activity, Activity::Running | Activity::Finishing);
                    // A program is dropped at once; an arm that follows goals is braked.
                    assert!(!commanded || variant.is_target(), "{activity:?}");
                }
                trial.lockstep.robot.disconnect();
                starts_over(trial, &closed(REASON));
            });
        }
    }
    matrix.finish();
}

/// After a message of invalid size, the rest of the stream cannot be read.
#[test]
fn an_invalid_message_ends_the_connection() {
    let mut matrix = Matrix::new("garbage");
    for variant in Variant::all() {
        for moment in MOMENTS {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                trial.lockstep.client.on_bytes(&[0; Header::SIZE]);
                trial.lockstep.robot.disconnect();
                starts_over(trial, &closed("libfranka: Incorrect TCP message size."));
            });
        }
    }
    matrix.finish();
}

/// The reply is unreadable: the robot receives a stop, and the connection stays open.
#[test]
fn an_invalid_reply_ends_the_motion() {
    let mut matrix = Matrix::new("nonsense");
    let texts = [
        (
            0xee,
            "libfranka: Unexpected response while handling Move command!",
        ),
        (
            MoveStatus::MotionStarted as u8,
            "libfranka: Move received unexpected motion started message.",
        ),
    ];
    for variant in Variant::all() {
        for moment in MOMENTS {
            for (status, text) in texts {
                matrix.case(format_args!("{variant}/{moment:?}/{status}"), || {
                    let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                    trial.until(moment);
                    let (id, _) = trial.lockstep.client.newest_motion();
                    let header = Header {
                        command: 1,
                        command_id: id.0,
                        size: Header::SIZE as u32 + 1,
                    };
                    let reply = [&header.to_bytes()[..], &[status]].concat();
                    trial.lockstep.client.on_bytes(&reply);
                    trial.lockstep.client.settle();
                    let outcome = so_far(&trial).expect("resolved at once");
                    let violation =
                        |error: &MotionError| matches!(error, MotionError::Violation(_));
                    Expect::Other(violation, text.to_owned()).check(&trial, &outcome);
                    // The motion is resolved, but still has to be stopped.
                    let unchanged = trial.outcome();
                    assert_eq!(unchanged, outcome);
                    trial.works_again();
                });
            }
        }
    }
    matrix.finish();
}

/// libfranka waits forever.
#[test]
fn a_move_that_never_arrives_times_out() {
    let mut matrix = Matrix::new("no-move");
    for variant in Variant::all() {
        matrix.case(variant, || {
            let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
            trial.lockstep.link.requests = false;
            trial.tick();
            trial.lockstep.link.requests = true;
            let patience = START_TIMEOUT.as_millis() as u64;
            trial.lockstep.jump(patience - 2);
            assert_eq!(so_far(&trial), None);
            trial.lockstep.jump(1);
            let outcome = trial.outcome();
            protocol("the robot's states never showed the motion's modes").check(&trial, &outcome);
            trial.works_again();
        });
    }
    matrix.finish();
}

/// libfranka waits forever.
#[test]
fn a_motion_whose_replies_are_lost_times_out_once_it_has_ended() {
    let mut matrix = Matrix::new("no-reply");
    for variant in Variant::all() {
        matrix.case(variant, || {
            let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
            trial.lockstep.link.replies = false;
            while !trial.has_ended() {
                trial.tick();
            }
            let patience = END_TIMEOUT.as_millis() as u64;
            trial.lockstep.jump(patience - 1);
            assert_eq!(so_far(&trial), None);
            trial.lockstep.jump(1);
            trial.lockstep.link.replies = true;
            let outcome = trial.outcome();
            protocol("the robot did not report how the motion ended").check(&trial, &outcome);
            trial.works_again();
        });
    }
    matrix.finish();
}

/// The robot gets no commands either, and stops meanwhile.
#[test]
fn link_to_a_silent_robot_is_lost_at_the_timeout() {
    let mut matrix = Matrix::new("silent");
    for variant in Variant::all() {
        for moment in MOMENTS {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                trial.lockstep.link.drop_states(u64::MAX);
                trial.lockstep.link.drop_commands(u64::MAX);
                // While armed, the client has received no state before either.
                let heard = match moment {
                    Moment::Armed(milliseconds) => milliseconds,
                    _ => 0,
                };
                trial.lockstep.run(60);
                let patience = LINK_TIMEOUT.as_millis() as u64;
                trial.lockstep.silence(patience - 61 - heard);
                assert_eq!(so_far(&trial), None);
                trial.lockstep.silence(1);
                let lost = |error: &MotionError| matches!(error, MotionError::LinkLost { .. });
                let text = "libfranka: UDP receive: Timeout (no robot state for 1000 ms)";
                let outcome = so_far(&trial).expect("resolved at the timeout");
                Expect::Other(lost, text.to_owned()).check(&trial, &outcome);
                assert!(trial.lockstep.client.driver.is_watching());
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

/// States keep arriving, and the robot keeps waiting for the commands that answer them.
#[test]
fn commands_that_never_arrive_end_the_motion_where_it_has_begun() {
    let mut matrix = Matrix::new("no-command");
    for (variant, _) in Variant::cyclic() {
        for cycle in [1, course::REST + course::RAMP, course::END - 1] {
            matrix.case(format_args!("{variant}/{cycle}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(Moment::Cycle(cycle));
                trial.lockstep.link.drop_commands(u64::MAX);
                let outcome = trial.outcome();
                let error = RobotError::CommunicationConstraintsViolation;
                Expect::reflex([error]).check(&trial, &outcome);
                trial.works_again();
            });
        }
        // Before the first command the robot waits, and libfranka repeats the last one forever.
        matrix.case(format_args!("{variant}/first"), || {
            let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
            trial.lockstep.link.drop_commands(u64::MAX);
            trial.until(Moment::Finishing(30));
            trial.lockstep.jump(END_TIMEOUT.as_millis() as u64 - 32);
            assert_eq!(so_far(&trial), None);
            trial.lockstep.jump(32);
            let outcome = trial.outcome();
            protocol("the robot did not end the finished motion").check(&trial, &outcome);
            trial.works_again();
        });
    }
    matrix.finish();
}
