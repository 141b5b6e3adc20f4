//! The protocols of the Hand and of the vacuum gripper: messages, datagrams, numbers and sizes.

use std::fmt::Debug;

use anyhow::{Context as _, bail};
use franka_proto::framing::{FrameError, Message};
use franka_proto::{
    CommandId, ConnectStatus, DecodeError, Outgoing, Protocol, ServiceCommand, client, gripper,
    server, vacuum,
};

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::wire::{File, Golden, Values};
use super::wire_table::{DeclaredEnum, DeclaredStruct};
use super::{Case, Report};

/// Checks the messages of both devices in `wire_golden.json`.
pub(super) fn messages(report: &mut Report, file: &File) -> anyhow::Result<()> {
    device_messages::<gripper::Version>(report, "gripper", &file.gripper)?;
    device_messages::<vacuum::Version>(report, "vacuum_gripper", &file.vacuum_gripper)
}

/// Checks `wire_gripper.json`.
pub(super) fn gripper_headers(text: &[u8]) -> anyhow::Result<Report> {
    headers::<gripper::Version>(text)
}

/// Checks `wire_vacuum_gripper.json`.
pub(super) fn vacuum_headers(text: &[u8]) -> anyhow::Result<Report> {
    headers::<vacuum::Version>(text)
}

/// Requirements of the checks on a device.
trait Device: for<'a> Protocol<Reply<'a> = gripper::Reply> + Default {
    const PORT: u16;
    const COMMANDS: &'static [Self::Command];
    type State: Debug + PartialEq;

    /// The request for a command, with the parameters of the file or, without a file, with any.
    fn request(command: Self::Command, values: Option<&Values>) -> anyhow::Result<Self::Request>;
    fn state(values: &Values) -> anyhow::Result<Self::State>;
    fn decode(bytes: &[u8]) -> Result<Self::State, DecodeError>;
    fn encode(state: &Self::State) -> Vec<u8>;
}

impl Device for gripper::Version {
    const PORT: u16 = Self::TCP_PORT;
    const COMMANDS: &'static [gripper::Command] = &[
        gripper::Command::Connect,
        gripper::Command::Homing,
        gripper::Command::Grasp,
        gripper::Command::Move,
        gripper::Command::Stop,
    ];
    type State = gripper::State;

    fn request(
        command: gripper::Command,
        values: Option<&Values>,
    ) -> anyhow::Result<gripper::Request> {
        let number = |name| field(values, name);
        Ok(match command {
            gripper::Command::Connect => gripper::Request::Connect {
                version: field(values, "version")?,
                udp_port: field(values, "udp_port")?,
            },
            gripper::Command::Homing => gripper::Request::Homing,
            gripper::Command::Grasp => gripper::Request::Grasp(gripper::Grasp {
                width: number("width")?,
                epsilon_inner: number("epsilon.inner")?,
                epsilon_outer: number("epsilon.outer")?,
                speed: number("speed")?,
                force: number("force")?,
            }),
            gripper::Command::Move => gripper::Request::Move(gripper::Move {
                width: number("width")?,
                speed: number("speed")?,
            }),
            gripper::Command::Stop => gripper::Request::Stop,
        })
    }

    fn state(values: &Values) -> anyhow::Result<gripper::State> {
        Ok(gripper::State {
            message_id: values.get("message_id")?,
            width: values.get("width")?,
            max_width: values.get("max_width")?,
            is_grasped: values.flag("is_grasped")?,
            temperature: values.get("temperature")?,
        })
    }

    fn decode(bytes: &[u8]) -> Result<gripper::State, DecodeError> {
        gripper::State::decode(bytes)
    }

    fn encode(state: &gripper::State) -> Vec<u8> {
        state.encode().to_vec()
    }
}

impl Device for vacuum::Version {
    const PORT: u16 = Self::TCP_PORT;
    const COMMANDS: &'static [vacuum::Command] = &[
        vacuum::Command::Connect,
        vacuum::Command::Vacuum,
        vacuum::Command::DropOff,
        vacuum::Command::Stop,
    ];
    type State = vacuum::State;

    fn request(
        command: vacuum::Command,
        values: Option<&Values>,
    ) -> anyhow::Result<vacuum::Request> {
        Ok(match command {
            vacuum::Command::Connect => vacuum::Request::Connect {
                version: field(values, "version")?,
                udp_port: field(values, "udp_port")?,
            },
            vacuum::Command::Vacuum => vacuum::Request::Vacuum(vacuum::Vacuum {
                vacuum: field(values, "vacuum")?,
                profile: vacuum::Profile::from_byte(field(values, "profile")?)?,
                timeout: field(values, "timeout")?,
            }),
            vacuum::Command::DropOff => vacuum::Request::DropOff {
                timeout: field(values, "timeout")?,
            },
            vacuum::Command::Stop => vacuum::Request::Stop,
        })
    }

    fn state(values: &Values) -> anyhow::Result<vacuum::State> {
        Ok(vacuum::State {
            message_id: values.get("message_id")?,
            in_control_range: values.flag("in_control_range")?,
            part_detached: values.flag("part_detached")?,
            part_present: values.flag("part_present")?,
            device_status: vacuum::DeviceStatus::from_byte(values.get("device_status")?),
            actual_power: values.get("actual_power")?,
            vacuum: values.get("vacuum")?,
        })
    }

    fn decode(bytes: &[u8]) -> Result<vacuum::State, DecodeError> {
        vacuum::State::decode(bytes)
    }

    fn encode(state: &vacuum::State) -> Vec<u8> {
        state.encode().to_vec()
    }
}

/// A value, or zero without values.
fn field<T: DeserializeOwned + Default>(values: Option<&Values>, name: &str) -> anyhow::Result<T> {
    values.map_or(Ok(T::default()), |values| values.get(name))
}

fn command_named<D: Device>(name: &str) -> anyhow::Result<D::Command> {
    let mut commands = D::COMMANDS.iter().copied();
    let command = commands.find(|command| format!("{command:?}") == name);
    command.with_context(|| format!("{name}: expected a command of the device"))
}

fn device_messages<D: Device>(
    report: &mut Report,
    list: &str,
    messages: &[Golden],
) -> anyhow::Result<()> {
    for (index, golden) in messages.iter().enumerate() {
        let (name, values, bytes) = (&golden.message, &golden.values, &golden.bytes);
        let title = format!("{list}[{index}] {name}");
        match name.split_once(' ') {
            Some((command, "request")) => {
                let request = D::request(command_named::<D>(command)?, Some(values))?;
                let id = CommandId(values.get("command_id")?);
                report.case(title, |case| check_request::<D>(case, &request, id, bytes));
            }
            Some((command, "reply")) => {
                let command = command_named::<D>(command)?;
                let id = CommandId(values.get("command_id")?);
                let reply = reply::<D>(command, values)?;
                report.case(title, |case| {
                    check_reply::<D>(case, command, reply, id, bytes);
                });
            }
            _ => {
                let state = D::state(values)?;
                report.case(title, |case| {
                    case.equal("bytes", &D::encode(&state), bytes);
                    case.equal("values", D::decode(bytes), Ok(state));
                    let short = D::decode(&bytes[..bytes.len() - 1]);
                    case.equal("shorter datagram is refused", short.is_err(), true);
                });
            }
        }
    }
    Ok(())
}

fn reply<D: Device>(command: D::Command, values: &Values) -> anyhow::Result<gripper::Reply> {
    let status: u16 = values.get("status")?;
    if command == D::Command::CONNECT {
        return Ok(gripper::Reply::Connect {
            status: match status {
                0 => ConnectStatus::Success,
                1 => ConnectStatus::IncompatibleLibraryVersion,
                _ => bail!("status {status} of a handshake"),
            },
            version: values.get("version")?,
        });
    }
    Ok(gripper::Reply::Done(match status {
        0 => gripper::Status::Success,
        1 => gripper::Status::Fail,
        2 => gripper::Status::Unsuccessful,
        3 => gripper::Status::Aborted,
        _ => bail!("status {status}"),
    }))
}

fn whole(bytes: &[u8]) -> Result<Message<'_>, String> {
    let message = gripper::next_message(bytes).map_err(|error: FrameError| error.to_string())?;
    message.ok_or_else(|| "half a message".to_owned())
}

fn check_request<D: Device>(
    case: &mut Case<'_>,
    request: &D::Request,
    id: CommandId,
    bytes: &[u8],
) {
    let encoded = D::default().encode_request(request, id);
    let encoded = encoded.as_ref().map(Outgoing::as_bytes);
    case.equal("bytes", encoded, Ok(bytes));
    match whole(bytes) {
        Ok(message) => {
            case.equal("id", message.header.id(), id);
            let decoded = D::default().decode_request(&message);
            case.equal("values", decoded.as_ref(), Ok(request));
        }
        Err(error) => case.fail(error),
    }
}

/// The client reads the bytes as the reply, and a server session sends them.
fn check_reply<D: Device>(
    case: &mut Case<'_>,
    command: D::Command,
    reply: gripper::Reply,
    id: CommandId,
    bytes: &[u8],
) {
    let decoded = whole(bytes).map(|message| D::default().decode_reply(command, &message));
    case.equal("values", decoded, Ok(Ok(reply)));
    match server_bytes::<D>(command, reply, id) {
        Ok(sent) => case.equal("bytes", sent, bytes),
        Err(error) => case.fail(error),
    }
}

fn server_bytes<D: Device>(
    command: D::Command,
    reply: gripper::Reply,
    id: CommandId,
) -> Result<Vec<u8>, String> {
    let mut session = server::Session::new(D::default());
    let hello = client::Session::new(D::default()).connect(1);
    let event = session
        .on_message(whole(hello.as_bytes())?)
        .map_err(|error| error.to_string())?;
    let (
        server::Event::Connect {
            reply: accepted, ..
        },
        true,
    ) = (event, session.is_connected())
    else {
        return Err("no handshake".to_owned());
    };
    if command == D::Command::CONNECT {
        return Ok(accepted.as_bytes().to_vec());
    }
    let request = D::request(command, None).map_err(|error| error.to_string())?;
    let request = D::default().encode_request(&request, id);
    let request = request.map_err(|error| error.to_string())?;
    session
        .on_message(whole(request.as_bytes())?)
        .map_err(|error| error.to_string())?;
    let answer = session
        .reply(id, reply)
        .map_err(|error| error.to_string())?;
    Ok(answer.as_bytes().to_vec())
}

/// Declarations of the vendor's headers.
#[derive(Deserialize)]
struct Headers {
    version: u16,
    tcp_port: u16,
    header_size: usize,
    state_struct: String,
    commands: Vec<DeclaredCommand>,
    enums: Vec<DeclaredEnum>,
    structs: Vec<DeclaredStruct>,
}

#[derive(Deserialize)]
struct DeclaredCommand {
    id: u32,
    name: String,
    request_total_bytes: usize,
    response_total_bytes: usize,
}

/// Checks version, port, sizes, the numbers of commands and every number of the enums. Offsets are
/// asserted when the protocol crate is compiled.
fn headers<D: Device>(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: Headers = serde_json::from_slice(text)?;
    report.case("service", |case| {
        case.equal("version", D::default().number(), file.version);
        case.equal("port", D::PORT, file.tcp_port);
        let bytes = message_of(file.header_size, &[]);
        case.equal("header size", whole(&bytes).map(|m| m.payload.len()), Ok(0));
    });
    for declared in &file.commands {
        declared.check::<D>(&mut report, file.header_size)?;
    }
    for declared in &file.enums {
        check_enum::<D>(&mut report, declared);
    }
    let state = file
        .structs
        .iter()
        .find(|declared| declared.name == file.state_struct);
    let size = state
        .and_then(|state| state.size)
        .context("no size of the state")?;
    report.case(&file.state_struct, |case| {
        case.equal("its size is read", D::decode(&vec![0; size]).is_ok(), true);
        case.equal("less is not", D::decode(&vec![0; size - 1]).is_ok(), false);
    });
    Ok(report)
}

/// A message of this size that is zero except for size and payload.
fn message_of(size: usize, payload: &[u8]) -> Vec<u8> {
    [&[0; 6], &(size as u32).to_le_bytes()[..], payload].concat()
}

impl DeclaredCommand {
    fn check<D: Device>(&self, report: &mut Report, header_size: usize) -> anyhow::Result<()> {
        let command = command_named::<D>(self.name.trim_start_matches('k'))?;
        let request = D::request(command, None)?;
        report.case(format!("command {}", self.name), |case| {
            match D::default().encode_request(&request, CommandId(0)) {
                Ok(sent) => {
                    let size = sent.as_bytes().len();
                    case.equal("request size", size, self.request_total_bytes);
                    case.equal("number", u32::from(sent.as_bytes()[0]), self.id);
                }
                Err(error) => case.fail(error.to_string()),
            }
            let decode = |size: usize| {
                let bytes = message_of(size, &vec![0; size - header_size]);
                let message = whole(&bytes);
                message.is_ok_and(|m| D::default().decode_reply(command, &m).is_ok())
            };
            let size = self.response_total_bytes;
            case.equal("reply of this size is read", decode(size), true);
            case.equal("shorter reply is read", decode(size - 1), false);
        });
        Ok(())
    }
}

fn check_enum<D: Device>(report: &mut Report, declared: &DeclaredEnum) {
    let name = &declared.name;
    let command = match name.as_str() {
        "Connect::Status" => D::Command::CONNECT,
        "CommandBase::Status" => D::COMMANDS[1],
        // The numbers of commands are checked with the commands, the bytes of the other enums in
        // the messages.
        _ => return,
    };
    report.case(format!("enum {name}"), |case| {
        for (number, name) in (0..=u8::MAX).zip(declared.names()) {
            let bytes = message_of(14, &[number, 0, 0, 0]);
            let decoded = whole(&bytes).map(|m| D::default().decode_reply(command, &m));
            let got = match decoded {
                Ok(Ok(gripper::Reply::Connect { status, .. })) => Some(format!("k{status:?}")),
                Ok(Ok(gripper::Reply::Done(status))) => Some(format!("k{status:?}")),
                _ => None,
            };
            case.equal(&format!("number {number}"), got.as_deref(), name);
        }
    });
}
