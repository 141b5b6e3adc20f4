//! Every scenario is run twice. The first time its bytes become a cassette, as a tap records them;
//! the second time the cassette is the robot, and accepts nothing but the recorded bytes.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::time::Duration;

use franka_record::cassette::{
    Cassette, Connection, Device, Event, Matching, Output, Pace, Payload, PlayOptions, Player, Side,
};

/// Treatment of connections that a scenario opens.
enum Studio {
    /// They are recorded, in the order in which they were opened.
    Recording(Vec<Option<Connection>>),
    /// They are played, in this order.
    Playing(VecDeque<Connection>),
}

thread_local! {
    static STUDIO: RefCell<Studio> = const { RefCell::new(Studio::Recording(Vec::new())) };
}

/// The bytes of a connection on their way between a client and the robot of a scenario.
pub(crate) struct Tape(Way);

enum Way {
    Recorded {
        number: usize,
        connection: Connection,
    },
    Played(Box<Player>),
}

/// Runs a scenario, and again against its recording. The scenario's assertions check that the
/// outcome is the same.
pub(crate) fn recorded_and_replayed(scenario: impl Fn()) {
    let cassette = recorded(&scenario);
    let file = cassette.to_bytes().expect("few channels");
    let read = Cassette::read(&file).expect("just written");
    assert_eq!(read, cassette);
    replayed(read, &scenario);
}

/// Runs a scenario and returns its cassette.
pub(crate) fn recorded(scenario: impl Fn()) -> Cassette {
    STUDIO.set(Studio::Recording(Vec::new()));
    scenario();
    let Studio::Recording(connections) = STUDIO.replace(Studio::Recording(Vec::new())) else {
        panic!("nothing else changes it");
    };
    let connections = connections.into_iter();
    Cassette {
        connections: connections.map(|one| one.expect("ended")).collect(),
        ..Cassette::default()
    }
}

/// Runs a scenario against a cassette.
pub(crate) fn replayed(cassette: Cassette, scenario: impl Fn()) {
    STUDIO.set(Studio::Playing(cassette.connections.into()));
    scenario();
    let Studio::Playing(left) = STUDIO.replace(Studio::Recording(Vec::new())) else {
        panic!("nothing else changes it");
    };
    assert!(left.is_empty(), "every connection is opened again");
}

impl Tape {
    /// The tape of a connection that is opened now.
    pub(crate) fn new(device: Device) -> Self {
        let way = STUDIO.with_borrow_mut(|studio| match studio {
            Studio::Recording(connections) => {
                connections.push(None);
                Way::Recorded {
                    number: connections.len() - 1,
                    connection: Connection::new(device),
                }
            }
            Studio::Playing(connections) => {
                let connection = connections.pop_front().expect("as many as recorded");
                let mut options = PlayOptions::default();
                (options.matching, options.pace) = (Matching::Strict, Pace::Lockstep);
                let player = Player::new(&connection, options, Duration::ZERO);
                Way::Played(Box::new(player.expect("a whole recording")))
            }
        });
        Self(way)
    }

    /// Bytes of the client arrive at the robot.
    pub(crate) fn on_request(&mut self, bytes: &[u8]) {
        match &mut self.0 {
            Way::Recorded { connection, .. } => {
                note(connection, Side::Client, Payload::Stream(bytes.to_vec()));
            }
            Way::Played(player) => player.on_stream(bytes).expect("the recorded request"),
        }
    }

    /// A datagram of the client arrives at the robot.
    pub(crate) fn on_command(&mut self, bytes: &[u8]) {
        match &mut self.0 {
            Way::Recorded { connection, .. } => {
                note(connection, Side::Client, Payload::Datagram(bytes.to_vec()));
            }
            Way::Played(player) => player.on_datagram(bytes).expect("the recorded command"),
        }
    }

    /// Returns the bytes that reach the client when the robot sends these: the same, or the
    /// cassette's.
    pub(crate) fn reply(&mut self, bytes: Vec<u8>) -> Vec<u8> {
        match &mut self.0 {
            Way::Recorded { connection, .. } => {
                note(connection, Side::Robot, Payload::Stream(bytes.clone()));
                bytes
            }
            Way::Played(player) => match player.poll(Duration::ZERO) {
                Ok(Some(Output::Stream(played))) => {
                    assert_eq!(played, bytes);
                    played
                }
                other => panic!("expected a reply, got {other:?}"),
            },
        }
    }

    /// Returns the datagram that reaches the client when the robot sends this one: the same, or the
    /// cassette's.
    pub(crate) fn send_state(&mut self, bytes: &[u8]) -> Vec<u8> {
        match &mut self.0 {
            Way::Recorded { connection, .. } => {
                note(connection, Side::Robot, Payload::Datagram(bytes.to_vec()));
                bytes.to_vec()
            }
            Way::Played(player) => match player.poll(Duration::ZERO) {
                Ok(Some(Output::Datagram(played))) => {
                    assert_eq!(played, bytes);
                    played
                }
                other => panic!("expected a state, got {other:?}"),
            },
        }
    }
}

impl Drop for Tape {
    fn drop(&mut self) {
        if std::thread::panicking() {
            return;
        }
        match &mut self.0 {
            Way::Recorded { number, connection } => {
                let connection = std::mem::replace(connection, Connection::new(connection.device));
                STUDIO.with_borrow_mut(|studio| match studio {
                    Studio::Recording(connections) => connections[*number] = Some(connection),
                    Studio::Playing(_) => panic!("a connection outlives its scenario"),
                });
            }
            Way::Played(player) => {
                assert_eq!(player.poll(Duration::ZERO), Ok(None));
                assert!(player.is_finished(), "next is {}", player.awaited());
            }
        }
    }
}

/// Records an event; its time is its number, as scenarios have no clock.
fn note(connection: &mut Connection, from: Side, what: Payload) {
    let at = Duration::from_micros(connection.events.len() as u64);
    connection.events.push(Event { at, from, what });
}
