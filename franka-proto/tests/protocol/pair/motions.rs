//! `Move` and its two answers.

use franka_proto::{
    Command, CommandId, DecodeError, MoveStatus, Refusal, Reply, ReplyError, Request, RobotMode,
    StopStatus, Version, Violation, client, server,
};

use super::{Pair, joint_motion, message, raw_reply};

#[test]
fn a_motion_is_answered_twice_under_one_id() {
    for version in Version::ALL {
        let mut pair = Pair::connected(version);
        let id = pair.request(&joint_motion());
        assert_eq!(id, CommandId(1));
        pair.reply(id, Reply::Move(MoveStatus::MotionStarted));
        assert_eq!(pair.client.pending(), 1);
        pair.reply(id, Reply::Move(MoveStatus::Success));
        assert_eq!(pair.client.pending(), 0);
        let error = pair.server.reply(id, Reply::Move(MoveStatus::Success));
        assert_eq!(error.unwrap_err(), ReplyError::NotPending { id });
    }
}

#[test]
fn a_stop_and_the_motion_it_ends_are_answered_in_any_order() {
    for version in Version::ALL {
        for stop_first in [false, true] {
            let mut pair = Pair::connected(version);
            let motion = pair.request(&joint_motion());
            pair.reply(motion, Reply::Move(MoveStatus::MotionStarted));
            let stop = pair.request(&Request::StopMove);
            let replies = [
                (motion, Reply::Move(MoveStatus::Preempted)),
                (stop, Reply::StopMove(StopStatus::Success)),
            ];
            let order = if stop_first { [1, 0] } else { [0, 1] };
            for index in order {
                let (id, reply) = replies[index];
                pair.reply(id, reply);
            }
            assert_eq!(pair.client.pending(), 0);
        }
    }
}

#[test]
fn a_motion_refused_at_once_has_one_answer() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&joint_motion());
    let reply = Reply::Move(MoveStatus::CommandNotPossibleRejected);
    pair.reply(id, reply);
    assert_eq!(pair.client.pending(), 0);
    let refusal = Refusal::from_reply(Command::Move, &reply, RobotMode::Reflex).unwrap();
    assert_eq!(
        refusal.to_string(),
        r#"libfranka: Move command rejected: command not possible in the current mode ("Reflex")!"#
    );
}

#[test]
fn a_second_start_is_a_violation_and_the_motion_goes_on() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&joint_motion());
    pair.reply(id, Reply::Move(MoveStatus::MotionStarted));
    let again = pair
        .server
        .reply(id, Reply::Move(MoveStatus::MotionStarted));
    assert_eq!(again.unwrap_err(), ReplyError::AlreadyStarted { id });

    let bytes = raw_reply(id.0, &[1]);
    let error = pair.receive(&bytes).unwrap_err();
    assert_eq!(error, Violation::SecondMotionStarted { id });
    assert!(!error.is_fatal());
    assert_eq!(
        error.to_string(),
        "libfranka: Move received unexpected motion started message."
    );
    pair.reply(id, Reply::Move(MoveStatus::Success));
}

#[test]
fn move_with_unknown_mode_is_an_invalid_argument() {
    for version in Version::ALL {
        let mut pair = Pair::connected(version);
        let outgoing = pair.client.request(&joint_motion()).unwrap();
        let mut bytes = outgoing.as_bytes().to_vec();
        bytes[16] = 9;
        let event = pair.deliver_bytes(&bytes).unwrap();
        let server::Event::Rejected { id, error, reply } = event else {
            panic!("{event:?}");
        };
        let field = "motion_generator_mode";
        assert_eq!(error, DecodeError::UnknownValue { field, value: 9 });
        let event = pair.client.on_message(message(&reply)).unwrap();
        let expected = client::Event::Reply {
            id,
            command: Command::Move,
            reply: Reply::Move(MoveStatus::InvalidArgumentRejected),
        };
        assert_eq!(event, expected);
    }
}
