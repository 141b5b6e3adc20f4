//! The version table of the protocol against the vendor's headers.

use std::collections::BTreeMap;

use anyhow::Context as _;
use franka_proto::framing::{Header, Message};
use franka_proto::{
    Architecture, CollisionBehavior, Command, CommandId, ControllerMode, DecodeError, Filters,
    MotionGeneratorMode, MoveControllerMode, MoveGeneratorMode, MoveRequest, Reply, Request,
    RobotError, RobotMode, RobotState, System, Version,
};

use serde::Deserialize;

use super::wire::status_of;
use super::{Case, Report};

/// Declarations of the vendor's headers.
#[derive(Deserialize)]
struct File {
    fci_version: u16,
    header_size: usize,
    commands: Vec<DeclaredCommand>,
    enums: Vec<DeclaredEnum>,
    errors: Vec<DeclaredError>,
    structs: Vec<DeclaredStruct>,
}

#[derive(Deserialize)]
struct DeclaredCommand {
    id: u32,
    name: String,
    display_name: String,
    request_total_bytes: usize,
    response_total_bytes: usize,
}

#[derive(Deserialize)]
pub(super) struct DeclaredEnum {
    pub(super) name: String,
    pub(super) values: BTreeMap<String, u32>,
}

impl DeclaredEnum {
    /// The name of each byte, if any.
    pub(super) fn names(&self) -> [Option<&str>; 256] {
        let mut names = [None; 256];
        for (name, &value) in &self.values {
            names[value as usize] = Some(name.as_str());
        }
        names
    }
}

#[derive(Deserialize)]
struct DeclaredError {
    index: usize,
    name: String,
}

#[derive(Deserialize)]
pub(super) struct DeclaredStruct {
    pub(super) name: String,
    /// `None` for a reply that ends with a text.
    pub(super) size: Option<usize>,
}

/// Checks `wire_v10.json` or `wire_v5.json`: command numbers, names and sizes, the bytes of every
/// enumerator, the errors, the sizes of the datagrams. Offsets are asserted when the protocol crate
/// is compiled, and golden messages prove them.
pub(super) fn headers(text: &[u8]) -> anyhow::Result<Report> {
    let file: File = serde_json::from_slice(text)?;
    let version = Version::from_number(file.fci_version);
    let version = version.context("expected a version of the protocol")?;
    let mut report = Report::default();
    report.case("header_size", |case| {
        case.equal("size", Header::SIZE, file.header_size);
    });
    for declared in &file.commands {
        declared.check(&mut report, version);
    }
    for declared in &file.enums {
        check_enum(&mut report, version, declared);
    }
    for (index, error) in file.errors.iter().enumerate() {
        report.case(format!("error {}", error.name), |case| {
            case.equal("index", error.index, index);
            let name = RobotError::from_index(error.index).map(RobotError::name);
            case.equal("name", name, Some(error.name.as_str()));
        });
    }
    for (name, size) in [
        ("RobotState", version.state_size()),
        ("RobotCommand", version.command_size()),
    ] {
        let declared = file.structs.iter().find(|declared| declared.name == name);
        let expected = declared.and_then(|declared| declared.size);
        let expected = expected.with_context(|| format!("no struct {name} with a size"))?;
        report.case(name, |case| case.equal("size", size, expected));
    }
    Ok(report)
}

impl DeclaredCommand {
    fn check(&self, report: &mut Report, version: Version) {
        let (name, number) = (&self.name, self.id);
        report.case(format!("command {name}"), |case| {
            let Some(command) = version.command_from_number(number) else {
                return case.fail(format!("no command {number}"));
            };
            case.equal("name", &format!("k{command:?}"), name);
            if !self.display_name.starts_with("(none") {
                case.equal("display name", command.display_name(), &self.display_name);
            }
            let request = sample(command).encode(version, CommandId(0));
            let size = request.map(|bytes| bytes.as_bytes().len());
            case.equal("request size", size, Ok(self.request_total_bytes));
            let payload = self.response_total_bytes - Header::SIZE;
            let bytes = vec![0; payload];
            let decode = |size| Reply::decode(version, command, &message(number, &bytes[..size]));
            case.equal("reply of this size is read", decode(payload).is_ok(), true);
            let short = decode(payload - 1);
            let too_short = matches!(short, Err(DecodeError::MessageSize { .. }));
            case.equal("shorter reply is refused", too_short, true);
        });
    }
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
fn check_enum(report: &mut Report, version: Version, declared: &DeclaredEnum) {
    let name = &declared.name;
    let Some(meaning) = reader(name, version) else {
        return;
    };
    report.case(format!("enum {name}"), |case: &mut Case<'_>| {
        for (byte, name) in (0..=u8::MAX).zip(declared.names()) {
            case.equal(&format!("byte {byte}"), meaning(byte).as_deref(), name);
        }
    });
}

/// The vendor's name for a byte, if it has one.
type Meaning = Box<dyn Fn(u8) -> Option<String>>;

/// This crate's reader for the bytes of an enum. `None` for enums without a reader: command
/// numbers, which are checked separately, and enums from which others are derived.
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
        // The base of all other statuses; in protocol 10 `GetRobotModel` has no separate status.
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

/// Meaning of these bytes of a `LoadModelLibrary`, if any.
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
