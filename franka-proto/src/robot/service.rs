//! The robot's protocol as an implementation of [`Protocol`].

use super::{MoveStatus, Reply, Request};
use crate::command::{Command, CommandId};
use crate::framing::Message;
use crate::outgoing::Outgoing;
use crate::protocol::{
    ConnectStatus, DecodeError, FieldDevice, Progress, Protocol, ReplyError, RequestError, sealed,
};
use crate::version::Version;

impl sealed::Sealed for Version {}

impl Protocol for Version {
    type Command = Command;
    type Request = Request;
    type Reply<'a> = Reply<'a>;

    fn number(self) -> u16 {
        self.number()
    }

    fn device(self) -> &'static str {
        "robot"
    }

    fn field(number: u16) -> Option<FieldDevice> {
        let known = FIELD.iter().find(|(known, _)| *known == number);
        known.map(|(_, device)| *device)
    }

    fn spoken() -> &'static [u16] {
        SPOKEN
    }

    fn incompatible_advice(self) -> [&'static str; 2] {
        self.table().incompatible_advice
    }

    fn command_of(request: &Request) -> Command {
        request.command()
    }

    fn connect(self, udp_port: u16) -> Request {
        let version = self.number();
        Request::Connect { version, udp_port }
    }

    fn handshake(request: &Request) -> Option<(u16, u16)> {
        match *request {
            Request::Connect { version, udp_port } => Some((version, udp_port)),
            _ => None,
        }
    }

    fn answer_handshake(self, status: ConnectStatus) -> Reply<'static> {
        let version = self.number();
        Reply::Connect { status, version }
    }

    fn rejection(self, message: &Message<'_>) -> Option<(Command, Reply<'static>)> {
        let command = self.command_from_number(message.header.command)?;
        Reply::to_unknown_value(command)
    }

    fn progress(reply: &Reply<'_>) -> Progress {
        match *reply {
            Reply::Connect { status, version } => Progress::Handshake(status, version),
            Reply::Move(MoveStatus::MotionStarted) => Progress::Started,
            _ => Progress::Ended,
        }
    }

    fn encode_request(self, request: &Request, id: CommandId) -> Result<Outgoing, RequestError> {
        request.encode(self, id)
    }

    fn decode_request(self, message: &Message<'_>) -> Result<Request, DecodeError> {
        Request::decode(self, message)
    }

    fn encode_reply(
        self,
        command: Command,
        id: CommandId,
        reply: &Reply<'_>,
        extra: usize,
    ) -> Result<Outgoing, ReplyError> {
        reply.encode(self, command, id, extra)
    }

    fn decode_reply<'a>(
        self,
        command: Command,
        message: &Message<'a>,
    ) -> Result<Reply<'a>, DecodeError> {
        Reply::decode(self, command, message)
    }
}

const SPOKEN: &[u16] = &[5, 10];

/// The robots of each version, from the compatibility table of libfranka 0.21.
const FIELD: &[(u16, FieldDevice)] = &[
    (3, fer("3.x", Some(FER_UPDATE))),
    (4, fer("4.0", Some(FER_UPDATE))),
    (5, fer(FER_UPDATE, None)),
    (6, fr3("5.2", Some(FR3_UPDATE))),
    (7, fr3("5.5", Some(FR3_UPDATE))),
    (8, fr3("5.7.0", Some(FR3_UPDATE))),
    (9, fr3("5.7.2", Some(FR3_UPDATE))),
    (10, fr3(FR3_UPDATE, None)),
];

const FER_UPDATE: &str = "4.2.1 or later";
const FR3_UPDATE: &str = "5.9.0 or later";

const fn fer(system: &'static str, update: Option<&'static str>) -> FieldDevice {
    FieldDevice {
        name: "Franka Emika Robot (Panda)",
        system,
        update,
    }
}

const fn fr3(system: &'static str, update: Option<&'static str>) -> FieldDevice {
    FieldDevice {
        name: "Franka Research 3",
        system,
        update,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spoken_versions_are_those_of_the_table() {
        assert_eq!(Version::ALL.map(Version::number), SPOKEN);
        for &(number, device) in FIELD {
            let spoken = Version::from_number(number).is_some();
            assert_eq!(device.update.is_none(), spoken, "{number}");
        }
    }
}
