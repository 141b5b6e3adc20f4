//! No robot, or a robot of another version.

use std::net::{Ipv4Addr, TcpListener};

use franka_async::error::ConnectError;
use franka_async::{Realtime, Robot};
use franka_proto::framing::next_message;
use franka_proto::{Version, client, server};

use franka_record::cassette::Device;

use crate::for_each_version;
use crate::tape::Tape;

/// Over a real socket, which refuses the connection. `tests/live/connecting.rs` has more such
/// cases.
#[tokio::test]
async fn scenario_17_no_server_listens() {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let address = listener.local_addr().expect("bound");
    drop(listener);
    let connected = Robot::builder(address).realtime(Realtime::Ignore).connect();
    let error = connected.await.expect_err("no server listens");
    assert!(matches!(error, ConnectError::Refused { .. }), "{error:?}");
    let text = "libfranka: Connection to FCI refused. Please install FCI feature or enable FCI mode in Desk.";
    assert_eq!(error.to_string(), format!("{text} ({address})"));
}

#[test]
fn scenario_17_a_robot_of_the_other_version_names_both() {
    for_each_version(|version| {
        let [other] = Version::ALL
            .into_iter()
            .filter(|other| *other != version)
            .collect::<Vec<_>>()[..]
        else {
            panic!("there are two versions")
        };
        let mut session = client::Session::new(version);
        let hello = session.connect(40_000);
        let mut tape = Tape::new(Device::Robot);
        tape.on_request(hello.as_bytes());
        let hello = next_message(hello.as_bytes()).expect("well-formed");
        let mut robot = server::Session::new(other);
        let event = robot.on_message(hello.expect("whole"));
        let Ok(server::Event::Incompatible {
            version: announced,
            reply,
        }) = event
        else {
            panic!("{event:?}")
        };
        assert_eq!(announced, version.number());
        let reply = tape.reply(reply.as_bytes().to_vec());
        let reply = next_message(&reply).expect("well-formed");
        let event = session.on_message(reply.expect("whole"));
        let Ok(client::Event::Incompatible(error)) = event else {
            panic!("{event:?}")
        };
        assert_eq!(error.server_version, other.number());
        assert_eq!(error.library_version, version);
        assert!(!session.is_connected());
        let text = match version {
            Version::V10 => {
                "libfranka: Incompatible library version (server version: 5, library version: 10). \
                 Please check https://frankarobotics.github.io for system updates or choose a libfranka \
                 version that uses the server version 5 from the table at \
                 https://frankarobotics.github.io/docs/libfranka/docs/compatibility_with_images.html ."
            }
            Version::V5 => {
                "libfranka: Incompatible library version (server version: 10, library version: 5). \
                 Please check https://frankaemika.github.io for Panda system updates or choose a \
                 libfranka version that uses the server version 10 from the table at \
                 https://frankaemika.github.io/docs/compatibility.html ."
            }
        };
        assert_eq!(error.to_string(), text);
    });
}
