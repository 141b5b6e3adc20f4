//! Groups packets into connections. Puts the streams in order, and assigns datagrams to connections
//! by the port in `Connect`.

use std::collections::{BTreeMap, HashMap};
use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use super::packets::{Body, Packet, Segment};
use crate::cassette::{Cassette, Connection, Device, Event, Payload, Side};

/// The connections found in a capture so far.
#[derive(Default)]
pub(super) struct Sessions {
    started: Option<u64>,
    sessions: Vec<Session>,
    /// Open connections, by client and device.
    open: HashMap<(SocketAddr, SocketAddr), usize>,
    /// Connections by two addresses: the client's address for datagrams, and the robot's IP
    /// address.
    announced: HashMap<(SocketAddr, IpAddr), usize>,
}

struct Session {
    connection: Connection,
    client: SocketAddr,
    robot: SocketAddr,
    from_client: Stream,
    from_robot: Stream,
    /// The client's bytes up to `Connect`.
    hello: Option<Vec<u8>>,
}

/// One direction of a TCP stream.
#[derive(Default)]
struct Stream {
    /// Sequence number of the next byte.
    next: Option<u32>,
    /// Segments that arrived before a missing segment.
    early: BTreeMap<u32, Vec<u8>>,
    end: Option<u32>,
    ended: bool,
}

impl Sessions {
    pub(super) fn on_packet(&mut self, packet: &Packet) {
        let started = *self.started.get_or_insert(packet.time);
        let at = Duration::from_nanos(packet.time.saturating_sub(started));
        match &packet.body {
            Body::Tcp(segment) => self.on_segment(at, segment),
            Body::Udp { from, to, payload } => self.on_datagram(at, *from, *to, payload),
            Body::Cut { from, to } => {
                if let Some((index, _)) = self.connection_of(*from, *to) {
                    self.sessions[index].connection.missing_datagrams += 1;
                }
            }
            Body::Other => {}
        }
    }

    pub(super) fn finish(self) -> Cassette {
        let connections = self.sessions.into_iter().map(|mut session| {
            let missing = [&session.from_client, &session.from_robot].map(Stream::missing);
            session.connection.missing_stream = missing.iter().sum();
            session.connection
        });
        let connections: Vec<_> = connections.collect();
        Cassette {
            started: self.started.unwrap_or_default(),
            dropped: connections
                .iter()
                .map(|one| one.missing_stream + one.missing_datagrams)
                .sum(),
            connections,
            ..Cassette::default()
        }
    }

    fn on_segment(&mut self, at: Duration, segment: &Segment) {
        let (from, client, robot) = if Device::with_port(segment.to.port()).is_some() {
            (Side::Client, segment.from, segment.to)
        } else {
            (Side::Robot, segment.to, segment.from)
        };
        let Some(device) = Device::with_port(robot.port()) else {
            return;
        };
        let new = from == Side::Client && segment.opens;
        let known = self.open.get(&(client, robot)).copied();
        // The client reuses its port for a new connection. In a repeated packet, the sequence
        // number would be the same.
        let reopened = new
            && known.is_some_and(|index| {
                let stream = &self.sessions[index].from_client;
                stream.ended || stream.next != Some(segment.sequence.wrapping_add(1))
            });
        let index = match known {
            Some(index) if !reopened => index,
            _ => {
                self.sessions.push(Session {
                    connection: Connection::new(device),
                    client,
                    robot,
                    from_client: Stream::default(),
                    from_robot: Stream::default(),
                    hello: Some(Vec::new()),
                });
                let index = self.sessions.len() - 1;
                self.open.insert((client, robot), index);
                index
            }
        };
        let session = &mut self.sessions[index];
        let stream = match from {
            Side::Client => &mut session.from_client,
            Side::Robot => &mut session.from_robot,
        };
        for what in stream.take(segment) {
            if let (Side::Client, Payload::Stream(bytes), Some(hello)) =
                (from, &what, &mut session.hello)
            {
                hello.extend_from_slice(bytes);
                if let Some(request) = device.connect(hello) {
                    session.hello = None;
                    let port = request.udp_port.get();
                    let client = SocketAddr::new(session.client.ip(), port);
                    self.announced.insert((client, session.robot.ip()), index);
                }
            }
            session.connection.events.push(Event { at, from, what });
        }
    }

    fn on_datagram(&mut self, at: Duration, from: SocketAddr, to: SocketAddr, payload: &[u8]) {
        let Some((index, from)) = self.connection_of(from, to) else {
            return;
        };
        let what = Payload::Datagram(payload.to_vec());
        let events = &mut self.sessions[index].connection.events;
        events.push(Event { at, from, what });
    }

    fn connection_of(&self, from: SocketAddr, to: SocketAddr) -> Option<(usize, Side)> {
        let to_client = self.announced.get(&(to, from.ip()));
        let of_client = self.announced.get(&(from, to.ip()));
        match (to_client, of_client) {
            (Some(&index), _) => Some((index, Side::Robot)),
            (None, Some(&index)) => Some((index, Side::Client)),
            (None, None) => None,
        }
    }
}

impl Stream {
    /// Returns the bytes that a segment adds to the stream, in order.
    fn take(&mut self, segment: &Segment) -> Vec<Payload> {
        let mut events = Vec::new();
        if self.ended {
            return events;
        }
        if segment.opens {
            self.next.get_or_insert(segment.sequence.wrapping_add(1));
            return events;
        }
        // If the capture starts later than the connection, the first captured segment is the
        // beginning of the stream.
        let next = self.next.get_or_insert(segment.sequence);
        if !segment.payload.is_empty() {
            let longest = self.early.get(&segment.sequence).map_or(0, Vec::len);
            if segment.payload.len() > longest && self.early.len() < EARLY_MAX {
                self.early.insert(segment.sequence, segment.payload.clone());
            }
        }
        while let Some((&sequence, _)) = self
            .early
            .iter()
            .find(|(sequence, _)| ahead(**sequence, *next) <= 0)
        {
            let payload = self.early.remove(&sequence).unwrap_or_default();
            let known = usize::try_from(ahead(*next, sequence)).unwrap_or_default();
            if let Some(fresh) = payload.get(known..)
                && !fresh.is_empty()
            {
                *next = next.wrapping_add(fresh.len() as u32);
                events.push(Payload::Stream(fresh.to_vec()));
            }
        }
        if segment.ends {
            let length = segment.payload.len() as u32;
            self.end = Some(segment.sequence.wrapping_add(length));
        }
        if segment.resets || self.end.is_some_and(|end| ahead(end, *next) <= 0) {
            self.ended = true;
            events.push(Payload::End);
        }
        events
    }

    /// Returns the number of pieces that do not directly follow the data before them.
    fn missing(&self) -> u64 {
        self.early.len() as u64
    }
}

/// Returns how far `one` is ahead of `other` in the sequence numbers of a stream, which wrap
/// around.
fn ahead(one: u32, other: u32) -> i32 {
    one.wrapping_sub(other).cast_signed()
}

/// Largest number of segments that wait for a missing segment. A stream with a gap cannot be played
/// back.
const EARLY_MAX: usize = 1024;

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(sequence: u32, payload: &[u8]) -> Segment {
        let any = SocketAddr::from(([127, 0, 0, 1], 1));
        Segment {
            from: any,
            to: any,
            sequence,
            opens: false,
            ends: false,
            resets: false,
            payload: payload.to_vec(),
        }
    }

    /// The segments arrive in any order, even where the sequence numbers wrap around.
    #[test]
    fn segments_are_put_in_order_and_repeated_ones_left_out() {
        let begin = u32::MAX - 2;
        let segments = [(0, 3), (3, 5), (2, 6), (0, 8), (5, 8), (8, 9)];
        let bytes: Vec<u8> = (0..9).collect();
        for first in 0..segments.len() {
            for second in 0..segments.len() {
                let mut order = segments;
                order.swap(0, first);
                order.swap(1, second);
                let mut stream = Stream {
                    next: Some(begin),
                    ..Stream::default()
                };
                let mut got = Vec::new();
                for (from, to) in order {
                    let sequence = begin.wrapping_add(from as u32);
                    for event in stream.take(&segment(sequence, &bytes[from..to])) {
                        let Payload::Stream(bytes) = event else {
                            panic!("{event:?}")
                        };
                        got.extend(bytes);
                    }
                }
                assert_eq!(got, bytes);
                assert_eq!(stream.missing(), 0);
            }
        }
    }

    #[test]
    fn a_hole_is_counted() {
        let mut stream = Stream::default();
        assert_eq!(stream.take(&segment(10, &[1])).len(), 1);
        assert_eq!(stream.take(&segment(12, &[3])), []);
        assert_eq!(stream.missing(), 1);
    }
}
