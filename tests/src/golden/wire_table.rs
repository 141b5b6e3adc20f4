//! The version table of the protocol against the vendor's headers.

use franka_proto::framing::{Header, Message};
use franka_proto::{
    Architecture, CollisionBehavior, Command, CommandId, ControllerMode, DecodeError, Filters,
    MotionGeneratorMode, MoveControllerMode, MoveGeneratorMode, MoveRequest, Reply, Request,
    RobotError, RobotMode, RobotState, System, Version,
};

use super::wire::{narrow, status_of};
use super::{Case, Malformed, Node, Report};

/// Checks `wire_v10.json` or `wire_v5.json`: command numbers, names and sizes, the bytes of every
/// enumerator, the errors, the sizes of the datagrams. Offsets are asserted when the protocol crate
/// is compiled, and golden messages prove them.
pub(super) fn headers(root: &Node<'_>) -> Result<Report, Malformed> {
    let node = root.get("fci_version")?;
    let version = Version::from_number(narrow(&node)?);
    let version = version.ok_or_else(|| node.malformed("a version of the protocol"))?;
    let mut report = Report::default();
    let size: usize = narrow(&root.get("header_size")?)?;
    report.case("header_size", |case| case.equal("size", Header::SIZE, size));
    for node in root.get("commands")?.list()? {
        check_command(&mut report, version, &node)?;
    }
    for node in root.get("enums")?.list()? {
        check_enum(&mut report, version, &node)?;
    }
    for (index, node) in root.get("errors")?.list()?.iter().enumerate() {
        let name = node.get("name")?.text()?;
        let at: usize = narrow(&node.get("index")?)?;
        report.case(format!("error {name}"), |case| {
            case.equal("index", at, index);
            case.equal(
                "name",
                RobotError::from_index(at).map(RobotError::name),
                Some(name),
            );
        });
    }
    for (name, size) in [
        ("RobotState", version.state_size()),
        ("RobotCommand", version.command_size()),
    ] {
        let expected: usize = narrow(&structure(root, name)?.get("size")?)?;
        report.case(name, |case| case.equal("size", size, expected));
    }
    Ok(report)
}

fn structure<'a>(root: &Node<'a>, name: &str) -> Result<Node<'a>, Malformed> {
    for node in root.get("structs")?.list()? {
        if node.get("name")?.text()? == name {
            return Ok(node);
        }
    }
    Err(root.malformed(format!("a struct {name}")))
}

fn check_command(report: &mut Report, version: Version, node: &Node<'_>) -> Result<(), Malformed> {
    let name = node.get("name")?.text()?;
    let number: u32 = narrow(&node.get("id")?)?;
    let display_name = node.get("display_name")?.text()?;
    let request_size: usize = narrow(&node.get("request_total_bytes")?)?;
    let response_size: usize = narrow(&node.get("response_total_bytes")?)?;
    report.case(format!("command {name}"), |case| {
        let Some(command) = version.command_from_number(number) else {
            return case.fail(format!("no command {number}"));
        };
        case.equal("name", format!("k{command:?}"), name);
        if !display_name.starts_with("(none") {
            case.equal("display name", command.display_name(), display_name);
        }
        let id = CommandId(0);
        let size = sample(command)
            .encode(version, id)
            .map(|bytes| bytes.as_bytes().len());
        case.equal("request size", size, Ok(request_size));
        let payload = response_size - Header::SIZE;
        let bytes = vec![0; payload];
        let decode = |size| Reply::decode(version, command, &message(number, &bytes[..size]));
        case.equal("reply of this size is read", decode(payload).is_ok(), true);
        let short = decode(payload - 1);
        let too_short = matches!(short, Err(DecodeError::MessageSize { .. }));
        case.equal("shorter reply is refused", too_short, true);
    });
    Ok(())
}

/// Some request for a command.
fn sample(command: Command) -> Request {
    match command {
        Command::Connect => Request::Connect {
            version: 0,
            udp_port: 0,
        },
        Command::Move => Request::Move(MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )),
        Command::StopMove => Request::StopMove,
        Command::SetCollisionBehavior => {
            let (torque, force) = ([0.0; 7], [0.0; 6]);
            let thresholds = CollisionBehavior::uniform(torque, torque, force, force);
            Request::SetCollisionBehavior(thresholds)
        }
        Command::SetJointImpedance => Request::SetJointImpedance([0.0; 7]),
        Command::SetCartesianImpedance => Request::SetCartesianImpedance([0.0; 6]),
        Command::SetGuidingMode => Request::SetGuidingMode {
            guiding_mode: [false; 6],
            nullspace: false,
        },
        Command::SetEEToK => Request::SetEEToK([0.0; 16]),
        Command::SetNEToEE => Request::SetNEToEE([0.0; 16]),
        Command::SetLoad => Request::SetLoad(Default::default()),
        Command::AutomaticErrorRecovery => Request::AutomaticErrorRecovery,
        Command::GetRobotModel => Request::GetRobotModel,
        Command::GetCartesianLimit => Request::GetCartesianLimit { id: 0 },
        Command::SetFilters => Request::SetFilters(Filters::uniform(0.0)),
        Command::LoadModelLibrary => Request::LoadModelLibrary {
            architecture: Architecture::X64,
            system: System::Linux,
        },
    }
}

fn message(command: u32, payload: &[u8]) -> Message<'_> {
    let size = (Header::SIZE + payload.len()) as u32;
    let header = Header {
        command,
        command_id: 0,
        size,
    };
    Message { header, payload }
}

/// Checks every byte of an enum: the enumerators have their names, the rest has none.
fn check_enum(report: &mut Report, version: Version, node: &Node<'_>) -> Result<(), Malformed> {
    let name = node.get("name")?.text()?;
    let Some(meaning) = reader(name, version) else {
        return Ok(());
    };
    let mut names = vec![None; 256];
    for (enumerator, value) in node.get("values")?.members()? {
        let value: u8 = narrow(&value)?;
        names[usize::from(value)] = Some(enumerator.to_owned());
    }
    report.case(format!("enum {name}"), |case: &mut Case<'_>| {
        for (byte, name) in (0..=u8::MAX).zip(names) {
            case.equal(&format!("byte {byte}"), meaning(byte), name);
        }
    });
    Ok(())
}

/// The vendor's name for a byte, if it has one.
type Meaning = Box<dyn Fn(u8) -> Option<String>>;

/// How this crate reads the bytes of an enum; `None` for enums that it has no reader for: numbers
/// of commands, checked on their own, and what other enums are derived from.
fn reader(name: &str, version: Version) -> Option<Meaning> {
    let status = |command: Command| -> Meaning {
        Box::new(move |byte| {
            let mut payload = [0; 154];
            payload[0] = byte;
            let reply = Reply::decode(version, command, &message(0, &payload));
            reply.ok().map(|reply| status_of(&reply))
        })
    };
    Some(match name {
        "Connect::Status" => status(Command::Connect),
        "Move::Status" => status(Command::Move),
        "StopMove::Status" => status(Command::StopMove),
        "GetterSetterCommandBase::Status" => status(Command::SetLoad),
        "AutomaticErrorRecovery::Status" => status(Command::AutomaticErrorRecovery),
        // The base of all other statuses; in protocol 10 `GetRobotModel` has no status of its own.
        "CommandBase::Status" if version.supports(Command::GetRobotModel) => {
            status(Command::GetRobotModel)
        }
        "LoadModelLibrary::Status" => status(Command::LoadModelLibrary),
        "LoadModelLibrary::Architecture" => Box::new(move |byte| {
            let (architecture, _) = library(version, byte, 0)?;
            Some(match architecture {
                Architecture::Arm => "kARM".to_owned(),
                Architecture::Arm64 => "kARM64".to_owned(),
                architecture => format!("k{architecture:?}"),
            })
        }),
        "LoadModelLibrary::System" => Box::new(move |byte| {
            let (_, system) = library(version, 0, byte)?;
            Some(format!("k{system:?}"))
        }),
        "Move::ControllerMode" => Box::new(move |byte| {
            let request = motion(version, byte, 0)?;
            Some(format!("k{:?}", request.controller))
        }),
        "Move::MotionGeneratorMode" => Box::new(move |byte| {
            let request = motion(version, 0, byte)?;
            Some(format!("k{:?}", request.generator))
        }),
        "state::ControllerMode" => Box::new(|byte| match ControllerMode::from_byte(byte) {
            ControllerMode::Unknown(_) => None,
            mode => Some(format!("k{mode:?}")),
        }),
        "state::RobotMode" => Box::new(|byte| match RobotMode::from_byte(byte) {
            // Bytes without a name read as Other.
            RobotMode::Other if byte != 0 => None,
            mode => Some(format!("k{mode:?}")),
        }),
        "state::MotionGeneratorMode" => Box::new(move |byte| {
            let mut bytes = vec![0; version.state_size()];
            // Behind the numbers: 1288 of 1377 bytes, 2280 of 2373.
            let behind = if version.has_accelerometers() { 89 } else { 93 };
            let offset = bytes.len() - behind;
            bytes[offset] = byte;
            match RobotState::decode(version, &bytes)
                .ok()?
                .motion_generator_mode
            {
                MotionGeneratorMode::Unknown(_) => None,
                mode => Some(format!("k{mode:?}")),
            }
        }),
        _ => return None,
    })
}

/// What these bytes of a `LoadModelLibrary` mean, if they do.
fn library(version: Version, architecture: u8, system: u8) -> Option<(Architecture, System)> {
    let number = version.command_number(Command::LoadModelLibrary)?;
    match Request::decode(version, &message(number, &[architecture, system])) {
        Ok(Request::LoadModelLibrary {
            architecture,
            system,
        }) => Some((architecture, system)),
        _ => None,
    }
}

/// The `Move` with these modes, if they exist.
fn motion(version: Version, controller: u8, generator: u8) -> Option<MoveRequest> {
    let mut payload = [0; 113];
    payload[0] = controller;
    payload[4] = generator;
    let number = version.command_number(Command::Move)?;
    match Request::decode(version, &message(number, &payload)) {
        Ok(Request::Move(request)) => Some(request),
        _ => None,
    }
}
