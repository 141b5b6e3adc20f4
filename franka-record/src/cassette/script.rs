//! The steps for the playback of a recorded connection.

use std::time::Duration;

use franka_proto::framing::{FrameError, Message};
use franka_proto::{RobotCommand, Version};

use super::{Connection, Device, Payload, Side};

/// Reason why a recorded connection cannot be played back.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unplayable {
    /// The recording lacks pieces of a stream.
    #[error(
        "{missing} pieces of the {device}'s TCP streams are missing, expected complete streams"
    )]
    Missing {
        /// The device of the connection.
        device: Device,
        /// Number of missing pieces.
        missing: u64,
    },
    /// The client's stream cannot be split into messages.
    #[error("the client's stream to the {device} has no readable messages: {error}")]
    Framing {
        /// The device of the connection.
        device: Device,
        /// The error.
        error: FrameError,
    },
    /// The client's first message is not `Connect`.
    #[error("the client's first message to the {device} is {got}, expected Connect")]
    NoConnect {
        /// The device of the connection.
        device: Device,
        /// The client's first message.
        got: String,
    },
}

/// A step of the playback. The robot performs the step, or waits until the client performs it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The client sends this message.
    Request(Vec<u8>),
    /// The client sends this datagram.
    Command(Vec<u8>),
    /// The client closes its stream.
    ClientEnd,
    /// The robot sends this message, or bytes of its stream that are not a message.
    Reply(Vec<u8>),
    /// The robot sends this datagram.
    State(Vec<u8>),
    /// The robot closes its stream.
    RobotEnd,
}

/// The steps of a connection, with their times.
#[derive(Clone, Debug)]
pub(super) struct Script {
    pub(super) device: Device,
    /// Version that the client announced; 0 if the client sent no data.
    pub(super) version: u16,
    pub(super) steps: Vec<(Duration, Step)>,
    /// Mean time between states.
    pub(super) interval: Duration,
}

impl Script {
    pub(super) fn new(connection: &Connection) -> Result<Self, Unplayable> {
        let device = connection.device;
        if connection.missing_stream > 0 {
            let missing = connection.missing_stream;
            return Err(Unplayable::Missing { device, missing });
        }
        let mut version = None;
        let mut steps = Vec::with_capacity(connection.events.len());
        let (mut from_client, mut from_robot) = (Vec::new(), Vec::new());
        for event in &connection.events {
            let mut step = |step| steps.push((event.at, step));
            match (event.from, &event.what) {
                (Side::Client, Payload::Datagram(bytes)) => step(Step::Command(bytes.clone())),
                (Side::Robot, Payload::Datagram(bytes)) => step(Step::State(bytes.clone())),
                (Side::Client, Payload::End) => step(Step::ClientEnd),
                (Side::Robot, Payload::End) => {
                    if !from_robot.is_empty() {
                        step(Step::Reply(std::mem::take(&mut from_robot)));
                    }
                    step(Step::RobotEnd);
                }
                (Side::Client, Payload::Stream(bytes)) => {
                    from_client.extend_from_slice(bytes);
                    while let Some(message) = next(device, &mut from_client)
                        .map_err(|error| Unplayable::Framing { device, error })?
                    {
                        if version.is_none() {
                            version = Some(announced(device, &message)?);
                        }
                        step(Step::Request(message));
                    }
                }
                (Side::Robot, Payload::Stream(bytes)) => {
                    from_robot.extend_from_slice(bytes);
                    loop {
                        match next(device, &mut from_robot) {
                            Ok(Some(message)) => step(Step::Reply(message)),
                            Ok(None) => break,
                            // The player sends the robot's data unchanged, even if it is invalid.
                            Err(_) => {
                                step(Step::Reply(std::mem::take(&mut from_robot)));
                                break;
                            }
                        }
                    }
                }
            }
        }
        if let Some(&(at, _)) = steps.last()
            && !from_robot.is_empty()
        {
            steps.push((at, Step::Reply(from_robot)));
        }
        Ok(Self {
            device,
            version: version.unwrap_or_default(),
            interval: interval(device, &steps),
            steps,
        })
    }

    pub(super) fn describe(&self, step: &Step) -> String {
        match step {
            Step::Request(bytes) => match self.device.next_message(bytes) {
                Ok(Some(message)) => self.device.request_name(self.version, &message),
                _ => "a message that cannot be read".to_owned(),
            },
            Step::Command(bytes) => match counter(self.device, bytes) {
                Some(id) => format!("the command for state {id}"),
                None => "a datagram too short for a command".to_owned(),
            },
            Step::ClientEnd => "the end of the connection".to_owned(),
            Step::Reply(_) | Step::State(_) | Step::RobotEnd => "nothing".to_owned(),
        }
    }

    /// Returns true if the client ends a motion with this datagram.
    pub(super) fn finishes(&self, datagram: &[u8]) -> bool {
        let version = Version::from_number(self.version);
        version.is_some_and(|version| {
            RobotCommand::decode(version, datagram).is_ok_and(|command| {
                command.motion_generation_finished || command.torque_command_finished
            })
        })
    }
}

/// Removes and returns the first message of a stream, if it is complete.
fn next(device: Device, stream: &mut Vec<u8>) -> Result<Option<Vec<u8>>, FrameError> {
    let size = device
        .next_message(stream)?
        .map(|message: Message<'_>| message.size());
    Ok(size.map(|size| stream.drain(..size).collect()))
}

/// Returns the version in a client's first message.
fn announced(device: Device, message: &[u8]) -> Result<u16, Unplayable> {
    let request = device.connect(message);
    let version = request.map(|request| request.version.get());
    version.ok_or_else(|| {
        let message = device.next_message(message).ok().flatten();
        let got = message.map(|message| format!("command {}", message.header.command));
        Unplayable::NoConnect {
            device,
            got: got.unwrap_or_else(|| "none".to_owned()),
        }
    })
}

/// Returns the millisecond counter at the beginning of a datagram.
pub(super) fn counter(device: Device, datagram: &[u8]) -> Option<u64> {
    let mut wide = [0; 8];
    let size = device.counter_size();
    wide[..size].copy_from_slice(datagram.get(..size)?);
    Some(u64::from_le_bytes(wide))
}

/// Returns the mean time between the states of a connection.
fn interval(device: Device, steps: &[(Duration, Step)]) -> Duration {
    let mut states = steps
        .iter()
        .filter(|(_, step)| matches!(step, Step::State(_)))
        .map(|(at, _)| *at);
    let first = states.next();
    let (gaps, last) = states.fold((0, None), |(count, _), at| (count + 1, Some(at)));
    let mean = first
        .zip(last)
        .map(|(first, last)| last.saturating_sub(first) / gaps);
    match device {
        Device::Robot => INTERVAL_MIN,
        Device::Hand | Device::VacuumGripper => mean
            .unwrap_or(INTERVAL_MAX)
            .clamp(INTERVAL_MIN, INTERVAL_MAX),
    }
}

/// Smallest and largest interval between repeated states. Robots send one state per millisecond.
/// Clients regard an end effector as lost if its states are slower than the upper bound.
const INTERVAL_MIN: Duration = Duration::from_millis(1);
const INTERVAL_MAX: Duration = Duration::from_millis(200);
