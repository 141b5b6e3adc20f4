//! Replies of variable length: the description of protocol 10, and the library of protocol 5.

use franka_proto::framing::next_message;
use franka_proto::{
    Command, LibraryStatus, ModelStatus, Reply, ReplyError, Request, Version, client, server,
};

use super::{Pair, library, message};

#[test]
fn a_model_comes_whole_and_its_text_is_sent_behind_the_header() {
    let urdf = "<robot name=\"fr3\"/>".repeat(3000);
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::GetRobotModel);
    let header = pair.server.model_header(id, urdf.len()).unwrap();
    let mut stream = header.as_bytes().to_vec();
    assert_eq!(next_message(&stream), Ok(None));
    stream.extend(urdf.as_bytes());
    let message = next_message(&stream).unwrap().unwrap();
    let event = pair.client.on_message(message).unwrap();
    let expected = client::Event::Reply {
        id,
        command: Command::GetRobotModel,
        reply: Reply::Model {
            status: ModelStatus::Success,
            text: urdf.as_bytes(),
        },
    };
    assert_eq!(event, expected);
}

#[test]
fn a_model_text_never_goes_into_the_fixed_buffer() {
    let mut pair = Pair::connected(Version::V10);
    let id = pair.request(&Request::GetRobotModel);
    let (status, text) = (ModelStatus::Success, &b"<robot/>"[..]);
    let error = pair.server.reply(id, Reply::Model { status, text });
    assert_eq!(error.unwrap_err(), ReplyError::TextLength { len: 8 });
    let error = pair.server.model_header(id, usize::MAX).unwrap_err();
    assert_eq!(error, ReplyError::TextLength { len: usize::MAX });
    assert!(pair.server.model_header(id, 8).is_ok());
}

#[test]
fn library_for_unknown_system_fails_but_session_goes_on() {
    let mut pair = Pair::connected(Version::V5);
    let outgoing = pair.client.request(&library()).unwrap();
    let mut bytes = outgoing.as_bytes().to_vec();
    bytes[13] = 2;
    let event = pair.deliver_bytes(&bytes).unwrap();
    let server::Event::Rejected { id, reply, .. } = event else {
        panic!("{event:?}");
    };
    let event = pair.client.on_message(message(&reply)).unwrap();
    let expected = Reply::ModelLibrary {
        status: LibraryStatus::Error,
        library: &[],
    };
    assert!(matches!(event, client::Event::Reply { reply, .. } if reply == expected));
    assert!(!pair.client.abandon(id));
    pair.request(&Request::StopMove);
}
