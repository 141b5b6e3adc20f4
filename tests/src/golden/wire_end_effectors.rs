//! The protocols of the Hand and of the vacuum gripper: messages, datagrams, numbers and sizes.

use std::fmt::Debug;

use franka_proto::framing::{FrameError, Message};
use franka_proto::{
    CommandId, ConnectStatus, DecodeError, Outgoing, Protocol, ServiceCommand, client, gripper,
    server, vacuum,
};

use super::wire::narrow;
use super::{Case, Malformed, Node, Report};

/// Checks the messages of both devices in `wire_golden.json`.
pub(super) fn messages(report: &mut Report, root: &Node<'_>) -> Result<(), Malformed> {
    device_messages::<gripper::Version>(report, &root.get("gripper")?)?;
    device_messages::<vacuum::Version>(report, &root.get("vacuum_gripper")?)
}

/// Checks `wire_gripper.json`.
pub(super) fn gripper_headers(root: &Node<'_>) -> Result<Report, Malformed> {
    headers::<gripper::Version>(root)
}

/// Checks `wire_vacuum_gripper.json`.
pub(super) fn vacuum_headers(root: &Node<'_>) -> Result<Report, Malformed> {
    headers::<vacuum::Version>(root)
}

/// What the checks ask of a device.
trait Device: for<'a> Protocol<Reply<'a> = gripper::Reply> + Default {
    const PORT: u16;
    const COMMANDS: &'static [Self::Command];
    type State: Debug + PartialEq;

    /// The request for a command, with the parameters of the file or, without a file, with any.
    fn request(
        command: Self::Command,
        values: Option<&Node<'_>>,
    ) -> Result<Self::Request, Malformed>;
    fn state(values: &Node<'_>) -> Result<Self::State, Malformed>;
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
        values: Option<&Node<'_>>,
    ) -> Result<gripper::Request, Malformed> {
        let number = |name| values.map_or(Ok(0.0), |values| values.get(name)?.number());
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

    fn state(values: &Node<'_>) -> Result<gripper::State, Malformed> {
        Ok(gripper::State {
            message_id: narrow(&values.get("message_id")?)?,
            width: values.get("width")?.number()?,
            max_width: values.get("max_width")?.number()?,
            is_grasped: values.get("is_grasped")?.boolean()?,
            temperature: narrow(&values.get("temperature")?)?,
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
        values: Option<&Node<'_>>,
    ) -> Result<vacuum::Request, Malformed> {
        Ok(match command {
            vacuum::Command::Connect => vacuum::Request::Connect {
                version: field(values, "version")?,
                udp_port: field(values, "udp_port")?,
            },
            vacuum::Command::Vacuum => {
                let profile = vacuum::Profile::from_byte(field(values, "profile")?);
                let unknown = |values: &Node<'_>| values.malformed("a profile");
                vacuum::Request::Vacuum(vacuum::Vacuum {
                    vacuum: field(values, "vacuum")?,
                    profile: match (profile, values) {
                        (Err(_), Some(values)) => return Err(unknown(values)),
                        (profile, _) => profile.unwrap_or_default(),
                    },
                    timeout: field(values, "timeout")?,
                })
            }
            vacuum::Command::DropOff => vacuum::Request::DropOff {
                timeout: field(values, "timeout")?,
            },
            vacuum::Command::Stop => vacuum::Request::Stop,
        })
    }

    fn state(values: &Node<'_>) -> Result<vacuum::State, Malformed> {
        let flag = |name| values.get(name)?.boolean();
        Ok(vacuum::State {
            message_id: narrow(&values.get("message_id")?)?,
            in_control_range: flag("in_control_range")?,
            part_detached: flag("part_detached")?,
            part_present: flag("part_present")?,
            device_status: vacuum::DeviceStatus::from_byte(narrow(&values.get("device_status")?)?),
            actual_power: narrow(&values.get("actual_power")?)?,
            vacuum: narrow(&values.get("vacuum")?)?,
        })
    }

    fn decode(bytes: &[u8]) -> Result<vacuum::State, DecodeError> {
        vacuum::State::decode(bytes)
    }

    fn encode(state: &vacuum::State) -> Vec<u8> {
        state.encode().to_vec()
    }
}

/// A member of the values, or zero where there are none.
fn field<T: TryFrom<u64> + Default>(values: Option<&Node<'_>>, name: &str) -> Result<T, Malformed> {
    values.map_or(Ok(T::default()), |values| narrow(&values.get(name)?))
}

fn command_named<D: Device>(name: &str, node: &Node<'_>) -> Result<D::Command, Malformed> {
    let mut commands = D::COMMANDS.iter().copied();
    commands
        .find(|command| format!("{command:?}") == name)
        .ok_or_else(|| node.malformed("a command of the device"))
}

fn device_messages<D: Device>(report: &mut Report, list: &Node<'_>) -> Result<(), Malformed> {
    for node in list.list()? {
        let name = node.get("message")?.text()?;
        let (values, bytes) = (node.get("values")?, node.get("hex")?.bytes()?);
        let title = format!("{} {name}", node.path());
        match name.split_once(' ') {
            Some((command, "request")) => {
                let request = D::request(command_named::<D>(command, &node)?, Some(&values))?;
                let id = CommandId(narrow(&values.get("command_id")?)?);
                report.case(title, |case| check_request::<D>(case, &request, id, &bytes));
            }
            Some((command, "reply")) => {
                let command = command_named::<D>(command, &node)?;
                let id = CommandId(narrow(&values.get("command_id")?)?);
                let reply = reply::<D>(command, &values)?;
                report.case(title, |case| {
                    check_reply::<D>(case, command, reply, id, &bytes)
                });
            }
            _ => {
                let state = D::state(&values)?;
                report.case(title, |case| {
                    case.equal("bytes", &D::encode(&state), &bytes);
                    case.equal("values", D::decode(&bytes), Ok(state));
                    let short = D::decode(&bytes[..bytes.len() - 1]);
                    case.equal("shorter datagram is refused", short.is_err(), true);
                });
            }
        }
    }
    Ok(())
}

fn reply<D: Device>(command: D::Command, values: &Node<'_>) -> Result<gripper::Reply, Malformed> {
    let number = values.get("status")?;
    if command == D::Command::CONNECT {
        let version = narrow(&values.get("version")?)?;
        let status = match number.integer()? {
            0 => ConnectStatus::Success,
            1 => ConnectStatus::IncompatibleLibraryVersion,
            _ => return Err(number.malformed("an answer to a handshake")),
        };
        return Ok(gripper::Reply::Connect { status, version });
    }
    Ok(gripper::Reply::Done(match number.integer()? {
        0 => gripper::Status::Success,
        1 => gripper::Status::Fail,
        2 => gripper::Status::Unsuccessful,
        3 => gripper::Status::Aborted,
        _ => return Err(number.malformed("a status")),
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

/// Checks version, port, sizes, the numbers of commands and every number of the enums. Offsets are
/// asserted when the protocol crate is compiled.
fn headers<D: Device>(root: &Node<'_>) -> Result<Report, Malformed> {
    let mut report = Report::default();
    let (version, port): (u16, u16) = (
        narrow(&root.get("version")?)?,
        narrow(&root.get("tcp_port")?)?,
    );
    let header_size: usize = narrow(&root.get("header_size")?)?;
    report.case("service", |case| {
        case.equal("version", D::default().number(), version);
        case.equal("port", D::PORT, port);
        let header = u32::try_from(header_size).unwrap_or_default().to_le_bytes();
        let bytes = [&[0; 6][..], &header].concat();
        case.equal("header size", whole(&bytes).map(|m| m.payload.len()), Ok(0));
    });
    for node in root.get("commands")?.list()? {
        check_command::<D>(&mut report, &node, header_size)?;
    }
    for node in root.get("enums")?.list()? {
        check_enum::<D>(&mut report, &node)?;
    }
    let state = root.get("state_struct")?.text()?;
    for node in root.get("structs")?.list()? {
        if node.get("name")?.text()? == state {
            let size: usize = narrow(&node.get("size")?)?;
            report.case(state, |case| {
                case.equal("its size is read", D::decode(&vec![0; size]).is_ok(), true);
                case.equal("less is not", D::decode(&vec![0; size - 1]).is_ok(), false);
            });
        }
    }
    Ok(report)
}

fn check_command<D: Device>(
    report: &mut Report,
    node: &Node<'_>,
    header_size: usize,
) -> Result<(), Malformed> {
    let name = node.get("name")?.text()?;
    let number: u32 = narrow(&node.get("id")?)?;
    let request_size: usize = narrow(&node.get("request_total_bytes")?)?;
    let response_size: usize = narrow(&node.get("response_total_bytes")?)?;
    let command = command_named::<D>(name.trim_start_matches('k'), node)?;
    let request = D::request(command, None)?;
    report.case(format!("command {name}"), |case| {
        match D::default().encode_request(&request, CommandId(0)) {
            Ok(sent) => {
                case.equal("request size", sent.as_bytes().len(), request_size);
                case.equal("number", u32::from(sent.as_bytes()[0]), number);
            }
            Err(error) => case.fail(error.to_string()),
        }
        let decode = |size: usize| {
            let total = (size as u32).to_le_bytes();
            let bytes = [&[0; 6][..], &total, &vec![0; size - header_size]].concat();
            whole(&bytes).is_ok_and(|message| D::default().decode_reply(command, &message).is_ok())
        };
        case.equal("reply of this size is read", decode(response_size), true);
        case.equal("shorter reply is read", decode(response_size - 1), false);
    });
    Ok(())
}

fn check_enum<D: Device>(report: &mut Report, node: &Node<'_>) -> Result<(), Malformed> {
    let name = node.get("name")?.text()?;
    let command = match name {
        "Connect::Status" => D::Command::CONNECT,
        "CommandBase::Status" => D::COMMANDS[1],
        // The numbers of commands are checked with the commands, the bytes of the other enums in
        // the messages.
        _ => return Ok(()),
    };
    let mut names = vec![None; 256];
    for (enumerator, value) in node.get("values")?.members()? {
        names[narrow::<usize>(&value)?] = Some(enumerator.to_owned());
    }
    report.case(format!("enum {name}"), |case| {
        for (number, name) in (0..=u8::MAX).zip(names) {
            let bytes = [0, 0, 0, 0, 0, 0, 14, 0, 0, 0, number, 0, 0, 0];
            let decoded = whole(&bytes).map(|m| D::default().decode_reply(command, &m));
            let got = match decoded {
                Ok(Ok(gripper::Reply::Connect { status, .. })) => Some(format!("k{status:?}")),
                Ok(Ok(gripper::Reply::Done(status))) => Some(format!("k{status:?}")),
                _ => None,
            };
            case.equal(&format!("number {number}"), got, name);
        }
    });
    Ok(())
}
