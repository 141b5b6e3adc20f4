//! A recording with live viewers.

use std::collections::BTreeMap;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

use franka_model::RobotKind;
use franka_record::recorder::{Live, RecordError, Recorder, Robot};
use franka_record::schema::{Message as _, foxglove, franka};
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

use crate::feed::{Arm, Scratch, quick};

/// A viewer, like Foxglove's application.
struct Viewer {
    socket: WebSocket<TcpStream>,
    /// The offered channels: their numbers and contents, by name.
    channels: BTreeMap<String, (u64, String)>,
}

impl Viewer {
    fn connect(address: SocketAddr) -> Self {
        let mut request = format!("ws://{address}/").into_client_request().unwrap();
        let protocol = "foxglove.sdk.v1".parse().unwrap();
        let headers = request.headers_mut();
        headers.insert("Sec-WebSocket-Protocol", protocol);
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = tungstenite::client(request, stream).unwrap();
        Self {
            socket,
            channels: BTreeMap::new(),
        }
    }

    /// Waits until the server has offered `count` channels.
    fn wait_for_channels(&mut self, count: usize) {
        while self.channels.len() < count {
            let Message::Text(text) = self.socket.read().unwrap() else {
                continue;
            };
            let message: Value = serde_json::from_str(&text).unwrap();
            if message["op"] != "advertise" {
                continue;
            }
            for channel in message["channels"].as_array().unwrap() {
                assert_eq!(channel["encoding"], "protobuf");
                assert!(!channel["schema"].as_str().unwrap().is_empty());
                let text = |key: &str| channel[key].as_str().unwrap().to_owned();
                let id = channel["id"].as_u64().unwrap();
                self.channels
                    .insert(text("topic"), (id, text("schemaName")));
            }
        }
    }

    /// Subscribes to channels, which are numbered in the given order.
    fn subscribe(&mut self, topics: &[&str]) {
        let wanted = topics
            .iter()
            .enumerate()
            .map(|(number, topic)| json!({ "id": number, "channelId": self.channels[*topic].0 }));
        let wanted: Vec<_> = wanted.collect();
        let order = json!({ "op": "subscribe", "subscriptions": wanted });
        self.socket.send(Message::text(order.to_string())).unwrap();
    }

    /// Returns the next message: the number of its channel, and its bytes.
    fn next(&mut self) -> (u32, Vec<u8>) {
        loop {
            if let Message::Binary(bytes) = self.socket.read().unwrap()
                && bytes[0] == 1
            {
                let number = u32::from_le_bytes(bytes[1..5].try_into().unwrap());
                return (number, bytes[13..].to_vec());
            }
        }
    }
}

fn anywhere() -> Live {
    Live {
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        every: 1,
    }
}

#[test]
fn viewers_see_the_messages_of_every_robot_while_they_come() {
    let scratch = Scratch::new();
    let recorder = Recorder::to_file(scratch.path("run.mcap"), quick()).unwrap();
    let (mut left, _) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3).named("left"));
    let address = recorder.serve(&anywhere()).unwrap();
    let mut viewers = [Viewer::connect(address), Viewer::connect(address)];
    for viewer in &mut viewers {
        viewer.wait_for_channels(9);
    }
    let (_right, _) = Arm::attach(&recorder, Robot::new(RobotKind::Fer).named("right"));
    for viewer in &mut viewers {
        viewer.wait_for_channels(18);
        viewer.subscribe(&["/left/cycle", "/left/tf"]);
        assert_eq!(viewer.channels["/left/cycle"].1, "franka.Cycle");
        assert_eq!(viewer.channels["/right/tf"].1, "foxglove.FrameTransforms");
    }
    // The server is notified after some time.
    let (cycles, transforms) = std::thread::scope(|scope| {
        let watching = scope.spawn(|| {
            let seen = viewers.each_mut().map(|viewer| {
                loop {
                    let (number, bytes) = viewer.next();
                    if number == 1 {
                        break (viewer.next(), bytes);
                    }
                }
            });
            seen.map(|((number, cycle), tf)| {
                assert_eq!(number, 0);
                let tf = foxglove::FrameTransforms::decode(&*tf).unwrap();
                (franka::Cycle::decode(&*cycle).unwrap(), tf.transforms.len())
            })
        });
        while !watching.is_finished() {
            left.step();
            std::thread::sleep(Duration::from_millis(1));
        }
        watching
            .join()
            .unwrap()
            .into_iter()
            .unzip::<_, _, Vec<_>, Vec<_>>()
    });
    for cycle in cycles {
        let (state, _) = left.cycle_at(cycle.robot_time);
        assert_eq!(cycle.q, state.q);
    }
    assert!(transforms.iter().all(|count| *count >= 9), "{transforms:?}");
    left.wait(&recorder);
    let status = recorder.finish().unwrap();
    assert_eq!((status.cycles, status.dropped), (left.cycles(), 0));
    for mut viewer in viewers {
        // The server has closed the connection.
        while viewer.socket.read().is_ok() {}
    }
}

#[test]
fn a_viewer_that_never_reads_costs_the_recording_nothing() {
    let (recorder, address) = Recorder::live(&anywhere()).unwrap();
    let (mut arm, _) = Arm::attach(&recorder, Robot::new(RobotKind::Fr3));
    let mut deaf = Viewer::connect(address);
    deaf.wait_for_channels(9);
    deaf.subscribe(&["/cycle"]);
    let mut gone = Viewer::connect(address);
    gone.wait_for_channels(9);
    gone.subscribe(&["/cycle"]);
    drop(gone);
    arm.run(&recorder, 30_000);
    // It receives the newest messages, not all of them.
    let mut newest = 0;
    while newest < arm.cycles() {
        let (_, bytes) = deaf.next();
        newest = franka::Cycle::decode(&*bytes).unwrap().robot_time;
    }
    let status = recorder.finish().unwrap();
    assert_eq!((status.cycles, status.dropped), (30_000, 0));
}

#[test]
fn an_address_that_is_taken_is_told_at_once() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let live = Live {
        address: taken.local_addr().unwrap(),
        ..anywhere()
    };
    let error = Recorder::live(&live).map(drop).unwrap_err();
    assert!(matches!(error, RecordError::Live { .. }), "{error}");
    assert!(
        error.to_string().contains(&live.address.to_string()),
        "{error}"
    );
    let never = Live {
        every: 0,
        ..anywhere()
    };
    let error = Recorder::live(&never).map(drop).unwrap_err();
    assert!(error.to_string().contains("live.every is 0"), "{error}");
}

const PATIENCE: Duration = Duration::from_secs(60);
