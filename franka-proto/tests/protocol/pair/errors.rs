//! Reaction of each side to errors of the other side.

use franka_proto::{
    Command, CommandId, DecodeError, RecoveryStatus, Reply, ReplyError, Request, RequestError,
    SetterStatus, StopStatus, Version, Violation, client, server,
};

use super::{Pair, joint_motion, message, raw_reply};

#[test]
fn unexpected_replies_are_reported_and_change_nothing() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::StopMove);
    let bytes = raw_reply(99, &[0]);
    let event = pair.receive(&bytes);
    let unmatched = |id| client::Event::Unmatched { id };
    assert_eq!(event, Ok(unmatched(CommandId(99))));
    assert_eq!(pair.client.pending(), 1);

    assert!(pair.client.abandon(id));
    assert!(!pair.client.abandon(id));
    let late = pair
        .server
        .reply(id, Reply::StopMove(StopStatus::Success))
        .unwrap();
    assert_eq!(pair.client.on_message(message(&late)), Ok(unmatched(id)));
}

#[test]
fn an_unreadable_reply_ends_its_request_and_no_other() {
    let mut pair = Pair::connected(Version::V10);
    let motion = pair.request(&joint_motion());
    let setter = pair.request(&Request::SetLoad(Default::default()));
    let stop = pair.request(&Request::StopMove);

    let bytes = raw_reply(setter.0, &[77]);
    let error = pair.receive(&bytes).unwrap_err();
    assert_eq!((error.id(), error.is_fatal()), (Some(setter), false));
    assert_eq!(
        error.to_string(),
        "libfranka: Unexpected response while handling Set Load command!"
    );

    let bytes = raw_reply(motion.0, &[]);
    let error = pair.receive(&bytes).unwrap_err();
    let size = DecodeError::MessageSize {
        got: 12,
        expected: 13,
    };
    let expected = Violation::Reply {
        id: motion,
        error: size,
    };
    assert_eq!(error, expected);
    assert_eq!(error.to_string(), "libfranka: Incorrect TCP message size.");

    pair.reply(stop, Reply::StopMove(StopStatus::Success));
    assert_eq!(pair.client.pending(), 0);
}

#[test]
fn padded_replies_are_accepted() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::StopMove);
    let bytes = raw_reply(id.0, &[0, 0, 0, 0]);
    let event = pair.receive(&bytes);
    assert!(
        matches!(event, Ok(client::Event::Reply { .. })),
        "{event:?}"
    );
}

#[test]
fn pending_requests_are_bounded_on_both_sides() {
    let limit = <client::Session>::PENDING_LIMIT;
    let mut pair = Pair::connected(Version::V10);
    for _ in 0..limit {
        pair.request(&Request::AutomaticErrorRecovery);
    }
    let error = pair.client.request(&Request::StopMove).unwrap_err();
    assert_eq!(error, RequestError::TooManyPending { limit });

    let id = CommandId(1000);
    let one_more = Request::StopMove.encode(Version::V10, id).unwrap();
    let limit = <server::Session>::PENDING_LIMIT;
    let error = pair.deliver(&one_more).unwrap_err();
    assert_eq!(error, Violation::TooManyPending { limit });
    // An answer frees an entry on both sides.
    pair.reply(CommandId(1), Reply::Recovery(RecoveryStatus::Success));
    pair.request(&Request::StopMove);
}

#[test]
fn a_client_that_leaves_the_protocol_is_reported() {
    let mut pair = Pair::connected(Version::V10);
    let hello = client::Session::new(Version::V10).connect(1);
    assert_eq!(pair.deliver(&hello), Err(Violation::SecondConnect));

    let id = pair.request(&Request::StopMove);
    let again = Request::StopMove.encode(Version::V10, id).unwrap();
    assert_eq!(pair.deliver(&again), Err(Violation::RepeatedId { id }));

    let mut bytes = raw_reply(7, &[]);
    bytes[0] = 200;
    let error = pair.deliver_bytes(&bytes).unwrap_err();
    assert!(error.is_fatal());
    assert_eq!(error.to_string(), "protocol 10 has no command 200");
}

#[test]
fn a_robot_answers_with_the_right_kind_of_reply_only() {
    let mut pair = Pair::connected(Version::V5);
    let id = pair.request(&Request::StopMove);
    let error = pair.server.reply(id, Reply::Setter(SetterStatus::Success));
    let command = Command::StopMove;
    assert_eq!(error.unwrap_err(), ReplyError::Mismatch { id, command });
    // Protocol 5 has no safety functions.
    let safety = StopStatus::CommandRejectedDueToActivatedSafetyFunctions;
    let error = pair.server.reply(id, Reply::StopMove(safety));
    let version = Version::V5;
    assert_eq!(error.unwrap_err(), ReplyError::Unsupported { version });
    pair.reply(id, Reply::StopMove(StopStatus::Success));
}
