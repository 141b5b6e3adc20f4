//! The protocol against complete messages and datagrams, both ways: values to bytes, bytes to
//! values.

use anyhow::{Context as _, bail};
use franka_proto::framing::{Message, next_message};
use franka_proto::{
    Architecture, CollisionBehavior, Command, CommandId, ConnectStatus, Deviation, Filters, Load,
    MoveControllerMode, MoveGeneratorMode, MoveRequest, Outgoing, Reply, Request, SuccessRate,
    System, Version, VirtualWall, server,
};
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};
use serde_json::{Map, Value};

use super::wire_datagrams::{command, state};
use super::{Report, Versions, wire_end_effectors};

#[derive(Deserialize)]
pub(super) struct File {
    #[serde(flatten)]
    robots: Versions<Vec<Golden>>,
    pub(super) gripper: Vec<Golden>,
    pub(super) vacuum_gripper: Vec<Golden>,
    control_exception_suffixes: Vec<Suffix>,
}

/// One message or datagram of the file.
#[derive(Deserialize)]
pub(super) struct Golden {
    pub(super) message: String,
    pub(super) values: Values,
    #[serde(rename = "hex", deserialize_with = "hexadecimal")]
    pub(super) bytes: Vec<u8>,
}

/// The values of a message by the vendor's names of the fields; bools are 0 or 1.
#[derive(Deserialize)]
pub(super) struct Values(Map<String, Value>);

#[derive(Deserialize)]
struct Suffix {
    second_to_last_success_rate: f64,
    lost_packets: u64,
    suffix: String,
}

impl Values {
    pub(super) fn get<T: DeserializeOwned>(&self, name: &str) -> anyhow::Result<T> {
        self.find(name)?.with_context(|| format!("no value {name}"))
    }

    pub(super) fn find<T: DeserializeOwned>(&self, name: &str) -> anyhow::Result<Option<T>> {
        let value = self.0.get(name).map(T::deserialize).transpose();
        value.with_context(|| format!("value {name}"))
    }

    pub(super) fn flag(&self, name: &str) -> anyhow::Result<bool> {
        Ok(self.get::<u8>(name)? != 0)
    }
}

/// Bytes as a text of two hexadecimal digits each.
fn hexadecimal<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
    let text = String::deserialize(deserializer)?;
    let (pairs, []) = text.as_bytes().as_chunks::<2>() else {
        return Err(D::Error::custom("an odd number of hexadecimal digits"));
    };
    let byte = |pair: &[u8; 2]| {
        let pair = str::from_utf8(pair).ok()?;
        u8::from_str_radix(pair, 16).ok()
    };
    let bytes: Option<_> = pairs.iter().map(byte).collect();
    bytes.ok_or_else(|| D::Error::custom("a character that is not a hexadecimal digit"))
}

/// Checks `wire_golden.json`: bytes made by the compiled protocol headers.
pub(super) fn messages(text: &[u8]) -> anyhow::Result<Report> {
    let mut report = Report::default();
    let file: File = serde_json::from_slice(text)?;
    for (version, messages) in file.robots.each() {
        for (index, golden) in messages.iter().enumerate() {
            let name = format!("v{version}[{index}] {}", golden.message);
            golden.check(&mut report, version, &name).context(name)?;
        }
    }
    wire_end_effectors::messages(&mut report, &file)?;
    let suffixes = &file.control_exception_suffixes;
    report.each("control_exception_suffixes", suffixes, |case, v| {
        let rate = SuccessRate::of_log(v.second_to_last_success_rate, 1000, 1001 + v.lost_packets);
        case.equal("suffix", &rate.to_string(), &v.suffix);
    });
    Ok(report)
}

/// The command with the vendor's name, which is also the name of the variant.
fn known(name: &str) -> anyhow::Result<Command> {
    let mut commands = Command::ALL.into_iter();
    let command = commands.find(|command| format!("{command:?}") == name);
    command.context("expected a command of the protocol")
}

impl Golden {
    fn check(&self, report: &mut Report, version: Version, name: &str) -> anyhow::Result<()> {
        match self.message.split_once(' ') {
            Some((command, "request")) => self.request(report, version, name, known(command)?),
            Some((command, "reply")) => self.reply(report, version, name, known(command)?),
            _ if self.message == "RobotCommand" => command(report, version, name, self),
            _ if self.message == "RobotState" => state(report, version, name, self),
            _ => bail!("expected a message of the protocol"),
        }
    }

    fn id(&self) -> anyhow::Result<CommandId> {
        Ok(CommandId(self.values.get("command_id")?))
    }

    fn whole(&self) -> anyhow::Result<Message<'_>> {
        next_message(&self.bytes)?.context("half a message")
    }

    fn request(
        &self,
        report: &mut Report,
        version: Version,
        name: &str,
        command: Command,
    ) -> anyhow::Result<()> {
        let (id, message) = (self.id()?, self.whole()?);
        let decoded = Request::decode(version, &message);
        let request = self.request_values(command)?;
        report.case(name, |case| {
            case.equal("id", message.header.id(), id);
            case.equal("values", decoded, Ok(request));
            let encoded = request.encode(version, id);
            let encoded = encoded.as_ref().map(Outgoing::as_bytes);
            case.equal("bytes", encoded, Ok(&self.bytes[..]));
        });
        Ok(())
    }

    /// The request with the values of the file.
    fn request_values(&self, command: Command) -> anyhow::Result<Request> {
        let values = &self.values;
        Ok(match command {
            Command::Connect => Request::Connect {
                version: values.get("version")?,
                udp_port: values.get("udp_port")?,
            },
            Command::Move => Request::Move(self.motion()?),
            Command::StopMove => Request::StopMove,
            Command::SetCollisionBehavior => Request::SetCollisionBehavior(self.thresholds()?),
            Command::SetJointImpedance => Request::SetJointImpedance(values.get("K_theta")?),
            Command::SetCartesianImpedance => Request::SetCartesianImpedance(values.get("K_x")?),
            Command::SetGuidingMode => Request::SetGuidingMode {
                guiding_mode: values.get::<[u8; 6]>("guiding_mode")?.map(|flag| flag != 0),
                nullspace: values.flag("nullspace")?,
            },
            Command::SetEEToK => Request::SetEEToK(values.get("EE_T_K")?),
            Command::SetNEToEE => Request::SetNEToEE(values.get("NE_T_EE")?),
            Command::SetLoad => Request::SetLoad(Load {
                m_load: values.get("m_load")?,
                F_x_Cload: values.get("F_x_Cload")?,
                I_load: values.get("I_load")?,
            }),
            Command::AutomaticErrorRecovery => Request::AutomaticErrorRecovery,
            Command::GetRobotModel => Request::GetRobotModel,
            Command::GetCartesianLimit => Request::GetCartesianLimit {
                id: values.get("id")?,
            },
            Command::SetFilters => Request::SetFilters(self.filters()?),
            Command::LoadModelLibrary => Request::LoadModelLibrary {
                architecture: match values.get("architecture")? {
                    0 => Architecture::X64,
                    1 => Architecture::X86,
                    2 => Architecture::Arm,
                    3 => Architecture::Arm64,
                    other => bail!("architecture {other}"),
                },
                system: match values.get("system")? {
                    0 => System::Linux,
                    1 => System::Windows,
                    other => bail!("operating system {other}"),
                },
            },
        })
    }

    fn filters(&self) -> anyhow::Result<Filters> {
        let frequency = |name| self.values.get(&format!("{name}_filter_frequency"));
        Ok(Filters {
            joint_position_filter_frequency: frequency("joint_position")?,
            joint_velocity_filter_frequency: frequency("joint_velocity")?,
            cartesian_position_filter_frequency: frequency("cartesian_position")?,
            cartesian_velocity_filter_frequency: frequency("cartesian_velocity")?,
            controller_filter_frequency: frequency("controller")?,
        })
    }

    fn motion(&self) -> anyhow::Result<MoveRequest> {
        let values = &self.values;
        let deviation = |name: &str| -> anyhow::Result<Deviation> {
            let part = |part| values.get(&format!("{name}.{part}"));
            Ok(Deviation {
                translation: part("translation")?,
                rotation: part("rotation")?,
                elbow: part("elbow")?,
            })
        };
        let asynchronous = match values.find::<u8>("use_async_motion_generator")? {
            Some(1) => Some(values.get("maximum_velocity")?),
            _ => None,
        };
        Ok(MoveRequest {
            controller: match values.get("controller_mode")? {
                0 => MoveControllerMode::JointImpedance,
                1 => MoveControllerMode::CartesianImpedance,
                2 => MoveControllerMode::ExternalController,
                other => bail!("controller {other}"),
            },
            generator: match values.get("motion_generator_mode")? {
                0 => MoveGeneratorMode::JointPosition,
                1 => MoveGeneratorMode::JointVelocity,
                2 => MoveGeneratorMode::CartesianPosition,
                3 => MoveGeneratorMode::CartesianVelocity,
                4 => MoveGeneratorMode::None,
                other => bail!("motion generator {other}"),
            },
            maximum_path_deviation: deviation("maximum_path_deviation")?,
            maximum_goal_pose_deviation: deviation("maximum_goal_pose_deviation")?,
            asynchronous,
        })
    }

    fn thresholds(&self) -> anyhow::Result<CollisionBehavior> {
        macro_rules! thresholds {
            ($($field:ident),* $(,)?) => {
                CollisionBehavior { $($field: self.values.get(stringify!($field))?,)* }
            };
        }
        Ok(thresholds! {
            lower_torque_thresholds_acceleration,
            upper_torque_thresholds_acceleration,
            lower_torque_thresholds_nominal,
            upper_torque_thresholds_nominal,
            lower_force_thresholds_acceleration,
            upper_force_thresholds_acceleration,
            lower_force_thresholds_nominal,
            upper_force_thresholds_nominal,
        })
    }

    fn reply(
        &self,
        report: &mut Report,
        version: Version,
        name: &str,
        command: Command,
    ) -> anyhow::Result<()> {
        let (id, message, values) = (self.id()?, self.whole()?, &self.values);
        let decoded = Reply::decode(version, command, &message);
        let status: usize = values.get("status")?;
        // Where the file names no status, these are the vendor's.
        let unnamed = ["kSuccess", "kIncompatibleLibraryVersion"][status.min(1)];
        let status = values.find("status_name")?.unwrap_or(unnamed.to_owned());
        let announced = values.find("version")?;
        let model = values.find("robot_model")?.unwrap_or(String::new());
        let wall = match values.find("object_frame")? {
            Some(object_frame) => Some(VirtualWall {
                object_world_size: values.get("object_world_size")?,
                object_frame,
                object_activation: values.flag("object_activation")?,
            }),
            None => None,
        };
        report.case(name, |case| {
            case.equal("id", message.header.id(), id);
            let Ok(reply) = decoded else {
                return case.fail(format!("{decoded:?}"));
            };
            case.equal("status", status_of(&reply), status);
            match reply {
                Reply::Connect { version: got, .. } => case.equal("version", Some(got), announced),
                Reply::Model { text, .. } => case.equal("text", text, model.as_bytes()),
                Reply::CartesianLimit { wall: got, .. } => case.equal("wall", Some(got), wall),
                _ => {}
            }
            match server_bytes(version, command, id, reply) {
                Ok(bytes) => case.equal("bytes", &bytes, &self.bytes),
                Err(error) => case.fail(error.to_string()),
            }
        });
        Ok(())
    }
}

/// Bytes that a server session sends for this reply to a request of this id.
fn server_bytes(
    version: Version,
    command: Command,
    id: CommandId,
    reply: Reply<'_>,
) -> anyhow::Result<Vec<u8>> {
    let mut session = server::Session::new(version);
    let mut hello = |announced, id| {
        let hello = Request::Connect {
            version: announced,
            udp_port: 1,
        };
        deliver(&mut session, &hello, version, id)
    };
    if let Reply::Connect { status, .. } = reply {
        let same = status == ConnectStatus::Success;
        let announced = version.number() + u16::from(!same);
        return match hello(announced, id)? {
            server::Event::Connect { reply, .. } if same => Ok(reply.as_bytes().to_vec()),
            server::Event::Incompatible { reply, .. } => Ok(reply.as_bytes().to_vec()),
            event => bail!("{event:?}"),
        };
    }
    hello(version.number(), CommandId(u32::MAX))?;
    let request = match command {
        Command::Move => Request::Move(MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        )),
        Command::StopMove => Request::StopMove,
        Command::AutomaticErrorRecovery => Request::AutomaticErrorRecovery,
        Command::GetRobotModel => Request::GetRobotModel,
        Command::GetCartesianLimit => Request::GetCartesianLimit { id: 0 },
        _ => Request::SetEEToK([0.0; 16]),
    };
    deliver(&mut session, &request, version, id)?;
    match reply {
        Reply::Model { text, .. } => {
            let header = session.model_header(id, text.len())?;
            Ok([header.as_bytes(), text].concat())
        }
        reply => Ok(session.reply(id, reply)?.as_bytes().to_vec()),
    }
}

fn deliver(
    session: &mut server::Session,
    request: &Request,
    version: Version,
    id: CommandId,
) -> anyhow::Result<server::Event> {
    let outgoing = request.encode(version, id)?;
    let message = next_message(outgoing.as_bytes())?.context("half a message")?;
    Ok(session.on_message(message)?)
}

/// The vendor's name of a status: the variant's name after a `k`.
pub(super) fn status_of(reply: &Reply<'_>) -> String {
    match reply {
        Reply::Connect { status, .. } => format!("k{status:?}"),
        Reply::Move(status) => format!("k{status:?}"),
        Reply::StopMove(status) => format!("k{status:?}"),
        Reply::Setter(status) => format!("k{status:?}"),
        Reply::Recovery(status) => format!("k{status:?}"),
        Reply::Model { status, .. } => format!("k{status:?}"),
        Reply::CartesianLimit { status, .. } => format!("k{status:?}"),
        Reply::ModelLibrary { status, .. } => format!("k{status:?}"),
        reply => format!("{reply:?}"),
    }
}
