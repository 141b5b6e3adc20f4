//! Converts a cassette to a capture: a pcap file of raw IPv4 packets with times in nanoseconds.

use std::time::Duration;

use etherparse::PacketBuilder;

use crate::cassette::{Cassette, Connection, Payload, Side};

/// Converts a cassette to a pcap capture that Wireshark can open. The addresses are invented: the
/// client is 192.0.2.1, and the robot is 192.0.2.2.
#[must_use]
pub fn to_capture(cassette: &Cassette) -> Vec<u8> {
    let mut packets = Vec::new();
    for (number, connection) in cassette.connections.iter().enumerate() {
        let number = u16::try_from(number % 10_000).unwrap_or_default();
        Conversation::new(connection, number).packets(connection, &mut packets);
    }
    packets.sort_by_key(|(at, _)| *at);
    let mut file = HEADER.concat();
    for (at, packet) in packets {
        let time = Duration::from_nanos(cassette.started) + at;
        let seconds = u32::try_from(time.as_secs()).unwrap_or(u32::MAX);
        let length = packet.len() as u32;
        for field in [seconds, time.subsec_nanos(), length, length] {
            file.extend(field.to_le_bytes());
        }
        file.extend(packet);
    }
    file
}

/// The ports of a connection, and the current positions in its two streams.
struct Conversation {
    client_tcp: u16,
    client_udp: u16,
    robot_tcp: u16,
    robot_udp: u16,
    from_client: u32,
    from_robot: u32,
}

impl Conversation {
    fn new(connection: &Connection, number: u16) -> Self {
        let stream = connection.stream(Side::Client);
        let request = connection.device.connect(&stream);
        let announced = request.map(|request| request.udp_port.get());
        Self {
            client_tcp: CLIENT_PORTS + number,
            client_udp: announced.unwrap_or(CLIENT_PORTS + number),
            robot_tcp: connection.device.port(),
            robot_udp: ROBOT_PORTS + number,
            from_client: 1,
            from_robot: 1,
        }
    }

    fn packets(mut self, connection: &Connection, packets: &mut Vec<(Duration, Vec<u8>)>) {
        if let Some(first) = connection.events.first() {
            packets.push((first.at, self.tcp(Side::Client, Some(0), &[], false)));
            packets.push((first.at, self.tcp(Side::Robot, Some(0), &[], false)));
        }
        for event in &connection.events {
            match &event.what {
                Payload::Datagram(bytes) => packets.push((event.at, self.udp(event.from, bytes))),
                Payload::Stream(bytes) => {
                    for bytes in bytes.chunks(SEGMENT_MAX) {
                        packets.push((event.at, self.tcp(event.from, None, bytes, false)));
                        let sent = match event.from {
                            Side::Client => &mut self.from_client,
                            Side::Robot => &mut self.from_robot,
                        };
                        *sent = sent.wrapping_add(bytes.len() as u32);
                    }
                }
                Payload::End => packets.push((event.at, self.tcp(event.from, None, &[], true))),
            }
        }
    }

    fn tcp(&self, from: Side, opens: Option<u32>, payload: &[u8], ends: bool) -> Vec<u8> {
        let (source, destination, sequence, acknowledged) = match from {
            Side::Client => (
                self.client_tcp,
                self.robot_tcp,
                self.from_client,
                self.from_robot,
            ),
            Side::Robot => (
                self.robot_tcp,
                self.client_tcp,
                self.from_robot,
                self.from_client,
            ),
        };
        let sequence = opens.unwrap_or(sequence);
        let mut builder = addressed(from).tcp(source, destination, sequence, WINDOW);
        if opens.is_some() {
            builder = builder.syn();
        }
        if opens.is_none() || from == Side::Robot {
            builder = builder.ack(acknowledged);
        }
        if ends {
            builder = builder.fin();
        }
        let mut packet = Vec::with_capacity(builder.size(payload.len()));
        let written = builder.write(&mut packet, payload);
        written.expect("a segment is shorter than a packet may be");
        packet
    }

    fn udp(&self, from: Side, payload: &[u8]) -> Vec<u8> {
        let (source, destination) = match from {
            Side::Client => (self.client_udp, self.robot_udp),
            Side::Robot => (self.robot_udp, self.client_udp),
        };
        let payload = payload.get(..SEGMENT_MAX).unwrap_or(payload);
        let builder = addressed(from).udp(source, destination);
        let mut packet = Vec::with_capacity(builder.size(payload.len()));
        let written = builder.write(&mut packet, payload);
        written.expect("a datagram is shorter than a packet may be");
        packet
    }
}

fn addressed(from: Side) -> etherparse::PacketBuilderStep<etherparse::IpHeaders> {
    let (source, destination) = match from {
        Side::Client => (CLIENT, ROBOT),
        Side::Robot => (ROBOT, CLIENT),
    };
    PacketBuilder::ipv4(source, destination, HOPS)
}

/// File header: magic number for nanoseconds, version 2.4, time zone, accuracy, longest packet, and
/// link type 101 (raw IP).
const HEADER: [[u8; 4]; 6] = [
    0xa1b2_3c4d_u32.to_le_bytes(),
    [2, 0, 4, 0],
    [0; 4],
    [0; 4],
    65_535_u32.to_le_bytes(),
    101_u32.to_le_bytes(),
];

/// Address reserved for documentation (RFC 5737).
const CLIENT: [u8; 4] = [192, 0, 2, 1];
const ROBOT: [u8; 4] = [192, 0, 2, 2];

const CLIENT_PORTS: u16 = 40_000;
const ROBOT_PORTS: u16 = 50_000;
const SEGMENT_MAX: usize = 16_384;
const WINDOW: u16 = 65_535;
const HOPS: u8 = 64;
